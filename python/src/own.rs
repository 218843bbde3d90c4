//! Statistics of the caller's own. A function of Python turns the events of a finished block into a
//! number for each path. The estimate from these numbers has an interval like that of any other
//! statistic.

use numpy::{IntoPyArray as _, PyReadonlyArray1};
use pyo3::prelude::*;
use stickslip::engine::{Asked, Moment, Outcome, Sink, SinkError};
use stickslip::scenario::Scenario;
use stickslip::stats::{BlockResult, BlockRows, EventColumns, PathMeans, Record};
use stickslip::sums::{Measurement, Replicate, Tree};
use stickslip_files::dataset::Recorder;

/// A statistic of the caller's own.
pub struct Own {
    pub name: String,
    function: Py<PyAny>,
    /// The means of what the function returns and of what these numbers are divided by, summed
    /// along the tree of the run.
    tree: Tree<PathMeans<2>>,
    is_ratio: bool,
}

/// A sink that keeps a run in memory, and passes the events of each block to statistics of the
/// caller's own.
pub struct Kept {
    pub recorder: Recorder,
    pub own: Vec<Own>,
    /// What the data set is to contain.
    record: Record,
    unit: Replicate,
    blocks: u64,
}

/// What a function returns for a block: a number for each path, and for a ratio the numbers whose
/// mean it is divided by.
type Numbers<'py> = (
    PyReadonlyArray1<'py, f64>,
    Option<PyReadonlyArray1<'py, f64>>,
);

impl Kept {
    pub fn new(scenario: &Scenario, own: Vec<(String, Py<PyAny>)>) -> Self {
        let of = |(name, function)| Own {
            name,
            function,
            tree: Tree::default(),
            is_ratio: false,
        };
        let unit = if scenario.ensemble.antithetic {
            Replicate::Pair
        } else {
            Replicate::Path
        };
        Kept {
            recorder: Recorder::default(),
            own: own.into_iter().map(of).collect(),
            record: scenario.record,
            unit,
            blocks: 0,
        }
    }

    /// The scenario with events recorded, if there are statistics of the caller's own that need
    /// them.
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

    fn show(&mut self, block: &BlockResult) -> PyResult<()> {
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
            Ok(())
        })
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

    /// The estimate from the blocks so far, if there are any.
    pub fn estimated(&self) -> Option<Measurement> {
        let means = self.tree.total(|means| means)?;
        Some(if self.is_ratio {
            means.ratio(0, 1)
        } else {
            means.mean(0)
        })
    }
}

impl Sink for Kept {
    fn begin(&mut self, scenario: &Scenario, asked: &Asked) -> Result<(), SinkError> {
        let asked_for = Scenario {
            record: self.record,
            ..scenario.clone()
        };
        self.blocks = asked.blocks().start;
        self.recorder.begin(&asked_for, asked)
    }

    fn block(&mut self, block: &BlockResult) -> Result<(), SinkError> {
        self.show(block)?;
        self.blocks += 1;
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
