//! A picture as data, and its three formats. There is no plotting here, only shapes and text on a
//! sheet.
//!
//! ```text
//! Label      text with italics and indices, measured before it is placed            (face, label)
//! Scene      a sheet with filled and stroked paths, text, and clipped parts         (scene)
//!   -> svg   letters as outlines, so that it looks the same everywhere
//!   -> png   that SVG, rasterised
//!   -> pdf   letters as text in an embedded font, so that it can be searched
//! ```
//!
//! Lengths are in points of 1/72 inch, and y points down.

mod escape;
mod face;
mod label;
mod pdf;
mod png;
mod scene;
mod svg;

pub use escape::escaped;
pub use label::Label;
pub use pdf::pdf;
pub use png::png;
pub use scene::{Align, Colour, Drawing, Item, Outline, Rect, Stroke};
pub use svg::svg;
