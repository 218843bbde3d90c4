//! Stick durations and sub-phases as bars made of letters.

use crate::cli::numbers::{percent, significant};
use crate::cli::terminal::Letters;
use stick_slip::scenario::Units;
use stick_slip::stats::{Dimension, Distribution, SubPhaseCounts, Summary};

/// The length of the longest bar, in cells.
const CELLS: usize = 24;
/// The most rows of a table. All shorter durations share its first row.
const ROWS: usize = 16;
/// The shortest durations are put together in the first row until it would hold more than this
/// share of the sticks.
const FIRST: f64 = 0.005;

/// Both plots, for a terminal.
pub fn plots(summary: &Summary, units: &Units, letters: Letters) -> String {
    let unit = Dimension::TIME.label(units);
    sticks(&summary.stick_durations, &unit, letters) + &sub_phases(&summary.sub_phases, letters)
}

/// The sticks whose durations lie in one octave, which is a factor of two.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Octave {
    upper: f64,
    share: f64,
    survival: [f64; 3],
}

fn sticks(sticks: &Distribution, unit: &str, letters: Letters) -> String {
    let octaves = octaves(sticks);
    if octaves.is_empty() {
        return "no stick, the first of each path left out, has ended\n".into();
    }
    let most = octaves.iter().map(|octave| octave.share).fold(0.0, f64::max);
    let mut rows = vec![["sticks up to", "share", "", "longer", "95 %", "interval", ""].map(String::from)];
    for octave in &octaves {
        let [survival, low, high] = octave.survival;
        let end = |x: f64| if x.is_finite() { significant(x, 3) } else { "none".into() };
        rows.push([
            format!("{} {unit}", significant(octave.upper, 3)).trim_end().to_string(),
            percent(octave.share),
            letters.bar(octave.share / most, CELLS),
            significant(survival, 3),
            end(low),
            end(high),
            letters.bar(survival, CELLS),
        ]);
    }
    layout(&rows)
}

/// The bins of the file put together to octaves. The first octave also holds all shorter sticks.
fn octaves(sticks: &Distribution) -> Vec<Octave> {
    let total: u64 = sticks.histogram.counts.iter().sum();
    let (Some(last), true) = (sticks.histogram.counts.iter().rposition(|count| *count > 0), total > 0) else {
        return Vec::new();
    };
    let mut octaves: Vec<Octave> = Vec::new();
    let (mut count, mut next) = (0, f64::NEG_INFINITY);
    for i in 0..=last {
        let upper = sticks.histogram.edges[i + 1];
        count += sticks.histogram.counts[i];
        if next == f64::NEG_INFINITY {
            next = 2.0 * sticks.histogram.edges[i].max(upper / 2.0);
        }
        // The edges are rounded, so a little less than an octave counts as an octave.
        if upper >= 0.999 * next || i == last {
            let share = count as f64 / total as f64;
            let [low, high] = sticks.survival_ends.at(i);
            octaves.push(Octave { upper, share, survival: [sticks.survival[i], low, high] });
            (count, next) = (0, 2.0 * upper);
        }
    }
    let below = |n: usize| octaves[..=n].iter().map(|octave| octave.share).sum::<f64>();
    let few = (0..octaves.len()).take_while(|n| below(*n) < FIRST).count();
    let first = few.saturating_sub(1).max(octaves.len().saturating_sub(ROWS));
    let share = below(first);
    let mut shown = octaves.split_off(first);
    shown[0].share = share;
    shown
}

fn sub_phases(counts: &SubPhaseCounts, letters: Letters) -> String {
    let Some(last) = counts.counts.iter().rposition(|count| *count > 0) else { return "no slip has ended\n".into() };
    let end = |x: f64| if x.is_finite() { percent(x) } else { "none".into() };
    let mut rows = vec![["sub-phases", "share", "", "", "95 %", "interval", ""].map(String::from)];
    for (i, share) in counts.shares.iter().enumerate().take((last + 1).min(ROWS)) {
        let [low, high] = counts.share_ends.at(i).map(end);
        let name =
            if i + 1 == ROWS && last + 1 > ROWS { format!("{} (of {})", i + 1, last + 1) } else { (i + 1).to_string() };
        rows.push([name, percent(*share), letters.bar(*share, CELLS), String::new(), low, high, String::new()]);
    }
    "\n".to_string() + &layout(&rows)
}

type Cells = [String; 7];

/// The rows as text, with numbers aligned to the right and bars to the left.
fn layout(rows: &[Cells]) -> String {
    let width = |column: usize| rows.iter().map(|row| row[column].chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..7).map(width).collect();
    let mut text = String::new();
    for row in rows {
        let cell = |i: usize| {
            let pad = " ".repeat(widths[i] - row[i].chars().count());
            if i == 2 || i == 6 { row[i].clone() + &pad } else { pad + &row[i] }
        };
        let line: Vec<String> = (0..7).filter(|i| widths[*i] > 0).map(cell).collect();
        text += line.join("  ").trim_end();
        text.push('\n');
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use stick_slip::engine::Run;
    use stick_slip::scenario::Scenario;

    /// Every stick is in one row, the share of longer sticks decreases from row to row, and the
    /// bars agree with the numbers.
    #[test]
    fn the_rows_hold_every_stick() {
        let mut scenario = Scenario::shipped("rho025").expect("shipped");
        scenario.ensemble.paths = 256;
        let summary = Run::of(&scenario).without_bias().simulate().expect("no sink").summary;
        let octaves = octaves(&summary.stick_durations);
        assert!((5..=ROWS).contains(&octaves.len()), "{}", octaves.len());
        let total: f64 = octaves.iter().map(|octave| octave.share).sum();
        assert!((total - 1.0).abs() < 1e-12, "{total}");
        for pair in octaves.windows(2) {
            assert!(pair[0].upper < pair[1].upper && pair[0].survival[0] > pair[1].survival[0]);
        }
        // Few sticks are censored, so the share that has not ended at the upper edge of a row is
        // about the share that lasts longer.
        let mut ended = 0.0;
        for octave in &octaves {
            ended += octave.share;
            assert!((1.0 - ended - octave.survival[0]).abs() < 0.02, "{octave:?}");
        }
        for letters in [Letters::Unicode, Letters::Ascii] {
            let text = plots(&summary, &Units::default(), letters);
            assert_eq!(text.is_ascii(), letters == Letters::Ascii);
            assert!(text.lines().all(|line| line.chars().count() <= 100), "{text}");
        }
    }
}
