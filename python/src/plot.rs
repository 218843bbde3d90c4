//! Pictures of a path of a scenario, of a run, a trade, sweeps and a calibration.

use crate::dataset::{Handed, from_python};
use crate::errors;
use crate::scenario::Scenario;
use crate::studies::statistic;
use pyo3::prelude::*;
use stick_slip::config::Override;
use stick_slip::dataset::StoredSweep;
use stick_slip::figure::{self, Absent, Drawing, DrawnPath, NoPage, Only, Style, Subject, Theme};
use stick_slip::scenario::Scenario as Checked;
use stick_slip::stats::Statistic;
use stick_slip::study::sweep::{Setting, Sweep};

/// A picture, which can be written as SVG, PNG or PDF.
#[pyclass(frozen)]
pub struct Picture(Drawing);

#[pymethods]
impl Picture {
    /// The picture as the text of an SVG file.
    #[getter]
    fn svg(&self) -> String {
        figure::svg(&self.0)
    }

    /// The picture as the bytes of a PNG file with this resolution.
    #[pyo3(signature = (dots_per_inch = 300.0))]
    fn png(&self, py: Python<'_>, dots_per_inch: f64) -> PyResult<Vec<u8>> {
        figure::png(&self.0, dots_per_inch).map_err(|error| errors::of_run(py, &error.to_string(), "report it"))
    }

    /// The picture as the bytes of a PDF file.
    fn pdf(&self, py: Python<'_>) -> PyResult<Vec<u8>> {
        figure::pdf(&self.0).ok_or_else(|| errors::of_run(py, "a flaw in the program: no PDF", "report it"))
    }
}

/// How a picture is drawn: the name of its only figure or panel (none for all figures), whether it is dark,
/// the width of a figure in millimetres, and whether vertical axes are logarithmic.
type Drawn = (Option<String>, bool, f64, bool);

/// Draws a path of a scenario or, given the data set of a run, that run.
#[pyfunction]
pub fn plot_scenario(
    py: Python<'_>,
    scenario: &Scenario,
    run: Option<Handed<'_>>,
    path: u64,
    drawn: Drawn,
) -> PyResult<Picture> {
    let scenario = &scenario.checked;
    let path = DrawnPath { scenario, number: path, from: 0.0 };
    let Some(run) = run else {
        return draw(py, &Subject::Path(path), drawn);
    };
    let summary = from_python(run)?.summary(scenario.scheme.step()).map_err(|error| damaged(py, &error))?;
    draw(py, &Subject::Run { scenario, summary: &summary, path }, drawn)
}

/// Draws a trade.
#[pyfunction]
pub fn plot_trade(py: Python<'_>, trade: Handed<'_>, of: Option<&str>, drawn: Drawn) -> PyResult<Picture> {
    let of = of.map(|name| statistic(py, name)).transpose()?;
    let stored = from_python(trade)?.trade().map_err(|error| damaged(py, &error))?;
    let prices = stored.prices(of).ok_or_else(|| damaged(py, "no statistic in it has prices"))?;
    draw(py, &Subject::Trade(&prices), drawn)
}

/// Draws sweeps over the same key, each with its name.
#[pyfunction]
pub fn plot_sweeps(
    py: Python<'_>,
    sweeps: Vec<(String, Handed<'_>)>,
    of: Option<&str>,
    drawn: Drawn,
) -> PyResult<Picture> {
    let of: Vec<Statistic> = of.map(|name| statistic(py, name)).transpose()?.into_iter().collect();
    let read = |(name, sweep): (String, Handed<'_>)| {
        let stored = from_python(sweep)?.sweep().map_err(|error| damaged(py, &error))?;
        Ok((name, whole(py, stored)?))
    };
    let sweeps = sweeps.into_iter().map(read).collect::<PyResult<Vec<(String, Sweep)>>>()?;
    let named: Vec<(String, &Sweep)> = sweeps.iter().map(|(name, sweep)| (name.clone(), sweep)).collect();
    draw(py, &Subject::Sweep { sweeps: &named, statistics: &of }, drawn)
}

/// Draws a calibration.
#[pyfunction]
pub fn plot_calibration(py: Python<'_>, calibration: Handed<'_>, drawn: Drawn) -> PyResult<Picture> {
    let stored = from_python(calibration)?.calibration().map_err(|error| damaged(py, &error))?;
    draw(py, &Subject::Calibration { title: &stored.title, calibration: &stored.calibration }, drawn)
}

/// A sweep from a data set, with the scenarios of its points made again.
fn whole(py: Python<'_>, stored: StoredSweep) -> PyResult<Sweep> {
    let (text, series) = (stored.scenario_text.clone(), stored.series.clone());
    stored.whole(|settings| {
        let laid = |Setting { key, value }: &Setting| Override::number(key, key, *value);
        let own: Vec<Override> = settings.iter().map(laid).collect();
        Checked::parse_stored("sweep", &text, &own, series.as_ref()).map_err(|error| errors::of_scenario(py, &error))
    })
}

fn damaged(py: Python<'_>, problem: &str) -> PyErr {
    let remedy = "give what run(), trade(), sweep() or calibrate() returned, or load() of its file";
    errors::of_argument(py, "subject", "a data set", problem, remedy)
}

fn draw(py: Python<'_>, subject: &Subject, drawn: Drawn) -> PyResult<Picture> {
    errors::guarded(py, || drawn_as(py, subject, drawn))
}

fn drawn_as(py: Python<'_>, subject: &Subject, (only, dark, width, log): Drawn) -> PyResult<Picture> {
    if !(60.0..=400.0).contains(&width) {
        let value = width.to_string();
        return Err(errors::of_argument(
            py,
            "width",
            &value,
            "letters would be crowded or lost",
            "give 60 to 400 millimetres",
        ));
    }
    let style = Style { theme: if dark { Theme::Dark } else { Theme::Light }, width, log, ..Style::default() };
    let refused = |name: &str, absent: Absent| {
        let remedy = match absent {
            Absent::Panel(..) => "choose one of them, or leave the letter out for all",
            _ => "choose another figure or another path",
        };
        errors::of_argument(py, "only", name, &absent.to_string(), remedy)
    };
    let scene = match only {
        Some(name) => {
            let unknown =
                |problem: String| errors::of_argument(py, "only", &name, &problem, "as `mc plot --help` says");
            let only = Only::named(&name).map_err(unknown)?;
            only.draw(subject, &style).map_err(|absent| refused(&name, absent))?
        }
        None => figure::page(subject, &style).map_err(|no| match no {
            NoPage::Without(figure, absent) => refused(figure.name, absent),
            NoPage::Empty => errors::of_run(py, "there is nothing to draw: every path was lost", "draw another run"),
        })?,
    };
    Ok(Picture(scene))
}
