//! A density in bins, with its intervals, as one outline: bins that were drawn one by one would show
//! hairlines between them.

use super::theme::Palette;
use super::{LegendEntry, Panel, solid};

/// A bin: its edges, its density, and the interval of the density.
pub type DensityBin = ([f64; 2], f64, [f64; 2]);

/// What [`draw`] draws, without the intervals.
pub fn entry(words: &str, palette: &Palette) -> LegendEntry {
    LegendEntry {
        fill: Some(palette.wide),
        ..LegendEntry::line(solid(palette.first), words)
    }
}

/// Draws the bins above the lower edge of the panel, which is at `floor`.
pub fn draw(bins: &[DensityBin], floor: f64, palette: &Palette, panel: &mut Panel) {
    let stepped = |of: &dyn Fn(&DensityBin) -> [f64; 2]| -> Vec<[f64; 3]> {
        let ends = |bin: &DensityBin| of(bin).map(|end| end.max(floor));
        bins.iter()
            .flat_map(|bin| bin.0.map(|edge| [edge, ends(bin)[0], ends(bin)[1]]))
            .collect()
    };
    panel.band(stepped(&|bin| [floor, bin.1]), palette.wide);
    panel.band(stepped(&|bin| bin.2), palette.narrow);
    let tops = bins
        .iter()
        .flat_map(|(edges, density, _)| edges.map(|edge| [edge, *density]));
    panel.line(tops.collect(), solid(palette.first));
}
