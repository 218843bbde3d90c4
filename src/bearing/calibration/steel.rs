//! The temperature of the steel, and the slips that are seen with it.

use super::lag::{CONVINCING, LagProfile, lag_profile};
use super::question::Lag;
use super::samples::MeasuredRecord;
use super::slips::Evidence;
use super::thermometer::Thermometer;
use super::uncertainty::AroundLag;

/// The fewest usual slips that determine anything.
const FEWEST_SLIPS: usize = 6;

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
        let evidence_at = |lag: f64| Evidence::find(&air.lagged(lag), resolution).filter(is_visible);
        let mut evidence = evidence_at(given);
        let mut profile = evidence.as_ref().map(|evidence| lag_profile(air, evidence));
        let mut used = given;
        if let (Lag::Auto, Some(first)) = (lag, &profile)
            && first.gain > CONVINCING
            && let Some(second) = evidence_at(first.likeliest)
        {
            let again = lag_profile(air, &second);
            used = again.likeliest;
            evidence = evidence_at(used);
            profile = Some(again);
        }
        let around = evidence.map(|evidence| match lag {
            Lag::Auto if used > 0.0 => AroundLag::lag(evidence, air, used),
            _ => AroundLag { here: evidence, beside: None },
        });
        let record = air.lagged(used);
        let thermometer =
            around.as_ref().map_or_else(|| Thermometer::of(&record), |around| around.here.thermometer.clone());
        let (roughness, overlooked) = (thermometer.roughness, thermometer.overlooked());
        Steel { record, lag: used, profile, roughness, overlooked, around }
    }
}

/// Whether enough slips are seen to determine the parameters.
fn is_visible(evidence: &Evidence) -> bool {
    let usual = evidence.slips.iter().filter(|slip| slip.is_usual).count();
    usual >= FEWEST_SLIPS && evidence.reversals.len() >= 2
}
