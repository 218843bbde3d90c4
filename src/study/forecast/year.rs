//! The numbers that are kept of a simulated year.

use super::draw::DrawnBearing;
use crate::model::{Event, EventKind};
use crate::scheme::{Instant, Observer, Snapshot};
use std::sync::atomic::{AtomicBool, Ordering};

/// A quantity that is kept of a simulated year.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// The sum of the distances of all slips.
    SlidingPath,
    /// The number of slips.
    Slips,
    /// The highest z minus the lowest.
    Range,
    /// The largest |z|.
    Greatest,
    /// The share of time with |F| above q f_s.
    Loaded,
    /// The largest |F|.
    Force,
}

impl Quantity {
    /// All of them.
    pub const ALL: [Quantity; 6] = [
        Quantity::SlidingPath,
        Quantity::Slips,
        Quantity::Range,
        Quantity::Greatest,
        Quantity::Loaded,
        Quantity::Force,
    ];

    /// The name in files and for programs.
    pub fn name(self) -> &'static str {
        match self {
            Quantity::SlidingPath => "sliding_path",
            Quantity::Slips => "slips",
            Quantity::Range => "displacement_range",
            Quantity::Greatest => "displacement_abs_max",
            Quantity::Loaded => "loaded_share",
            Quantity::Force => "force_abs_max",
        }
    }

    /// Its unit.
    pub fn unit(self) -> &'static str {
        match self {
            Quantity::SlidingPath | Quantity::Range | Quantity::Greatest => "m",
            Quantity::Slips | Quantity::Loaded => "1",
            Quantity::Force => "N",
        }
    }
}

/// One value for each of [`Quantity::ALL`].
pub type Year = [f64; Quantity::ALL.len()];

/// The path of one year.
#[derive(Clone, Copy, Debug)]
struct Path {
    /// The displacement x of the body after its last event.
    position: f64,
    sliding: f64,
    slips: u64,
    low: f64,
    high: f64,
    force: f64,
    observations: u64,
    loaded: u64,
}

/// Observes paths from the end of the burn-in on.
pub struct YearObserver<'a> {
    bearing: DrawnBearing,
    threshold: f64,
    paths: Vec<Path>,
    is_counting: bool,
    stop: &'a AtomicBool,
}

impl<'a> YearObserver<'a> {
    /// An observer of this number of paths of a bearing. The time with |F| above this `share` of
    /// f_s is counted.
    pub fn new(bearing: DrawnBearing, share: f64, paths: usize, stop: &'a AtomicBool) -> Self {
        let threshold = share * bearing.reach * bearing.stiffness * bearing.dilatation();
        let path = Path {
            position: 0.0,
            sliding: 0.0,
            slips: 0,
            low: f64::INFINITY,
            high: f64::NEG_INFINITY,
            force: 0.0,
            observations: 0,
            loaded: 0,
        };
        YearObserver { bearing, threshold, paths: vec![path; paths], is_counting: false, stop }
    }

    /// The years of all paths that were not lost; empty if the simulation was stopped.
    pub fn years(&self, lost: &[usize]) -> Vec<Year> {
        if self.is_stopped() {
            return Vec::new();
        }
        let kept = self.paths.iter().enumerate().filter(|(lane, _)| !lost.contains(lane));
        kept.map(|(_, path)| {
            let greatest = path.high.abs().max(path.low.abs());
            let loaded = path.loaded as f64 / path.observations as f64;
            [path.sliding, path.slips as f64, path.high - path.low, greatest, loaded, path.force]
        })
        .collect()
    }

    /// Observe a body at x under the force F: z = z0 + x + kappa F/K.
    fn observe(&mut self, lane: usize, x: f64, force: f64) {
        let sensor = self.bearing.sensor;
        let kappa = sensor.still / self.bearing.dilatation();
        let z = sensor.offset + x + kappa * force / self.bearing.stiffness;
        let path = &mut self.paths[lane];
        path.low = path.low.min(z);
        path.high = path.high.max(z);
        path.force = path.force.max(force.abs());
    }
}

impl Observer for YearObserver<'_> {
    fn event(&mut self, lane: usize, event: Event) {
        let before = std::mem::replace(&mut self.paths[lane].position, event.displacement);
        if !self.is_counting {
            return;
        }
        self.observe(lane, event.displacement, event.force);
        if event.kind == EventKind::StickEntered {
            let path = &mut self.paths[lane];
            path.slips += 1;
            path.sliding += (event.displacement - before).abs();
        }
    }

    fn snapshot(&mut self, instant: Instant, seen: Snapshot<'_>) {
        self.is_counting |= instant == Instant::Counting;
        if !self.is_counting || !matches!(instant, Instant::Output(_)) {
            return;
        }
        for lane in 0..self.paths.len() {
            // Paths in a slip are skipped: slips take no time compared with the hour between two
            // observations.
            if seen.is_static[lane] {
                let x = seen.displacement[lane];
                let force = self.bearing.stiffness * (self.bearing.dilatation() * seen.temperature[lane] - x);
                self.observe(lane, x, force);
                self.paths[lane].observations += 1;
                self.paths[lane].loaded += u64::from(force.abs() > self.threshold);
            }
        }
    }

    fn is_stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }
}
