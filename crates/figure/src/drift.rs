//! Whether the motion has settled: mean and variance of x at whole periods, with the slopes
//! that the statistics report.

use super::axis::{between, plain, unit};
use super::theme::{DASHES, LINE};
use super::words::caveats;
use super::{Absent, Axis, Label, LegendEntry, Mark, Panel, Sheet, Stroke, Style, Subject, sheet};
use stickslip::scenario::Units;
use stickslip::stats::{Dimension, Statistic, Summary};
use stickslip::sums::Ends;

/// Draws the figure.
pub fn draw(subject: &Subject, style: &Style) -> Result<Sheet, Absent> {
    let (scenario, summary) = subject.run()?;
    let periods = &summary.periods;
    if periods.time.is_empty() || periods.mean.iter().all(|mean| mean.is_nan()) {
        return Err(Absent::Nothing(
            "the simulated time has no whole period, or too many periods to compare x at",
        ));
    }
    let palette = style.palette();
    let unit = |dimension: Dimension| dimension.label(&scenario.units);
    let end = scenario.time.end;
    let time = || Axis::linear([0.0, 1.03 * end], "time *t* = *nP*", &unit(Dimension::TIME));
    let after = summary.transient.map_or(0.0, |transient| transient.end);
    let dashes = Stroke::dashed(palette.second, LINE, &DASHES);

    let panel = |values: &[f64], ends: &Ends, slope: f64, axis: (&str, Dimension)| {
        let line = sloped(&periods.time, values, slope, after);
        let seen = values
            .iter()
            .chain(&ends.low)
            .chain(&ends.high)
            .copied()
            .chain(line.iter().flatten().map(|point| point[1]))
            .chain([0.0]);
        let (title, dimension) = axis;
        let mut panel = Panel::new(time(), Axis::around(seen, title, &unit(dimension)), 80.0);
        if after > 0.0 {
            panel.before(after, palette.grid);
        }
        panel.level(0.0, Stroke::solid(palette.faint, 0.4));
        if let Some([from, to]) = line {
            panel.line(vec![from, to], dashes.clone());
        }
        for (i, (&t, &value)) in periods.time.iter().zip(values).enumerate() {
            panel.interval(t, ends.at(i), palette.first);
            panel.mark([t, value], Mark::Disc, palette.first);
        }
        panel
    };
    let drift = summary.estimate(Statistic::DriftVelocity).estimate;
    let diffusion = summary.estimate(Statistic::DiffusionCoefficient).estimate;
    let of_mean = ("mean of *x*(*nP*) − *x*(0)", Dimension::LENGTH);
    let mean = panel(&periods.mean, &periods.mean_ends, drift, of_mean);
    let of_variance = ("variance of *x*(*nP*)", Dimension::AREA);
    let variance = panel(
        &periods.variance,
        &periods.variance_ends,
        2.0 * diffusion,
        of_variance,
    );
    let has_interval = periods.mean_ends.low.iter().any(|low| low.is_finite());
    let of_disc = if has_interval {
        "with 95 % interval"
    } else {
        "one path"
    };
    let mut legend = vec![
        LegendEntry::mark(Mark::Disc, palette.first, of_disc),
        LegendEntry::line(dashes, "measured slope"),
    ];
    if after > 0.0 {
        legend.push(LegendEntry::area(palette.grid, "excluded"));
    }
    let slopes = reported(summary, &scenario.units).into_iter();
    legend.extend(slopes.map(LegendEntry::words));
    legend.extend(caveats(scenario, false));
    // One path has no variance.
    let panels = match has_interval {
        true => vec![mean.above_another(), variance],
        false => vec![mean],
    };
    let title = format!("Drift and diffusion: {}", scenario.title);
    Ok(sheet(&title, legend, panels))
}

/// The line with this slope through the mean of the points that are counted, from the first of them
/// to the last. None if no point is counted.
fn sloped(time: &[f64], values: &[f64], slope: f64, after: f64) -> Option<[[f64; 2]; 2]> {
    let counted = time
        .iter()
        .zip(values)
        .filter(|(t, value)| **t >= after * (1.0 - 1e-9) && value.is_finite());
    let counted: Vec<(f64, f64)> = counted.map(|(t, value)| (*t, *value)).collect();
    let (first, last) = (counted.first()?.0, counted.last()?.0);
    let n = counted.len() as f64;
    let (t, value) = counted.iter().fold((0.0, 0.0), |(t, v), point| {
        (t + point.0 / n, v + point.1 / n)
    });
    let at = |x: f64| [x, value + slope * (x - t)];
    (last > first && slope.is_finite()).then(|| [at(first), at(last)])
}

/// The intervals of the slopes, as the statistics report them.
fn reported(summary: &Summary, units: &Units) -> Vec<Label> {
    let number = |statistic: Statistic, name: &str| {
        let e = summary.estimate(statistic);
        let is_known = e.low.is_finite() && e.high.is_finite();
        let range = || {
            if is_known {
                between([e.low, e.high])
            } else {
                plain(e.estimate)
            }
        };
        let unit_of = format!(" {}", statistic.dimension().label(units));
        e.estimate
            .is_finite()
            .then(|| Label::from(name).and(range()).and(unit(unit_of.trim_end())))
    };
    if summary.counted_periods() < 3 {
        return vec!["too few periods to detect a drift".into()];
    }
    // Without a spring nothing settles, and the numbers speak for themselves.
    let verdict = summary.unsettled().map(|off| match off.is_empty() {
        true => "settled: no significant slope",
        false => "not settled: significant slope",
    });
    let numbers = [
        number(Statistic::DriftVelocity, "drift "),
        number(Statistic::DiffusionCoefficient, "diffusion "),
    ];
    numbers
        .into_iter()
        .flatten()
        .chain(verdict.map(Label::from))
        .collect()
}
