//! The numbers that are kept of a simulated year.

use super::draw::DrawnBearing;
use crate::model::{Event, EventKind};
use crate::scheme::{Instant, Observer, Snapshot};
use std::sync::atomic::{AtomicBool, Ordering};

/// A quantity that is kept of a simulated year.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ForecastQuantity {
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

impl ForecastQuantity {
    /// All of them.
    pub const ALL: [ForecastQuantity; 6] = [
        ForecastQuantity::SlidingPath,
        ForecastQuantity::Slips,
        ForecastQuantity::Range,
        ForecastQuantity::Greatest,
        ForecastQuantity::Loaded,
        ForecastQuantity::Force,
    ];

    /// The name in files and for programs.
    pub fn name(self) -> &'static str {
        NAMES_AND_UNITS[self as usize].0
    }

    /// Whether it may be any number from 0 on; otherwise it is a share of the time.
    pub fn is_unbounded(self) -> bool {
        self != ForecastQuantity::Loaded
    }

    /// Its unit.
    pub fn unit(self) -> &'static str {
        NAMES_AND_UNITS[self as usize].1
    }
}

/// The name and the unit of each of [`ForecastQuantity::ALL`].
const NAMES_AND_UNITS: [(&str, &str); ForecastQuantity::ALL.len()] = [
    ("sliding_path", "m"),
    ("slips", "1"),
    ("displacement_range", "m"),
    ("displacement_abs_max", "m"),
    ("loaded_share", "1"),
    ("force_abs_max", "N"),
];

/// One value for each of [`ForecastQuantity::ALL`].
pub type Year = [f64; ForecastQuantity::ALL.len()];

/// What was seen of a year so far.
#[derive(Clone, Copy, Debug)]
struct Seen {
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
    paths: Vec<Seen>,
    is_counting: bool,
    stop: &'a AtomicBool,
}

impl<'a> YearObserver<'a> {
    /// An observer of this number of paths of a bearing. The time with |F| above this `share` of
    /// f_s is counted.
    pub fn new(bearing: DrawnBearing, share: f64, paths: usize, stop: &'a AtomicBool) -> Self {
        let threshold = share * bearing.reach * bearing.stiffness * bearing.dilatation();
        let path = Seen {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bearing::calibration::Sensor;
    use crate::model::Sign;

    /// A bearing with K = 4 and beta = 1.5 + 0.5, so that kappa = 1/4, f_s = A K beta = 16, and z =
    /// 0.1 + x + F/16. Its forces are F = 4 (2 T - x). It is seen at x = 0 under T = 0, 1.5, -1.5
    /// and 0.5, so under F = 0, 12, -12 and 4, of which two exceed 8, half of f_s, in size. Then it
    /// slips from x = 0 under F = 16, where z = 1.1, to x = -2 under F = -8, where z = -2.4, and is
    /// seen in a slip, where it does not count. What happens in the burn-in is farther away and
    /// does not count either.
    #[test]
    fn a_year_holds_what_was_seen_of_it() {
        let sensor = Sensor { offset: 0.1, moving: 1.5, still: 0.5 };
        let bearing = DrawnBearing { reach: 2.0, jump: 0.5, sensor, stiffness: 4.0 };
        let stop = AtomicBool::new(false);
        let mut observer = YearObserver::new(bearing, 0.5, 2, &stop);
        let event = |kind, displacement, force| Event { kind, time: 0.0, displacement, force };
        let look = |observer: &mut YearObserver<'_>, instant, x: f64, temperature: f64, is_static: bool| {
            let (displacement, velocity) = (&[x; 2], &[0.0; 2]);
            let (temperature, is_static) = (&[temperature; 2], &[is_static, false]);
            observer.snapshot(instant, Snapshot { time: 0.0, displacement, velocity, temperature, is_static });
        };
        observer.event(0, event(EventKind::SlipStarted(Sign::Positive), 30.0, 99.0));
        look(&mut observer, Instant::Output(0), 30.0, 30.0, true);
        observer.event(0, event(EventKind::StickEntered, 0.0, 99.0));
        look(&mut observer, Instant::Counting, 0.0, 0.0, true);
        for (row, temperature) in [0.0, 1.5, -1.5, 0.5].into_iter().enumerate() {
            look(&mut observer, Instant::Output(1 + row), 0.0, temperature, true);
        }
        observer.event(0, event(EventKind::SlipStarted(Sign::Negative), 0.0, 16.0));
        observer.event(0, event(EventKind::StickEntered, -2.0, -8.0));
        look(&mut observer, Instant::Output(5), -50.0, 0.0, false);
        let years = observer.years(&[1]);
        // The way, the slips, the range of z, the largest |z|, the share above 8, the largest |F|.
        let expected = [2.0, 1.0, 3.5, 2.4, 0.5, 16.0];
        assert_eq!(years.len(), 1);
        for (quantity, (found, expected)) in ForecastQuantity::ALL.iter().zip(years[0].iter().zip(expected)) {
            assert!((found - expected).abs() < 1e-12, "{quantity:?}: {found}, expected {expected}");
        }
        stop.store(true, Ordering::Relaxed);
        assert!(observer.years(&[]).is_empty());
    }
}
