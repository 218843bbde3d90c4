//! Sweeps as results: how the commands show, draw and verify them.

use super::{Again, AnyResult, Kind, Shown, StoredResult, page, pictures, provenance};
use crate::arguments::threads::Threads;
use crate::commands::plot;
use crate::inputs::files;
use crate::output::dataset;
use crate::output::failure::{Failure, warn};
use crate::output::numbers::grouped;
use crate::report::{self, Report, ShownStatistics};
use crate::session::progress::Progress;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use stickslip::dataset::{Dataset, SWEEP_FORMAT};
use stickslip::study::sweep::{Point, Sweep, SweepSimulation};
use stickslip_figure::{Drawing, Subject};
use stickslip_files::store::{self, CheckedBytes, StoreError, StoredSweep};

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
        report::warnings(&self.sweep)
            .into_iter()
            .filter(|_| shown.is_text)
            .for_each(warn);
        Ok(report::sweep(&self.sweep, shown.chosen, file))
    }

    fn json(&self, file: &Path) -> Result<String, Failure> {
        Ok(dataset::json(&Dataset::of_sweep(&self.sweep), Some(file)))
    }

    fn page(&self, file: &Path) -> Result<String, Failure> {
        let scenario = self.scenario().0;
        let mut page = page(file, &scenario);
        page.provenance = provenance(file, self.other_program.as_deref());
        let sweeps = [(String::new(), self.sweep.clone())];
        let [(_, sweep)] = &sweeps;
        let subject = Subject::Sweep {
            sweeps: &sweeps,
            statistics: &[],
        };
        let mut pictures = pictures(SWEEP.figures, &subject, "").into_iter();
        page.leading_picture = pictures.next();
        page.pictures = pictures.collect();
        page.report = report::sweep(sweep, ShownStatistics::First, file);
        page.warnings = report::warnings(sweep);
        Ok(page.html())
    }
}

impl StoredResult for StoredSweep {
    fn scenario(&self) -> (String, bool) {
        let scenario = &self.sweep.question.scenario;
        (scenario.to_toml(), !scenario.written.measured.is_empty())
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
            Ok((name, files::read(file, store::read_sweep)?.sweep))
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

    /// All points are simulated again. The times of the points are taken from the file.
    fn again(&self, file: &Path, threads: &Threads, _: CheckedBytes) -> Result<Again, Failure> {
        let mut again = self.sweep.clone();
        let count = again.points.len();
        let before = std::mem::replace(&mut again.points, vec![None; count]);
        let points = &again.question.points;
        let paths = points.iter().map(|point| point.ensemble.paths).sum();
        let mut progress = Progress::new(paths, false, None, None);
        let simulation = SweepSimulation {
            threads: threads.number(),
            stop: &AtomicBool::new(false),
            progress: &mut progress,
            blocks: None,
        };
        let ended = simulation.run(&mut again, |_| Ok::<_, StoreError>(()));
        progress.finish();
        ended.map_err(|end| Failure::Run(end.to_string()))?;
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
