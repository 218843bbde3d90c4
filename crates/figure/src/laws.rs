//! The laws of slips, jumps and times from slip to slip: the share that exceeds each value.

use super::sticks::{beyond, entries, is_narrow};
use super::words::{caveats, grouped};
use super::{Absent, Sheet, Style, Subject, sheet};
use stickslip::stats::{Distribution, PhaseLaw};

/// The laws that are drawn, with the titles of their axes.
const DRAWN: [(PhaseLaw, &str); 3] = [
    (PhaseLaw::Slip, "slip duration"),
    (PhaseLaw::Jump, "size of a jump"),
    (PhaseLaw::Recurrence, "time from slip to slip"),
];

/// The share of values that may lie below the axis.
const NEXT_TO_NONE: f64 = 1e-3;

/// Draws the figure.
pub fn draw(subject: &Subject, style: &Style) -> Result<Sheet, Absent> {
    let (scenario, summary) = subject.run()?;
    if summary.laws.is_none() {
        return Err(Absent::Nothing(
            "the run has no laws: set record.laws = true",
        ));
    }
    let mut panels = Vec::new();
    let mut legend = caveats(scenario, true);
    let mut drawn = [false; 2];
    for (law, title) in DRAWN {
        let Some(of) = summary.law(law).filter(|of| of.completed > 0) else {
            continue;
        };
        let Some(range) = range(of) else {
            continue;
        };
        let titles = [
            title,
            "fraction beyond",
            &law.dimension().label(&scenario.units),
        ];
        let is_narrow = is_narrow(of);
        let mut panel = beyond(of, range, titles, 60.0, style);
        // The curve has fallen there.
        let end = match is_narrow {
            true => of.quantiles.last().copied().unwrap_or(range[1]),
            false => range[1],
        };
        let values = format!("*n* = {}", grouped(of.completed));
        panel.note([end, 0.85], values, &[[-1, 0]]);
        panels.push(panel);
        if !std::mem::replace(&mut drawn[usize::from(is_narrow)], true) {
            legend.extend(entries(of, style.palette()));
        }
    }
    if panels.is_empty() {
        return Err(Absent::Nothing("no slip was completed"));
    }
    Ok(sheet(&format!("Laws: {}", scenario.title), legend, panels))
}

/// From where all but next to none of the values lie, to the largest one.
fn range(of: &Distribution) -> Option<[f64; 2]> {
    let (edges, counts) = (&of.histogram.edges, &of.histogram.counts);
    let few = NEXT_TO_NONE * of.completed as f64;
    let mut below = 0;
    let first = counts.iter().position(|count| {
        below += count;
        below as f64 > few
    })?;
    let last = counts.iter().rposition(|count| *count > 0)?;
    let least = edges[first..].iter().copied().find(|edge| *edge > 0.0)?;
    Some([least, edges[last + 1].max(2.0 * least)])
}
