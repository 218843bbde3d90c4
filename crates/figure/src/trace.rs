//! One path for a drawing: divided at its events, and as fine as a drawing needs.

use super::Absent;
use super::subject::DrawnPath;
use std::ops::Range;
use stickslip::engine::Replay;
use stickslip::model::{Model, Sign};
use stickslip::scheme::{Along, Segment};

/// The state of a path at one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StateAt {
    pub time: f64,
    pub displacement: f64,
    pub velocity: f64,
    /// The force of the spring, K (beta T - x), or b where there is a user-defined force.
    pub spring: f64,
}

/// A stick, or a sub-phase of a slip, from its first instant to its last.
#[derive(Clone, Debug, PartialEq)]
pub struct DrawnPhase {
    /// The number k of the sub-phase, from 1 on, and its direction; none in a stick.
    pub slip: Option<(usize, f64)>,
    pub samples: Vec<StateAt>,
}

impl DrawnPhase {
    pub fn begin(&self) -> f64 {
        self.samples.first().map_or(f64::NAN, |sample| sample.time)
    }

    pub fn end(&self) -> f64 {
        self.samples.last().map_or(f64::NAN, |sample| sample.time)
    }
}

/// A sub-phase of fewer samples than this is drawn by the motion that the scheme knows.
const FEW_ROWS: usize = 16;

impl DrawnPhase {
    /// Puts what the scheme knows of the motion between the first instant and the last one.
    fn follow(&mut self, motion: &[Segment], model: &Model) {
        let ([Some(first), Some(last)], Some((_, sign))) =
            ([self.samples.first(), self.samples.last()], self.slip)
        else {
            return;
        };
        let begin = motion.partition_point(|segment| segment.end() <= first.time);
        let end = motion
            .partition_point(|segment| segment.start < last.time)
            .max(begin);
        let places = FEW_ROWS.div_ceil((end - begin).max(1));
        let is_inside = |at: &StateAt| first.time < at.time && at.time < last.time;
        let place = |k: usize| (k as f64 + 0.5) / places as f64;
        let states = motion[begin..end]
            .iter()
            .flat_map(|segment| (0..places).map(move |k| state(segment, place(k), sign, model)));
        let between: Vec<StateAt> = states.filter(is_inside).collect();
        self.samples = [vec![*first], between, vec![*last]].concat();
    }
}

/// The state at a place in a segment of a sub-phase in this direction.
fn state(segment: &Segment, part: f64, sign: f64, model: &Model) -> StateAt {
    let [way, velocity, acceleration] = segment.at(part);
    // The polynomial may turn by its rounding before the sub-phase does.
    let velocity = sign * (sign * velocity).max(0.0);
    let spring = match segment.along {
        Along::Step { temperature } => shown(
            model,
            segment.start,
            temperature,
            [segment.displacement, velocity],
        ),
        Along::Smooth { .. } => {
            let (time, x) = (
                segment.start + part * segment.length,
                segment.displacement + way,
            );
            let friction = model.sliding_friction(Sign::of(sign), time, x, velocity);
            let force = model.oscillator.mass * acceleration + friction;
            if model.force.is_some() {
                force
            } else {
                force + 2.0 * model.oscillator.damping * velocity
            }
        }
    };
    StateAt {
        time: segment.start + part * segment.length,
        displacement: segment.displacement + way,
        velocity,
        spring,
    }
}

/// The force of the spring or, where there is a user-defined force, the whole of b.
fn shown(model: &Model, time: f64, temperature: f64, [x, velocity]: [f64; 2]) -> f64 {
    model.total_force(
        time,
        temperature,
        x,
        if model.force.is_some() { velocity } else { 0.0 },
    )
}

/// An event of the cascade: tau_j, tau_{j+1/2} or tau_j^k.
#[derive(Clone, Debug, PartialEq)]
pub struct LabelledEvent {
    pub at: StateAt,
    pub name: String,
    /// Whether the event lies between two sub-phases.
    pub is_turn: bool,
}

/// A path, cut into pieces at its events.
#[derive(Clone, Debug, PartialEq)]
pub struct PathTrace {
    pub pieces: Vec<DrawnPhase>,
    pub moments: Vec<LabelledEvent>,
}

/// How many sticks a path had so far, and how many sub-phases its slip.
#[derive(Default)]
struct EventNumbers {
    sticks: usize,
    sub_phases: usize,
}

impl EventNumbers {
    /// Counts an event of this kind, and gives it its name.
    fn name(&mut self, kind: i8) -> String {
        match kind {
            0 => self.sticks += 1,
            1 => self.sub_phases = 1,
            _ => self.sub_phases += 1,
        }
        match (kind, self.sticks) {
            (0, j) => format!("*τ*_{{{j}}}"),
            (1, 0) => "*τ*_{½}".to_string(),
            (1, j) => format!("*τ*_{{{j}+½}}"),
            (_, j) => format!("*τ*_{{{j}}}^{{{}}}", self.sub_phases - 1),
        }
    }
}

impl PathTrace {
    /// The path, simulated again.
    ///
    /// # Errors
    ///
    /// The path was lost.
    pub fn of(path: &DrawnPath) -> Result<PathTrace, Absent> {
        let replay = Replay::of(path.scenario, path.number);
        let trace = PathTrace::cut(&replay)
            .filter(|_| !replay.is_lost())
            .ok_or(Absent::Lost(path.number))?;
        Ok(trace.refined(&replay).beginning_at(path.from))
    }

    /// The rows of its trajectory, with its events inserted between them. None if events or
    /// trajectory were not kept.
    fn cut(replay: &Replay) -> Option<PathTrace> {
        let (events, rows) = (
            replay.block.rows.events.as_ref()?,
            replay.block.rows.trajectories.as_ref()?,
        );
        let model = &replay.scenario.model;
        let time = replay.scenario.timeline().output_times();
        let row = |i: usize| {
            let state = [rows.displacement[i], rows.velocity[i]];
            StateAt {
                time: time[i],
                displacement: state[0],
                velocity: state[1],
                spring: shown(model, time[i], rows.temperature[i], state),
            }
        };
        let mut next_row = 0;
        let end = time.len().min(rows.displacement.len());
        let mut piece = DrawnPhase {
            slip: None,
            samples: Vec::new(),
        };
        let mut trace = PathTrace {
            pieces: Vec::new(),
            moments: Vec::new(),
        };
        let mut count = EventNumbers::default();
        for i in 0..events.time.len() {
            let at = match rows.velocity.first() {
                // A body with initial velocity begins its first slip with it.
                Some(v0) if events.time[i] == 0.0 && *v0 != 0.0 => row(0),
                // The velocity is zero at an event, so the force b is that of the spring alone.
                _ => StateAt {
                    time: events.time[i],
                    displacement: events.displacement[i],
                    velocity: 0.0,
                    spring: events.force[i],
                },
            };
            while next_row < end && row(next_row).time < at.time {
                piece.samples.push(row(next_row));
                next_row += 1;
            }
            piece.samples.push(at);
            trace.moments.push(LabelledEvent {
                at,
                name: count.name(events.kind[i]),
                is_turn: events.kind[i] == 2,
            });
            let next = DrawnPhase {
                slip: (events.kind[i] > 0).then(|| (count.sub_phases, f64::from(events.sign[i]))),
                samples: vec![at],
            };
            trace.pieces.push(std::mem::replace(&mut piece, next));
        }
        piece.samples.extend((next_row..end).map(row));
        trace.pieces.push(piece);
        trace.name_first_state();
        Some(trace)
    }

    /// Names the state at t = 0, where no event has that name.
    fn name_first_state(&mut self) {
        if let Some(first) = self
            .pieces
            .iter()
            .find_map(|piece| piece.samples.first())
            .filter(|first| first.time == 0.0)
            && self
                .moments
                .first()
                .is_none_or(|moment| moment.at.time > 0.0)
        {
            let begin = LabelledEvent {
                at: *first,
                name: "*τ*_{0}".to_string(),
                is_turn: false,
            };
            self.moments.insert(0, begin);
        }
    }

    /// The same path with the motion that the scheme knows in sub-phases of few rows.
    fn refined(mut self, replay: &Replay) -> PathTrace {
        let is_coarse =
            |piece: &&mut DrawnPhase| piece.slip.is_some() && piece.samples.len() < FEW_ROWS;
        let coarse: Vec<&mut DrawnPhase> = self.pieces.iter_mut().filter(is_coarse).collect();
        let motion = if coarse.is_empty() {
            Vec::new()
        } else {
            replay.motion()
        };
        coarse
            .into_iter()
            .for_each(|piece| piece.follow(&motion, &replay.scenario.model));
        self
    }

    /// The part of the path from this time on.
    fn beginning_at(mut self, from: f64) -> PathTrace {
        self.moments.retain(|moment| moment.at.time >= from);
        for piece in &mut self.pieces {
            piece.samples.retain(|sample| sample.time >= from);
        }
        self.pieces.retain(|piece| !piece.samples.is_empty());
        self
    }

    /// The curve of x over time.
    pub fn curve(&self) -> Vec<[f64; 2]> {
        self.samples().map(|s| [s.time, s.displacement]).collect()
    }

    /// The times at which each stick begins and ends.
    pub fn sticks(&self) -> impl Iterator<Item = [f64; 2]> {
        self.pieces
            .iter()
            .filter(|piece| piece.slip.is_none())
            .map(|piece| [piece.begin(), piece.end()])
    }

    /// The time from an event to the nearest other event.
    pub fn distance(&self, moment: &LabelledEvent) -> f64 {
        let others = self.moments.iter().filter(|other| *other != moment);
        others
            .map(|other| (other.at.time - moment.at.time).abs())
            .fold(f64::INFINITY, f64::min)
    }

    pub fn samples(&self) -> impl Iterator<Item = &StateAt> {
        self.pieces.iter().flat_map(|piece| &piece.samples)
    }

    /// The most sub-phases of a slip; zero if there is no slip.
    pub fn most_sub_phases(&self) -> usize {
        self.pieces
            .iter()
            .filter_map(|piece| piece.slip)
            .map(|(k, _)| k)
            .max()
            .unwrap_or(0)
    }

    /// The longest complete slip, with the sticks before and after it.
    pub fn longest_slip(&self) -> Option<Range<usize>> {
        let sticks: Vec<usize> = (0..self.pieces.len())
            .filter(|i| self.pieces[*i].slip.is_none())
            .collect();
        let slips = sticks.windows(2).map(|pair| pair[0]..pair[1] + 1);
        let length =
            |slip: &Range<usize>| self.pieces[slip.end - 1].begin() - self.pieces[slip.start].end();
        slips.max_by(|one, other| length(one).total_cmp(&length(other)))
    }
}
