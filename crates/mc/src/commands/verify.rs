//! `mc verify`: checks that a file is unchanged, and reproducible from its scenario and seed.

use crate::arguments::threads::Threads;
use crate::inputs::files;
use crate::kinds::{self, Again, RUN};
use crate::output::document::document;
use crate::output::failure::{Failure, note, print, print_data};
use crate::output::numbers::grouped;
use crate::report::{Report, text};
use serde_json::json;
use std::path::PathBuf;
use stickslip_files::saved::Difference;
use stickslip_files::store::{self, CheckedBytes};

/// Arguments of `mc verify`.
#[derive(Debug, clap::Args)]
#[command(after_help = include_str!("help/verify.txt"))]
pub struct Arguments {
    /// File of results, of any kind
    file: PathBuf,
    /// Simulate the stored scenario again, and compare all numbers with those in the file
    #[arg(long)]
    again: bool,
    #[command(flatten)]
    threads: Threads,
    /// Print only one JSON object to standard output
    #[arg(long)]
    json: bool,
}

impl Arguments {
    pub fn call(&self) -> Result<(), Failure> {
        let is_unfinished = self.file.is_dir() || !self.file.exists();
        if is_unfinished
            && files::read(&self.file, kinds::of)?.is_some_and(|kind| kind.format == RUN.format)
        {
            let problem = format!("{}: the run is not finished", self.file.display());
            return Err(Failure::usage(
                problem,
                "finish it with `mc resume`, which checks what was saved",
            ));
        }
        let checked = store::check_bytes(&self.file)?;
        let content = kinds::read(&self.file)?;
        let other_program = content.other_program();
        if let Some(other) = &other_program {
            note(&format!("warning: {} was {other}", self.file.display()));
        }
        let again = match self.again {
            true => Some(content.again(&self.file, &self.threads, checked)?),
            false => None,
        };
        match self.json {
            true => print_data(&self.object(again.as_ref(), checked, other_program.is_none()))?,
            false => print(&self.report(again.as_ref(), checked))?,
        }
        let Some(difference) = again.and_then(|again| again.found.difference) else {
            return Ok(());
        };
        let remedy = match other_program {
            Some(_) => {
                "verify it with the program that wrote it; results of other versions may differ"
            }
            None => "use the unmodified file; its scenario, seed or numbers were changed",
        };
        Err(Failure::run_of(&self.file, difference.of("file"), remedy))
    }

    /// The result for people.
    fn report(
        &self,
        again: Option<&Again>,
        CheckedBytes {
            bytes,
            has_checksum,
        }: CheckedBytes,
    ) -> String {
        let file = self.file.display().to_string();
        let checksum = match has_checksum {
            true => format!("correct for its {} bytes", grouped(bytes)),
            false => "none: another program changed the file, or an earlier version of mc wrote it"
                .into(),
        };
        let mut remarks = vec![("checksum", checksum)];
        if let Some(Again {
            simulated,
            compared,
            found,
        }) = again
        {
            let compared = format!("{compared}: {} values", grouped(found.values));
            remarks.extend([("simulated", simulated.clone()), ("compared", compared)]);
            if found.difference.is_none() {
                remarks.push(("result", "all of this is identical, bit for bit".into()));
            }
        } else {
            let rest = format!("numbers; to simulate them again, use `mc verify {file} --again`");
            remarks.extend([
                ("result", "the file can be read".into()),
                ("not compared", rest),
            ]);
        }
        text(&Report {
            title: file,
            remarks,
            ..Report::default()
        })
    }

    fn object(&self, again: Option<&Again>, checked: CheckedBytes, same_program: bool) -> String {
        let found = again.map(|again| &again.found);
        let difference = found.and_then(|found| found.difference.as_ref()).map(|difference| {
            let Difference { variable, path, index, stored, computed } = difference;
            json!({ "variable": variable, "path": path, "index": index, "stored": stored, "computed": computed })
        });
        let object = json!({
            "file": self.file.display().to_string(),
            "matches": found.map(|_| difference.is_none()),
            "bytes": checked.bytes,
            "has_checksum": checked.has_checksum,
            "same_program": same_program,
            "values_checked": found.map_or(0, |found| found.values),
            "difference": difference,
        });
        document("verification", object)
    }
}
