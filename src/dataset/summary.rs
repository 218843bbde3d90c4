//! The statistics of an ensemble. One walk writes them and reads them back.

use super::layout;
use super::walk::{Reading, Walk};
use super::{Destination, Source, columns_of, read_or_empty, read_variable, texts};
use crate::stats::{
    Band, Bands, Bias, Corrected, Densities, Dimension, Distribution, Estimate, Extremes, FirstSticks, Fluctuations,
    Histogram, LimitCycle, Line, Passages, PeriodMoments, PhaseLaw, QUANTILE_LEVELS, Spectrum, Statistic,
    SubPhaseCounts, Summary, Transient,
};
use crate::sums::{Ends, Measurement};
use ndarray::Array2;

/// Write the coordinates that are known before a run: quantile levels and times.
pub(crate) fn write_coordinates<D: Destination>(to: &mut D, time: &[f64]) -> Result<(), D::Error> {
    to.write_variable(&layout::QUANTILE, &QUANTILE_LEVELS)?;
    to.write_variable(&layout::TIME, time)
}

/// Write the names, meanings and units of these statistics.
pub(crate) fn write_statistics<D: Destination>(to: &mut D, statistics: &[Statistic]) -> Result<(), D::Error> {
    let of = |of: fn(Statistic) -> &'static str| texts(statistics.iter().map(|statistic| of(*statistic)));
    let units: Vec<String> = statistics.iter().map(|statistic| statistic.dimension().udunits(to.units())).collect();
    to.write_variable(&layout::STATISTIC, &of(Statistic::name))?;
    to.write_variable(&layout::STATISTIC_LONG_NAME, &of(Statistic::meaning))?;
    to.write_variable(&layout::STATISTIC_UNIT, &units)
}

/// Write all statistics of a run at its end.
pub(crate) fn write<D: Destination>(to: &mut D, summary: &Summary) -> Result<(), D::Error> {
    let asked: Vec<Statistic> = summary.reported().map(|e| e.statistic).collect();
    write_statistics(to, &asked)?;
    walk(to, &mut summary.clone(), &texts(asked.into_iter().map(Statistic::name)))
}

/// The statistics of a finished run; `step` is the step of its scheme, if it has one.
pub(crate) fn read<S: Source>(from: &S, completed_paths: u64, step: Option<f64>) -> Result<Summary, S::Error> {
    if read_variable::<S, f64>(from, &layout::QUANTILE)? != QUANTILE_LEVELS {
        return Err(format!("{} has other levels than this program", layout::QUANTILE.name).into());
    }
    let names: Vec<String> = read_variable(from, &layout::STATISTIC)?;
    let mut summary = Summary {
        completed_paths,
        diverged: Vec::new(),
        estimates: Statistic::ALL.map(|statistic| estimate_of(statistic, [f64::NAN; 7])),
        stick_durations: Distribution { step, ..Distribution::default() },
        first_sticks: FirstSticks::default(),
        laws: None,
        densities: None,
        spectrum: None,
        extremes: None,
        cycle: None,
        asked: names.iter().filter_map(|name| Statistic::from_name(name)).collect(),
        sub_phases: SubPhaseCounts::default(),
        transient: None,
        periods: PeriodMoments::default(),
        bands: Bands { time: read_or_empty(from, &layout::TIME)?, ..Bands::default() },
    };
    walk(&mut Reading(from), &mut summary, &names)?;
    if let Some(laws) = &mut summary.laws {
        let of_time = laws.iter_mut().zip(PhaseLaw::ASKED).filter(|(_, law)| law.dimension() == Dimension::TIME);
        of_time.for_each(|(distribution, _)| distribution.step = step);
    }
    Ok(summary)
}

/// Walk over all statistics; `names` are those of the data set. Another minor version may have
/// fewer or more of them.
fn walk<W: Walk>(walk: &mut W, summary: &mut Summary, names: &[String]) -> Result<(), W::Error> {
    let Summary {
        completed_paths: _,
        diverged,
        estimates,
        stick_durations,
        first_sticks,
        laws,
        sub_phases,
        transient,
        periods,
        bands,
        densities,
        spectrum,
        extremes,
        cycle,
        asked: _,
    } = summary;
    walk_estimates(walk, estimates, names)?;
    walk_bands(walk, bands)?;
    walk.present(&layout::of_law(PhaseLaw::Slip).completed, laws);
    walk_law(walk, &layout::of_law(PhaseLaw::Stick), stick_durations)?;
    walk_first_sticks(walk, first_sticks)?;
    for (law, distribution) in PhaseLaw::ASKED.into_iter().zip(laws.iter_mut().flatten()) {
        walk_law(walk, &layout::of_law(law), distribution)?;
    }
    walk_sub_phases(walk, sub_phases)?;
    walk_periods(walk, periods)?;
    if let Some(densities) = walk.present(&layout::REST_SHARE.value, densities) {
        walk_densities(walk, densities)?;
    }
    if let Some(extremes) = walk.present(&layout::LEVEL, extremes) {
        walk_extremes(walk, extremes)?;
    }
    if let Some(spectrum) = walk.present(&layout::SPECTRUM_SEGMENTS, spectrum) {
        walk_spectrum(walk, spectrum)?;
    }
    if let Some(cycle) = walk.present(&layout::CYCLE, cycle) {
        walk_cycle(walk, cycle)?;
    }
    if let Some(transient) = walk.present(&layout::TRANSIENT_END, transient) {
        walk_transient(walk, transient)?;
    }
    walk.variable(&layout::DIVERGED_PATH, diverged)
}

/// One estimate for each entry of `Statistic::ALL`.
type Estimates = [Estimate; Statistic::ALL.len()];

/// The variables with one value for each statistic.
const PER_STATISTIC: [layout::Variable; 7] = [
    layout::ESTIMATE,
    layout::STANDARD_ERROR,
    layout::INTERVAL_LOW,
    layout::INTERVAL_HIGH,
    layout::BIAS,
    layout::BIAS_UNCERTAINTY,
    layout::BIAS_ORDER,
];

/// The numbers of an estimate in the order of these variables; NaN where it is unknown.
pub(super) fn numbers_of(e: &Estimate) -> [f64; 7] {
    let Bias { estimate, uncertainty, order } =
        e.bias.unwrap_or(Bias { estimate: f64::NAN, uncertainty: f64::NAN, order: None });
    [e.estimate, e.standard_error, e.low, e.high, estimate, uncertainty, order.unwrap_or(f64::NAN)]
}

/// The estimate with these numbers.
pub(super) fn estimate_of(statistic: Statistic, numbers: [f64; 7]) -> Estimate {
    let [estimate, standard_error, low, high, bias, uncertainty, order] = numbers;
    let order = Some(order).filter(|order| !order.is_nan());
    let bias = Some(bias).filter(|bias| !bias.is_nan()).map(|estimate| Bias { estimate, uncertainty, order });
    Estimate { statistic, estimate, standard_error, low, high, bias }
}

/// The corrected estimate with its interval; NaN where there is none.
pub(super) fn corrected_of(e: &Estimate) -> [f64; 3] {
    e.corrected().map_or([f64::NAN; 3], |Corrected { estimate, low, high }| [estimate, low, high])
}

fn walk_estimates<W: Walk>(walk: &mut W, estimates: &mut Estimates, names: &[String]) -> Result<(), W::Error> {
    let is_there = |e: &&Estimate| names.iter().any(|name| name == e.statistic.name());
    let mut columns = columns_of(estimates.iter().filter(is_there).map(numbers_of));
    for (variable, values) in PER_STATISTIC.iter().zip(&mut columns) {
        walk.variable(variable, values)?;
    }
    for estimate in estimates.iter_mut() {
        let row = names.iter().position(|name| name == estimate.statistic.name());
        let numbers = columns.each_ref().map(|values| row.and_then(|row| values.get(row).copied()).unwrap_or(f64::NAN));
        *estimate = estimate_of(estimate.statistic, numbers);
    }
    // What follows from the estimates and their biases is left out if no statistic has it.
    if estimates.iter().all(|estimate| estimate.corrected().is_none()) {
        return Ok(());
    }
    let corrected = columns_of(estimates.iter().filter(is_there).map(corrected_of));
    let variables = [&layout::ESTIMATE_CORRECTED, &layout::ESTIMATE_CORRECTED_LOW, &layout::ESTIMATE_CORRECTED_HIGH];
    variables.into_iter().zip(&corrected).try_for_each(|(variable, values)| walk.derived(variable, values))
}

fn walk_bands<W: Walk>(walk: &mut W, bands: &mut Bands) -> Result<(), W::Error> {
    let Bands { time: _, displacement, velocity, temperature, static_probability, static_probability_ends } = bands;
    for ([mean, sd, quantile], band) in
        [(layout::DISPLACEMENT, displacement), (layout::VELOCITY, velocity), (layout::TEMPERATURE, temperature)]
    {
        let Band { mean: values, mean_ends, sd: sds, sd_ends, quantiles, quantile_ends } = band;
        let mut matrix = quantiles.iter().copied().collect();
        walk.curve(&mean, values, mean_ends)?;
        walk.curve(&sd, sds, sd_ends)?;
        walk.curve(&quantile, &mut matrix, quantile_ends)?;
        let levels = matrix.len().checked_div(values.len()).unwrap_or(QUANTILE_LEVELS.len());
        match Array2::from_shape_vec((levels, values.len()), matrix) {
            Ok(matrix) => *quantiles = matrix,
            Err(error) => walk.refuse(error.to_string())?,
        }
    }
    walk.curve(&layout::STATIC_PROBABILITY, static_probability, static_probability_ends)
}

fn walk_law<W: Walk>(walk: &mut W, layout: &layout::LawLayout, law: &mut Distribution) -> Result<(), W::Error> {
    let Distribution {
        step: _,
        completed,
        censored,
        histogram: Histogram { edges, counts },
        censored_counts,
        survival,
        survival_ends,
        quantiles,
        quantile_ends,
    } = law;
    walk_edges(walk, [&layout.bin, &layout.bin_lower], edges)?;
    walk.variable(&layout.count, counts)?;
    walk.variable(&layout.censored_count, censored_counts)?;
    walk.curve(&layout.survival, survival, survival_ends)?;
    walk.curve(&layout.quantile, quantiles, quantile_ends)?;
    walk.scalar(&layout.completed, completed)?;
    walk.scalar(&layout.censored, censored)
}

fn walk_first_sticks<W: Walk>(walk: &mut W, sticks: &mut FirstSticks) -> Result<(), W::Error> {
    let FirstSticks { completed, censored } = sticks;
    walk.scalar(&layout::FIRST_STICK_COMPLETED, completed)?;
    walk.scalar(&layout::FIRST_STICK_CENSORED, censored)
}

/// The edges of bins: the upper and the lower one of each.
fn walk_edges<W: Walk>(
    walk: &mut W,
    [upper, lower]: [&layout::Variable; 2],
    edges: &mut Vec<f64>,
) -> Result<(), W::Error> {
    let mut below = edges.get(..edges.len().saturating_sub(1)).unwrap_or_default().to_vec();
    let mut above = edges.get(1..).unwrap_or_default().to_vec();
    walk.variable(upper, &mut above)?;
    walk.variable(lower, &mut below)?;
    *edges = below.into_iter().chain(above.last().copied()).collect();
    Ok(())
}

fn walk_densities<W: Walk>(walk: &mut W, densities: &mut Densities) -> Result<(), W::Error> {
    let Densities { displacement, velocity, joint_edges, joint, at_rest, at_rest_ends } = densities;
    walk.number(&layout::REST_SHARE, at_rest, at_rest_ends)?;
    walk_edges(walk, [&layout::DISPLACEMENT_BIN, &layout::DISPLACEMENT_BIN_LOWER], &mut displacement.edges)?;
    walk.curve(&layout::DISPLACEMENT_DENSITY, &mut displacement.density, &mut displacement.ends)?;
    walk_edges(walk, [&layout::VELOCITY_BIN, &layout::VELOCITY_BIN_LOWER], &mut velocity.edges)?;
    walk.curve(&layout::VELOCITY_DENSITY, &mut velocity.density, &mut velocity.ends)?;
    let [rows, columns] = joint_edges;
    walk_edges(walk, [&layout::JOINT_DISPLACEMENT_BIN, &layout::JOINT_DISPLACEMENT_BIN_LOWER], rows)?;
    walk_edges(walk, [&layout::JOINT_VELOCITY_BIN, &layout::JOINT_VELOCITY_BIN_LOWER], columns)?;
    let shape = (rows.len().saturating_sub(1), columns.len().saturating_sub(1));
    let mut values = joint.iter().copied().collect();
    walk.variable(&layout::JOINT_DENSITY, &mut values)?;
    match Array2::from_shape_vec(shape, values) {
        Ok(matrix) => *joint = matrix,
        Err(error) => walk.refuse(error.to_string())?,
    }
    Ok(())
}

fn walk_extremes<W: Walk>(walk: &mut W, extremes: &mut Extremes) -> Result<(), W::Error> {
    let Extremes { displacement, velocity, passages } = extremes;
    for (layout, law) in layout::EXTREMES.iter().zip([displacement, velocity]) {
        walk_law(walk, layout, law)?;
    }
    let mut levels: Vec<f64> = passages.iter().map(|of| of.level).collect();
    let mut survival: Vec<f64> = passages.iter().flat_map(|of| of.survival.clone()).collect();
    let ends = passages.iter().flat_map(|of| (0..of.survival.len()).map(|row| of.survival_ends.at(row)));
    let mut ends: Ends = ends.collect();
    walk.variable(&layout::LEVEL, &mut levels)?;
    walk.curve(&layout::PASSAGE_SURVIVAL, &mut survival, &mut ends)?;
    let rows = survival.len() / levels.len().max(1);
    let of_level = |(i, level): (usize, &f64)| Passages {
        level: *level,
        survival: survival[i * rows..(i + 1) * rows].to_vec(),
        survival_ends: (i * rows..(i + 1) * rows).map(|row| ends.at(row)).collect(),
    };
    *passages = levels.iter().enumerate().map(of_level).collect();
    Ok(())
}

fn walk_spectrum<W: Walk>(walk: &mut W, spectrum: &mut Spectrum) -> Result<(), W::Error> {
    let Spectrum { segments, lag, frequency, displacement, velocity, lines } = spectrum;
    walk.scalar(&layout::SPECTRUM_SEGMENTS, segments)?;
    walk.variable(&layout::LAG, lag)?;
    walk.variable(&layout::FREQUENCY, frequency)?;
    let of = [
        (displacement, layout::DISPLACEMENT_AUTOCOVARIANCE, layout::DISPLACEMENT_SPECTRUM),
        (velocity, layout::VELOCITY_AUTOCOVARIANCE, layout::VELOCITY_SPECTRUM),
    ];
    for (fluctuations, covariance, power) in of {
        let Fluctuations { autocovariance, autocovariance_ends, spectrum, spectrum_ends } = fluctuations;
        walk.curve(&covariance, autocovariance, autocovariance_ends)?;
        walk.curve(&power, spectrum, spectrum_ends)?;
    }
    let [mut at, mut x, mut v] =
        columns_of(lines.iter().map(|line| [line.frequency, line.displacement, line.velocity]));
    walk.variable(&layout::LINE_FREQUENCY, &mut at)?;
    walk.variable(&layout::DISPLACEMENT_LINE, &mut x)?;
    walk.variable(&layout::VELOCITY_LINE, &mut v)?;
    let line = |((frequency, displacement), velocity)| Line { frequency, displacement, velocity };
    *lines = at.into_iter().zip(x).zip(v).map(line).collect();
    Ok(())
}

fn walk_cycle<W: Walk>(walk: &mut W, cycle: &mut LimitCycle) -> Result<(), W::Error> {
    let (mut numbers, mut section) = (cycle.numbers().to_vec(), std::mem::take(&mut cycle.section));
    walk.derived(&layout::CYCLE_NUMBER, &texts(LimitCycle::NUMBERS))?;
    walk.derived(&layout::SECTION_STATE, &(0..section.len() as u32).collect::<Vec<u32>>())?;
    walk.sized(&layout::CYCLE, &mut numbers, LimitCycle::NUMBERS.len())?;
    walk.variable(&layout::SECTION, &mut section)?;
    *cycle = LimitCycle::of_numbers(std::array::from_fn(|i| numbers[i]), &section);
    Ok(())
}

fn walk_sub_phases<W: Walk>(walk: &mut W, sub_phases: &mut SubPhaseCounts) -> Result<(), W::Error> {
    let SubPhaseCounts { counts, shares, share_ends, censored } = sub_phases;
    walk.derived(&layout::SUB_PHASE, &(1..).take(counts.len()).collect::<Vec<u32>>())?;
    walk.variable(&layout::SUB_PHASE_COUNT, counts)?;
    walk.curve(&layout::SUB_PHASE_SHARE, shares, share_ends)?;
    walk.scalar(&layout::SUB_PHASE_CENSORED, censored)
}

fn walk_periods<W: Walk>(walk: &mut W, periods: &mut PeriodMoments) -> Result<(), W::Error> {
    let PeriodMoments { drift_limit, time, mean, mean_ends, variance, variance_ends } = periods;
    if let Some(limit) = walk.present(&layout::DRIFT_LIMIT, drift_limit) {
        walk.scalar(&layout::DRIFT_LIMIT, limit)?;
    }
    walk.derived(&layout::PERIOD, &(1..).take(time.len()).collect::<Vec<u32>>())?;
    walk.variable(&layout::PERIOD_TIME, time)?;
    walk.curve(&layout::DISPLACEMENT_PERIOD_MEAN, mean, mean_ends)?;
    walk.curve(&layout::DISPLACEMENT_PERIOD_VARIANCE, variance, variance_ends)
}

fn walk_transient<W: Walk>(walk: &mut W, transient: &mut Transient) -> Result<(), W::Error> {
    let Transient { end, sticks, slips, displacement } = transient;
    let Measurement { estimate, standard_error, low, high } = displacement;
    walk.scalar(&layout::TRANSIENT_END, end)?;
    walk.scalar(&layout::TRANSIENT_STICKS, sticks)?;
    walk.scalar(&layout::TRANSIENT_SLIPS, slips)?;
    walk.scalar(&layout::TRANSIENT_DISPLACEMENT.value, estimate)?;
    walk.scalar(&layout::TRANSIENT_DISPLACEMENT_ERROR, standard_error)?;
    walk.scalar(&layout::TRANSIENT_DISPLACEMENT.low, low)?;
    walk.scalar(&layout::TRANSIENT_DISPLACEMENT.high, high)
}
