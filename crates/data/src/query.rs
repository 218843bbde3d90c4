//! Which columns of a file are wanted, and the layout of the file.

use super::unit::ColumnQuantity;

/// The order of day, month and year in a date.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DateOrder {
    /// 2015-08-13.
    YearMonthDay,
    /// 13.08.2015.
    DayMonthYear,
    /// 8/13/2015.
    MonthDayYear,
}

impl DateOrder {
    /// All orders, with the words for them.
    pub const WORDS: [(&'static str, DateOrder); 3] = [
        ("ymd", DateOrder::YearMonthDay),
        ("dmy", DateOrder::DayMonthYear),
        ("mdy", DateOrder::MonthDayYear),
    ];

    /// The word for this order.
    pub fn word(self) -> &'static str {
        Self::WORDS
            .iter()
            .find(|(_, order)| *order == self)
            .map_or("", |(word, _)| word)
    }

    /// The order that a word stands for.
    pub fn from_word(word: &str) -> Option<Self> {
        Self::WORDS
            .iter()
            .find(|(name, _)| name.eq_ignore_ascii_case(word.trim()))
            .map(|(_, order)| *order)
    }
}

/// How a remedy names an option: as a key of a scenario, a flag of a command, or an argument in
/// Python.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Wording {
    /// `zone = "UTC"`
    #[default]
    Key,
    /// `--zone UTC`
    Flag,
    /// `--temperature-zone UTC`, for a separate file of temperatures.
    TemperatureFlag,
    /// `zone="UTC"`
    Argument,
}

impl Wording {
    /// An option of the layout with a value.
    pub(super) fn option(self, name: &str, value: &str) -> String {
        match self {
            Wording::Key if name == "time" => format!("`time = {}`", text(value)),
            Wording::Key => format!("`{name} = {}`", literal(value)),
            // A file of temperatures has these options of the other file, or no own ones.
            Wording::TemperatureFlag if ["zone", "outliers", "decimal"].contains(&name) => {
                flag(name, value)
            }
            Wording::Flag => flag(name, value),
            Wording::TemperatureFlag => flag(&format!("temperature-{name}"), value),
            Wording::Argument => format!("`{name}={}`", literal(value)),
        }
    }

    /// The option that leaves out lines that cannot be read.
    pub(super) fn skip_bad(self) -> &'static str {
        match self {
            Wording::Key => "`skip_bad = true`",
            Wording::Flag | Wording::TemperatureFlag => "`--skip-bad`",
            Wording::Argument => "`skip_bad=True`",
        }
    }

    /// The option that names the column of a quantity.
    pub(super) fn column(self, quantity: ColumnQuantity, name: &str) -> String {
        match self {
            Wording::Key if quantity == ColumnQuantity::Input => {
                format!("`column = {}`", text(name))
            }
            Wording::Key => format!("`value = {}`", text(name)),
            Wording::Argument => format!("`{}={}`", quantity.word(), literal(name)),
            _ => flag(quantity.word(), name),
        }
    }

    /// The option that gives the unit of a quantity.
    pub(super) fn unit(self, quantity: ColumnQuantity, unit: &str) -> String {
        match self {
            Wording::Key => format!("`unit = {}`", literal(unit)),
            Wording::Argument => format!("`{}_unit={}`", quantity.word(), literal(unit)),
            _ => format!("`--{}-unit {unit}`", quantity.word()),
        }
    }
}

/// A value as TOML and Python write it.
fn literal(value: &str) -> String {
    if value.parse::<u64>().is_ok() {
        value.to_string()
    } else {
        text(value)
    }
}

/// A text as TOML and Python write it.
fn text(value: &str) -> String {
    format!("\"{}\"", value.replace('\\', "\\\\").replace('"', "\\\""))
}

/// A flag with its value as a shell takes it. A value that begins with a dash is joined to its flag.
fn flag(name: &str, value: &str) -> String {
    let is_plain = |c: char| c.is_alphanumeric() || "_-.,:/+=".contains(c);
    let quoted = if !value.is_empty() && value.chars().all(is_plain) {
        value.to_string()
    } else {
        format!("'{}'", value.replace('\'', r"'\''"))
    };
    let between = if value.starts_with('-') { '=' } else { ' ' };
    format!("`--{name}{between}{quoted}`")
}

/// The layout of a file, where the file itself does not determine it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Layout {
    /// The name of the column of times, or those of dates and of times of day, or of years, days of
    /// the year and times of day, with commas between them. Without it, the column is found by usual names such as `time`,
    /// `Timestamp` or `Date/Time`.
    pub time: Option<String>,
    /// The time zone of stamps, if neither they nor the name of their column give it: an IANA name,
    /// or an offset such as `+01:00`.
    pub zone: Option<String>,
    /// The order of day, month and year. Without it, dates begin with a year of four digits, or
    /// the whole column decides.
    pub dates: Option<DateOrder>,
    /// The number of lines before the line that names the columns. Without it, that is the first
    /// line with the names that are wanted.
    pub skip: Option<u64>,
    /// Numbers and words that mark a missing value, in addition to the usual ones.
    pub missing: Vec<String>,
    /// Whether lines that cannot be read are left out and counted, if they are few.
    pub skip_bad: bool,
    /// Whether `time` and `dates` belong to another file, and apply to this one only if they fit.
    pub is_of_other_file: bool,
    /// Limit beyond which outliers are left out, in standard deviations of the differences from
    /// neighbours. Without it, all values are kept.
    pub outliers: Option<u64>,
    /// The decimal mark, a point or a comma; the other one then separates thousands. Without it,
    /// the mark is inferred from all numbers of the file.
    pub decimal: Option<char>,
    /// The averaging time of each value in seconds, ending at its time; 0 for instantaneous values.
    /// Without it, the name of the column decides.
    pub averaged: Option<u64>,
    /// The time between the values of an input that has no column of times, in seconds.
    pub step: Option<f64>,
    /// How remedies name these options.
    pub wording: Wording,
}

impl Layout {
    /// A file whose column of times has this name.
    pub fn timed(time: &str) -> Self {
        Layout {
            time: Some(time.to_string()),
            ..Layout::default()
        }
    }

    /// This layout, completed by the options of another one. The wording of remedies is that of
    /// this one.
    pub fn over(self, other: &Layout) -> Self {
        Layout {
            time: self.time.or_else(|| other.time.clone()),
            zone: self.zone.or_else(|| other.zone.clone()),
            dates: self.dates.or(other.dates),
            skip: self.skip.or(other.skip),
            missing: if self.missing.is_empty() {
                other.missing.clone()
            } else {
                self.missing
            },
            skip_bad: self.skip_bad || other.skip_bad,
            is_of_other_file: self.is_of_other_file,
            outliers: self.outliers.or(other.outliers),
            decimal: self.decimal.or(other.decimal),
            averaged: self.averaged.or(other.averaged),
            step: self.step.or(other.step),
            wording: self.wording,
        }
    }
}

/// A column of values.
#[derive(Clone, Copy, Debug)]
pub struct Wanted<'a> {
    /// How the column is found.
    pub column: Name<'a>,
    /// What it measures, which decides the units that are allowed.
    pub quantity: ColumnQuantity,
    /// Its unit, if its name does not give it.
    pub unit: Option<&'a str>,
    /// The longest time allowed between two values, in the unit of the times; `None` for no limit.
    pub max_gap: Option<f64>,
    /// As in [`Layout::averaged`], for this column.
    pub averaged: Option<u64>,
}

impl<'a> Wanted<'a> {
    /// The values of a quantity in the column of this name, or, without a name, in the one whose
    /// name begins with that of the quantity.
    pub fn of(quantity: ColumnQuantity, column: Option<&'a str>, unit: Option<&'a str>) -> Self {
        Wanted::called(quantity, column, quantity.word(), unit)
    }

    /// The same, with another word for the quantity in the name of a column.
    pub fn called(
        quantity: ColumnQuantity,
        column: Option<&'a str>,
        word: &'a str,
        unit: Option<&'a str>,
    ) -> Self {
        let column = column.map_or(Name::Beginning(word), Name::Exactly);
        Wanted {
            column,
            quantity,
            unit,
            max_gap: None,
            averaged: None,
        }
    }
}

/// How a column is found in the header.
#[derive(Clone, Copy, Debug)]
pub enum Name<'a> {
    /// The column of this name.
    Exactly(&'a str),
    /// The only column whose name begins with this text, or else with its first four letters.
    Beginning(&'a str),
    /// All columns that hold no times.
    Every,
}

impl Name<'_> {
    /// The description of such a column in messages.
    pub(super) fn description(&self) -> String {
        match self {
            Name::Exactly(name) => format!("is called `{name}`"),
            Name::Beginning(start) => format!("has a name that begins with `{start}`"),
            Name::Every => "holds values".into(),
        }
    }
}
