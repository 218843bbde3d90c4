//! The zero of the displacement sensor, which jumps when it is reset and drifts with age.
//!
//! The middles of the jumps of z, minus still T, lie on a line over the temperature (`fit.rs`). If
//! the zero moves, they deviate from that line: by a step at the time of the reset, or in
//! proportion to time. Steps and a drift are additional columns of the same regression, if needed.

use crate::linear::Normal;
use std::cmp::Ordering;

/// Which movements of the zero are fitted.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ZeroColumns {
    /// The time of the first sample, the origin of a drift.
    pub start: f64,
    /// Times of steps.
    pub steps: Vec<f64>,
    /// Whether there is a drift.
    pub drifts: bool,
}

/// How the zero of the sensor moves, in seconds and the unit of displacement.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Zero {
    /// The time from which the drift counts.
    pub start: f64,
    /// The drift per second; 0 if none is detected.
    pub drift: f64,
    /// Steps in order of time: when, and by how much.
    pub steps: Vec<(f64, f64)>,
}

/// Seconds of a year.
const YEAR: f64 = 365.25 * 86_400.0;

impl Zero {
    /// A zero that drifts by this much per year from `start` on, and may be reset once.
    pub fn moving(start: f64, per_year: f64, set: Option<(f64, f64)>) -> Self {
        Zero {
            start,
            drift: per_year / YEAR,
            steps: set.into_iter().collect(),
        }
    }

    /// The zero at this time, relative to the start.
    pub fn at(&self, time: f64) -> f64 {
        let stepped: f64 = self
            .steps
            .iter()
            .filter(|(when, _)| *when < time)
            .map(|(_, size)| size)
            .sum();
        self.drift * (time - self.start) + stepped
    }

    /// The drift in a year.
    pub fn drift_per_year(&self) -> f64 {
        self.drift * YEAR
    }
}

/// The middle of a jump: its time, its temperature, and its value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Middle {
    /// The time of the jump.
    pub time: f64,
    /// T -+ (A - G/2).
    pub centre: f64,
    /// z - still T.
    pub place: f64,
    /// The change of the centre by each function of varying friction.
    pub course: [f64; 2],
}

/// What a change of direction adds to the middles if friction varies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Turn {
    /// The change of temperature, less its mean.
    pub change: f64,
    /// Minus the contribution of each function of varying friction to it.
    pub course: [f64; 2],
}

/// All middles, and the changes of direction.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Middles {
    /// The middles in order of time.
    pub all: Vec<Middle>,
    turns: Vec<Turn>,
    /// Number of functions of varying friction.
    columns: usize,
    /// The weight of a turn relative to that of a middle.
    weight: f64,
}

impl Middles {
    /// These middles and turns, which are weighted with their residuals about the line of this zero.
    pub fn of(all: Vec<Middle>, turns: Vec<Turn>, columns: usize, zero: &ZeroColumns) -> Self {
        let mut middles = Middles {
            all,
            turns,
            columns,
            weight: 0.0,
        };
        for _ in 0..if columns > 0 { WEIGHTINGS } else { 0 } {
            let Some(line) = zero.line(&middles) else {
                break;
            };
            let off = |turn: &Turn| {
                let of_course = turn.course[0] * line.course[0] + turn.course[1] * line.course[1];
                (line.slope * (turn.change + of_course)).powi(2)
            };
            let of_turn = middles.turns.iter().map(off).sum::<f64>() / middles.turns.len() as f64;
            // Middles of a day have the same noise.
            middles.weight = line.squares / middles.days() as f64 / of_turn;
        }
        middles
    }

    /// Number of days with a middle.
    fn days(&self) -> usize {
        let is_same_day =
            |a: &Middle, b: &Middle| libm::floor(a.time / DAY) == libm::floor(b.time / DAY);
        self.all.chunk_by(is_same_day).count()
    }
}

/// Number of times that the weights are computed.
const WEIGHTINGS: u32 = 3;

/// A line through middles: place = offset + slope (centre + course) + zero(time).
#[derive(Clone, Debug, PartialEq)]
pub struct MiddleLine {
    pub offset: f64,
    pub slope: f64,
    pub zero: Zero,
    /// The coefficients of A - G/2 as a function of time, in kelvin.
    pub course: [f64; 2],
    /// The sum of the squares of the residuals of middles.
    squares: f64,
}

/// Threshold of twice the log-likelihood ratio for a step. The noise of the sensor is correlated
/// from slip to slip, and the best of some hundred places of a step is chosen. In 400 synthetic
/// records whose zero did not move, neither a step nor a drift was found.
const STEP: f64 = 40.0;

/// The same for a drift, which needs no choice of place.
const DRIFT: f64 = 20.0;

/// The same as a multiple of random gains: that of one column exceeds 15 once in ten thousand
/// records, and the best of some hundred places of a step is chosen.
const CLEAR_STEP: f64 = 25.0;
const CLEAR_DRIFT: f64 = 15.0;

/// Middles within this time, in seconds, count as one, because slow noise of the sensor is the same
/// in them.
const DAY: f64 = 86_400.0;

/// A step must have at least this many jumps on each side.
const BESIDE: usize = 5;

/// The most steps of a record.
const MOST: usize = 8;

impl ZeroColumns {
    /// The movements that these middles require. `candidates` are the times at which the zero may
    /// have been set: those of jumps, and the ends of gaps.
    pub fn asked_by(middles: &Middles, candidates: &[f64], start: f64) -> Self {
        let mut columns = ZeroColumns {
            start,
            ..ZeroColumns::default()
        };
        let sides = |when: f64| {
            middles
                .all
                .iter()
                .filter(|middle| middle.time < when)
                .count()
        };
        let is_inside = |when: &f64| {
            (BESIDE..=middles.all.len().saturating_sub(BESIDE)).contains(&sides(*when))
        };
        let places: Vec<f64> = candidates.iter().copied().filter(is_inside).collect();
        // A step can resemble a drift, and a drift several steps. So the one with the larger gain
        // above its threshold is taken first, and movements made unnecessary by later ones are
        // removed.
        while columns.steps.len() < MOST {
            let more = columns.more(&places);
            let best = more
                .into_iter()
                .map(|more| (more.gain_over(&columns, middles), more));
            let Some((_, next)) = best
                .filter(|(gain, _)| *gain > 0.0)
                .max_by(|a, b| a.0.total_cmp(&b.0))
            else {
                break;
            };
            columns = next;
        }
        while let Some(less) = columns
            .less()
            .into_iter()
            .find(|less| columns.gain_over(less, middles) <= 0.0)
        {
            columns = less;
        }
        columns.steps.sort_by(f64::total_cmp);
        columns
    }

    /// The same with one more movement: a step at one of these places, or a drift.
    fn more(&self, places: &[f64]) -> Vec<Self> {
        let steps = places
            .iter()
            .filter(|place| !self.steps.contains(place))
            .map(|place| {
                let steps = self.steps.iter().copied().chain([*place]).collect();
                ZeroColumns {
                    steps,
                    ..self.clone()
                }
            });
        let drift = (!self.drifts).then(|| ZeroColumns {
            drifts: true,
            ..self.clone()
        });
        steps.chain(drift).collect()
    }

    /// The same with one movement fewer.
    fn less(&self) -> Vec<Self> {
        let without = |i: usize| {
            let steps = self
                .steps
                .iter()
                .enumerate()
                .filter(|(j, _)| i != *j)
                .map(|(_, step)| *step)
                .collect();
            ZeroColumns {
                steps,
                ..self.clone()
            }
        };
        let steps = (0..self.steps.len()).map(without);
        steps
            .chain(self.drifts.then(|| ZeroColumns {
                drifts: false,
                ..self.clone()
            }))
            .collect()
    }

    /// Twice the log-likelihood ratio of these columns to fewer of them, minus the threshold.
    fn gain_over(&self, fewer: &Self, middles: &Middles) -> f64 {
        let price = if self.drifts == fewer.drifts {
            STEP
        } else {
            DRIFT
        };
        let gain = self.plain_gain_over(fewer, middles) - price;
        if gain.is_nan() {
            f64::NEG_INFINITY
        } else {
            gain
        }
    }

    fn plain_gain_over(&self, fewer: &Self, middles: &Middles) -> f64 {
        let squares = |columns: &Self| columns.line(middles).map_or(f64::NAN, |line| line.squares);
        middles.days() as f64 * libm::log(squares(fewer) / squares(self))
    }

    /// Twice the log-likelihood ratio of these columns to none.
    pub fn gain(&self, middles: &Middles) -> f64 {
        self.plain_gain_over(&self.none(), middles)
    }

    /// The same zero without movements.
    pub fn none(&self) -> Self {
        ZeroColumns {
            start: self.start,
            ..ZeroColumns::default()
        }
    }

    /// Whether a gain is convincing, if it is `chance` on average in records whose zero does not
    /// move. Random gains exceed 1 per column if the noise of the sensor is the same in slips of
    /// several days.
    pub fn is_convincing(&self, gain: f64, chance: f64) -> bool {
        let columns = self.steps.len() + usize::from(self.drifts);
        let least =
            CLEAR_STEP * self.steps.len() as f64 + f64::from(u8::from(self.drifts)) * CLEAR_DRIFT;
        columns == 0 || gain * columns as f64 > least * chance.max(columns as f64)
    }

    /// The line of least squares; `None` if the middles do not determine it.
    pub fn line(&self, middles: &Middles) -> Option<MiddleLine> {
        let n = 2 + usize::from(self.drifts) + self.steps.len() + middles.columns;
        let (of_steps, of_course) = (2 + usize::from(self.drifts), n - middles.columns);
        let row = |middle: &Middle| {
            let mut row = vec![1.0, middle.centre];
            if self.drifts {
                row.push((middle.time - self.start) / YEAR);
            }
            // A jump at the time of a step has its middle half-way.
            let stepped = |when: &f64| match when.total_cmp(&middle.time) {
                Ordering::Less => 1.0,
                Ordering::Equal => 0.5,
                Ordering::Greater => 0.0,
            };
            row.extend(self.steps.iter().map(stepped));
            row.extend(&middle.course[..middles.columns]);
            row
        };
        let mut normal = Normal::of(n);
        for middle in &middles.all {
            normal.add(&row(middle), middle.place, 1.0);
        }
        for turn in middles.turns.iter().filter(|_| middles.weight > 0.0) {
            let mut row = vec![0.0; of_course];
            row[1] = turn.change;
            row.extend(&turn.course[..middles.columns]);
            normal.add(&row, 0.0, middles.weight);
        }
        let found = normal.solve()?;
        let off = |middle: &Middle| {
            let at: f64 = found.iter().zip(row(middle)).map(|(a, b)| a * b).sum();
            (middle.place - at).powi(2)
        };
        let drift = if self.drifts { found[2] / YEAR } else { 0.0 };
        let sizes = found[of_steps..of_course].iter().copied();
        let zero = Zero {
            start: self.start,
            drift,
            steps: self.steps.iter().copied().zip(sizes).collect(),
        };
        let mut course = [0.0; 2];
        course
            .iter_mut()
            .zip(&found[of_course..])
            .for_each(|(course, of)| *course = of / found[1]);
        Some(MiddleLine {
            offset: found[0],
            slope: found[1],
            zero,
            course,
            squares: middles.all.iter().map(off).sum(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use stickslip::noise::Stream;

    /// Two hundred middles on a line, with noise of 0.15 mm, whose zero was set by 2 mm after a
    /// third of a year, and which drifts by 1 mm in a year. Without movement none is found, in ten
    /// records; with it the step is found at its place, and the numbers are within five standard
    /// errors of the truth.
    #[test]
    fn a_step_and_a_drift_are_found_where_they_are() {
        for seed in 0..10 {
            let mut random = Stream::new(seed, 3);
            let middle = |i: usize, random: &mut Stream, step: f64, drift: f64| {
                let time = 86_400.0 * (100.0 + 1.5 * i as f64);
                let centre = 10.0 + 9.0 * libm::sin(0.02 * i as f64) + 4.0 * random.normal();
                let moved =
                    if i >= 80 { step } else { 0.0 } + drift * (time - 100.0 * 86_400.0) / YEAR;
                Middle {
                    time,
                    centre,
                    place: 0.003 + 3e-4 * centre + moved + 1.5e-4 * random.normal(),
                    course: [0.0; 2],
                }
            };
            let still: Vec<Middle> = (0..200).map(|i| middle(i, &mut random, 0.0, 0.0)).collect();
            let times: Vec<f64> = still.iter().map(|middle| middle.time).collect();
            let alone = |all| Middles {
                all,
                ..Middles::default()
            };
            let start = times[0];
            assert_eq!(
                ZeroColumns::asked_by(&alone(still), &times, start),
                ZeroColumns {
                    start,
                    ..ZeroColumns::default()
                }
            );
            let moving: Vec<Middle> = (0..200)
                .map(|i| middle(i, &mut random, 2e-3, 1e-3))
                .collect();
            let moving = alone(moving);
            let columns = ZeroColumns::asked_by(&moving, &times, start);
            assert!(columns.drifts && columns.steps.len() == 1, "{columns:?}");
            let line = columns.line(&moving).expect("determined");
            let [(when, size)] = line.zero.steps[..] else {
                panic!("one step")
            };
            assert!((when - times[79]).abs() < 3.0 * 86_400.0, "{when}");
            assert!(
                (size - 2e-3).abs() < 2e-4 && (line.zero.drift_per_year() - 1e-3).abs() < 5e-4,
                "{line:?}"
            );
            assert!((line.slope - 3e-4).abs() < 1e-5, "{line:?}");
            let end = line.zero.at(start + 0.8 * YEAR);
            assert!((end - 2e-3 - 0.8e-3).abs() < 3e-4, "{end}");
        }
    }
}
