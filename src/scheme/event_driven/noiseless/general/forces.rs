//! The force on the body, b(x, x', t) = K (beta T(t) - x) - 2 alpha x' + g(x, x', t), with times
//! that keep their precision over many periods.

use super::super::super::user_force::UserForce;
use super::super::exact_time::ExactTime;
use crate::model::{Complex, ForcingTerm, Hold, InitialNoise, Oscillator, Problem, Series, Sign};
use std::sync::Arc;

/// All forces on the body but friction.
#[derive(Clone, Debug)]
pub struct Forces {
    oscillator: Oscillator,
    /// The terms of T.
    terms: Vec<ForcingTerm>,
    series: Option<Arc<Series>>,
    /// The constant and the trend of T.
    line: [f64; 2],
    /// g.
    pub own: UserForce,
    /// Its kinks, in order.
    kinks: Arc<[f64]>,
}

/// The temperature near a time: it is correct from this time up to the next kink.
#[derive(Clone, Debug)]
pub struct LocalTemperature {
    pub start: ExactTime,
    /// The value at the start and the rate of each term.
    terms: Vec<(Complex, Complex)>,
    /// The line and the series, and their slope, at the start.
    line: (f64, f64),
    /// The duration until the next sample of the temperature or kink of g; infinite if there is
    /// none.
    pub until_kink: f64,
}

impl Forces {
    /// The forces of a model without its diffusion.
    pub fn new(model: &Problem) -> Self {
        let harmonics = model.temperature.harmonics.iter().map(|h| ForcingTerm {
            amplitude: Complex::unit(h.phase) * h.amplitude,
            rate: Complex::new(0.0, h.angular_frequency),
        });
        let relaxing =
            model
                .temperature
                .effective_noises()
                .filter_map(|noise| match noise.initial {
                    InitialNoise::At(v) => Some(ForcingTerm {
                        amplitude: Complex::new(noise.intensity * v, 0.0),
                        rate: Complex::new(-noise.relaxation_rate, 0.0),
                    }),
                    InitialNoise::Stationary => None,
                });
        let terms = harmonics
            .chain(relaxing)
            .filter(|term| term.amplitude.abs() > 0.0)
            .collect();
        let Problem {
            oscillator,
            temperature,
            ..
        } = model;
        let (series, line) = (
            temperature.series.clone(),
            [temperature.offset, temperature.trend],
        );
        Forces {
            oscillator: *oscillator,
            terms,
            series,
            line,
            own: UserForce::of(model),
            kinks: Arc::new([]),
        }
    }

    /// The same with the kinks from 0 to `end`, among them what steps of this length would pass by.
    pub fn with_kinks(mut self, end: f64, step: f64) -> Self {
        self.kinks = self.own.kinks(end, step).into();
        self
    }

    /// The fastest rate of the temperature, and of g until `end`.
    pub fn fastest_rate(&self, end: f64) -> f64 {
        self.terms
            .iter()
            .map(|term| term.rate.abs())
            .fold(self.own.fastest_rate(end), f64::max)
    }

    /// By how much b at rest and its limit change within some roundings of the time, where there
    /// are kinks: no time scale shows how steep it is here.
    pub fn rounding_of_inputs(&self, x: f64, t: f64) -> f64 {
        if self.kinks.is_empty() {
            return 0.0;
        }
        let rounding = 2.0 * f64::EPSILON * t;
        // Both sides are compared with the middle, because a peak is equally high on both.
        let [before, here, after] = [t - rounding, t, t + rounding].map(|t| self.own.hold(x, t));
        let change = |a: Hold, b: Hold| {
            let of_limits = [0, 1].map(|i| (b.excess[i] - a.excess[i]).abs());
            (b.pull - a.pull).abs() + of_limits[0].max(of_limits[1])
        };
        change(before, here) + change(here, after)
    }

    /// Whether b at a fixed x and x' changes with time.
    pub fn depend_on_time(&self) -> bool {
        let temperature_changes = self.series.is_some()
            || self.line[1] != 0.0
            || self.terms.iter().any(|term| term.rate.abs() > 0.0);
        self.own.depends_on_time()
            || (temperature_changes && self.oscillator.force_per_temperature() != 0.0)
    }

    /// The temperature near a time.
    pub fn near(&self, start: ExactTime) -> LocalTemperature {
        let terms = self
            .terms
            .iter()
            .map(|term| (start.phased(term), term.rate))
            .collect();
        let [offset, trend] = self.line;
        let line = (offset + trend * start.value(), trend);
        let mut local = LocalTemperature {
            start,
            terms,
            line,
            until_kink: f64::INFINITY,
        };
        if let Some(series) = self.series.as_deref() {
            let times = series.times();
            let piece = passed(times, start).clamp(1, times.len() - 1) - 1;
            let slope = series.slope(piece);
            local.line.0 += series.values()[piece] - slope * start.until(times[piece]);
            local.line.1 += slope;
            if piece + 2 < times.len() {
                local.until_kink = start.until(times[piece + 1]);
            }
        }
        if let Some(kink) = self.kinks.get(passed(&self.kinks, start)) {
            local.until_kink = local.until_kink.min(start.until(*kink));
        }
        local
    }

    /// b for x and x' a duration after the start of `local`, with the g of [`UserForce::at`].
    pub fn at(
        &self,
        local: &LocalTemperature,
        direction: Option<Sign>,
        [x, v]: [f64; 2],
        after: f64,
    ) -> f64 {
        self.oscillator.force(local.after(after), x, v)
            + self
                .own
                .at(direction, x, v, local.start.after(after).value())
    }

    /// b in a stick at x, and how much the limits of b and -b exceed f_s.
    pub fn held(&self, local: &LocalTemperature, x: f64, after: f64) -> (f64, [f64; 2]) {
        let Hold { pull, excess } = self.own.hold(x, local.start.after(after).value());
        (
            self.oscillator.force(local.after(after), x, 0.0) + pull,
            excess,
        )
    }

    /// The sizes of all terms of b together. b is known up to the rounding of these.
    pub fn size(
        &self,
        local: &LocalTemperature,
        direction: Sign,
        [x, v]: [f64; 2],
        after: f64,
    ) -> f64 {
        let Oscillator { damping, .. } = self.oscillator;
        let spring = self
            .oscillator
            .force_bound(local.after(after).abs(), x.abs());
        spring
            + (2.0 * damping * v).abs()
            + self
                .own
                .at(Some(direction), x, v, local.start.after(after).value())
                .abs()
    }
}

/// How many of these times are not after the start, which has more digits than they have.
fn passed(times: &[f64], start: ExactTime) -> usize {
    let mut count = times.partition_point(|time| *time <= start.value());
    while times
        .get(count)
        .is_some_and(|time| start.until(*time) <= 0.0)
    {
        count += 1;
    }
    count
}

impl LocalTemperature {
    /// T a duration after the start.
    fn after(&self, duration: f64) -> f64 {
        let terms = self
            .terms
            .iter()
            .map(|(start, rate)| (*start * (*rate * duration).exp()).re);
        self.line.0 + self.line.1 * duration + terms.sum::<f64>()
    }
}
