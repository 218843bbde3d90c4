//! One path of an ensemble, simulated again alone, with its events and a trajectory as fine as the
//! scheme allows.

use super::{Asked, Provenance};
use crate::ensemble::Plan;
use crate::scenario::{MAX_TRAJECTORIES, Scenario};
use crate::scheme::Segment;
use crate::stats::{BlockResult, Record};

/// One path of an ensemble, simulated again.
///
/// ```
/// use stickslip::engine::Replay;
/// use stickslip::scenario::Scenario;
///
/// let replay = Replay::of(&Scenario::shipped("rho025")?, 4711);
/// let rows = replay.block.rows;
/// let events = rows.events.expect("a replay records them");
/// println!("path 4711 has {} events, the first at {}", events.time.len(), events.time[0]);
/// # assert_eq!(rows.trajectories.expect("and the trajectory").displacement[0], 6.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Replay {
    /// The scenario, with the output grid of the trajectory, in which everything is recorded.
    pub scenario: Scenario,
    /// What is recorded of the path.
    pub record: Record,
    /// The times of the rows of the trajectory.
    pub rows: ReplayRows,
    /// A block that contains only this path.
    pub block: BlockResult,
}

/// The times of the rows of the trajectory of a replay.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ReplayRows {
    /// One row every `stride` steps.
    Steps {
        /// Number of steps from row to row.
        stride: u64,
        /// Number of steps of the path.
        of: u64,
    },
    /// The output grid of the run, made finer by this factor.
    Finer(usize),
}

impl Replay {
    /// Simulate path number `path` of the ensemble of this scenario. It has the same bits as in the
    /// ensemble.
    ///
    /// With a scheme that has a step, the trajectory contains every step, or one in several if
    /// there would be more than 10 000 rows. With a scheme that has none, it is ten times finer
    /// than the output grid of the run, or less if there would be more than 10 000 rows. At the
    /// times of that grid it has the states of the run.
    pub fn of(scenario: &Scenario, path: u64) -> Self {
        Replay::enlarged(scenario, path, 0.0)
    }

    /// The same path with as many rows from the time `from` on as [`Replay::of`] has in all, or up to
    /// 200 000 rows in all.
    pub fn enlarged(scenario: &Scenario, path: u64, from: f64) -> Self {
        let mut scenario = scenario.of_path(path);
        let shown = scenario.time.end - from;
        let enlargement = if scenario.time.end > 0.0 {
            (scenario.time.end / shown).clamp(1.0, MOST_ENLARGED)
        } else {
            1.0
        };
        let (output_step, rows) = finest_grid(&scenario, enlargement as usize);
        scenario.time.output_step = output_step;
        let record = Record {
            paths: true,
            events: true,
            trajectories: path + 1,
            ..Record::NOTHING
        };
        // The scenario in a file must be valid, and no valid scenario records more trajectories
        // than `MAX_TRAJECTORIES`.
        scenario.record = Record {
            trajectories: record.trajectories.min(MAX_TRAJECTORIES),
            ..record
        };
        let block = rows.plan(&scenario, record).replay(path);
        Replay {
            scenario,
            record,
            rows,
            block,
        }
    }

    /// Its provenance: a run of one path, whatever its number in the ensemble.
    pub fn provenance(&self) -> Provenance {
        Asked::paths(1).provenance(&self.scenario)
    }

    /// The motion of the path between its events, segment by segment; nothing if the path is lost.
    /// The path is simulated again for this.
    pub fn motion(&self) -> Vec<Segment> {
        self.rows
            .plan(&self.scenario, Record::NOTHING)
            .motion(self.block.rows.first_path)
            .unwrap_or_default()
    }

    /// Whether the path diverged or was given up.
    pub fn is_lost(&self) -> bool {
        !self.block.diverged.is_empty()
    }
}

impl ReplayRows {
    /// The plan that simulates the path of a replay with these rows.
    fn plan(self, scenario: &Scenario, record: Record) -> Plan {
        let plan = Plan {
            record,
            ..scenario.plan()
        };
        match self {
            ReplayRows::Steps { .. } => plan,
            ReplayRows::Finer(refinement) => plan.with_additional_rows(refinement),
        }
    }
}

/// The largest number of rows of a trajectory, unless the run itself has more.
const MOST_ROWS: usize = 10_000;

/// The trajectory of a scheme without a step is at most this many times finer than the output grid
/// of the run.
const REFINEMENT: usize = 10;

/// The largest factor by which the rows of a part of the path are more than those of the whole.
const MOST_ENLARGED: f64 = 20.0;

/// The output step of the finest trajectory of the same path that has at most [`MOST_ROWS`] rows
/// times an enlargement, and the times of its rows.
fn finest_grid(scenario: &Scenario, enlargement: usize) -> (f64, ReplayRows) {
    let most = (MOST_ROWS * enlargement) as u64 - 1;
    let output_step = scenario.time.output_step;
    if let (Some(step), Some(of)) = (scenario.scheme.step(), scenario.steps()) {
        let stride = stride(of, most);
        return (stride as f64 * step, ReplayRows::Steps { stride, of });
    }
    let rows = scenario.timeline().rows().saturating_sub(1);
    let refinement = (most as usize)
        .checked_div(rows)
        .unwrap_or(1)
        .clamp(1, REFINEMENT * enlargement);
    (
        output_step / refinement as f64,
        ReplayRows::Finer(refinement),
    )
}

/// The smallest number of steps between rows that gives at most `most` rows besides the first one.
/// If a number up to twice as large divides `steps`, it is used instead, so that the last row is at
/// the end of the path.
fn stride(steps: u64, most: u64) -> u64 {
    let least = steps.div_ceil(most).max(1);
    (least..=2 * least)
        .take(MOST_ROWS)
        .find(|stride| steps.is_multiple_of(*stride))
        .unwrap_or(least)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::{Override, shipped};

    fn scenario(name: &str, set: &[&str]) -> Scenario {
        let text = shipped(name).expect("shipped").text;
        let set: Vec<Override> = set
            .iter()
            .map(|set| Override::set(set).expect("well formed"))
            .collect();
        Scenario::parse(name, text, &set).expect("sound")
    }

    #[test]
    fn a_stride_keeps_the_rows_within_bounds() {
        assert_eq!(
            [0, 1, 9_999, 10_000, 60_000, 10_000_000].map(|steps| stride(steps, 9_999)),
            [1, 1, 1, 2, 8, 1_250]
        );
        for steps in [10_007, 99_991, 123_457, 1 << 53] {
            assert!(steps / stride(steps, 9_999) <= 9_999, "{steps}");
        }
    }

    #[test]
    fn the_grid_of_a_replay_is_never_too_long_and_still_a_scenario() {
        for (name, set, spacing) in [
            ("rho025", &[][..], 0.01),
            ("rho025", &["time.step=1e-6"], 0.00625),
            ("rho025", &["scheme.kind=event-driven"], 0.05),
            ("shaw", &["scheme.kind=event-driven"], 0.05),
            (
                "shaw",
                &["scheme.kind=quasi-static", "time.output_step=0.01"],
                0.01,
            ),
            ("viaduct", &[], 3600.0),
        ] {
            let mut scenario = scenario(name, set);
            let (output_step, _) = finest_grid(&scenario, 1);
            assert!(
                (output_step / spacing - 1.0).abs() < 1e-12,
                "{name} {set:?}: {output_step}"
            );
            scenario.time.output_step = output_step;
            assert!(scenario.timeline().rows() <= MOST_ROWS);
            assert_eq!(
                Scenario::parse(name, &scenario.to_toml(), &[]).expect("sound"),
                scenario
            );
        }
    }
}
