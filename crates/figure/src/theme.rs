//! The look of every picture: width, colours, sizes of letters and lines.

use super::kit::Colour;

/// The part of the look that a user chooses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Style<'a> {
    /// Light or dark.
    pub theme: Theme,
    /// Width of one figure in millimetres.
    pub width: f64,
    /// Whether vertical axes are logarithmic where the values allow it.
    pub log: bool,
    /// The heading of a page; none for that of its subject.
    pub title: Option<&'a str>,
    /// Words for keys and statistics at the axes, in the place of those that they have.
    pub labels: &'a [(String, String)],
}

/// Light or dark.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Theme {
    /// Dark on white, for paper.
    Light,
    /// Light on near-black, for screens.
    Dark,
}

/// One column of a journal, in millimetres.
pub const COLUMN: f64 = 86.0;

impl Default for Style<'_> {
    fn default() -> Self {
        Style {
            theme: Theme::Light,
            width: COLUMN,
            log: false,
            title: None,
            labels: &[],
        }
    }
}

impl Style<'_> {
    /// The words that the user gave to one of these names.
    pub(super) fn words(&self, names: &[&str]) -> Option<&str> {
        self.labels
            .iter()
            .find(|(name, _)| names.contains(&name.as_str()))
            .map(|(_, words)| words.as_str())
    }

    /// Width of one figure in points of 1/72 inch.
    pub fn points(&self) -> f64 {
        self.width * 72.0 / 25.4
    }

    /// The colours of the theme.
    pub fn palette(&self) -> &'static Palette {
        match self.theme {
            Theme::Light => &LIGHT,
            Theme::Dark => &DARK,
        }
    }
}

/// The space between figures.
pub(super) const GAP: f64 = 14.0;

/// The size of letters, in points.
pub const LETTERS: f64 = 8.0;
/// The size of the numbers at ticks and of notes, in points.
pub const SMALL: f64 = 7.0;
/// The width of a curve.
pub const LINE: f64 = 1.3;
/// The width of a secondary line.
pub const THIN: f64 = 0.6;
/// The radius of a mark.
pub const MARK: f64 = 1.9;

/// Lengths of the strokes and gaps of a static phase.
pub const DASH_DOT: [f64; 4] = [5.0, 1.8, 1.1, 1.8];
/// Lengths of the strokes and gaps of a second curve.
pub const DASHES: [f64; 2] = [3.2, 1.6];
/// Lengths of the strokes and gaps of a line that leads from a point to an axis.
pub const DOTS: [f64; 2] = [0.8, 1.8];

/// The colours of a theme. Colour-blind readers can distinguish the colours of the data. Printed in
/// grey, they differ in lightness or by the dashes of their curves.
#[derive(Debug)]
pub struct Palette {
    /// The background of the sheet.
    pub background: Colour,
    /// Letters, axes and static phases.
    pub ink: Colour,
    /// Secondary lines.
    pub faint: Colour,
    /// Lines of a grid.
    pub grid: Colour,
    /// The first colour of data.
    pub first: Colour,
    /// The second colour of data.
    pub second: Colour,
    /// The third colour of data.
    pub third: Colour,
    /// The fourth colour of data.
    pub fourth: Colour,
    /// The area of a wide interval around the first curve.
    pub wide: Colour,
    /// The area of a narrow interval around the first curve.
    pub narrow: Colour,
}

const LIGHT: Palette = Palette {
    background: Colour::hex(0xffffff),
    ink: Colour::hex(0x16181c),
    faint: Colour::hex(0x6a6f78),
    grid: Colour::hex(0xe3e5e8),
    first: Colour::hex(0x0b4f8a),
    second: Colour::hex(0xd55e00),
    third: Colour::hex(0x2aa283),
    fourth: Colour::hex(0x9b3f86),
    wide: Colour::hex(0xd3e5f3),
    narrow: Colour::hex(0x8fbfe0),
};

const DARK: Palette = Palette {
    background: Colour::hex(0x14171c),
    ink: Colour::hex(0xe8eaed),
    faint: Colour::hex(0x9aa0aa),
    grid: Colour::hex(0x2c323b),
    first: Colour::hex(0x8ecaff),
    second: Colour::hex(0xdd7a33),
    third: Colour::hex(0x3cbd99),
    fourth: Colour::hex(0xd98bc7),
    wide: Colour::hex(0x1f3a52),
    narrow: Colour::hex(0x33658f),
};

#[cfg(test)]
mod tests {
    use super::*;

    /// Relative luminance (WCAG 2.2).
    fn luminance(colour: Colour) -> f64 {
        let linear = |channel: u8| {
            let c = f64::from(channel) / 255.0;
            if c <= 0.04045 {
                c / 12.92
            } else {
                ((c + 0.055) / 1.055).powf(2.4)
            }
        };
        let [r, g, b] = colour.0.map(linear);
        0.2126 * r + 0.7152 * g + 0.0722 * b
    }

    fn contrast(one: Colour, other: Colour) -> f64 {
        let (one, other) = (luminance(one), luminance(other));
        (one.max(other) + 0.05) / (one.min(other) + 0.05)
    }

    /// WCAG requires a contrast of 3 between graphics and their background, and of 4.5 for letters.
    /// The curves of one panel that differ by colour alone, which are those of sub-phases, must
    /// also differ in grey.
    #[test]
    fn colours_are_legible_and_those_of_sub_phases_differ_in_grey() {
        for palette in [&LIGHT, &DARK] {
            for colour in [palette.first, palette.second, palette.third, palette.fourth] {
                assert!(contrast(colour, palette.background) > 3.0, "{colour:?}");
            }
            assert!(contrast(palette.ink, palette.background) > 12.0);
            assert!(contrast(palette.faint, palette.background) > 4.5);
            let phases = [palette.first, palette.second, palette.third];
            for (i, one) in phases.iter().enumerate() {
                for other in &phases[..i] {
                    assert!(
                        contrast(*one, *other) > 1.15,
                        "{one:?} {other:?} {}",
                        contrast(*one, *other)
                    );
                }
            }
            assert!(
                contrast(palette.wide, palette.narrow) > 1.3
                    && contrast(palette.wide, palette.background) > 1.15
            );
        }
    }
}
