//! The number of sub-phases of a slip: the share of slips with each number, with its interval.

use super::words::{caveats, grouped, intervals};
use super::{Absent, Axis, LegendEntry, Panel, Sheet, Style, Subject, range_of, sheet};

/// Half the width of a bar.
const HALF: f64 = 0.36;

/// Draws the figure.
pub fn draw(subject: &Subject, style: &Style) -> Result<Sheet, Absent> {
    let (scenario, summary) = subject.run()?;
    let counts = &summary.sub_phases;
    let Some(last) = counts.counts.iter().rposition(|count| *count > 0) else {
        return Err(Absent::Nothing("no slip has ended"));
    };
    let palette = style.palette();
    let shares = &counts.shares[..=last];
    let ends: Vec<[f64; 2]> = (0..=last).map(|i| counts.share_ends.at(i)).collect();

    let k = Axis::linear(
        [0.4, (last as f64).max(3.0) + 1.6],
        "number *k* of sub-phases of a slip",
        "",
    )
    .whole();
    let [_, most] = range_of(
        shares
            .iter()
            .copied()
            .chain(ends.iter().map(|ends| ends[1])),
    );
    let [least, _] = range_of(shares.iter().copied().filter(|share| *share > 0.0));
    let title = "fraction of slips";
    let floor = if style.log {
        10f64.powf((least / 1.5).log10().floor())
    } else {
        0.0
    };
    let vertical = match style.log {
        true => Axis::log_around([floor, most], title, ""),
        false => Axis::from_zero(most, title, ""),
    };
    let mut panel = Panel::new(k, vertical, 100.0);
    for (i, (&share, &[low, high])) in shares.iter().zip(&ends).enumerate() {
        let k = i as f64 + 1.0;
        if share > 0.0 {
            panel.bar([k - HALF, floor], [k + HALF, share], palette.narrow);
        }
        panel.interval(k, [low.max(floor), high], palette.ink);
    }
    let slips: u64 = counts.counts.iter().sum();
    let words = format!(
        "{} slips ended, {} censored",
        grouped(slips),
        grouped(counts.censored)
    );
    let mut legend = vec![LegendEntry::words(words)];
    legend.extend(caveats(scenario, true));
    let words = match intervals(&counts.share_ends, palette) {
        Some(_) => "fraction, with 95 % interval",
        None => "fraction",
    };
    legend.push(LegendEntry::area(palette.narrow, words));
    Ok(sheet(
        &format!("Sub-phases of slips: {}", scenario.title),
        legend,
        [panel],
    ))
}
