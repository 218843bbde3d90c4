//! The temperature of the steel, and the slips that are seen with it.

use super::lag::{LagProfile, is_small, lag_profile};
use super::question::Lag;
use super::samples::{MeasuredRecord, interval};
use super::slips::Evidence;
use super::thermometer::Thermometer;
use super::uncertainty::AroundLag;
use crate::weather::{Imagined, imagined};

/// The fewest usual slips that determine anything.
const FEWEST_SLIPS: usize = 6;

/// Largest number of searches for a lag, each with the slips that the lag before it shows, and the
/// relative difference of two of them that are the same.
const LAG_ROUNDS: u32 = 4;
const SAME_LAG: f64 = 0.02;

/// A record with the temperature of the steel in place of that of the air.
pub struct Steel {
    pub record: MeasuredRecord,
    /// The lag that was used, in seconds.
    pub lag: f64,
    /// The likelihood as a function of the lag; `None` if there are no slips.
    pub profile: Option<LagProfile>,
    /// The variance that its temperature gains between samples, in K^2/s.
    pub roughness: f64,
    /// By how many kelvin the friction seems to hold less, because temperatures between samples are
    /// overlooked.
    pub overlooked: f64,
    /// The slips; `None` if too few are seen.
    pub around: Option<AroundLag>,
}

impl Steel {
    /// Use the lag that is known, or estimate it from the slips. An estimate is used only if the
    /// data clearly show a lag.
    pub fn of(air: &MeasuredRecord, resolution: f64, lag: Lag) -> Self {
        let given = match lag {
            Lag::Known(lag) => lag,
            Lag::Auto => 0.0,
        };
        let [times, temperatures] = air.thermometer();
        let interval = interval(&times);
        let imagined_at = |shift: f64| {
            let times: Vec<f64> = times.iter().map(|time| time + shift).collect();
            imagined(
                [&times, &temperatures],
                &air.times,
                interval,
                air.averaged[0],
            )
        };
        let imagined = imagined_at(0.0);
        // Temperatures with noise would make the slope of z against T too small, and so would means
        // beside readings of an instant.
        let is_better = |of: &&Imagined| of.white > 0.0 || air.averaged[0] != air.averaged[1];
        let better = imagined
            .as_ref()
            .filter(is_better)
            .map(|of| air.with_temperatures(&of.times, &of.mean));
        let air = better.as_ref().unwrap_or(air);
        let evidence_of = |air: &MeasuredRecord, lag: f64, imagined: &Option<Imagined>| {
            let steel = air.lagged(lag);
            let rough = match imagined {
                Some(of) if lag == 0.0 => Thermometer::imagined(of.clone()),
                _ => Thermometer::of(&steel),
            };
            Evidence::find(&steel, &rough, resolution).filter(is_visible)
        };
        let clean = match air.averaged[1] > 0.0 {
            true => evidence_of(air, given, &imagined)
                .map(|evidence| air.without_readings(&evidence.mixed(air))),
            false => None,
        };
        let clean = clean.unwrap_or_else(|| air.clone());
        let first = evidence_of(&clean, given, &imagined);
        let first_profile = first.as_ref().map(|evidence| lag_profile(&clean, evidence));
        let clock = first_profile
            .as_ref()
            .and_then(|profile| profile.clock)
            .filter(|seconds| is_small(*seconds));
        let shift = clock.unwrap_or(0.0);
        let (air, imagined) = match shift {
            0.0 => (&clean, imagined),
            _ => (&clean.shifted(shift), imagined_at(shift)),
        };
        let evidence_at = |lag: f64| evidence_of(air, lag, &imagined);
        let (mut evidence, mut profile) = match shift {
            0.0 => (first, first_profile),
            _ => {
                let evidence = evidence_at(given);
                let profile = evidence.as_ref().map(|evidence| LagProfile {
                    clock,
                    ..lag_profile(air, evidence)
                });
                (evidence, profile)
            }
        };
        let mut used = given;
        for _ in 0..if lag == Lag::Auto { LAG_ROUNDS } else { 0 } {
            let Some(found) = profile.as_ref().and_then(LagProfile::found) else {
                break;
            };
            let Some(next) = evidence_at(found) else {
                break;
            };
            let again = lag_profile(air, &next);
            let is_same = (again.likeliest - found).abs() <= SAME_LAG * found;
            used = again.found().unwrap_or(0.0);
            evidence = evidence_at(used);
            profile = Some(LagProfile {
                clock: clock.or(again.clock),
                ..again
            });
            if is_same {
                break;
            }
        }
        let around = evidence.map(|evidence| match lag {
            Lag::Auto if used > 0.0 => AroundLag::lag(evidence, air, used),
            _ => AroundLag {
                here: evidence,
                beside: None,
            },
        });
        let record = air.lagged(used);
        let thermometer = around.as_ref().map_or_else(
            || Thermometer::of(&record),
            |around| around.here.thermometer.clone(),
        );
        let (roughness, overlooked) = (thermometer.roughness, thermometer.overlooked(interval));
        Steel {
            record,
            lag: used,
            profile,
            roughness,
            overlooked,
            around,
        }
    }
}

/// Whether enough slips are seen to determine the parameters.
fn is_visible(evidence: &Evidence) -> bool {
    let usual = evidence.slips.iter().filter(|slip| slip.is_usual).count();
    usual >= FEWEST_SLIPS && evidence.reversals.len() >= 2
}
