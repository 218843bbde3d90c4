//! A user-defined statistic: a few numbers of each path, and an estimate from their means over
//! paths.
//!
//! ```text
//! Tally           start, event, row, end: one path -> N numbers
//!   -> PathMeans  their means and co-moments over all paths, merged along the tree of sums
//!     -> Tally::estimate -> Measurement   with an interval whose independent unit is the path
//! ```

use crate::model::Event;
use crate::noise::AddressedDraws;
use crate::scheme::{Instant, Observer, Snapshot};
use crate::sums::Measurement;
use crate::sums::Merge;
use crate::sums::Replicate;
use crate::sums::codec::sums_of_fields;
use crate::sums::interval::Measured;
use crate::sums::moments::JointMoments;
use crate::sums::range::Range;

/// The state of one path at one time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathState {
    /// Time t.
    pub time: f64,
    /// Displacement x(t).
    pub displacement: f64,
    /// Velocity x'(t).
    pub velocity: f64,
    /// Temperature T(t), noise included.
    pub temperature: f64,
    /// Whether the path is in a static phase at t.
    pub is_static: bool,
}

impl PathState {
    fn of(snapshot: &Snapshot<'_>, lane: usize) -> Self {
        PathState {
            time: snapshot.time,
            displacement: snapshot.displacement[lane],
            velocity: snapshot.velocity[lane],
            temperature: snapshot.temperature[lane],
            is_static: snapshot.is_static[lane],
        }
    }
}

/// N numbers of each path, and an estimate from their means. A tally is folded together with the
/// statistics of the program, block by block, and gives the same bits on any number of threads. It
/// observes the whole path: if it is to exclude the time before
/// [`after`](crate::scenario::Statistics::after), like the statistics of the program, it must do so
/// itself.
///
/// ```
/// use stickslip::engine::Run;
/// use stickslip::model::{Event, EventKind};
/// use stickslip::noise::AddressedDraws;
/// use stickslip::scenario::Scenario;
/// use stickslip::stats::{PathMeans, PathState, Tally};
/// use stickslip::sums::Measurement;
///
/// /// The mean number of slips to the right, per path.
/// struct SlipsToTheRight;
///
/// impl Tally<1> for SlipsToTheRight {
///     type Path = f64;
///     fn start(&self, _: AddressedDraws) -> f64 { 0.0 }
///     fn event(&self, slips: &mut f64, event: &Event) {
///         if let EventKind::SlipStarted(sign) = event.kind && sign.value() > 0.0 { *slips += 1.0; }
///     }
///     fn end(&self, slips: f64, _: PathState) -> [f64; 1] { [slips] }
///     fn estimate(&self, paths: &PathMeans<1>) -> Measurement { paths.mean(0) }
/// }
///
/// let mut scenario = Scenario::shipped("rho025")?;
/// scenario.ensemble.paths = 300;
/// let (_, slips) = Run::of(&scenario).without_bias().tallied(&SlipsToTheRight)?;
/// assert!(slips.low < slips.estimate && slips.estimate < slips.high);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub trait Tally<const N: usize>: Sync {
    /// The state of the tally for a path while it is simulated.
    type Path: Clone + Send;

    /// The state at the start of a path, which is at rest at x0. `draws` are random numbers of this
    /// path that its noise does not use, for a statistic that needs its own. They are a generator
    /// of `rand_core`: `rand_distr` draws any law from them. The two paths of an antithetic pair
    /// have different ones.
    fn start(&self, draws: AddressedDraws) -> Self::Path;

    /// Takes an event of the path. Events arrive in time order. By default nothing is done.
    fn event(&self, _path: &mut Self::Path, _event: &Event) {}

    /// Takes the state of the path at a row of the output grid. By default nothing is done.
    fn row(&self, _path: &mut Self::Path, _state: PathState) {}

    /// The numbers of a path that has reached t_end. It is not called for a path that diverged.
    fn end(&self, path: Self::Path, state: PathState) -> [f64; N];

    /// The estimate from the means over all paths, usually [`PathMeans::mean`] or
    /// [`PathMeans::ratio`].
    fn estimate(&self, paths: &PathMeans<N>) -> Measurement;
}

/// Means over paths of the numbers of a [`Tally`].
#[derive(Clone, Debug, PartialEq)]
pub struct PathMeans<const N: usize> {
    moments: JointMoments<N>,
    /// For each i, the number of units with a path whose number i is not zero.
    contributing: [u64; N],
    /// For each i and j, the number of paths whose number i is not from zero to their number j.
    beyond: [[u64; N]; N],
}

sums_of_fields!(PathMeans<N> { moments, contributing, beyond }, N);

impl<const N: usize> Default for PathMeans<N> {
    fn default() -> Self {
        PathMeans {
            moments: JointMoments::default(),
            contributing: [0; N],
            beyond: [[0; N]; N],
        }
    }
}

impl<const N: usize> PathMeans<N> {
    /// The means of the numbers of consecutive paths, without diverged ones.
    pub fn of(paths: &[[f64; N]], unit: Replicate) -> Self {
        let columns: [Vec<f64>; N] =
            std::array::from_fn(|i| unit.column(paths, |numbers| numbers[i]));
        let count = |is: &dyn Fn(&[f64; N]) -> bool| {
            paths.iter().filter(|numbers| is(numbers)).count() as u64
        };
        PathMeans {
            moments: JointMoments::of(columns.each_ref().map(Vec::as_slice)),
            contributing: std::array::from_fn(|i| unit.count(paths, |numbers| numbers[i] != 0.0)),
            beyond: std::array::from_fn(|i| {
                std::array::from_fn(|j| count(&|of| !(0.0..=of[j]).contains(&of[i])))
            }),
        }
    }

    /// Number of independent units: paths, or antithetic pairs of paths.
    pub fn units(&self) -> u64 {
        self.moments.count
    }

    /// The mean of number `i`, with the interval of Student's t.
    pub fn mean(&self, i: usize) -> Measurement {
        Measured::mean_of(&self.moments, i).measurement()
    }

    /// The mean of number `top` divided by the mean of number `bottom`. This is the mean of a pool
    /// if `top` is the sum of what a path contributes to the pool and `bottom` is the number of
    /// these contributions. The interval is that of a ratio estimator (W. G. Cochran, *Sampling
    /// Techniques* (1977), chapter 6). Paths whose `bottom` is zero contain no information about
    /// it. Where `top` is a part of `bottom` in every path, the ratio is a share, and its interval
    /// ends at 0 and 1.
    pub fn ratio(&self, top: usize, bottom: usize) -> Measurement {
        let found =
            Measured::ratio(&self.moments, top, bottom, self.contributing[bottom]).measurement();
        let range = if self.beyond[top][bottom] == 0 {
            Range::SHARE
        } else {
            Range::ANY
        };
        let [low, high] = range.clip([found.low, found.high]);
        Measurement { low, high, ..found }
    }
}

/// Observes each block in addition to the statistics of the program. `()` observes nothing and
/// takes no time.
pub trait AuxiliaryObserver: Sync {
    /// The observer of one block of paths.
    type Observer: Observer;
    /// The sums over the paths of a block.
    type Sums: Merge + Clone + Send;

    /// The sums of no paths.
    fn empty(&self) -> Self::Sums;

    /// An observer of the paths with these numbers, in ascending order, one lane each.
    fn observer(&self, paths: &[u64]) -> Self::Observer;

    /// The sums of the block, once its paths have reached t_end.
    fn finish(&self, observer: Self::Observer, unit: Replicate) -> Self::Sums;
}

impl AuxiliaryObserver for () {
    type Observer = ();
    type Sums = ();

    fn empty(&self) {}

    fn observer(&self, _: &[u64]) {}

    fn finish(&self, (): (), _: Replicate) {}
}

/// A tally as the auxiliary of every block.
pub struct Tallied<'a, T, const N: usize> {
    /// The tally.
    pub tally: &'a T,
    /// The seed of the ensemble, from which the tally has its random numbers.
    pub seed: u64,
}

impl<'a, T: Tally<N>, const N: usize> AuxiliaryObserver for Tallied<'a, T, N> {
    type Observer = TallyObserver<'a, T, N>;
    type Sums = PathMeans<N>;

    fn empty(&self) -> PathMeans<N> {
        PathMeans::default()
    }

    fn observer(&self, paths: &[u64]) -> Self::Observer {
        let start = |&path| self.tally.start(AddressedDraws::auxiliary(self.seed, path));
        TallyObserver {
            tally: self.tally,
            paths: paths.iter().map(start).collect(),
            numbers: Vec::new(),
        }
    }

    fn finish(&self, observer: Self::Observer, unit: Replicate) -> PathMeans<N> {
        PathMeans::of(&observer.numbers, unit)
    }
}

/// Passes the paths of a block to a tally.
pub struct TallyObserver<'a, T: Tally<N>, const N: usize> {
    tally: &'a T,
    paths: Vec<T::Path>,
    numbers: Vec<[f64; N]>,
}

impl<T: Tally<N>, const N: usize> Observer for TallyObserver<'_, T, N> {
    fn event(&mut self, lane: usize, event: Event) {
        self.tally.event(&mut self.paths[lane], &event);
    }

    fn snapshot(&mut self, instant: Instant, snapshot: Snapshot<'_>) {
        match instant {
            Instant::Output(_) => {
                for (lane, path) in self.paths.iter_mut().enumerate() {
                    self.tally.row(path, PathState::of(&snapshot, lane));
                }
            }
            Instant::Period(_) | Instant::Counting => {}
            Instant::End => {
                let paths = std::mem::take(&mut self.paths).into_iter().enumerate();
                let end = |(lane, path)| self.tally.end(path, PathState::of(&snapshot, lane));
                self.numbers = paths.map(end).collect();
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// y = 2, 0, 5, 0, 5 over x = 1, 0, 2, 0, 3 gives R = 2. The three paths that contribute have
    /// the residuals 0, 1, -1. So the standard error is sqrt(3/2 * 2)/6, and Student's t has two
    /// degrees of freedom. The mean of y is over all five paths.
    #[test]
    fn paths_outside_a_ratio_do_not_count_in_its_interval() {
        let paths = PathMeans::of(
            &[[2.0, 1.0], [0.0, 0.0], [5.0, 2.0], [0.0, 0.0], [5.0, 3.0]],
            Replicate::Path,
        );
        let ratio = paths.ratio(0, 1);
        assert!(
            (ratio.estimate - 2.0).abs() < 1e-15
                && (ratio.standard_error - 3f64.sqrt() / 6.0).abs() < 1e-15
        );
        assert!(
            (ratio.high - 2.0 - 4.302_652_729_9 * 3f64.sqrt() / 6.0).abs() < 1e-9,
            "{ratio:?}"
        );
        // The squared deviations from 2.4 are 0.16, 5.76, 6.76, 5.76, 6.76.
        let mean = paths.mean(0);
        assert!(
            (mean.estimate - 2.4).abs() < 1e-15
                && (mean.standard_error - (25.2f64 / 20.0).sqrt()).abs() < 1e-15
        );
        assert!(
            (mean.high - 2.4 - 2.776_445_105_2 * mean.standard_error).abs() < 1e-9,
            "{mean:?}"
        );
    }
}
