//! User-defined statistics. A Python function turns the events of a finished block into a number for
//! each path. The estimate from these numbers has an interval like that of any other statistic.

use numpy::{IntoPyArray as _, PyReadonlyArray1};
use pyo3::prelude::*;
use stickslip::dataset::Recorder;
use stickslip::engine::{Asked, Moment, Outcome, Sink, SinkError};
use stickslip::scenario::Scenario;
use stickslip::stats::{BlockResult, BlockRows, EventColumns, PathMeans, Record};
use stickslip::sums::{Measurement, Replicate, Tree};

/// A user-defined statistic.
struct Own {
    function: Py<PyAny>,
    /// The means of what the function returns and of what these numbers are divided by, summed
    /// along the tree of the run.
    tree: Tree<PathMeans<2>>,
    is_ratio: bool,
}

/// Estimate, standard error, and the ends of the interval of a user-defined statistic.
pub type OwnEstimate = [f64; 4];

/// The user-defined statistics of one scenario.
pub struct OwnStatistics {
    own: Vec<Own>,
    unit: Replicate,
    blocks: u64,
}

/// A sink that keeps a run in memory, and passes the events of each block to user-defined
/// statistics.
pub struct KeptRun {
    pub recorder: Recorder,
    pub own: OwnStatistics,
    /// What the data set is to contain.
    record: Record,
}

/// What a function returns for a block: a number for each path, and for a ratio the numbers whose
/// mean it is divided by.
type Numbers<'py> = (
    PyReadonlyArray1<'py, f64>,
    Option<PyReadonlyArray1<'py, f64>>,
);

impl OwnStatistics {
    pub fn new(scenario: &Scenario, functions: &[Py<PyAny>]) -> Self {
        let own = Python::attach(|py| {
            let of = |function: &Py<PyAny>| Own {
                function: function.clone_ref(py),
                tree: Tree::default(),
                is_ratio: false,
            };
            functions.iter().map(of).collect()
        });
        let unit = if scenario.ensemble.antithetic {
            Replicate::Pair
        } else {
            Replicate::Path
        };
        OwnStatistics {
            own,
            unit,
            blocks: 0,
        }
    }

    /// Passes the events of the next block to the functions.
    pub fn show(&mut self, block: &BlockResult) -> PyResult<()> {
        let BlockRows {
            first_path,
            events: Some(events),
            ..
        } = &block.rows
        else {
            return Ok(());
        };
        let is_sound = |path: u64| block.diverged.binary_search(&path).is_err();
        Python::attach(|py| {
            for own in &mut self.own {
                let (top, bottom) = own.numbers(py, *first_path, events)?;
                let (top, bottom) = (
                    top.as_array(),
                    bottom.as_ref().map(|bottom| bottom.as_array()),
                );
                own.is_ratio = bottom.is_some();
                let each = (*first_path..).zip(&top).enumerate();
                let sound = each.filter(|(_, (path, _))| is_sound(*path));
                let numbers = sound
                    .map(|(i, (_, &top))| [top, bottom.as_ref().map_or(1.0, |bottom| bottom[i])]);
                let means = PathMeans::of(&numbers.collect::<Vec<_>>(), self.unit);
                // This cannot fail, because each block comes once and in order.
                let _ = own.tree.push(self.blocks, means);
            }
            self.blocks += 1;
            Ok(())
        })
    }

    fn is_empty(&self) -> bool {
        self.own.is_empty()
    }

    /// The estimates from the blocks so far; NaN before the first.
    pub fn estimates(&self) -> Vec<OwnEstimate> {
        self.own.iter().map(Own::estimate).collect()
    }
}

impl KeptRun {
    pub fn new(scenario: &Scenario, functions: &[Py<PyAny>]) -> Self {
        KeptRun {
            recorder: Recorder::default(),
            own: OwnStatistics::new(scenario, functions),
            record: scenario.record,
        }
    }

    /// The scenario, with events recorded if user-defined statistics need them.
    pub fn watched(&self, scenario: &Scenario) -> Scenario {
        let record = Record {
            events: scenario.record.events || !self.own.is_empty(),
            ..scenario.record
        };
        Scenario {
            record,
            ..scenario.clone()
        }
    }
}

impl Own {
    fn numbers<'py>(
        &self,
        py: Python<'py>,
        first: u64,
        events: &EventColumns,
    ) -> PyResult<Numbers<'py>> {
        let EventColumns {
            count,
            time,
            displacement,
            force,
            sign,
            kind,
            ..
        } = events;
        let [time, displacement, force] =
            [time, displacement, force].map(|column| column.clone().into_pyarray(py));
        let [sign, kind] = [sign, kind].map(|column| column.clone().into_pyarray(py));
        let shown = (
            first,
            count.clone().into_pyarray(py),
            time,
            displacement,
            force,
            sign,
            kind,
        );
        self.function.bind(py).call1(shown)?.extract()
    }

    fn estimate(&self) -> OwnEstimate {
        let Some(means) = self.tree.total(|means| means) else {
            return [f64::NAN; 4];
        };
        let Measurement {
            estimate,
            standard_error,
            low,
            high,
        } = match self.is_ratio {
            true => means.ratio(0, 1),
            false => means.mean(0),
        };
        [estimate, standard_error, low, high]
    }
}

impl Sink for KeptRun {
    fn begin(&mut self, scenario: &Scenario, asked: &Asked) -> Result<(), SinkError> {
        let asked_for = Scenario {
            record: self.record,
            ..scenario.clone()
        };
        self.own.blocks = asked.blocks().start;
        self.recorder.begin(&asked_for, asked)
    }

    fn block(&mut self, block: &BlockResult) -> Result<(), SinkError> {
        self.own.show(block)?;
        match self.record.events || self.own.is_empty() {
            true => self.recorder.block(block),
            false => {
                let rows = BlockRows {
                    events: None,
                    ..block.rows.clone()
                };
                self.recorder.block(&BlockResult {
                    rows,
                    ..block.clone()
                })
            }
        }
    }

    fn save(&mut self, moment: &Moment<'_>) -> Result<(), SinkError> {
        self.recorder.save(moment)
    }

    fn finish(&mut self, outcome: &Outcome) -> Result<(), SinkError> {
        self.recorder.finish(outcome)
    }
}
