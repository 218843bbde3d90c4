//! A statistic of a user's own: numbers that each path comes down to, and what is estimated from
//! their means.
//!
//! ```text
//! Tally           start, event, row, end: one path -> N numbers
//!   -> PathMeans  their means and co-moments over all paths, merged along the tree of sums
//!     -> Tally::estimate -> Measurement   with an interval whose independent unit is the path
//! ```

use super::Measurement;
use super::codec::codec_of_fields;
use super::interval::Measured;
use super::moments::JointMoments;
use super::tree::Merge;
use super::unit::Unit;
use crate::model::Event;
use crate::scheme::{Instant, Observer, Snapshot};

/// The state of one path at one time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathState {
    /// t.
    pub time: f64,
    /// x(t).
    pub displacement: f64,
    /// x'(t).
    pub velocity: f64,
    /// T(t), noise included.
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

/// N numbers of each path, and what is estimated from them. It is folded beside the statistics of
/// the program, block by block, and gives the same bits on any number of threads. It sees the whole
/// path: what [`after`](crate::scenario::Statistics::after) leaves out of the statistics of the
/// program is its own to leave out.
///
/// ```
/// use stick_slip::engine::Run;
/// use stick_slip::model::{Event, EventKind};
/// use stick_slip::scenario::Scenario;
/// use stick_slip::stats::{Measurement, PathMeans, PathState, Tally};
///
/// /// The mean number of slips to the right, per path.
/// struct SlipsToTheRight;
///
/// impl Tally<1> for SlipsToTheRight {
///     type Path = f64;
///     fn start(&self) -> f64 { 0.0 }
///     fn event(&self, slips: &mut f64, event: &Event) {
///         if let EventKind::SlipStarted(sign) = event.kind && sign.value() > 0.0 { *slips += 1.0; }
///     }
///     fn end(&self, slips: f64, _: PathState) -> [f64; 1] { [slips] }
///     fn estimate(&self, paths: &PathMeans<1>) -> Measurement { paths.mean(0) }
/// }
///
/// let mut scenario = Scenario::shipped("rho025")?;
/// scenario.ensemble.paths = 300;
/// let outcome = Run::of(&scenario).without_bias().tallied(&SlipsToTheRight)?;
/// let slips = outcome.tally;
/// assert!(slips.low < slips.estimate && slips.estimate < slips.high);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub trait Tally<const N: usize>: Sync {
    /// What is remembered of a path while it runs.
    type Path: Clone + Send;

    /// A path begins, at rest at x0.
    fn start(&self) -> Self::Path;

    /// Something happens to the path; events arrive in time order.
    fn event(&self, path: &mut Self::Path, event: &Event) {
        let _ = (path, event);
    }

    /// The path at a row of the output grid.
    fn row(&self, path: &mut Self::Path, state: PathState) {
        let _ = (path, state);
    }

    /// The path has reached t_end: its numbers. A path that diverged is never asked.
    fn end(&self, path: Self::Path, state: PathState) -> [f64; N];

    /// The estimate from the means over all paths, usually [`PathMeans::mean`] or
    /// [`PathMeans::ratio`].
    fn estimate(&self, paths: &PathMeans<N>) -> Measurement;
}

/// Means over paths of the numbers of a [`Tally`].
#[derive(Clone, Debug, PartialEq)]
pub struct PathMeans<const N: usize> {
    moments: JointMoments<N>,
    /// Units with a path whose number i is not zero.
    contributing: [u64; N],
}

codec_of_fields!(PathMeans<N> { moments, contributing }, N);

impl<const N: usize> Default for PathMeans<N> {
    fn default() -> Self {
        PathMeans { moments: JointMoments::default(), contributing: [0; N] }
    }
}

impl<const N: usize> PathMeans<N> {
    /// Of the numbers of consecutive paths, diverged ones left out.
    pub fn of(paths: &[[f64; N]], unit: Unit) -> Self {
        let column = |i: usize| unit.means(&paths.iter().map(|numbers| numbers[i]).collect::<Vec<f64>>()).into_owned();
        let columns: [Vec<f64>; N] = std::array::from_fn(column);
        PathMeans {
            moments: JointMoments::of(columns.each_ref().map(Vec::as_slice)),
            contributing: std::array::from_fn(|i| unit.count(paths, |numbers| numbers[i] != 0.0)),
        }
    }

    /// Number of independent units: paths, or antithetic pairs of them.
    pub fn units(&self) -> u64 {
        self.moments.count
    }

    /// The mean of number `i`, with the interval of Student's t.
    pub fn mean(&self, i: usize) -> Measurement {
        Measured::mean_of(&self.moments, i).measurement()
    }

    /// The mean of number `top` over the mean of number `bottom`: that of a pool, if `top` is the
    /// sum of what a path puts into it and `bottom` how many those are. Its interval is that of a
    /// ratio estimator (W. G. Cochran, *Sampling Techniques* (1977), chapter 6); paths whose
    /// `bottom` is zero say nothing about it.
    pub fn ratio(&self, top: usize, bottom: usize) -> Measurement {
        Measured::ratio(&self.moments, top, bottom, self.contributing[bottom]).measurement()
    }
}

impl<const N: usize> Merge for PathMeans<N> {
    fn merge(&mut self, other: &Self) {
        self.moments.merge(&other.moments);
        for (mine, more) in self.contributing.iter_mut().zip(&other.contributing) {
            *mine += more;
        }
    }
}

/// What watches each block beside the statistics of the program; `()` watches nothing and costs
/// nothing.
pub trait Companion: Sync {
    /// Shown one block of paths.
    type Observer: Observer;
    /// What a block leaves behind.
    type Sums: Merge + Clone + Send;

    /// The sums of no paths.
    fn empty(&self) -> Self::Sums;

    /// An observer of the paths of these numbers, ascending, a lane each.
    fn observer(&self, paths: &[u64]) -> Self::Observer;

    /// What it has seen, once its paths have reached t_end.
    fn finish(&self, observer: Self::Observer, unit: Unit) -> Self::Sums;
}

impl Companion for () {
    type Observer = ();
    type Sums = ();

    fn empty(&self) {}

    fn observer(&self, _: &[u64]) {}

    fn finish(&self, (): (), _: Unit) {}
}

/// A tally as a companion of every block.
pub struct Tallied<'a, T, const N: usize>(pub &'a T);

impl<'a, T: Tally<N>, const N: usize> Companion for Tallied<'a, T, N> {
    type Observer = TallyObserver<'a, T, N>;
    type Sums = PathMeans<N>;

    fn empty(&self) -> PathMeans<N> {
        PathMeans::default()
    }

    fn observer(&self, paths: &[u64]) -> Self::Observer {
        TallyObserver { tally: self.0, paths: paths.iter().map(|_| self.0.start()).collect(), numbers: Vec::new() }
    }

    fn finish(&self, observer: Self::Observer, unit: Unit) -> PathMeans<N> {
        PathMeans::of(&observer.numbers, unit)
    }
}

/// Shows the paths of a block to a tally.
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

    /// y = 2, 0, 5, 0, 5 over x = 1, 0, 2, 0, 3: R = 2, residuals 0, 1, -1 of the three paths that
    /// say anything, so the standard error is sqrt(3/2 * 2)/6, and Student's t has two degrees of
    /// freedom. The mean of y is over all five.
    #[test]
    fn paths_with_nothing_to_say_of_a_ratio_are_not_counted_in_its_interval() {
        let paths = PathMeans::of(&[[2.0, 1.0], [0.0, 0.0], [5.0, 2.0], [0.0, 0.0], [5.0, 3.0]], Unit::Path);
        let ratio = paths.ratio(0, 1);
        assert!((ratio.estimate - 2.0).abs() < 1e-15 && (ratio.standard_error - 3f64.sqrt() / 6.0).abs() < 1e-15);
        assert!((ratio.high - 2.0 - 4.302_652_729_9 * 3f64.sqrt() / 6.0).abs() < 1e-9, "{ratio:?}");
        // Squared deviations from 2.4: 0.16, 5.76, 6.76, 5.76, 6.76.
        let mean = paths.mean(0);
        assert!((mean.estimate - 2.4).abs() < 1e-15 && (mean.standard_error - (25.2f64 / 20.0).sqrt()).abs() < 1e-15);
        assert!((mean.high - 2.4 - 2.776_445_105_2 * mean.standard_error).abs() < 1e-9, "{mean:?}");
    }
}
