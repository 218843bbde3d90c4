//! A scene as PDF: letters as text in an embedded font, shapes as vector paths.

use super::face::Face;
use super::label::Letters;
use super::scene::{Colour, Drawing, Item, Outline, PenMove, Stroke};
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
pub fn pdf(scene: &Drawing) -> Option<Vec<u8>> {
    let fonts: Vec<Font> = Face::ALL
        .iter()
        .filter_map(|face| Font::new(Data::from(face.bytes().to_vec()), 0))
        .collect();
    let mut document = Document::new();
    document.set_metadata(Metadata::new().title(scene.title.clone()));
    let mut page = document.start_page_with(PageSettings::from_wh(
        scene.width as f32,
        scene.height as f32,
    )?);
    let mut surface = page.surface();
    let corners = [
        [0.0, 0.0],
        [scene.width, 0.0],
        [scene.width, scene.height],
        [0.0, scene.height],
    ];
    draw(
        &mut surface,
        &Item::filled(Outline::polygon(&corners), scene.background),
        &fonts,
    );
    scene
        .items
        .iter()
        .for_each(|item| draw(&mut surface, item, &fonts));
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
        Item::Words {
            label,
            at: [x, y],
            size,
            colour,
            upwards,
        } => {
            surface.push_transform(&Transform::from_translate(*x as f32, *y as f32));
            if *upwards {
                surface.push_transform(&Transform::from_row(0.0, -1.0, 1.0, 0.0, 0.0, 0.0));
            }
            surface.set_fill(Some(filled(*colour)));
            surface.set_stroke(None);
            label
                .runs
                .iter()
                .for_each(|run| draw_run(surface, run, *size, fonts));
            if *upwards {
                surface.pop();
            }
            surface.pop();
        }
        Item::Clipped { inside, items } => {
            let Some(clip) = outline(&Outline::rect(*inside)) else {
                return;
            };
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

/// Draws letters of one typeface and size, in a label of this size.
fn draw_run(surface: &mut Surface, run: &Letters, size: f64, fonts: &[Font]) {
    let glyph = |(at, c): (usize, char)| {
        let glyph = run.face.glyph(c);
        let advance = run.face.advance(glyph) as f32;
        KrillaGlyph::new(
            GlyphId::new(glyph),
            advance,
            0.0,
            0.0,
            0.0,
            at..at + c.len_utf8(),
            None,
        )
    };
    let glyphs: Vec<KrillaGlyph> = run.text.char_indices().map(glyph).collect();
    let start = Point::from_xy((run.at[0] * size) as f32, (-run.at[1] * size) as f32);
    if let Some(font) = fonts.get(run.face as usize) {
        surface.draw_glyphs(
            start,
            &glyphs,
            font.clone(),
            &run.text,
            (run.size * size) as f32,
            false,
        );
    }
}

fn outline(path: &Outline) -> Option<krilla::geom::Path> {
    let mut builder = PathBuilder::new();
    let single = |point: [f64; 2]| point.map(|x| x as f32);
    for step in &path.0 {
        match *step {
            PenMove::Move(to) => {
                let [x, y] = single(to);
                builder.move_to(x, y);
            }
            PenMove::Line(to) => {
                let [x, y] = single(to);
                builder.line_to(x, y);
            }
            PenMove::Curve(a, b, to) => {
                let [[ax, ay], [bx, by], [x, y]] = [a, b, to].map(single);
                builder.cubic_to(ax, ay, bx, by, x, y);
            }
            PenMove::Close => builder.close(),
        }
    }
    builder.finish()
}

fn filled(colour: Colour) -> Fill {
    Fill {
        paint: painted(colour).into(),
        opacity: NormalizedF32::ONE,
        rule: FillRule::NonZero,
    }
}

fn stroked(stroke: &Stroke) -> PdfStroke {
    let dash = (!stroke.dash.is_empty()).then(|| StrokeDash {
        array: stroke.dash.iter().map(|length| *length as f32).collect(),
        offset: 0.0,
    });
    PdfStroke {
        paint: painted(stroke.colour).into(),
        width: stroke.width as f32,
        line_join: LineJoin::Round,
        dash,
        ..PdfStroke::default()
    }
}

fn painted(Colour([r, g, b]): Colour) -> rgb::Color {
    rgb::Color::new(r, g, b)
}
