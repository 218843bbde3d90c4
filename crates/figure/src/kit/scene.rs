//! A sheet with shapes and text on it.

use super::Label;

/// A colour: red, green and blue.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Colour(pub [u8; 3]);

impl Colour {
    /// A colour from six hexadecimal digits.
    pub const fn hex(rgb: u32) -> Self {
        Colour([(rgb >> 16) as u8, (rgb >> 8) as u8, rgb as u8])
    }

    /// The colour mixed with a share of another one.
    pub fn mixed(self, other: Colour, share: f64) -> Self {
        let mix = |i: usize| {
            (f64::from(self.0[i]) * (1.0 - share) + f64::from(other.0[i]) * share).round() as u8
        };
        Colour([0, 1, 2].map(mix))
    }
}

/// A rectangle with horizontal and vertical sides.
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

    /// The rectangle, larger by `by` on every side.
    pub fn grown(&self, by: f64) -> Rect {
        Rect {
            x: self.x - by,
            y: self.y - by,
            width: self.width + 2.0 * by,
            height: self.height + 2.0 * by,
        }
    }

    /// Whether a point lies in the rectangle.
    pub fn holds(&self, [x, y]: [f64; 2]) -> bool {
        (self.x..=self.right()).contains(&x) && (self.y..=self.bottom()).contains(&y)
    }

    /// Whether the interiors of the two rectangles have a point in common.
    pub fn meets(&self, other: &Rect) -> bool {
        self.x < other.right()
            && other.x < self.right()
            && self.y < other.bottom()
            && other.y < self.bottom()
    }
}

/// Lines and curves, in the elements that SVG has.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Outline(pub Vec<PenMove>);

/// An element of a path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PenMove {
    /// Moves to a point without drawing.
    Move([f64; 2]),
    /// A straight line.
    Line([f64; 2]),
    /// A cubic curve with two control points.
    Curve([f64; 2], [f64; 2], [f64; 2]),
    /// Closes this part of the path by a line to its beginning.
    Close,
}

impl Outline {
    /// Straight lines from point to point.
    pub fn line(points: &[[f64; 2]]) -> Self {
        let step = |(i, point): (usize, &[f64; 2])| {
            if i == 0 {
                PenMove::Move(*point)
            } else {
                PenMove::Line(*point)
            }
        };
        Outline(points.iter().enumerate().map(step).collect())
    }

    /// A closed shape with these corners.
    pub fn polygon(points: &[[f64; 2]]) -> Self {
        let mut path = Outline::line(points);
        path.0.push(PenMove::Close);
        path
    }

    /// A rectangle.
    pub fn rect(rect: Rect) -> Self {
        let Rect { x, y, .. } = rect;
        Outline::polygon(&[
            [x, y],
            [rect.right(), y],
            [rect.right(), rect.bottom()],
            [x, rect.bottom()],
        ])
    }

    /// A circle.
    pub fn circle([x, y]: [f64; 2], radius: f64) -> Self {
        // Four cubic curves approximate the circle to 3e-4 of its radius.
        let (r, k) = (radius, 0.552_284_75 * radius);
        Outline(vec![
            PenMove::Move([x + r, y]),
            PenMove::Curve([x + r, y + k], [x + k, y + r], [x, y + r]),
            PenMove::Curve([x - k, y + r], [x - r, y + k], [x - r, y]),
            PenMove::Curve([x - r, y - k], [x - k, y - r], [x, y - r]),
            PenMove::Curve([x + k, y - r], [x + r, y - k], [x + r, y]),
            PenMove::Close,
        ])
    }
}

/// How the outline of a path is drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct Stroke {
    /// Its colour.
    pub colour: Colour,
    /// Its width.
    pub width: f64,
    /// The lengths of strokes and gaps in turn; empty for a solid line.
    pub dash: Vec<f64>,
}

impl Stroke {
    /// A solid line.
    pub fn solid(colour: Colour, width: f64) -> Self {
        Stroke {
            colour,
            width,
            dash: Vec::new(),
        }
    }

    /// A dashed line.
    pub fn dashed(colour: Colour, width: f64, dash: &[f64]) -> Self {
        Stroke {
            colour,
            width,
            dash: dash.to_vec(),
        }
    }
}

/// Which point of a text is placed at the given position.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Align {
    /// Its beginning.
    Start,
    /// Its middle.
    Middle,
    /// Its end.
    End,
}

/// An element of a sheet.
#[derive(Clone, Debug, PartialEq)]
pub enum Item {
    /// A shape.
    Shape {
        /// Its outline.
        path: Outline,
        /// The colour it is filled with; none for an outline only.
        fill: Option<Colour>,
        /// How its outline is drawn; none for an area only.
        stroke: Option<Stroke>,
    },
    /// A line of text.
    Words {
        /// The text.
        label: Label,
        /// Where its base line begins.
        at: [f64; 2],
        /// The size of the letters.
        size: f64,
        /// The colour of the letters.
        colour: Colour,
        /// Whether the text runs upwards instead of to the right.
        upwards: bool,
    },
    /// Items that are visible only inside a rectangle.
    Clipped {
        /// The rectangle.
        inside: Rect,
        /// The items.
        items: Vec<Item>,
    },
    /// Items that are moved to the right and down.
    Moved {
        /// The distances to the right and down.
        by: [f64; 2],
        /// The items.
        items: Vec<Item>,
    },
}

/// A sheet.
#[derive(Clone, Debug, PartialEq)]
pub struct Drawing {
    /// Its width.
    pub width: f64,
    /// Its height.
    pub height: f64,
    /// Its colour.
    pub background: Colour,
    /// What it shows, in one line, for readers who do not see the picture.
    pub title: String,
    /// Its items, from back to front.
    pub items: Vec<Item>,
    /// Number of notes for which there was no room.
    pub left_out: usize,
}

impl Item {
    /// An outline without a filled area.
    pub fn stroked(path: Outline, stroke: Stroke) -> Self {
        Item::Shape {
            path,
            fill: None,
            stroke: Some(stroke),
        }
    }

    /// A filled area without an outline.
    pub fn filled(path: Outline, fill: Colour) -> Self {
        Item::Shape {
            path,
            fill: Some(fill),
            stroke: None,
        }
    }

    /// Text that runs to the right. `align` says which point of its base line is at the given
    /// position.
    pub fn words(label: Label, [x, y]: [f64; 2], align: Align, size: f64, colour: Colour) -> Self {
        let share = match align {
            Align::Start => 0.0,
            Align::Middle => 0.5,
            Align::End => 1.0,
        };
        let x = x - size * label.width() * share;
        Item::Words {
            label,
            at: [x, y],
            size,
            colour,
            upwards: false,
        }
    }

    /// Text that runs upwards. The middle of its base line is at the given position.
    pub fn words_upwards(label: Label, [x, y]: [f64; 2], size: f64, colour: Colour) -> Self {
        let y = y + size * label.width() * 0.5;
        Item::Words {
            label,
            at: [x, y],
            size,
            colour,
            upwards: true,
        }
    }
}
