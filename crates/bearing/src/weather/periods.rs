//! Harmonics that the sample times resolve.

use crate::linear::{Normal, cholesky};
use std::f64::consts::TAU;
use stickslip_data::median;
use stickslip_text::numbers::short;

/// Why samples do not resolve a harmonic. Times are in seconds.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum HarmonicError {
    /// The record is shorter than half of this period.
    #[error("the record is shorter than half a period of {}, too short to resolve that harmonic", words(*.0))]
    Short(f64),
    /// A harmonic takes the same values at the samples as the mean or another harmonic.
    #[error("samples are {} apart, too far to resolve a harmonic of {}", words(*.interval), words(*.period))]
    Sparse {
        /// The median time between samples.
        interval: f64,
        /// The period.
        period: f64,
    },
    /// Two harmonics have this period.
    #[error("the period {} is listed twice", words(*.0))]
    Twice(f64),
}

impl HarmonicError {
    /// What the user can do about it.
    pub fn remedy(&self) -> &'static str {
        match self {
            HarmonicError::Short(_) => "measure for at least half of that period, or leave it out",
            HarmonicError::Sparse { .. } => "leave that harmonic out, or sample more often",
            HarmonicError::Twice(_) => "list it once",
        }
    }
}

/// A time in words: 12 h, 365.25 d.
fn words(seconds: f64) -> String {
    match seconds {
        s if s < 120.0 => format!("{} s", short(s)),
        s if s < 3600.0 => format!("{} min", short(s / 60.0)),
        s if s < 86_400.0 => format!("{} h", short(s / 3600.0)),
        s => format!("{} d", s / 86_400.0),
    }
}

/// A harmonic is resolved if at least this share of its variance is independent of the mean and the
/// other harmonics at the samples. Half a period has 0.19; samples twice a period, each time ten
/// minutes early or late at random, have 0.0006.
const OWN_SHARE: f64 = 1e-3;

/// An error if the samples do not resolve the harmonics of these periods. The record may be shorter
/// than half a period, or there may be at most two samples per period. A harmonic may also have the
/// same values at the samples as a combination of the mean and the others.
pub fn check_harmonics(times: &[f64], periods: &[f64]) -> Result<(), HarmonicError> {
    let duration = times.last().unwrap_or(&0.0) - times.first().unwrap_or(&0.0);
    let interval = median(
        &mut times
            .windows(2)
            .map(|pair| pair[1] - pair[0])
            .collect::<Vec<f64>>(),
    );
    for (i, period) in periods.iter().enumerate() {
        if periods[..i].contains(period) {
            return Err(HarmonicError::Twice(*period));
        }
        if duration < 0.5 * period {
            return Err(HarmonicError::Short(*period));
        }
        if 2.0 * interval >= *period || !is_own(times, &periods[..=i]) {
            return Err(HarmonicError::Sparse {
                interval,
                period: *period,
            });
        }
    }
    Ok(())
}

/// Those of the usual periods, a year and a day, that the samples resolve, and a sentence for each
/// of the others.
pub fn usual(times: &[f64]) -> (Vec<f64>, Vec<String>) {
    let (mut found, mut remarks): (Vec<f64>, Vec<String>) = Default::default();
    for period in super::PERIODS {
        let more = [&found[..], &[period]].concat();
        match check_harmonics(times, &more) {
            Ok(()) => found = more,
            Err(error) => {
                remarks.push(format!("harmonic of {} not fitted: {error}", words(period)))
            }
        }
    }
    (found, remarks)
}

/// Whether the last harmonic differs from the mean and the harmonics before it. Each diagonal
/// element of the Cholesky factor of the columns' products is the independent part of a column.
fn is_own(times: &[f64], periods: &[f64]) -> bool {
    let columns = 2 * periods.len() + 1;
    let mut normal = Normal::of(columns);
    for time in times {
        let phase = |period: &f64| TAU / period * (time - times[0]);
        let waves = periods
            .iter()
            .flat_map(|period| [libm::cos(phase(period)), libm::sin(phase(period))]);
        let row: Vec<f64> = std::iter::once(1.0).chain(waves).collect();
        normal.add(&row, 0.0, 1.0);
    }
    let n = times.len() as f64;
    let Some(factor) = cholesky(&normal.matrix) else {
        return false;
    };
    // A cosine or a sine has half of n as its sum of squares.
    (columns - 2..columns).all(|i| factor[i][i] * factor[i][i] > OWN_SHARE * 0.5 * n)
}

#[cfg(test)]
mod tests {
    use super::*;

    const DAY: f64 = 86_400.0;
    const YEAR: f64 = 365.25 * DAY;

    /// Times of a record of this many days, each `hours` after the one before.
    fn every(hours: f64, days: f64) -> Vec<f64> {
        (0..(24.0 * days / hours) as usize)
            .map(|i| 3600.0 * hours * i as f64)
            .collect()
    }

    /// Readings at these hours of each day.
    fn at(hours: &[f64], days: usize) -> Vec<f64> {
        (0..days)
            .flat_map(|day| {
                hours
                    .iter()
                    .map(move |hour| DAY * day as f64 + 3600.0 * hour)
            })
            .collect()
    }

    #[test]
    fn samples_tell_only_what_they_are_dense_enough_for() {
        for (name, times, expected) in [
            ("hourly for a year", every(1.0, 366.0), vec![YEAR, DAY]),
            ("hourly for a month", every(1.0, 30.0), vec![DAY]),
            ("daily for two years", every(24.0, 731.0), vec![YEAR]),
            ("daily for a month", every(24.0, 30.0), vec![]),
            ("twice a day", every(12.0, 731.0), vec![YEAR]),
            ("every 18 hours", every(18.0, 731.0), vec![YEAR]),
            ("every 8 hours", every(8.0, 731.0), vec![YEAR, DAY]),
            (
                "at 7, 14 and 21 o'clock",
                at(&[7.0, 14.0, 21.0], 731),
                vec![YEAR, DAY],
            ),
            ("at 6 and 15 o'clock", at(&[6.0, 15.0], 731), vec![YEAR]),
            ("weekly", every(168.0, 1500.0), vec![YEAR]),
        ] {
            assert_eq!(usual(&times).0, expected, "{name}");
        }
        let error = |hours, period| {
            check_harmonics(&every(hours, 100.0), &[period])
                .unwrap_err()
                .to_string()
        };
        assert_eq!(
            error(12.0, DAY),
            "samples are 12 h apart, too far to resolve a harmonic of 1 d"
        );
        assert_eq!(
            error(24.0, DAY),
            "samples are 1 d apart, too far to resolve a harmonic of 1 d"
        );
        assert_eq!(
            error(1.0, 7200.0),
            "samples are 1 h apart, too far to resolve a harmonic of 2 h"
        );
        // Two periods that a hundred days do not distinguish.
        assert!(check_harmonics(&every(1.0, 100.0), &[DAY, 1.00001 * DAY]).is_err());
        assert!(check_harmonics(&every(1.0, 100.0), &[DAY, 0.5 * DAY, 7.0 * DAY]).is_ok());
    }
}
