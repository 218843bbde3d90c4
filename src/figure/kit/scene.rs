//! A sheet with shapes and words on it.

use super::Label;

/// A colour, and how much of what lies behind it shows through.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Colour {
    /// Red, green and blue.
    pub rgb: [u8; 3],
    /// From 0, nothing of it, to 1, nothing behind it.
    pub opacity: f64,
}

impl Colour {
    /// Of six hexadecimal digits, opaque.
    pub const fn hex(rgb: u32) -> Self {
        Colour { rgb: [(rgb >> 16) as u8, (rgb >> 8) as u8, rgb as u8], opacity: 1.0 }
    }

    /// The same, so far opaque.
    pub const fn at(self, opacity: f64) -> Self {
        Colour { opacity, ..self }
    }

    /// The same mixed with so much of another.
    pub fn mixed(self, other: Colour, share: f64) -> Self {
        let mix = |i: usize| (f64::from(self.rgb[i]) * (1.0 - share) + f64::from(other.rgb[i]) * share).round() as u8;
        Colour { rgb: [0, 1, 2].map(mix), ..self }
    }
}

/// An upright rectangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rect {
    /// Left edge.
    pub x: f64,
    /// Upper edge.
    pub y: f64,
    /// Width.
    pub width: f64,
    /// Height.
    pub height: f64,
}

impl Rect {
    /// Right edge.
    pub fn right(&self) -> f64 {
        self.x + self.width
    }

    /// Lower edge.
    pub fn bottom(&self) -> f64 {
        self.y + self.height
    }

    /// Larger by so much on every side.
    pub fn grown(&self, by: f64) -> Rect {
        Rect { x: self.x - by, y: self.y - by, width: self.width + 2.0 * by, height: self.height + 2.0 * by }
    }

    /// Whether a point lies in it.
    pub fn holds(&self, [x, y]: [f64; 2]) -> bool {
        (self.x..=self.right()).contains(&x) && (self.y..=self.bottom()).contains(&y)
    }

    /// Whether the two have a point in common.
    pub fn meets(&self, other: &Rect) -> bool {
        self.x < other.right() && other.x < self.right() && self.y < other.bottom() && other.y < self.bottom()
    }
}

/// Lines and curves, as SVG draws them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Path(pub Vec<Step>);

/// A step of a path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Step {
    /// Go there without drawing.
    Move([f64; 2]),
    /// A straight line.
    Line([f64; 2]),
    /// A cubic curve with two control points.
    Curve([f64; 2], [f64; 2], [f64; 2]),
    /// Back to where this part began.
    Close,
}

impl Path {
    /// Straight lines from point to point.
    pub fn line(points: &[[f64; 2]]) -> Self {
        let step = |(i, point): (usize, &[f64; 2])| if i == 0 { Step::Move(*point) } else { Step::Line(*point) };
        Path(points.iter().enumerate().map(step).collect())
    }

    /// A closed shape with these corners.
    pub fn polygon(points: &[[f64; 2]]) -> Self {
        let mut path = Path::line(points);
        path.0.push(Step::Close);
        path
    }

    /// A rectangle.
    pub fn rect(rect: Rect) -> Self {
        let Rect { x, y, .. } = rect;
        Path::polygon(&[[x, y], [rect.right(), y], [rect.right(), rect.bottom()], [x, rect.bottom()]])
    }

    /// A circle.
    pub fn circle([x, y]: [f64; 2], radius: f64) -> Self {
        // Four cubic curves, off by less than 3e-4 of the radius.
        let (r, k) = (radius, 0.552_284_75 * radius);
        Path(vec![
            Step::Move([x + r, y]),
            Step::Curve([x + r, y + k], [x + k, y + r], [x, y + r]),
            Step::Curve([x - k, y + r], [x - r, y + k], [x - r, y]),
            Step::Curve([x - r, y - k], [x - k, y - r], [x, y - r]),
            Step::Curve([x + k, y - r], [x + r, y - k], [x + r, y]),
            Step::Close,
        ])
    }
}

/// How a path is drawn along.
#[derive(Clone, Debug, PartialEq)]
pub struct Stroke {
    /// Its colour.
    pub colour: Colour,
    /// Its width.
    pub width: f64,
    /// Lengths of strokes and gaps; empty for a line without gaps.
    pub dash: Vec<f64>,
}

impl Stroke {
    /// Without gaps.
    pub fn solid(colour: Colour, width: f64) -> Self {
        Stroke { colour, width, dash: Vec::new() }
    }

    /// With gaps.
    pub fn dashed(colour: Colour, width: f64, dash: &[f64]) -> Self {
        Stroke { colour, width, dash: dash.to_vec() }
    }
}

/// Which point of a line of words stands at its place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Align {
    /// Its beginning.
    Start,
    /// Its middle.
    Middle,
    /// Its end.
    End,
}

/// Something on a sheet.
#[derive(Clone, Debug, PartialEq)]
pub enum Item {
    /// A shape.
    Shape {
        /// Its outline.
        path: Path,
        /// What it is filled with.
        fill: Option<Colour>,
        /// How its outline is drawn.
        stroke: Option<Stroke>,
    },
    /// A line of words.
    Words {
        /// The words.
        label: Label,
        /// Where the base line begins.
        at: [f64; 2],
        /// Size of the letters.
        size: f64,
        /// Their colour.
        colour: Colour,
        /// Whether they run upwards instead of to the right.
        upwards: bool,
    },
    /// Things of which only what is inside a rectangle is seen.
    Clipped {
        /// The rectangle.
        inside: Rect,
        /// The things.
        items: Vec<Item>,
    },
    /// Things moved to the right and down.
    Moved {
        /// How far.
        by: [f64; 2],
        /// The things.
        items: Vec<Item>,
    },
}

/// A sheet.
#[derive(Clone, Debug, PartialEq)]
pub struct Scene {
    /// Its width.
    pub width: f64,
    /// Its height.
    pub height: f64,
    /// Its colour.
    pub background: Colour,
    /// What it shows, in a line: for readers that do not see it.
    pub title: String,
    /// What is on it, from back to front.
    pub items: Vec<Item>,
}

impl Item {
    /// A line that is drawn along.
    pub fn stroked(path: Path, stroke: Stroke) -> Self {
        Item::Shape { path, fill: None, stroke: Some(stroke) }
    }

    /// A shape that is filled.
    pub fn filled(path: Path, fill: Colour) -> Self {
        Item::Shape { path, fill: Some(fill), stroke: None }
    }

    /// Words to the right, one point of which stands at a place on their base line.
    pub fn words(label: Label, [x, y]: [f64; 2], align: Align, size: f64, colour: Colour) -> Self {
        let x = x - size * label.width() * share(align);
        Item::Words { label, at: [x, y], size, colour, upwards: false }
    }

    /// Words upwards.
    pub fn words_upwards(label: Label, [x, y]: [f64; 2], align: Align, size: f64, colour: Colour) -> Self {
        let y = y + size * label.width() * share(align);
        Item::Words { label, at: [x, y], size, colour, upwards: true }
    }
}

fn share(align: Align) -> f64 {
    match align {
        Align::Start => 0.0,
        Align::Middle => 0.5,
        Align::End => 1.0,
    }
}
