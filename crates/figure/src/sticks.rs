//! Stick durations: their density on a logarithmic axis, and the share of sticks that last longer
//! than a duration.

use super::steps::{self, DensityBin};
use super::theme::Palette;
use super::words::{caveats, grouped, intervals};
use super::{Absent, Axis, LegendEntry, Mark, Panel, Sheet, Style, Subject, sheet, solid};
use stickslip::stats::{Dimension, Distribution, QUANTILE_LEVELS};
use stickslip::sums::Ends;

/// The share of sticks that may be shorter than the shortest duration that is drawn.
const NEXT_TO_NONE: f64 = 5e-3;

/// The titles of the axes of durations and of the fraction that lasts longer.
pub(super) const TITLES: [&str; 2] = ["stick duration *D*", "fraction longer than *D*"];

/// The share of the completed sticks in one bin, divided by the width of the bin in decades.
#[derive(Clone, Copy, Debug, PartialEq)]
struct DrawnBin {
    /// The durations at which the bin begins and ends.
    edges: [f64; 2],
    count: u64,
    density: f64,
}

/// Draws the figure.
pub fn draw(subject: &Subject, style: &Style) -> Result<Sheet, Absent> {
    let (scenario, summary) = subject.run()?;
    let sticks = &summary.stick_durations;
    let range = range(sticks).ok_or(Absent::Nothing(
        "no stick after the first of a path has ended",
    ))?;
    let all = bins(sticks);
    let (bins, shorter) = drawn(&all);
    let palette = style.palette();
    let unit = Dimension::TIME.label(&scenario.units);
    let titles = [TITLES[0], TITLES[1], &unit];

    let (axis, floor) = Axis::of_shares(
        bins.iter().map(|bin| bin.density),
        "density per decade",
        "",
        style.log,
    );
    let mut density = Panel::new(Axis::log(range, titles[0], &unit), axis, 84.0);
    let steps: Vec<DensityBin> = bins
        .iter()
        .map(|bin| (bin.edges, bin.density, [bin.density; 2]))
        .collect();
    steps::draw(&steps, floor, palette, &mut density);

    let mut legend = vec![LegendEntry::words(format!(
        "{} ended, {} censored",
        grouped(sticks.completed),
        grouped(sticks.censored)
    ))];
    if shorter > 0 {
        let words = format!("{} shorter than shown", grouped(shorter));
        legend.push(LegendEntry::words(words));
    }
    legend.extend(caveats(scenario, true));
    let key = entries(sticks, palette);
    let mut panels = vec![beyond(sticks, range, titles, 84.0, style).keyed(key)];
    if !is_narrow(sticks) {
        let key = [steps::entry("density", palette)];
        panels.insert(0, density.above_another().keyed(key));
    }
    Ok(sheet(
        &format!("Stick durations: {}", scenario.title),
        legend,
        panels,
    ))
}

/// The bins of the file. Where durations are multiples of a step, the edges of a bin are moved to
/// half a step beyond the multiples in it, and a bin without a multiple becomes part of its
/// neighbours.
fn bins(sticks: &Distribution) -> Vec<DrawnBin> {
    let edges = &sticks.histogram.edges;
    let mut out = Vec::new();
    for (i, &count) in sticks.histogram.counts.iter().enumerate() {
        let [low, high] = [edges[i], edges[i + 1]];
        let edges = match sticks.step {
            None => [low, high],
            Some(h) => {
                let [from, to] = [low, high].map(|edge| (edge / h - 1e-6).ceil().max(1.0));
                if to <= from {
                    continue;
                }
                [(from - 0.5) * h, (to - 0.5) * h]
            }
        };
        if edges[0] <= 0.0 {
            continue;
        }
        let per_decade =
            |n: f64| n / sticks.completed.max(1) as f64 / (edges[1] / edges[0]).log10();
        out.push(DrawnBin {
            edges,
            count,
            density: per_decade(count as f64),
        });
    }
    out
}

/// The bins that are drawn, and the number of sticks shorter than they show. They begin where a
/// share of `NEXT_TO_NONE` of the sticks is shorter, and end at the longest stick.
fn drawn(bins: &[DrawnBin]) -> (&[DrawnBin], u64) {
    let total: u64 = bins.iter().map(|bin| bin.count).sum();
    let below = |end: usize| bins[..end].iter().map(|bin| bin.count).sum::<u64>();
    let first = (0..bins.len())
        .rev()
        .find(|end| below(*end) as f64 <= NEXT_TO_NONE * total as f64)
        .unwrap_or(0);
    let last = bins
        .iter()
        .rposition(|bin| bin.count > 0)
        .map_or(first, |last| last + 1);
    (&bins[first..last], below(first))
}

/// The upper edge of the bin of the longest stick, at which the survival curve falls to its end.
fn longest(sticks: &Distribution) -> Option<f64> {
    let filled = |count: &u64| *count > 0;
    let last = sticks.histogram.counts.iter().rposition(filled)?;
    Some(sticks.histogram.edges[last + 1])
}

/// The shortest and the longest duration that is drawn; none if no stick has ended.
pub(super) fn range(sticks: &Distribution) -> Option<[f64; 2]> {
    let all = bins(sticks);
    let (bins, _) = drawn(&all);
    Some([
        bins.first()?.edges[0],
        bins.last()?.edges[1].max(longest(sticks)?),
    ])
}

/// A law that fills at most this number of bins has no visible shape.
const NARROW: usize = 3;

/// Whether a law is hardly wider than the bins of its survival curve. It is drawn as its quantiles.
pub(super) fn is_narrow(of: &Distribution) -> bool {
    let counts = &of.histogram.counts;
    let first = counts.iter().position(|count| *count > 0);
    let last = counts.iter().rposition(|count| *count > 0);
    first
        .zip(last)
        .is_some_and(|(first, last)| last - first < NARROW)
}

/// The fraction of the values of a law beyond each number of this range.
pub(super) fn beyond(
    of: &Distribution,
    range: [f64; 2],
    [across, upwards, unit]: [&str; 3],
    height: f64,
    style: &Style,
) -> Panel {
    let palette = style.palette();
    let shares = of.survival.iter().copied().chain([1.0]);
    let (vertical, _) = Axis::of_shares(shares, upwards, "", style.log);
    if is_narrow(of) {
        let Ends { low, high } = &of.quantile_ends;
        let seen = of.quantiles.iter().chain(low).chain(high);
        let axis = Axis::around(seen.copied(), across, unit);
        let mut panel = Panel::new(axis, vertical, height);
        for (i, (level, value)) in QUANTILE_LEVELS.iter().zip(&of.quantiles).enumerate() {
            panel.interval_across(1.0 - level, of.quantile_ends.at(i), palette.first);
            panel.mark([*value, 1.0 - level], Mark::Disc, palette.first);
        }
        return panel;
    }
    let mut panel = Panel::new(Axis::log(range, across, unit), vertical, height);
    let (curve, ends) = survival(of, range[0]);
    panel.band(ends, palette.narrow);
    panel.line(curve, solid(palette.first));
    panel
}

/// What the panel of [`beyond`] shows.
pub(super) fn entries(of: &Distribution, palette: &Palette) -> Vec<LegendEntry> {
    let interval = |ends: &Ends| intervals(ends, palette);
    let quantile = |words: &str| vec![LegendEntry::mark(Mark::Disc, palette.first, words)];
    match (is_narrow(of), interval(&of.quantile_ends)) {
        (true, Some(_)) => quantile("quantile, with 95 % interval"),
        (true, None) => quantile("quantile"),
        _ => std::iter::once(LegendEntry::line(
            solid(palette.first),
            "Kaplan–Meier, at bin edges",
        ))
        .chain(interval(&of.survival_ends))
        .collect(),
    }
}

/// The survival curve of the file and its interval, from the smallest number that is drawn. It is
/// known at the edges of the bins only, and falls there.
fn survival(of: &Distribution, from: f64) -> (Vec<[f64; 2]>, Vec<[f64; 3]>) {
    let mut before = (1.0, [1.0; 2]);
    let first = of.histogram.edges[0].min(from);
    let mut rows = vec![(first, before)];
    for (i, edge) in of.histogram.edges[1..].iter().enumerate() {
        let here = (of.survival[i], of.survival_ends.at(i));
        rows.extend([(*edge, before), (*edge, here)]);
        before = here;
    }
    let point =
        |&(edge, (share, [low, high])): &(f64, (f64, [f64; 2]))| ([edge, share], [edge, low, high]);
    rows.iter().map(point).unzip()
}

#[cfg(test)]
mod tests {
    use super::*;
    use stickslip::engine::Run;
    use stickslip::scenario::Scenario;

    /// The density integrates to one over the logarithm of the duration, both with a step and
    /// without one, and the survival curve has steps.
    #[test]
    fn the_density_holds_every_stick() {
        for scheme in ["discrete-vi", "event-driven"] {
            let mut scenario = Scenario::shipped("rho025").expect("shipped");
            if scheme == "event-driven" {
                scenario = scenario
                    .with_scheme(stickslip::scheme::EventDriven { tolerance: 1e-2 })
                    .expect("suits");
            }
            scenario.ensemble.paths = 256;
            let summary = Run::of(&scenario)
                .without_bias()
                .simulate()
                .expect("no sink")
                .summary;
            let (curve, _) = survival(&summary.stick_durations, 1e-3);
            assert!(curve.len() > 8 && curve[0][0] <= 1e-3 && curve[0][1] == 1.0);
            for pair in curve.windows(2) {
                let [[x, y], [next, below]] = [pair[0], pair[1]];
                assert!(
                    x == next || y == below,
                    "{scheme}: a step is level or upright"
                );
            }
            let bins = bins(&summary.stick_durations);
            let total: f64 = bins
                .iter()
                .map(|bin| bin.density * (bin.edges[1] / bin.edges[0]).log10())
                .sum();
            assert!((total - 1.0).abs() < 1e-9, "{scheme}: {total}");
            assert!(
                bins.windows(2)
                    .all(|pair| (pair[0].edges[1] / pair[1].edges[0] - 1.0).abs() < 1e-9),
                "{scheme}"
            );
        }
    }
}
