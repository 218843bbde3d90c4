//! An observer that changes the temperature in every snapshot, where that of the simulated problem
//! contains an absorbed force, or lacks noise that does not change the motion.

use crate::model::{Absorbed, Event, Problem};
use crate::scheme::{Instant, Observer, Segment, Snapshot};

/// Passes everything on to another observer, with another temperature: `change` appends that of every
/// path, given the time and the simulated one.
pub struct WithTemperature<'a, F> {
    observer: &'a mut dyn Observer,
    change: F,
    temperature: Vec<f64>,
}

impl<'a, F: FnMut(f64, &[f64], &mut Vec<f64>)> WithTemperature<'a, F> {
    pub fn new(observer: &'a mut dyn Observer, change: F) -> Self {
        WithTemperature {
            observer,
            change,
            temperature: Vec::new(),
        }
    }
}

/// The temperature as it is given, without what an absorbed force adds to it.
pub fn given(model: &Problem, absorbed: &Absorbed) -> impl FnMut(f64, &[f64], &mut Vec<f64>) {
    move |t, simulated, temperature| match &absorbed.added {
        Some(added) => {
            let added = added.deterministic(t);
            temperature.extend(simulated.iter().map(|of| of - added));
        }
        None => temperature.resize(simulated.len(), model.temperature.mean(t)),
    }
}

impl<F: FnMut(f64, &[f64], &mut Vec<f64>)> Observer for WithTemperature<'_, F> {
    fn event(&mut self, lane: usize, event: Event) {
        self.observer.event(lane, event);
    }

    fn follows(&self) -> bool {
        self.observer.follows()
    }

    fn segment(&mut self, lane: usize, segment: &Segment) {
        self.observer.segment(lane, segment);
    }

    fn is_stopped(&self) -> bool {
        self.observer.is_stopped()
    }

    fn snapshot(&mut self, instant: Instant, snapshot: Snapshot<'_>) {
        self.temperature.clear();
        (self.change)(snapshot.time, snapshot.temperature, &mut self.temperature);
        let temperature = &self.temperature;
        let changed = Snapshot {
            temperature,
            ..snapshot
        };
        self.observer.snapshot(instant, changed);
    }
}
