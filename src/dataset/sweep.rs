//! A sweep as a data set: the question, the results of every point, and the comparisons between
//! points.

use super::form::AttributeValue;
use super::header::{Format, write_origin};
use super::layout::{self, Described, Unit, variable};
use super::summary::{
    CORRECTED, PER_STATISTIC, corrected_of, estimate_of, numbers_of, write_statistics,
};
use super::sweep_layout as own;
use super::{
    Attribute, Dataset, Element, Source, columns_of, counted, read_attribute, read_other_program,
    read_sized, read_variable, series, texts,
};
use crate::config::{Override, ScenarioError};
use crate::engine::{Provenance, Status};
use crate::scenario::Scenario;
use crate::stats::{Estimate, GROUPS, GroupValues, LimitCycle, Statistic};
use crate::study::sweep::{
    AxisValue, AxisValues, Design, DesignError, Paired, Point, Seeds, Setting, Sweep, SweepAxis,
    SweepQuestion, table_of_file,
};

/// Name and version of the format.
pub const SWEEP_FORMAT: Format = ("stick-slip sweep", (3, 0));

/// A sweep read from a data set.
#[derive(Clone, Debug, PartialEq)]
pub struct StoredSweep {
    /// The sweep, with the points that are done.
    pub sweep: Sweep,
    /// The program that wrote the sweep, if it was a different one.
    pub other_program: Option<String>,
}

impl Dataset {
    /// The data set of a sweep.
    pub fn of_sweep(sweep: &Sweep) -> Self {
        let mut header = Provenance::of(&sweep.question.scenario);
        header.samples.extend(sweep.question.samples_of_files());
        let mut dataset = Dataset::new(&header.units);
        attributes(&mut dataset, sweep, &header);
        series::write(&mut dataset, &header);
        coordinates(&mut dataset, &sweep.question.design);
        results(&mut dataset, sweep);
        comparisons(&mut dataset, sweep);
        dataset
    }

    /// The sweep in the data set. Fails if the data set is not that of a sweep.
    pub fn sweep(&self) -> Result<StoredSweep, String> {
        read(self)
    }
}

/// The value of the attribute about the bias of the step.
pub fn bias_name(with_bias: bool) -> &'static str {
    if with_bias { "estimated" } else { "left out" }
}

fn attributes(to: &mut Dataset, sweep: &Sweep, header: &Provenance) {
    let SweepQuestion {
        design,
        seeds,
        with_bias,
        ..
    } = &sweep.question;
    write_origin(to, SWEEP_FORMAT, &header.title);
    let status = if sweep.is_complete() {
        Status::Complete
    } else {
        Status::Running
    };
    let all: [(&str, Attribute); 11] = [
        ("scheme", header.scheme.as_str().into()),
        ("seed", header.seed.into()),
        ("seeds", seeds.name().into()),
        ("generator", header.program.generator.as_str().into()),
        ("paths", header.paths.into()),
        ("block_size", header.program.block_size.into()),
        ("status", status.name().into()),
        ("points", (sweep.points.len() as u64).into()),
        ("completed_points", (sweep.done() as u64).into()),
        ("bias_of_the_step", bias_name(*with_bias).into()),
        ("design", name(design).into()),
    ];
    for (name, value) in all {
        to.set_attribute(name, value);
    }
    match design {
        Design::Star { relative_step, .. } => to.set_attribute("relative_step", *relative_step),
        Design::Grid(axes) | Design::Zip(axes) => {
            let names: Vec<&str> = axes.iter().map(|axis| axis.name.as_str()).collect();
            to.set_attribute("axes", names.join(" "));
        }
    }
    to.set_attribute("scenario", header.scenario_text.as_str());
}

/// The name of a design.
pub fn name(design: &Design) -> &'static str {
    match design {
        Design::Grid(_) => "grid",
        Design::Zip(_) => "zip",
        Design::Star { .. } => "elasticity",
    }
}

/// The names of the dimensions of a design.
fn shape(design: &Design) -> Vec<&str> {
    if let Design::Star { .. } = design {
        vec!["point"]
    } else {
        design.along()
    }
}

/// Whether an axis of a design names files.
fn has_files(design: &Design) -> bool {
    let mut axes = design.axes().iter();
    axes.any(|axis| table_of_file(&axis.key).is_some())
}

fn coordinates(to: &mut Dataset, design: &Design) {
    write_statistics(to, &Statistic::ALL);
    to.write(&own::GROUP, &counted(0, GROUPS));
    if !matches!(design, Design::Grid(_)) {
        to.write(&own::POINT, &counted(0, design.points()));
    }
    match design {
        Design::Grid(axes) | Design::Zip(axes) => {
            for SweepAxis { name, key, values } in axes {
                let along = if let Design::Grid(_) = design {
                    name
                } else {
                    "point"
                };
                let (along, attributes) = ([along], [("key", key.as_str())]);
                let variable = variable(name, &along, Unit::None, key).with(&attributes);
                match values {
                    AxisValues::Numbers(numbers) => to.write(&variable, numbers),
                    AxisValues::Files(files) => to.write(&variable, files),
                }
            }
            to.write(&own::ALONG, &texts(design.along()));
        }
        Design::Star { keys, .. } => {
            let none = || ("none".to_string(), f64::NAN);
            let moved = |point| match design.settings(point).pop() {
                Some(Setting {
                    key,
                    value: AxisValue::Number(number),
                }) => (key, number),
                _ => none(),
            };
            let (moved, values): (Vec<String>, Vec<f64>) = (0..design.points()).map(moved).unzip();
            to.write(&own::POINT_KEY, &moved);
            to.write(&own::POINT_VALUE, &values);
            let (keys, values): (Vec<String>, Vec<f64>) = keys.iter().cloned().unzip();
            to.write(&own::KEY, &keys);
            to.write(&own::KEY_VALUE, &values);
        }
    }
}

const STATISTICS: usize = Statistic::ALL.len();
const NUMBERS: usize = LimitCycle::NUMBERS.len();

/// Write a variable along the dimensions of a design of this shape and its own.
fn write_along<T: Element>(
    to: &mut Dataset,
    shape: &[&str],
    variable: &Described,
    values: impl IntoIterator<Item = T>,
) {
    let dimensions = [shape, variable.axes].concat();
    let values: Vec<T> = values.into_iter().collect();
    to.write(&variable.along(&dimensions, variable.attributes), &values);
}

/// Write the results of all points.
fn results(to: &mut Dataset, sweep: &Sweep) {
    let design = &sweep.question.design;
    let shape = &shape(design);
    let missing = Point {
        estimates: Statistic::ALL.map(|statistic| estimate_of(statistic, [f64::NAN; 7])),
        completed_paths: 0,
        diverged_paths: 0,
        seconds: f64::NAN,
        cycle: None,
        without: Vec::new(),
    };
    let points = || {
        sweep
            .points
            .iter()
            .map(|point| point.as_ref().unwrap_or(&missing))
    };
    let mut coordinates = "statistic_long_name statistic_unit".to_string();
    match design {
        Design::Grid(_) => {}
        Design::Zip(axes) => axes
            .iter()
            .for_each(|axis| coordinates = format!("{coordinates} {}", axis.name)),
        Design::Star { .. } => coordinates.push_str(" point_key point_value"),
    }
    let attributes = [("coordinates", coordinates.as_str())];
    let numbers = columns_of(points().flat_map(|point| point.estimates.each_ref().map(numbers_of)));
    let corrected =
        columns_of(points().flat_map(|point| point.estimates.each_ref().map(corrected_of)));
    let variables = PER_STATISTIC.iter().chain(&CORRECTED);
    for (variable, values) in variables.zip(numbers.into_iter().chain(corrected)) {
        write_along(to, shape, &variable.with(&attributes), values);
    }
    let without = points().flat_map(|point| {
        let mut groups = point.without.clone();
        groups.resize(GROUPS, [f64::NAN; STATISTICS]);
        groups.concat()
    });
    write_along(to, shape, &own::ESTIMATE_WITHOUT, without);
    let statuses = sweep.points.iter().map(|point| match point {
        None => 0_i8,
        Some(point) if point.diverged_paths < point.completed_paths => 1,
        Some(_) => 2,
    });
    write_along(to, shape, &own::POINT_STATUS, statuses);
    let completed = points().map(|point| point.completed_paths);
    write_along(to, shape, &own::POINT_COMPLETED_PATHS, completed);
    let diverged = points().map(|point| point.diverged_paths);
    write_along(to, shape, &own::POINT_DIVERGED_PATHS, diverged);
    let scenarios = || sweep.question.points.iter();
    let seeds = scenarios().map(|scenario| scenario.ensemble.seed);
    write_along(to, shape, &own::POINT_SEED, seeds);
    if has_files(design) {
        let ends = scenarios().map(|scenario| scenario.time.end);
        write_along(to, shape, &own::POINT_END, ends);
    }
    write_along(
        to,
        shape,
        &own::POINT_SECONDS,
        points().map(|point| point.seconds),
    );
    if points().all(|point| point.cycle.is_none()) {
        return;
    }
    to.write(&layout::CYCLE_NUMBER, &texts(LimitCycle::NUMBERS));
    to.write(&layout::SECTION_STATE, &counted(0, LimitCycle::STATES));
    let none = [f64::NAN; NUMBERS];
    let cycles = || points().map(|point| point.cycle.as_ref());
    let numbers = cycles().flat_map(|cycle| cycle.map_or(none, LimitCycle::numbers));
    write_along(to, shape, &layout::CYCLE, numbers);
    let sections = cycles().flat_map(|cycle| {
        let mut states = cycle.map_or(Vec::new(), |cycle| cycle.section.clone());
        states.resize(LimitCycle::STATES, f64::NAN);
        states
    });
    write_along(to, shape, &layout::SECTION, sections);
}

/// Write the differences between points, or the elasticities.
fn comparisons(to: &mut Dataset, sweep: &Sweep) {
    let numbers = |paired: Option<Paired>| {
        let Paired {
            measurement: m,
            gain,
        } = paired.unwrap_or(Paired::NOTHING);
        [m.estimate, m.standard_error, m.low, m.high, gain]
    };
    let design = &sweep.question.design;
    let (variables, dimensions, rows): (_, _, Vec<[f64; 5]>) = match design {
        Design::Star { keys, .. } => {
            let of =
                |key| Statistic::ALL.map(|statistic| numbers(sweep.elasticity(key, statistic)));
            (
                &own::PER_ELASTICITY,
                vec!["key", "statistic"],
                (0..keys.len()).flat_map(of).collect(),
            )
        }
        Design::Grid(_) | Design::Zip(_) => {
            let of = |(along, point)| {
                Statistic::ALL.map(|statistic| numbers(sweep.difference(point, along, statistic)))
            };
            let places = (0..design.along().len())
                .flat_map(|along| (0..design.points()).map(move |point| (along, point)));
            let dimensions = [&["along"][..], &shape(design), &["statistic"]].concat();
            (
                &own::PER_DIFFERENCE,
                dimensions,
                places.flat_map(of).collect(),
            )
        }
    };
    let columns = columns_of(rows);
    variables
        .iter()
        .zip(&columns)
        .for_each(|(variable, values)| to.write(&variable.along(&dimensions, &[]), values));
}

/// Read a sweep.
pub fn read(from: &dyn Source) -> Result<StoredSweep, String> {
    let text: String = read_attribute(from, "scenario")?;
    let samples = series::read(from)?;
    let scenario_at = |settings: &[Setting]| {
        let laid = |setting: &Setting| setting.change(&setting.key);
        let overrides: Vec<Override> = settings.iter().map(laid).collect();
        Scenario::parse_stored("scenario", &text, &overrides, &samples)
    };
    let (design, points) = read_points(from)?;
    // The end of a point is that of its record, if files are varied.
    let ends: Vec<f64> = match has_files(&design) {
        true => along(from, &shape(&design), &own::POINT_END, design.points())?,
        false => Vec::new(),
    };
    let scenario_of = |i: usize| {
        let mut settings = design.settings(i);
        settings.extend(ends.get(i).map(|end| Setting {
            key: "time.end".into(),
            value: AxisValue::Number(*end),
        }));
        scenario_at(&settings)
    };
    let wrong = |error: ScenarioError| error.to_string();
    let scenarios = (0..design.points()).map(scenario_of);
    let scenarios = scenarios.collect::<Result<_, _>>().map_err(wrong)?;
    let name: String = read_attribute(from, "seeds")?;
    let seeds = [Seeds::Common, Seeds::Independent]
        .into_iter()
        .find(|seeds| seeds.name() == name)
        .ok_or_else(|| format!("unknown seeds \"{name}\""))?;
    let bias: String = read_attribute(from, "bias_of_the_step")?;
    let with_bias = bias == bias_name(true);
    let scenario = scenario_at(&[]).map_err(wrong)?;
    let question = SweepQuestion::new(scenario, design, scenarios, seeds, with_bias);
    Ok(StoredSweep {
        sweep: Sweep { question, points },
        other_program: read_other_program(from)?,
    })
}

pub fn read_design(from: &dyn Source) -> Result<Design, String> {
    let design: String = read_attribute(from, "design")?;
    let is_zipped = design == "zip";
    match design.as_str() {
        "grid" | "zip" => {
            let axis = |name: &str| {
                let along = [if is_zipped { "point" } else { name }];
                let key = from.attribute(Some(name), "key")?;
                let key: String = AttributeValue::of(key, &format!("key of {name}"))?;
                let variable = variable(name, &along, Unit::None, "");
                let values = match table_of_file(&key) {
                    Some(_) => AxisValues::Files(read_variable(from, &variable)?),
                    None => AxisValues::Numbers(read_variable(from, &variable)?),
                };
                Ok(SweepAxis {
                    name: name.to_string(),
                    key,
                    values,
                })
            };
            let names: String = read_attribute(from, "axes")?;
            let axes = names.split(' ').map(axis).collect::<Result<_, String>>()?;
            Design::of(axes, is_zipped).map_err(|error: DesignError| error.to_string())
        }
        "elasticity" => {
            let keys: Vec<String> = read_variable(from, &own::KEY)?;
            let values = read_variable(from, &own::KEY_VALUE)?;
            Ok(Design::Star {
                keys: keys.into_iter().zip(values).collect(),
                relative_step: read_attribute(from, "relative_step")?,
            })
        }
        other => Err(format!("unknown design \"{other}\"")),
    }
}

/// The design of a sweep and the result of each point; none if the point is not done.
pub fn read_points(from: &dyn Source) -> Result<(Design, Vec<Option<Point>>), String> {
    let design = read_design(from)?;
    let (shape, count) = (shape(&design), design.points());
    let mut estimates = Vec::new();
    for variable in &PER_STATISTIC {
        estimates.push(along::<f64>(from, &shape, variable, count * STATISTICS)?);
    }
    let without: Vec<f64> = along(
        from,
        &shape,
        &own::ESTIMATE_WITHOUT,
        count * GROUPS * STATISTICS,
    )?;
    let statuses: Vec<i8> = along(from, &shape, &own::POINT_STATUS, count)?;
    let completed: Vec<u64> = along(from, &shape, &own::POINT_COMPLETED_PATHS, count)?;
    let diverged: Vec<u64> = along(from, &shape, &own::POINT_DIVERGED_PATHS, count)?;
    let seconds: Vec<f64> = along(from, &shape, &own::POINT_SECONDS, count)?;
    let cycles = read_cycles(from, &shape, count)?;
    let estimate = |p: usize, statistic: Statistic| -> Estimate {
        let row = p * STATISTICS + statistic.index();
        estimate_of(statistic, std::array::from_fn(|i| estimates[i][row]))
    };
    let groups = |p: usize| -> Vec<GroupValues> {
        let (groups, _) = without[p * GROUPS * STATISTICS..].as_chunks();
        // With few paths there are fewer groups.
        let is_there = |values: &&GroupValues| values.iter().any(|x| !x.is_nan());
        groups
            .iter()
            .take(GROUPS)
            .take_while(is_there)
            .copied()
            .collect()
    };
    let point = |p: usize| {
        if statuses[p] == 0 {
            return Ok(None);
        }
        if diverged[p] > completed[p] {
            return Err("more diverged paths than paths".to_string());
        }
        Ok(Some(Point {
            estimates: Statistic::ALL.map(|statistic| estimate(p, statistic)),
            completed_paths: completed[p],
            diverged_paths: diverged[p],
            seconds: seconds[p],
            cycle: cycles[p].clone(),
            without: groups(p),
        }))
    };
    let points = (0..count).map(point).collect::<Result<_, String>>()?;
    Ok((design, points))
}

/// The cycle of each point that has one.
fn read_cycles(
    from: &dyn Source,
    shape: &[&str],
    count: usize,
) -> Result<Vec<Option<LimitCycle>>, String> {
    if !from.has(layout::CYCLE.name) {
        return Ok(vec![None; count]);
    }
    let numbers: Vec<f64> = along(from, shape, &layout::CYCLE, count * NUMBERS)?;
    let sections: Vec<f64> = along(from, shape, &layout::SECTION, count * LimitCycle::STATES)?;
    let (numbers, _) = numbers.as_chunks::<NUMBERS>();
    let cycles = numbers.iter().zip(sections.chunks(LimitCycle::STATES));
    let cycle = |(numbers, section): (&[f64; NUMBERS], _)| {
        (!numbers[0].is_nan()).then(|| LimitCycle::of_numbers(*numbers, section))
    };
    Ok(cycles.map(cycle).collect())
}

/// The values of a variable along the dimensions of a design of this shape and its own.
fn along<T: Element>(
    from: &dyn Source,
    shape: &[&str],
    variable: &Described,
    length: usize,
) -> Result<Vec<T>, String> {
    let dimensions = [shape, variable.axes].concat();
    read_sized(from, &variable.along(&dimensions, &[]), length)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two points with S = 3 and 5, and without either of two groups 3 -+ 0.1 and 5 -+ 0.3. Their
    /// difference has an error of 0.2 with common noise and of sqrt(0.1) without, and t = 12.7062.
    #[test]
    fn variables_hold_what_their_names_say() {
        let axis = SweepAxis::parse("friction.static=1.2,1.3", |_| None).expect("an axis");
        let design = Design::of(vec![axis], false).expect("a line");
        let scenario = Scenario::shipped("rho025").expect("shipped");
        let scenarios = vec![scenario.clone(); 2];
        let question = SweepQuestion::new(scenario, design, scenarios, Seeds::Common, false);
        let point = |value: f64, off: f64, diverged_paths| {
            let of = |statistic| {
                estimate_of(
                    statistic,
                    [
                        value,
                        off,
                        value - off,
                        value + off,
                        f64::NAN,
                        f64::NAN,
                        f64::NAN,
                    ],
                )
            };
            let without = [value - off, value + off].map(|value| Statistic::ALL.map(|_| value));
            Point {
                estimates: Statistic::ALL.map(of),
                completed_paths: 512,
                diverged_paths,
                seconds: 1.5,
                cycle: None,
                without: without.into(),
            }
        };
        let mut sweep = Sweep::new(question);
        sweep.points = vec![Some(point(3.0, 0.1, 7)), Some(point(5.0, 0.3, 0))];
        let dataset = Dataset::of_sweep(&sweep);
        let column = |name: &str| {
            &dataset
                .entry(name)
                .unwrap_or_else(|| panic!("{name}"))
                .column
        };
        let first = |name: &str| <&[f64]>::try_from(column(name)).expect("reals")[0];
        for (name, wanted) in [
            ("estimate", 3.0),
            ("interval_low", 2.9),
            ("interval_high", 3.1),
            ("point_seconds", 1.5),
            ("difference", 2.0),
            ("difference_error", 0.2),
            ("difference_low", 2.0 - 0.2 * 12.706_204_7),
            ("difference_high", 2.0 + 0.2 * 12.706_204_7),
            ("difference_gain", 0.1 / 0.04),
        ] {
            assert!(
                (first(name) - wanted).abs() < 1e-6,
                "{name}: {} {wanted}",
                first(name)
            );
        }
        let count = |name: &str| <&[u64]>::try_from(column(name)).expect("counts")[0];
        assert_eq!(
            ["point_completed_paths", "point_diverged_paths"].map(count),
            [512, 7]
        );
    }
}
