//! The observer of one block of paths. It yields the totals of the block, and the records of single
//! paths.

use super::column::Columns as _;
use super::density::DensityFold;
use super::folds::PathFolds;
use super::law::PhaseLaw;
use super::path::{Censored, EndedPhase, PathFold};
use super::periods::PeriodFold;
use super::record::{PathRow, TrajectoryRow};
use super::spectrum::SpectrumFold;
use super::{BlockResult, BlockRows, EventColumns, PathColumns, Record, Totals, TrajectoryRows};
use crate::model::{Event, Problem, Sign};
use crate::scheme::{Instant, Observer, Segment, Snapshot, Timeline};
use crate::sums::Replicate;

const STICK: usize = PhaseLaw::Stick as usize;

/// The observer of one block of paths.
pub struct BlockObserver {
    /// Number of the path in each lane, and of its independent unit.
    path_numbers: Vec<u64>,
    units: Vec<u64>,
    unit: Replicate,
    folds: PathFolds,
    totals: Totals,
    periods: PeriodFold,
    /// The requested measures on the output grid.
    density: Option<DensityFold>,
    spectrum: Option<SpectrumFold>,
    /// Events of each lane, if they are kept.
    events: Option<Vec<Vec<Event>>>,
    /// The first lanes on the output grid, which are those of the first paths of the run.
    trajectories: Vec<TrajectoryRows>,
}

/// A path on the output grid without data.
fn unknown(path: u64, rows: usize) -> TrajectoryRows {
    let mut table = TrajectoryRows {
        path: vec![path],
        ..TrajectoryRows::default()
    };
    (0..rows).for_each(|_| table.push(TrajectoryRows::MISSING));
    table
}

impl BlockObserver {
    /// An observer of these paths, whose numbers must ascend. Lane i is path `paths[i]`. Each path
    /// is at rest at x0, in its first static phase. The two paths of a pair must follow one another
    /// in the list.
    pub fn new(
        model: &Problem,
        timeline: &Timeline,
        record: &Record,
        paths: &[u64],
        unit: Replicate,
    ) -> Self {
        let (rows, x0) = (timeline.rows(), model.initial_displacement);
        let units: Vec<u64> = paths.iter().map(|number| unit.of(*number)).collect();
        let mut totals = Totals::empty(model, timeline, record);
        let spectrum = totals.sums.spectrum.take();
        BlockObserver {
            path_numbers: paths.to_vec(),
            unit,
            folds: PathFolds::new(model, timeline, record, paths.len()),
            totals,
            periods: PeriodFold::new(timeline, x0, paths.len(), unit),
            density: record
                .density
                .then(|| DensityFold::new(timeline, x0, &units)),
            spectrum: spectrum.map(|sums| SpectrumFold::new(timeline, &units, *sums)),
            units,
            events: record.events.then(|| vec![Vec::new(); paths.len()]),
            trajectories: paths
                .iter()
                .take_while(|&&path| path < record.trajectories)
                .map(|path| unknown(*path, rows))
                .collect(),
        }
    }

    /// The same observer for a scheme with this step, if the scheme has one.
    pub fn with_step(mut self, step: Option<f64>) -> Self {
        self.totals.counts.set_step(step);
        self
    }

    /// The result of the block, which has `path_count` paths from number `first_path` on. The paths
    /// in `diverged` did not reach t_end and were not observed.
    pub fn finish(mut self, first_path: u64, path_count: u64, diverged: Vec<u64>) -> BlockResult {
        let PathFolds { paths, record, .. } = &self.folds;
        self.totals.counts.density = self.density.map(|density| Box::new(density.finish()));
        self.totals.sums.phases = self.folds.sums(None, self.periods.finish(), self.unit);
        self.totals.sums.spectrum = self.spectrum.map(|spectrum| Box::new(spectrum.finish()));
        self.totals.end(paths, &diverged, self.unit);
        // Every path of the block, in order, with its lane; none for a diverged path.
        let mut watched = (0..).zip(&self.path_numbers).peekable();
        let lane = |number| {
            (
                number,
                watched
                    .next_if(|(_, path)| **path == number)
                    .map(|(lane, _)| lane),
            )
        };
        let lanes: Vec<(u64, Option<usize>)> =
            (first_path..first_path + path_count).map(lane).collect();
        let instants = self.totals.timeline.rows();
        let rows = BlockRows {
            first_path,
            paths: path_count,
            path_columns: record.paths.then(|| {
                let mut columns = PathColumns::default();
                for (_, lane) in &lanes {
                    columns.push(match lane {
                        Some(lane) => path_row(&paths[*lane]),
                        None => PathRow {
                            diverged: 1,
                            ..PathColumns::MISSING
                        },
                    });
                }
                columns
            }),
            events: self.events.map(|events| {
                let mut columns = EventColumns::default();
                lanes.iter().for_each(|(_, lane)| {
                    columns.push_path(lane.map_or(&[], |lane| &events[lane]))
                });
                columns
            }),
            trajectories: (first_path < record.trajectories).then(|| {
                let mut columns = TrajectoryRows::default();
                for (number, lane) in lanes
                    .iter()
                    .take_while(|(number, _)| *number < record.trajectories)
                {
                    match lane {
                        Some(lane) => columns.append(&self.trajectories[*lane]),
                        None => columns.append(&unknown(*number, instants)),
                    }
                }
                columns
            }),
        };
        BlockResult {
            rows,
            diverged,
            totals: self.totals,
        }
    }

    /// The paths have reached t_end, in these phases.
    fn end(&mut self, snapshot: &Snapshot<'_>) {
        let BlockObserver {
            folds,
            totals,
            units,
            ..
        } = self;
        let counts = &mut totals.counts;
        folds.at(Instant::End, snapshot, |lane, phase| match phase {
            Some(Censored::FirstStick) => counts.first_censored += 1,
            Some(Censored::Stick(so_far)) => counts.laws[STICK].censored(units[lane], so_far),
            Some(Censored::Slip) => counts.sub_phases.censored(),
            None => {}
        });
        for (path, unit) in folds.laws.iter().flatten().zip(&*units) {
            path.end(snapshot.time, |law, so_far| {
                counts.laws[law as usize].censored(*unit, so_far)
            });
        }
        if let (Some(motion), Some(extremes)) = (&folds.motion, &mut counts.extremes) {
            motion
                .iter()
                .zip(units)
                .for_each(|(path, unit)| extremes.end(*unit, path));
        }
    }

    /// Adds the row of a path to those that are kept.
    fn keep(&mut self, row: usize, snapshot: &Snapshot<'_>) {
        for (lane, rows) in self.trajectories.iter_mut().enumerate() {
            let model = self.folds.model(lane);
            let (x, v, t) = (
                snapshot.displacement[lane],
                snapshot.velocity[lane],
                snapshot.temperature[lane],
            );
            let b = model.total_force(snapshot.time, t, x, v);
            // At rest in a slip, at a turning point or at the end of a stick, the body is about to
            // follow b.
            let direction = if v == 0.0 {
                Sign::of(b)
            } else {
                self.folds.paths[lane].direction
            };
            let sliding = model.sliding_friction(direction, snapshot.time, x, v);
            let is_static = snapshot.is_static[lane];
            let seen = TrajectoryRow {
                displacement: x,
                velocity: v,
                temperature: t,
                force: b,
                friction: if is_static { b } else { sliding },
                is_static: is_static.into(),
            };
            rows.set(row, seen);
        }
    }
}

fn path_row(path: &PathFold) -> PathRow {
    PathRow {
        displacement_end: path.displacement_end,
        max_displacement: path.max_displacement,
        first_stick_duration: path.first_duration.unwrap_or(f64::NAN),
        stick_time: path.stick_time,
        friction_work: path.friction_work,
        sticks: path.sticks.count,
        slips: path.slips,
        sub_phases: path.sub_phases,
        diverged: 0,
    }
}

impl Observer for BlockObserver {
    #[inline]
    fn event(&mut self, lane: usize, event: Event) {
        let (counts, unit) = (&mut self.totals.counts, self.units[lane]);
        match self.folds.event(lane, &event, |law, value| {
            counts.laws[law as usize].completed(unit, value)
        }) {
            Some(EndedPhase::FirstStick) => counts.first_completed += 1,
            Some(EndedPhase::Stick(duration)) => counts.laws[STICK].completed(unit, duration),
            Some(EndedPhase::Slip(sub_phases)) => counts.sub_phases.completed(unit, sub_phases),
            None => {}
        }
        if let Some(density) = &mut self.density {
            density.event(lane, &event);
        }
        if let Some(events) = &mut self.events {
            events[lane].push(event);
        }
    }

    fn realised(&mut self, lane: usize, model: &Problem) {
        self.folds.realised(lane, model);
    }

    fn follows(&self) -> bool {
        self.folds.motion.is_some() || self.density.is_some()
    }

    fn segment(&mut self, lane: usize, segment: &Segment) {
        self.folds.segment(lane, segment);
        if let Some(density) = &mut self.density {
            density.segment(lane, segment);
        }
    }

    fn snapshot(&mut self, instant: Instant, snapshot: Snapshot<'_>) {
        match instant {
            Instant::Output(row) => {
                self.totals.row(row, &snapshot, self.unit);
                if let (Some(motion), Some(extremes)) =
                    (&self.folds.motion, &mut self.totals.counts.extremes)
                {
                    extremes.row(row, motion, snapshot.displacement);
                }
                if let Some(spectrum) = &mut self.spectrum {
                    spectrum.row(row, &snapshot);
                }
                self.keep(row, &snapshot);
            }
            Instant::Period(n) => self.periods.observe(n, &snapshot),
            Instant::Counting => self.folds.at(instant, &snapshot, |_, _| ()),
            Instant::End => self.end(&snapshot),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stats::synthetic::{Path, model, observe, slip, stick, turn};
    use crate::stats::{Estimate, Statistic, Summary};
    use crate::sums::Merge as _;
    use rand_distr::{Distribution, StandardNormal, StandardUniform};
    use rand_pcg::Pcg64Dxsm;
    use rand_pcg::rand_core::SeedableRng;

    fn random_walk(rng: &mut Pcg64Dxsm) -> Path {
        let (mut x, mut t, mut events) = (6.0, 0.0, Vec::new());
        for _ in 0..8 {
            let mut wait = || Distribution::<f64>::sample(&StandardUniform, rng);
            t += wait();
            events.push(slip(t, x));
            t += wait();
            events.push(turn(t, x + 2.0));
            t += wait();
            x += Distribution::<f64>::sample(&StandardNormal, rng);
            events.push(stick(t, x));
        }
        Path { events, end: x }
    }

    /// Sums of 600 numbers near 10 have a rounding error below 1e-13. A ratio of small differences
    /// of them loses a digit.
    fn close(a: f64, b: f64) -> bool {
        (a - b).abs() <= 1e-11 * (1.0 + a.abs()) || (a.is_nan() && b.is_nan())
    }

    /// The errors of spreads over periods are computed about block means, and the last path has no
    /// other path in its block. The effect is a relative O(1/256). The same holds for the tails from
    /// which the interval of a standard deviation or a correlation comes.
    fn assert_same_estimate(a: &Estimate, b: &Estimate) {
        let near = |a: f64, b: f64| (a / b - 1.0).abs() < 0.01;
        assert!(close(a.estimate, b.estimate), "{a:?} {b:?}");
        match a.statistic {
            Statistic::DiffusionCoefficient => {
                assert!(near(a.standard_error, b.standard_error), "{a:?} {b:?}")
            }
            Statistic::PhaseDisplacementSd => {
                assert!(near(a.standard_error, b.standard_error), "{a:?} {b:?}");
                assert!(near(a.low, b.low) && near(a.high, b.high), "{a:?} {b:?}");
            }
            Statistic::DisplacementEndSd
            | Statistic::StickDurationSd
            | Statistic::PeriodDisplacementSd
            | Statistic::PeriodDisplacementCorrelation => {
                assert!(close(a.standard_error, b.standard_error), "{a:?} {b:?}");
                assert!(near(a.low, b.low) && near(a.high, b.high), "{a:?} {b:?}");
            }
            _ => {
                assert!(close(a.standard_error, b.standard_error), "{a:?} {b:?}");
                assert!(close(a.low, b.low) && close(a.high, b.high), "{a:?} {b:?}");
            }
        }
    }

    fn assert_same_summary(whole: &Summary, merged: &Summary) {
        for (a, b) in whole.estimates.iter().zip(&merged.estimates) {
            assert_same_estimate(a, b);
        }
        let (sticks, others) = (&whole.stick_durations, &merged.stick_durations);
        assert_eq!(sticks.survival_ends, others.survival_ends);
        assert_eq!(sticks.quantile_ends, others.quantile_ends);
        assert_eq!(sticks.histogram, others.histogram);
        assert_eq!(whole.sub_phases, merged.sub_phases);
        let all_close = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| close(*a, *b));
        let (bands, others) = (&whole.bands, &merged.bands);
        assert_eq!(bands.static_probability, others.static_probability);
        for (a, b) in [
            (&bands.displacement, &others.displacement),
            (&bands.velocity, &others.velocity),
            (&bands.temperature, &others.temperature),
        ] {
            assert_eq!(a.quantiles, b.quantiles);
            assert!(all_close(&a.mean, &b.mean) && all_close(&a.sd, &b.sd));
        }
        assert!(all_close(&whole.periods.variance, &merged.periods.variance));
    }

    #[test]
    fn blocks_merged_in_order_are_the_ensemble_folded_at_once() {
        let timeline = Timeline {
            end: 32.0,
            output_step: 16.0,
            period: Some(10.0),
            after: 0.0,
        };
        let mut rng = Pcg64Dxsm::seed_from_u64(11);
        let paths: Vec<Path> = (0..600).map(|_| random_walk(&mut rng)).collect();
        let mut snapshots = |n: usize| -> Vec<Vec<f64>> {
            (0..n)
                .map(|_| {
                    paths
                        .iter()
                        .map(|p| p.end + Distribution::<f64>::sample(&StandardNormal, &mut rng))
                        .collect()
                })
                .collect()
        };
        let (rows, periods) = (snapshots(3), snapshots(3));
        let part = |from: usize, to: usize| {
            let cut = |all: &[Vec<f64>]| {
                all.iter()
                    .map(|row| row[from..to].to_vec())
                    .collect::<Vec<_>>()
            };
            observe(
                &timeline,
                &Record::NOTHING,
                from as u64,
                &paths[from..to],
                &cut(&rows),
                &cut(&periods),
            )
            .totals
        };
        let whole = part(0, 600).summary();
        let mut merged = Totals::empty(&model(), &timeline, &Record::NOTHING);
        for (from, to) in [(0, 256), (256, 512), (512, 599), (599, 600)] {
            merged.merge(&part(from, to));
        }
        assert_same_summary(&whole, &merged.summary());
    }

    /// A path whose waits and displacements have long tails.
    fn long_tailed_walk(rng: &mut Pcg64Dxsm) -> Path {
        let (mut x, mut t, mut events) = (6.0, 0.0, Vec::new());
        let mut long = || -> f64 {
            let normal: f64 = StandardNormal.sample(rng);
            normal * (0.6 * normal).exp()
        };
        let scale = 0.2 + long().abs().sqrt();
        for _ in 0..4 {
            t += scale * long().abs();
            events.push(slip(t, x));
            x += long();
            events.push(stick(t, x));
        }
        Path { events, end: x }
    }

    /// The error of a standard deviation has the degrees of freedom that the tails of the law leave
    /// ([`crate::sums::spread`]), and those are the tails of all paths. So the interval is as wide
    /// from eight blocks as from the same paths in one block, up to what is taken about the means
    /// of blocks (1 %). With the tails of the first block alone it would be wider by 6 to 13 %.
    #[test]
    fn intervals_of_an_sd_do_not_depend_on_the_blocks() {
        let timeline = Timeline {
            end: 1e3,
            output_step: 1e3,
            period: Some(300.0),
            after: 0.0,
        };
        let mut rng = Pcg64Dxsm::seed_from_u64(12);
        let paths: Vec<Path> = (0..600).map(|_| long_tailed_walk(&mut rng)).collect();
        let mut x = vec![6.0; 600];
        let periods: Vec<Vec<f64>> = (0..3)
            .map(|_| {
                x.iter_mut()
                    .for_each(|x| *x += long_tailed_walk(&mut rng).end - 6.0);
                x.clone()
            })
            .collect();
        let in_blocks_of = |size: usize| {
            let mut blocks = (0..600).step_by(size).map(|from| {
                let cut: Vec<Vec<f64>> = periods
                    .iter()
                    .map(|x| x[from..from + size].to_vec())
                    .collect();
                observe(
                    &timeline,
                    &Record::NOTHING,
                    from as u64,
                    &paths[from..from + size],
                    &[],
                    &cut,
                )
                .totals
            });
            let mut totals = blocks.next().expect("a block");
            blocks.for_each(|block| totals.merge(&block));
            totals.summary()
        };
        let (one, many) = (in_blocks_of(600), in_blocks_of(75));
        for statistic in [
            Statistic::StickDurationSd,
            Statistic::DisplacementEndSd,
            Statistic::PeriodDisplacementSd,
            Statistic::PhaseDisplacementSd,
        ] {
            // The relative half-width, in standard errors: a quantile of Student's t.
            let quantile = |summary: &Summary| {
                let e = summary.estimate(statistic);
                (e.estimate / e.low - 1.0) * e.estimate / e.standard_error
            };
            let (one, many) = (quantile(&one), quantile(&many));
            println!("{}: {one:.4} {many:.4}", statistic.name());
            assert!(
                one > 2.0,
                "{}: the tails are not long, {one}",
                statistic.name()
            );
            assert!(
                (many / one - 1.0).abs() < 0.02,
                "{}: {one} {many}",
                statistic.name()
            );
        }
    }

    /// A block of the paths 100 to 104, of which 101 and 104 diverged.
    fn block_with_diverged_paths() -> BlockResult {
        let timeline = Timeline {
            end: 2.0,
            output_step: 1.0,
            period: None,
            after: 0.0,
        };
        let record = Record {
            trajectories: 103,
            ..Record::everything()
        };
        let mut observer = BlockObserver::new(
            &model(),
            &timeline,
            &record,
            &[100, 102, 103],
            Replicate::Path,
        );
        observer.event(1, slip(0.5, 6.0));
        observer.event(1, stick(1.5, 7.0));
        observer.event(2, slip(1.0, 6.0));
        let (v, is_static) = ([0.0, 0.25, 0.5], [true, false, false]);
        for (row, x) in [[6.0, 6.0, 6.0], [6.0, 6.5, 6.0], [6.0, 7.0, 8.0]]
            .iter()
            .enumerate()
        {
            let snapshot = Snapshot {
                time: row as f64,
                displacement: x,
                velocity: &v,
                temperature: &v,
                is_static: &is_static,
            };
            observer.snapshot(Instant::Output(row), snapshot);
            if row == 2 {
                observer.snapshot(Instant::End, snapshot);
            }
        }
        observer.finish(100, 5, vec![101, 104])
    }

    #[test]
    fn diverged_paths_stay_out_of_the_statistics() {
        let result = block_with_diverged_paths();
        let columns = result.rows.path_columns.expect("asked for");
        assert_eq!(columns.diverged, [0, 1, 0, 0, 1]);
        assert_eq!(columns.slips, [0, 0, 1, 0, 0]);
        assert_eq!(columns.sub_phases, [0, 0, 1, 0, 0]);
        // With f_d = 2:
        let expected = [0.0, f64::NAN, 2.0, 4.0, f64::NAN];
        assert!(
            columns
                .friction_work
                .iter()
                .zip(expected)
                .all(|(a, b)| a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan()))
        );
        assert_eq!(
            (columns.displacement_end[3], columns.max_displacement[3]),
            (8.0, 8.0)
        );
        assert!(columns.first_stick_duration[0].is_nan());
        assert_eq!(
            (columns.first_stick_duration[2], columns.stick_time[2]),
            (0.5, 1.0)
        );

        let events = result.rows.events.expect("asked for");
        assert_eq!(events.count, [0, 0, 2, 1, 0]);
        assert_eq!(
            (events.time, events.kind, events.sign),
            (vec![0.5, 1.5, 1.0], vec![1, 0, 1], vec![1, 0, 1])
        );

        let trajectories = result
            .rows
            .trajectories
            .expect("paths 100 to 102 are among the first 103");
        assert_eq!(trajectories.path, [100, 101, 102]);
        assert_eq!(trajectories.displacement[..3], [6.0, 6.0, 6.0]);
        assert!(trajectories.displacement[3..6].iter().all(|x| x.is_nan()));
        assert_eq!(trajectories.displacement[6..], [6.0, 6.5, 7.0]);
        assert_eq!(trajectories.velocity[6..], [0.25; 3]);
        // b = T - x with m = K = beta = 1. Path 102 slips to the right against f_d = 2, so F = 2.
        assert_eq!(trajectories.force[6..], [-5.75, -6.25, -6.75]);
        assert_eq!(trajectories.friction[6..], [2.0; 3]);
        // Path 100 stays in its first stick: F = b.
        assert_eq!(trajectories.friction[..3], trajectories.force[..3]);
        assert_eq!(trajectories.force[..3], [-6.0; 3]);
        assert_eq!(trajectories.is_static, [1, 1, 1, 0, 0, 0, 0, 0, 0]);

        let summary = result.totals.summary();
        assert_eq!(
            (summary.completed_paths, summary.diverged),
            (5, vec![101, 104])
        );
        assert_eq!(summary.bands.displacement.mean, [6.0, 18.5 / 3.0, 7.0]);
    }

    #[test]
    fn a_block_of_diverged_paths_adds_only_their_numbers() {
        let timeline = Timeline {
            end: 2.0,
            output_step: 1.0,
            period: Some(1.0),
            after: 0.0,
        };
        let record = Record {
            trajectories: 2,
            ..Record::everything()
        };
        let result = BlockObserver::new(&model(), &timeline, &record, &[], Replicate::Path).finish(
            0,
            2,
            vec![0, 1],
        );
        let summary = result.totals.summary();
        assert_eq!((summary.completed_paths, summary.diverged.len()), (2, 2));
        assert!(summary.estimates.iter().all(|e| e.estimate.is_nan()));
        let trajectories = result.rows.trajectories.expect("both are asked for");
        assert_eq!(
            (trajectories.displacement.len(), trajectories.is_static),
            (6, vec![0; 6])
        );
    }
}
