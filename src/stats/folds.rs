//! The folds of paths that are simulated together: of the cascade of each path, and of its laws and
//! its motion if requested. A run, its bias and a sweep use only these.

use super::Record;
use super::cascade::CascadeSums;
use super::catalogue::Extra;
use super::energy::EnergySums;
use super::extremes::ExtremeSums;
use super::law::PhaseLaw;
use super::laws::{LawFold, LawsSums};
use super::motion::MotionFold;
use super::path::{Censored, EndedPhase, PathFold};
use super::periods::PeriodSums;
use super::totals::PhaseSums;
use crate::model::{Event, Problem};
use crate::scheme::{Instant, Segment, Snapshot, Timeline};
use crate::sums::Replicate;
use std::borrow::Cow;

/// The folds of some paths, one of each kind a path.
pub(super) struct PathFolds {
    pub paths: Vec<PathFold>,
    pub laws: Option<Vec<LawFold>>,
    pub motion: Option<Vec<MotionFold>>,
    model: Problem,
    /// The model of each path, if it has random inputs.
    realised: Vec<Problem>,
    timeline: Timeline,
    pub record: Record,
}

impl PathFolds {
    /// This many paths at rest at x0.
    pub fn new(model: &Problem, timeline: &Timeline, record: &Record, count: usize) -> Self {
        let path = PathFold::starting_at(model.initial_displacement).counted_after(timeline.after);
        let path = path.moving(model.initial_velocity != 0.0);
        PathFolds {
            paths: vec![path; count],
            laws: record
                .laws
                .then(|| vec![LawFold::counted_after(timeline.after); count]),
            motion: (record.has_motion() || model.has_load())
                .then(|| vec![MotionFold::starting_at(model, timeline); count]),
            model: model.clone(),
            realised: Vec::new(),
            timeline: *timeline,
            record: *record,
        }
    }

    /// The model of a path.
    pub fn model(&self, lane: usize) -> &Problem {
        self.realised.get(lane).unwrap_or(&self.model)
    }

    /// Add the model of the next path.
    pub fn realised(&mut self, lane: usize, model: &Problem) {
        self.realised.truncate(lane);
        self.realised.push(model.clone());
    }

    /// Add an event. Returns the counted phase that it completes; `law` receives the completed
    /// values of the laws.
    #[inline]
    pub fn event(
        &mut self,
        lane: usize,
        event: &Event,
        law: impl FnMut(PhaseLaw, f64),
    ) -> Option<EndedPhase> {
        if let Some(laws) = &mut self.laws {
            laws[lane].event(event, law);
        }
        if let Some(motion) = &mut self.motion {
            motion[lane].event(event.displacement);
        }
        self.paths[lane].event(event)
    }

    /// Add a segment of the motion.
    pub fn segment(&mut self, lane: usize, segment: &Segment) {
        if let Some(motion) = &mut self.motion {
            let model = self.realised.get(lane).unwrap_or(&self.model);
            match self.record.has_motion() {
                true => motion[lane].segment(model, &self.timeline, segment),
                false => motion[lane].friction(model, &self.timeline, segment),
            }
        }
    }

    /// Add the states at an instant. `end` receives the phase of each path that runs at the end.
    pub fn at(
        &mut self,
        instant: Instant,
        seen: &Snapshot<'_>,
        mut end: impl FnMut(usize, Option<Censored>),
    ) {
        for (lane, (path, &x)) in self.paths.iter_mut().zip(seen.displacement).enumerate() {
            match instant {
                Instant::Counting => path.count_from_here(x),
                Instant::End => end(lane, path.end(seen.time, x)),
                Instant::Output(_) | Instant::Period(_) => return,
            }
            path.friction_work = self.model.friction.dynamic_force * path.travel;
            if let Some(motion) = &mut self.motion {
                let model = self.realised.get(lane).unwrap_or(&self.model);
                motion[lane].at(model, instant, [x, seen.velocity[lane]], path);
            }
        }
    }

    /// The sums over the paths in these lanes, or over all.
    pub fn sums(&self, lanes: Option<&[usize]>, periods: PeriodSums, unit: Replicate) -> PhaseSums {
        fn of<'a, T: Copy>(all: &'a [T], lanes: Option<&[usize]>) -> Cow<'a, [T]> {
            lanes.map_or(Cow::Borrowed(all), |lanes| {
                lanes.iter().map(|&lane| all[lane]).collect()
            })
        }
        let motion = self
            .motion
            .as_deref()
            .map(|motion| of(motion, lanes))
            .unwrap_or_default();
        PhaseSums {
            cascade: CascadeSums::of(&of(&self.paths, lanes), unit),
            periods,
            laws: self
                .laws
                .as_deref()
                .map(|laws| Box::new(LawsSums::of(&of(laws, lanes), unit))),
            energy: self
                .record
                .energy
                .then(|| Box::new(EnergySums::of(&motion, unit))),
            extremes: self
                .record
                .asks_for(Extra::Levels)
                .then(|| Box::new(ExtremeSums::of(&motion, unit))),
        }
    }
}
