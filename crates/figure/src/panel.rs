//! A panel: two axes with curves, bands, bars and marks between them, and notes that never overlap.

use super::axis::{Axis, Tick};
use super::kit::{Align, Colour, Item, Label, Outline, Rect, Stroke};
use super::legend::LegendEntry;
use super::mark::Mark;
use super::theme::{LETTERS, LINE, MARK, Palette, SMALL, THIN};

/// An element of a panel. Its positions are numbers of the two axes.
#[derive(Clone, Debug)]
enum Layer {
    Line {
        points: Vec<[f64; 2]>,
        stroke: Stroke,
    },
    Band {
        points: Vec<[f64; 3]>,
        fill: Colour,
    },
    Bars {
        corners: Vec<[[f64; 2]; 2]>,
        fill: Colour,
    },
    Interval {
        at: f64,
        ends: [f64; 2],
        is_across: bool,
        colour: Colour,
    },
    Mark {
        at: [f64; 2],
        mark: Mark,
        colour: Colour,
    },
    Level {
        at: f64,
        stroke: Stroke,
    },
    Before {
        at: f64,
        fill: Colour,
    },
}

/// Words beside a point. They are placed where there is space for them.
#[derive(Clone, Debug)]
struct Note {
    at: [f64; 2],
    label: Label,
    /// The sides of the point where they may be placed, the best one first.
    places: &'static [Beside],
}

/// The side of a point at which words are placed, as a step to the right and one down: `[-1, 1]` is
/// below it and to its left.
pub type Beside = [i8; 2];

/// A panel with its two axes and its elements.
#[derive(Clone, Debug)]
pub struct Panel {
    /// The horizontal axis.
    pub x: Axis,
    /// The vertical axis.
    pub y: Axis,
    /// The height of the frame in points.
    pub height: f64,
    /// Whether the horizontal axis has numbers and a title. If not, it shares those of the panel
    /// below.
    pub is_labelled: bool,
    /// Whether it explains the colours of the other panels, and has no letter.
    pub is_scale: bool,
    /// What its curves and areas are, where panels differ in it.
    pub key: Vec<LegendEntry>,
    layers: Vec<Layer>,
    notes: Vec<Note>,
}

/// The length of a tick.
const TICK: f64 = 3.0;
/// The space between a tick and its number.
const GAP: f64 = 2.0;
/// The space along an axis for one number.
const X_ROOM: f64 = 26.0;
const Y_ROOM: f64 = 13.0;
/// Half the length of the bars at the ends of an interval.
const CAP: f64 = 1.8;
/// The distance of two rows of the title of the vertical axis, in heights of its letters.
const ROW: f64 = 1.2;
/// How far the title of the vertical axis may extend below the frame.
const BELOW: f64 = 8.0;
/// Points of a curve that are closer than this to the line between their neighbours are left out.
const TOLERANCE: f64 = 0.03;

impl Panel {
    /// A panel without elements.
    pub fn new(x: Axis, y: Axis, height: f64) -> Self {
        Panel {
            x,
            y,
            height,
            is_labelled: true,
            is_scale: false,
            key: Vec::new(),
            layers: Vec::new(),
            notes: Vec::new(),
        }
    }

    /// The same panel with a legend of its own above it.
    pub fn keyed(self, key: impl IntoIterator<Item = LegendEntry>) -> Self {
        Panel {
            key: key.into_iter().collect(),
            ..self
        }
    }

    /// The same panel with a frame that is `factor` times as high, and a vertical axis for it.
    pub fn stretched(&self, factor: f64) -> Self {
        let height = factor * self.height;
        Panel {
            height,
            y: self.y.clone().ending_at_marks(height, Y_ROOM),
            ..self.clone()
        }
    }

    /// The same panel without numbers at its horizontal axis, because the panel below has them.
    pub fn above_another(self) -> Self {
        Panel {
            is_labelled: false,
            ..self
        }
    }

    /// The same panel with numbers at its horizontal axis, because there is none below.
    pub fn last(self) -> Self {
        Panel {
            is_labelled: true,
            ..self
        }
    }

    /// Adds a curve. It has a gap where a number is missing.
    pub fn line(&mut self, points: Vec<[f64; 2]>, stroke: Stroke) {
        self.layers.push(Layer::Line { points, stroke });
    }

    /// Adds the area between two curves, given by points (x, low, high).
    pub fn band(&mut self, points: Vec<[f64; 3]>, fill: Colour) {
        self.layers.push(Layer::Band { points, fill });
    }

    /// Adds a filled rectangle.
    pub fn bar(&mut self, from: [f64; 2], to: [f64; 2], fill: Colour) {
        self.bars(vec![[from, to]], fill);
    }

    /// Adds filled rectangles as one shape, so that no hairline separates those that touch.
    pub fn bars(&mut self, corners: Vec<[[f64; 2]; 2]>, fill: Colour) {
        self.layers.push(Layer::Bars { corners, fill });
    }

    /// Adds a vertical interval; nothing where an end is not known.
    pub fn interval(&mut self, at: f64, ends: [f64; 2], colour: Colour) {
        self.interval_along(at, ends, false, colour);
    }

    /// Adds a horizontal interval, likewise.
    pub fn interval_across(&mut self, at: f64, ends: [f64; 2], colour: Colour) {
        self.interval_along(at, ends, true, colour);
    }

    fn interval_along(&mut self, at: f64, ends: [f64; 2], is_across: bool, colour: Colour) {
        if ends.iter().all(|end| end.is_finite()) {
            self.layers.push(Layer::Interval {
                at,
                ends,
                is_across,
                colour,
            });
        }
    }

    /// Adds a mark. It is never clipped at the frame.
    pub fn mark(&mut self, at: [f64; 2], mark: Mark, colour: Colour) {
        self.layers.push(Layer::Mark { at, mark, colour });
    }

    /// Adds a horizontal line across the whole panel.
    pub fn level(&mut self, at: f64, stroke: Stroke) {
        self.layers.push(Layer::Level { at, stroke });
    }

    /// Fills the part of the panel to the left of a number.
    pub fn before(&mut self, at: f64, fill: Colour) {
        self.layers.push(Layer::Before { at, fill });
    }

    /// Adds words beside a point, at the first of these sides where there is space for them. They are
    /// left out if there is none.
    pub fn note(&mut self, at: [f64; 2], label: impl Into<Label>, places: &'static [Beside]) {
        self.notes.push(Note {
            at,
            label: label.into(),
            places,
        });
    }

    /// The space that numbers and title need to the left of the frame.
    pub fn margin(&self) -> f64 {
        let rows = self.title_rows().len() as f64;
        LETTERS * (0.15 + ROW * rows) + GAP + self.number_width() + GAP + TICK
    }

    /// The title of the vertical axis, in as many rows as it needs to end at the letter of the next
    /// panel. The letter of this one is above the frame, so a row extends below it.
    fn title_rows(&self) -> Vec<Label> {
        let below = if self.is_labelled { BELOW } else { 0.0 };
        self.y.title().wrapped((self.height + below) / LETTERS)
    }

    fn number_width(&self) -> f64 {
        let ticks = self.y.ticks(self.height, Y_ROOM);
        ticks
            .iter()
            .filter_map(|tick| tick.label.as_ref())
            .map(|label| SMALL * label.width())
            .fold(0.0, f64::max)
    }

    /// The space that numbers and title need below the frame.
    pub fn footing(&self) -> f64 {
        if self.is_labelled {
            let names = self.x.upright_length().unwrap_or(1.0);
            TICK + GAP + SMALL * names + GAP + LETTERS * 1.3
        } else {
            TICK
        }
    }

    /// Draws the panel with its frame at this place, and returns the number of notes for which there
    /// was no space.
    pub fn draw(&self, frame: Rect, palette: &Palette, items: &mut Vec<Item>) -> usize {
        let across = self.x.clone().ending_at_marks(frame.width, X_ROOM);
        let place = |[x, y]: [f64; 2]| {
            [
                frame.x + frame.width * across.place(x),
                frame.bottom() - frame.height * self.y.place(y),
            ]
        };
        // A curve and the bars of an interval along the edge of the frame have their whole widths.
        for edge in [0.0, LINE / 2.0, CAP] {
            let layers = self.layers.iter();
            let drawn = layers.filter(|layer| layer.edge() == edge);
            items.push(Item::Clipped {
                inside: frame.grown(edge),
                items: drawn.flat_map(|layer| layer.draw(&place, frame)).collect(),
            });
        }
        self.draw_axes(frame, &across, palette, items);
        let is_seen = |at: &[f64; 2]| frame.grown(0.01).holds(*at);
        for layer in &self.layers {
            if let Layer::Mark { at, mark, colour } = layer
                && is_seen(&place(*at))
            {
                items.extend(mark.draw(place(*at), *colour, palette.background));
            }
        }
        self.draw_notes(frame, &place, palette, items)
    }

    fn draw_axes(&self, frame: Rect, across: &Axis, palette: &Palette, items: &mut Vec<Item>) {
        let pen = || Stroke::solid(palette.ink, THIN);
        let corners = [
            [frame.x, frame.y],
            [frame.x, frame.bottom()],
            [frame.right(), frame.bottom()],
        ];
        items.push(Item::stroked(Outline::line(&corners), pen()));
        let mut written_to = f64::NEG_INFINITY;
        for tick in across.ticks(frame.width, X_ROOM) {
            let x = frame.x + tick.at * frame.width;
            items.push(Item::stroked(
                Outline::line(&[[x, frame.bottom()], [x, frame.bottom() + tick.length()]]),
                pen(),
            ));
            let upright = across.upright_length();
            let half = |label: &Label| 0.5 * SMALL * upright.map_or(label.width(), |_| 0.7);
            if let Some(label) = tick
                .label
                .filter(|label| self.is_labelled && x - half(label) > written_to)
            {
                let below = frame.bottom() + TICK + GAP;
                if upright.is_some() {
                    written_to = x + half(&label);
                    let at = [x + 0.36 * SMALL, below + 0.5 * SMALL * label.width()];
                    items.push(Item::words_upwards(label, at, SMALL, palette.ink));
                    continue;
                }
                written_to = x + half(&label) + GAP;
                let at = [x, below + 0.75 * SMALL];
                items.push(Item::words(label, at, Align::Middle, SMALL, palette.ink));
            }
        }
        for tick in self.y.ticks(frame.height, Y_ROOM) {
            let y = frame.bottom() - tick.at * frame.height;
            let length = tick.length();
            items.push(Item::stroked(
                Outline::line(&[[frame.x - length, y], [frame.x, y]]),
                pen(),
            ));
            if let Some(label) = tick.label {
                let at = [frame.x - TICK - GAP, y + 0.36 * SMALL];
                items.push(Item::words(label, at, Align::End, SMALL, palette.ink));
            }
        }
        if self.is_labelled {
            let at = [
                frame.x + frame.width / 2.0,
                frame.bottom() + self.footing() - 0.25 * LETTERS,
            ];
            items.push(Item::words(
                across.title(),
                at,
                Align::Middle,
                LETTERS,
                palette.ink,
            ));
        }
        let x = frame.x - TICK - GAP - self.number_width() - GAP - 0.3 * LETTERS;
        for (row, title) in self.title_rows().into_iter().rev().enumerate() {
            let low = frame.y + frame.height.max(LETTERS * title.width()) / 2.0;
            let at = [x - ROW * LETTERS * row as f64, low];
            items.push(Item::words_upwards(title, at, LETTERS, palette.ink));
        }
    }

    /// Places the notes where they overlap nothing, and returns how many of them found no such
    /// place.
    fn draw_notes(
        &self,
        frame: Rect,
        place: &impl Fn([f64; 2]) -> [f64; 2],
        palette: &Palette,
        items: &mut Vec<Item>,
    ) -> usize {
        let mut marks: Vec<[f64; 2]> = Vec::new();
        let mut curves: Vec<[f64; 2]> = Vec::new();
        for layer in &self.layers {
            match layer {
                Layer::Mark { at, .. } => marks.push(place(*at)),
                Layer::Line { points, .. } => curves.extend(sampled(
                    &points.iter().map(|p| place(*p)).collect::<Vec<_>>(),
                )),
                Layer::Level { at, .. } => curves.extend(sampled(
                    &[frame.x, frame.right()].map(|x| [x, place([f64::NAN, *at])[1]]),
                )),
                _ => {}
            }
        }
        let mut taken: Vec<Rect> = marks.iter().map(|mark| around(*mark, MARK + 0.4)).collect();
        let mut left_out = 0;
        for note in &self.notes {
            // A note at infinity is at the edge.
            let [x, y] = place(note.at);
            let point = [x.clamp(frame.x, frame.right()), y];
            let free = note.places.iter().find_map(|beside| {
                let (at, needed) = placed(*beside, point, &note.label);
                let across = needed.x >= frame.x + 1.0 && needed.right() <= frame.right() + ASIDE;
                let within =
                    across && needed.y >= frame.y - 1.0 && needed.bottom() <= frame.bottom() + 1.0;
                // Words diagonally beside their mark must not extend over another mark.
                let is_own = |mark: &&[f64; 2]| (mark[0] - point[0]).abs() < 0.01;
                let reaches = |mark: &[f64; 2]| {
                    (needed.x..=needed.right()).contains(&mark[0]) && mark[1] == point[1]
                };
                let is_plain = beside.contains(&0)
                    || !marks.iter().any(|mark| !is_own(&mark) && reaches(mark));
                let meets_nothing = !taken.iter().any(|other| other.meets(&needed))
                    && !curves.iter().any(|p| needed.holds(*p));
                (within && is_plain && meets_nothing).then_some((at, needed))
            });
            let Some((at, needed)) = free else {
                left_out += 1;
                continue;
            };
            taken.push(needed);
            items.push(Item::words(
                note.label.clone(),
                at,
                Align::Start,
                LETTERS,
                palette.ink,
            ));
        }
        left_out
    }
}

impl Tick {
    fn length(&self) -> f64 {
        if self.label.is_some() {
            TICK
        } else {
            TICK * 0.6
        }
    }
}

/// How far words may extend beyond the right side of the frame.
const ASIDE: f64 = 8.0;

/// The beginning of the base line of words at this side of a point, and the rectangle that they
/// take.
fn placed([right, down]: Beside, [x, y]: [f64; 2], label: &Label) -> ([f64; 2], Rect) {
    let (rise, fall) = (LETTERS * label.rise(), LETTERS * label.fall());
    let (width, gap, aside) = (LETTERS * label.width(), MARK + 1.4, 1.6);
    let (to_left, to_right) = (x - gap - width, x + gap);
    let x = match (right, down) {
        (0, _) => x - width / 2.0,
        (-1, 0) => to_left,
        (-1, _) => to_left + gap - aside,
        (_, 0) => to_right,
        (_, _) => to_right - gap + aside,
    };
    let y = match down {
        -1 => y - gap - fall,
        0 => y + 0.26 * LETTERS,
        _ => y + gap + rise,
    };
    (
        [x, y],
        Rect {
            x: x - 0.5,
            y: y - rise,
            width: width + 1.0,
            height: rise + fall,
        },
    )
}

impl Layer {
    /// How far it may extend beyond the frame.
    fn edge(&self) -> f64 {
        match self {
            Layer::Line { .. } => LINE / 2.0,
            Layer::Interval { .. } => CAP,
            _ => 0.0,
        }
    }

    fn draw(&self, place: &impl Fn([f64; 2]) -> [f64; 2], frame: Rect) -> Vec<Item> {
        match self {
            Layer::Line { points, stroke } => pieces(points)
                .map(|piece| {
                    let placed: Vec<[f64; 2]> = piece.iter().map(|point| place(*point)).collect();
                    Item::stroked(Outline::line(&simplified(&placed)), stroke.clone())
                })
                .collect(),
            Layer::Band { points, fill } => {
                let known = |p: &&[f64; 3]| !p[0].is_nan() && !p[1].is_nan() && !p[2].is_nan();
                let edge = |k: usize| -> Vec<[f64; 2]> {
                    simplified(
                        &points
                            .iter()
                            .filter(known)
                            .map(|p| place([p[0], p[k]]))
                            .collect::<Vec<_>>(),
                    )
                };
                let around: Vec<[f64; 2]> = edge(1)
                    .into_iter()
                    .chain(edge(2).into_iter().rev())
                    .collect();
                if around.len() < 3 {
                    Vec::new()
                } else {
                    vec![Item::filled(Outline::polygon(&around), *fill)]
                }
            }
            Layer::Bars { corners, fill } => {
                // All run the same way round, so that no two of them cancel where they overlap.
                let bar = |[from, to]: &[[f64; 2]; 2]| {
                    let ([ax, ay], [bx, by]) = (place(*from), place(*to));
                    Outline::polygon(&[[ax, ay], [bx, ay], [bx, by], [ax, by]]).0
                };
                vec![Item::filled(
                    Outline(corners.iter().flat_map(bar).collect()),
                    *fill,
                )]
            }
            Layer::Interval {
                at,
                ends,
                is_across,
                colour,
            } => {
                let bar = |ends: [[f64; 2]; 2]| {
                    Item::stroked(Outline::line(&ends), Stroke::solid(*colour, 0.9))
                };
                let end = |end: f64| place(if *is_across { [end, *at] } else { [*at, end] });
                let across = |[x, y]: [f64; 2]| match is_across {
                    true => bar([[x, y - CAP], [x, y + CAP]]),
                    false => bar([[x - CAP, y], [x + CAP, y]]),
                };
                let [low, high] = ends.map(end);
                vec![bar([low, high]), across(low), across(high)]
            }
            Layer::Mark { .. } => Vec::new(),
            Layer::Level { at, stroke } => {
                let y = place([f64::NAN, *at])[1];
                vec![Item::stroked(
                    Outline::line(&[[frame.x, y], [frame.right(), y]]),
                    stroke.clone(),
                )]
            }
            Layer::Before { at, fill } => {
                let x = place([*at, f64::NAN])[0].clamp(frame.x, frame.right());
                vec![Item::filled(
                    Outline::rect(Rect {
                        width: x - frame.x,
                        ..frame
                    }),
                    *fill,
                )]
            }
        }
    }
}

/// The pieces of a curve between missing numbers.
fn pieces(points: &[[f64; 2]]) -> impl Iterator<Item = &[[f64; 2]]> {
    points
        .split(|[x, y]| x.is_nan() || y.is_nan())
        .filter(|piece| piece.len() > 1)
}

/// A square around a point.
fn around([x, y]: [f64; 2], half: f64) -> Rect {
    Rect {
        x: x - half,
        y: y - half,
        width: 2.0 * half,
        height: 2.0 * half,
    }
}

/// Points along a curve, no farther apart than the stem of a letter.
fn sampled(curve: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let mut out = Vec::new();
    for pair in curve.windows(2) {
        let length = (pair[1][0] - pair[0][0]).hypot(pair[1][1] - pair[0][1]);
        if !length.is_finite() {
            continue;
        }
        let n = (length / 1.5).ceil().clamp(1.0, 4096.0) as usize;
        out.extend((0..n).map(|i| {
            let s = i as f64 / n as f64;
            [0, 1].map(|k| pair[0][k] + s * (pair[1][k] - pair[0][k]))
        }));
    }
    out
}

/// The same curve with fewer points: no point that is left out is farther than `TOLERANCE` from the
/// new curve (algorithm of Ramer, and Douglas and Peucker).
fn simplified(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let mut keep = vec![false; points.len()];
    let Some(last) = points.len().checked_sub(1) else {
        return Vec::new();
    };
    (keep[0], keep[last]) = (true, true);
    let mut open = vec![(0, last)];
    while let Some((a, b)) = open.pop() {
        let farthest = (a + 1..b)
            .map(|i| (distance(points[i], points[a], points[b]), i))
            .reduce(|one, other| if other.0 > one.0 { other } else { one });
        if let Some((_, i)) = farthest.filter(|(distance, _)| *distance > TOLERANCE) {
            keep[i] = true;
            open.extend([(a, i), (i, b)]);
        }
    }
    points
        .iter()
        .zip(keep)
        .filter(|(_, keep)| *keep)
        .map(|(point, _)| *point)
        .collect()
}

/// The distance of a point from the line segment between two others.
fn distance(p: [f64; 2], a: [f64; 2], b: [f64; 2]) -> f64 {
    let (along, to) = ([b[0] - a[0], b[1] - a[1]], [p[0] - a[0], p[1] - a[1]]);
    let square = along[0] * along[0] + along[1] * along[1];
    let s = if square > 0.0 {
        ((to[0] * along[0] + to[1] * along[1]) / square).clamp(0.0, 1.0)
    } else {
        0.0
    };
    (to[0] - s * along[0]).hypot(to[1] - s * along[1])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_simplified_curve_stays_within_the_tolerance() {
        let curve: Vec<[f64; 2]> = (0..2000)
            .map(|i| f64::from(i) / 10.0)
            .map(|x| [x, 20.0 * (x / 9.0).sin()])
            .collect();
        let simple = simplified(&curve);
        assert!(simple.len() < 400, "{}", simple.len());
        for p in &curve {
            let nearest = simple
                .windows(2)
                .map(|pair| distance(*p, pair[0], pair[1]))
                .fold(f64::INFINITY, f64::min);
            assert!(nearest <= TOLERANCE * 1.000_001, "{nearest}");
        }
    }

    fn axis() -> Axis {
        Axis::linear([0.0, 1.0], "x", "")
    }

    #[test]
    fn a_long_title_has_rows_and_edges_have_whole_curves() {
        let title = "autocovariance *C*(*s*) of the velocity";
        let mut panel = Panel::new(axis(), Axis::linear([0.0, 1.0], title, "m^2/s^2"), 60.0);
        panel.line(
            vec![[0.0, 1.0], [1.0, 1.0]],
            Stroke::solid(Colour::hex(0), LINE),
        );
        let frame = Rect {
            x: 0.0,
            y: 0.0,
            width: 200.0,
            height: 60.0,
        };
        let mut items = Vec::new();
        let palette = super::super::theme::Style::default().palette();
        panel.draw(frame, palette, &mut items);
        let rows = items.iter().filter_map(|item| match item {
            Item::Words {
                label,
                size,
                upwards: true,
                ..
            } => Some((*size, size * label.width())),
            _ => None,
        });
        let rows: Vec<(f64, f64)> = rows.collect();
        let fits = |row: &(f64, f64)| row.0 == LETTERS && row.1 < 60.0 + BELOW;
        assert!(rows.len() > 1 && rows.iter().all(fits), "{rows:?}");
        let shown = items.iter().any(|item| {
            matches!(item, Item::Clipped { inside, items } if !items.is_empty()
                && inside.y <= -LINE / 2.0)
        });
        assert!(shown, "half of a curve along the edge is cut off");
    }

    #[test]
    fn notes_never_overlap_and_those_without_room_are_counted() {
        let mut panel = Panel::new(axis(), axis(), 100.0);
        for i in 0..60 {
            let at = [0.2 + 0.01 * f64::from(i), 0.5];
            panel.mark(at, Mark::Disc, Colour::hex(0));
            panel.note(at, "*τ*_{12}", &[[0, 1], [0, -1]]);
        }
        let frame = Rect {
            x: 0.0,
            y: 0.0,
            width: 200.0,
            height: 100.0,
        };
        let mut items = Vec::new();
        let left_out = panel.draw(
            frame,
            super::super::theme::Style::default().palette(),
            &mut items,
        );
        let boxes: Vec<Rect> = items
            .iter()
            .filter_map(|item| match item {
                Item::Words { label, at, .. } if label.words() == "τ12" => Some(Rect {
                    x: at[0],
                    y: at[1] - 6.0,
                    width: LETTERS * label.width(),
                    height: 6.0,
                }),
                _ => None,
            })
            .collect();
        assert_eq!(boxes.len() + left_out, 60);
        assert!(boxes.len() >= 10, "{}", boxes.len());
        for (i, one) in boxes.iter().enumerate() {
            assert!(boxes[..i].iter().all(|other| !one.meets(other)));
        }
    }
}
