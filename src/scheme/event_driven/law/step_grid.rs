//! The times at which macro steps begin and end.
//!
//! All macro steps have one length, which follows from the scene and the tolerance. Where the
//! temperature or an input of g was measured, a macro step also ends at every sample, so that
//! neither has a kink inside a macro step. The time between two samples is divided into the
//! smallest number of equal macro steps that are not longer than this length.

use crate::model::usual_spacing;
use std::sync::Arc;

/// The division of time into macro steps.
#[derive(Clone, Debug)]
pub struct StepGrid {
    /// The length of most macro steps.
    pub length: f64,
    cuts: Option<Arc<Cuts>>,
}

/// The division of the time between samples into macro steps.
#[derive(Debug)]
struct Cuts {
    /// The times of the samples.
    times: Vec<f64>,
    /// The number of the macro step that begins at each sample.
    firsts: Vec<u64>,
}

/// One macro step: where it lies in time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MacroStepPlace {
    /// The time at which it begins.
    pub start: f64,
    /// The time at which it ends and the next macro step begins.
    pub end: f64,
    pub length: f64,
    /// The last sample before it or at its start.
    pub sample: f64,
}

impl StepGrid {
    /// All macro steps have this length.
    pub fn even(length: f64) -> Self {
        StepGrid { length, cuts: None }
    }

    /// Macro steps of at most this length, which also end at each of these times, two or more.
    pub fn cut(times: Vec<f64>, longest: f64) -> Self {
        let parts = |spacing: f64| (spacing / longest * (1.0 - SAME_LENGTH)).ceil().max(1.0);
        let mut firsts = vec![0];
        for pair in times.windows(2) {
            firsts.push(firsts[firsts.len() - 1] + parts(pair[1] - pair[0]) as u64);
        }
        let usual = usual_spacing(&times);
        StepGrid {
            length: usual / parts(usual),
            cuts: Some(Arc::new(Cuts { times, firsts })),
        }
    }

    /// Whether all macro steps have the same length.
    pub fn is_even(&self) -> bool {
        self.cuts.is_none()
    }

    /// The macro step with this number. After the last sample, macro steps go on with the length of
    /// those before it.
    pub fn place(&self, index: u64) -> MacroStepPlace {
        let Some(cuts) = &self.cuts else {
            let (start, end) = (index as f64 * self.length, (index + 1) as f64 * self.length);
            return MacroStepPlace {
                start,
                end,
                length: self.length,
                sample: 0.0,
            };
        };
        let Cuts { times, firsts } = cuts.as_ref();
        let piece = firsts
            .partition_point(|first| *first <= index)
            .clamp(1, firsts.len() - 1)
            - 1;
        let (from, to) = (times[piece], times[piece + 1]);
        let (done, parts) = (index - firsts[piece], firsts[piece + 1] - firsts[piece]);
        let length = (to - from) / parts as f64;
        // The last macro step before a sample ends exactly at the sample.
        let at = |part: u64| {
            if part == parts {
                to
            } else {
                from + part as f64 * length
            }
        };
        MacroStepPlace {
            start: at(done),
            end: at(done + 1),
            length,
            sample: from,
        }
    }
}

/// Two lengths whose relative difference is smaller than this differ only by the rounding of the
/// times from which they were computed.
pub const SAME_LENGTH: f64 = 1e-9;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn macro_steps_end_at_samples_and_cover_all_times() {
        let grid = StepGrid::cut(vec![0.0, 1.0, 1.3, 2.3, 3.3], 0.4);
        let mut at = 0.0;
        for index in 0..10 {
            let place = grid.place(index);
            assert_eq!(place.start, at, "{index}");
            assert!(place.length <= 0.4 && (place.end - place.start - place.length).abs() < 1e-15);
            at = place.end;
        }
        assert_eq!(at, 3.3);
        // The four intervals between samples have 3, 1, 3 and 3 macro steps.
        assert_eq!(
            [2, 3, 6, 9].map(|index| grid.place(index).end),
            [1.0, 1.3, 2.3, 3.3]
        );
        assert_eq!(
            [0, 2, 3, 4, 9, 10].map(|index| grid.place(index).sample),
            [0.0, 0.0, 1.0, 1.3, 2.3, 2.3]
        );
        assert_eq!((grid.length, grid.is_even()), (1.0 / 3.0, false));
        assert_eq!(grid.place(10).start, 3.3);
        // Ten minutes are filled by three macro steps of 200 s.
        assert_eq!(StepGrid::cut(vec![0.0, 600.0], 200.0).length, 200.0);
        assert_eq!(
            StepGrid::even(0.5).place(7),
            MacroStepPlace {
                start: 3.5,
                end: 4.0,
                length: 0.5,
                sample: 0.0
            }
        );
    }
}
