//! The statistics of an ensemble in the file: written and read side by side, so that one mirrors the other.

use super::layout;
use super::variable::{Place, read_or_empty, read_scalar, text};
use crate::stats::{
    Band, Bands, Bias, Corrected, Estimate, Histogram, PeriodMoments, QUANTILE_LEVELS, Statistic, StickDurations,
    SubPhaseCounts, Summary,
};
use hdf5::types::VarLenUnicode;
use hdf5::{File, Result};
use ndarray::Array2;

/// Write the coordinates that are known before a run: statistics, quantile levels, times.
pub(super) fn write_coordinates(place: &Place, time: &[f64]) -> Result<()> {
    let texts = |of: &dyn Fn(Statistic) -> String| -> Result<Vec<VarLenUnicode>> {
        Statistic::ALL.iter().map(|&statistic| text(&of(statistic))).collect()
    };
    let unit = |statistic: Statistic| statistic.dimension().udunits(&place.units);
    place.put(&layout::STATISTIC, &texts(&|statistic| statistic.name().to_owned())?)?;
    place.put(&layout::STATISTIC_LONG_NAME, &texts(&|statistic| layout::long_name(statistic).to_owned())?)?;
    place.put(&layout::STATISTIC_UNIT, &texts(&unit)?)?;
    place.put(&layout::QUANTILE, &QUANTILE_LEVELS)?;
    place.put(&layout::TIME, time)
}

/// Write everything that is known at the end of a run.
pub(super) fn write(place: &Place, summary: &Summary) -> Result<()> {
    write_estimates(place, &summary.estimates)?;
    write_bands(place, &summary.bands)?;
    write_stick_durations(place, &summary.stick_durations)?;
    write_sub_phases(place, &summary.sub_phases)?;
    write_periods(place, &summary.periods)?;
    place.put(&layout::DIVERGED_PATH, &summary.diverged)
}

/// The statistics of a finished file, of a scheme with this step.
pub(super) fn read(file: &File, completed_paths: u64, step: Option<f64>) -> Result<Summary> {
    Ok(Summary {
        completed_paths,
        diverged: read_or_empty(file, &layout::DIVERGED_PATH)?,
        estimates: read_estimates(file)?,
        stick_durations: read_stick_durations(file, step)?,
        sub_phases: SubPhaseCounts {
            counts: read_or_empty(file, &layout::SUB_PHASE_COUNT)?,
            censored: read_scalar(file, &layout::SUB_PHASE_CENSORED)?,
        },
        periods: PeriodMoments {
            time: read_or_empty(file, &layout::PERIOD_TIME)?,
            mean: read_or_empty(file, &layout::DISPLACEMENT_PERIOD_MEAN)?,
            variance: read_or_empty(file, &layout::DISPLACEMENT_PERIOD_VARIANCE)?,
        },
        bands: read_bands(file)?,
    })
}

/// One for each of `Statistic::ALL`.
type Estimates = [Estimate; Statistic::ALL.len()];

/// A value that an estimate has in the file; NaN where it is unknown.
type Field = fn(&Estimate) -> f64;

fn write_estimates(place: &Place, estimates: &Estimates) -> Result<()> {
    let fields: [(&layout::Variable, Field); 7] = [
        (&layout::ESTIMATE, |e| e.estimate),
        (&layout::STANDARD_ERROR, |e| e.standard_error),
        (&layout::INTERVAL_LOW, |e| e.low),
        (&layout::INTERVAL_HIGH, |e| e.high),
        (&layout::BIAS, |e| e.bias.map_or(f64::NAN, |bias| bias.estimate)),
        (&layout::BIAS_UNCERTAINTY, |e| e.bias.map_or(f64::NAN, |bias| bias.uncertainty)),
        (&layout::BIAS_ORDER, |e| e.bias.and_then(|bias| bias.order).unwrap_or(f64::NAN)),
    ];
    for (variable, field) in fields {
        place.put(variable, &estimates.each_ref().map(field))?;
    }
    write_corrected(place, estimates)
}

/// What follows from the bias, where there is one. It is not read back: an estimate knows it.
fn write_corrected(place: &Place, estimates: &Estimates) -> Result<()> {
    let corrected = estimates.each_ref().map(Estimate::corrected);
    if corrected.iter().all(Option::is_none) {
        return Ok(());
    }
    let each = |of: fn(Corrected) -> f64| corrected.map(|corrected| corrected.map_or(f64::NAN, of));
    place.put(&layout::ESTIMATE_CORRECTED, &each(|c| c.estimate))?;
    place.put(&layout::ESTIMATE_CORRECTED_LOW, &each(|c| c.low))?;
    place.put(&layout::ESTIMATE_CORRECTED_HIGH, &each(|c| c.high))
}

/// Statistics are found by name: a file of another minor version may have fewer or more of them.
fn read_estimates(file: &File) -> Result<Estimates> {
    let names: Vec<VarLenUnicode> = read_or_empty(file, &layout::STATISTIC)?;
    let estimate: Vec<f64> = read_or_empty(file, &layout::ESTIMATE)?;
    let standard_error: Vec<f64> = read_or_empty(file, &layout::STANDARD_ERROR)?;
    let low: Vec<f64> = read_or_empty(file, &layout::INTERVAL_LOW)?;
    let high: Vec<f64> = read_or_empty(file, &layout::INTERVAL_HIGH)?;
    let bias: Vec<f64> = read_or_empty(file, &layout::BIAS)?;
    let uncertainty: Vec<f64> = read_or_empty(file, &layout::BIAS_UNCERTAINTY)?;
    let order: Vec<f64> = read_or_empty(file, &layout::BIAS_ORDER)?;
    let read = |statistic: Statistic| {
        let row = names.iter().position(|name| name.as_str() == statistic.name());
        let value = |values: &[f64]| row.and_then(|row| values.get(row).copied()).unwrap_or(f64::NAN);
        let known = |values: &[f64]| Some(value(values)).filter(|value| !value.is_nan());
        Estimate {
            statistic,
            estimate: value(&estimate),
            standard_error: value(&standard_error),
            low: value(&low),
            high: value(&high),
            bias: known(&bias).map(|estimate| Bias {
                estimate,
                uncertainty: value(&uncertainty),
                order: known(&order),
            }),
        }
    };
    Ok(Statistic::ALL.map(read))
}

/// Mean, standard deviation and quantiles of one variable.
type BandVariables = [&'static layout::Variable; 3];

const DISPLACEMENT: BandVariables =
    [&layout::DISPLACEMENT_MEAN, &layout::DISPLACEMENT_SD, &layout::DISPLACEMENT_QUANTILE];
const VELOCITY: BandVariables = [&layout::VELOCITY_MEAN, &layout::VELOCITY_SD, &layout::VELOCITY_QUANTILE];
const TEMPERATURE: BandVariables = [&layout::TEMPERATURE_MEAN, &layout::TEMPERATURE_SD, &layout::TEMPERATURE_QUANTILE];

fn write_bands(place: &Place, bands: &Bands) -> Result<()> {
    let variables =
        [(DISPLACEMENT, &bands.displacement), (VELOCITY, &bands.velocity), (TEMPERATURE, &bands.temperature)];
    for ([mean, sd, quantiles], band) in variables {
        place.put(mean, &band.mean)?;
        place.put(sd, &band.sd)?;
        place.put(quantiles, &band.quantiles.iter().copied().collect::<Vec<_>>())?;
    }
    place.put(&layout::STATIC_PROBABILITY, &bands.static_probability)
}

fn read_bands(file: &File) -> Result<Bands> {
    let band = |[mean, sd, quantiles]: BandVariables| -> Result<Band> {
        let mean: Vec<f64> = read_or_empty(file, mean)?;
        let values: Vec<f64> = read_or_empty(file, quantiles)?;
        let levels = values.len().checked_div(mean.len()).unwrap_or(QUANTILE_LEVELS.len());
        let quantiles = Array2::from_shape_vec((levels, mean.len()), values)?;
        Ok(Band { sd: read_or_empty(file, sd)?, mean, quantiles })
    };
    Ok(Bands {
        time: read_or_empty(file, &layout::TIME)?,
        displacement: band(DISPLACEMENT)?,
        velocity: band(VELOCITY)?,
        temperature: band(TEMPERATURE)?,
        static_probability: read_or_empty(file, &layout::STATIC_PROBABILITY)?,
    })
}

fn write_stick_durations(place: &Place, sticks: &StickDurations) -> Result<()> {
    let edges = &sticks.histogram.edges;
    place.put(&layout::DURATION_BIN, edges.get(1..).unwrap_or_default())?;
    place.put(&layout::DURATION_BIN_LOWER, edges.get(..edges.len().saturating_sub(1)).unwrap_or_default())?;
    place.put(&layout::STICK_DURATION_COUNT, &sticks.histogram.counts)?;
    place.put(&layout::STICK_DURATION_CENSORED_COUNT, &sticks.censored_counts)?;
    place.put(&layout::STICK_DURATION_SURVIVAL, &sticks.survival)?;
    place.put(&layout::STICK_DURATION_QUANTILE, &sticks.quantiles)?;
    place.put(&layout::STICK_DURATION_COMPLETED, &[sticks.completed])?;
    place.put(&layout::STICK_DURATION_CENSORED, &[sticks.censored])?;
    place.put(&layout::FIRST_STICK_COMPLETED, &[sticks.first_completed])?;
    place.put(&layout::FIRST_STICK_CENSORED, &[sticks.first_censored])
}

fn read_stick_durations(file: &File, step: Option<f64>) -> Result<StickDurations> {
    let lower: Vec<f64> = read_or_empty(file, &layout::DURATION_BIN_LOWER)?;
    let upper: Vec<f64> = read_or_empty(file, &layout::DURATION_BIN)?;
    let edges = lower.into_iter().chain(upper.last().copied()).collect();
    Ok(StickDurations {
        step,
        completed: read_scalar(file, &layout::STICK_DURATION_COMPLETED)?,
        censored: read_scalar(file, &layout::STICK_DURATION_CENSORED)?,
        first_completed: read_scalar(file, &layout::FIRST_STICK_COMPLETED)?,
        first_censored: read_scalar(file, &layout::FIRST_STICK_CENSORED)?,
        histogram: Histogram { edges, counts: read_or_empty(file, &layout::STICK_DURATION_COUNT)? },
        censored_counts: read_or_empty(file, &layout::STICK_DURATION_CENSORED_COUNT)?,
        survival: read_or_empty(file, &layout::STICK_DURATION_SURVIVAL)?,
        quantiles: read_or_empty(file, &layout::STICK_DURATION_QUANTILE)?,
    })
}

fn write_sub_phases(place: &Place, sub_phases: &SubPhaseCounts) -> Result<()> {
    let k: Vec<u32> = (1..).take(sub_phases.counts.len()).collect();
    place.put(&layout::SUB_PHASE, &k)?;
    place.put(&layout::SUB_PHASE_COUNT, &sub_phases.counts)?;
    place.put(&layout::SUB_PHASE_CENSORED, &[sub_phases.censored])
}

fn write_periods(place: &Place, periods: &PeriodMoments) -> Result<()> {
    let n: Vec<u32> = (1..).take(periods.time.len()).collect();
    place.put(&layout::PERIOD, &n)?;
    place.put(&layout::PERIOD_TIME, &periods.time)?;
    place.put(&layout::DISPLACEMENT_PERIOD_MEAN, &periods.mean)?;
    place.put(&layout::DISPLACEMENT_PERIOD_VARIANCE, &periods.variance)
}
