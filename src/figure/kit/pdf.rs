//! A scene as PDF: letters as text in an embedded font, shapes as vector paths.

use super::face::Face;
use super::scene::{Colour, Item, Path, Scene, Step, Stroke};
use krilla::color::rgb;
use krilla::geom::{PathBuilder, Point, Transform};
use krilla::metadata::Metadata;
use krilla::num::NormalizedF32;
use krilla::page::PageSettings;
use krilla::paint::{Fill, FillRule, LineJoin, Stroke as PdfStroke, StrokeDash};
use krilla::surface::Surface;
use krilla::text::{Font, GlyphId, KrillaGlyph};
use krilla::{Data, Document};

/// The scene as a document of one page. Equal scenes give equal documents. None if PDF does not
/// allow a page of this size.
pub fn pdf(scene: &Scene) -> Option<Vec<u8>> {
    let fonts: Vec<Font> =
        Face::ALL.iter().filter_map(|face| Font::new(Data::from(face.bytes().to_vec()), 0)).collect();
    let mut document = Document::new();
    document.set_metadata(Metadata::new().title(scene.title.clone()));
    let mut page = document.start_page_with(PageSettings::from_wh(scene.width as f32, scene.height as f32)?);
    let mut surface = page.surface();
    let corners = [[0.0, 0.0], [scene.width, 0.0], [scene.width, scene.height], [0.0, scene.height]];
    draw(&mut surface, &Item::filled(Path::polygon(&corners), scene.background), &fonts);
    scene.items.iter().for_each(|item| draw(&mut surface, item, &fonts));
    surface.finish();
    page.finish();
    document.finish().ok()
}

fn draw(surface: &mut Surface, item: &Item, fonts: &[Font]) {
    match item {
        Item::Shape { path, fill, stroke } => {
            let Some(path) = outline(path) else { return };
            surface.set_fill(fill.map(filled));
            surface.set_stroke(stroke.as_ref().map(stroked));
            surface.draw_path(&path);
        }
        Item::Words { label, at: [x, y], size, colour, upwards } => {
            surface.push_transform(&Transform::from_translate(*x as f32, *y as f32));
            if *upwards {
                surface.push_transform(&Transform::from_row(0.0, -1.0, 1.0, 0.0, 0.0, 0.0));
            }
            surface.set_fill(Some(filled(*colour)));
            surface.set_stroke(None);
            for run in &label.runs {
                let glyph = |(at, c): (usize, char)| {
                    let glyph = run.face.glyph(c);
                    let advance = run.face.advance(glyph) as f32;
                    KrillaGlyph::new(GlyphId::new(glyph), advance, 0.0, 0.0, 0.0, at..at + c.len_utf8(), None)
                };
                let glyphs: Vec<KrillaGlyph> = run.text.char_indices().map(glyph).collect();
                let start = Point::from_xy((run.at[0] * size) as f32, (-run.at[1] * size) as f32);
                if let Some(font) = fonts.get(run.face as usize) {
                    surface.draw_glyphs(start, &glyphs, font.clone(), &run.text, (run.size * size) as f32, false);
                }
            }
            if *upwards {
                surface.pop();
            }
            surface.pop();
        }
        Item::Clipped { inside, items } => {
            let Some(clip) = outline(&Path::rect(*inside)) else { return };
            surface.push_clip_path(&clip, &FillRule::NonZero);
            items.iter().for_each(|item| draw(surface, item, fonts));
            surface.pop();
        }
        Item::Moved { by: [x, y], items } => {
            surface.push_transform(&Transform::from_translate(*x as f32, *y as f32));
            items.iter().for_each(|item| draw(surface, item, fonts));
            surface.pop();
        }
    }
}

fn outline(path: &Path) -> Option<krilla::geom::Path> {
    let mut builder = PathBuilder::new();
    for step in &path.0 {
        match step.map(|x| x as f32) {
            Step32::Move([x, y]) => builder.move_to(x, y),
            Step32::Line([x, y]) => builder.line_to(x, y),
            Step32::Curve([ax, ay], [bx, by], [x, y]) => builder.cubic_to(ax, ay, bx, by, x, y),
            Step32::Close => builder.close(),
        }
    }
    builder.finish()
}

enum Step32 {
    Move([f32; 2]),
    Line([f32; 2]),
    Curve([f32; 2], [f32; 2], [f32; 2]),
    Close,
}

impl Step {
    fn map(&self, f: impl Fn(f64) -> f32) -> Step32 {
        match self {
            Step::Move(to) => Step32::Move(to.map(f)),
            Step::Line(to) => Step32::Line(to.map(f)),
            Step::Curve(a, b, to) => Step32::Curve(a.map(&f), b.map(&f), to.map(&f)),
            Step::Close => Step32::Close,
        }
    }
}

fn filled(colour: Colour) -> Fill {
    let (paint, opacity) = painted(colour);
    Fill { paint: paint.into(), opacity, rule: FillRule::NonZero }
}

fn stroked(stroke: &Stroke) -> PdfStroke {
    let (paint, opacity) = painted(stroke.colour);
    let dash = (!stroke.dash.is_empty())
        .then(|| StrokeDash { array: stroke.dash.iter().map(|length| *length as f32).collect(), offset: 0.0 });
    PdfStroke {
        paint: paint.into(),
        width: stroke.width as f32,
        line_join: LineJoin::Round,
        opacity,
        dash,
        ..PdfStroke::default()
    }
}

fn painted(Colour { rgb: [r, g, b], opacity }: Colour) -> (rgb::Color, NormalizedF32) {
    (rgb::Color::new(r, g, b), NormalizedF32::new(opacity as f32).unwrap_or(NormalizedF32::ONE))
}
