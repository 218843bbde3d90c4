//! Where cells begin and end.
//!
//! Cells have one length, which follows from the scene and the tolerance. Where the temperature was
//! measured, a cell also ends at every sample, so that B is a straight line in each: the time
//! between two samples is parted into as few equal cells as that length allows.

use crate::model::Series;
use std::sync::Arc;

/// Where cells begin and end.
#[derive(Clone, Debug)]
pub struct Ladder {
    /// How long most cells are.
    length: f64,
    cuts: Option<Arc<Cuts>>,
}

/// The cells between samples.
#[derive(Debug)]
struct Cuts {
    /// When the samples are.
    times: Vec<f64>,
    /// The cell that begins at each of them.
    firsts: Vec<u64>,
}

/// One cell of a ladder.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rung {
    /// When it begins.
    pub start: f64,
    /// When it ends, and the next one begins.
    pub end: f64,
    pub length: f64,
    /// The piece of the series that it lies on.
    pub piece: usize,
}

impl Ladder {
    /// All cells have this length.
    pub fn even(length: f64) -> Self {
        Ladder { length, cuts: None }
    }

    /// Cells of at most this length, cut at samples.
    pub fn cut(series: &Series, longest: f64) -> Self {
        let times = series.times().to_vec();
        let parts = |spacing: f64| (spacing / longest * (1.0 - ALIGNMENT)).ceil().max(1.0);
        let mut firsts = vec![0];
        for pair in times.windows(2) {
            firsts.push(firsts[firsts.len() - 1] + parts(pair[1] - pair[0]) as u64);
        }
        let usual = series.usual_spacing();
        Ladder { length: usual / parts(usual), cuts: Some(Arc::new(Cuts { times, firsts })) }
    }

    /// How long most cells are.
    pub fn length(&self) -> f64 {
        self.length
    }

    /// Whether all cells have that length.
    pub fn is_even(&self) -> bool {
        self.cuts.is_none()
    }

    /// The cell with this number. Behind the last sample cells go on as they were.
    pub fn rung(&self, index: u64) -> Rung {
        let Some(cuts) = &self.cuts else {
            let (start, end) = (index as f64 * self.length, (index + 1) as f64 * self.length);
            return Rung { start, end, length: self.length, piece: 0 };
        };
        let Cuts { times, firsts } = cuts.as_ref();
        let piece = firsts.partition_point(|first| *first <= index).clamp(1, firsts.len() - 1) - 1;
        let (from, to) = (times[piece], times[piece + 1]);
        let (done, parts) = (index - firsts[piece], firsts[piece + 1] - firsts[piece]);
        let length = (to - from) / parts as f64;
        // The last cell before a sample ends where the sample is.
        let at = |part: u64| if part == parts { to } else { from + part as f64 * length };
        Rung { start: at(done), end: at(done + 1), length, piece }
    }
}

/// Relative difference of two lengths that is rounding of the times they come from.
const ALIGNMENT: f64 = 1e-9;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_end_at_samples_and_leave_no_time_out() {
        let series = Series::new(vec![0.0, 1.0, 1.3, 2.3, 3.3], vec![0.0; 5]).unwrap();
        let ladder = Ladder::cut(&series, 0.4);
        let mut at = 0.0;
        for index in 0..10 {
            let rung = ladder.rung(index);
            assert_eq!(rung.start, at, "{index}");
            assert!(rung.length <= 0.4 && (rung.end - rung.start - rung.length).abs() < 1e-15);
            at = rung.end;
        }
        assert_eq!(at, 3.3);
        // 3, 1, 3 and 3 cells.
        assert_eq!([2, 3, 6, 9].map(|index| ladder.rung(index).end), [1.0, 1.3, 2.3, 3.3]);
        assert_eq!([0, 2, 3, 4, 9, 10].map(|index| ladder.rung(index).piece), [0, 0, 1, 2, 3, 3]);
        assert_eq!((ladder.length(), ladder.is_even()), (1.0 / 3.0, false));
        assert_eq!(ladder.rung(10).start, 3.3);
        // Ten minutes that three cells of 200 s fill.
        assert_eq!(Ladder::cut(&Series::new(vec![0.0, 600.0], vec![0.0; 2]).unwrap(), 200.0).length(), 200.0);
        assert_eq!(Ladder::even(0.5).rung(7), Rung { start: 3.5, end: 4.0, length: 0.5, piece: 0 });
    }
}
