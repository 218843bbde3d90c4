//! The source texts of a scenario: one file, and the overrides of a command line.

use super::Shipped;
use super::error::{Diagnostic, ScenarioError};
use super::keys::Key;
use super::overrides::Override;
use crate::model::{NamedSeries, RandomInput};
use std::cell::{Cell, RefCell};
use stickslip_text::excerpt::{short, underlined};

/// A range of bytes in one of the texts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Place {
    /// Which text: 0 is the file, i > 0 is override i - 1.
    pub text: usize,
    /// First byte.
    pub start: usize,
    /// One past the last byte.
    pub end: usize,
}

/// The texts, and the errors found in them so far.
pub(super) struct Sources<'a> {
    /// The name of the file in messages.
    pub name: &'a str,
    /// The text of the file.
    pub text: &'a str,
    /// The overrides that are applied to it.
    pub overrides: &'a [Override],
    /// Where measured values come from.
    pub measured_from: MeasuredFrom<'a>,
    /// The shipped scenario whose text this is, with the data files that are built into the
    /// program. None for the text of a user, whose data files are read from the disk.
    shipped: Option<&'a Shipped>,
    /// The errors found so far.
    diagnostics: RefCell<Vec<Diagnostic>>,
    /// Whether an invalid value was replaced by a valid one.
    has_stand_in: Cell<bool>,
    /// The parameters of all expressions, which numbers may name.
    parameters: RefCell<Vec<(String, f64)>>,
    /// The keys whose numbers name a parameter, with its name.
    named: RefCell<Vec<(String, String)>>,
    /// Whether the unit of time is the second.
    is_in_seconds: Cell<bool>,
}

/// Sources of measured values, each by the name of the table that describes it.
#[derive(Clone, Copy)]
pub(super) enum MeasuredFrom<'a> {
    /// From the files that the text names.
    Files,
    /// From values stored in the file of a run, as described by the text.
    Stored(&'a [NamedSeries]),
    /// From values that replace those of the text.
    Given(&'a [NamedSeries], &'a [RandomInput]),
}

impl<'a> Sources<'a> {
    pub fn new(
        name: &'a str,
        text: &'a str,
        overrides: &'a [Override],
        measured_from: MeasuredFrom<'a>,
    ) -> Self {
        let (diagnostics, has_stand_in, parameters, named, is_in_seconds) = Default::default();
        Sources {
            name,
            text,
            overrides,
            measured_from,
            shipped: None,
            diagnostics,
            has_stand_in,
            parameters,
            named,
            is_in_seconds,
        }
    }

    /// The same with the data files of a shipped scenario.
    pub fn of_shipped(self, shipped: &'a Shipped) -> Self {
        Sources {
            shipped: Some(shipped),
            ..self
        }
    }

    /// The text of the built-in data file of this name, if there is one.
    pub fn data(&self, file: &str) -> Option<&'static str> {
        self.shipped.and_then(|shipped| shipped.file(file))
    }

    /// Set the parameters, and whether the unit of time is the second.
    pub fn set_scope(&self, parameters: Vec<(String, f64)>, is_in_seconds: bool) {
        *self.parameters.borrow_mut() = parameters;
        self.is_in_seconds.set(is_in_seconds);
    }

    /// The seconds in a duration such as "6h", for a key of a time in seconds.
    pub fn duration(&self, key: Key, text: &str) -> Option<f64> {
        let is_duration = key.is_time() && self.is_in_seconds.get();
        is_duration.then(|| stickslip_data::seconds(text)).flatten()
    }

    /// The value of the parameter that the number at a key names, which is recorded; or all
    /// parameters, if it names none.
    pub fn named(&self, key: &str, name: &str) -> Result<f64, Vec<String>> {
        let parameters = self.parameters.borrow();
        let Some((_, value)) = parameters.iter().find(|(known, _)| known == name) else {
            return Err(parameters
                .iter()
                .map(|(known, _)| format!("\"{known}\""))
                .collect());
        };
        let (mut named, here) = (self.named.borrow_mut(), (key.to_string(), name.to_string()));
        // A key may be read more than once.
        if !named.contains(&here) {
            named.push(here);
        }
        Ok(*value)
    }

    /// The keys whose numbers name a parameter, with its name.
    pub fn all_named(&self) -> Vec<(String, String)> {
        self.named.borrow().clone()
    }

    /// Record that a value is missing or invalid; the reader continues with another value.
    pub fn report(&self, diagnostic: Box<Diagnostic>) {
        self.has_stand_in.set(true);
        let mut diagnostics = self.diagnostics.borrow_mut();
        // A table may be opened more than once, so the same error may be reported again.
        if !diagnostics.contains(&diagnostic) {
            diagnostics.push(*diagnostic);
        }
    }

    /// The value, or `None` with its error recorded.
    pub fn or_report<T>(&self, read: Result<T, Box<Diagnostic>>) -> Option<T> {
        read.map_err(|diagnostic| self.report(diagnostic)).ok()
    }

    /// Record inconsistent values. This is ignored if an invalid value was replaced, because the
    /// check is then meaningless.
    pub fn report_check_error(&self, diagnostic: Diagnostic) {
        if !self.has_stand_in.get() {
            self.diagnostics.borrow_mut().push(diagnostic);
        }
    }

    /// The value that was read if no error was found; otherwise all errors, in the order of the
    /// file.
    pub fn outcome<T>(&self, read: T) -> Result<T, ScenarioError> {
        let mut found = self.diagnostics.take();
        found.sort_by_key(|diagnostic| {
            (
                diagnostic.line.is_none(),
                diagnostic.line,
                diagnostic.column,
            )
        });
        if found.is_empty() {
            Ok(read)
        } else {
            Err(ScenarioError::Invalid(found))
        }
    }
}

impl Sources<'_> {
    /// The override that a place is in; `None` if it is in the file.
    pub fn override_at(&self, place: Place) -> Option<&Override> {
        place
            .text
            .checked_sub(1)
            .and_then(|i| self.overrides.get(i))
    }

    /// Whether a place is in an override.
    pub fn is_override(&self, place: Option<Place>) -> bool {
        place.is_some_and(|place| self.override_at(place).is_some())
    }

    /// An error at a place, or of the file as a whole.
    pub fn diagnostic(
        &self,
        place: Option<Place>,
        problem: impl Into<String>,
        remedy: impl Into<String>,
    ) -> Box<Diagnostic> {
        let origin = match place.and_then(|p| self.override_at(p)) {
            Some(o) => o.shown.clone(),
            None => self.name.to_string(),
        };
        let mut diagnostic = Diagnostic {
            origin,
            problem: problem.into(),
            remedy: remedy.into(),
            ..Diagnostic::default()
        };
        if let Some((line, column, excerpt)) = place.and_then(|p| self.excerpt(p)) {
            (diagnostic.line, diagnostic.column, diagnostic.excerpt) =
                (Some(line), Some(column), Some(excerpt));
        }
        diagnostic.into()
    }

    /// The place of a part of a string in the file whose content is `text`; none if escapes hide
    /// it, or in an override.
    pub fn within(&self, place: Place, text: &str, part: std::ops::Range<usize>) -> Option<Place> {
        let raw = self
            .text
            .get(place.start..place.end)
            .filter(|_| place.text == 0)?;
        let start = place.start + raw.find(text).filter(|_| !text.is_empty())?;
        Some(Place {
            text: 0,
            start: start + part.start,
            end: start + part.end,
        })
    }

    /// The text at a place, cut to one short line. For an override this is its whole value.
    pub fn quote(&self, place: Place) -> String {
        let raw = match self.override_at(place) {
            Some(o) => o.value.as_str(),
            None => self.text.get(place.start..place.end).unwrap_or(""),
        };
        let line = short(raw.lines().next().unwrap_or(""));
        if raw.contains('\n') && !line.ends_with("...") {
            line + "..."
        } else {
            line
        }
    }

    /// A place in the file: its line and its column, counted from 1, and the line with a caret
    /// under the place.
    fn excerpt(&self, place: Place) -> Option<(usize, usize, String)> {
        if place.text > 0 {
            return None;
        }
        let start = floor_boundary(self.text, place.start);
        let line_start = self.text[..start].rfind('\n').map_or(0, |i| i + 1);
        let line_end = self.text[start..]
            .find('\n')
            .map_or(self.text.len(), |i| start + i);
        let line = self.text[..line_start].matches('\n').count() + 1;
        let content = self.text[line_start..line_end].trim_end_matches('\r');
        let before = &self.text[line_start..start];
        let marked = &self.text[start..floor_boundary(self.text, place.end.clamp(start, line_end))];
        let column = before.chars().count() + 1;
        let [content, carets] = underlined(content, column - 1, marked.trim_end().chars().count());
        let margin = line.to_string();
        let drawing = format!(
            "{0:1$} |\n{margin} | {content}\n{0:1$} | {carets}",
            "",
            margin.len()
        );
        Some((line, column, drawing))
    }
}

/// The last character boundary at or before `index`.
fn floor_boundary(text: &str, index: usize) -> usize {
    (0..=index.min(text.len()))
        .rev()
        .find(|&i| text.is_char_boundary(i))
        .unwrap_or(0)
}
