//! The temperature as it is given, where that of the simulated problem contains an absorbed force.

use crate::model::{Absorbed, Event, Problem};
use crate::scheme::{Instant, Observer, Segment, Snapshot};

/// An observer that passes everything on to another one, with the given temperature.
pub struct WithGivenTemperature<'a> {
    given: &'a Problem,
    absorbed: &'a Absorbed,
    observer: &'a mut dyn Observer,
    temperature: Vec<f64>,
}

impl<'a> WithGivenTemperature<'a> {
    pub fn new(given: &'a Problem, absorbed: &'a Absorbed, observer: &'a mut dyn Observer) -> Self {
        WithGivenTemperature {
            given,
            absorbed,
            observer,
            temperature: Vec::new(),
        }
    }
}

impl Observer for WithGivenTemperature<'_> {
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
        let (t, simulated) = (snapshot.time, snapshot.temperature);
        self.temperature.clear();
        match &self.absorbed.added {
            Some(added) => {
                let added = added.deterministic(t);
                self.temperature
                    .extend(simulated.iter().map(|of| of - added));
            }
            None => {
                let mean = self.given.temperature.mean(t);
                self.temperature.resize(simulated.len(), mean);
            }
        }
        let temperature = &self.temperature;
        self.observer.snapshot(
            instant,
            Snapshot {
                temperature,
                ..snapshot
            },
        );
    }
}
