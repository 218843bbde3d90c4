//! The sink that keeps a run in memory.

use super::{Dataset, header, run};
use stickslip::engine::{Asked, Outcome, Provenance, Sink, SinkError};
use stickslip::scenario::Scenario;
use stickslip::stats::BlockResult;

/// Keeps a run in memory, with everything that its scenario records. The result is the data set
/// that a file of the run would contain.
///
/// ```
/// use stickslip_files::dataset::{Column, Recorder};
/// use stickslip::engine::Run;
/// use stickslip::scenario::Scenario;
///
/// let mut recorder = Recorder::default();
/// Run::of(&Scenario::shipped("shaw")?).into_sink(&mut recorder).simulate()?;
/// let dataset = recorder.into_dataset();
/// let path = dataset.entry("path").expect("its scenario records paths");
/// assert_eq!(path.column, Column::U64(vec![0]));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct Recorder {
    dataset: Dataset,
    header: Option<Provenance>,
}

impl Recorder {
    /// The data set.
    pub fn into_dataset(self) -> Dataset {
        self.dataset
    }
}

impl Sink for Recorder {
    fn begin(&mut self, scenario: &Scenario, asked: &Asked) -> Result<(), SinkError> {
        let header = asked.provenance(scenario);
        self.dataset = run::start(&header, &scenario.record);
        self.header = Some(header);
        Ok(())
    }

    fn block(&mut self, block: &BlockResult) -> Result<(), SinkError> {
        if let Some(Provenance { units, bearing, .. }) = &self.header {
            self.dataset
                .grow(Dataset::of_rows(&block.rows, units, *bearing));
        }
        Ok(())
    }

    fn finish(&mut self, outcome: &Outcome) -> Result<(), SinkError> {
        header::write_part(&mut self.dataset, outcome.part);
        header::write_ended_by(
            &mut self.dataset,
            outcome.ended_by.as_ref().map(ToString::to_string),
        );
        run::write_end(&mut self.dataset, &outcome.summary, outcome.status);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use stickslip::engine::Run;
    use stickslip::stats::{PassageLevels, Record};

    /// The statistics that are read back have the bits of those that were written.
    #[test]
    fn the_statistics_of_a_data_set_are_those_of_the_run() {
        for (name, paths) in [("rho025", 300), ("shaw", 1)] {
            let mut scenario = Scenario::shipped(name).expect("shipped");
            scenario.ensemble.paths = paths;
            scenario.record = Record {
                paths: true,
                events: true,
                trajectories: 2,
                laws: true,
                density: true,
                spectrum: true,
                energy: true,
                levels: PassageLevels::of(&[1.0]),
            };
            let mut recorder = Recorder::default();
            let outcome = Run::of(&scenario)
                .into_sink(&mut recorder)
                .simulate()
                .expect("sound");
            let dataset = recorder.into_dataset();
            let summary = dataset.summary(scenario.scheme.step()).expect("whole");
            // The texts are compared because NaN does not equal itself.
            assert_eq!(
                format!("{summary:?}"),
                format!("{:?}", outcome.summary),
                "{name}"
            );
            let shape = |name: &str| dataset.shape(dataset.entry(name).expect("recorded"));
            assert_eq!(shape("path_sticks"), [paths as usize]);
            let rows = scenario.timeline().rows();
            assert_eq!(
                shape("trajectory_displacement"),
                [paths.min(2) as usize, rows]
            );
            assert_eq!(shape("event_time"), shape("event_kind"));
        }
    }
}
