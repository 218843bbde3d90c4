//! Pictures of a path of a scenario, of a run, a trade, sweeps and a calibration.

use crate::dataset::{Handed, from_python};
use crate::errors;
use crate::scenario::Scenario;
use crate::studies;
use pyo3::prelude::*;
use stickslip::stats::Statistic;
use stickslip::study::sweep::Sweep;
use stickslip_bearing::dataset::CALIBRATION_FORMAT;
use stickslip_bearing::figures::FIGURES;
use stickslip_figure::{
    Absent, Drawing, DrawnPath, Figure, NoPage, Only, RUN, SWEEP, Style, Subject, TRADE, Theme,
};
use stickslip_files::dataset::{Attribute, Dataset};

/// A picture, which can be written as SVG, PNG or PDF.
#[pyclass(frozen)]
pub struct Picture(Drawing);

#[pymethods]
impl Picture {
    /// The picture as the text of an SVG file.
    #[getter]
    fn svg(&self) -> String {
        stickslip_figure::svg(&self.0)
    }

    /// The picture as the bytes of a PNG file with this resolution.
    #[pyo3(signature = (dots_per_inch = 300.0))]
    fn png(&self, py: Python<'_>, dots_per_inch: f64) -> PyResult<Vec<u8>> {
        stickslip_figure::png(&self.0, dots_per_inch)
            .map_err(|error| errors::of_run(py, &error, "report it"))
    }

    /// The picture as the bytes of a PDF file.
    fn pdf(&self, py: Python<'_>) -> PyResult<Vec<u8>> {
        stickslip_figure::pdf(&self.0)
            .ok_or_else(|| errors::of_run(py, "internal error: no PDF", "report it"))
    }
}

/// The figures of all kinds of results.
fn figures() -> impl Iterator<Item = &'static Figure> + Clone {
    [RUN, TRADE, SWEEP, FIGURES].into_iter().flatten()
}

/// How a picture is drawn: the name of its only figure or panel (none for all figures), whether it is dark,
/// the width of a figure in millimetres, whether vertical axes are logarithmic, the heading, and
/// words for keys and statistics of a sweep.
type Drawn = (
    Option<String>,
    bool,
    f64,
    bool,
    Option<String>,
    Vec<(String, String)>,
);

/// Draws a path of a scenario; or data sets with their names: a run of this scenario, a trade, a
/// calibration, or sweeps over the same key.
#[pyfunction]
pub fn plot(
    py: Python<'_>,
    scenario: Option<&Scenario>,
    data: Vec<(String, Handed<'_>)>,
    path: u64,
    statistic: Option<&str>,
    drawn: Drawn,
) -> PyResult<Picture> {
    let of = statistic
        .map(|name| studies::statistic(py, name))
        .transpose()?;
    let read = |(name, handed): (String, Handed<'_>)| Ok((name, from_python(handed)?));
    let data = data
        .into_iter()
        .map(read)
        .collect::<PyResult<Vec<(String, Dataset)>>>()?;
    match (scenario.map(|scenario| &scenario.checked), data.as_slice()) {
        (Some(scenario), data) => {
            let path = DrawnPath {
                scenario,
                number: path,
                from: 0.0,
            };
            let run = data.first().map(|(_, run)| run);
            draw_path(py, path, run, drawn)
        }
        (None, data) => draw_study(py, data, of, drawn),
    }
}

/// Draws a path of a scenario, or a run with this path.
fn draw_path(
    py: Python<'_>,
    path: DrawnPath<'_>,
    run: Option<&Dataset>,
    drawn: Drawn,
) -> PyResult<Picture> {
    let Some(run) = run else {
        return draw(py, &Subject::Path(path), drawn);
    };
    let scenario = path.scenario;
    let summary = run
        .summary(scenario.scheme.step())
        .map_err(|problem| damaged(py, &problem))?;
    let subject = Subject::Run {
        scenario,
        summary: &summary,
        path,
    };
    draw(py, &subject, drawn)
}

/// Draws a trade, a calibration or sweeps.
fn draw_study(
    py: Python<'_>,
    data: &[(String, Dataset)],
    of: Option<Statistic>,
    drawn: Drawn,
) -> PyResult<Picture> {
    let wrong = |problem: String| damaged(py, &problem);
    let format = data
        .first()
        .and_then(|(_, first)| first.attribute("format_name"));
    match (data, format) {
        ([(_, trade)], Some(Attribute::Text(kind))) if kind == "stick-slip trade" => {
            let costs = trade.trade().map_err(wrong)?.cost_curves(of);
            let costs = costs.ok_or_else(|| damaged(py, "it has no costs for any statistic"))?;
            draw(py, &Subject::Trade(&costs), drawn)
        }
        ([(_, fit)], Some(Attribute::Text(kind))) if kind == CALIBRATION_FORMAT.0 => {
            draw(py, &Subject::Dataset(fit), drawn)
        }
        (sweeps, _) => {
            let read = |(name, sweep): &(String, Dataset)| {
                Ok((name.clone(), sweep.sweep().map_err(wrong)?.sweep))
            };
            let sweeps: Vec<(String, Sweep)> = sweeps.iter().map(read).collect::<PyResult<_>>()?;
            let subject = Subject::Sweep {
                sweeps: &sweeps,
                statistics: of.as_slice(),
            };
            draw(py, &subject, drawn)
        }
    }
}

fn damaged(py: Python<'_>, problem: &str) -> PyErr {
    let remedy = "give what run(), trade(), sweep() or calibrate() returned, or load() of its file";
    errors::of_argument(py, "subject", "a data set", problem, remedy)
}

fn draw(
    py: Python<'_>,
    subject: &Subject,
    (only, dark, width, log, title, labels): Drawn,
) -> PyResult<Picture> {
    if !(60.0..=400.0).contains(&width) {
        return Err(errors::of_argument(
            py,
            "width",
            width,
            "too narrow or too wide for the text",
            "must be between 60 and 400 mm",
        ));
    }
    let theme = if dark { Theme::Dark } else { Theme::Light };
    let style = Style {
        theme,
        width,
        log,
        title: title.as_deref(),
        labels: &labels,
    };
    let refused = |name: &str, absent: Absent| {
        let remedy = match absent {
            Absent::Panel(..) => "choose one of them, or omit the letter to draw all",
            _ => "choose another figure or another path",
        };
        errors::of_argument(py, "only", name, &absent, remedy)
    };
    let unknown = |name: &str, problem: String| {
        errors::of_argument(py, "only", name, &problem, "as `mc plot --help` says")
    };
    let only = only
        .map(|name| Only::named(&name, figures()).map_err(|problem| unknown(&name, problem)))
        .transpose()?;
    let drawn = || {
        stickslip_figure::draw(only, figures(), subject, &style).map_err(|no| match no {
            NoPage::Without(figure, absent) => refused(figure.name, absent),
            NoPage::Empty => errors::of_run(
                py,
                "nothing to draw: every path was lost",
                "draw another run",
            ),
            NoPage::Label(name, known) => {
                let remedy = format!("use a statistic, or one of {known}");
                errors::of_argument(py, "labels", &name, "the sweep has no such key", &remedy)
            }
        })
    };
    Ok(Picture(errors::guarded(py, drawn)?))
}
