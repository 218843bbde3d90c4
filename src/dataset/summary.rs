//! The statistics of an ensemble. Writing and reading are side by side, so that they agree.

use super::layout;
use super::{Destination, Source, read_or_empty, read_scalar, read_variable, texts};
use crate::stats::{
    Band, Bands, Bias, Corrected, Estimate, Histogram, PeriodMoments, QUANTILE_LEVELS, Statistic, StickDurations,
    SubPhaseCounts, Summary, Transient,
};
use crate::sums::{Ends, Measurement};
use ndarray::Array2;

/// Write the coordinates that are known before a run: statistics, quantile levels, and times.
pub(crate) fn write_coordinates<D: Destination>(to: &mut D, time: &[f64]) -> Result<(), D::Error> {
    write_statistics(to)?;
    to.write_variable(&layout::QUANTILE, &QUANTILE_LEVELS)?;
    to.write_variable(&layout::TIME, time)
}

/// Write the names, meanings and units of all statistics.
pub(crate) fn write_statistics<D: Destination>(to: &mut D) -> Result<(), D::Error> {
    let units = Statistic::ALL.map(|statistic| statistic.dimension().udunits(to.units()));
    to.write_variable(&layout::STATISTIC, &texts(Statistic::ALL.map(Statistic::name)))?;
    to.write_variable(&layout::STATISTIC_LONG_NAME, &texts(Statistic::ALL.map(Statistic::meaning)))?;
    to.write_variable(&layout::STATISTIC_UNIT, &units)
}

/// Write all statistics of a run at its end.
pub(crate) fn write<D: Destination>(to: &mut D, summary: &Summary) -> Result<(), D::Error> {
    write_estimates(to, &summary.estimates)?;
    write_bands(to, &summary.bands)?;
    write_stick_durations(to, &summary.stick_durations)?;
    write_sub_phases(to, &summary.sub_phases)?;
    write_periods(to, &summary.periods)?;
    write_transient(to, summary.transient)?;
    to.write_variable(&layout::DIVERGED_PATH, &summary.diverged)
}

/// The statistics of a finished run; `step` is the step of its scheme, if it has one.
pub(crate) fn read<S: Source>(from: &S, completed_paths: u64, step: Option<f64>) -> Result<Summary, S::Error> {
    if read_variable::<S, f64>(from, &layout::QUANTILE)? != QUANTILE_LEVELS {
        return Err(format!("{} has other levels than this program", layout::QUANTILE.name).into());
    }
    Ok(Summary {
        completed_paths,
        diverged: read_or_empty(from, &layout::DIVERGED_PATH)?,
        estimates: read_estimates(from)?,
        stick_durations: read_stick_durations(from, step)?,
        sub_phases: SubPhaseCounts {
            counts: read_or_empty(from, &layout::SUB_PHASE_COUNT)?,
            count_ends: read_ends(from, &layout::SUB_PHASE_COUNT_ENDS)?,
            shares: read_or_empty(from, &layout::SUB_PHASE_SHARE)?,
            share_ends: read_ends(from, &layout::SUB_PHASE_SHARE_ENDS)?,
            censored: read_scalar(from, &layout::SUB_PHASE_CENSORED)?,
            censored_ends: read_scalar_ends(from, &layout::SUB_PHASE_CENSORED_ENDS)?,
        },
        transient: read_transient(from)?,
        periods: PeriodMoments {
            time: read_or_empty(from, &layout::PERIOD_TIME)?,
            mean: read_or_empty(from, &layout::DISPLACEMENT_PERIOD_MEAN)?,
            mean_ends: read_ends(from, &layout::DISPLACEMENT_PERIOD_MEAN_ENDS)?,
            variance: read_or_empty(from, &layout::DISPLACEMENT_PERIOD_VARIANCE)?,
            variance_ends: read_ends(from, &layout::DISPLACEMENT_PERIOD_VARIANCE_ENDS)?,
        },
        bands: read_bands(from)?,
    })
}

/// Write the ends of the intervals of a curve.
fn write_ends<D: Destination>(to: &mut D, [low, high]: &[layout::Variable; 2], ends: &Ends) -> Result<(), D::Error> {
    to.write_variable(low, &ends.low)?;
    to.write_variable(high, &ends.high)
}

/// Write the ends of the interval of a single number.
fn write_scalar_ends<D: Destination>(
    to: &mut D,
    variables: &[layout::Variable; 2],
    ends: [f64; 2],
) -> Result<(), D::Error> {
    write_ends(to, variables, &Ends::from_iter([ends]))
}

/// Read the ends of the intervals of a curve.
fn read_ends<S: Source>(from: &S, [low, high]: &[layout::Variable; 2]) -> Result<Ends, S::Error> {
    Ok(Ends { low: read_or_empty(from, low)?, high: read_or_empty(from, high)? })
}

/// Read the ends of the interval of a single number.
fn read_scalar_ends<S: Source>(from: &S, [low, high]: &[layout::Variable; 2]) -> Result<[f64; 2], S::Error> {
    Ok([read_scalar(from, low)?, read_scalar(from, high)?])
}

/// One estimate for each entry of `Statistic::ALL`.
type Estimates = [Estimate; Statistic::ALL.len()];

/// A value of an estimate; NaN where it is unknown.
type Field = fn(&Estimate) -> f64;

fn write_estimates<D: Destination>(to: &mut D, estimates: &Estimates) -> Result<(), D::Error> {
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
        to.write_variable(variable, &estimates.each_ref().map(field))?;
    }
    write_corrected(to, estimates)
}

/// Write the corrected estimates, if any statistic has one. They are not read back, because they
/// follow from the estimates and their biases.
fn write_corrected<D: Destination>(to: &mut D, estimates: &Estimates) -> Result<(), D::Error> {
    let corrected = estimates.each_ref().map(Estimate::corrected);
    if corrected.iter().all(Option::is_none) {
        return Ok(());
    }
    let each = |of: fn(Corrected) -> f64| corrected.map(|corrected| corrected.map_or(f64::NAN, of));
    to.write_variable(&layout::ESTIMATE_CORRECTED, &each(|c| c.estimate))?;
    to.write_variable(&layout::ESTIMATE_CORRECTED_LOW, &each(|c| c.low))?;
    to.write_variable(&layout::ESTIMATE_CORRECTED_HIGH, &each(|c| c.high))
}

/// Read the estimates. Statistics are found by name, because another minor version may have fewer
/// or more of them.
fn read_estimates<S: Source>(from: &S) -> Result<Estimates, S::Error> {
    let names: Vec<String> = read_or_empty(from, &layout::STATISTIC)?;
    if names.is_empty() {
        return Err("statistic is missing".to_string().into());
    }
    let estimate: Vec<f64> = read_variable(from, &layout::ESTIMATE)?;
    let standard_error: Vec<f64> = read_variable(from, &layout::STANDARD_ERROR)?;
    let low: Vec<f64> = read_variable(from, &layout::INTERVAL_LOW)?;
    let high: Vec<f64> = read_variable(from, &layout::INTERVAL_HIGH)?;
    let bias: Vec<f64> = read_or_empty(from, &layout::BIAS)?;
    let uncertainty: Vec<f64> = read_or_empty(from, &layout::BIAS_UNCERTAINTY)?;
    let order: Vec<f64> = read_or_empty(from, &layout::BIAS_ORDER)?;
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

fn write_bands<D: Destination>(to: &mut D, bands: &Bands) -> Result<(), D::Error> {
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
            to.write_variable(variable, curve)?;
            write_ends(to, variables, ends)?;
        }
    }
    to.write_variable(&layout::STATIC_PROBABILITY, &bands.static_probability)?;
    write_ends(to, &layout::STATIC_PROBABILITY_ENDS, &bands.static_probability_ends)
}

fn read_bands<S: Source>(from: &S) -> Result<Bands, S::Error> {
    let band = |[mean, sd, quantiles]: BandVariables| -> Result<Band, S::Error> {
        let ends = [mean.1, sd.1, quantiles.1].map(|variables| read_ends(from, variables));
        let [mean_ends, sd_ends, quantile_ends] = ends;
        let mean: Vec<f64> = read_or_empty(from, mean.0)?;
        let values: Vec<f64> = read_or_empty(from, quantiles.0)?;
        let levels = values.len().checked_div(mean.len()).unwrap_or(QUANTILE_LEVELS.len());
        Ok(Band {
            quantiles: Array2::from_shape_vec((levels, mean.len()), values).map_err(|error| error.to_string())?,
            quantile_ends: quantile_ends?,
            sd: read_or_empty(from, sd.0)?,
            sd_ends: sd_ends?,
            mean,
            mean_ends: mean_ends?,
        })
    };
    Ok(Bands {
        time: read_or_empty(from, &layout::TIME)?,
        displacement: band(DISPLACEMENT)?,
        velocity: band(VELOCITY)?,
        temperature: band(TEMPERATURE)?,
        static_probability: read_or_empty(from, &layout::STATIC_PROBABILITY)?,
        static_probability_ends: read_ends(from, &layout::STATIC_PROBABILITY_ENDS)?,
    })
}

fn write_stick_durations<D: Destination>(to: &mut D, sticks: &StickDurations) -> Result<(), D::Error> {
    let edges = &sticks.histogram.edges;
    to.write_variable(&layout::DURATION_BIN, edges.get(1..).unwrap_or_default())?;
    to.write_variable(&layout::DURATION_BIN_LOWER, edges.get(..edges.len().saturating_sub(1)).unwrap_or_default())?;
    to.write_variable(&layout::STICK_DURATION_COUNT, &sticks.histogram.counts)?;
    write_ends(to, &layout::STICK_DURATION_COUNT_ENDS, &sticks.count_ends)?;
    to.write_variable(&layout::STICK_DURATION_CENSORED_COUNT, &sticks.censored_counts)?;
    write_ends(to, &layout::STICK_DURATION_CENSORED_COUNT_ENDS, &sticks.censored_count_ends)?;
    to.write_variable(&layout::STICK_DURATION_SURVIVAL, &sticks.survival)?;
    write_ends(to, &layout::STICK_DURATION_SURVIVAL_ENDS, &sticks.survival_ends)?;
    to.write_variable(&layout::STICK_DURATION_QUANTILE, &sticks.quantiles)?;
    write_ends(to, &layout::STICK_DURATION_QUANTILE_ENDS, &sticks.quantile_ends)?;
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
        to.write_variable(variable, &[count])?;
        write_scalar_ends(to, variables, ends)?;
    }
    Ok(())
}

fn read_stick_durations<S: Source>(from: &S, step: Option<f64>) -> Result<StickDurations, S::Error> {
    let lower: Vec<f64> = read_or_empty(from, &layout::DURATION_BIN_LOWER)?;
    let upper: Vec<f64> = read_or_empty(from, &layout::DURATION_BIN)?;
    let edges = lower.into_iter().chain(upper.last().copied()).collect();
    Ok(StickDurations {
        step,
        completed: read_scalar(from, &layout::STICK_DURATION_COMPLETED)?,
        completed_ends: read_scalar_ends(from, &layout::STICK_DURATION_COMPLETED_ENDS)?,
        censored: read_scalar(from, &layout::STICK_DURATION_CENSORED)?,
        censored_ends: read_scalar_ends(from, &layout::STICK_DURATION_CENSORED_ENDS)?,
        first_completed: read_scalar(from, &layout::FIRST_STICK_COMPLETED)?,
        first_completed_ends: read_scalar_ends(from, &layout::FIRST_STICK_COMPLETED_ENDS)?,
        first_censored: read_scalar(from, &layout::FIRST_STICK_CENSORED)?,
        first_censored_ends: read_scalar_ends(from, &layout::FIRST_STICK_CENSORED_ENDS)?,
        histogram: Histogram { edges, counts: read_or_empty(from, &layout::STICK_DURATION_COUNT)? },
        count_ends: read_ends(from, &layout::STICK_DURATION_COUNT_ENDS)?,
        censored_counts: read_or_empty(from, &layout::STICK_DURATION_CENSORED_COUNT)?,
        censored_count_ends: read_ends(from, &layout::STICK_DURATION_CENSORED_COUNT_ENDS)?,
        survival: read_or_empty(from, &layout::STICK_DURATION_SURVIVAL)?,
        survival_ends: read_ends(from, &layout::STICK_DURATION_SURVIVAL_ENDS)?,
        quantiles: read_or_empty(from, &layout::STICK_DURATION_QUANTILE)?,
        quantile_ends: read_ends(from, &layout::STICK_DURATION_QUANTILE_ENDS)?,
    })
}

fn write_sub_phases<D: Destination>(to: &mut D, sub_phases: &SubPhaseCounts) -> Result<(), D::Error> {
    let k: Vec<u32> = (1..).take(sub_phases.counts.len()).collect();
    to.write_variable(&layout::SUB_PHASE, &k)?;
    to.write_variable(&layout::SUB_PHASE_COUNT, &sub_phases.counts)?;
    write_ends(to, &layout::SUB_PHASE_COUNT_ENDS, &sub_phases.count_ends)?;
    to.write_variable(&layout::SUB_PHASE_SHARE, &sub_phases.shares)?;
    write_ends(to, &layout::SUB_PHASE_SHARE_ENDS, &sub_phases.share_ends)?;
    to.write_variable(&layout::SUB_PHASE_CENSORED, &[sub_phases.censored])?;
    write_scalar_ends(to, &layout::SUB_PHASE_CENSORED_ENDS, sub_phases.censored_ends)
}

fn write_periods<D: Destination>(to: &mut D, periods: &PeriodMoments) -> Result<(), D::Error> {
    let n: Vec<u32> = (1..).take(periods.time.len()).collect();
    to.write_variable(&layout::PERIOD, &n)?;
    to.write_variable(&layout::PERIOD_TIME, &periods.time)?;
    to.write_variable(&layout::DISPLACEMENT_PERIOD_MEAN, &periods.mean)?;
    write_ends(to, &layout::DISPLACEMENT_PERIOD_MEAN_ENDS, &periods.mean_ends)?;
    to.write_variable(&layout::DISPLACEMENT_PERIOD_VARIANCE, &periods.variance)?;
    write_ends(to, &layout::DISPLACEMENT_PERIOD_VARIANCE_ENDS, &periods.variance_ends)
}

fn write_transient<D: Destination>(to: &mut D, transient: Option<Transient>) -> Result<(), D::Error> {
    let Some(Transient { end, sticks, stick_ends, slips, slip_ends, displacement }) = transient else { return Ok(()) };
    to.write_variable(&layout::TRANSIENT_END, &[end])?;
    to.write_variable(&layout::TRANSIENT_STICKS, &[sticks])?;
    write_scalar_ends(to, &layout::TRANSIENT_STICKS_ENDS, stick_ends)?;
    to.write_variable(&layout::TRANSIENT_SLIPS, &[slips])?;
    write_scalar_ends(to, &layout::TRANSIENT_SLIPS_ENDS, slip_ends)?;
    to.write_variable(&layout::TRANSIENT_DISPLACEMENT, &[displacement.estimate])?;
    to.write_variable(&layout::TRANSIENT_DISPLACEMENT_ERROR, &[displacement.standard_error])?;
    write_scalar_ends(to, &layout::TRANSIENT_DISPLACEMENT_ENDS, [displacement.low, displacement.high])
}

fn read_transient<S: Source>(from: &S) -> Result<Option<Transient>, S::Error> {
    if !from.has(layout::TRANSIENT_END.name) {
        return Ok(None);
    }
    let end = read_scalar(from, &layout::TRANSIENT_END)?;
    let [low, high] = read_scalar_ends(from, &layout::TRANSIENT_DISPLACEMENT_ENDS)?;
    Ok(Some(Transient {
        end,
        sticks: read_scalar(from, &layout::TRANSIENT_STICKS)?,
        stick_ends: read_scalar_ends(from, &layout::TRANSIENT_STICKS_ENDS)?,
        slips: read_scalar(from, &layout::TRANSIENT_SLIPS)?,
        slip_ends: read_scalar_ends(from, &layout::TRANSIENT_SLIPS_ENDS)?,
        displacement: Measurement {
            estimate: read_scalar(from, &layout::TRANSIENT_DISPLACEMENT)?,
            standard_error: read_scalar(from, &layout::TRANSIENT_DISPLACEMENT_ERROR)?,
            low,
            high,
        },
    }))
}
