//! The sink that keeps a run in memory.

use super::{Dataset, header, run};
use crate::engine::{Asked, Outcome, Provenance, Sink, SinkError};
use crate::scenario::Scenario;
use crate::stats::BlockResult;

/// Keeps a run in memory, with everything that its scenario records. The result is the data set
/// that a file of the run would contain.
///
/// ```
/// use stickslip::dataset::{Column, Recorder};
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
    use crate::engine::Run;
    use crate::stats::{Bias, Line, PassageLevels, Record};
    use crate::sums::Ends;

    /// A shipped scenario of which everything is recorded.
    fn recorded(name: &str, paths: u64) -> Scenario {
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
        scenario
    }

    /// The statistics that are read back have the bits of those that were written.
    #[test]
    fn the_statistics_of_a_data_set_are_those_of_the_run() {
        for (name, paths) in [("rho025", 300), ("shaw", 1)] {
            let scenario = recorded(name, paths);
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

    /// Each variable holds what its name says, for a reader that knows only the names: two that are
    /// exchanged come back right through the reader of this program.
    #[test]
    fn variables_hold_what_their_names_say() {
        let mut scenario = recorded("rho025", 300);
        scenario.statistics.after = 9.0;
        let run = Run::of(&scenario).simulate().expect("sound");
        let mut summary = run.summary;
        summary.estimates[0].bias = Some(Bias {
            estimate: 0.1,
            uncertainty: 0.03,
            order: Some(0.5),
        });
        let spectrum = summary.spectrum.as_mut().expect("recorded");
        spectrum.lines = vec![Line {
            frequency: 1.0,
            displacement: 2.0,
            velocity: 3.0,
        }];
        let mut dataset = Dataset::default();
        crate::dataset::summary::write(&mut dataset, &summary);
        let of = |name: &str| {
            let entry = dataset.entry(name).unwrap_or_else(|| panic!("{name}"));
            let reals = <&[f64]>::try_from(&entry.column).map(<[f64]>::to_vec);
            reals.unwrap_or_else(|_| {
                let counts = <&[u64]>::try_from(&entry.column).expect("numbers");
                counts.iter().map(|count| *count as f64).collect()
            })
        };
        let both = |ends: &Ends| [&ends.low[..], &ends.high].concat();
        let e = summary.estimates[0];
        for (name, wanted) in [
            ("estimate", e.estimate),
            ("standard_error", e.standard_error),
            ("interval_low", e.low),
            ("interval_high", e.high),
            ("bias", 0.1),
            ("bias_uncertainty", 0.03),
            ("bias_order", 0.5),
            (
                "estimate_corrected_low",
                e.estimate - 0.1 - (e.estimate - e.low).hypot(0.03),
            ),
            (
                "estimate_corrected_high",
                e.estimate - 0.1 + (e.high - e.estimate).hypot(0.03),
            ),
            ("displacement_line", 2.0),
            ("velocity_line", 3.0),
        ] {
            assert!(
                (of(name)[0] - wanted).abs() < 1e-12,
                "{name}: {} {wanted}",
                of(name)[0]
            );
        }
        let (laws, transient) = (
            summary.laws.as_ref().expect("recorded"),
            summary.transient.expect("a burn-in"),
        );
        let (sticks, periods) = (&summary.stick_durations, &summary.periods);
        let bands = &summary.bands;
        for (name, wanted) in [
            (
                "displacement_mean_interval",
                both(&bands.displacement.mean_ends),
            ),
            (
                "static_probability_interval",
                both(&bands.static_probability_ends),
            ),
            (
                "displacement_period_mean_interval",
                both(&periods.mean_ends),
            ),
            (
                "displacement_period_variance_interval",
                both(&periods.variance_ends),
            ),
            ("transient_sticks", vec![transient.sticks as f64]),
            ("transient_slips", vec![transient.slips as f64]),
        ] {
            assert_eq!(format!("{:?}", of(name)), format!("{wanted:?}"), "{name}");
        }
        let first = [sticks, &laws[0]];
        assert_eq!(
            of("law_completed")[..2],
            first.map(|law| law.completed as f64)
        );
        assert_eq!(
            of("law_censored")[..2],
            first.map(|law| law.censored as f64)
        );
        // All lower ends come before all upper ones, and each law is filled up to the longest.
        let survival = of("law_survival_interval");
        let ends = [&sticks.survival_ends.low, &sticks.survival_ends.high];
        for (ends, found) in ends.into_iter().zip(survival.chunks(survival.len() / 2)) {
            assert_eq!(format!("{:?}", &found[..ends.len()]), format!("{ends:?}"));
        }
    }
}
