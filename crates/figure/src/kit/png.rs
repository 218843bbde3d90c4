//! A scene as PNG: its SVG, rasterised.

use super::Drawing;
use super::svg::svg;
use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::{Options, Tree};

/// Why a scene cannot be written as PNG.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PngError {
    /// The picture would have more pixels than are allowed: its width and its height.
    #[error("{0} x {1} pixels are too many for a PNG; use SVG or PDF, or a smaller width")]
    TooLarge(u32, u32),
    /// The conversion failed, which is an error of this program.
    #[error("internal error: {0}")]
    Flaw(String),
}

/// The most pixels. They take 400 MB while they are drawn.
const MOST_PIXELS: u64 = 100_000_000;

/// The scene as PNG with `per_inch` pixels to an inch. Equal scenes give equal pictures on one
/// machine.
pub fn png(scene: &Drawing, per_inch: f64) -> Result<Vec<u8>, PngError> {
    let flaw = |error: String| PngError::Flaw(error);
    let tree = Tree::from_str(&svg(scene), &Options::default())
        .map_err(|error| flaw(error.to_string()))?;
    let pixels = |points: f64| {
        (points * per_inch / 72.0)
            .round()
            .clamp(1.0, f64::from(u32::MAX)) as u32
    };
    let (width, height) = (pixels(scene.width), pixels(scene.height));
    if u64::from(width) * u64::from(height) > MOST_PIXELS {
        return Err(PngError::TooLarge(width, height));
    }
    let mut pixmap = Pixmap::new(width, height).ok_or(PngError::TooLarge(width, height))?;
    let (x, y) = (
        width as f32 / tree.size().width(),
        height as f32 / tree.size().height(),
    );
    resvg::render(&tree, Transform::from_scale(x, y), &mut pixmap.as_mut());

    // The sheet is opaque. Without the channel for transparency the file is smaller, and no reader
    // can misinterpret that channel.
    let rgb: Vec<u8> = pixmap
        .pixels()
        .iter()
        .flat_map(|pixel| [pixel.red(), pixel.green(), pixel.blue()])
        .collect();
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(png::ColorType::Rgb);
    let per_metre = (per_inch / 0.0254).round() as u32;
    let unit = png::Unit::Meter;
    encoder.set_pixel_dims(Some(png::PixelDimensions {
        xppu: per_metre,
        yppu: per_metre,
        unit,
    }));
    let mut writer = encoder
        .write_header()
        .map_err(|error| flaw(error.to_string()))?;
    writer
        .write_image_data(&rgb)
        .map_err(|error| flaw(error.to_string()))?;
    writer.finish().map_err(|error| flaw(error.to_string()))?;
    Ok(bytes)
}
