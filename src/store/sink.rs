//! A file as the sink of a run.

use super::{StoreError, Writer, check_space, discard_partial};
use crate::engine::{Outcome, Sink, SinkError};
use crate::provenance::Provenance;
use crate::scenario::Scenario;
use crate::stats::BlockResult;
use std::path::{Path, PathBuf};

/// Writes a run to a file, which has its name only once the run is over.
///
/// ```
/// use stick_slip::engine::Run;
/// use stick_slip::scenario::Scenario;
/// use stick_slip::store::{self, FileSink};
///
/// let folder = tempfile::tempdir()?;
/// let target = folder.path().join("shaw.h5");
/// let scenario = Scenario::shipped("shaw")?;
/// Run::of(&scenario).into_sink(&mut FileSink::new(&target, false)).simulate()?;
/// assert_eq!(store::read(&target)?.completed_paths, scenario.ensemble.paths);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct FileSink {
    target: PathBuf,
    force: bool,
    writer: Option<Writer>,
}

impl FileSink {
    /// To this file. With `force`, what an unfinished run to the same name left behind is removed first.
    pub fn new(target: &Path, force: bool) -> Self {
        FileSink { target: target.to_owned(), force, writer: None }
    }

    fn create(&self, scenario: &Scenario, paths: u64) -> Result<Writer, StoreError> {
        let folder = self.target.parent().unwrap_or(Path::new("."));
        check_space(folder, scenario.derived().output_bytes as u64)?;
        if self.force {
            discard_partial(&self.target)?;
        }
        let provenance = Provenance { paths, ..Provenance::of(scenario) };
        Writer::create(&self.target, &provenance, &scenario.record)
    }
}

impl Sink for FileSink {
    fn begin(&mut self, scenario: &Scenario, paths: u64) -> Result<(), SinkError> {
        self.writer = Some(self.create(scenario, paths)?);
        Ok(())
    }

    fn block(&mut self, block: &BlockResult) -> Result<(), SinkError> {
        if let Some(writer) = &mut self.writer {
            writer.append(block)?;
        }
        Ok(())
    }

    fn finish(&mut self, outcome: &Outcome) -> Result<(), SinkError> {
        let Some(mut writer) = self.writer.take() else { return Ok(()) };
        if let Some(reason) = &outcome.ended_by {
            writer.ended_by(&reason.to_string())?;
        }
        Ok(writer.finish(&outcome.summary, outcome.status)?)
    }
}
