//! One path for a drawing: divided at its events, and as fine as a drawing needs.

use super::Absent;
use super::subject::DrawnPath;
use std::ops::Range;
use stickslip::engine::Replay;
use stickslip::model::{Problem, Series, Sign};
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

    /// Whether it is a sub-phase of few samples.
    fn is_coarse(&self) -> bool {
        self.slip.is_some() && self.samples.len() < FEW_ROWS
    }

    /// The times at which a parabola through three samples of a force or a velocity turns.
    fn turns(&self) -> Vec<f64> {
        let turn = |[a, b, c]: [[f64; 2]; 3]| {
            let slope = |a: [f64; 2], b: [f64; 2]| (b[1] - a[1]) / (b[0] - a[0]);
            let (before, after) = (slope(a, b), slope(b, c));
            let at = 0.5 * (a[0] + b[0]) - 0.5 * before * (c[0] - a[0]) / (after - before);
            (before * after < 0.0 && a[0] < at && at < c[0]).then_some(at)
        };
        let points = |of: fn(&StateAt) -> f64| {
            let all = self.samples.windows(3);
            all.filter_map(move |some| turn([0, 1, 2].map(|i| [some[i].time, of(&some[i])])))
        };
        points(|s| s.spring).chain(points(|s| s.velocity)).collect()
    }

    /// Adds the states at these times, where they are known.
    fn insert(&mut self, times: &[f64], between: &Between) {
        let (begin, end) = (self.begin(), self.end());
        let is_inside = |time: &&f64| begin < **time && **time < end;
        let inside = times.iter().filter(is_inside);
        let states: Vec<StateAt> = inside
            .filter_map(|time| between.state(self, *time))
            .collect();
        self.samples.extend(states);
        self.samples.sort_by(|a, b| a.time.total_cmp(&b.time));
    }
}

/// A sub-phase of fewer samples than this is drawn by the motion that the scheme knows.
const FEW_ROWS: usize = 16;

/// More samples of an input are grouped, and of each group the smallest and the largest are drawn.
const MOST_SAMPLES: usize = 20_000;

/// Measured values between two times, as points of a curve.
pub fn sampled(series: &Series, [from, end]: [f64; 2]) -> Vec<[f64; 2]> {
    let (times, values) = (series.times(), series.values());
    let inside = times.partition_point(|t| *t <= from)..times.partition_point(|t| *t < end);
    let each = inside.len().div_ceil(MOST_SAMPLES / 2).max(2);
    let mut points = vec![[from, series.at(from)]];
    for first in inside.clone().step_by(each) {
        let group = first..inside.end.min(first + each);
        let by_value = |i: &usize, j: &usize| values[*i].total_cmp(&values[*j]);
        let extremes = [group.clone().min_by(by_value), group.max_by(by_value)];
        let mut extremes: Vec<usize> = extremes.into_iter().flatten().collect();
        extremes.sort_unstable();
        points.extend(extremes.into_iter().map(|i| [times[i], values[i]]));
    }
    points.push([end, series.at(end)]);
    points
}

/// What is known of a path between its rows.
struct Between<'a> {
    model: &'a Problem,
    /// The motion in its slips.
    motion: Vec<Segment>,
    /// The times of the rows, and the temperature there.
    rows: [&'a [f64]; 2],
}

impl Between<'_> {
    /// The state in a phase at a time; none if the motion is not known.
    fn state(&self, phase: &DrawnPhase, time: f64) -> Option<StateAt> {
        let Some((_, sign)) = phase.slip else {
            let displacement = phase.samples[0].displacement;
            let temperature = self.temperature(time);
            return Some(StateAt {
                time,
                displacement,
                velocity: 0.0,
                spring: shown(self.model, time, temperature, [displacement, 0.0]),
            });
        };
        let next = self.motion.partition_point(|segment| segment.start <= time);
        let segment = self.motion.get(next.checked_sub(1)?)?;
        let part = ((time - segment.start) / segment.length).min(1.0);
        let at = state(segment, part, sign, self.model);
        let known = !self.model.is_random();
        let at_time = || {
            let moving = [at.displacement, at.velocity];
            shown(self.model, time, self.temperature(time), moving)
        };
        let spring = if known { at_time() } else { at.spring };
        Some(StateAt { time, spring, ..at })
    }

    /// The temperature, with a noise that is linear between rows.
    fn temperature(&self, time: f64) -> f64 {
        let (of, [times, temperatures]) = (&self.model.temperature, self.rows);
        let noise = |i: usize| temperatures[i] - of.mean(times[i]);
        let next = times.partition_point(|t| *t < time);
        if !of.is_random() || next == 0 || next >= times.len() {
            return of.mean(time);
        }
        let part = (time - times[next - 1]) / (times[next] - times[next - 1]);
        of.mean(time) + (1.0 - part) * noise(next - 1) + part * noise(next)
    }
}

impl DrawnPhase {
    /// Puts what the scheme knows of the motion between the first instant and the last one.
    fn follow(&mut self, motion: &[Segment], model: &Problem) {
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
fn state(segment: &Segment, part: f64, sign: f64, model: &Problem) -> StateAt {
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
            let damping = match model.force {
                Some(_) => 0.0,
                None => 2.0 * model.oscillator.damping * velocity,
            };
            let parts = [model.oscillator.mass * acceleration, friction, damping];
            let force: f64 = parts.iter().sum();
            // What is left of forces that cancel is their rounding.
            let rounding = 1e-13 * parts.iter().map(|part| part.abs()).sum::<f64>();
            if force.abs() <= rounding { 0.0 } else { force }
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
fn shown(model: &Problem, time: f64, temperature: f64, [x, velocity]: [f64; 2]) -> f64 {
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
        let replay = Replay::enlarged(path.scenario, path.number, path.from);
        let trace = PathTrace::cut(&replay)
            .filter(|_| !replay.is_lost())
            .ok_or(Absent::Lost(path.number))?;
        Ok(trace.beginning_at(path.from).refined(&replay, path.from))
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

    /// The same path with the motion that the scheme knows in sub-phases of few rows, and with all
    /// samples of inputs. Without noise, it contains the extremes between its rows, too.
    fn refined(mut self, replay: &Replay, from: f64) -> PathTrace {
        let scenario = &replay.scenario;
        let is_random = scenario.model.is_random();
        let has_step = scenario.scheme.step().is_some();
        let follows = |phase: &DrawnPhase| phase.is_coarse() || phase.slip.is_some() && !has_step;
        let times = scenario.timeline().output_times();
        let rows = replay.block.rows.trajectories.as_ref();
        let between = Between {
            model: &scenario.model,
            motion: match self.pieces.iter().any(follows) {
                true => replay.motion(),
                false => Vec::new(),
            },
            rows: [&times, rows.map_or(&[], |rows| &rows.temperature[..])],
        };
        let window = [from, scenario.time.end];
        let temperature = scenario.model.temperature.series.as_deref();
        let inputs = scenario.inputs_of_path().map(|(_, series)| series);
        let samples = temperature
            .into_iter()
            .chain(inputs)
            .flat_map(|series| sampled(series, window));
        let samples: Vec<f64> = samples.map(|[time, _]| time).collect();
        if let Some(first) = self.pieces.first_mut().filter(|first| first.begin() > from) {
            let begin = between.state(first, from);
            first.samples.splice(0..0, begin);
        }
        for piece in &mut self.pieces {
            if piece.is_coarse() {
                piece.follow(&between.motion, &scenario.model);
            }
            piece.insert(&samples, &between);
            if !is_random {
                piece.insert(&piece.turns(), &between);
            }
        }
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

#[cfg(test)]
mod tests {
    use super::*;
    use stickslip::scenario::Scenario;

    fn traced(scenario: &Scenario, from: f64) -> PathTrace {
        let path = DrawnPath {
            scenario,
            number: 0,
            from,
        };
        PathTrace::of(&path).expect("not lost")
    }

    fn largest(trace: &PathTrace) -> f64 {
        trace.samples().map(|s| s.spring.abs()).fold(0.0, f64::max)
    }

    /// A block under a record of spikes of 3, 4, 5, ... between samples of zero, which lie between the
    /// rows of the drawing: at any window, the force is the largest of its spikes, and every sample of
    /// the record is drawn.
    #[test]
    fn every_sample_of_a_record_in_the_window_is_drawn() {
        let folder = std::env::temp_dir().join(format!("spikes-{}", std::process::id()));
        std::fs::create_dir_all(&folder).expect("a folder");
        let spike = |i: u32| {
            if i % 10 == 7 {
                f64::from(3 + i / 10)
            } else {
                0.0
            }
        };
        let rows = (0..=2000).map(|i| format!("{},{}\n", 0.01 * f64::from(i), spike(i)));
        let text = format!("time_s,ag\n{}", rows.collect::<String>());
        std::fs::write(folder.join("spikes.csv"), text).expect("written");
        let scenario = |end: f64| {
            let text = format!(
                "oscillator = {{ mass = 1, stiffness = 0, dilatation = 0 }}\n\
                 friction = {{ static = 150, dynamic = 100 }}\nforce.expression = \"-ag\"\n\
                 input.ag = {{ file = \"spikes.csv\", unit = \"none\" }}\n\
                 initial.displacement = 0\ntime.end = {end}\ntime.output_step = 1.0\n\
                 scheme.kind = \"event-driven\"\nensemble.paths = 1\n"
            );
            let file = folder.join("block.toml");
            std::fs::write(&file, text).expect("written");
            Scenario::read(&file, &[]).expect("sound")
        };
        for [from, end] in [[0.0, 20.0], [6.0, 6.4], [19.85, 19.95]] {
            let trace = traced(&scenario(end), from);
            let inside = |i: &u32| (from..=end).contains(&(0.01 * f64::from(*i)));
            let most = (0..=2000).filter(inside).map(spike).fold(0.0, f64::max);
            let drawn = trace
                .samples()
                .filter(|s| (s.spring.abs() - most).abs() < 1e-9);
            assert!(
                drawn.count() > 0 && largest(&trace) < most + 1e-9,
                "{from} to {end}"
            );
            let times: Vec<f64> = trace.samples().map(|s| s.time).collect();
            let is_near = |t: f64| times.iter().any(|other| (other - t).abs() < 1e-9);
            let samples = (0..=2000).filter(inside).map(|i| 0.01 * f64::from(i));
            assert!(samples.into_iter().all(is_near), "{from} to {end}");
            assert!((times[0] - from).abs() < 1e-9, "{from}: {}", times[0]);
        }
        std::fs::remove_dir_all(&folder).expect("removed");
    }

    /// The force on a stuck body under 8 cos(w t + 0.3) reaches 8 between rows that are a tenth of a
    /// period apart.
    #[test]
    fn an_extremum_between_rows_is_drawn() {
        let text = "oscillator = { mass = 1, stiffness = 1, dilatation = 1 }\n\
            friction = { static = 20, dynamic = 10 }\ninitial.displacement = 0\n\
            temperature.harmonics = [{ amplitude = 8.0, angular_frequency = 0.25, phase = 0.3 }]\n\
            time = { end = 60, output_step = 25 }\nscheme.kind = \"event-driven\"\n\
            ensemble.paths = 1\n";
        let scenario = Scenario::parse("stuck", text, &[]).expect("sound");
        assert!((largest(&traced(&scenario, 10.0)) / 8.0 - 1.0).abs() < 1e-3);
    }

    /// Of more samples than can be drawn, the extremes are.
    #[test]
    fn long_records_keep_their_extremes() {
        let n = 10 * MOST_SAMPLES;
        let values = (0..n).map(|i| if i == 77_777 { 9.0 } else { (i % 7) as f64 });
        let series = Series::new((0..n).map(|i| i as f64).collect(), values.collect());
        let points = sampled(&series.expect("a series"), [10.0, (n - 10) as f64]);
        assert!(points.len() <= MOST_SAMPLES + 4, "{}", points.len());
        assert!(points.contains(&[77_777.0, 9.0]));
        assert!(points.windows(2).all(|pair| pair[0][0] <= pair[1][0]));
    }
}
