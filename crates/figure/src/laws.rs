//! The laws of slips, jumps and times from slip to slip: the share that exceeds each value.

use super::sticks::survival;
use super::words::{caveats, grouped};
use super::{Absent, Axis, LegendEntry, Mark, Panel, Sheet, Style, Subject, sheet, solid};
use stickslip::stats::{Distribution, PhaseLaw, QUANTILE_LEVELS};

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
    let palette = style.palette();
    let mut panels = Vec::new();
    let (mut has_curve, mut has_quantiles) = (false, false);
    let mut ended = Vec::new();
    for (law, title) in DRAWN {
        let Some(distribution) = summary
            .law(law)
            .filter(|distribution| distribution.completed > 0)
        else {
            continue;
        };
        let Some([least, most]) = range(distribution) else {
            continue;
        };
        let unit = law.dimension().label(&scenario.units);
        let shares = distribution.survival.iter().copied().chain([1.0]);
        let (vertical, _) = Axis::of_shares(shares, "share beyond", "", style.log);
        if is_narrow(distribution) {
            let axis = Axis::around(distribution.quantiles.iter().copied(), title, &unit);
            let mut panel = Panel::new(axis, vertical, 60.0);
            for (i, (level, value)) in QUANTILE_LEVELS
                .into_iter()
                .zip(&distribution.quantiles)
                .enumerate()
            {
                panel.interval_across(1.0 - level, distribution.quantile_ends.at(i), palette.first);
                panel.mark([*value, 1.0 - level], Mark::Disc, palette.first);
            }
            panels.push(panel);
            has_quantiles = true;
        } else {
            let mut panel = Panel::new(Axis::log([least, most], title, &unit), vertical, 60.0);
            survival(distribution).draw(palette, &mut panel);
            panels.push(panel);
            has_curve = true;
        }
        ended.push(grouped(distribution.completed));
    }
    if panels.is_empty() {
        return Err(Absent::Nothing("no slip was completed"));
    }
    let mut legend = vec![LegendEntry::words(format!("{} values", ended.join(", ")))];
    legend.extend(caveats(scenario, true));
    if has_curve {
        legend.push(LegendEntry::line(
            solid(palette.first),
            "Kaplan\u{2013}Meier",
        ));
        legend.push(LegendEntry::area(palette.narrow, "95 % interval"));
    }
    if has_quantiles {
        legend.push(LegendEntry::mark(
            Mark::Disc,
            palette.first,
            "quantile, with 95 % interval",
        ));
    }
    Ok(sheet(&format!("Laws: {}", scenario.title), legend, panels))
}

/// A law that fills at most this number of bins has no visible shape.
const NARROW: usize = 3;

/// Whether a law is hardly wider than the bins of its survival curve. It is drawn as its quantiles.
fn is_narrow(of: &Distribution) -> bool {
    let is_filled = |count: &u64| *count > 0;
    let ends = of
        .histogram
        .counts
        .iter()
        .position(is_filled)
        .zip(of.histogram.counts.iter().rposition(is_filled));
    ends.is_some_and(|(first, last)| last - first < NARROW)
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
