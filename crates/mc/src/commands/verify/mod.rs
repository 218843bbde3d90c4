//! `mc verify`: checks that a file holds what its scenario and its seed give.

mod run;
mod study;

use crate::arguments::threads::Threads;
use crate::inputs::files;
use crate::output::document::{document, joined};
use crate::output::failure::{Failure, note, print, print_data};
use crate::output::numbers::grouped;
use crate::report::{Report, text};
use serde_json::{Value, json};
use std::path::PathBuf;
use std::time::Duration;
use stickslip_files::saved::{BlocksAgain, Difference};
use stickslip_files::store::{self, Content, FileKind, Sealed, Verified};

/// How long a file may take to be computed again as a whole if nobody asked for that.
const UNASKED: Duration = Duration::from_secs(5);

/// Arguments of `mc verify`.
#[derive(Debug, clap::Args)]
#[command(after_help = include_str!("../help/verify.txt"))]
pub struct Arguments {
    /// File of results: a run or a part of one, a sweep, a trade or a calibration
    file: PathBuf,
    /// Number of blocks to simulate again, or `all` [default: all, or 8 if that takes long]
    #[arg(long, value_name = "N|all", value_parser = sample)]
    blocks: Option<BlocksAgain>,
    #[command(flatten)]
    threads: Threads,
    /// Print only one JSON object to standard output
    #[arg(long)]
    json: bool,
}

fn sample(text: &str) -> Result<BlocksAgain, String> {
    match text {
        "all" => Ok(BlocksAgain::All),
        number => number
            .parse()
            .map(BlocksAgain::Some)
            .map_err(|_| "write a number of blocks, or `all`".into()),
    }
}

/// What was compared, and the first difference if there is one.
struct Checked {
    /// What was computed again, for people.
    simulated: String,
    /// What was compared with that.
    compared: String,
    /// What was not, and why.
    not_compared: Option<String>,
    /// The same in JSON, without what all kinds of files have in common.
    fields: Value,
    found: Verified,
    /// The program that wrote the file, if it was not this one.
    other_program: Option<String>,
}

impl Arguments {
    pub fn call(&self) -> Result<(), Failure> {
        let is_unfinished = self.file.is_dir() || !self.file.exists();
        if is_unfinished && matches!(files::read(&self.file, store::kind)?, Some(FileKind::Run)) {
            let problem = format!("{}: the run is not finished", self.file.display());
            return Err(Failure::usage(
                problem,
                "finish it with `mc resume`, which checks what was saved",
            ));
        }
        let sealed = store::check_bytes(&self.file)?;
        let checked = match files::read(&self.file, store::content)? {
            Content::Run(stored) => self.run(&stored)?,
            Content::Sweep(stored) => self.sweep(&stored)?,
            Content::Trade(stored) => self.trade(&stored)?,
            Content::Calibration(stored) => self.calibration(&stored)?,
        };
        if let Some(other) = &checked.other_program {
            note(&format!("warning: {} was {other}", self.file.display()));
        }
        match self.json {
            true => print_data(&self.object(&checked, sealed))?,
            false => print(&self.report(&checked, sealed))?,
        }
        let Some(difference) = &checked.found.difference else {
            return Ok(());
        };
        let remedy = match &checked.other_program {
            Some(_) => {
                "verify it with the program that wrote it; results of other versions may differ"
            }
            None => "use the unmodified file; its scenario, seed or numbers were changed",
        };
        Err(Failure::run_of(&self.file, difference.of("file"), remedy))
    }

    /// How many blocks or points are to be simulated again.
    fn sample(&self) -> BlocksAgain {
        self.blocks.unwrap_or(BlocksAgain::Within(UNASKED))
    }

    /// The result for people.
    fn report(
        &self,
        checked: &Checked,
        Sealed {
            bytes,
            has_checksum,
        }: Sealed,
    ) -> String {
        let Checked {
            simulated,
            compared,
            not_compared,
            found,
            ..
        } = checked;
        let checksum = match has_checksum {
            true => format!("correct for its {} bytes", grouped(bytes)),
            false => "none: another program changed the file, or an earlier version of mc wrote it"
                .into(),
        };
        let compared = format!("{compared}: {} values", grouped(found.values));
        let mut remarks = vec![
            ("checksum", checksum),
            ("simulated", simulated.clone()),
            ("compared", compared),
        ];
        if found.difference.is_none() {
            remarks.extend(not_compared.clone().map(|why| ("not compared", why)));
            remarks.push(("result", "all of this is identical, bit for bit".into()));
        }
        text(&Report {
            title: self.file.display().to_string(),
            remarks,
            ..Report::default()
        })
    }

    fn object(&self, checked: &Checked, sealed: Sealed) -> String {
        let difference = checked.found.difference.as_ref().map(|difference| {
            let Difference { variable, path, index, stored, computed } = difference;
            json!({ "variable": variable, "path": path, "index": index, "stored": stored, "computed": computed })
        });
        let object = json!({
            "file": self.file.display().to_string(),
            "matches": difference.is_none(),
            "bytes": sealed.bytes,
            "has_checksum": sealed.has_checksum,
            "same_program": checked.other_program.is_none(),
            "values_checked": checked.found.values,
            "difference": difference,
        });
        document("verification", joined(object, checked.fields.clone()))
    }
}
