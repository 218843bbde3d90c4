//! The three typefaces of pictures: subsets of Inter (`assets/inter`).

use skrifa::instance::{LocationRef, Size};
use skrifa::outline::{DrawSettings, OutlinePen};
use skrifa::raw::TableProvider as _;
use skrifa::{FontRef, GlyphId, MetadataProvider as _};
use std::sync::LazyLock;

/// A typeface.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Face {
    /// Upright.
    Regular,
    /// For the symbols of quantities.
    Italic,
    /// For headings and the letters of panels.
    Bold,
}

/// A font that was parsed once.
struct Parsed {
    font: FontRef<'static>,
    em: f64,
}

static FILES: [&[u8]; 3] = [
    include_bytes!("../../assets/inter/Inter-Regular.ttf"),
    include_bytes!("../../assets/inter/Inter-Italic.ttf"),
    include_bytes!("../../assets/inter/Inter-Bold.ttf"),
];

static PARSED: LazyLock<[Parsed; 3]> = LazyLock::new(|| {
    FILES.map(|bytes| {
        // This cannot fail: tests/command/assets.rs compares the bytes with their hash, and a test
        // below reads every typeface.
        let font = FontRef::new(bytes).expect("a vendored font is sound");
        let em = f64::from(font.head().map_or(1000, |head| head.units_per_em()));
        Parsed { font, em }
    })
});

impl Face {
    /// All typefaces.
    pub const ALL: [Face; 3] = [Face::Regular, Face::Italic, Face::Bold];

    fn parsed(self) -> &'static Parsed {
        &PARSED[self as usize]
    }

    /// The font file.
    pub fn bytes(self) -> &'static [u8] {
        FILES[self as usize]
    }

    /// The number of font units in the size of the letters.
    pub fn em(self) -> f64 {
        self.parsed().em
    }

    /// The glyph of a character; the glyph for missing characters if the typeface does not have it.
    pub fn glyph(self, c: char) -> u32 {
        self.parsed()
            .font
            .charmap()
            .map(c)
            .map_or(0, |glyph| glyph.to_u32())
    }

    /// The width of a glyph, in units of the size of the letters.
    pub fn advance(self, glyph: u32) -> f64 {
        let metrics = self
            .parsed()
            .font
            .glyph_metrics(Size::unscaled(), LocationRef::default());
        f64::from(metrics.advance_width(GlyphId::new(glyph)).unwrap_or(0.0)) / self.em()
    }

    /// The width of a text, in units of the size of the letters.
    pub fn width(self, text: &str) -> f64 {
        text.chars().map(|c| self.advance(self.glyph(c))).sum()
    }

    /// The outline of a glyph as SVG path data, in font units with y pointing up.
    pub fn outline(self, glyph: u32) -> String {
        let mut pen = SvgPen::default();
        let settings = DrawSettings::unhinted(Size::unscaled(), LocationRef::default());
        if let Some(outline) = self.parsed().font.outline_glyphs().get(GlyphId::new(glyph)) {
            // A glyph that cannot be drawn stays blank. The test below ensures that all glyphs that
            // are used can be drawn.
            let _ = outline.draw(settings, &mut pen);
        }
        pen.0
    }
}

#[derive(Default)]
struct SvgPen(String);

impl SvgPen {
    fn put(&mut self, command: char, points: &[f32]) {
        self.0.push(command);
        let numbers: Vec<String> = points.iter().map(|x| format!("{x}")).collect();
        self.0.push_str(&numbers.join(" "));
    }
}

impl OutlinePen for SvgPen {
    fn move_to(&mut self, x: f32, y: f32) {
        self.put('M', &[x, y]);
    }
    fn line_to(&mut self, x: f32, y: f32) {
        self.put('L', &[x, y]);
    }
    fn quad_to(&mut self, cx: f32, cy: f32, x: f32, y: f32) {
        self.put('Q', &[cx, cy, x, y]);
    }
    fn curve_to(&mut self, ax: f32, ay: f32, bx: f32, by: f32, x: f32, y: f32) {
        self.put('C', &[ax, ay, bx, by, x, y]);
    }
    fn close(&mut self) {
        self.put('Z', &[]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The characters of labels: letters, digits, the typographic minus, Greek letters, a dotted x
    /// for a velocity, fractions, comparisons.
    const NEEDED: &str = "0123456789−–.,%()=<>≤≥×·±°√∞≈½¼abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZẋẍαβγδεθλμρστφωΔΩäöüßéèñçåøžś";

    #[test]
    fn every_face_has_and_draws_what_labels_need() {
        for face in Face::ALL {
            for c in NEEDED.chars() {
                let glyph = face.glyph(c);
                assert!(glyph != 0, "{face:?} lacks {c}");
                assert!(
                    face.advance(glyph) > 0.1 && face.outline(glyph).len() > 10,
                    "{face:?} {c}"
                );
            }
            assert_eq!(face.glyph('龍'), 0);
        }
    }

    #[test]
    fn a_width_is_the_sum_of_its_letters() {
        let face = Face::Regular;
        assert!((face.width("mM") - face.width("m") - face.width("M")).abs() < 1e-12);
        assert!(face.width("m") > 2.0 * face.width("i"));
    }
}
