//! The years of a forecast: distributions of the sliding path, the number of slips and the largest
//! force over years, with the range of most single years.

use crate::forecast::{Forecast, ForecastQuantity};
use stickslip_figure::{Axis, Drawing, LegendEntry, Panel, Style, range_of, sheet, solid};
use stickslip_text::numbers::grouped;

/// Number of bars.
const BARS: usize = 30;

/// The quantities that are drawn, with the title and the unit of their axes and the factor to it.
const DRAWN: [(ForecastQuantity, &str, &str, f64); 3] = [
    (
        ForecastQuantity::SlidingPath,
        "sliding path in a year",
        "mm",
        1e3,
    ),
    (ForecastQuantity::Slips, "slips in a year", "", 1.0),
    (
        ForecastQuantity::Force,
        "largest force on the pier in a year",
        "kN",
        1e-3,
    ),
];

/// Draws the years of a forecast.
pub fn years(title: &str, forecast: &Forecast, style: &Style) -> Drawing {
    let palette = style.palette();
    let mut panels = Vec::new();
    for (quantity, words, unit, factor) in DRAWN {
        let mut levels = forecast.levels.iter();
        let Some(level) = levels.find(|level| level.quantity == quantity) else {
            continue;
        };
        let years = forecast.years.iter().flatten();
        let values: Vec<f64> = years.map(|year| factor * year[quantity as usize]).collect();
        let [low, high] = range_of(values.iter().copied());
        let width = ((high - low) / BARS as f64).max(f64::MIN_POSITIVE);
        let mut counts = [0.0; BARS];
        for value in &values {
            counts[(((value - low) / width) as usize).min(BARS - 1)] += 1.0;
        }
        let share = 100.0 / values.len() as f64;
        let most = share * counts.iter().fold(0.0_f64, |most, count| most.max(*count));
        let x = Axis::around(values.iter().copied(), words, unit);
        let mut panel = Panel::new(x, Axis::linear([0.0, 1.2 * most], "years", "%"), 60.0);
        let left = |i: usize| low + i as f64 * width;
        let bar = |i: usize| [[left(i), 0.0], [left(i + 1), share * counts[i]]];
        panel.bars((0..BARS).map(bar).collect(), palette.narrow);
        let range = level.year_interval.map(|end| factor * end);
        panel.interval_across(1.1 * most, range, palette.first);
        let expected = factor * level.expected;
        panel.line(
            vec![[expected, 0.0], [expected, 1.2 * most]],
            solid(palette.second),
        );
        panels.push(panel);
    }
    let years: usize = forecast.years.iter().map(Vec::len).sum();
    let level = 100.0 * forecast.question.level;
    let legend = [
        LegendEntry::area(
            palette.narrow,
            format!("{} simulated years", grouped(years as u64)),
        ),
        LegendEntry::line(
            solid(palette.first),
            format!("{level:.0} % range of one year"),
        ),
        LegendEntry::line(solid(palette.second), "mean"),
    ];
    sheet(&format!("Years to come: {title}"), legend, panels).alone(style)
}
