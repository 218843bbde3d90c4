//! A calibrated bearing over time: the displacement as measured and as modelled, and the
//! temperature. They are shown for the whole record and for two shorter segments.

use super::calendar;
use super::measured::{DAY, Measured, thinned};
use std::ops::Range;
use stickslip_figure::{
    Absent, Axis, LegendEntry, Mark, Panel, Sheet, Stroke, Style, Subject, THIN, range_of, sheet,
};

/// A gap is longer than this number of typical steps.
const GAP: f64 = 6.0;

/// The beginnings of the shorter segments, as fractions of the whole record, and their length in
/// days.
const CLOSER: ([f64; 2], f64) = ([0.1, 0.6], 30.0);

/// Draws the figure.
pub fn draw(subject: &Subject, style: &Style) -> Result<Sheet, Absent> {
    let measured = Measured::of(subject)?;
    let palette = style.palette();
    let days = measured.days();
    let mut panels = pair(measured, [0.0, days], 75.0, style);
    for from in CLOSER.0 {
        let from = (from * days).floor();
        if from + CLOSER.1 < days {
            panels.extend(pair(measured, [from, from + CLOSER.1], 60.0, style));
        }
    }
    let legend = [
        LegendEntry::line(Stroke::solid(palette.first, 1.0), "measured"),
        LegendEntry::line(Stroke::solid(palette.second, 1.0), "model"),
        LegendEntry::mark(Mark::Triangle, palette.third, "detected slip"),
    ];
    Ok(sheet(
        &format!("Calibration: {}", measured.title),
        legend,
        panels,
    ))
}

/// Two panels, displacement above temperature, between two days.
fn pair(of: Measured, days: [f64; 2], height: f64, style: &Style) -> Vec<Panel> {
    let palette = style.palette();
    let times = of.numbers("time");
    let curve = |times: &[f64], values: &[f64], scale: f64| {
        let shown = within(times, days);
        let samples = shown.filter(|i| values[*i].is_finite());
        let samples: Vec<[f64; 2]> = samples
            .map(|i| [times[i] / DAY, scale * values[i]])
            .collect();
        let thinned = thinned(0..samples.len()).map(|i| samples[i]).collect();
        with_gaps(thinned)
    };
    let time = || calendar::time(days, of.start());
    let measured = curve(times, of.numbers("displacement"), 1e3);
    let modelled = curve(times, of.numbers("displacement_modelled"), 1e3);
    let [low, high] = range_of(measured.iter().chain(&modelled).map(|point| point[1]));
    // The marks of slips are below the curves.
    let mark = low - 0.08 * (high - low);
    let mut above = Panel::new(time(), Axis::around([mark, high], "*z*", "mm"), height);
    above.line(measured, Stroke::solid(palette.first, THIN));
    above.line(modelled, Stroke::solid(palette.second, THIN));
    // In a segment of this length the marks of slips are separate; in a longer one they would merge
    // into a line.
    if days[1] - days[0] <= CLOSER.1 {
        let slips = of.numbers("slip_time").iter().map(|time| time / DAY);
        for slip in slips.filter(|slip| (days[0]..days[1]).contains(slip)) {
            above.mark([slip, mark], Mark::Triangle, palette.third);
        }
    }
    let [times, temperatures] = of.thermometer();
    let warmth = curve(&times, &temperatures, 1.0);
    let degrees = Axis::around(warmth.iter().map(|point| point[1]), "*T*", "°C");
    let mut below = Panel::new(time(), degrees, 0.55 * height);
    below.line(warmth, Stroke::solid(palette.fourth, THIN));
    vec![above.above_another(), below]
}

/// A curve through the samples of one logger, whatever the times of the other. It is interrupted
/// where samples are missing.
fn with_gaps(samples: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    let steps = samples.windows(2).map(|pair| pair[1][0] - pair[0][0]);
    let usual = stickslip_data::median(&mut steps.collect::<Vec<f64>>());
    let mut curve = Vec::with_capacity(samples.len());
    for point in samples {
        let before = curve.last().map_or(point[0], |last: &[f64; 2]| last[0]);
        if point[0] - before > GAP * usual {
            curve.push([before, f64::NAN]);
        }
        curve.push(point);
    }
    curve
}

/// The indices of the samples between two days.
fn within(times: &[f64], [from, to]: [f64; 2]) -> Range<usize> {
    times.partition_point(|t| *t < from * DAY)..times.partition_point(|t| *t <= to * DAY)
}
