//! Makes the inputs that fuzzing starts from: the shipped scenarios and series, and the files that
//! a short run of each writes.

use std::fs;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use stickslip::config::SHIPPED;
use stickslip::engine::{Run, Sink, SinkError};
use stickslip::scenario::Scenario;
use stickslip::stats::BlockResult;
use stickslip_files::store::{FileSink, partial_path};

type Done<T = ()> = Result<T, Box<dyn std::error::Error>>;

/// Stops a run after its first block.
struct Stopper<'a>(&'a AtomicBool);

impl Sink for Stopper<'_> {
    fn block(&mut self, _: &BlockResult) -> Result<(), SinkError> {
        self.0.store(true, Ordering::Relaxed);
        Ok(())
    }
}

fn main() -> Done {
    let corpus = Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz/corpus");
    for target in ["scenario", "series", "state", "rows", "results", "force"] {
        fs::create_dir_all(corpus.join(target))?;
    }
    let shipped = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios");
    for file in fs::read_dir(shipped)? {
        let path = file?.path();
        let name = path.file_name().unwrap_or_default();
        match path.extension().is_some_and(|extension| extension == "csv") {
            true => {
                // The first day of the series only, to keep the input small.
                let text: String = fs::read_to_string(&path)?
                    .lines()
                    .take(150)
                    .map(|line| format!("{line}\n"))
                    .collect();
                fs::write(corpus.join("series").join(name), format!("\0{text}"))?;
            }
            false => drop(fs::copy(&path, corpus.join("scenario").join(name))?),
        }
    }
    let forces = [
        "mu*(1 - exp(-abs(xdot)/vs))*sign(xdot)",
        "(0.3 - 0.05*x^2)*xdot",
        "-20*max(x - 3, 0) + 1.5*cos(2*t)",
    ];
    for (i, force) in forces.iter().enumerate() {
        fs::write(corpus.join("force").join(i.to_string()), force)?;
    }
    SHIPPED
        .iter()
        .try_for_each(|shipped| runs(&corpus, shipped.name))
}

/// Makes a finished run and an unfinished one.
fn runs(corpus: &Path, name: &str) -> Done {
    let mut scenario = Scenario::shipped(name)?;
    scenario.ensemble.paths = 600;
    scenario.record.events = true;
    scenario.record.trajectories = 2;
    scenario.time.output_step = scenario.time.end / 4.0;
    if scenario.check().is_err() {
        scenario = Scenario::shipped(name)?;
    }
    let folder = tempfile::tempdir()?;
    let target = folder.path().join("run.h5");
    let stop = AtomicBool::new(false);
    let (mut file, mut stopper) = (FileSink::new(&target, false), Stopper(&stop));
    Run::of(&scenario)
        .threads(1)
        .stopped_by(&stop)
        .into_sink(&mut file)
        .into_sink(&mut stopper)
        .simulate()?;
    drop(file);
    let partial = partial_path(&target);
    let state = fs::read(partial.join("state"))?;
    fs::write(corpus.join("state").join(name), &state[..state.len() - 4])?;
    let rows = fs::read(partial.join("rows"))?;
    // All blocks of rows as they are, and the rows of one block alone.
    fs::write(corpus.join("rows").join(name), [&[1], &rows[..]].concat())?;
    fs::write(
        corpus.join("rows").join(format!("{name}-block")),
        [&[0], &rows[8..rows.len() - 4]].concat(),
    )?;
    let target = folder.path().join("finished.h5");
    scenario.record.events = false;
    scenario.ensemble.paths = 64;
    Run::of(&scenario)
        .threads(1)
        .without_bias()
        .into_sink(&mut FileSink::new(&target, false))
        .simulate()?;
    let results = fs::read(target)?;
    fs::write(
        corpus.join("results").join(name),
        &results[..results.len() - 24],
    )?;
    Ok(())
}
