//! The one path that there is without noise, stretch by stretch, reported for every lane.

use super::super::work::{Resolved, Simulated, WorkLeft};
use super::exact_time::ExactTime;
use crate::model::{Event, Phase};
use crate::scheme::columns::{LOST, Seen, StateColumns};
use crate::scheme::{Instant, Observer, Segment, Timeline};
use std::cell::RefCell;

/// A phase of the path, or a part of one.
pub struct Stretch<M, C> {
    pub start: ExactTime,
    pub phase: Phase,
    /// What is known of the motion at the start.
    pub from: M,
    /// The duration of the stretch and what ends it; none if it does not end before t_end.
    pub end: Option<(f64, End<C>)>,
}

/// What ends a stretch.
#[derive(Clone, Copy)]
pub enum End<C> {
    Event(Event),
    /// A cut in the phase, and what is known of the motion there.
    Cut(C),
}

impl<M, C: Copy> Stretch<M, C> {
    /// The end of the stretch, if it is at a time or before.
    fn end_by(&self, time: f64) -> Option<(f64, End<C>)> {
        self.end.filter(|(duration, end)| match end {
            End::Event(event) => event.time <= time,
            End::Cut(_) => *duration <= self.start.until(time),
        })
    }
}

/// A stretch of the path of a scheme.
pub type StretchOf<P> = Stretch<<P as Stretches>::Motion, <P as Stretches>::Cut>;

/// A scheme without noise, by the stretches of its path. Nothing is random, so one path is computed
/// for all lanes.
pub trait Stretches {
    /// What the scheme knows of the motion at the start of a stretch.
    type Motion;
    /// What it knows at a cut.
    type Cut: Copy;

    fn timeline(&self) -> &Timeline;

    /// The number of evaluations that the path may make.
    fn work_limit(&self) -> u64;

    /// The stretch that begins at t = 0.
    fn first(&self, work: &mut WorkLeft) -> Resolved<StretchOf<Self>>;

    /// The stretch that follows one that ends like this after a duration.
    fn next(
        &self,
        stretch: &StretchOf<Self>,
        end: (f64, End<Self::Cut>),
        work: &mut WorkLeft,
    ) -> Resolved<StretchOf<Self>>;

    /// x, x', T and whether the path is static, at a time within the stretch.
    fn state(&self, stretch: &StretchOf<Self>, t: f64, work: &mut WorkLeft) -> Resolved<Seen>;

    /// The first part of a stretch, of this duration, in pieces that a quintic describes.
    fn segments(
        &self,
        stretch: &StretchOf<Self>,
        duration: f64,
        tell: impl FnMut(Segment),
    ) -> Resolved<()>;

    /// Computes the path and reports it to the observer once for each of `lanes` lanes. If the path
    /// cannot be resolved, all lanes are lost.
    fn simulate(&self, lanes: usize, observer: &mut dyn Observer) -> Simulated {
        let (mut columns, observer) = (StateColumns::new(lanes), RefCell::new(observer));
        let is_stopped = || observer.borrow().is_stopped();
        let mut work = WorkLeft::watched(self.work_limit(), &is_stopped);
        let mut stretch = self.first(&mut work);
        let follows = observer.borrow().follows();
        let follow = |stretch: &Stretch<_, _>, duration: f64| {
            let tell =
                |segment| (0..lanes).for_each(|lane| observer.borrow_mut().segment(lane, &segment));
            if follows {
                self.segments(stretch, duration, tell)
            } else {
                Ok(())
            }
        };
        for stop in self.timeline().stops() {
            while let Ok(here) = &stretch
                && let Some(end) = here.end_by(stop.time)
            {
                stretch = follow(here, end.0).and_then(|()| {
                    if let End::Event(event) = end.1 {
                        (0..lanes).for_each(|lane| observer.borrow_mut().event(lane, event));
                    }
                    self.next(here, end, &mut work)
                });
            }
            let seen = stretch.as_ref().map_err(|lost| *lost).and_then(|here| {
                if stop.instant == Instant::End {
                    follow(here, here.start.until(stop.time))?;
                }
                self.state(here, stop.time, &mut work)
            });
            columns.fill(seen.unwrap_or(LOST));
            stretch = seen.and(stretch);
            if is_stopped() {
                break;
            }
            observer
                .borrow_mut()
                .snapshot(stop.instant, columns.snapshot(stop.time));
        }
        let why = stretch.err();
        Simulated {
            lost: (0..lanes).filter(|_| why.is_some()).collect(),
            why,
            evaluations: self.work_limit() - work.left(),
        }
    }
}
