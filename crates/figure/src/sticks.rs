//! Stick durations: their density on a logarithmic axis, and the share of sticks that last longer
//! than a duration.

use super::steps::{self, DensityBin};
use super::theme::Palette;
use super::words::{caveats, grouped};
use super::{Absent, Axis, LegendEntry, Panel, Sheet, Style, Subject, sheet, solid};
use stickslip::stats::{Dimension, Distribution};

/// The share of sticks that may be shorter than the shortest duration that is drawn.
const NEXT_TO_NONE: f64 = 5e-3;

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
    let all = bins(sticks);
    let (bins, shorter) = drawn(&all);
    let (Some(first), Some(last)) = (bins.first(), bins.last()) else {
        return Err(Absent::Nothing(
            "no stick after the first of a path has ended",
        ));
    };
    let palette = style.palette();
    let unit = Dimension::TIME.label(&scenario.units);
    let end = longest(sticks).map_or(last.edges[1], |edge| edge.max(last.edges[1]));
    let durations = || Axis::log([first.edges[0], end], "stick duration *D*", &unit);

    let (axis, floor) = Axis::of_shares(
        bins.iter().map(|bin| bin.density),
        "density per decade",
        "",
        style.log,
    );
    let mut density = Panel::new(durations(), axis, 84.0);
    let steps: Vec<DensityBin> = bins
        .iter()
        .map(|bin| (bin.edges, bin.density, [bin.density; 2]))
        .collect();
    steps::draw(&steps, floor, palette, &mut density);

    let mut curve = survival(sticks);
    let shares = curve.shares.iter().map(|point| point[1]);
    let (axis, floor) = Axis::of_shares(shares, "fraction longer than *D*", "", style.log);
    let mut outlasting = Panel::new(durations(), axis, 84.0);
    if style.log {
        curve
            .ends
            .iter_mut()
            .for_each(|[_, low, _]| *low = low.max(floor));
    }
    curve.draw(palette, &mut outlasting);

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
    let interval = LegendEntry::area(palette.narrow, "95 % interval");
    let panels = [
        density
            .above_another()
            .keyed([LegendEntry::line(solid(palette.first), "density")]),
        outlasting.keyed([
            LegendEntry::line(solid(palette.first), "Kaplan–Meier"),
            interval,
        ]),
    ];
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

/// A survival curve at the edges of the bins: shares, and their intervals, against durations.
pub(super) struct SurvivalCurve {
    shares: Vec<[f64; 2]>,
    ends: Vec<[f64; 3]>,
}

/// The survival curve of the file.
pub(super) fn survival(sticks: &Distribution) -> SurvivalCurve {
    let edges = &sticks.histogram.edges;
    let mut curve = SurvivalCurve {
        shares: Vec::new(),
        ends: Vec::new(),
    };
    let mut put = |edge: f64, share: f64, [low, high]: [f64; 2]| {
        curve.shares.push([edge, share]);
        curve.ends.push([edge, low, high]);
    };
    edges
        .first()
        .into_iter()
        .for_each(|edge| put(*edge, 1.0, [1.0; 2]));
    let mut before = (1.0, [1.0; 2]);
    for (i, share) in sticks.survival.iter().enumerate() {
        let here = (*share, sticks.survival_ends.at(i));
        // The share is known at the edges only, and never rises between them.
        put(edges[i + 1], before.0, before.1);
        put(edges[i + 1], here.0, here.1);
        before = here;
    }
    curve
}

impl SurvivalCurve {
    pub(super) fn draw(self, palette: &Palette, panel: &mut Panel) {
        panel.band(self.ends, palette.narrow);
        panel.line(self.shares, solid(palette.first));
    }
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
            let curve = survival(&summary.stick_durations).shares;
            assert!(curve.len() > 8);
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
