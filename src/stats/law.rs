//! Laws: the quantities of phases whose distribution over all phases is reported, and their
//! moments.
//!
//! From the phases of a path come their number n, the sum s of the quantity and the sum q of its
//! squares. In terms of the means of n, s and q over paths,
//!
//! ```text
//! mean = s/n     sd^2 = q/n - (s/n)^2     coefficient of variation = sd/mean
//! ```
//!
//! The path is the independent unit, because the phases of a path depend on each other.

use super::Dimension;
use crate::sums::Replicate;
use crate::sums::codec::sums;
use crate::sums::interval::Measured;
use crate::sums::moments::JointMoments;
use crate::sums::rare::{FEWEST, FEWEST_FOR_PHASES, Powers, are_too_few, cautious};
use crate::sums::spread::Tails;

/// A quantity of the phases of a path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PhaseLaw {
    /// D_j = tau_{j+1/2} - tau_j, the duration of a completed stick, j >= 1.
    Stick,
    /// tau_{j+1} - tau_{j+1/2}, the duration of a completed slip.
    Slip,
    /// |x_{j+1} - x_j|, the size of the jump of a completed slip.
    Jump,
    /// The size of a jump with x_{j+1} > x_j.
    JumpForward,
    /// The size of a jump with x_{j+1} < x_j.
    JumpBackward,
    /// tau_{j+3/2} - tau_{j+1/2}, the time from the beginning of a slip to that of the next.
    Recurrence,
}

impl PhaseLaw {
    /// All laws, in the order in which runs keep them.
    pub const ALL: [PhaseLaw; 6] = [
        PhaseLaw::Stick,
        PhaseLaw::Slip,
        PhaseLaw::Jump,
        PhaseLaw::JumpForward,
        PhaseLaw::JumpBackward,
        PhaseLaw::Recurrence,
    ];

    /// The laws that a run reports on request (`record.laws`). That of sticks is always reported.
    pub const ASKED: [PhaseLaw; 5] = {
        let [_, asked @ ..] = PhaseLaw::ALL;
        asked
    };

    /// The law with this name, if there is one.
    pub fn from_name(name: &str) -> Option<PhaseLaw> {
        PhaseLaw::ALL.into_iter().find(|law| law.name() == name)
    }

    /// Name, quantity in words, and dimension.
    const fn row(self) -> (&'static str, &'static str, Dimension) {
        match self {
            PhaseLaw::Stick => ("stick", "stick duration", Dimension::TIME),
            PhaseLaw::Slip => ("slip", "slip duration", Dimension::TIME),
            PhaseLaw::Jump => ("jump", "size of a jump", Dimension::LENGTH),
            PhaseLaw::JumpForward => ("jump_forward", "size of a forward jump", Dimension::LENGTH),
            PhaseLaw::JumpBackward => (
                "jump_backward",
                "size of a backward jump",
                Dimension::LENGTH,
            ),
            PhaseLaw::Recurrence => ("recurrence", "time from slip to slip", Dimension::TIME),
        }
    }

    /// The name of the law on the command line.
    pub fn name(self) -> &'static str {
        self.row().0
    }

    /// The quantity in words, e.g. "slip duration".
    pub fn words(self) -> &'static str {
        self.row().1
    }

    /// The dimension of the quantity.
    pub fn dimension(self) -> Dimension {
        self.row().2
    }

    /// Whether the quantity is a multiple of the step in a scheme that has one.
    pub(super) fn is_of_time(self) -> bool {
        self.dimension() == Dimension::TIME
    }
}

/// Number, sum and sum of squares of the values that one path has of a quantity, in time order.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Folded {
    pub count: u32,
    pub sum: f64,
    pub squares: f64,
}

impl Folded {
    /// Add a value.
    #[inline]
    pub fn add(&mut self, value: f64) {
        self.count += 1;
        self.sum += value;
        self.squares += value * value;
    }
}

sums! {
    /// Moments over paths of [`Folded`].
    #[derive(Clone, Debug, Default, PartialEq)]
    pub(super) struct LawSums {
        /// Number of values, their sum, and the sum of their squares.
        units: JointMoments<3>,
        /// Powers of the sum with the number, and of the number.
        mean_tails: Powers,
        number_tails: Powers,
        /// Powers of the influences of paths on the standard deviation.
        sd_tails: Tails,
        /// Number of units that have any value.
        contributing: u64,
    }
}

const NUMBER: usize = 0;
const SUM: usize = 1;

impl LawSums {
    /// The sums over the paths of a block, of each of which `of` gives the values.
    pub fn of<P>(paths: &[P], of: impl Fn(&P) -> Folded, unit: Replicate) -> Self {
        let column = |of_one: &dyn Fn(Folded) -> f64| unit.column(paths, |path| of_one(of(path)));
        let numbers = column(&|folded| folded.count.into());
        let sums = column(&|folded| folded.sum);
        let units = JointMoments::of([&numbers, &sums, &column(&|folded| folded.squares)]);
        // The influence of a path is the sum over its values d of (d - mean)^2 - sd^2, with the
        // mean and the sd of these paths.
        let [number, sum, squares] = units.mean;
        let (mean, variance) = (
            sum / number,
            squares / number - (sum / number) * (sum / number),
        );
        let influence = |folded: Folded| {
            folded.squares - 2.0 * mean * folded.sum
                + (mean * mean - variance) * f64::from(folded.count)
        };
        let sd_tails = match unit {
            Replicate::Path => Tails::of(
                paths
                    .iter()
                    .map(&of)
                    .filter(|folded| folded.count > 0)
                    .map(influence),
            ),
            Replicate::Pair => Tails::of(column(&influence).into_iter()),
        };
        LawSums {
            mean_tails: Powers::of(&sums, &numbers),
            number_tails: Powers::of_mean(&numbers),
            sd_tails,
            contributing: unit.count(paths, |path| of(path).count > 0),
            units,
        }
    }

    /// Number of units that have any value.
    pub fn contributing(&self) -> u64 {
        self.contributing
    }

    /// The mean number of values of a path.
    pub fn number(&self) -> Measured {
        rare_mean(&self.units, NUMBER, &self.number_tails, self.contributing)
    }

    /// The mean of values that cannot be negative.
    pub fn mean(&self) -> Measured {
        rare_ratio(
            &self.units,
            SUM,
            NUMBER,
            &self.mean_tails,
            self.contributing,
        )
    }

    /// The standard deviation of the values, sqrt(q/n - (s/n)^2). One below 1e-7 of the root mean
    /// square is lost in rounding, and the result is zero.
    pub fn sd(&self, unit: Replicate) -> Measured {
        self.spread(unit, |[n, s, q], sd| {
            let (mean, mean_square) = (s / n, q / n);
            let gradient =
                [2.0 * mean * mean - mean_square, -2.0 * mean, 1.0].map(|g| g / (2.0 * sd * n));
            (sd, gradient)
        })
    }

    /// The coefficient of variation, sqrt(q n/s^2 - 1), of values that cannot be negative.
    pub fn coefficient_of_variation(&self, unit: Replicate) -> Measured {
        self.spread(unit, |[n, s, q], sd| {
            let cv = sd * n / s;
            let gradient =
                [q / (s * s), -2.0 * q * n / (s * s * s), n / (s * s)].map(|g| g / (2.0 * cv));
            (cv, gradient)
        })
    }

    /// A measure of spread, of which `of` gives the value and the gradient in n, s and q from the
    /// standard deviation.
    fn spread(&self, unit: Replicate, of: impl Fn([f64; 3], f64) -> (f64, [f64; 3])) -> Measured {
        let LawSums {
            units,
            contributing,
            ..
        } = self;
        let [n, s, q] = units.mean;
        // A single value has no spread.
        if n * (units.count * unit.size()) as f64 <= 1.5 {
            return Measured::NOTHING;
        }
        let (mean, mean_square) = (s / n, q / n);
        let variance = mean_square - mean * mean;
        if variance <= 64.0 * f64::EPSILON * mean_square {
            return Measured::smooth(0.0, units, [0.0; 3], *contributing);
        }
        let (value, gradient) = of(units.mean, variance.sqrt());
        let error = Measured::smooth(value, units, gradient, *contributing)
            .measurement()
            .standard_error;
        let law = cautious(
            self.sd_tails.error_law(*contributing),
            *contributing,
            units.count,
        );
        let spread = Measured::spread(value, error, law, *contributing);
        if *contributing < FEWEST_FOR_PHASES {
            spread.without_interval()
        } else {
            spread
        }
    }
}

/// A mean over events, as a ratio of sums over units, of which these contribute.
pub(super) fn rare_ratio<const N: usize>(
    units: &JointMoments<N>,
    top: usize,
    bottom: usize,
    tails: &Powers,
    contributing: u64,
) -> Measured {
    let measured = Measured::ratio(units, top, bottom, contributing);
    let mut influence = [0.0; N];
    (influence[top], influence[bottom]) = (1.0, -measured.estimate());
    rare(
        measured,
        units,
        influence,
        (tails, contributing),
        contributing,
    )
}

/// A number of events per path, of which these units have any.
pub(super) fn rare_mean<const N: usize>(
    units: &JointMoments<N>,
    entry: usize,
    tails: &Powers,
    contributing: u64,
) -> Measured {
    let mut influence = [0.0; N];
    influence[entry] = 1.0;
    rare(
        Measured::mean_of(units, entry),
        units,
        influence,
        (tails, units.count),
        contributing,
    )
}

/// A measured number with the interval of one that few units may contribute to. The tails are those
/// of this many units.
fn rare<const N: usize>(
    measured: Measured,
    units: &JointMoments<N>,
    influence: [f64; N],
    (tails, of): (&Powers, u64),
    contributing: u64,
) -> Measured {
    if are_too_few(contributing, units.count, FEWEST) {
        return measured.without_interval();
    }
    let law = tails.error_law(measured.estimate(), units.spread_along(influence), of);
    measured.with_law(cautious(law, contributing, units.count))
}
