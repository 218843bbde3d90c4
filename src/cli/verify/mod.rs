//! `mc verify`: checks that a file holds what its scenario and its seed give.

mod run;
mod study;

use super::document::document;
use super::failure::{Failure, note, print, print_data};
use super::files;
use super::numbers::grouped;
use super::threads::Threads;
use serde_json::{Value, json};
use std::collections::BTreeSet;
use std::hash::{BuildHasher as _, RandomState};
use std::ops::Range;
use std::path::PathBuf;
use std::time::Duration;
use stick_slip::store::{self, Difference, FileKind, Sealed};

/// How long a file may take to be computed again as a whole if nobody asked for that.
const UNASKED: Duration = Duration::from_secs(5);

/// Arguments of `mc verify`.
#[derive(Debug, clap::Args)]
#[command(after_help = include_str!("../help/verify.txt"))]
pub struct Verify {
    /// A file of results: of a run or a part of one, a sweep, a trade or a calibration
    file: PathBuf,
    /// Number of blocks to simulate again, or `all` [default: all, or 8 where all take long]
    #[arg(long, value_name = "N|all", value_parser = sample)]
    blocks: Option<Sample>,
    #[command(flatten)]
    threads: Threads,
    /// Print one JSON object on standard output, and nothing else there
    #[arg(long)]
    json: bool,
}

/// How many blocks are to be simulated again.
#[derive(Clone, Copy, Debug)]
enum Sample {
    Some(u64),
    All,
}

fn sample(text: &str) -> Result<Sample, String> {
    match text {
        "all" => Ok(Sample::All),
        number => number.parse().map(Sample::Some).map_err(|_| "write a number of blocks, or `all`".into()),
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

impl Verify {
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

    fn refusal(&self, difference: &Difference, checked: &Checked) -> String {
        let remedy = match &checked.other_program {
            Some(_) => "verify it with the program that wrote it, because another version may compute other numbers",
            None => "take the file as it was written; its scenario, its seed or its numbers were changed since",
        };
        format!("{}: {difference}\n  fix: {remedy}", self.file.display())
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

/// `wanted` different numbers of this range, drawn at random.
fn drawn(all: &Range<u64>, wanted: u64) -> BTreeSet<u64> {
    let (random, count) = (RandomState::new(), all.end - all.start);
    let mut drawn = BTreeSet::new();
    // Floyd's algorithm for a sample: every subset of this size is equally likely.
    for last in count - wanted.min(count)..count {
        let number = all.start + random.hash_one(last) % (last + 1);
        if !drawn.insert(number) {
            drawn.insert(all.start + last);
        }
    }
    drawn
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sample_has_its_size_and_every_block_its_chance() {
        let mut seen = BTreeSet::new();
        // A sample of 5 out of 20 blocks misses a given block with probability 3/4, and 400 samples
        // all miss it with probability 1e-50. With 20 blocks, the test fails by chance with
        // probability below 1e-48. The samples are not seeded.
        for _ in 0..400 {
            let sample = drawn(&(100..120), 5);
            assert_eq!(sample.len(), 5);
            seen.extend(sample);
        }
        assert_eq!(seen, (100..120).collect());
        assert_eq!(drawn(&(3..7), 4), (3..7).collect());
    }
}
