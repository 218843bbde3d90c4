//! When a simulation is looked at: the output grid, the whole forcing periods, the end.

/// The instants at which every path is observed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Timeline {
    /// t_end >= 0.
    pub end: f64,
    /// Spacing of the output grid 0, s, 2s, ... <= t_end.
    pub output_step: f64,
    /// P: the forcing period, if there is one.
    pub period: Option<f64>,
}

/// Why the paths are looked at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Instant {
    /// Row `k` of the output grid, t = k output_step.
    Output(usize),
    /// The end of forcing period `n` = 1, 2, ..., t = n P.
    Period(usize),
    /// t_end.
    End,
}

/// One instant with its time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stop {
    /// t.
    pub time: f64,
    /// Why.
    pub instant: Instant,
}

/// How far beyond the end, relative to it, a grid time may fall by rounding and still count as the end.
const END_TOLERANCE: f64 = 1e-9;

impl Timeline {
    /// The same with no row but the first.
    pub fn without_rows(&self) -> Self {
        Timeline { output_step: 2.0 * self.end, ..*self }
    }

    /// Times of the output grid, row by row.
    pub fn output_times(&self) -> Vec<f64> {
        (0..self.rows()).map(|k| self.output_time(k)).collect()
    }

    /// Number of rows of the output grid.
    pub fn rows(&self) -> usize {
        whole(self.end, self.output_step) + 1
    }

    /// Number of whole forcing periods up to the end.
    pub fn periods(&self) -> usize {
        self.period.map_or(0, |p| whole(self.end, p))
    }

    /// All stops in time order; at equal times, output before period before end.
    pub fn stops(&self) -> impl Iterator<Item = Stop> + use<> {
        let this = *self;
        let (rows, periods) = (this.rows(), this.periods());
        let (mut k, mut n, mut ended) = (0, 1, false);
        std::iter::from_fn(move || {
            let output = (k < rows).then(|| this.output_time(k));
            let period = (n <= periods).then(|| (n as f64 * this.period.unwrap_or(0.0)).min(this.end));
            match (output, period) {
                (Some(t), p) if p.is_none_or(|p| t <= p) => {
                    k += 1;
                    Some(Stop { time: t, instant: Instant::Output(k - 1) })
                }
                (_, Some(t)) => {
                    n += 1;
                    Some(Stop { time: t, instant: Instant::Period(n - 1) })
                }
                _ if !ended => {
                    ended = true;
                    Some(Stop { time: this.end, instant: Instant::End })
                }
                _ => None,
            }
        })
    }

    fn output_time(&self, k: usize) -> f64 {
        (k as f64 * self.output_step).min(self.end)
    }
}

/// The largest n with n * part <= total, rounding forgiven.
fn whole(total: f64, part: f64) -> usize {
    (total / part * (1.0 + END_TOLERANCE)).floor() as usize
}
