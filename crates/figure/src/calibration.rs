//! A calibrated bearing over time: the displacement as measured and as modelled, and the
//! temperature. They are shown for the whole record and for two shorter stretches.

use super::theme::THIN;
use super::{
    Absent, Axis, LegendEntry, Mark, Panel, Sheet, Stroke, Style, Subject, calendar, range_of,
    sheet,
};
use std::ops::Range;
use stickslip_bearing::calibration::Calibration;

pub(super) const DAY: f64 = 86_400.0;

/// The most points of a curve. More of them would be closer together than the dots of a printer.
const POINTS: usize = 8_000;

/// The beginnings of the shorter stretches, as shares of the whole record, and their length in
/// days.
const CLOSER: ([f64; 2], f64) = ([0.1, 0.6], 30.0);

/// Draws the figure.
pub fn draw(subject: &Subject, style: &Style) -> Result<Sheet, Absent> {
    let (title, calibration) = subject.calibration()?;
    let palette = style.palette();
    let days = calibration.record.times.last().copied().unwrap_or(0.0) / DAY;
    let mut panels = pair(calibration, [0.0, days], 75.0, style);
    for from in CLOSER.0 {
        let from = (from * days).floor();
        if from + CLOSER.1 < days {
            panels.extend(pair(calibration, [from, from + CLOSER.1], 60.0, style));
        }
    }
    let legend = [
        LegendEntry::line(Stroke::solid(palette.first, 1.0), "measured"),
        LegendEntry::line(Stroke::solid(palette.second, 1.0), "model"),
        LegendEntry::mark(Mark::Triangle, palette.third, "detected slip"),
    ];
    Ok(sheet(&format!("Calibration: {title}"), legend, panels))
}

/// Two panels, displacement above temperature, between two days.
fn pair(calibration: &Calibration, days: [f64; 2], height: f64, style: &Style) -> Vec<Panel> {
    let palette = style.palette();
    let record = &calibration.record;
    let shown = within(&record.times, days);
    let curve = |values: &[f64], scale: f64| -> Vec<[f64; 2]> {
        thinned(shown.clone())
            .map(|i| [record.times[i] / DAY, scale * values[i]])
            .collect()
    };
    let time = || calendar::time(days, record.start);
    let (measured, modelled) = (
        curve(&record.readings, 1e3),
        curve(&calibration.modelled, 1e3),
    );
    let [low, high] = range_of(measured.iter().chain(&modelled).map(|point| point[1]));
    // The marks of slips are below the curves.
    let mark = low - 0.08 * (high - low);
    let mut above = Panel::new(time(), Axis::around([mark, high], "*z*", "mm"), height);
    above.line(measured, Stroke::solid(palette.first, THIN));
    above.line(modelled, Stroke::solid(palette.second, THIN));
    // In a stretch of this length the marks of slips are separate; in a longer one they would merge
    // to a line.
    if days[1] - days[0] <= CLOSER.1 {
        let seen = calibration
            .slips
            .iter()
            .filter(|slip| (days[0]..days[1]).contains(&(slip.time / DAY)));
        for slip in seen {
            above.mark([slip.time / DAY, mark], Mark::Triangle, palette.third);
        }
    }
    let warmth = curve(&record.temperatures, 1.0);
    let degrees = Axis::around(warmth.iter().map(|point| point[1]), "*T*", "°C");
    let mut below = Panel::new(time(), degrees, 0.55 * height);
    below.line(warmth, Stroke::solid(palette.fourth, THIN));
    vec![above.above_another(), below]
}

/// The indices of the samples that a curve goes through: not more than `POINTS` of them.
pub(super) fn thinned(samples: Range<usize>) -> impl Iterator<Item = usize> {
    let step = samples.len().div_ceil(POINTS).max(1);
    samples.step_by(step)
}

/// The indices of the samples between two days.
fn within(times: &[f64], [from, to]: [f64; 2]) -> Range<usize> {
    times.partition_point(|t| *t < from * DAY)..times.partition_point(|t| *t <= to * DAY)
}
