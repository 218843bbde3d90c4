//! Text with italics, indices and powers, whose size is known before it is placed.

use super::face::Face;

/// A part of a label with letters of one typeface and size.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Letters {
    pub face: Face,
    /// The size of the letters, in units of the size of the label.
    pub size: f64,
    /// The position of its beginning, in units of the size of the label, with y pointing up.
    pub at: [f64; 2],
    pub text: String,
}

/// A line of text. Positions and widths are in units of the size that it is drawn in.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Label {
    pub(super) runs: Vec<Letters>,
    width: f64,
}

/// The size of an index or a power.
const SMALL: f64 = 0.72;
/// How far an index is below the base line (`DROP`), and a power above it (`RAISE`).
const DROP: f64 = 0.20;
const RAISE: f64 = 0.36;

/// How far letters extend above the base line (`TALL`), and below it (`DEEP`).
const TALL: f64 = 0.74;
const DEEP: f64 = 0.16;

/// A label from a text with marks: `*x*` is italic, `**A**` bold, `_{1}` an index, `^{2}` a power. An
/// index and a power that follow each other are placed one above the other.
impl<T: AsRef<str>> From<T> for Label {
    fn from(marked: T) -> Self {
        let mut label = Label::default();
        let (mut face, mut rest) = (Face::Regular, marked.as_ref());
        // The position of an index or a power above or below which the next one may be placed.
        let mut stack: Option<f64> = None;
        while let Some(c) = rest.chars().next() {
            let script = [("_{", -DROP), ("^{", RAISE)]
                .into_iter()
                .find_map(|(mark, shift)| {
                    let (inside, after) = rest.strip_prefix(mark)?.split_once('}')?;
                    Some((inside, shift, after))
                });
            if let Some((inside, shift, after)) = script {
                let start = stack.take();
                let width = label.width;
                let from = start.unwrap_or(width);
                label.push(face, SMALL, [from, shift], inside);
                label.width = label.width.max(width);
                stack = start.is_none().then_some(from);
                rest = after;
            } else if let Some(after) = rest.strip_prefix("**") {
                face = if face == Face::Bold {
                    Face::Regular
                } else {
                    Face::Bold
                };
                rest = after;
            } else if let Some(after) = rest.strip_prefix('*') {
                face = if face == Face::Italic {
                    Face::Regular
                } else {
                    Face::Italic
                };
                rest = after;
            } else {
                let end = rest[c.len_utf8()..]
                    .find(['*', '_', '^'])
                    .map_or(rest.len(), |at| at + c.len_utf8());
                label.push(face, 1.0, [label.width, 0.0], &rest[..end]);
                stack = None;
                rest = &rest[end..];
            }
        }
        label
    }
}

impl Label {
    /// A label from a text without marks, such as one that a user wrote.
    pub fn verbatim(text: &str) -> Self {
        let mut label = Label::default();
        label.push(Face::Regular, 1.0, [0.0; 2], text);
        label
    }

    /// This label with another one behind it.
    pub fn and(mut self, other: impl Into<Label>) -> Self {
        let (shift, other) = (self.width, other.into());
        self.runs.extend(other.runs.into_iter().map(|run| Letters {
            at: [run.at[0] + shift, run.at[1]],
            ..run
        }));
        self.width += other.width;
        self
    }

    /// A label in bold letters, from a text without marks.
    pub fn bold(text: &str) -> Self {
        let mut label = Label::default();
        label.push(Face::Bold, 1.0, [0.0; 2], text);
        label
    }

    /// The width of the label, in units of its size.
    pub fn width(&self) -> f64 {
        self.width
    }

    /// How far the label extends above the base line, in units of its size.
    pub fn rise(&self) -> f64 {
        self.runs
            .iter()
            .map(|run| run.at[1].max(0.0) + TALL * run.size)
            .fold(0.0, f64::max)
    }

    /// How far the label extends below the base line, in units of its size.
    pub fn fall(&self) -> f64 {
        self.runs
            .iter()
            .map(|run| (-run.at[1]).max(0.0) + DEEP * run.size)
            .fold(0.0, f64::max)
    }

    /// The text without the marks, for readers who do not see the picture.
    pub fn words(&self) -> String {
        self.runs.iter().map(|run| run.text.as_str()).collect()
    }

    /// The label in rows that are at most this wide. Rows end at spaces, and a wider word has a row
    /// of its own.
    pub fn wrapped(&self, width: f64) -> Vec<Label> {
        let texts = self.runs.iter().flat_map(|run| {
            let mut end = run.at[0];
            run.text.split_inclusive(' ').map(move |text| {
                let x = end;
                end += run.size * run.face.width(text);
                (run, x, text)
            })
        });
        let texts: Vec<_> = texts.collect();
        let mut rows = vec![Label::default()];
        let mut start = 0.0;
        // A word ends at a space, even if its letters differ in face or size.
        for word in texts.split_inclusive(|(.., text)| text.ends_with(' ')) {
            let ((_, begin, _), (run, x, text)) = (word[0], word[word.len() - 1]);
            if begin > start && x + run.size * run.face.width(text.trim_end()) - start > width {
                rows.push(Label::default());
                start = begin;
            }
            for (run, x, text) in word {
                let row = rows.last_mut().expect("there is a row");
                row.push(run.face, run.size, [x - start, run.at[1]], text);
            }
        }
        rows
    }

    fn push(&mut self, face: Face, size: f64, at: [f64; 2], text: &str) {
        if !text.is_empty() {
            self.width = at[0] + size * face.width(text);
            self.runs.push(Letters {
                face,
                size,
                at,
                text: text.to_string(),
            });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_become_faces_and_shifts() {
        let label = Label::from("mean *x*_{1+½}^{2} (m)");
        let parts: Vec<_> = label
            .runs
            .iter()
            .map(|run| (run.face, run.text.as_str(), run.at[1]))
            .collect();
        assert_eq!(
            parts,
            [
                (Face::Regular, "mean ", 0.0),
                (Face::Italic, "x", 0.0),
                (Face::Regular, "1+½", -DROP),
                (Face::Regular, "2", RAISE),
                (Face::Regular, " (m)", 0.0)
            ]
        );
        // Index and power begin at the same place, and what follows begins behind the wider one.
        assert_eq!(label.runs[2].at[0], label.runs[3].at[0]);
        assert!(
            (label.runs[4].at[0] - label.runs[2].at[0] - SMALL * Face::Regular.width("1+½")).abs()
                < 1e-12
        );
        assert_eq!(label.words(), "mean x1+½2 (m)");
    }

    #[test]
    fn a_long_label_is_broken_at_spaces() {
        let label = Label::from("mean of *x*(*t*) over paths");
        let rows = label.wrapped(0.6 * label.width());
        let words: Vec<String> = rows.iter().map(Label::words).collect();
        assert_eq!(words, ["mean of x(t) ", "over paths"]);
        assert_eq!(rows[1].runs[0].at, [0.0; 2]);
        assert_eq!(label.wrapped(label.width()).len(), 1);
        let unit = Label::from("density (10^{-4}\u{a0}s/m)");
        let rows = unit.wrapped(0.8 * unit.width());
        assert_eq!(rows[0].words(), "density ", "a power is never separated");
    }

    #[test]
    fn what_a_user_wrote_has_no_marks() {
        assert_eq!(Label::verbatim("a_{b} *c*").words(), "a_{b} *c*");
        assert_eq!(
            Label::from("snake_case and 2 ^ 3").words(),
            "snake_case and 2 ^ 3"
        );
    }
}
