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
    /// The order of day, month and year, if all dates together told it, and why it is this one.
    pub order: Option<String>,
    /// The zone that the name of the column of times says, where another one was given.
    pub zone: Option<String>,
    /// Number of rows that came after a row with a later time, and were sorted.
    pub unsorted: u64,
    /// Number of rows that repeated the time and the value of another row, and were left out.
    pub repeated: u64,
    /// Number of stamps in an hour that occurs twice; they were understood by the order of the
    /// rows.
    pub folds: u64,
    /// Number of numbers with a decimal comma.
    pub decimal_commas: u64,
    /// For each column, what was left out of it.
    pub columns: Vec<ColumnRepairs>,
}

/// What was left out of one column, and what was assumed of it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ColumnRepairs {
    /// The name of the column.
    pub name: String,
    /// Number of cells without a value.
    pub missing: u64,
    /// Number of temperatures that were left out, because they are below absolute zero in any unit.
    pub cold: u64,
    /// Number of values that were left out, as the layout says, because they differ strongly from
    /// those around them.
    pub outliers: u64,
    /// A value that stands out and was kept, in a sentence.
    pub odd: Option<String>,
    /// The unit that was assumed, because nothing says one.
    pub assumed_unit: Option<&'static str>,
    /// The time over which values were taken to be means, because the name of the column says so.
    pub averaged: Option<String>,
}

pub(super) fn many(count: u64, one: &str, more: &str) -> Option<String> {
    match count {
        0 => None,
        1 => Some(one.replace('#', "1")),
        _ => Some(more.replace('#', &count.to_string())),
    }
}

impl Repairs {
    /// The repairs as sentences that begin with the name of their file.
    pub fn of_file(&self, name: impl Display) -> Vec<String> {
        self.sentences()
            .iter()
            .map(|sentence| format!("{name}: {sentence}"))
            .collect()
    }

    /// The repairs as sentences; none if nothing was repaired.
    pub fn sentences(&self) -> Vec<String> {
        let at_first = [
            many(
                self.skipped,
                "skipped # line before the header",
                "skipped # lines before the header",
            ),
            many(
                self.unit_rows,
                "took # line below the header as units",
                "took # lines below the header as units and notes",
            ),
            many(
                self.repeated_headers,
                "left out # repeated header",
                "left out # repeated headers",
            ),
            self.bad.and_then(|(count, line)| {
                let one = format!("left out # line that cannot be read, line {line}");
                let more =
                    format!("left out # lines that cannot be read, the first is line {line}");
                many(count, &one, &more)
            }),
            self.encoding.map(|name| format!("read the text as {name}")),
            self.order
                .as_ref()
                .map(|order| format!("took dates as {order}")),
            self.zone
                .as_ref()
                .map(|zone| format!("took times in {zone}, from the name of their column")),
            many(
                self.unsorted,
                "sorted # row that was out of order",
                "sorted # rows that were out of order",
            ),
            many(
                self.repeated,
                "left out # duplicate row",
                "left out # duplicate rows",
            ),
            many(
                self.folds,
                "resolved # ambiguous stamp (clocks set back) by the order of rows",
                "resolved # ambiguous stamps (clocks set back) by the order of rows",
            ),
        ];
        let columns = self.columns.iter().flat_map(ColumnRepairs::sentences);
        let commas = many(
            self.decimal_commas,
            "read # decimal comma",
            "read # decimal commas",
        );
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
        let missing = many(
            self.missing,
            "left out # cell without a value",
            "left out # cells without a value",
        );
        let outliers = many(
            self.outliers,
            "left out # value that differs strongly from those around it",
            "left out # values that differ strongly from those around them",
        );
        let cold = many(
            self.cold,
            "treated # value below absolute zero as missing",
            "treated # values below absolute zero as missing",
        );
        let counted = [missing, cold, outliers]
            .into_iter()
            .flatten()
            .map(|said| format!("{said} in `{name}`"));
        let unit = self
            .assumed_unit
            .map(|unit| format!("unit of `{name}` not given; assuming {unit}"));
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
