//! A sweep as a data set: the question, the results of every point, and the comparisons between
//! points.

use super::form::AttributeValue;
use super::header::{Format, walk_origin};
use super::layout::{self, Unit, variable};
use super::summary::{
    CORRECTED, PER_STATISTIC, corrected_of, estimate_of, numbers_of, write_statistics,
};
use super::sweep_layout as own;
use super::walk::{Walk, Walked};
use super::{Dataset, Source, columns_of, counted, read_or_empty, read_variable, series, texts};
use stickslip::engine::{Program, Provenance, Status};
use stickslip::model::NamedSeries;
use stickslip::scenario::Scenario;
use stickslip::stats::{GROUPS, GroupValues, LimitCycle, Statistic};
use stickslip::study::sweep::{
    AxisValue, AxisValues, Design, DesignError, Paired, Point, Seeds, Setting, Sweep, SweepAxis,
    SweepQuestion, table_of_file,
};

/// Name and version of the format.
pub(crate) const SWEEP_FORMAT: Format = ("stick-slip sweep", (3, 0));

/// A sweep as it is read back from a data set.
#[derive(Clone, Debug, PartialEq)]
pub struct StoredSweep {
    /// The scenario that the points are variations of, as TOML.
    pub scenario_text: String,
    /// The measured values of the scenario, and those of the files that points have in their place.
    pub samples: Vec<NamedSeries>,
    /// The end of each point, if files are varied, whose lengths may differ; empty otherwise.
    pub ends: Vec<f64>,
    /// Version, commit, generator and block size of the program that wrote the sweep, in one line.
    pub program: Program,
    /// The program that wrote the sweep, if it was another one.
    pub other_program: Option<String>,
    /// The design, which determines the points.
    pub design: Design,
    /// Whether all points see the same noise.
    pub seeds: Seeds,
    /// Whether the bias of the step was estimated.
    pub with_bias: bool,
    /// Whether all points are done.
    pub status: Status,
    /// The result of each point; none if the point is not done.
    pub points: Vec<Option<Point>>,
}

impl StoredSweep {
    /// The sweep, where `scenario_at` gives the scenario of a point from its settings. Fails if
    /// `scenario_at` does.
    pub fn whole<E>(
        self,
        scenario_at: impl Fn(&[Setting]) -> Result<Scenario, E>,
    ) -> Result<Sweep, E> {
        let point = |i: usize| {
            let mut settings = self.design.settings(i);
            settings.extend(self.ends.get(i).map(|end| Setting {
                key: "time.end".into(),
                value: AxisValue::Number(*end),
            }));
            scenario_at(&settings)
        };
        let points = (0..self.design.points())
            .map(point)
            .collect::<Result<_, E>>()?;
        let scenario = scenario_at(&[])?;
        let (seeds, with_bias) = (self.seeds, self.with_bias);
        Ok(Sweep {
            question: SweepQuestion::new(scenario, self.design, points, seeds, with_bias),
            points: self.points,
        })
    }
}

impl Dataset {
    /// The data set of a sweep.
    pub fn of_sweep(sweep: &Sweep) -> Self {
        let mut header = Provenance::of(&sweep.question.scenario);
        let SweepQuestion {
            design,
            seeds,
            with_bias,
            ..
        } = &sweep.question;
        let status = if sweep.is_complete() {
            Status::Complete
        } else {
            Status::Running
        };
        let axes: Vec<&str> = design
            .axes()
            .iter()
            .map(|axis| axis.name.as_str())
            .collect();
        let mut about = About {
            seeds: seeds.name().to_owned(),
            status: status.name().to_owned(),
            points: [sweep.points.len(), sweep.done()],
            bias: if *with_bias { ESTIMATED } else { "left out" }.to_owned(),
            design: name(design).to_owned(),
            axes: Some(axes.join(" ")).filter(|axes| !axes.is_empty()),
            relative_step: if let Design::Star { relative_step, .. } = design {
                Some(*relative_step)
            } else {
                None
            },
        };
        let units = header.units.clone();
        let mut dataset =
            Dataset::written(&units, |walk| attributes(walk, &mut header, &mut about));
        header.samples.extend(sweep.question.samples_of_files());
        series::write(&mut dataset, &header);
        coordinates(&mut dataset, design);
        if has_files(design) {
            let points = sweep.question.points.iter();
            let ends: Vec<f64> = points.map(|scenario| scenario.time.end).collect();
            dataset.write(&own::POINT_END.along(&shape(design), &[]), &ends);
        }
        let seeds: Vec<u64> = sweep
            .question
            .points
            .iter()
            .map(|scenario| scenario.ensemble.seed)
            .collect();
        dataset.write_by(|to| points(to, design, &seeds, &mut sweep.points.clone()));
        comparisons(&mut dataset, sweep);
        dataset
    }

    /// The sweep in the data set. Fails if the data set is not that of a sweep.
    pub fn sweep(&self) -> Result<StoredSweep, String> {
        read(self)
    }
}

/// What the attributes of a sweep say about it, besides where it comes from.
#[derive(Default)]
struct About {
    seeds: String,
    status: String,
    /// Number of points, and of those that are done.
    points: [usize; 2],
    bias: String,
    design: String,
    axes: Option<String>,
    relative_step: Option<f64>,
}

/// What `bias` says if the bias of the step was estimated.
const ESTIMATED: &str = "estimated";

fn attributes(walk: &mut Walk, header: &mut Provenance, about: &mut About) -> Walked {
    walk_origin(walk, SWEEP_FORMAT, &mut header.title, &mut header.program)?;
    walk.derived_attribute("scheme", header.scheme.as_str());
    walk.derived_attribute("seed", header.seed);
    walk.attribute("seeds", &mut about.seeds)?;
    walk.attribute("generator", &mut header.program.generator)?;
    walk.derived_attribute("paths", header.paths);
    walk.attribute("block_size", &mut header.program.block_size)?;
    walk.attribute("status", &mut about.status)?;
    walk.derived_attribute("points", about.points[0] as u64);
    walk.derived_attribute("completed_points", about.points[1] as u64);
    walk.attribute("bias_of_the_step", &mut about.bias)?;
    walk.attribute("design", &mut about.design)?;
    walk.attribute("axes", &mut about.axes)?;
    walk.attribute("relative_step", &mut about.relative_step)?;
    walk.attribute("scenario", &mut header.scenario_text)
}

/// The name of a design.
pub(crate) fn name(design: &Design) -> &'static str {
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
            let settings = (0..design.points()).map(|point| design.settings(point).pop());
            let none = || Setting {
                key: "none".into(),
                value: AxisValue::Number(f64::NAN),
            };
            let number = |value: AxisValue| match value {
                AxisValue::Number(number) => number,
                AxisValue::File(_) => f64::NAN,
            };
            let settings = settings.map(|setting| setting.unwrap_or_else(none));
            let (moved, values): (Vec<String>, Vec<f64>) = settings
                .map(|Setting { key, value }| (key, number(value)))
                .unzip();
            to.write(&own::POINT_KEY, &moved);
            to.write(&own::POINT_VALUE, &values);
            let (keys, values): (Vec<String>, Vec<f64>) = keys.iter().cloned().unzip();
            to.write(&own::KEY, &keys);
            to.write(&own::KEY_VALUE, &values);
        }
    }
}

/// Walk over the results of all points. `seeds` are those of the points.
fn points(
    walk: &mut Walk,
    design: &Design,
    seeds: &[u64],
    points: &mut Vec<Option<Point>>,
) -> Walked {
    let mut columns = PointColumns::of(points);
    columns.walk_estimates(walk, design)?;
    columns.walk_paths(walk, design, seeds)?;
    points.clear();
    for p in 0..design.points() {
        let is_right = columns.status[p] == 0 || columns.diverged[p] <= columns.completed[p];
        walk.check(is_right, || "more diverged paths than paths".to_string())?;
        points.push(columns.point(p));
    }
    Ok(())
}

const STATISTICS: usize = Statistic::ALL.len();

/// The results of all points, as the variables of a file.
struct PointColumns {
    estimates: [Vec<f64>; 7],
    corrected: [Vec<f64>; 3],
    /// The estimates without each group of paths.
    without: Vec<f64>,
    /// 0 if a point is not done, 1 if it is, and 2 if all of its paths diverged.
    status: Vec<i8>,
    completed: Vec<u64>,
    diverged: Vec<u64>,
    seconds: Vec<f64>,
    cycles: Vec<Option<LimitCycle>>,
}

impl PointColumns {
    fn of(points: &[Option<Point>]) -> Self {
        let estimates = |point: &Option<Point>| match point {
            Some(Point { estimates, .. }) => estimates
                .each_ref()
                .map(|e| (numbers_of(e), corrected_of(e))),
            None => [([f64::NAN; 7], [f64::NAN; 3]); STATISTICS],
        };
        let (estimates, corrected): (Vec<_>, Vec<_>) = points.iter().flat_map(estimates).unzip();
        let without = |point: &Option<Point>| {
            let known = point.as_ref().map_or(&[][..], |point| &point.without);
            (0..GROUPS)
                .flat_map(|group| known.get(group).copied().unwrap_or([f64::NAN; STATISTICS]))
                .collect::<Vec<f64>>()
        };
        let status = |point: &Option<Point>| match point {
            None => 0,
            Some(point) if point.diverged_paths < point.completed_paths => 1,
            Some(_) => 2,
        };
        let each = || points.iter().map(Option::as_ref);
        PointColumns {
            estimates: columns_of(estimates),
            corrected: columns_of(corrected),
            without: points.iter().flat_map(without).collect(),
            status: points.iter().map(status).collect(),
            completed: each()
                .map(|point| point.map_or(0, |point| point.completed_paths))
                .collect(),
            diverged: each()
                .map(|point| point.map_or(0, |point| point.diverged_paths))
                .collect(),
            seconds: each()
                .map(|point| point.map_or(f64::NAN, |point| point.seconds))
                .collect(),
            cycles: each()
                .map(|point| point.and_then(|point| point.cycle.clone()))
                .collect(),
        }
    }

    fn walk_estimates(&mut self, walk: &mut Walk, design: &Design) -> Walked {
        let mut coordinates = "statistic_long_name statistic_unit".to_string();
        match design {
            Design::Grid(_) => {}
            Design::Zip(axes) => axes
                .iter()
                .for_each(|axis| coordinates = format!("{coordinates} {}", axis.name)),
            Design::Star { .. } => coordinates.push_str(" point_key point_value"),
        }
        let attributes = [("coordinates", coordinates.as_str())];
        let shape = shape(design);
        let length = design.points() * STATISTICS;
        for (variable, values) in PER_STATISTIC.iter().zip(&mut self.estimates) {
            let dimensions = [&shape, variable.axes].concat();
            walk.sized(&variable.along(&dimensions, &attributes), values, length)?;
        }
        for (variable, values) in CORRECTED.iter().zip(&self.corrected) {
            let dimensions = [&shape, variable.axes].concat();
            walk.derived(&variable.along(&dimensions, &attributes), values);
        }
        let dimensions = [&shape, own::ESTIMATE_WITHOUT.axes].concat();
        walk.sized(
            &own::ESTIMATE_WITHOUT.along(&dimensions, &[]),
            &mut self.without,
            length * GROUPS,
        )
    }

    /// Walk over what became of the paths of each point, and over the cycles.
    fn walk_paths(&mut self, walk: &mut Walk, design: &Design, seeds: &[u64]) -> Walked {
        let (shape, count) = (shape(design), design.points());
        walk.sized(
            &own::POINT_STATUS.along(&shape, own::POINT_STATUS.attributes),
            &mut self.status,
            count,
        )?;
        walk.sized(
            &own::POINT_COMPLETED_PATHS.along(&shape, &[]),
            &mut self.completed,
            count,
        )?;
        walk.sized(
            &own::POINT_DIVERGED_PATHS.along(&shape, &[]),
            &mut self.diverged,
            count,
        )?;
        walk.derived(&own::POINT_SEED.along(&shape, &[]), seeds);
        walk.sized(
            &own::POINT_SECONDS.along(&shape, &[]),
            &mut self.seconds,
            count,
        )?;
        // A walk that reads begins without points.
        self.cycles.resize(count, None);
        walk_cycles(walk, &shape, &mut self.cycles)
    }

    /// A point; none if it is not done.
    fn point(&self, p: usize) -> Option<Point> {
        let estimate = |statistic: Statistic| {
            let row = p * STATISTICS + statistic.index();
            estimate_of(
                statistic,
                self.estimates.each_ref().map(|column| column[row]),
            )
        };
        let group = |values: &[f64]| -> GroupValues { std::array::from_fn(|i| values[i]) };
        let groups = self.without[p * GROUPS * STATISTICS..]
            .chunks(STATISTICS)
            .take(GROUPS)
            .map(group);
        (self.status[p] != 0).then(|| Point {
            estimates: Statistic::ALL.map(estimate),
            completed_paths: self.completed[p],
            diverged_paths: self.diverged[p],
            seconds: self.seconds[p],
            cycle: self.cycles[p].clone(),
            // There are fewer groups where there are fewer paths.
            without: groups
                .take_while(|values| values.iter().any(|x| !x.is_nan()))
                .collect(),
        })
    }
}

/// Walk over the cycles of the points of a design of this shape, if a point has one.
fn walk_cycles(walk: &mut Walk, shape: &[&str], cycles: &mut [Option<LimitCycle>]) -> Walked {
    const NUMBERS: usize = LimitCycle::NUMBERS.len();
    let [cycle, section] = [layout::CYCLE, layout::SECTION];
    let mut there = cycles.iter().any(Option::is_some).then_some(());
    if walk.present(&cycle, &mut there).is_none() {
        return Ok(());
    }
    let numbers = |cycle: &Option<LimitCycle>| {
        cycle
            .as_ref()
            .map_or([f64::NAN; NUMBERS], LimitCycle::numbers)
    };
    let states = |cycle: &Option<LimitCycle>| {
        let mut states = cycle
            .as_ref()
            .map_or_else(Vec::new, |cycle| cycle.section.clone());
        states.resize(LimitCycle::STATES, f64::NAN);
        states
    };
    let mut all: Vec<f64> = cycles.iter().flat_map(numbers).collect();
    let mut sections: Vec<f64> = cycles.iter().flat_map(states).collect();
    walk.derived(&layout::CYCLE_NUMBER, &texts(LimitCycle::NUMBERS));
    walk.derived(&layout::SECTION_STATE, &counted(0, LimitCycle::STATES));
    walk.sized(
        &cycle.along(&[shape, cycle.axes].concat(), &[]),
        &mut all,
        cycles.len() * NUMBERS,
    )?;
    let length = cycles.len() * LimitCycle::STATES;
    walk.sized(
        &section.along(&[shape, section.axes].concat(), &[]),
        &mut sections,
        length,
    )?;
    let found = all.chunks(NUMBERS).zip(sections.chunks(LimitCycle::STATES));
    for (cycle, (numbers, section)) in cycles.iter_mut().zip(found) {
        let there = LimitCycle::of_numbers(std::array::from_fn(|i| numbers[i]), section);
        *cycle = (!numbers[0].is_nan()).then_some(there);
    }
    Ok(())
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
pub(crate) fn read(from: &dyn Source) -> Result<StoredSweep, String> {
    let (mut header, mut about, mut results) =
        (Provenance::default(), About::default(), Vec::new());
    attributes(&mut Walk::Reading(from), &mut header, &mut about)?;
    let seeds = [Seeds::Common, Seeds::Independent]
        .into_iter()
        .find(|seeds| seeds.name() == about.seeds);
    let design = read_design(from, &about)?;
    points(&mut Walk::Reading(from), &design, &[], &mut results)?;
    let Provenance {
        scenario_text,
        program,
        ..
    } = header;
    Ok(StoredSweep {
        scenario_text,
        samples: series::read(from)?,
        ends: match has_files(&design) {
            true => read_or_empty(from, &own::POINT_END.along(&shape(&design), &[]))?,
            false => Vec::new(),
        },
        other_program: program.other(),
        program,
        with_bias: about.bias == ESTIMATED,
        seeds: seeds.ok_or_else(|| format!("unknown seeds \"{}\"", about.seeds))?,
        status: Status::from_name(&about.status)
            .ok_or_else(|| format!("unknown status \"{}\"", about.status))?,
        points: results,
        design,
    })
}

fn read_design(from: &dyn Source, about: &About) -> Result<Design, String> {
    let axes = |dimension: Option<&str>| -> Result<Vec<SweepAxis>, String> {
        let names = about
            .axes
            .as_ref()
            .ok_or_else(|| "axes is missing".to_owned())?;
        let axis = |name: &str| {
            let axes = [dimension.unwrap_or(name)];
            let key: String = AttributeValue::of(
                from.attribute(Some(name), "key")?,
                &format!("key of {name}"),
            )?;
            let variable = variable(name, &axes, Unit::None, "");
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
        names.split(' ').map(axis).collect()
    };
    let refused = |error: DesignError| error.to_string();
    match about.design.as_str() {
        "grid" => Design::of(axes(None)?, false).map_err(refused),
        "zip" => Design::of(axes(Some("point"))?, true).map_err(refused),
        "elasticity" => {
            let keys: Vec<String> = read_variable(from, &own::KEY)?;
            let keys = keys
                .into_iter()
                .zip(read_variable(from, &own::KEY_VALUE)?)
                .collect();
            let relative_step = about
                .relative_step
                .ok_or_else(|| "relative_step is missing".to_owned())?;
            Ok(Design::Star {
                keys,
                relative_step,
            })
        }
        other => Err(format!("unknown design \"{other}\"")),
    }
}
