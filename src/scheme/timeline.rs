//! The instants at which a simulation is observed: the output grid, the ends of the
//! periods, the end of the burn-in, and the end.

/// The instants at which every path is observed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Timeline {
    /// t_end >= 0, the end of the run.
    pub end: f64,
    /// The spacing s of the output grid 0, s, 2s, ... <= t_end.
    pub output_step: f64,
    /// P, the time between the instants at which x is compared; none if it is not compared.
    pub period: Option<f64>,
    /// The end of the burn-in, from which on statistics count: 0 <= after < t_end, or 0.
    pub after: f64,
}

/// The reason for observing the paths at an instant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Instant {
    /// Row `k` of the output grid, t = k output_step.
    Output(usize),
    /// The end of period `n` = 1, 2, ..., t = n P.
    Period(usize),
    /// The end of the burn-in, if there is one: t = after.
    Counting,
    /// t_end.
    End,
}

/// An instant and its time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stop {
    /// t, a time.
    pub time: f64,
    /// The reason for observing the paths at this time.
    pub instant: Instant,
}

/// A time of the grid that lies beyond the end by at most this fraction, because of rounding, still
/// counts as the end.
const END_TOLERANCE: f64 = 1e-9;

impl Timeline {
    /// The fewest whole periods from which a lasting drift can be distinguished from the
    /// effect of the initial condition.
    pub const FEWEST_PERIODS: usize = 3;

    /// The same timeline with an output grid that has only its first row.
    pub fn without_rows(&self) -> Self {
        Timeline {
            output_step: 2.0 * self.end,
            ..*self
        }
    }

    /// The times of the output grid, row by row.
    pub fn output_times(&self) -> Vec<f64> {
        (0..self.rows()).map(|k| self.output_time(k)).collect()
    }

    /// The number of rows of the output grid.
    pub fn rows(&self) -> usize {
        whole(self.end, self.output_step) + 1
    }

    /// The first row of the output grid that is not before the end of the burn-in.
    pub fn first_row(&self) -> usize {
        (self.after / self.output_step * (1.0 - END_TOLERANCE)).ceil() as usize
    }

    /// The number of whole periods up to the end.
    pub fn periods(&self) -> usize {
        self.period.map_or(0, |p| whole(self.end, p))
    }

    /// The number of the first period n >= 1 whose end, n P, is not before the end of the
    /// burn-in.
    pub fn first_period(&self) -> usize {
        let passed = self
            .period
            .map_or(0.0, |p| (self.after / p * (1.0 - END_TOLERANCE)).ceil());
        (passed as usize).max(1)
    }

    /// The number of whole periods between the first and the last counted instant at which
    /// a period ends.
    pub fn counted_periods(&self) -> usize {
        self.periods().saturating_sub(self.first_period())
    }

    /// The length of time that is counted, from the end of the burn-in to the end.
    pub fn counted(&self) -> f64 {
        self.end - self.after
    }

    /// All stops in time order. At equal times, the order is output, period, counting, end.
    pub fn stops(&self) -> impl Iterator<Item = Stop> + use<> {
        let this = *self;
        let (rows, periods) = (this.rows(), this.periods());
        let (mut k, mut n, mut counts, mut ended) = (0, 1, this.after == 0.0, false);
        std::iter::from_fn(move || {
            let never = f64::INFINITY;
            let output = if k < rows { this.output_time(k) } else { never };
            let period = if n <= periods {
                (n as f64 * this.period.unwrap_or(0.0)).min(this.end)
            } else {
                never
            };
            let all = [
                (output, Instant::Output(k)),
                (period, Instant::Period(n)),
                (if counts { never } else { this.after }, Instant::Counting),
                (if ended { never } else { this.end }, Instant::End),
            ];
            // Of equal times the first one.
            let (time, instant) = all
                .into_iter()
                .min_by(|a, b| a.0.total_cmp(&b.0))
                .filter(|first| first.0 < never)?;
            match instant {
                Instant::Output(_) => k += 1,
                Instant::Period(_) => n += 1,
                Instant::Counting => counts = true,
                Instant::End => ended = true,
            }
            Some(Stop { time, instant })
        })
    }

    fn output_time(&self, k: usize) -> f64 {
        (k as f64 * self.output_step).min(self.end)
    }
}

/// The largest n with n * part <= total, where rounding errors are ignored.
fn whole(total: f64, part: f64) -> usize {
    (total / part * (1.0 + END_TOLERANCE)).floor() as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stops_come_in_time_order() {
        let line = Timeline {
            end: 7.0,
            output_step: 3.0,
            period: Some(2.0),
            after: 0.0,
        };
        let stops = |line: Timeline| {
            line.stops()
                .map(|stop| (stop.time, stop.instant))
                .collect::<Vec<_>>()
        };
        use Instant::{Counting, End, Output, Period};
        let without = [
            (0.0, Output(0)),
            (2.0, Period(1)),
            (3.0, Output(1)),
            (4.0, Period(2)),
            (6.0, Output(2)),
            (6.0, Period(3)),
            (7.0, End),
        ];
        assert_eq!(stops(line), without);
        for (after, place) in [(1.0, 1), (2.0, 2), (5.0, 4), (6.0, 6), (6.5, 6)] {
            let mut with = without.to_vec();
            with.insert(place, (after, Counting));
            assert_eq!(stops(Timeline { after, ..line }), with, "{after}");
        }
        let nothing = Timeline {
            end: 0.0,
            output_step: 1.0,
            period: Some(2.0),
            after: 0.0,
        };
        assert_eq!(stops(nothing), [(0.0, Output(0)), (0.0, End)]);
    }

    #[test]
    fn periods_count_from_the_first_or_the_burn_in() {
        let line = |after| Timeline {
            end: 60.0,
            output_step: 60.0,
            period: Some(0.1),
            after,
        };
        let counted = |after| (line(after).first_period(), line(after).counted_periods());
        assert_eq!(
            (counted(0.0), counted(0.1), counted(0.25)),
            ((1, 599), (1, 599), (3, 597))
        );
        // 3 * 0.1 is 0.30000000000000004.
        assert_eq!((counted(0.3), counted(59.95)), ((3, 597), (600, 0)));
        assert_eq!(
            Timeline {
                period: None,
                ..line(1.0)
            }
            .counted_periods(),
            0
        );
    }
}
