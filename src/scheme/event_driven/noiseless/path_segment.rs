//! The single path without noise, segment by segment, reported for every lane.

use super::super::work::{Resolved, Simulated, WorkLeft};
use super::exact_time::ExactTime;
use crate::model::{Event, Phase};
use crate::scheme::columns::{LOST, Seen, StateColumns};
use crate::scheme::{Instant, Observer, Segment, Timeline};
use std::cell::RefCell;

/// A phase of the path, or a part of one.
pub struct PathSegment<M, C> {
    pub start: ExactTime,
    pub phase: Phase,
    /// The known motion at the start.
    pub from: M,
    /// The duration of the segment and what ends it; none if it does not end before t_end.
    pub end: Option<(f64, End<C>)>,
}

/// What ends a segment.
#[derive(Clone, Copy)]
pub enum End<C> {
    Event(Event),
    /// A cut in the phase, with the known motion there.
    Cut(C),
}

/// A segment of the path of a scheme.
pub type PathSegmentOf<P> = PathSegment<<P as PathSegments>::Motion, <P as PathSegments>::Cut>;

/// A scheme without noise, by the segments of its path. Nothing is random, so one path is computed
/// for all lanes.
pub trait PathSegments {
    /// The known motion at the start of a segment.
    type Motion;
    /// The known motion at a cut.
    type Cut: Copy;

    /// Computes the path and reports it to the observer once for each of `lanes` lanes. If the path
    /// cannot be resolved, all lanes are lost.
    fn simulate(&self, lanes: usize, observer: &mut dyn Observer) -> Simulated {
        let (mut columns, observer) = (StateColumns::new(lanes), RefCell::new(observer));
        let is_stopped = || observer.borrow().is_stopped();
        let mut work = WorkLeft::watched(self.work_limit(), &is_stopped);
        let mut path_segment = self.first(&mut work);
        let follows = observer.borrow().follows();
        let follow = |path_segment: &PathSegment<_, _>, duration: f64| {
            let report =
                |segment| (0..lanes).for_each(|lane| observer.borrow_mut().segment(lane, &segment));
            if follows {
                self.segments(path_segment, duration, report)
            } else {
                Ok(())
            }
        };
        for stop in self.timeline().stops() {
            while let Ok(here) = &path_segment
                && let Some(end) = here.end_by(stop.time)
            {
                path_segment = follow(here, end.0).and_then(|()| {
                    if let End::Event(event) = end.1 {
                        (0..lanes).for_each(|lane| observer.borrow_mut().event(lane, event));
                    }
                    self.next(here, end, &mut work)
                });
            }
            let seen = path_segment
                .as_ref()
                .map_err(|lost| *lost)
                .and_then(|here| {
                    if stop.instant == Instant::End {
                        follow(here, here.start.until(stop.time))?;
                    }
                    self.state(here, stop.time, &mut work)
                });
            columns.fill(seen.unwrap_or(LOST));
            path_segment = seen.and(path_segment);
            if is_stopped() {
                break;
            }
            observer
                .borrow_mut()
                .snapshot(stop.instant, columns.snapshot(stop.time));
        }
        let why = path_segment.err();
        Simulated {
            lost: (0..lanes).filter(|_| why.is_some()).collect(),
            why,
            evaluations: self.work_limit() - work.left(),
        }
    }

    fn timeline(&self) -> &Timeline;

    /// The number of evaluations that the path may make.
    fn work_limit(&self) -> u64;

    /// The segment that begins at t = 0.
    fn first(&self, work: &mut WorkLeft) -> Resolved<PathSegmentOf<Self>>;

    /// The segment that follows one that ends like this after a duration.
    fn next(
        &self,
        path_segment: &PathSegmentOf<Self>,
        end: (f64, End<Self::Cut>),
        work: &mut WorkLeft,
    ) -> Resolved<PathSegmentOf<Self>>;

    /// x, x', T and whether the path is static, at a time within the segment.
    fn state(
        &self,
        path_segment: &PathSegmentOf<Self>,
        t: f64,
        work: &mut WorkLeft,
    ) -> Resolved<Seen>;

    /// The first part of a segment, of this duration, in pieces that a quintic describes.
    fn segments(
        &self,
        path_segment: &PathSegmentOf<Self>,
        duration: f64,
        report: impl FnMut(Segment),
    ) -> Resolved<()>;
}

impl<M, C: Copy> PathSegment<M, C> {
    /// The end of the segment, if it is at a time or before.
    fn end_by(&self, time: f64) -> Option<(f64, End<C>)> {
        self.end.filter(|(duration, end)| match end {
            End::Event(event) => event.time <= time,
            End::Cut(_) => *duration <= self.start.until(time),
        })
    }
}
