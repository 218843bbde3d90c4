//! The statistics of an ensemble. One walk writes them and reads them back.

use super::layout;
use super::walk::{Walk, Walked};
use super::{
    Attribute, Dataset, Element, Source, columns_of, counted, read_or_empty, read_variable, texts,
};
use crate::stats::{
    Band, Bands, Bias, Corrected, Densities, Dimension, Distribution, Estimate, Extremes,
    FirstSticks, Fluctuations, LimitCycle, Line, Passages, PeriodMoments, PhaseLaw,
    QUANTILE_LEVELS, Spectrum, Statistic, SubPhaseCounts, Summary, Transient,
};
use crate::sums::{Ends, Measurement};
use ndarray::Array2;

/// Write the coordinates that are known before a run: quantile levels and times.
pub fn write_coordinates(to: &mut Dataset, time: &[f64]) {
    to.write(&layout::BOUND, &texts(["low", "high"]));
    to.write(&layout::QUANTILE, &QUANTILE_LEVELS);
    to.write(&layout::TIME, time)
}

/// Write the names, meanings and units of these statistics.
pub fn write_statistics(to: &mut Dataset, statistics: &[Statistic]) {
    let of = |of: fn(Statistic) -> &'static str| {
        texts(statistics.iter().map(|statistic| of(*statistic)))
    };
    to.write(&layout::STATISTIC, &of(Statistic::name));
    to.write(&layout::STATISTIC_LONG_NAME, &of(Statistic::meaning));
    to.write_units(
        &layout::STATISTIC_UNIT,
        statistics.iter().map(|statistic| statistic.dimension()),
    );
}

/// Write all statistics of a run at its end.
pub fn write(to: &mut Dataset, summary: &Summary) {
    let asked: Vec<Statistic> = summary.reported().map(|e| e.statistic).collect();
    write_statistics(to, &asked);
    to.write_by(|to| {
        walk(
            to,
            &mut summary.clone(),
            &texts(asked.into_iter().map(Statistic::name)),
        )
    });
}

/// The statistics of a finished run; `step` is the step of its scheme, if it has one.
pub fn read(from: &dyn Source, completed_paths: u64, step: Option<f64>) -> Result<Summary, String> {
    if read_variable::<f64>(from, &layout::QUANTILE)? != QUANTILE_LEVELS {
        return Err(format!(
            "{} has different levels from this program",
            layout::QUANTILE.name
        ));
    }
    let names: Vec<String> = read_variable(from, &layout::STATISTIC)?;
    let mut summary = Summary {
        completed_paths,
        diverged: Vec::new(),
        estimates: Statistic::ALL.map(|statistic| estimate_of(statistic, [f64::NAN; 7])),
        stick_durations: Distribution {
            step,
            ..Distribution::default()
        },
        first_sticks: FirstSticks::default(),
        laws: None,
        densities: None,
        spectrum: None,
        extremes: None,
        cycle: None,
        asked: names
            .iter()
            .filter_map(|name| Statistic::from_name(name))
            .collect(),
        sub_phases: SubPhaseCounts::default(),
        transient: None,
        periods: PeriodMoments::default(),
        bands: Bands {
            time: read_or_empty(from, &layout::TIME)?,
            ..Bands::default()
        },
    };
    walk(&mut Walk::Reading(from), &mut summary, &names)?;
    if let Some(laws) = &mut summary.laws {
        let of_time = laws
            .iter_mut()
            .zip(PhaseLaw::ASKED)
            .filter(|(_, law)| law.dimension() == Dimension::TIME);
        of_time.for_each(|(distribution, _)| distribution.step = step);
    }
    Ok(summary)
}

/// Walk over all statistics; `names` are those of the data set. Another minor version may have
/// fewer or more of them.
fn walk(walk: &mut Walk, summary: &mut Summary, names: &[String]) -> Walked {
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
    walk_laws(walk, stick_durations, laws, extremes)?;
    walk.scalar(&layout::FIRST_STICK_COMPLETED, &mut first_sticks.completed)?;
    walk.scalar(&layout::FIRST_STICK_CENSORED, &mut first_sticks.censored)?;
    walk_sub_phases(walk, sub_phases)?;
    walk_periods(walk, periods)?;
    if let Some(densities) = walk.present(&layout::REST_SHARE.value, densities) {
        walk_densities(walk, densities)?;
    }
    if let Some(extremes) = extremes {
        walk_passages(walk, &mut extremes.passages)?;
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
pub(super) const PER_STATISTIC: [layout::Variable; 7] = [
    layout::ESTIMATE,
    layout::STANDARD_ERROR,
    layout::INTERVAL_LOW,
    layout::INTERVAL_HIGH,
    layout::BIAS,
    layout::BIAS_UNCERTAINTY,
    layout::BIAS_ORDER,
];

/// What follows from them.
pub(super) const CORRECTED: [layout::Variable; 3] = [
    layout::ESTIMATE_CORRECTED,
    layout::ESTIMATE_CORRECTED_LOW,
    layout::ESTIMATE_CORRECTED_HIGH,
];

/// The numbers of an estimate in the order of these variables; NaN where it is unknown.
pub(super) fn numbers_of(e: &Estimate) -> [f64; 7] {
    let Bias {
        estimate,
        uncertainty,
        order,
    } = e.bias.unwrap_or(Bias {
        estimate: f64::NAN,
        uncertainty: f64::NAN,
        order: None,
    });
    [
        e.estimate,
        e.standard_error,
        e.low,
        e.high,
        estimate,
        uncertainty,
        order.unwrap_or(f64::NAN),
    ]
}

/// The estimate with these numbers.
pub(super) fn estimate_of(statistic: Statistic, numbers: [f64; 7]) -> Estimate {
    let [
        estimate,
        standard_error,
        low,
        high,
        bias,
        uncertainty,
        order,
    ] = numbers;
    let order = Some(order).filter(|order| !order.is_nan());
    let bias = Some(bias)
        .filter(|bias| !bias.is_nan())
        .map(|estimate| Bias {
            estimate,
            uncertainty,
            order,
        });
    Estimate {
        statistic,
        estimate,
        standard_error,
        low,
        high,
        bias,
    }
}

/// The corrected estimate with its interval; NaN where there is none.
pub(super) fn corrected_of(e: &Estimate) -> [f64; 3] {
    e.corrected().map_or(
        [f64::NAN; 3],
        |Corrected {
             estimate,
             low,
             high,
         }| [estimate, low, high],
    )
}

fn walk_estimates(walk: &mut Walk, estimates: &mut Estimates, names: &[String]) -> Walked {
    let is_there = |e: &&Estimate| names.iter().any(|name| name == e.statistic.name());
    let mut columns = columns_of(estimates.iter().filter(is_there).map(numbers_of));
    for (variable, values) in PER_STATISTIC.iter().zip(&mut columns) {
        walk.variable(variable, values)?;
    }
    for estimate in estimates.iter_mut() {
        let row = names
            .iter()
            .position(|name| name == estimate.statistic.name());
        let numbers = columns.each_ref().map(|values| {
            row.and_then(|row| values.get(row).copied())
                .unwrap_or(f64::NAN)
        });
        *estimate = estimate_of(estimate.statistic, numbers);
    }
    // What follows from the estimates and their biases is left out if no statistic has it.
    if estimates
        .iter()
        .all(|estimate| estimate.corrected().is_none())
    {
        return Ok(());
    }
    let corrected = columns_of(estimates.iter().filter(is_there).map(corrected_of));
    CORRECTED
        .iter()
        .zip(&corrected)
        .for_each(|(variable, values)| walk.derived(variable, values));
    Ok(())
}

fn walk_bands(walk: &mut Walk, bands: &mut Bands) -> Walked {
    let Bands {
        time: _,
        displacement,
        velocity,
        temperature,
        static_probability,
        static_probability_ends,
    } = bands;
    for ([mean, sd, quantile], band) in [
        (layout::DISPLACEMENT, displacement),
        (layout::VELOCITY, velocity),
        (layout::TEMPERATURE, temperature),
    ] {
        let Band {
            mean: values,
            mean_ends,
            sd: sds,
            sd_ends,
            quantiles,
            quantile_ends,
        } = band;
        let mut matrix = quantiles.iter().copied().collect();
        walk.curve(&mean, values, mean_ends)?;
        walk.curve(&sd, sds, sd_ends)?;
        walk.curve(&quantile, &mut matrix, quantile_ends)?;
        let levels = matrix
            .len()
            .checked_div(values.len())
            .unwrap_or(QUANTILE_LEVELS.len());
        *quantiles = Array2::from_shape_vec((levels, values.len()), matrix)
            .map_err(|error| error.to_string())?;
    }
    walk.curve(
        &layout::STATIC_PROBABILITY,
        static_probability,
        static_probability_ends,
    )
}

/// The laws of the largest displacement and of the largest speed of a path: name, quantity, unit.
const EXTREMES: [(&str, &str, Dimension); 2] = [
    (
        "largest_displacement",
        "largest distance from the start",
        Dimension::LENGTH,
    ),
    ("largest_speed", "largest speed", Dimension::VELOCITY),
];

/// The laws of sticks, the requested laws, and those of extremes, each with its own bins.
fn walk_laws(
    walk: &mut Walk,
    sticks: &mut Distribution,
    asked: &mut Option<[Distribution; PhaseLaw::ASKED.len()]>,
    extremes: &mut Option<Extremes>,
) -> Walked {
    let of = |law: PhaseLaw| (law.name(), law.words(), law.dimension());
    let known = [PhaseLaw::Stick]
        .into_iter()
        .chain(PhaseLaw::ASKED)
        .map(of)
        .chain(EXTREMES);
    let is_there = |(name, ..): &(&str, &str, Dimension)| match *name {
        "stick" => true,
        name if EXTREMES.iter().any(|extreme| extreme.0 == name) => extremes.is_some(),
        _ => asked.is_some(),
    };
    let there: Vec<_> = known.filter(is_there).collect();
    let mut names = texts(there.iter().map(|law| law.0));
    walk.variable(&layout::LAW, &mut names)?;
    walk.check(!names.is_empty(), || {
        format!("{} is missing", layout::LAW.name)
    })?;
    walk.derived(
        &layout::LAW_LONG_NAME,
        &texts(there.iter().map(|law| law.1)),
    );
    walk.units(&layout::LAW_UNIT, there.iter().map(|law| law.2));
    if names.iter().any(|name| name == PhaseLaw::Slip.name()) {
        asked.get_or_insert_default();
    }
    if names.iter().any(|name| name == EXTREMES[0].0) {
        extremes.get_or_insert_default();
    }
    let extremes = extremes
        .iter_mut()
        .flat_map(|of| [&mut of.displacement, &mut of.velocity]);
    let laws: Vec<&mut Distribution> = [sticks]
        .into_iter()
        .chain(asked.iter_mut().flatten())
        .chain(extremes)
        .collect();
    walk.check(laws.len() == names.len(), || {
        format!("{} has different names from this program", layout::LAW.name)
    })?;
    walk_distributions(walk, laws)
}

fn walk_distributions(walk: &mut Walk, mut laws: Vec<&mut Distribution>) -> Walked {
    let most = laws.iter().map(|law| law.survival.len()).max().unwrap_or(0);
    let rows = |part: fn(&[f64]) -> Option<&[f64]>| -> Vec<Vec<f64>> {
        laws.iter()
            .map(|law| part(&law.histogram.edges).unwrap_or_default().to_vec())
            .collect()
    };
    let (mut lower, mut upper) = (
        rows(|edges| edges.split_last().map(|(_, rest)| rest)),
        rows(|edges| edges.get(1..)),
    );
    walk.derived(&layout::LAW_BIN, &counted(0, most));
    walk_ragged(walk, &layout::LAW_LOWER, lower.iter_mut())?;
    walk_ragged(walk, &layout::LAW_UPPER, upper.iter_mut())?;
    walk_ragged(
        walk,
        &layout::LAW_COUNT,
        laws.iter_mut().map(|law| &mut law.histogram.counts),
    )?;
    walk_ragged(
        walk,
        &layout::LAW_CENSORED_COUNT,
        laws.iter_mut().map(|law| &mut law.censored_counts),
    )?;
    walk_curves(walk, &layout::LAW_SURVIVAL, &mut laws, |law| {
        (&mut law.survival, &mut law.survival_ends)
    })?;
    walk_curves(walk, &layout::LAW_QUANTILE, &mut laws, |law| {
        (&mut law.quantiles, &mut law.quantile_ends)
    })?;
    for ((law, lower), upper) in laws.iter_mut().zip(lower).zip(upper) {
        let bins = upper.iter().take_while(|edge| !edge.is_nan()).count();
        law.histogram.edges = lower
            .into_iter()
            .take(bins)
            .chain(bins.checked_sub(1).map(|last| upper[last]))
            .collect();
        law.histogram.counts.truncate(bins);
        law.censored_counts.truncate(bins);
        let Ends { low, high } = &mut law.survival_ends;
        [&mut law.survival, low, high]
            .into_iter()
            .for_each(|values| values.truncate(bins));
    }
    let (mut completed, mut censored): (Vec<u64>, Vec<u64>) =
        laws.iter().map(|law| (law.completed, law.censored)).unzip();
    walk.variable(&layout::LAW_COMPLETED, &mut completed)?;
    walk.variable(&layout::LAW_CENSORED, &mut censored)?;
    let counts = completed.into_iter().zip(censored);
    laws.into_iter()
        .zip(counts)
        .for_each(|(law, counts)| (law.completed, law.censored) = counts);
    Ok(())
}

/// Walk over a curve of each law, and over its intervals: all lower ends, then all upper ones.
fn walk_curves<T>(
    walk: &mut Walk,
    of: &layout::WithInterval,
    rows: &mut [T],
    parts: fn(&mut T) -> (&mut Vec<f64>, &mut Ends),
) -> Walked {
    walk_ragged(walk, &of.value, rows.iter_mut().map(|row| parts(row).0))?;
    let ends = rows.iter_mut().map(|row| parts(row).1);
    let (low, high): (Vec<_>, Vec<_>) = ends.map(|ends| (&mut ends.low, &mut ends.high)).unzip();
    walk_ragged(walk, &of.interval, low.into_iter().chain(high))
}

/// Walk over rows that are filled up to the longest of them.
fn walk_ragged<'a, T: Element + 'a>(
    walk: &mut Walk,
    variable: &layout::Variable,
    rows: impl Iterator<Item = &'a mut Vec<T>>,
) -> Walked {
    let mut rows: Vec<&mut Vec<T>> = rows.collect();
    let width = rows.iter().map(|row| row.len()).max().unwrap_or(0);
    let filled = |row: &&mut Vec<T>| {
        row.iter()
            .cloned()
            .chain(std::iter::repeat(T::MISSING))
            .take(width)
            .collect()
    };
    let mut values: Vec<T> = rows
        .iter()
        .flat_map(|row| -> Vec<T> { filled(row) })
        .collect();
    walk.variable(variable, &mut values)?;
    let width = values.len() / rows.len().max(1);
    rows.iter_mut()
        .zip(values.chunks(width.max(1)))
        .for_each(|(row, values)| **row = values.to_vec());
    Ok(())
}

/// The upper and lower edges of bins.
fn walk_edges(
    walk: &mut Walk,
    [upper, lower]: &[layout::Variable; 2],
    edges: &mut Vec<f64>,
) -> Walked {
    let mut below = edges
        .get(..edges.len().saturating_sub(1))
        .unwrap_or_default()
        .to_vec();
    let mut above = edges.get(1..).unwrap_or_default().to_vec();
    walk.variable(upper, &mut above)?;
    walk.variable(lower, &mut below)?;
    *edges = below.into_iter().chain(above.last().copied()).collect();
    Ok(())
}

fn walk_densities(walk: &mut Walk, densities: &mut Densities) -> Walked {
    let Densities {
        displacement,
        velocity,
        joint_edges,
        joint,
        at_rest,
        at_rest_ends,
    } = densities;
    walk.number(&layout::REST_SHARE, at_rest, at_rest_ends)?;
    walk_edges(walk, &layout::DISPLACEMENT_BIN, &mut displacement.edges)?;
    walk.curve(
        &layout::DISPLACEMENT_DENSITY,
        &mut displacement.density,
        &mut displacement.ends,
    )?;
    walk_edges(walk, &layout::VELOCITY_BIN, &mut velocity.edges)?;
    walk.curve(
        &layout::VELOCITY_DENSITY,
        &mut velocity.density,
        &mut velocity.ends,
    )?;
    let [rows, columns] = joint_edges;
    walk_edges(walk, &layout::JOINT_DISPLACEMENT_BIN, rows)?;
    walk_edges(walk, &layout::JOINT_VELOCITY_BIN, columns)?;
    let shape = (
        rows.len().saturating_sub(1),
        columns.len().saturating_sub(1),
    );
    let mut values = joint.iter().copied().collect();
    walk.variable(&layout::JOINT_DENSITY, &mut values)?;
    *joint = Array2::from_shape_vec(shape, values).map_err(|error| error.to_string())?;
    Ok(())
}

fn walk_passages(walk: &mut Walk, passages: &mut Vec<Passages>) -> Walked {
    let mut levels: Vec<f64> = passages.iter().map(|of| of.level).collect();
    walk.variable(&layout::LEVEL, &mut levels)?;
    passages.resize(levels.len(), Passages::default());
    passages
        .iter_mut()
        .zip(levels)
        .for_each(|(of, level)| of.level = level);
    walk_curves(walk, &layout::PASSAGE_SURVIVAL, passages, |of| {
        (&mut of.survival, &mut of.survival_ends)
    })
}

fn walk_spectrum(walk: &mut Walk, spectrum: &mut Spectrum) -> Walked {
    let Spectrum {
        segments,
        lag,
        frequency,
        displacement,
        velocity,
        lines,
    } = spectrum;
    walk.scalar(&layout::SPECTRUM_SEGMENTS, segments)?;
    walk.variable(&layout::LAG, lag)?;
    walk.variable(&layout::FREQUENCY, frequency)?;
    let of = [
        (
            displacement,
            layout::DISPLACEMENT_AUTOCOVARIANCE,
            layout::DISPLACEMENT_SPECTRUM,
        ),
        (
            velocity,
            layout::VELOCITY_AUTOCOVARIANCE,
            layout::VELOCITY_SPECTRUM,
        ),
    ];
    for (fluctuations, covariance, power) in of {
        let Fluctuations {
            autocovariance,
            autocovariance_ends,
            spectrum,
            spectrum_ends,
        } = fluctuations;
        walk.curve(&covariance, autocovariance, autocovariance_ends)?;
        walk.curve(&power, spectrum, spectrum_ends)?;
    }
    let [mut at, mut x, mut v] = columns_of(
        lines
            .iter()
            .map(|line| [line.frequency, line.displacement, line.velocity]),
    );
    walk.variable(&layout::LINE_FREQUENCY, &mut at)?;
    walk.variable(&layout::DISPLACEMENT_LINE, &mut x)?;
    walk.variable(&layout::VELOCITY_LINE, &mut v)?;
    let line = |((frequency, displacement), velocity)| Line {
        frequency,
        displacement,
        velocity,
    };
    *lines = at.into_iter().zip(x).zip(v).map(line).collect();
    Ok(())
}

fn walk_cycle(walk: &mut Walk, cycle: &mut LimitCycle) -> Walked {
    let (mut numbers, mut section) = (cycle.numbers().to_vec(), std::mem::take(&mut cycle.section));
    walk.derived(&layout::CYCLE_NUMBER, &texts(LimitCycle::NUMBERS));
    walk.derived(&layout::SECTION_STATE, &counted(0, section.len()));
    walk.sized(&layout::CYCLE, &mut numbers, LimitCycle::NUMBERS.len())?;
    walk.variable(&layout::SECTION, &mut section)?;
    *cycle = LimitCycle::of_numbers(std::array::from_fn(|i| numbers[i]), &section);
    Ok(())
}

fn walk_sub_phases(walk: &mut Walk, sub_phases: &mut SubPhaseCounts) -> Walked {
    let SubPhaseCounts {
        counts,
        shares,
        share_ends,
        censored,
    } = sub_phases;
    walk.derived(&layout::SUB_PHASE, &counted(1, counts.len()));
    walk.variable(&layout::SUB_PHASE_COUNT, counts)?;
    walk.curve(&layout::SUB_PHASE_SHARE, shares, share_ends)?;
    walk.scalar(&layout::SUB_PHASE_CENSORED, censored)
}

fn walk_periods(walk: &mut Walk, periods: &mut PeriodMoments) -> Walked {
    let PeriodMoments {
        drift_limit,
        time,
        mean,
        mean_ends,
        variance,
        variance_ends,
    } = periods;
    if let Some(limit) = walk.present(&layout::DRIFT_LIMIT, drift_limit) {
        walk.scalar(&layout::DRIFT_LIMIT, limit)?;
    }
    walk.derived(&layout::PERIOD, &counted(1, time.len()));
    walk.variable(&layout::PERIOD_TIME, time)?;
    walk.curve(&layout::DISPLACEMENT_PERIOD_MEAN, mean, mean_ends)?;
    walk.curve(
        &layout::DISPLACEMENT_PERIOD_VARIANCE,
        variance,
        variance_ends,
    )
}

fn walk_transient(walk: &mut Walk, transient: &mut Transient) -> Walked {
    let Transient {
        end,
        sticks,
        slips,
        displacement,
    } = transient;
    let Measurement {
        estimate,
        standard_error,
        low,
        high,
    } = displacement;
    walk.scalar(&layout::TRANSIENT_END, end)?;
    walk.scalar(&layout::TRANSIENT_STICKS, sticks)?;
    walk.scalar(&layout::TRANSIENT_SLIPS, slips)?;
    let mut ends = [*low, *high];
    walk.number(&layout::TRANSIENT_DISPLACEMENT, estimate, &mut ends)?;
    [*low, *high] = ends;
    walk.scalar(&layout::TRANSIENT_DISPLACEMENT_ERROR, standard_error)
}

impl Dataset {
    /// The statistics of a run; `step` is the step of its scheme, if it has one. Fails if the data
    /// set is not that of a run.
    pub fn summary(&self, step: Option<f64>) -> Result<Summary, String> {
        match self.attribute("completed_paths") {
            Some(Attribute::Count(paths)) => read(self, *paths, step),
            _ => Err("not the data set of a run: completed_paths is missing".into()),
        }
    }
}
