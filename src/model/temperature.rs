//! What drives the oscillator: a sum of harmonics, what was measured, and one or two
//! Ornstein-Uhlenbeck noises on top.

use super::Series;
use std::f64::consts::TAU;
use std::sync::Arc;

/// a cos(w t + phi).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Harmonic {
    /// a.
    pub amplitude: f64,
    /// w >= 0.
    pub angular_frequency: f64,
    /// phi.
    pub phase: f64,
}

/// rho v(t) with dv = -theta v dt + sigma dW.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Noise {
    /// rho >= 0.
    pub intensity: f64,
    /// theta > 0.
    pub relaxation_rate: f64,
    /// sigma >= 0.
    pub diffusion: f64,
    /// v(0).
    pub initial: InitialNoise,
}

/// How v starts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum InitialNoise {
    /// At this value.
    At(f64),
    /// Drawn from the stationary law N(0, sigma^2 / (2 theta)); the first draw of the path's
    /// stream.
    Stationary,
}

impl Noise {
    /// sigma / sqrt(2 theta), the stationary standard deviation of v.
    pub fn stationary_sd(&self) -> f64 {
        self.diffusion / (2.0 * self.relaxation_rate).sqrt()
    }

    /// Whether rho v(t) differs from path to path: rho sigma > 0. Without diffusion v relaxes from
    /// v(0), the same for all.
    pub fn is_random(&self) -> bool {
        self.intensity * self.diffusion > 0.0
    }

    /// Whether rho v(t) is zero for ever: rho = 0, or v stays at zero.
    pub fn is_silent(&self) -> bool {
        let starts_at_zero = matches!(self.initial, InitialNoise::Stationary | InitialNoise::At(0.0));
        self.intensity == 0.0 || (self.diffusion == 0.0 && starts_at_zero)
    }
}

/// T(t) = sum_i a_i cos(w_i t + phi_i) + S(t) + sum_j rho_j v_j(t), with one noise or two.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Temperature {
    /// What is known in closed form.
    pub harmonics: Vec<Harmonic>,
    /// S, what was measured, if anything was. Clones of a model share it.
    pub series: Option<Arc<Series>>,
    /// Whether v is zero at every sample of the series: what the weather may have done in between,
    /// given that it was measured there.
    pub is_pinned: bool,
    /// The noise as it was written, if any; one that is zero for ever is kept, but see
    /// [`Temperature::effective_noise`].
    pub noise: Option<Noise>,
    /// Another noise, independent of the first: weather has a memory of hours and one of days.
    pub second_noise: Option<Noise>,
}

/// Cycles of the slowest harmonic in which the others are to come round.
pub const MOST_CYCLES: u32 = 1000;

/// How far, relative to it, a number of cycles may be from a whole one: rounding of decimal
/// fractions, no more.
const WHOLE: f64 = 1e-9;

impl Temperature {
    /// Whether T(t) differs from path to path, and with it all that follows from it. Else one path
    /// is the ensemble.
    pub fn is_random(&self) -> bool {
        self.noises().any(|noise| noise.is_random())
    }

    /// The noises that are not zero for ever: what is simulated. A scene without any draws no
    /// random number.
    pub fn noises(&self) -> impl Iterator<Item = Noise> {
        [self.noise, self.second_noise].into_iter().flatten().filter(|noise| !noise.is_silent())
    }

    /// The first of [`Temperature::noises`]; the only one for whoever asks
    /// [`Temperature::has_two_noises`] before.
    pub fn effective_noise(&self) -> Option<Noise> {
        self.noises().next()
    }

    /// Whether two noises are to be simulated.
    pub fn has_two_noises(&self) -> bool {
        self.noises().count() == 2
    }

    /// The harmonics and the series at time t, straight from their definition.
    pub fn deterministic(&self, t: f64) -> f64 {
        let harmonics: f64 =
            self.harmonics.iter().map(|h| h.amplitude * libm::cos(h.angular_frequency * t + h.phase)).sum();
        self.series.as_ref().map_or(harmonics, |series| harmonics + series.at(t))
    }

    /// E T(t), straight from its definition: harmonics and series, and each v relaxing from where
    /// it starts.
    pub fn mean(&self, t: f64) -> f64 {
        let relaxing = self.noises().map(|noise| match noise.initial {
            InitialNoise::At(v) => noise.intensity * v * libm::exp(-noise.relaxation_rate * t),
            InitialNoise::Stationary => 0.0,
        });
        self.deterministic(t) + relaxing.sum::<f64>()
    }

    /// A bound of |T|, with each noise kept to so many stationary standard deviations.
    pub fn bound(&self, sds: f64) -> f64 {
        let harmonics: f64 = self.harmonics.iter().map(|harmonic| harmonic.amplitude.abs()).sum();
        let noise = self.noises().map(|noise| {
            let start = if let InitialNoise::At(v0) = noise.initial { v0.abs() } else { 0.0 };
            noise.intensity * (start + sds * noise.stationary_sd())
        });
        harmonics + self.series.as_ref().map_or(0.0, |series| series.bound()) + noise.sum::<f64>()
    }

    /// P: the shortest time after which every harmonic repeats itself.
    ///
    /// None where no harmonic moves, where there is a series, which repeats nothing, and where
    /// their frequencies have no common measure: where no number of cycles of the slowest one, up
    /// to 1000, is a whole number of cycles of each.
    pub fn period(&self) -> Option<f64> {
        if self.series.is_some() {
            return None;
        }
        let moving = self.harmonics.iter().filter(|h| h.angular_frequency > 0.0 && h.amplitude != 0.0);
        let frequencies: Vec<f64> = moving.map(|h| h.angular_frequency).collect();
        let slowest = frequencies.iter().copied().reduce(f64::min)?;
        let is_whole = |cycles: f64| (cycles - cycles.round()).abs() <= WHOLE * cycles;
        let shared =
            (1..=MOST_CYCLES).map(f64::from).find(|n| frequencies.iter().all(|w| is_whole(n * (w / slowest))))?;
        Some(shared * (TAU / slowest))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn period(harmonics: &[(f64, f64)]) -> Option<f64> {
        let harmonic = |&(amplitude, angular_frequency)| Harmonic { amplitude, angular_frequency, phase: 0.3 };
        Temperature { harmonics: harmonics.iter().map(harmonic).collect(), ..Temperature::default() }.period()
    }

    #[test]
    fn the_period_is_that_which_all_harmonics_share() {
        assert_eq!(period(&[(1.0, 0.25)]), Some(TAU / 0.25));
        // 0.25 and 0.6 have the common measure 0.05; a harmonic that does not move, or is not
        // there, has no say.
        let both = period(&[(1.0, 0.25), (0.2, 0.6), (3.0, 0.0), (0.0, 0.7)]).expect("5 and 12 cycles");
        assert!((both / (TAU / 0.05) - 1.0).abs() < 1e-12);
        assert_eq!(period(&[(0.2, 0.6), (1.0, 0.25)]), Some(both));
        assert_eq!(period(&[(1.0, 0.3), (1.0, 0.1)]), Some(TAU / 0.1));
        assert_eq!(period(&[(1.0, 0.25), (1.0, 0.25 * std::f64::consts::SQRT_2)]), None);
        assert_eq!((period(&[]), period(&[(1.0, 0.0)])), (None, None));
    }
}
