//! One axis of a sweep: a key of the scenario, and the values that it takes.

use crate::scenario::{INPUT, TEMPERATURE_SERIES};
use std::fmt;
use std::ops::Range;
use stickslip_text::excerpt::underlined;
use stickslip_text::numbers::tidy;

/// Largest number of points of a sweep.
pub const MOST_POINTS: usize = 100_000;

/// A key of the scenario with the values that it takes.
///
/// ```
/// use stickslip::study::sweep::SweepAxis;
///
/// let rho = SweepAxis::parse("rho=temperature.noise.intensity=0:1:5", |_| None)?;
/// assert_eq!((rho.name.as_str(), rho.values), ("rho", vec![0.0, 0.25, 0.5, 0.75, 1.0].into()));
/// let thresholds = SweepAxis::parse("friction.static=log:1:100:3", |_| Some("f_s".to_string()))?;
/// assert_eq!((thresholds.name.as_str(), thresholds.values), ("f_s", vec![1.0, 10.0, 100.0].into()));
/// let records = SweepAxis::parse("input.ag.file=a.at2,b.at2", |_| None)?;
/// assert_eq!((records.name.as_str(), records.values.to_string()), ("input_ag_file", "a.at2, b.at2".into()));
/// assert!(SweepAxis::parse("friction.static=1:2", |_| None).is_err());
/// # Ok::<(), stickslip::study::sweep::AxisError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct SweepAxis {
    /// The name of its dimension in the file: a letter, then letters, digits and underscores.
    pub name: String,
    /// The dotted key of the scenario.
    pub key: String,
    /// Its values, all different.
    pub values: AxisValues,
}

/// The values that a key takes.
#[derive(Clone, Debug, PartialEq)]
pub enum AxisValues {
    /// Numbers.
    Numbers(Vec<f64>),
    /// Files of measured values, as the scenario would name them.
    Files(Vec<String>),
}

impl AxisValues {
    /// Number of values.
    #[expect(clippy::len_without_is_empty, reason = "an axis has values")]
    pub fn len(&self) -> usize {
        match self {
            AxisValues::Numbers(numbers) => numbers.len(),
            AxisValues::Files(files) => files.len(),
        }
    }

    /// One of the values.
    pub fn at(&self, i: usize) -> AxisValue {
        match self {
            AxisValues::Numbers(numbers) => AxisValue::Number(numbers[i]),
            AxisValues::Files(files) => AxisValue::File(files[i].clone()),
        }
    }

    /// The numbers, or the positions 0, 1, 2, ... of files.
    pub fn positions(&self) -> Vec<f64> {
        match self {
            AxisValues::Numbers(numbers) => numbers.clone(),
            AxisValues::Files(files) => (0..files.len()).map(|i| i as f64).collect(),
        }
    }
}

impl From<Vec<f64>> for AxisValues {
    fn from(numbers: Vec<f64>) -> Self {
        AxisValues::Numbers(numbers)
    }
}

/// Writes the values, separated by commas.
impl fmt::Display for AxisValues {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let values = (0..self.len()).map(|i| self.at(i).to_string());
        f.write_str(&values.collect::<Vec<_>>().join(", "))
    }
}

/// The value of a key at a point of a sweep.
#[derive(Clone, Debug, PartialEq)]
pub enum AxisValue {
    /// A number.
    Number(f64),
    /// A file of measured values.
    File(String),
}

/// Writes the number with all digits, or the name of the file.
impl fmt::Display for AxisValue {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            AxisValue::Number(number) => write!(f, "{number:?}"),
            AxisValue::File(file) => f.write_str(file),
        }
    }
}

/// The table whose file a key names, such as `input.ag` for `input.ag.file`; `None` for other keys.
pub fn table_of_file(key: &str) -> Option<&str> {
    let table = key.strip_suffix(".file")?;
    (table == TEMPERATURE_SERIES || table.starts_with(INPUT)).then_some(table)
}

/// Why a text does not describe an axis, and which part of it is wrong.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AxisError {
    /// The text.
    pub text: String,
    /// The range of bytes that is wrong.
    pub at: Range<usize>,
    /// What is wrong with them.
    pub problem: String,
    /// The remedy.
    pub remedy: String,
}

impl std::error::Error for AxisError {}

/// Writes the problem, the text with a caret, and the remedy.
impl fmt::Display for AxisError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let before = self.text.get(..self.at.start).unwrap_or("").chars().count();
        let marked = self
            .text
            .get(self.at.clone())
            .unwrap_or("")
            .chars()
            .count()
            .max(1);
        let line: String = self
            .text
            .chars()
            .map(|c| if c.is_control() { ' ' } else { c })
            .collect();
        let [line, carets] = underlined(&line, before, marked);
        writeln!(f, "{}", self.problem)?;
        writeln!(f, "  {line}\n  {carets}")?;
        write!(f, "  fix: {}", self.remedy)
    }
}

/// The permitted forms of values.
const VALUES: &str = "write START:STOP:COUNT, log:START:STOP:COUNT, or values such as 0.1,0.2,0.5";
const FILES: &str =
    "write file names separated by commas, such as a.at2,b.at2, or a pattern such as *.at2";
const FILE_KEY: &str =
    "files are values of a key such as `input.ag.file`: write input.ag.file=a.at2,b.at2";

impl SweepAxis {
    /// Read `[NAME=]KEY=VALUES`. The values are `START:STOP:COUNT` (evenly spaced),
    /// `log:START:STOP:COUNT` (evenly spaced in the logarithm) or a list. Without a name, the axis
    /// is called by the `symbol` of its key, or by the key with underscores in place of dots. The
    /// values of a grid are rounded to twelve digits, so that they are short enough to type.
    pub fn parse(
        text: &str,
        symbol: impl Fn(&str) -> Option<String>,
    ) -> Result<SweepAxis, AxisError> {
        let whole = TextPart {
            whole: text,
            at: 0..text.len(),
        };
        let parts = whole.split('=');
        let (name, key, values) = match parts.as_slice() {
            [key, values] => (None, key.trimmed(), values.trimmed()),
            [name, key, values] => (Some(name.trimmed()), key.trimmed(), values.trimmed()),
            [.., last] if parts.len() > 3 => return Err(last.wrong("more than two `=`", WRITTEN)),
            _ => return Err(whole.wrong("missing `=`", WRITTEN)),
        };
        if key.text().is_empty() {
            return Err(key.wrong("missing key", WRITTEN));
        }
        if let Some(name) = name.as_ref().filter(|name| !is_name(name.text())) {
            let problem = format!("`{}` is not a valid name of a dimension", name.text());
            return Err(name.wrong(
                &problem,
                "a letter, then letters, digits and underscores, such as rho",
            ));
        }
        let key = key.text().to_string();
        let values = match table_of_file(&key) {
            Some(_) => AxisValues::Files(files(&values)?),
            None => AxisValues::Numbers(numbers(&values)?),
        };
        let own = || {
            symbol(&key)
                .filter(|symbol| is_name(symbol))
                .unwrap_or_else(|| plain(&key))
        };
        let name = name.map_or_else(own, |name| name.text().to_string());
        Ok(SweepAxis { name, key, values })
    }
}

/// The form of an axis.
const WRITTEN: &str = "write [NAME=]KEY=VALUES, e.g. rho=temperature.noise.intensity=0:1:21 or friction.static=1.1,1.2,1.5";

/// Whether a text is a valid name of a dimension. Programs that read the file often use the name as
/// an identifier.
fn is_name(name: &str) -> bool {
    name.starts_with(|c: char| c.is_ascii_alphabetic())
        && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
}

fn plain(key: &str) -> String {
    key.chars()
        .map(|c| if c.is_ascii_alphanumeric() { c } else { '_' })
        .collect()
}

/// A part of the text, as a range of bytes.
#[derive(Clone, Debug)]
struct TextPart<'a> {
    whole: &'a str,
    at: Range<usize>,
}

impl<'a> TextPart<'a> {
    fn text(&self) -> &'a str {
        &self.whole[self.at.clone()]
    }

    fn split(&self, by: char) -> Vec<TextPart<'a>> {
        let mut start = self.at.start;
        let piece = |part: &str| {
            let at = start..start + part.len();
            start = at.end + by.len_utf8();
            TextPart {
                whole: self.whole,
                at,
            }
        };
        self.text().split(by).map(piece).collect()
    }

    fn trimmed(&self) -> TextPart<'a> {
        let text = self.text();
        let start = self.at.start + (text.len() - text.trim_start().len());
        TextPart {
            whole: self.whole,
            at: start..start + text.trim().len(),
        }
    }

    fn wrong(&self, problem: &str, remedy: &str) -> AxisError {
        AxisError {
            text: self.whole.to_string(),
            at: self.at.clone(),
            problem: problem.to_string(),
            remedy: remedy.to_string(),
        }
    }

    fn file(&self) -> Result<String, AxisError> {
        let file = self.text().trim();
        match file.is_empty() {
            true => Err(self.wrong("missing name of a file", FILES)),
            false => Ok(file.to_string()),
        }
    }

    fn number(&self) -> Result<f64, AxisError> {
        let number = self
            .text()
            .trim()
            .parse::<f64>()
            .ok()
            .filter(|x| x.is_finite());
        // The addition turns -0.0 into 0.0, because both are the same value.
        number.map(|x| x + 0.0).ok_or_else(|| {
            let text = self.text().trim();
            let ending = text.rsplit_once('.').map_or("", |(_, ending)| ending);
            let is_file = text.contains(['/', '*']) || ending.starts_with(char::is_alphabetic);
            let remedy = if is_file { FILE_KEY } else { VALUES };
            self.trimmed()
                .wrong(&format!("`{text}` is not a finite number"), remedy)
        })
    }
}

fn numbers(values: &TextPart<'_>) -> Result<Vec<f64>, AxisError> {
    if !values.text().contains(':') {
        return list(values, VALUES, TextPart::number);
    }
    let parts = values.split(':');
    match parts.as_slice() {
        [start, stop, count] => grid(start, stop, count, linear),
        [log, start, stop, count] if log.text().trim() == "log" => {
            if let Some(low) = [start, stop]
                .into_iter()
                .find(|end| end.number().is_ok_and(|x| x <= 0.0))
            {
                return Err(low.wrong(
                    "a logarithmic grid needs ends above 0",
                    "or write it without `log:`",
                ));
            }
            grid(start, stop, count, logarithmic)
        }
        [word, _, _, _] => Err(word.wrong(&format!("unknown grid `{}`", word.text()), VALUES)),
        _ => Err(values.wrong("no valid values", VALUES)),
    }
}

/// The files of a list of names and patterns.
fn files(values: &TextPart<'_>) -> Result<Vec<String>, AxisError> {
    let names = list(values, FILES, TextPart::file)?;
    let mut files: Vec<String> = Vec::new();
    for (part, name) in values.split(',').iter().zip(names) {
        let found = match name.contains('*') {
            true => matching(&name),
            false => vec![name],
        };
        if found.is_empty() {
            let remedy = "give names, or a pattern, relative to the current directory";
            return Err(part.wrong("no file matches this pattern", remedy));
        }
        let new = |file: &String| !files.contains(file);
        files.extend(found.into_iter().filter(new).collect::<Vec<_>>());
    }
    Ok(files)
}

/// The files that match a pattern, in order of their names. In the last part of its path, `*`
/// stands for any characters.
fn matching(pattern: &str) -> Vec<String> {
    let at = pattern.rfind('/').map_or(0, |slash| slash + 1);
    let (folder, pattern) = pattern.split_at(at);
    let entries = std::fs::read_dir(if folder.is_empty() { "." } else { folder });
    let names = entries.into_iter().flatten().flatten();
    let names = names.filter_map(|entry| entry.file_name().into_string().ok());
    let mut found: Vec<String> = names
        .filter(|name| is_like(name, pattern))
        .map(|name| format!("{folder}{name}"))
        .collect();
    found.sort();
    found
}

fn is_like(name: &str, pattern: &str) -> bool {
    let Some((start, rest)) = pattern.split_once('*') else {
        return name == pattern;
    };
    let is_rest = |name: &str| name.char_indices().any(|(i, _)| is_like(&name[i..], rest));
    let after = name.strip_prefix(start);
    after.is_some_and(|name| rest.is_empty() || is_rest(name))
}

fn list<'a, T: PartialEq + fmt::Display>(
    values: &TextPart<'a>,
    written: &str,
    read: impl Fn(&TextPart<'a>) -> Result<T, AxisError>,
) -> Result<Vec<T>, AxisError> {
    if values.text().is_empty() {
        return Err(values.wrong("no values given", written));
    }
    let mut list: Vec<T> = Vec::new();
    for part in values.split(',') {
        let value = read(&part)?;
        if list.contains(&value) {
            let problem = format!("{value} is listed twice");
            return Err(part.wrong(&problem, "list each value once"));
        }
        list.push(value);
    }
    Ok(list)
}

fn grid(
    start: &TextPart<'_>,
    stop: &TextPart<'_>,
    count: &TextPart<'_>,
    between: fn(f64, f64, f64) -> f64,
) -> Result<Vec<f64>, AxisError> {
    let (a, b) = (start.number()?, stop.number()?);
    let n = count
        .text()
        .trim()
        .parse::<usize>()
        .ok()
        .filter(|n| (2..=MOST_POINTS).contains(n))
        .ok_or_else(|| {
            let problem = format!(
                "`{}` must be a number of values from 2 to {MOST_POINTS}",
                count.text().trim()
            );
            count.wrong(&problem, VALUES)
        })?;
    let size = a.abs().max(b.abs());
    let value = |i: usize| match i {
        0 => a,
        i if i == n - 1 => b,
        i => {
            let x = between(a, b, i as f64 / (n - 1) as f64);
            // A value that would be zero but for rounding becomes zero.
            if x.abs() < ROUNDING * size && a * b < 0.0 {
                0.0
            } else {
                tidy(x)
            }
        }
    };
    let values: Vec<f64> = (0..n).map(value).collect();
    if values
        .windows(2)
        .all(|pair| (pair[0] < pair[1]) == (a < b) && pair[0] != pair[1])
    {
        return Ok(values);
    }
    let ends = TextPart {
        whole: start.whole,
        at: start.at.start..stop.at.end,
    };
    Err(ends.wrong(
        "the ends are too close for this number of values",
        "give ends further apart, or fewer values",
    ))
}

/// Values of a grid are rounded to this relative accuracy, twelve digits.
const ROUNDING: f64 = 1e-12;

fn linear(a: f64, b: f64, share: f64) -> f64 {
    // The form a + (b - a) share would overflow for some finite ends.
    a * (1.0 - share) + b * share
}

fn logarithmic(a: f64, b: f64, share: f64) -> f64 {
    libm::exp(linear(libm::log(a), libm::log(b), share))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn values(text: &str) -> Vec<f64> {
        let axis = SweepAxis::parse(&format!("k={text}"), |_| None).expect(text);
        axis.values.positions()
    }

    #[test]
    fn grids_are_what_a_person_would_write_down() {
        assert_eq!(values("0:1:6"), [0.0, 0.2, 0.4, 0.6, 0.8, 1.0]);
        assert_eq!(values("0.3:-0.3:7"), [0.3, 0.2, 0.1, 0.0, -0.1, -0.2, -0.3]);
        assert_eq!(values("log:1e-3:10:5"), [1e-3, 0.01, 0.1, 1.0, 10.0]);
        assert_eq!(values(" 3, 1e-2 ,-0 "), [3.0, 0.01, 0.0]);
        assert!(values("-0:1:2")[0].is_sign_positive());
        assert_eq!(values("-1e308:1e308:3"), [-1e308, 0.0, 1e308]);
    }

    #[test]
    fn a_name_is_the_one_given_or_the_symbol_or_the_key() {
        let name = |text: &str, symbol: Option<&str>| {
            let axis = SweepAxis::parse(text, |key| {
                symbol.filter(|_| key == "a.0.b").map(String::from)
            })
            .expect(text);
            assert_eq!(axis.key, "a.0.b");
            axis.name
        };
        assert_eq!(name("x=a.0.b=1", Some("rho")), "x");
        assert_eq!(name(" a.0.b =1", Some("rho")), "rho");
        assert_eq!(name("a.0.b=1", Some("v(0)")), "a_0_b");
        assert_eq!(name("a.0.b=1", None), "a_0_b");
    }

    /// The caret is under the part that is wrong.
    #[test]
    fn a_mistake_is_shown_where_it_is() {
        let cases = [
            ("rho", "rho", "missing `=`"),
            (
                "rho=temperature.noise.intensity=0:1:x",
                "x",
                "must be a number of values",
            ),
            (
                "rho=temperature.noise.intensity=0:1:1",
                "1",
                "must be a number of values",
            ),
            ("rho=k=0:one:5", "one", "not a finite number"),
            ("k=lag:1:2:5", "lag", "unknown grid"),
            ("k=log:0:2:5", "0", "above 0"),
            ("k=1:1:5", "1:1", "too close"),
            ("k=1,2,1", "1", "twice"),
            ("k=1,,2", "", "not a finite number"),
            ("k=nan", "nan", "not a finite number"),
            ("k=", "", "no values"),
            ("=1", "", "missing key"),
            ("2x=k=1", "2x", "not a valid name"),
            ("a=b=c=1", "1", "more than two"),
            ("k=1:2", "1:2", "no valid values"),
            ("input.ag.file=a,,b", "", "missing name"),
            ("input.ag.file=a,b, a", " a", "twice"),
            ("other.file=a", "a", "not a finite number"),
        ];
        for (text, wrong, problem) in cases {
            let error = SweepAxis::parse(text, |_| None).expect_err(text);
            assert_eq!(&text[error.at.clone()], wrong, "{text}: {error}");
            assert!(
                error.problem.contains(problem) && !error.remedy.is_empty(),
                "{text}: {error}"
            );
            let shown = error.to_string();
            let caret = shown.lines().nth(2).expect("a line of carets");
            assert_eq!(caret.find('^'), Some(2 + error.at.start), "{shown}");
        }
    }

    proptest! {
        #[test]
        fn any_text_is_an_axis_or_a_mistake_that_can_be_shown(text in "\\PC{0,40}|[a-z.=:,0-9 -]{0,24}") {
            match SweepAxis::parse(&text, |_| None) {
                Ok(axis) => prop_assert!(axis.values.len() > 0 && axis.values.positions().iter().all(|x| x.is_finite())),
                Err(error) => prop_assert!(error.to_string().contains("fix: ")),
            }
        }

        #[test]
        fn a_grid_goes_evenly_from_end_to_end(a in -1e3..1e3f64, width in 0.1..1e3f64, n in 2..50usize) {
            let grid = values(&format!("{a:?}:{:?}:{n}", a + width));
            prop_assert_eq!((grid.len(), grid[0], grid[n - 1]), (n, a, a + width));
            let step = width / (n - 1) as f64;
            prop_assert!(grid.windows(2).all(|pair| (pair[1] - pair[0] - step).abs() < 1e-8));
        }
    }
}
