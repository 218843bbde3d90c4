//! What was repaired in a file, and what was assumed.

use std::fmt::Display;

/// What was repaired in a file, and what was assumed.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Repairs {
    /// Number of lines before the names of the columns that were left out.
    pub skipped: u64,
    /// Number of lines below the names of the columns that hold units and the like.
    pub unit_rows: u64,
    /// Number of lines that repeat the names of the columns.
    pub repeated_headers: u64,
    /// Number of lines that could not be read and were left out, and the first of them.
    pub bad: Option<(u64, u64)>,
    /// The encoding of the file, if it is not UTF-8.
    pub encoding: Option<&'static str>,
    /// The order of day, month and year, if it was inferred from all dates, with the reason.
    pub order: Option<String>,
    /// The zone in the name of the time column, if a different one was given.
    pub zone: Option<String>,
    /// Number of rows that came after a row with a later time, and were sorted.
    pub unsorted: u64,
    /// Number of rows that repeated the time and the value of another row, and were left out.
    pub repeated: u64,
    /// Number of stamps in an hour that occurs twice; they were resolved by the order of the rows.
    pub folds: u64,
    /// Number of numbers with a decimal comma.
    pub decimal_commas: u64,
    /// For each column, what was left out of it.
    pub columns: Vec<ColumnRepairs>,
}

/// What was left out of one column, and what was assumed about it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ColumnRepairs {
    /// The name of the column.
    pub name: String,
    /// Number of cells without a value.
    pub missing: u64,
    /// Number of temperatures that were left out, because they are below absolute zero in any unit.
    pub cold: u64,
    /// Number of outliers that were left out, if the layout says so.
    pub outliers: u64,
    /// An outlier that was kept, in a sentence.
    pub odd: Option<String>,
    /// The unit that was assumed because none is given.
    pub assumed_unit: Option<&'static str>,
    /// The time over which values were taken to be means, because the name of the column says so.
    pub averaged: Option<String>,
}

/// A sentence with a count in place of `#`, and `{s}` as the plural of what is counted; none for 0.
pub(super) fn many(count: u64, sentence: &str) -> Option<String> {
    let plural = if count == 1 { "" } else { "s" };
    let said = sentence
        .replace('#', &count.to_string())
        .replace("{s}", plural);
    (count > 0).then_some(said)
}

impl Repairs {
    /// The repairs as sentences that begin with the name of their file.
    pub fn of_file(&self, name: impl Display) -> Vec<String> {
        self.sentences()
            .iter()
            .map(|sentence| format!("{name}: {sentence}").replace(char::is_control, " "))
            .collect()
    }

    /// The repairs as sentences; none if nothing was repaired.
    pub fn sentences(&self) -> Vec<String> {
        let bad = self.bad.and_then(|(count, line)| {
            let said = "left out # line{s} that cannot be read";
            Some(format!("{}, the first in line {line}", many(count, said)?))
        });
        let zone = self.zone.as_ref();
        let at_first = [
            many(self.skipped, "skipped # line{s} before the header"),
            many(
                self.unit_rows,
                "took # line{s} below the header as units and notes",
            ),
            many(self.repeated_headers, "left out # repeated header{s}"),
            bad,
            self.encoding.map(|name| format!("read the text as {name}")),
            self.order
                .as_ref()
                .map(|order| format!("took dates as {order}")),
            zone.map(|zone| format!("took times in {zone}, from the name of their column")),
            many(self.unsorted, "sorted # row{s} out of order"),
            many(self.repeated, "left out # duplicate row{s}"),
            many(
                self.folds,
                "resolved # ambiguous stamp{s} (clocks set back) by the order of rows",
            ),
        ];
        let columns = self.columns.iter().flat_map(ColumnRepairs::sentences);
        let commas = many(self.decimal_commas, "read # decimal comma{s}");
        at_first
            .into_iter()
            .flatten()
            .chain(columns)
            .chain(commas)
            .collect()
    }
}

impl ColumnRepairs {
    fn sentences(&self) -> Vec<String> {
        let name = &self.name;
        let missing = many(self.missing, "left out # cell{s} without a value");
        let outliers = many(self.outliers, "left out # outlier{s}");
        let cold = many(
            self.cold,
            "treated # value{s} below absolute zero as missing",
        );
        let counted = [missing, cold, outliers]
            .into_iter()
            .flatten()
            .map(|said| format!("{said} in `{name}`"));
        let unit = self
            .assumed_unit
            .map(|unit| format!("read `{name}` in {unit}"));
        let means = self.averaged.as_ref().map(|time| {
            format!(
                "took `{name}` as means over the {time} before each stamp, from its name; set `averaged = 0` \
                    if they are instantaneous"
            )
        });
        counted
            .chain(self.odd.clone())
            .chain(unit)
            .chain(means)
            .collect()
    }
}
