//! A part that is drawn by itself: a figure, or one of its panels.

use super::{Absent, Drawing, Figure, Style, Subject};
use std::fmt;

/// A figure, e.g. `sticks`, or one of its panels, e.g. `sticks.B`.
#[derive(Clone, Copy, Debug)]
pub struct Only {
    /// The figure.
    pub figure: &'static Figure,
    /// The letter of the panel.
    panel: Option<char>,
}

/// What people call a panel, and its name.
const CALLED: [(&str, &str); 3] = [
    ("histogram", "`sticks.A`"),
    ("phase", "the last panel of `path`"),
    ("survival", "`sticks.B`"),
];

impl Only {
    /// The names of figures, separated by commas.
    pub fn names(figures: impl Iterator<Item = &'static Figure>) -> String {
        figures
            .map(|figure| figure.name)
            .collect::<Vec<_>>()
            .join(", ")
    }

    /// The part of one of these figures with this name.
    ///
    /// # Errors
    ///
    /// The message says which names there are.
    pub fn named(
        text: &str,
        mut figures: impl Iterator<Item = &'static Figure> + Clone,
    ) -> Result<Only, String> {
        let all = figures.clone();
        let (name, panel) = text
            .split_once('.')
            .map_or((text, None), |(name, panel)| (name, Some(panel)));
        let Some(figure) = figures.find(|figure| figure.name == name) else {
            return Err(match CALLED.iter().find(|(word, _)| *word == name) {
                Some((_, panel)) => format!("did you mean {panel}?"),
                None => format!("unknown figure; use one of {}", Only::names(all)),
            });
        };
        let letter = |panel: &str| panel.parse().ok().filter(char::is_ascii_uppercase);
        match panel.map(letter) {
            Some(None) => Err(format!(
                "panels are named by capital letters, e.g. {name}.A"
            )),
            panel => Ok(Only {
                figure,
                panel: panel.flatten(),
            }),
        }
    }

    /// Draws the part.
    ///
    /// # Errors
    ///
    /// [`Absent`] says why this subject has no such figure, or which panels the figure has.
    pub fn draw(&self, subject: &Subject, style: &Style) -> Result<Drawing, Absent> {
        let mut sheet = (self.figure.draws)(subject, style)?;
        if let Some(letter) = self.panel {
            sheet = sheet
                .only(letter)
                .map_err(|others| Absent::Panel(letter, others))?;
        }
        Ok(sheet.alone(style))
    }
}

impl fmt::Display for Only {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.figure.name)?;
        self.panel.map_or(Ok(()), |letter| write!(f, ".{letter}"))
    }
}
