//! The temperature of the steel, and the slips detected with it.

use super::bearing::Response;
use super::course::Course;
use super::fit::SensorNoise;
use super::lag::{LagProfile, Offset, is_small, lag_profile, offset};
use super::question::Lag;
use super::roughness::{overlooked, shown_roughness};
use super::samples::{MeasuredRecord, interval};
use super::slips::DetectedSlips;
use super::synthetic::Synthetic;
use crate::weather::HiddenTemperature;

/// The minimum number of typical slips for any estimate.
const FEWEST_SLIPS: usize = 6;

/// Maximum number of searches for a lag, each with the slips detected with the previous lag, and
/// the relative difference below which two lags are equal.
const LAG_ROUNDS: u32 = 6;
const SAME_LAG: f64 = 0.002;

/// The temperature is smooth if its samples show less than this share of the roughness of the processes
/// that fit it best.
const SMOOTH: f64 = 0.35;

/// The longest step in simulating a mean, as a fraction of its averaging time.
const SHARE: f64 = 1.0 / 6.0;

/// A record whose clocks agree, and what is known of its temperature.
pub struct MeasuredAir {
    record: MeasuredRecord,
    hidden: Option<HiddenTemperature>,
    /// The variance that the temperature gains between samples, in K^2/s.
    roughness: f64,
    /// Whether it is interpolated linearly instead.
    is_straight: bool,
    resolution: f64,
}

impl MeasuredAir {
    /// The air of a record in which the clock of the sensor is ahead by `shift` seconds.
    fn new(record: &MeasuredRecord, shift: f64) -> Self {
        let [mut times, temperatures] = record.thermometer();
        times.iter_mut().for_each(|time| *time += shift);
        let record = match shift {
            0.0 => record.clone(),
            _ => {
                let seen = record.samples();
                let both =
                    MeasuredRecord::of([&times, &temperatures], [&seen.times, &seen.readings]);
                MeasuredRecord {
                    averaged: record.averaged,
                    ..both
                }
            }
        };
        let averaged = record.averaged;
        let means = averaged.iter().filter(|over| **over > 0.0);
        let step = means.fold(f64::INFINITY, |step, over| step.min(SHARE * over));
        let steps = [interval(&times), averaged[0], step];
        let shown = shown_roughness(&times, &temperatures);
        // The temperature of steel is smooth between samples, which the processes are not.
        let is_rough = |hidden: &HiddenTemperature| {
            let is_needed = hidden.white > 0.0 || averaged != [0.0; 2];
            is_needed || shown > SMOOTH * hidden.roughness
        };
        let hidden = HiddenTemperature::new([&times, &temperatures], &record.times, steps);
        let hidden = hidden.filter(is_rough);
        let roughness = hidden.as_ref().map_or(shown, |hidden| hidden.roughness);
        MeasuredAir {
            resolution: record.resolution(),
            record,
            hidden,
            roughness,
            is_straight: false,
        }
    }

    /// A record of this air with the underlying temperature, if its samples are noisy, or means
    /// combined with instantaneous readings: otherwise the slope of z against T would be too small.
    fn smoothed(&self, record: &MeasuredRecord) -> MeasuredRecord {
        let averaged = record.averaged;
        match &self.hidden {
            Some(hidden) if hidden.white > 0.0 || averaged[0] != averaged[1] => {
                let [_, temperatures] = record.thermometer();
                record.with_temperatures(&hidden.times, &hidden.mean(&temperatures))
            }
            _ => record.clone(),
        }
    }

    /// This record without readings averaged over a slip.
    fn cleaned(
        &self,
        record: MeasuredRecord,
        find: impl Fn(&MeasuredRecord) -> Option<DetectedSlips>,
    ) -> MeasuredRecord {
        match record.averaged[1] > 0.0 {
            true => find(&record).map_or_else(
                || record.clone(),
                |slips| record.without_readings(&slips.mixed(&record)),
            ),
            false => record,
        }
    }

    /// The slips with steel of this lag; `None` if they do not determine the parameters.
    fn slips(&self, record: &MeasuredRecord, lag: f64) -> Option<DetectedSlips> {
        DetectedSlips::find(&record.lagged(lag), self.resolution).filter(is_visible)
    }
}

/// A record with the temperature of the steel in place of that of the air.
pub struct Steel {
    pub record: MeasuredRecord,
    /// The lag that was used, in seconds.
    pub lag: f64,
    /// Whether it was estimated.
    pub is_estimated: bool,
    /// The likelihood as a function of the lag; `None` if there are no slips.
    pub profile: Option<LagProfile>,
    /// If the thermometer is slower than the steel: A relative to that with a fast thermometer.
    pub slow_share: Option<f64>,
    /// The slips; `None` if too few were detected.
    pub slips: Option<DetectedSlips>,
    air: MeasuredAir,
}

impl Steel {
    /// Use the known lag, or estimate it from the slips. An estimate is used only if the data
    /// clearly show a lag.
    pub fn new(record: &MeasuredRecord, lag: Lag) -> Self {
        let given = match lag {
            Lag::Known(lag) => lag,
            Lag::Auto => 0.0,
        };
        let mut air = MeasuredAir::new(record, 0.0);
        let clean = |air: &MeasuredAir| {
            let record = air.smoothed(&air.record);
            air.cleaned(record, |record| air.slips(record, given))
        };
        let mut cleaned = clean(&air);
        let mut slips = air.slips(&cleaned, given);
        let mut profile = slips
            .as_ref()
            .map(|slips| lag_profile(&cleaned, slips, given));
        let lagging = slips.as_ref().zip(profile.as_ref());
        let offset =
            lagging.and_then(|(slips, profile)| offset(&cleaned, slips, profile.likeliest));
        let clock = match offset {
            Some(Offset::Clock(seconds)) => Some(seconds),
            Some(Offset::SlowThermometer(_)) | None => None,
        };
        let slow_share = match offset {
            Some(Offset::SlowThermometer(seconds)) => {
                let reach = |slips: &DetectedSlips| Some(slips.fit()?.response.motion.reach);
                let sharp = air.slips(&cleaned.sharpened(seconds), given);
                let share = slips.as_ref().zip(sharp.as_ref());
                share
                    .and_then(|(slow, sharp)| Some(reach(slow)? / reach(sharp)?))
                    .or(Some(1.0))
            }
            Some(Offset::Clock(_)) | None => None,
        };
        let shift = clock.filter(|seconds| is_small(*seconds)).unwrap_or(0.0);
        if shift != 0.0 {
            air = MeasuredAir::new(record, shift);
            cleaned = clean(&air);
            slips = air.slips(&cleaned, given);
            profile = slips
                .as_ref()
                .map(|slips| lag_profile(&cleaned, slips, given));
        }
        let mut used = given;
        for _ in 0..if lag == Lag::Auto { LAG_ROUNDS } else { 0 } {
            let Some(found) = profile.as_ref().and_then(LagProfile::found) else {
                break;
            };
            let Some(next) = air.slips(&cleaned, found) else {
                break;
            };
            let again = lag_profile(&cleaned, &next, found);
            let is_same = (again.likeliest - found).abs() <= SAME_LAG * found;
            used = again.found().unwrap_or(0.0);
            profile = Some(again);
            if is_same {
                break;
            }
        }
        if used != given {
            slips = air.slips(&cleaned, used);
        }
        if let Some(profile) = &mut profile {
            profile.clock = clock;
        }
        Steel {
            record: air.smoothed(record).shifted(shift).lagged(used),
            lag: used,
            is_estimated: lag == Lag::Auto && used > 0.0,
            profile,
            slow_share,
            slips,
            air,
        }
    }

    /// The variance that the temperature of the steel gains between samples, in K^2/s.
    pub fn roughness(&self) -> f64 {
        match self.lag > 0.0 {
            true => shown_roughness(&self.record.times, &self.record.temperatures),
            false if self.air.is_straight => 0.0,
            false => self.air.roughness,
        }
    }

    /// The apparent decrease of A in kelvin, because temperatures between samples are not seen.
    pub fn overlooked(&self) -> f64 {
        overlooked(
            self.roughness(),
            interval(&self.air.record.thermometer()[0]),
        )
    }

    /// Whether the samples alone do not determine the temperature between them.
    pub fn may_be_straight(&self) -> bool {
        let white = self.air.hidden.as_ref().map_or(0.0, |hidden| hidden.white);
        white == 0.0 && self.air.record.averaged == [0.0; 2] && self.lag == 0.0
    }

    /// Choose linear interpolation between samples, or the roughness of the temperature.
    pub fn straighten(&mut self, is_straight: bool) {
        self.air.is_straight = is_straight;
    }

    /// Synthetic records like this one, with a bearing of this response and course of friction.
    pub fn synthetic(
        &self,
        slips: &DetectedSlips,
        (response, course): (Response, Course),
        noise: SensorNoise,
    ) -> Synthetic<'_> {
        let motion = response.motion;
        Synthetic {
            record: &self.air.record,
            hidden: self.air.hidden.as_ref(),
            roughness: if self.air.is_straight {
                0.0
            } else {
                self.air.roughness
            },
            lag: self.lag,
            scatter: slips.excess_scatter() * motion.jump / (2.0 * motion.reach),
            noise,
            response,
            course,
        }
    }

    /// The slips of a synthetic record with these jumps, at its most likely lag near the estimated
    /// one, and that lag.
    pub fn slips_of(
        &self,
        slips: &DetectedSlips,
        (record, jumps): (MeasuredRecord, Vec<[f64; 2]>),
    ) -> Option<(f64, DetectedSlips)> {
        let find = |record: &MeasuredRecord, lag: f64| {
            slips
                .like_these(&record.lagged(lag), &jumps)
                .filter(is_visible)
        };
        let cleaned = self
            .air
            .cleaned(self.air.smoothed(&record), |record| find(record, self.lag));
        let mut here = find(&cleaned, self.lag)?;
        let mut lag = self.lag;
        if !self.is_estimated {
            return Some((lag, here));
        }
        // The vertex of the parabola through three deviances, limited to the range in which a parabola
        // is a good approximation; the second one is narrow, because a wide one is not symmetric.
        let wide = (0.2 * lag).max(60.0).min(lag);
        for step in [wide, 0.1 * wide] {
            let beside = |lag: f64| here.with_temperatures(&cleaned.lagged(lag.max(0.0)));
            let [less, more] = [beside(lag - step)?, beside(lag + step)?];
            let [low, middle, high] = [&less, &here, &more].map(|slips| slips.sums.deviance());
            let bend = low - 2.0 * middle + high;
            let vertex = match bend > 0.0 {
                true => (0.5 * (low - high) / bend).clamp(-3.0, 3.0),
                false => 0.0,
            };
            lag = (lag + vertex * step).max(0.0);
            here = here.with_temperatures(&cleaned.lagged(lag))?;
        }
        Some((lag, here))
    }
}

/// Whether enough slips were detected to determine the parameters.
fn is_visible(slips: &DetectedSlips) -> bool {
    slips.usual().count() >= FEWEST_SLIPS && slips.reversals.len() >= 2
}
