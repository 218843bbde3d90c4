//! `mc verify`: checks that a file holds what its scenario and its seed give.

mod run;
mod study;

use super::document::document;
use super::failure::{Failure, note, print, print_data};
use super::files;
use super::numbers::grouped;
use super::threads::Threads;
use serde_json::{Value, json};
use std::path::PathBuf;
use std::time::Duration;
use stick_slip::saved::{BlocksAgain, Difference};
use stick_slip::store::{self, FileKind, Sealed};

/// How long a file may take to be computed again as a whole if nobody asked for that.
const UNASKED: Duration = Duration::from_secs(5);

/// Arguments of `mc verify`.
#[derive(Debug, clap::Args)]
#[command(after_help = include_str!("../help/verify.txt"))]
pub struct Arguments {
    /// A file of results: of a run or a part of one, a sweep, a trade or a calibration
    file: PathBuf,
    /// Number of blocks to simulate again, or `all` [default: all, or 8 where all take long]
    #[arg(long, value_name = "N|all", value_parser = sample)]
    blocks: Option<BlocksAgain>,
    #[command(flatten)]
    threads: Threads,
    /// Print one JSON object on standard output, and nothing else there
    #[arg(long)]
    json: bool,
}

fn sample(text: &str) -> Result<BlocksAgain, String> {
    match text {
        "all" => Ok(BlocksAgain::All),
        number => number.parse().map(BlocksAgain::Some).map_err(|_| "write a number of blocks, or `all`".into()),
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
    values: u64,
    /// The program that wrote the file, if it was not this one.
    other_program: Option<String>,
    difference: Option<Difference>,
}

impl Arguments {
    pub fn call(&self) -> Result<(), Failure> {
        let kind = files::read(&self.file, store::kind)?;
        let is_unfinished = self.file.is_dir() || !self.file.exists();
        if is_unfinished && matches!(kind, Some(FileKind::Run)) {
            let problem = format!("{}: the run is not finished", self.file.display());
            return Err(Failure::usage(problem, "finish it with `mc resume`, which checks what was saved"));
        }
        let sealed = store::check_bytes(&self.file)?;
        let checked = match kind {
            Some(FileKind::Sweep) => self.sweep(&files::read(&self.file, store::read_sweep)?)?,
            Some(FileKind::Trade) => self.trade(&files::read(&self.file, store::read_trade)?)?,
            Some(FileKind::Calibration) => self.calibration(files::read(&self.file, store::read_calibration)?)?,
            Some(FileKind::Run) | None => self.run(&files::read(&self.file, store::read)?)?,
        };
        if let Some(other) = &checked.other_program {
            note(&format!("warning: {} was {other}", self.file.display()));
        }
        if self.json {
            print_data(&self.object(&checked, sealed))?;
        } else {
            print(&self.report(&checked, sealed))?;
        }
        match &checked.difference {
            Some(difference) => Err(Failure::Run(self.refusal(difference, &checked))),
            None => Ok(()),
        }
    }

    /// How many blocks or points are to be simulated again.
    fn sample(&self) -> BlocksAgain {
        self.blocks.unwrap_or(BlocksAgain::Within(UNASKED))
    }

    fn refusal(&self, difference: &Difference, checked: &Checked) -> String {
        let remedy = match &checked.other_program {
            Some(_) => "verify it with the program that wrote it, because another version may compute other numbers",
            None => "take the file as it was written; its scenario, its seed or its numbers were changed since",
        };
        format!("{}: {}\n  fix: {remedy}", self.file.display(), difference.of("file"))
    }

    /// The result for people.
    fn report(&self, checked: &Checked, sealed: Sealed) -> String {
        let Checked { simulated, compared, not_compared, values, difference, .. } = checked;
        let mut text = format!("{}\n{}", self.file.display(), checksum(sealed));
        text += &format!("simulated    {simulated}\ncompared     {compared}: {} values\n", grouped(*values));
        if difference.is_none() {
            if let Some(why) = not_compared {
                text += &format!("not compared {why}\n");
            }
            text += "all of that is the same, bit for bit\n";
        }
        text
    }

    fn object(&self, checked: &Checked, sealed: Sealed) -> String {
        let difference = checked.difference.as_ref().map(|difference| {
            json!({
                "variable": difference.variable,
                "path": difference.path,
                "index": difference.index,
                "stored": difference.stored,
                "computed": difference.computed,
            })
        });
        let mut object = json!({
            "file": self.file.display().to_string(),
            "matches": difference.is_none(),
            "bytes": sealed.bytes,
            "has_checksum": sealed.has_checksum,
            "same_program": checked.other_program.is_none(),
            "values_checked": checked.values,
            "difference": difference,
        });
        if let (Value::Object(all), Value::Object(own)) = (&mut object, checked.fields.clone()) {
            all.extend(own);
        }
        document("verification", object)
    }
}

fn checksum(Sealed { bytes, has_checksum }: Sealed) -> String {
    let bytes = grouped(bytes);
    match has_checksum {
        true => format!("checksum     that of its {bytes} bytes is right\n"),
        false => "checksum     none: another program changed the file, or an earlier version of mc wrote it\n".into(),
    }
}
