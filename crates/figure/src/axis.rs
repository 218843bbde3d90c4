//! An axis: converts numbers to positions, and chooses the numbers at its ticks.

use super::kit::Label;
use std::fmt::Display;
use std::ops::RangeInclusive;

/// An axis from one number to a larger one.
#[derive(Clone, Debug)]
pub struct Axis {
    /// Whether numbers are spaced by their logarithms.
    is_log: bool,
    low: f64,
    high: f64,
    /// What one of the numbers at the axis is in the unit of the positions.
    scale: f64,
    title: Label,
    unit: String,
    whole: bool,
    /// Whether the ends may be moved outwards, to marks.
    open: bool,
    /// Names that are written at some positions instead of numbers.
    names: Vec<(f64, Label)>,
    /// Whether names are written upwards.
    is_upright: bool,
}

/// A mark on an axis, with or without a number.
#[derive(Clone, Debug, PartialEq)]
pub struct Tick {
    /// The position, as a share of the length of the axis.
    pub at: f64,
    /// The text at the mark; none at a minor mark.
    pub label: Option<Label>,
}

/// If the largest number is at least this, the numbers are written as multiples of a power of ten,
/// which stands in the title.
const LARGE: f64 = 1e5;
/// The same holds if the largest number is below this.
const LITTLE: f64 = 1e-3;
/// Numbers whose relative difference is at most this are equal: their difference is a rounding error.
const ROUNDING: f64 = 1e-9;
/// Larger numbers are drawn as this one, and numbers closer than its inverse are equal: no difference
/// of ends overflows or vanishes.
const LARGEST: f64 = 1e300;
/// A day in seconds.
const DAY: f64 = 86_400.0;
/// An axis in seconds that reaches this many days is in days.
const LONG: f64 = 3.0;
/// A logarithmic one must begin at this many seconds, too.
const NOT_SHORT: f64 = 60.0;

impl Axis {
    /// A linear axis over exactly this range. The finite ones of reversed, infinite or equal ends are
    /// kept apart.
    pub fn linear(range: [f64; 2], title: impl Into<Label>, unit: &str) -> Self {
        Axis::over(false, widened(range), title.into(), unit)
    }

    /// An axis between these ends. Seconds become days if there are many of them.
    fn over(is_log: bool, [low, high]: [f64; 2], title: Label, unit: &str) -> Self {
        let is_long = high - low >= LONG * DAY && (!is_log || low >= NOT_SHORT);
        let (scale, unit) = match unit {
            "s" if is_long => (DAY, "d"),
            unit => (1.0, unit),
        };
        Axis {
            is_log,
            low: low / scale,
            high: high / scale,
            scale,
            title,
            unit: unit.to_string(),
            whole: false,
            open: false,
            names: Vec::new(),
            is_upright: false,
        }
    }

    /// A linear axis over the finite ones of these values that ends at marks.
    pub fn around(
        values: impl IntoIterator<Item = f64>,
        title: impl Into<Label>,
        unit: &str,
    ) -> Self {
        let values: Vec<f64> = values.into_iter().filter(|x| x.is_finite()).collect();
        let [low, high] = range_of(values.iter().copied());
        let is_empty = high - low <= ROUNDING * low.abs().max(high.abs());
        let title = match is_empty && values.len() > 1 {
            true => title.into().and(", all\u{a0}equal"),
            false => title.into(),
        };
        Axis {
            open: true,
            ..Axis::linear([low, high], title, unit)
        }
    }

    /// A linear axis from zero to the first mark that is not below this number.
    pub fn from_zero(high: f64, title: impl Into<Label>, unit: &str) -> Self {
        let high = match high > 1.0 / LARGEST && high.is_finite() {
            true => high,
            false => 1.0,
        };
        Axis {
            open: true,
            ..Axis::linear([0.0, high], title, unit)
        }
    }

    /// A logarithmic axis over this range of positive numbers that ends at marks.
    pub fn log_around(range: [f64; 2], title: impl Into<Label>, unit: &str) -> Self {
        Axis {
            open: true,
            ..Axis::log(range, title, unit)
        }
    }

    /// A logarithmic axis over this range of positive numbers.
    pub fn log(range: [f64; 2], title: impl Into<Label>, unit: &str) -> Self {
        let [low, high] = range.map(|end| match end > 0.0 && end.is_finite() {
            true => end.clamp(1.0 / LARGEST, LARGEST),
            false => f64::NAN,
        });
        let high = if high.is_nan() { 1.0 } else { high };
        let low = if low < high * (1.0 - ROUNDING) {
            low
        } else {
            high / 10.0
        };
        Axis::over(true, [low, high], title.into(), unit)
    }

    /// An axis for densities or shares: logarithmic, or from zero. The number is not above its lower
    /// end.
    pub fn of_shares(
        shares: impl Iterator<Item = f64>,
        title: impl Into<Label>,
        unit: &str,
        is_log: bool,
    ) -> (Self, f64) {
        let [least, most] = range_of(shares.filter(|share| *share > 0.0));
        let axis = match is_log {
            true => Axis::log_around([least, most], title, unit),
            false => Axis::from_zero(most, title, unit),
        };
        // The axis ends at a mark, which may be as far below as a power of ten.
        let floor = 0.1 * axis.low;
        (axis, floor)
    }

    /// An axis with names at given positions instead of numbers.
    pub fn named(range: [f64; 2], names: Vec<(f64, Label)>) -> Self {
        Axis {
            names,
            ..Axis::linear(range, "", "")
        }
    }

    /// The same axis with its names written upwards, and a title.
    pub fn upright(self, title: Label) -> Self {
        Axis {
            title,
            is_upright: true,
            ..self
        }
    }

    /// The length of the longest name that is written upwards, in heights of its letters.
    pub fn upright_length(&self) -> Option<f64> {
        let lengths = self.names.iter().map(|(_, name)| name.width());
        self.is_upright.then(|| lengths.fold(0.0, f64::max))
    }

    /// The same axis with marks at whole numbers only.
    pub fn whole(self) -> Self {
        Axis {
            whole: true,
            ..self
        }
    }

    /// The two ends of the axis.
    #[cfg(test)]
    fn range(&self) -> [f64; 2] {
        [self.low, self.high]
    }

    /// The position of a number: 0 at the lower end of the axis, 1 at the upper end. On a
    /// logarithmic axis, a number without a logarithm is far below the lower end.
    pub fn place(&self, x: f64) -> f64 {
        let x = x / self.scale;
        let place = match self.is_log {
            false => (x - self.low) / (self.high - self.low),
            true if x > 0.0 => (x.ln() - self.low.ln()) / (self.high.ln() - self.low.ln()),
            true => -FAR,
        };
        place.clamp(-FAR, FAR)
    }

    /// The title with the unit and with the power of ten that the numbers are multiples of.
    pub fn title(&self) -> Label {
        let title = self.title.clone();
        let opening = match (self.power(), self.unit.as_str()) {
            (0, "") => return title,
            (0, _) => " (".to_string(),
            (power, "") => return title.and(format!(" ({})", power_of_ten(power))),
            (power, _) => format!(" ({}\u{a0}", power_of_ten(power)),
        };
        let unit = unit(&self.unit.replace(' ', "\u{a0}"));
        title.and(opening).and(unit).and(")")
    }

    /// The power of ten that the numbers of an axis with linear marks are multiples of.
    fn power(&self) -> i32 {
        let largest = self.low.abs().max(self.high.abs());
        let is_plain = self.has_log_marks() || (LITTLE..LARGE).contains(&largest);
        if is_plain || self.whole {
            0
        } else {
            largest.log10().floor() as i32
        }
    }

    /// The marks of an axis of this length, if each number needs `room` of it.
    pub fn ticks(&self, length: f64, room: f64) -> Vec<Tick> {
        if !self.names.is_empty() {
            let tick = |(place, name): &(f64, Label)| Tick {
                at: self.place(*place),
                label: Some(name.clone()),
            };
            return self.names.iter().map(tick).collect();
        }
        let room = if self.whole {
            room.min(WHOLE_ROOM)
        } else {
            room
        };
        let most = (length / room).max(2.0);
        if self.has_log_marks() {
            self.log_ticks(most)
        } else {
            self.linear_ticks(most)
        }
    }

    /// The same axis with its ends moved outwards to marks, if the ends are not fixed.
    pub fn ending_at_marks(mut self, length: f64, room: f64) -> Self {
        if self.open {
            let most = (length / room).max(2.0);
            [self.low, self.high] = if self.has_log_marks() {
                self.log_ends(most)
            } else {
                self.linear_ends(most)
            };
        }
        self
    }

    /// Whether its marks are spaced by their logarithms: a short logarithmic axis has those of a linear
    /// one.
    fn has_log_marks(&self) -> bool {
        self.is_log && self.high >= 2.0 * self.low
    }

    /// The distance of two marks on an axis of this range that has at most this number of them.
    fn step(&self, most: f64) -> f64 {
        let step = nice_at_least((self.high - self.low) / most);
        if self.whole {
            step.max(1.0).round()
        } else {
            step
        }
    }

    fn linear_ends(&self, most: f64) -> [f64; 2] {
        let mut step = self.step(most);
        loop {
            let [low, high] = [
                (self.low / step + SLACK).floor(),
                (self.high / step - SLACK).ceil(),
            ];
            if high - low <= most {
                return [low * step, high * step];
            }
            step = nice_at_least(1.01 * step);
        }
    }

    /// The closest ends of a logarithmic axis at which it has marks.
    fn log_ends(&self, most: f64) -> [f64; 2] {
        let [low, high] = [self.low.log10(), self.high.log10()];
        let ends = |set: &[f64]| {
            let numbers = multiples(set, low.floor() as i32 - 1..=high.ceil() as i32);
            let first = numbers.iter().filter(|x| x.log10() <= low + SLACK).count() - 1;
            let last = numbers
                .partition_point(|x| x.log10() < high - SLACK)
                .min(numbers.len() - 1);
            [numbers[first], numbers[last]]
        };
        let has_marks = |[low, high]: &[f64; 2]| {
            let ticks = Axis {
                low: *low,
                high: *high,
                ..self.clone()
            }
            .log_ticks(most);
            [0.0, 1.0]
                .iter()
                .all(|end| ticks.iter().any(|tick| (tick.at - end).abs() < SLACK))
        };
        let [many, some, powers] = FEW_DECADES;
        [many, &DIGITS, some]
            .into_iter()
            .map(ends)
            .find(has_marks)
            .unwrap_or_else(|| ends(powers))
    }

    fn linear_ticks(&self, most: f64) -> Vec<Tick> {
        let step = self.step(most);
        let factor = 10f64.powi(self.power());
        let decimals = (-(step / factor).log10().floor()).clamp(0.0, 12.0) as usize;
        // A step of 2.5 needs one more digit than its size suggests.
        let decimals = decimals + usize::from(!is_whole_at(step / factor, decimals));
        let (first, last) = (
            (self.low / step - SLACK).ceil() as i64,
            (self.high / step + SLACK).floor() as i64,
        );
        let tick = |n: i64| {
            let x = n as f64 * step;
            Tick {
                at: self.place(x * self.scale),
                label: Some(Label::verbatim(&fixed(x / factor, decimals))),
            }
        };
        (first..=last).map(tick).collect()
    }

    fn log_ticks(&self, most: f64) -> Vec<Tick> {
        let (first, last) = (self.low.log10() - SLACK, self.high.log10() + SLACK);
        let tick = |x: f64, label: Option<Label>| Tick {
            at: self.place(x * self.scale),
            label,
        };
        let inside = |digits: &[f64]| {
            let mut numbers = multiples(digits, first.floor() as i32..=last.ceil() as i32);
            numbers.retain(|x| (first..=last).contains(&x.log10()));
            numbers
        };
        let decades = (last.floor() - first.ceil()) as i32 + 1;
        if decades < 3 {
            // With few powers of ten on the axis, the marks are plain numbers: all in this list, or
            // 1, 2 and 5 times each power of ten, or only the powers, whichever fits.
            let fitting = FEW_DECADES
                .into_iter()
                .map(inside)
                .find(|numbers| numbers.len() as f64 <= most);
            let numbers = fitting.unwrap_or_else(|| inside(&[1.0]));
            return numbers
                .into_iter()
                .map(|x| tick(x, Some(plain(x))))
                .collect();
        }
        let every = (f64::from(decades) / most).ceil().max(1.0) as i32;
        let power = |n: i32| {
            tick(
                10f64.powi(n),
                (n % every == 0).then(|| power_of_ten(n).into()),
            )
        };
        let mut ticks: Vec<Tick> = (first.ceil() as i32..=last.floor() as i32)
            .map(power)
            .collect();
        if every == 1 {
            ticks.extend(inside(&DIGITS[1..]).into_iter().map(|x| tick(x, None)));
        }
        ticks
    }
}

const DIGITS: [f64; 9] = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0];
/// The digits of the numbers at a logarithmic axis with few powers of ten on it.
const FEW_DECADES: [&[f64]; 3] = [
    &[1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0],
    &[1.0, 2.0, 5.0],
    &[1.0],
];
/// The space that a whole number of one or two digits needs.
const WHOLE_ROOM: f64 = 13.0;
/// A position farther out than anything that is visible.
const FAR: f64 = 50.0;
/// The rounding error that is allowed, as a share of a step.
const SLACK: f64 = 1e-9;

/// These digits times each of these powers of ten.
fn multiples(digits: &[f64], powers: RangeInclusive<i32>) -> Vec<f64> {
    powers
        .flat_map(|n| digits.iter().map(move |digit| digit * 10f64.powi(n)))
        .collect()
}

/// The range, made wider if it is empty.
fn widened(range: [f64; 2]) -> [f64; 2] {
    if range.iter().any(|end| !end.is_finite()) {
        return [-1.0, 1.0];
    }
    let [one, other] = range.map(|end| end.clamp(-LARGEST, LARGEST));
    let (low, high) = (one.min(other), one.max(other));
    match low.abs().max(high.abs()) {
        size if high - low > (ROUNDING * size).max(1.0 / LARGEST) => [low, high],
        size if size > 1.0 / LARGEST => {
            let half = 0.5 * low.abs();
            [low - half, high + half]
        }
        _ => [-1.0, 1.0],
    }
}

/// The smallest and the largest of the finite values.
pub fn range_of(values: impl IntoIterator<Item = f64>) -> [f64; 2] {
    let finite = values.into_iter().filter(|x| x.is_finite());
    finite.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| {
        [low.min(x), high.max(x)]
    })
}

/// The smallest of 1, 2, 2.5 and 5 times a power of ten that is not below `x`.
fn nice_at_least(x: f64) -> f64 {
    let power = 10f64.powi(x.log10().floor() as i32);
    [1.0, 2.0, 2.5, 5.0, 10.0]
        .into_iter()
        .map(|digit| digit * power)
        .find(|step| *step >= x)
        .unwrap_or(10.0 * power)
}

fn is_whole_at(x: f64, decimals: usize) -> bool {
    let scaled = x * 10f64.powi(decimals as i32);
    (scaled - scaled.round()).abs() < 1e-6 * scaled.abs()
}

fn fixed(x: f64, decimals: usize) -> String {
    let text = format!("{x:.decimals$}");
    let is_zero = text.chars().all(|c| ['-', '0', '.'].contains(&c));
    minus(if is_zero {
        text.trim_start_matches('-')
    } else {
        &text
    })
}

/// A number with the typographic minus sign.
pub fn minus(text: &str) -> String {
    text.replace('-', "\u{2212}")
}

/// A power of ten as a text with marks.
fn power_of_ten(power: impl Display) -> String {
    format!("10^{{{}}}", minus(&power.to_string()))
}

/// A number with two significant digits, or as a product with a power of ten.
pub fn plain(x: f64) -> Label {
    written(x, 2)
}

/// The ends of an interval, with two significant digits of its width; one number if it has none.
pub fn between([low, high]: [f64; 2]) -> Label {
    if low == high {
        return plain(low);
    }
    let ratio = low.abs().max(high.abs()) / (high - low);
    let digits = if ratio > 1.0 && ratio.is_finite() {
        2 + ratio.log10().ceil() as usize
    } else {
        2
    };
    written(low, digits).and(" to ").and(written(high, digits))
}

/// A number with this many significant digits, or as a product with a power of ten.
pub fn written(x: f64, digits: usize) -> Label {
    let text = stickslip_text::numbers::significant(x, digits);
    match text.split_once('e') {
        None => Label::verbatim(&minus(&text)),
        Some(("1", power)) => power_of_ten(power).into(),
        Some((digits, power)) => format!("{}·{}", minus(digits), power_of_ten(power)).into(),
    }
}

/// A unit as a label. The power in `m^2/s` is raised; everything else stays as it was written.
pub fn unit(label: &str) -> Label {
    let mut out = Label::default();
    let mut rest = label;
    while let Some((before, after)) = rest.split_once('^') {
        let digits = after.len()
            - after
                .trim_start_matches(|c: char| c.is_ascii_digit() || c == '-')
                .len();
        out = out.and(Label::verbatim(before));
        out = match digits {
            0 => out.and("^"),
            n => out.and(format!("^{{{}}}", minus(&after[..n]))),
        };
        rest = &after[digits..];
    }
    out.and(Label::verbatim(rest))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ends_of_an_interval_have_the_digits_that_its_width_needs() {
        assert_eq!(between([0.49992, 0.50032]).words(), "0.49992 to 0.50032");
        assert_eq!(between([-0.011, 0.31]).words(), "\u{2212}0.011 to 0.31");
        assert_eq!(between([0.1, 0.1]).words(), "0.1");
    }

    fn labels(axis: &Axis, length: f64) -> Vec<String> {
        axis.ticks(length, 20.0)
            .into_iter()
            .filter_map(|tick| tick.label)
            .map(|label| label.words())
            .collect()
    }

    fn axis(low: f64, high: f64) -> Axis {
        Axis::linear([low, high], "t", "s")
    }

    #[test]
    fn numbers_are_round_and_have_a_true_minus() {
        assert_eq!(labels(&axis(-7.0, 7.0), 100.0), ["−5", "0", "5"]);
        assert_eq!(
            labels(&axis(0.0, 1.0), 100.0),
            ["0.0", "0.2", "0.4", "0.6", "0.8", "1.0"]
        );
        assert_eq!(
            labels(&axis(0.0, 1.0), 80.0),
            ["0.00", "0.25", "0.50", "0.75", "1.00"]
        );
        assert_eq!(labels(&axis(0.1, 0.3), 60.0), ["0.1", "0.2", "0.3"]);
    }

    #[test]
    fn large_and_small_numbers_share_a_power_of_ten() {
        let metres = Axis::linear([0.0, 3.1e7], "x", "m");
        assert_eq!(labels(&metres, 100.0), ["0", "1", "2", "3"]);
        assert_eq!(metres.title().words(), "x (107\u{a0}m)");
        assert_eq!(axis(0.0, 2e-6).title().words(), "t (10−6\u{a0}s)");
        assert_eq!(axis(0.0, 20.0).title().words(), "t (s)");
    }

    #[test]
    fn powers_of_ten_are_written_alike_and_not_too_close() {
        let log = |low, high| Axis::log([low, high], "D", "");
        assert_eq!(
            labels(&log(1e-5, 1e-1), 200.0),
            ["10−5", "10−4", "10−3", "10−2", "10−1"]
        );
        assert_eq!(labels(&log(1e-8, 1e8), 100.0).len(), 5);
        assert_eq!(
            labels(&log(0.02, 0.6), 100.0),
            ["0.02", "0.05", "0.1", "0.2", "0.5"]
        );
        assert!(
            log(1e-5, 1e-1)
                .ticks(200.0, 20.0)
                .iter()
                .any(|tick| tick.label.is_none())
        );
        assert_eq!(
            (log(1.0, 100.0).place(10.0), log(1.0, 100.0).place(0.0)),
            (0.5, -FAR)
        );
    }

    #[test]
    fn marks_of_nearly_equal_numbers_differ() {
        for difference in [0.0, 1e-14, 1e-6, 1e-3, 0.5] {
            let range = [5.2e-8, 5.2e-8 * (1.0 + difference)];
            let marks = labels(&Axis::log_around(range, "S", ""), 100.0);
            let mut distinct = marks.clone();
            distinct.dedup();
            assert_eq!(marks, distinct, "{difference}");
        }
    }

    #[test]
    fn an_empty_range_is_widened() {
        assert_eq!(axis(2.0, 2.0).range(), [1.0, 3.0]);
        assert_eq!(axis(0.0, 0.0).range(), [-1.0, 1.0]);
        assert_eq!(Axis::around([], "", "").range(), [-1.0, 1.0]);
        let equal = Axis::around([2.0, 2.0 + 1e-12, f64::NAN], "x", "mm");
        assert_eq!(equal.range(), [1.0, 3.0 + 1e-12]);
        assert_eq!(equal.title().words(), "x, all\u{a0}equal (mm)");
        assert_eq!(Axis::around([2.0], "x", "").title().words(), "x");
    }

    /// Whatever the numbers, an axis has two finite ends, a few distinct marks between them, and every
    /// finite number at a place; an open axis ends at marks and contains what it is made around.
    #[test]
    fn every_axis_has_ends_and_marks_for_any_numbers() {
        let next = |x: f64| f64::from_bits(x.to_bits() + 1);
        let sizes = [
            0.0,
            5e-324,
            f64::MIN_POSITIVE,
            1e-300,
            1e-9,
            1.0,
            3.0,
            86_400.0,
            4e7,
            1e9,
        ];
        let sizes = sizes.into_iter().chain([1e300, f64::MAX, f64::INFINITY]);
        let mut numbers: Vec<f64> = sizes
            .flat_map(|x| [x, -x, next(x), 7.3 * x])
            .chain([f64::NAN])
            .collect();
        numbers.sort_by(f64::total_cmp);
        numbers.dedup_by(|a, b| a.to_bits() == b.to_bits());
        for &one in &numbers {
            check(&Axis::around([one], "", "s"), &[one]);
            // These are for numbers that are not negative.
            let least = one.min(0.0);
            check(&Axis::from_zero(one, "", "s"), &[one - least]);
            let shares = |is_log| Axis::of_shares([one].into_iter(), "", "s", is_log).0;
            [true, false]
                .iter()
                .for_each(|is_log| check(&shares(*is_log), &[one - least]));
            for &other in &numbers {
                let ends = [one, other];
                let whole = Axis::linear(ends, "", "s").whole();
                let two = [
                    Axis::linear(ends, "", "s"),
                    Axis::around(ends, "", "s"),
                    Axis::log(ends, "", "s"),
                    Axis::log_around(ends, "", "s"),
                    Axis::named(ends, vec![(one, "a".into()), (other, "b".into())]),
                ];
                two.iter().for_each(|axis| check(axis, &ends));
                check_ends(&whole, &ends);
            }
        }
        check(&Axis::around([], "", ""), &[]);
        let (axis, floor) = Axis::of_shares([].into_iter(), "", "", true);
        assert!(floor < axis.low && floor > 0.0);
    }

    /// The ends and the places of an axis that is made of these numbers.
    fn check_ends(axis: &Axis, of: &[f64]) {
        let [low, high] = axis.range();
        let is_sound = low.is_finite() && high.is_finite() && low < high;
        assert!(is_sound && (high - low).is_finite(), "{of:?}: {axis:?}");
        for x in of.iter().copied().chain([0.0, 1.0]) {
            assert!(
                x.is_nan() || axis.place(x).is_finite(),
                "{of:?}: {axis:?} {x}"
            );
        }
    }

    fn check(axis: &Axis, of: &[f64]) {
        check_ends(axis, of);
        for length in [60.0, 200.0, 400.0] {
            let ended = axis.clone().ending_at_marks(length, 17.0);
            check_ends(&ended, of);
            let ticks = ended.ticks(length, 17.0);
            let marks = ticks.iter().filter_map(|tick| tick.label.clone());
            let marks: Vec<String> = marks.map(|label| label.words()).collect();
            assert!(
                marks.len() as f64 <= length / 17.0 + 1.0,
                "{of:?}: {marks:?}"
            );
            if !ended.names.is_empty() {
                continue;
            }
            assert!(
                marks.len() >= 2 || !ended.open,
                "{of:?}: {ended:?} {marks:?}"
            );
            let are_distinct = (1..marks.len()).all(|i| !marks[..i].contains(&marks[i]));
            assert!(are_distinct, "{of:?}: {ended:?} {marks:?}");
            let is_inside = |place: f64| (-1e-6..=1.0 + 1e-6).contains(&place);
            assert!(
                ticks.iter().all(|tick| is_inside(tick.at)),
                "{of:?}: {ended:?}"
            );
            let is_drawn = |x: &f64| x.abs() < LARGEST && (!ended.is_log || *x > 1.0 / LARGEST);
            let has_all = of
                .iter()
                .all(|x| !is_drawn(x) || is_inside(ended.place(*x)));
            let is_whole = !of.iter().any(|x| x.is_infinite() || x.is_nan());
            let is_ordered = of.windows(2).all(|pair| pair[0] <= pair[1]);
            if ended.open && is_whole && is_ordered {
                assert!(has_all, "{of:?}: {ended:?}");
            }
        }
    }

    #[test]
    fn many_seconds_are_days() {
        let month = Axis::linear([0.0, 30.0 * DAY], "t", "s");
        assert_eq!(month.title().words(), "t (d)");
        assert_eq!(labels(&month, 100.0), ["0", "10", "20", "30"]);
        assert_eq!(month.place(15.0 * DAY), 0.5);
        let log = |low| Axis::log([low, 1e6], "D", "s");
        assert_eq!((log(60.0).unit, log(1e-3).unit), ("d".into(), "s".into()));
        assert_eq!(axis(0.0, 60.0).title().words(), "t (s)");
        assert_eq!(axis(0.0, 3.1e7).unit, "d");
    }

    /// The ends of an axis over data are marks, and the data are between them.
    #[test]
    fn an_open_axis_ends_at_marks() {
        for (low, high) in [
            (-6.3, 6.2),
            (0.0, 1.77),
            (-7.0, 0.2),
            (3.0, 3.1),
            (1e-7, 4e-7),
            (0.0, 0.05),
        ] {
            for length in [40.0, 84.0, 150.0, 400.0] {
                let linear = Axis {
                    open: true,
                    ..axis(low, high)
                };
                let log = Axis::log_around([high / 40.0, high], "", "");
                let long = Axis::log_around([high / 4e4, high], "", "");
                for axis in [linear, log, long] {
                    let [low, high] = axis.range();
                    let ended = axis.ending_at_marks(length, 17.0);
                    let ticks = ended.ticks(length, 17.0);
                    for end in [0.0, 1.0] {
                        assert!(
                            ticks.iter().any(|tick| (tick.at - end).abs() < 1e-6),
                            "{ended:?} {length}"
                        );
                    }
                    let slack = 1e-6 * (high - low);
                    assert!(
                        ended.low <= low + slack && ended.high >= high - slack,
                        "{ended:?}"
                    );
                }
            }
        }
    }

    #[test]
    fn powers_in_a_unit_are_raised() {
        assert_eq!(unit("m^2/s"), Label::from("m^{2}/s"));
        assert_eq!(unit("a_b*"), Label::verbatim("a_b*"));
    }
}
