//! The work-precision picture: what error which CPU time buys, one line a scheme, on logarithmic
//! axes.

use crate::scheme::{Kind, Look};
use crate::stats::Statistic;
use crate::study::trade::{TARGETS, Trade};
use kuva::backend::raster::RasterBackend;
use kuva::backend::svg::SvgBackend;
use kuva::prelude::{Layout, LegendPosition, LinePlot, LineStyle, Plot, ScatterPlot, TickFormat};
use kuva::render::render::render_multiple;
use std::sync::Arc;

/// The picture in both of its formats.
#[derive(Clone, Debug)]
pub struct Picture {
    /// As SVG.
    pub svg: String,
    /// As PNG.
    pub png: Vec<u8>,
}

/// Targets drawn per power of ten.
const PER_DECADE: i32 = 12;
/// From the largest target down.
const DECADES: i32 = 3;
/// Runs of more than a year are not drawn.
const YEAR: f64 = 3.2e7;
/// Most characters in a line of the title.
const TITLE_WIDTH: usize = 48;
/// Pixels of the PNG per unit of the SVG.
const SCALE: f32 = 2.0;

/// For each scheme the least cost of every target, of one statistic; none if no scheme has any.
pub fn work_precision(trade: &Trade, statistic: Statistic, title: &str) -> Option<Picture> {
    let mut plots: Vec<Plot> = Vec::new();
    for &scheme in Kind::ALL {
        let Look { colour, dash } = scheme.look();
        let cost = |target: f64| {
            let choice = trade.best(Some(scheme), &[statistic], target).ok()?;
            (choice.seconds < YEAR).then_some((choice.seconds, target))
        };
        let targets =
            (0..=DECADES * PER_DECADE).map(|i| TARGETS[0] * 10f64.powf(-f64::from(i) / f64::from(PER_DECADE)));
        let line: Vec<(f64, f64)> = targets.filter_map(cost).collect();
        let marks: Vec<(f64, f64)> = TARGETS.into_iter().filter_map(cost).collect();
        if line.is_empty() {
            continue;
        }
        let style = if dash.is_empty() { LineStyle::Solid } else { LineStyle::Custom(dash.into()) };
        let line = LinePlot::new().with_data(line).with_color(colour).with_line_style(style).with_stroke_width(2.0);
        plots.push(line.with_legend(scheme.name()).into());
        plots.push(ScatterPlot::new().with_data(marks).with_color(colour).with_size(4.0).into());
    }
    if plots.is_empty() {
        return None;
    }
    let layout = Layout::auto_from_plots(&plots)
        .with_log_scale()
        .with_title(title)
        .with_title_wrap(TITLE_WIDTH)
        .with_x_label("CPU seconds on one thread")
        .with_y_label(format!("relative RMSE of {}", statistic.name()))
        .with_tick_format(TickFormat::Custom(Arc::new(power)))
        .with_legend_position(LegendPosition::InsideTopRight)
        .with_width(720.0)
        .with_height(480.0);
    let scene = render_multiple(plots, layout);
    let svg = SvgBackend.render_scene(&scene);
    let png = RasterBackend::new().with_scale(SCALE).render_scene(&scene).ok()?;
    Some(Picture { svg, png })
}

/// A power of ten, plain where that is short.
fn power(x: f64) -> String {
    if (1e-4..1e4).contains(&x) { format!("{}", (x * 1e6).round() / 1e6) } else { format!("{x:.0e}") }
}
