//! A sweep: what the commands do with one.

use super::{Again, AnyResult, Kind, Shown, StoredResult, page, pictures, provenance};
use crate::arguments::threads::Threads;
use crate::commands::{plot, sweep::stored};
use crate::inputs::files;
use crate::output::dataset;
use crate::output::failure::{Failure, warn};
use crate::output::numbers::grouped;
use crate::report::{self, Chosen, Report};
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use stickslip::study::sweep::{Point, Sweep, SweepSimulation};
use stickslip_figure::{Drawing, Subject};
use stickslip_files::dataset::{Dataset, SWEEP_FORMAT};
use stickslip_files::store::{self, Sealed, StoreError, StoredSweep};

/// A sweep: statistics as functions of keys of the scenario.
pub const SWEEP: Kind = Kind {
    name: "a sweep",
    format: SWEEP_FORMAT,
    is_resumable: true,
    read: |path| Ok(Box::new(store::read_sweep(path)?)),
    figures: stickslip_figure::SWEEP,
};

impl AnyResult for StoredSweep {
    fn report(&self, file: &Path, shown: &Shown) -> Result<Report, Failure> {
        let sweep = stored(file, self.clone())?;
        report::warnings(&sweep)
            .into_iter()
            .filter(|_| shown.is_text)
            .for_each(warn);
        Ok(report::sweep(&sweep, shown.chosen, file))
    }

    fn json(&self, file: &Path) -> Result<String, Failure> {
        let sweep = stored(file, self.clone())?;
        Ok(dataset::json(&Dataset::of_sweep(&sweep), Some(file)))
    }

    fn page(&self, file: &Path) -> Result<String, Failure> {
        let mut page = page(file, &self.scenario_text);
        page.provenance = provenance(file, self.other_program.as_deref());
        let sweeps = [(String::new(), stored(file, self.clone())?)];
        let [(_, sweep)] = &sweeps;
        let subject = Subject::Sweep {
            sweeps: &sweeps,
            statistics: &[],
        };
        page.pictures = pictures(SWEEP.figures, &subject);
        page.report = report::sweep(sweep, Chosen::First, file);
        page.warnings = report::warnings(sweep);
        Ok(page.html())
    }
}

impl StoredResult for StoredSweep {
    fn scenario(&self) -> (String, bool) {
        (self.scenario_text.clone(), !self.samples.is_empty())
    }

    fn other_program(&self) -> Option<String> {
        self.other_program.clone()
    }

    fn draw(&self, asked: &plot::Arguments) -> Result<Drawing, Failure> {
        let read = |file: &PathBuf| -> Result<(String, Sweep), Failure> {
            let name = file
                .file_stem()
                .unwrap_or_default()
                .to_string_lossy()
                .into_owned();
            Ok((name, stored(file, files::read(file, store::read_sweep)?)?))
        };
        let sweeps = std::iter::once(&asked.subject)
            .chain(&asked.beside)
            .map(read)
            .collect::<Result<Vec<_>, _>>()?;
        asked.draw(&Subject::Sweep {
            sweeps: &sweeps,
            statistics: asked.statistic.as_slice(),
        })
    }

    /// All points are simulated again. The time that each took is that of the file.
    fn again(&self, file: &Path, threads: &Threads, _: Sealed) -> Result<Again, Failure> {
        let mut again = stored(file, self.clone())?;
        let count = again.points.len();
        let before = std::mem::replace(&mut again.points, vec![None; count]);
        let simulation = SweepSimulation {
            threads: threads.number(),
            stop: &AtomicBool::new(false),
            progress: &mut (),
        };
        simulation
            .run(&mut again, |_| Ok::<_, StoreError>(()))
            .map_err(|end| Failure::Run(end.to_string()))?;
        for (point, before) in again.points.iter_mut().zip(before) {
            let both = point.take().zip(before);
            *point = both.map(|(point, Point { seconds, .. })| Point { seconds, ..point });
        }
        Ok(Again {
            simulated: format!("{} points", grouped(count as u64)),
            compared: "statistics, comparisons between points, attributes, coordinates and units",
            found: store::verify(file, &Dataset::of_sweep(&again))?,
        })
    }
}
