//! The force on the body, b(x, x', t) = K (beta T(t) - x) - 2 alpha x' + g(x, x', t), with times
//! that keep their digits over many periods.

use super::super::exact_time::ExactTime;
use crate::model::{Complex, ForcingTerm, InitialNoise, Model, Oscillator, Series};
use std::fmt;
use std::sync::Arc;

/// g(x, x', t).
type Law = dyn Fn(f64, f64, f64) -> f64 + Send + Sync;

/// A force on the body beside spring, damper and friction: a continuous, piecewise smooth function
/// g(x, x', t).
#[derive(Clone)]
pub struct BodyForce {
    law: Arc<Law>,
    /// Whether g depends on t.
    pub depends_on_time: bool,
}

impl BodyForce {
    /// The force g; `depends_on_time` says whether it depends on t.
    pub fn new(law: Arc<Law>, depends_on_time: bool) -> Self {
        BodyForce { law, depends_on_time }
    }

    /// g(x, x', t).
    pub fn at(&self, x: f64, v: f64, t: f64) -> f64 {
        (self.law)(x, v, t)
    }
}

impl fmt::Debug for BodyForce {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("BodyForce").field("depends_on_time", &self.depends_on_time).finish_non_exhaustive()
    }
}

/// All forces on the body but friction.
#[derive(Clone, Debug)]
pub struct Forces {
    oscillator: Oscillator,
    /// The terms of T.
    terms: Vec<ForcingTerm>,
    series: Option<Arc<Series>>,
    /// g.
    pub extra: BodyForce,
}

/// The temperature near a time: it is correct from this time up to the next sample.
#[derive(Clone, Debug)]
pub struct LocalTemperature {
    start: ExactTime,
    /// The value at the start and the rate of each term.
    terms: Vec<(Complex, Complex)>,
    /// S and S' at the start.
    line: (f64, f64),
    /// The duration until the next sample; infinite if there is none.
    pub until_sample: f64,
}

impl Forces {
    /// The forces of a model without its diffusion, and g.
    pub fn new(model: &Model, extra: BodyForce) -> Self {
        let harmonics = model.temperature.harmonics.iter().map(|h| ForcingTerm {
            amplitude: Complex::unit(h.phase) * h.amplitude,
            rate: Complex::new(0.0, h.angular_frequency),
        });
        let relaxing = model.temperature.noises().filter_map(|noise| match noise.initial {
            InitialNoise::At(v) => Some(ForcingTerm {
                amplitude: Complex::new(noise.intensity * v, 0.0),
                rate: Complex::new(-noise.relaxation_rate, 0.0),
            }),
            InitialNoise::Stationary => None,
        });
        let terms = harmonics.chain(relaxing).filter(|term| term.amplitude.abs() > 0.0).collect();
        Forces { oscillator: model.oscillator, terms, series: model.temperature.series.clone(), extra }
    }

    /// The fastest rate of the temperature.
    pub fn fastest_rate(&self) -> f64 {
        self.terms.iter().map(|term| term.rate.abs()).fold(0.0, f64::max)
    }

    /// Whether b at a fixed x and x' changes with time.
    pub fn depend_on_time(&self) -> bool {
        let temperature_changes = self.series.is_some() || self.fastest_rate() > 0.0;
        self.extra.depends_on_time || (temperature_changes && self.oscillator.force_per_temperature() != 0.0)
    }

    /// The temperature near a time.
    pub fn near(&self, start: ExactTime) -> LocalTemperature {
        let terms = self.terms.iter().map(|term| (start.phased(term), term.rate)).collect();
        let mut local = LocalTemperature { start, terms, line: (0.0, 0.0), until_sample: f64::INFINITY };
        if let Some(series) = self.series.as_deref() {
            let times = series.times();
            let mut piece = series.piece(start.value());
            // `start` has more digits than the double that found the piece.
            while piece + 2 < times.len() && start.until(times[piece + 1]) <= 0.0 {
                piece += 1;
            }
            let slope = series.slope(piece);
            local.line = (series.values()[piece] - slope * start.until(times[piece]), slope);
            if piece + 2 < times.len() {
                local.until_sample = start.until(times[piece + 1]);
            }
        }
        local
    }

    /// b for x and x' a duration after the start of `local`.
    pub fn at(&self, local: &LocalTemperature, x: f64, v: f64, after: f64) -> f64 {
        self.oscillator.force(local.after(after), x, v) + self.extra.at(x, v, local.start.after(after).value())
    }

    /// The sizes of all terms of b together. b is known up to the rounding of these.
    pub fn size(&self, local: &LocalTemperature, x: f64, v: f64, after: f64) -> f64 {
        let Oscillator { stiffness, damping, dilatation, .. } = self.oscillator;
        let spring = stiffness.abs() * ((dilatation * local.after(after)).abs() + x.abs());
        spring + (2.0 * damping * v).abs() + self.extra.at(x, v, local.start.after(after).value()).abs()
    }
}

impl LocalTemperature {
    /// The start.
    pub fn start(&self) -> ExactTime {
        self.start
    }

    /// T a duration after the start.
    fn after(&self, duration: f64) -> f64 {
        let terms = self.terms.iter().map(|(start, rate)| (*start * (*rate * duration).exp()).re);
        self.line.0 + self.line.1 * duration + terms.sum::<f64>()
    }
}
