//! The statistics of an ensemble in the file: written and read side by side, so that one mirrors the other.

use super::layout;
use super::variable::{Place, read_or_empty, read_scalar, read_texts, read_variable, text};
use crate::stats::{
    Band, Bands, Bias, Corrected, Ends, Estimate, Histogram, Measurement, PeriodMoments, QUANTILE_LEVELS, Statistic,
    StickDurations, SubPhaseCounts, Summary, Transient,
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
    write_transient(place, summary.transient)?;
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
            count_ends: read_ends(file, &layout::SUB_PHASE_COUNT_ENDS)?,
            shares: read_or_empty(file, &layout::SUB_PHASE_SHARE)?,
            share_ends: read_ends(file, &layout::SUB_PHASE_SHARE_ENDS)?,
            censored: read_scalar(file, &layout::SUB_PHASE_CENSORED)?,
            censored_ends: read_scalar_ends(file, &layout::SUB_PHASE_CENSORED_ENDS)?,
        },
        transient: read_transient(file)?,
        periods: PeriodMoments {
            time: read_or_empty(file, &layout::PERIOD_TIME)?,
            mean: read_or_empty(file, &layout::DISPLACEMENT_PERIOD_MEAN)?,
            mean_ends: read_ends(file, &layout::DISPLACEMENT_PERIOD_MEAN_ENDS)?,
            variance: read_or_empty(file, &layout::DISPLACEMENT_PERIOD_VARIANCE)?,
            variance_ends: read_ends(file, &layout::DISPLACEMENT_PERIOD_VARIANCE_ENDS)?,
        },
        bands: read_bands(file)?,
    })
}

/// The ends of the intervals of a curve.
fn put_ends(place: &Place, [low, high]: &[layout::Variable; 2], ends: &Ends) -> Result<()> {
    place.put(low, &ends.low)?;
    place.put(high, &ends.high)
}

/// The ends of the interval of a single number.
fn put_scalar_ends(place: &Place, variables: &[layout::Variable; 2], ends: [f64; 2]) -> Result<()> {
    put_ends(place, variables, &Ends::from_iter([ends]))
}

/// Empty in a file of an earlier version.
fn read_ends(file: &File, [low, high]: &[layout::Variable; 2]) -> Result<Ends> {
    Ok(Ends { low: read_or_empty(file, low)?, high: read_or_empty(file, high)? })
}

/// NaN in a file of an earlier version.
fn read_scalar_ends(file: &File, variables: &[layout::Variable; 2]) -> Result<[f64; 2]> {
    let Ends { low, high } = read_ends(file, variables)?;
    Ok([low, high].map(|end| end.first().copied().unwrap_or(f64::NAN)))
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
    let names = read_texts(file, &layout::STATISTIC)?;
    if names.is_empty() {
        return Err("statistic is missing".into());
    }
    let estimate: Vec<f64> = read_variable(file, &layout::ESTIMATE)?;
    let standard_error: Vec<f64> = read_variable(file, &layout::STANDARD_ERROR)?;
    let low: Vec<f64> = read_variable(file, &layout::INTERVAL_LOW)?;
    let high: Vec<f64> = read_variable(file, &layout::INTERVAL_HIGH)?;
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

/// Mean, standard deviation and quantiles of one variable, each with its interval.
type BandVariables = [(&'static layout::Variable, &'static [layout::Variable; 2]); 3];

const DISPLACEMENT: BandVariables = [
    (&layout::DISPLACEMENT_MEAN, &layout::DISPLACEMENT_MEAN_ENDS),
    (&layout::DISPLACEMENT_SD, &layout::DISPLACEMENT_SD_ENDS),
    (&layout::DISPLACEMENT_QUANTILE, &layout::DISPLACEMENT_QUANTILE_ENDS),
];
const VELOCITY: BandVariables = [
    (&layout::VELOCITY_MEAN, &layout::VELOCITY_MEAN_ENDS),
    (&layout::VELOCITY_SD, &layout::VELOCITY_SD_ENDS),
    (&layout::VELOCITY_QUANTILE, &layout::VELOCITY_QUANTILE_ENDS),
];
const TEMPERATURE: BandVariables = [
    (&layout::TEMPERATURE_MEAN, &layout::TEMPERATURE_MEAN_ENDS),
    (&layout::TEMPERATURE_SD, &layout::TEMPERATURE_SD_ENDS),
    (&layout::TEMPERATURE_QUANTILE, &layout::TEMPERATURE_QUANTILE_ENDS),
];

fn write_bands(place: &Place, bands: &Bands) -> Result<()> {
    let variables =
        [(DISPLACEMENT, &bands.displacement), (VELOCITY, &bands.velocity), (TEMPERATURE, &bands.temperature)];
    for ([mean, sd, quantiles], band) in variables {
        let values = &band.quantiles.iter().copied().collect::<Vec<_>>();
        let curves = [
            (mean, &band.mean, &band.mean_ends),
            (sd, &band.sd, &band.sd_ends),
            (quantiles, values, &band.quantile_ends),
        ];
        for ((variable, variables), curve, ends) in curves {
            place.put(variable, curve)?;
            put_ends(place, variables, ends)?;
        }
    }
    place.put(&layout::STATIC_PROBABILITY, &bands.static_probability)?;
    put_ends(place, &layout::STATIC_PROBABILITY_ENDS, &bands.static_probability_ends)
}

fn read_bands(file: &File) -> Result<Bands> {
    let band = |[mean, sd, quantiles]: BandVariables| -> Result<Band> {
        let ends = [mean.1, sd.1, quantiles.1].map(|variables| read_ends(file, variables));
        let [mean_ends, sd_ends, quantile_ends] = ends;
        let mean: Vec<f64> = read_or_empty(file, mean.0)?;
        let values: Vec<f64> = read_or_empty(file, quantiles.0)?;
        let levels = values.len().checked_div(mean.len()).unwrap_or(QUANTILE_LEVELS.len());
        Ok(Band {
            quantiles: Array2::from_shape_vec((levels, mean.len()), values)?,
            quantile_ends: quantile_ends?,
            sd: read_or_empty(file, sd.0)?,
            sd_ends: sd_ends?,
            mean,
            mean_ends: mean_ends?,
        })
    };
    Ok(Bands {
        time: read_or_empty(file, &layout::TIME)?,
        displacement: band(DISPLACEMENT)?,
        velocity: band(VELOCITY)?,
        temperature: band(TEMPERATURE)?,
        static_probability: read_or_empty(file, &layout::STATIC_PROBABILITY)?,
        static_probability_ends: read_ends(file, &layout::STATIC_PROBABILITY_ENDS)?,
    })
}

fn write_stick_durations(place: &Place, sticks: &StickDurations) -> Result<()> {
    let edges = &sticks.histogram.edges;
    place.put(&layout::DURATION_BIN, edges.get(1..).unwrap_or_default())?;
    place.put(&layout::DURATION_BIN_LOWER, edges.get(..edges.len().saturating_sub(1)).unwrap_or_default())?;
    place.put(&layout::STICK_DURATION_COUNT, &sticks.histogram.counts)?;
    put_ends(place, &layout::STICK_DURATION_COUNT_ENDS, &sticks.count_ends)?;
    place.put(&layout::STICK_DURATION_CENSORED_COUNT, &sticks.censored_counts)?;
    put_ends(place, &layout::STICK_DURATION_CENSORED_COUNT_ENDS, &sticks.censored_count_ends)?;
    place.put(&layout::STICK_DURATION_SURVIVAL, &sticks.survival)?;
    put_ends(place, &layout::STICK_DURATION_SURVIVAL_ENDS, &sticks.survival_ends)?;
    place.put(&layout::STICK_DURATION_QUANTILE, &sticks.quantiles)?;
    put_ends(place, &layout::STICK_DURATION_QUANTILE_ENDS, &sticks.quantile_ends)?;
    for (variable, count, variables, ends) in [
        (
            &layout::STICK_DURATION_COMPLETED,
            sticks.completed,
            &layout::STICK_DURATION_COMPLETED_ENDS,
            sticks.completed_ends,
        ),
        (
            &layout::STICK_DURATION_CENSORED,
            sticks.censored,
            &layout::STICK_DURATION_CENSORED_ENDS,
            sticks.censored_ends,
        ),
        (
            &layout::FIRST_STICK_COMPLETED,
            sticks.first_completed,
            &layout::FIRST_STICK_COMPLETED_ENDS,
            sticks.first_completed_ends,
        ),
        (
            &layout::FIRST_STICK_CENSORED,
            sticks.first_censored,
            &layout::FIRST_STICK_CENSORED_ENDS,
            sticks.first_censored_ends,
        ),
    ] {
        place.put(variable, &[count])?;
        put_scalar_ends(place, variables, ends)?;
    }
    Ok(())
}

fn read_stick_durations(file: &File, step: Option<f64>) -> Result<StickDurations> {
    let lower: Vec<f64> = read_or_empty(file, &layout::DURATION_BIN_LOWER)?;
    let upper: Vec<f64> = read_or_empty(file, &layout::DURATION_BIN)?;
    let edges = lower.into_iter().chain(upper.last().copied()).collect();
    Ok(StickDurations {
        step,
        completed: read_scalar(file, &layout::STICK_DURATION_COMPLETED)?,
        completed_ends: read_scalar_ends(file, &layout::STICK_DURATION_COMPLETED_ENDS)?,
        censored: read_scalar(file, &layout::STICK_DURATION_CENSORED)?,
        censored_ends: read_scalar_ends(file, &layout::STICK_DURATION_CENSORED_ENDS)?,
        first_completed: read_scalar(file, &layout::FIRST_STICK_COMPLETED)?,
        first_completed_ends: read_scalar_ends(file, &layout::FIRST_STICK_COMPLETED_ENDS)?,
        first_censored: read_scalar(file, &layout::FIRST_STICK_CENSORED)?,
        first_censored_ends: read_scalar_ends(file, &layout::FIRST_STICK_CENSORED_ENDS)?,
        histogram: Histogram { edges, counts: read_or_empty(file, &layout::STICK_DURATION_COUNT)? },
        count_ends: read_ends(file, &layout::STICK_DURATION_COUNT_ENDS)?,
        censored_counts: read_or_empty(file, &layout::STICK_DURATION_CENSORED_COUNT)?,
        censored_count_ends: read_ends(file, &layout::STICK_DURATION_CENSORED_COUNT_ENDS)?,
        survival: read_or_empty(file, &layout::STICK_DURATION_SURVIVAL)?,
        survival_ends: read_ends(file, &layout::STICK_DURATION_SURVIVAL_ENDS)?,
        quantiles: read_or_empty(file, &layout::STICK_DURATION_QUANTILE)?,
        quantile_ends: read_ends(file, &layout::STICK_DURATION_QUANTILE_ENDS)?,
    })
}

fn write_sub_phases(place: &Place, sub_phases: &SubPhaseCounts) -> Result<()> {
    let k: Vec<u32> = (1..).take(sub_phases.counts.len()).collect();
    place.put(&layout::SUB_PHASE, &k)?;
    place.put(&layout::SUB_PHASE_COUNT, &sub_phases.counts)?;
    put_ends(place, &layout::SUB_PHASE_COUNT_ENDS, &sub_phases.count_ends)?;
    place.put(&layout::SUB_PHASE_SHARE, &sub_phases.shares)?;
    put_ends(place, &layout::SUB_PHASE_SHARE_ENDS, &sub_phases.share_ends)?;
    place.put(&layout::SUB_PHASE_CENSORED, &[sub_phases.censored])?;
    put_scalar_ends(place, &layout::SUB_PHASE_CENSORED_ENDS, sub_phases.censored_ends)
}

fn write_periods(place: &Place, periods: &PeriodMoments) -> Result<()> {
    let n: Vec<u32> = (1..).take(periods.time.len()).collect();
    place.put(&layout::PERIOD, &n)?;
    place.put(&layout::PERIOD_TIME, &periods.time)?;
    place.put(&layout::DISPLACEMENT_PERIOD_MEAN, &periods.mean)?;
    put_ends(place, &layout::DISPLACEMENT_PERIOD_MEAN_ENDS, &periods.mean_ends)?;
    place.put(&layout::DISPLACEMENT_PERIOD_VARIANCE, &periods.variance)?;
    put_ends(place, &layout::DISPLACEMENT_PERIOD_VARIANCE_ENDS, &periods.variance_ends)
}

fn write_transient(place: &Place, transient: Option<Transient>) -> Result<()> {
    let Some(Transient { end, sticks, stick_ends, slips, slip_ends, displacement }) = transient else { return Ok(()) };
    place.put(&layout::TRANSIENT_END, &[end])?;
    place.put(&layout::TRANSIENT_STICKS, &[sticks])?;
    put_scalar_ends(place, &layout::TRANSIENT_STICKS_ENDS, stick_ends)?;
    place.put(&layout::TRANSIENT_SLIPS, &[slips])?;
    put_scalar_ends(place, &layout::TRANSIENT_SLIPS_ENDS, slip_ends)?;
    place.put(&layout::TRANSIENT_DISPLACEMENT, &[displacement.estimate])?;
    place.put(&layout::TRANSIENT_DISPLACEMENT_ERROR, &[displacement.standard_error])?;
    put_scalar_ends(place, &layout::TRANSIENT_DISPLACEMENT_ENDS, [displacement.low, displacement.high])
}

fn read_transient(file: &File) -> Result<Option<Transient>> {
    let Some(&end) = read_or_empty(file, &layout::TRANSIENT_END)?.first() else { return Ok(None) };
    let [low, high] = read_scalar_ends(file, &layout::TRANSIENT_DISPLACEMENT_ENDS)?;
    Ok(Some(Transient {
        end,
        sticks: read_scalar(file, &layout::TRANSIENT_STICKS)?,
        stick_ends: read_scalar_ends(file, &layout::TRANSIENT_STICKS_ENDS)?,
        slips: read_scalar(file, &layout::TRANSIENT_SLIPS)?,
        slip_ends: read_scalar_ends(file, &layout::TRANSIENT_SLIPS_ENDS)?,
        displacement: Measurement {
            estimate: read_scalar(file, &layout::TRANSIENT_DISPLACEMENT)?,
            standard_error: read_scalar(file, &layout::TRANSIENT_DISPLACEMENT_ERROR)?,
            low,
            high,
        },
    }))
}
