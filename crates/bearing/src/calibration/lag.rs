//! The lag of the temperature of the steel behind that of the air.

use super::level;
use super::lowest::golden_section_minimum;
use super::samples::{HOUR, MeasuredRecord};
use super::slips::DetectedSlips;
use super::sticks::{bins, sticks};

/// A lag is accepted if twice the log-likelihood ratio exceeds this.
///
/// In synthetic records without a lag the gain is below 3, and below 10 with a thermometer that
/// shows whole kelvins; a lag of five minutes gains 40.
pub const CONVINCING: f64 = 15.0;

/// The lags of the reported profile, in minutes. The last one, two days, is the longest that is
/// considered.
const MINUTES: [f64; 19] = [
    0.0, 5.0, 10.0, 15.0, 20.0, 30.0, 45.0, 60.0, 90.0, 120.0, 180.0, 240.0, 360.0, 480.0, 720.0,
    1080.0, 1440.0, 2160.0, 2880.0,
];

/// Differences of two clocks in minutes: drift within a year, summer time, or a wrong time zone.
const CLOCKS: [f64; 28] = [
    -120.0, -60.0, -55.0, -50.0, -45.0, -40.0, -35.0, -30.0, -25.0, -20.0, -15.0, -10.0, -5.0,
    -2.0, 2.0, 5.0, 10.0, 15.0, 20.0, 25.0, 30.0, 35.0, 40.0, 45.0, 50.0, 55.0, 60.0, 120.0,
];

/// Those tried first.
const FIRST: [f64; 6] = [-120.0, -60.0, -5.0, 5.0, 60.0, 120.0];

/// The likelihood of the lag of steel behind the thermometer, from z during sticks.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LagProfile {
    /// The most likely lag, in seconds.
    pub likeliest: f64,
    /// Twice the log-likelihood ratio of that lag to none.
    pub gain: f64,
    /// Seconds by which the clock of the sensor is ahead of that of the thermometer, if that explains
    /// the displacement far better than any lag.
    pub clock: Option<f64>,
    /// Lags in seconds, and for each the deviance (minus twice the log-likelihood) above its
    /// minimum.
    pub profile: Vec<(f64, f64)>,
}

/// Minus twice the log-likelihood of other temperatures for a record, from bins of this many
/// seconds of its sticks. The variance of the walk is that of the record.
fn deviances(
    record: &MeasuredRecord,
    slips: &DetectedSlips,
    seconds: f64,
) -> impl Fn(&MeasuredRecord) -> f64 {
    let samples = record.samples();
    let sticks = sticks(&samples, slips.slips.iter().map(|slip| slip.index));
    let walk = level::fitted_walk(&bins(&samples, &sticks, seconds, 2));
    move |other| {
        let bins = bins(&other.samples(), &sticks, seconds, 2);
        level::sums(&bins, walk).deviance()
    }
}

/// Compute the profile of the lag, given the slips that were found with steel of the lag `found`:
/// with another one, the variation of the steel would count as a walk of the sensor, which would
/// bias the lag.
pub fn lag_profile(record: &MeasuredRecord, slips: &DetectedSlips, found: f64) -> LagProfile {
    let steel = record.lagged(found);
    let of = deviances(&steel, slips, slips.bin);
    let deviance = |lag: f64| of(&record.lagged(lag));
    let mut profile: Vec<(f64, f64)> = MINUTES
        .map(|minutes| 60.0 * minutes)
        .map(|lag| (lag, deviance(lag)))
        .to_vec();
    let (without, last) = (profile[0].1, profile.len() - 1);
    let best = (0..=last)
        .min_by(|a, b| profile[*a].1.total_cmp(&profile[*b].1))
        .unwrap_or(0);
    let (mut likeliest, mut lowest) = profile[best];
    if best < last {
        let found = golden_section_minimum(
            profile[best.saturating_sub(1)].0,
            profile[best + 1].0,
            16,
            deviance,
        );
        let at_found = deviance(found);
        if at_found < lowest {
            (likeliest, lowest) = (found, at_found);
        }
    }
    profile
        .iter_mut()
        .for_each(|(_, deviance)| *deviance -= lowest);
    LagProfile {
        likeliest,
        gain: without - lowest,
        clock: None,
        profile,
    }
}

/// The time constants of a thermometer that is slower than the steel, in minutes.
const SLOW: [f64; 11] = [
    2.0, 5.0, 10.0, 15.0, 20.0, 30.0, 45.0, 60.0, 90.0, 120.0, 180.0,
];

/// Why the temperature at another time explains the displacement better.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Offset {
    /// The clock of the sensor is ahead of that of the thermometer by this many seconds.
    Clock(f64),
    /// The thermometer is slower than the steel, with this time constant in seconds.
    SlowThermometer(f64),
}

/// The offset that is more likely than this lag and than none. A lag smooths the temperature from
/// sample to sample, and a clock does not, so samples are used individually here.
pub fn offset(record: &MeasuredRecord, slips: &DetectedSlips, lag: f64) -> Option<Offset> {
    let deviance = deviances(record, slips, 1.0);
    let best_of = |minutes: &[f64], other: fn(&MeasuredRecord, f64) -> MeasuredRecord| {
        let all = minutes.iter().map(|minutes| {
            let seconds = 60.0 * minutes;
            (seconds, deviance(&other(record, seconds)))
        });
        all.min_by(|a, b| a.1.total_cmp(&b.1))
    };
    let none = deviance(record);
    // If neither a small step to either side nor a whole hour is more likely, no other offset is.
    best_of(&FIRST, MeasuredRecord::shifted).filter(|(_, deviance)| *deviance < none)?;
    let (seconds, lowest) = best_of(&CLOCKS, MeasuredRecord::shifted)?;
    let other = none.min(deviance(&record.lagged(lag)));
    if other - lowest <= CONVINCING {
        return None;
    }
    // The temperature at later times resembles that of a thermometer that lags behind the steel.
    let slow = best_of(&SLOW, MeasuredRecord::sharpened);
    let slow = slow.filter(|(_, deviance)| seconds < 0.0 && *deviance < lowest);
    let clock = Offset::Clock(seconds);
    Some(slow.map_or(clock, |(seconds, _)| Offset::SlowThermometer(seconds)))
}

/// Whether a difference of this many seconds may be drift of the clocks; otherwise one of them was
/// set to another hour.
pub fn is_small(seconds: f64) -> bool {
    seconds.abs() < HOUR
}

impl LagProfile {
    /// The most likely lag, if it is clearly longer than none, and shorter than the longest that is
    /// considered.
    pub fn found(&self) -> Option<f64> {
        (self.gain > CONVINCING && !self.is_beyond()).then_some(self.likeliest)
    }

    /// Whether a lag longer than the longest considered may be more likely.
    pub fn is_beyond(&self) -> bool {
        self.gain > CONVINCING
            && self
                .profile
                .last()
                .is_some_and(|(longest, _)| self.likeliest >= *longest)
    }

    /// The deviance of a lag above the minimum, interpolated linearly between the lags of the
    /// profile.
    pub fn against(&self, lag: f64) -> f64 {
        let after = self
            .profile
            .iter()
            .position(|(at, _)| *at >= lag)
            .unwrap_or(self.profile.len() - 1)
            .max(1);
        let ((a, low), (b, high)) = (self.profile[after - 1], self.profile[after]);
        low + (high - low) * (lag - a) / (b - a)
    }
}

#[cfg(test)]
mod tests {
    use super::super::bearing::Sensor;
    use super::super::motion::Motion;
    use super::*;

    /// A lag at the end of what is considered is none that was found, however likely it is.
    #[test]
    fn a_lag_at_the_end_of_the_search_is_none() {
        let of = |likeliest: f64, gain: f64| LagProfile {
            likeliest,
            gain,
            clock: None,
            profile: vec![(0.0, gain), (7200.0, 0.0)],
        };
        assert_eq!(of(3600.0, 100.0).found(), Some(3600.0));
        assert_eq!(
            (of(7200.0, 100.0).found(), of(7200.0, 100.0).is_beyond()),
            (None, true)
        );
        assert_eq!(
            (of(3600.0, 10.0).found(), of(7200.0, 10.0).is_beyond()),
            (None, false)
        );
    }

    /// The readings of a bearing without noise, whose steel lags by 37 minutes, have this lag: it is
    /// found between the lags of the profile. Between these, the deviance is a straight line.
    #[test]
    fn a_lag_without_noise_is_found_to_the_second() {
        let times: Vec<f64> = (0..6000).map(|i| 600.0 * f64::from(i)).collect();
        let wave = |t: &f64| {
            let day = t / 86_400.0;
            9.0 * (0.21 * day).sin()
                + 4.0 * (std::f64::consts::TAU * day).cos()
                + (19.0 * day).sin()
        };
        let air = MeasuredRecord {
            temperatures: times.iter().map(wave).collect(),
            readings: vec![0.0; times.len()],
            times,
            ..MeasuredRecord::default()
        };
        let lag = 2220.0;
        let steel = air.lagged(lag).temperatures;
        let motion = Motion {
            reach: 5.0,
            jump: 1.0,
            start: 0.0,
        };
        let sensor = Sensor::sheared(0.0, 3e-4, 0.1);
        let places = motion.follow(&steel);
        let readings = places.iter().zip(&steel);
        let record = MeasuredRecord {
            readings: readings.map(|(xi, t)| sensor.reading(*xi, *t)).collect(),
            ..air
        };
        let slips = DetectedSlips::find(&record.lagged(lag), 1e-6).expect("slips");
        let found = lag_profile(&record, &slips, lag);
        assert!((found.likeliest - lag).abs() < 1.0, "{}", found.likeliest);
        let [(from, low), (to, high)] = [found.profile[6], found.profile[7]];
        assert_eq!([from, to], [2700.0, 3600.0]);
        assert!((found.against(2925.0) - (0.75 * low + 0.25 * high)).abs() < 1e-9 * high);
    }
}
