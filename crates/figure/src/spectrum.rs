//! The power spectrum of x' on logarithmic axes, and its autocovariance.

use super::theme::Palette;
use super::words::{caveats, intervals};
use super::{
    Absent, Axis, LegendEntry, Panel, Sheet, Stroke, Style, Subject, range_of, sheet, solid,
};
use stickslip::stats::{Dimension, Spectrum};
use stickslip::sums::Ends;

/// Draws the figure.
pub fn draw(subject: &Subject, style: &Style) -> Result<Sheet, Absent> {
    let (scenario, summary) = subject.run()?;
    let Some(spectrum) = &summary.spectrum else {
        return Err(Absent::Nothing(
            "the run has no spectrum: set record.spectrum = true",
        ));
    };
    let (of, ends) = (&spectrum.velocity, &spectrum.velocity.spectrum_ends);
    let shown = of.spectrum[1..].iter().chain(&ends.high[1..]);
    let [least, most] = range_of(shown.copied().filter(|power| *power > 0.0));
    if !(least > 0.0 && least < most) {
        return Err(Absent::Nothing(
            "x' is identical in all paths at every row of the output grid, or there is only one path",
        ));
    }
    let palette = style.palette();
    let unit = |time: i32, length: i32| {
        Dimension {
            time,
            length,
            ..Dimension::ONE
        }
        .label(&scenario.units)
    };
    let vertical = Axis::log_around([least, most], "power spectrum *S*(*ω*)", &unit(-1, 2));
    let panels = [
        power(spectrum, &unit(-1, 0), vertical, palette),
        covariance(spectrum, [unit(1, 0), unit(-2, 2)], palette),
    ];
    let mut legend = vec![LegendEntry::line(
        solid(palette.first),
        "velocity *x*\u{2032} less its mean over paths",
    )];
    legend.extend(intervals(ends, palette));
    legend.extend(caveats(scenario, false));
    Ok(sheet(
        &format!("Spectrum: {}", scenario.title),
        legend,
        panels,
    ))
}

/// The power spectrum.
fn power(spectrum: &Spectrum, unit: &str, vertical: Axis, palette: &Palette) -> Panel {
    let (of, frequencies) = (&spectrum.velocity, &spectrum.frequency);
    let horizontal = Axis::log(
        [frequencies[1], frequencies[frequencies.len() - 1]],
        "angular frequency *ω*",
        unit,
    );
    let mut panel = Panel::new(horizontal, vertical, 96.0);
    panel.band(band(frequencies, &of.spectrum_ends, 1), palette.narrow);
    let points = frequencies.iter().zip(&of.spectrum).skip(1);
    let curve = points
        .map(|(w, s)| [*w, *s])
        .filter(|point| point[1] > 0.0)
        .collect();
    panel.line(curve, solid(palette.first));
    panel
}

fn covariance(spectrum: &Spectrum, units: [String; 2], palette: &Palette) -> Panel {
    let (of, lags) = (&spectrum.velocity, &spectrum.lag);
    let horizontal = Axis::linear([0.0, lags[lags.len() - 1]], "lag *s*", &units[0]);
    let seen = of.autocovariance_ends.low[..lags.len()]
        .iter()
        .chain(&of.autocovariance_ends.high[..lags.len()])
        .copied();
    let title = "autocovariance *C*(*s*)";
    let vertical = Axis::around(seen.chain([0.0]), title, &units[1]);
    let mut panel = Panel::new(horizontal, vertical, 72.0);
    panel.level(0.0, Stroke::solid(palette.faint, 0.4));
    panel.band(band(lags, &of.autocovariance_ends, 0), palette.narrow);
    let points = lags.iter().zip(&of.autocovariance);
    let curve = points.map(|(l, c)| [*l, *c]).collect();
    panel.line(curve, solid(palette.first));
    panel
}

fn band(at: &[f64], ends: &Ends, from: usize) -> Vec<[f64; 3]> {
    (from..at.len())
        .map(|i| [at[i], ends.at(i)[0], ends.at(i)[1]])
        .filter(|[_, low, _]| low.is_finite())
        .collect()
}
