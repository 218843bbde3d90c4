//! Marks of single points.

use super::kit::{Colour, Item, Outline, Stroke};
use super::theme::MARK;

/// Shapes of marks. They distinguish curves without colour.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mark {
    /// A filled disc.
    Disc,
    /// A circle filled with the colour of the sheet.
    Circle,
    /// A square.
    Square,
    /// A triangle.
    Triangle,
    /// A square standing on its corner.
    Diamond,
}

impl Mark {
    /// Draws the mark at a place. Panels and legends use it.
    pub fn draw(self, at: [f64; 2], colour: Colour, background: Colour) -> Vec<Item> {
        let [x, y] = at;
        let corners = |points: &[[f64; 2]]| {
            Outline::polygon(
                &points
                    .iter()
                    .map(|[a, b]| [x + a * MARK, y + b * MARK])
                    .collect::<Vec<_>>(),
            )
        };
        let path = match self {
            Mark::Disc | Mark::Circle => Outline::circle(at, MARK),
            Mark::Square => corners(&[[-0.95, -0.95], [0.95, -0.95], [0.95, 0.95], [-0.95, 0.95]]),
            Mark::Triangle => corners(&[[0.0, -1.35], [1.2, 0.85], [-1.2, 0.85]]),
            Mark::Diamond => corners(&[[0.0, -1.35], [1.35, 0.0], [0.0, 1.35], [-1.35, 0.0]]),
        };
        match self {
            Mark::Circle => {
                vec![
                    Item::filled(path.clone(), background),
                    Item::stroked(path, Stroke::solid(colour, 0.9)),
                ]
            }
            _ => vec![Item::filled(path, colour)],
        }
    }
}
