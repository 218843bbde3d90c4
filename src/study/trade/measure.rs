//! Running the grid: estimates, their change from step to step on one realisation of the noise,
//! and CPU time per path.

use super::setting::{Cost, GROUPS, TradeSetting};
use super::settings::is_exact;
use super::timing::{bare_plan, cost};
use super::{LeftOut, Number, Pairing, PlannedCost, SettingGrid, Trade, TradeError, pairing};
use crate::ensemble::{Plan, in_order_while};
use crate::scenario::{Ensemble, Scenario};
use crate::scheme::{Scheme, Simulate as _};
use crate::stats::{Estimate, GroupValues, Totals};
use crate::study::clock::Stopwatch;
use crate::sums::Merge as _;
use crate::sums::jackknife;
use std::convert::Infallible;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// If a measurement was cut short and fewer groups have paths, no error can be given.
const FEWEST_GROUPS: usize = 8;

/// Number of paths that one thread simulates at a time.
const PIECE: u64 = 256;

/// Distance between the path numbers of different parts of the measurement, so that the parts are
/// independent.
const APART: u64 = 1 << 40;

/// Limits of a measurement, and a function that is informed about its progress.
#[derive(Clone, Copy, Default)]
pub struct Limits<'a> {
    /// CPU time of each thread, for a machine that turns out slower than in the pilot. Anything
    /// unfinished by then is cut short.
    pub time: Option<Duration>,
    /// When raised, the pieces in progress are the last. Measurements in progress are cut short,
    /// and further ones are left out.
    pub stop: Option<&'a AtomicBool>,
    /// Called with the name of the next measurement.
    pub begins: Option<&'a (dyn Fn(&str) + Sync)>,
}

impl Limits<'_> {
    fn is_stopped(&self) -> bool {
        self.stop.is_some_and(|stop| stop.load(Ordering::Relaxed))
    }

    fn begin(&self, what: &str) {
        if let Some(begins) = self.begins {
            begins(what);
        }
    }
}

/// Measure a scenario within about `budget` of CPU time on each thread; `limits.time` is ignored.
/// On an idle machine this is wall-clock time, and on a busy one it takes up to four times as long.
/// Fails if the budget is too small for the reference, or if the scenario has a duration of 0.
pub fn measure_within(
    scenario: &Scenario,
    budget: Duration,
    threads: usize,
    limits: Limits<'_>,
) -> Result<Trade, TradeError> {
    let watch = Stopwatch::start(threads);
    limits.begin("a few paths of each scheme, to divide the budget");
    let mut grid = SettingGrid::of(scenario);
    let planned = PlannedCost::within(scenario, &mut grid, budget, threads)?;
    let time = Some(budget.saturating_sub(watch.elapsed()));
    measure(
        scenario,
        &grid,
        &planned,
        threads,
        Limits { time, ..limits },
    )
}

// Shares of the time after which no further paths are begun: for the reference, for everything
// without a step, and for everything.
const REFERENCE_ENDS: f64 = 0.35;
const FREE_ENDS: f64 = 0.5;
const ALL_ENDS: f64 = 0.9;

/// Measure a scenario at a planned cost. If no limit cuts it short, everything but the costs is a
/// function of scenario, grid and planned cost.
pub fn measure(
    scenario: &Scenario,
    grid: &SettingGrid,
    planned: &PlannedCost,
    threads: usize,
    limits: Limits<'_>,
) -> Result<Trade, TradeError> {
    if scenario.time.end == 0.0 {
        return Err(TradeError::NothingHappens);
    }
    let watch = Stopwatch::start(threads);
    let until = |share: f64| MeasureUntil {
        threads,
        watch,
        time: limits.time.map(|time| time.mul_f64(share)),
        limits,
    };
    let [reference_ends, free_ends] = if planned.steps > 0 {
        [REFERENCE_ENDS, FREE_ENDS]
    } else {
        [FREE_ENDS, ALL_ENDS]
    };
    let runs = free_runs(grid, planned);
    let tightest = runs
        .iter()
        .rposition(|run| is_exact(run.scheme))
        .ok_or(TradeError::NothingHappens)?;
    // The reference comes first, because everything else is compared with it and time may run out.
    limits.begin(&runs[tightest].scheme.to_string());
    let reference = free(scenario, &runs[tightest], until(reference_ends))?;
    let paired = FreeRun {
        paths: runs[tightest].paths / pairing::SHARE,
        first: (grid.free.len() as u64 + 2) * APART,
        ..runs[tightest]
    };
    let pairing = pairing_of(scenario, &reference, &paired, until(reference_ends))?;
    let mut left_out = grid.left_out.clone();
    let mut others =
        |runs: &[FreeRun]| free_until_stopped(scenario, runs, until(free_ends), &mut left_out);
    let looser = others(&runs[..tightest])?;
    let tighter = others(&runs[tightest + 1..])?;
    let mut settings = coupled(scenario, grid, planned, until(ALL_ENDS))?;
    if planned.steps > 0 && settings.is_empty() {
        left_out.extend(
            grid.stepping
                .iter()
                .map(|scheme| unfinished(scheme.name().into())),
        );
    }
    settings.extend(looser);
    settings.push(reference);
    let reference = settings.len() - 1;
    settings.extend(tighter);
    limits.begin("CPU times");
    let timing = if limits.is_stopped() {
        planned.timing.min(BRIEF)
    } else {
        planned.timing
    };
    for setting in &mut settings {
        setting.cost = cost(&scenario.with_scheme(setting.scheme)?.plan(), timing);
    }
    left_out.extend(settings.iter().filter_map(diverged));
    Ok(Trade {
        left_out,
        ..Trade::of_rungs(scenario, settings, reference, pairing)?
    })
}

fn unfinished(what: String) -> LeftOut {
    LeftOut {
        what,
        why: "the measurement ended too early".into(),
    }
}

/// Why a setting is not recommended, if some of its paths diverged.
fn diverged(setting: &TradeSetting) -> Option<LeftOut> {
    (setting.diverged > 0).then(|| LeftOut {
        what: setting.scheme.to_string(),
        why: format!(
            "{} of {} paths diverged; not recommended at any accuracy",
            setting.diverged, setting.paths
        ),
    })
}

/// A run of a scheme without a step, whose paths are numbered from `first` on.
#[derive(Clone, Copy)]
struct FreeRun {
    scheme: Scheme,
    paths: u64,
    first: u64,
}

fn free_runs(grid: &SettingGrid, planned: &PlannedCost) -> Vec<FreeRun> {
    (grid.free.iter().zip(&planned.free_paths).zip(2..))
        .map(|((scheme, paths), part)| FreeRun {
            scheme: *scheme,
            paths: *paths,
            first: part * APART,
        })
        .filter(|run| run.paths > 0)
        .collect()
}

/// Measure the settings of these runs. Those that begin after the caller has asked to stop are left
/// out.
fn free_until_stopped(
    scenario: &Scenario,
    runs: &[FreeRun],
    end: MeasureUntil<'_>,
    left_out: &mut Vec<LeftOut>,
) -> Result<Vec<TradeSetting>, TradeError> {
    let mut settings = Vec::new();
    for run in runs {
        if end.limits.is_stopped() {
            left_out.push(unfinished(run.scheme.to_string()));
            continue;
        }
        end.limits.begin(&run.scheme.to_string());
        settings.push(free(scenario, run, end)?);
    }
    Ok(settings)
}

/// The effect of antithetic pairs on the variance, from this run in pairs if the scenario has none.
fn pairing_of(
    scenario: &Scenario,
    reference: &TradeSetting,
    paired: &FreeRun,
    end: MeasureUntil<'_>,
) -> Result<Pairing, TradeError> {
    if scenario.ensemble.antithetic {
        return Ok(Pairing::Asked);
    }
    let is_random = scenario.model.is_random();
    if !is_random || end.limits.is_stopped() || paired.paths < pairing::FEWEST {
        return Ok(Pairing::Unknown);
    }
    end.limits.begin("antithetic pairs");
    let in_pairs = Scenario {
        ensemble: Ensemble {
            antithetic: true,
            ..scenario.ensemble
        },
        ..scenario.clone()
    };
    Ok(Pairing::of(reference, &free(&in_pairs, paired, end)?))
}

/// Seconds for timing a setting after the caller has asked to stop.
const BRIEF: f64 = 0.1;

/// The time after which no further paths are begun.
#[derive(Clone, Copy)]
struct MeasureUntil<'a> {
    threads: usize,
    watch: Stopwatch,
    time: Option<Duration>,
    limits: Limits<'a>,
}

impl MeasureUntil<'_> {
    /// Make pieces and take them in order. Whether to go on is asked after each piece, so the first
    /// one is always done. Returns the number of pieces taken.
    fn pieces<R: Send>(
        &self,
        count: u64,
        make: impl Fn(u64, &AtomicBool) -> Option<R> + Sync,
        mut take: impl FnMut(R) + Send,
    ) -> u64 {
        let never = AtomicBool::new(false);
        let stop = self.limits.stop.unwrap_or(&never);
        let deliver = |piece| -> Result<_, Infallible> {
            take(piece);
            let is_late = self.time.is_some_and(|time| self.watch.elapsed() > time);
            Ok(if is_late || self.limits.is_stopped() {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            })
        };
        let Ok(taken) = in_order_while(
            count,
            self.threads,
            &never,
            |piece| make(piece, stop),
            deliver,
        );
        taken
    }
}

/// The number of paths, made even if paths are antithetic pairs.
fn whole_pairs(plan: &Plan, paths: u64) -> u64 {
    if plan.antithetic {
        paths.next_multiple_of(2)
    } else {
        paths
    }
}

/// Measure the setting of a scheme without a step.
fn free(
    scenario: &Scenario,
    run: &FreeRun,
    end: MeasureUntil<'_>,
) -> Result<TradeSetting, TradeError> {
    let plan = bare_plan(scenario, run.scheme)?;
    let paths = whole_pairs(&plan, run.paths);
    let mut totals = Totals::empty(plan.model(), plan.timeline(), &plan.record);
    let make = |piece: u64, stop: &AtomicBool| {
        let done = piece * PIECE;
        Some(
            plan.piece_until(run.first + done, PIECE.min(paths - done), stop)?
                .totals,
        )
    };
    end.pieces(paths.div_ceil(PIECE), make, |piece| totals.merge(&piece));
    Ok(setting(run.scheme, &totals))
}

fn setting(scheme: Scheme, totals: &Totals) -> TradeSetting {
    let summary = totals.summary();
    let (paths, diverged) = (summary.completed_paths, summary.diverged.len() as u64);
    let number = |e: &Estimate| Number {
        value: e.estimate,
        error: e.standard_error,
    };
    let estimates = summary.estimates.iter().map(number).collect();
    TradeSetting {
        scheme,
        paths,
        diverged,
        cost: Cost::UNKNOWN,
        estimates,
        changes: Vec::new(),
    }
}

/// Measure the settings of all schemes with a step; the list is empty if they are cut short too early.
/// Every step gets its noise from the finest one, so that path n sees the same realisation on every
/// setting.
fn coupled(
    scenario: &Scenario,
    grid: &SettingGrid,
    planned: &PlannedCost,
    end: MeasureUntil<'_>,
) -> Result<Vec<TradeSetting>, TradeError> {
    let steps = &grid.steps[..planned.steps.min(grid.steps.len())];
    let mut plans: Vec<(Scheme, Plan)> = Vec::new();
    for &kind in &grid.stepping {
        for (k, &h) in steps.iter().enumerate() {
            let (scheme, refinement) = (kind.with(h), 1 << (steps.len() - 1 - k));
            let plan = bare_plan(scenario, scheme)?;
            plans.push((
                scheme,
                Plan {
                    simulation: plan.simulation.fed_by_finer(refinement),
                    ..plan
                },
            ));
        }
    }
    let Some((_, any)) = plans.first().filter(|_| !end.limits.is_stopped()) else {
        return Ok(Vec::new());
    };
    end.limits.begin(&format!(
        "{} steps of {}",
        steps.len(),
        grid.stepping
            .iter()
            .map(|kind| kind.name())
            .collect::<Vec<_>>()
            .join(" and ")
    ));
    let empty = Totals::empty(any.model(), any.timeline(), &any.record);
    let groups = in_groups(
        &plans,
        &empty,
        whole_pairs(any, planned.coupled_paths / GROUPS),
        end,
    );
    if groups[0].len() < FEWEST_GROUPS {
        return Ok(Vec::new());
    }
    let of_rung = |((scheme, _), groups): (&(Scheme, Plan), &Vec<Totals>)| {
        let mut totals = empty.clone();
        groups.iter().for_each(|group| totals.merge(group));
        setting(*scheme, &totals)
    };
    let mut settings: Vec<TradeSetting> = plans.iter().zip(&groups).map(of_rung).collect();
    let without = |groups: &Vec<Totals>| {
        jackknife::leaving_one_out(&empty, groups, |of| of.values(|_| true)).1
    };
    let without: Vec<Vec<GroupValues>> = groups.iter().map(without).collect();
    for r in (1..settings.len()).filter(|r| r % steps.len() != 0) {
        let (here, finer) = (&settings[r - 1].estimates, &settings[r].estimates);
        settings[r - 1].changes = changes(here, finer, &without[r - 1], &without[r]);
    }
    Ok(settings)
}

/// Simulate groups of `of_group` paths each with all plans. Item r, g of the result holds the paths
/// of group g on setting r. There are fewer groups if the measurement was cut short before all of them
/// had paths.
fn in_groups(
    plans: &[(Scheme, Plan)],
    empty: &Totals,
    of_group: u64,
    end: MeasureUntil<'_>,
) -> Vec<Vec<Totals>> {
    let mut groups = vec![vec![empty.clone(); GROUPS as usize]; plans.len()];
    let make = |piece: u64, stop: &AtomicBool| -> Option<Vec<Totals>> {
        let (group, slice) = (piece % GROUPS, piece / GROUPS * PIECE);
        let first = APART + group * of_group + slice;
        plans
            .iter()
            .map(|(_, plan)| {
                Some(
                    plan.piece_until(first, PIECE.min(of_group - slice), stop)?
                        .totals,
                )
            })
            .collect()
    };
    let mut turn = 0;
    let take = |settings: Vec<Totals>| {
        groups
            .iter_mut()
            .zip(&settings)
            .for_each(|(groups, totals)| groups[turn].merge(totals));
        turn = (turn + 1) % GROUPS as usize;
    };
    let taken = end.pieces(GROUPS * of_group.div_ceil(PIECE), make, take);
    // Pieces go to the groups in turn, so if few were taken, only the first groups have paths.
    groups
        .iter_mut()
        .for_each(|groups| groups.truncate(taken.min(GROUPS) as usize));
    groups
}

/// The differences of two settings on one realisation of the noise. Their standard errors follow from
/// leaving out each group on both settings.
fn changes(
    here: &[Number],
    finer: &[Number],
    coarse: &[GroupValues],
    fine: &[GroupValues],
) -> Vec<Number> {
    let change = |i: usize| {
        let without: Vec<f64> = coarse.iter().zip(fine).map(|(c, f)| c[i] - f[i]).collect();
        Number {
            value: here[i].value - finer[i].value,
            error: jackknife::standard_error(&without),
        }
    };
    (0..here.len()).map(change).collect()
}
