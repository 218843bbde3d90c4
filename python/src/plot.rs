//! Pictures of a path of a scenario, of a run, a trade, sweeps and a calibration.

use crate::dataset::{Handed, from_python};
use crate::errors;
use crate::scenario::Scenario;
use crate::studies;
use crate::watched::{Watch, abandoned_on_interrupt};
use pyo3::prelude::*;
use stickslip::dataset::{Attribute, Dataset};
use stickslip::scenario;
use stickslip::stats::Statistic;
use stickslip::study::sweep::Sweep;
use stickslip_bearing::dataset::CALIBRATION_FORMAT;
use stickslip_bearing::figures::FIGURES;
use stickslip_figure::{
    Absent, Drawing, DrawnPath, Figure, NoPage, Only, RUN, SWEEP, Style, Subject, TRADE, Theme,
};

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

/// Why there is no picture: the argument and its value, or none if it is not an argument; the problem
/// and the remedy.
type Refused = (Option<(&'static str, String)>, String, String);

/// Draws a path of a scenario; or data sets with their names: a run of this scenario, a trade, a
/// calibration, or sweeps over the same key. Ctrl-C ends it.
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
    let scenario = scenario.map(|scenario| scenario.checked.clone());
    let work = move |_: &Watch| match &scenario {
        Some(scenario) => draw_path(scenario, path, data.first(), drawn),
        None => draw_study(&data, of, drawn),
    };
    let refused = |(argument, problem, remedy): Refused| match argument {
        Some((name, value)) => errors::of_argument(py, name, value, problem, &remedy),
        None => errors::of_run(py, problem, &remedy),
    };
    abandoned_on_interrupt(py, &None, work)?
        .map(Picture)
        .map_err(refused)
}

/// Draws a path of a scenario, or a run with this path.
fn draw_path(
    scenario: &scenario::Scenario,
    number: u64,
    run: Option<&(String, Dataset)>,
    drawn: Drawn,
) -> Result<Drawing, Refused> {
    let path = DrawnPath {
        scenario,
        number,
        from: 0.0,
    };
    let Some((_, run)) = run else {
        return draw(&Subject::Path(path), drawn);
    };
    let summary = run.summary(scenario.scheme.step()).map_err(damaged)?;
    let subject = Subject::Run {
        scenario,
        summary: &summary,
        path,
    };
    draw(&subject, drawn)
}

/// Draws a trade, a calibration or sweeps.
fn draw_study(
    data: &[(String, Dataset)],
    of: Option<Statistic>,
    drawn: Drawn,
) -> Result<Drawing, Refused> {
    let format = data
        .first()
        .and_then(|(_, first)| first.attribute("format_name"));
    match (data, format) {
        ([(_, trade)], Some(Attribute::Text(kind))) if kind == "stick-slip trade" => {
            let costs = trade.trade().map_err(damaged)?.cost_curves(of);
            let costs = costs.ok_or_else(|| damaged("it has no costs for any statistic".into()))?;
            draw(&Subject::Trade(&costs), drawn)
        }
        ([(_, fit)], Some(Attribute::Text(kind))) if kind == CALIBRATION_FORMAT.0 => {
            draw(&Subject::Dataset(fit), drawn)
        }
        (sweeps, _) => {
            let read = |(name, sweep): &(String, Dataset)| {
                Ok((name.clone(), sweep.sweep().map_err(damaged)?.sweep))
            };
            let sweeps = sweeps.iter().map(read);
            let sweeps = sweeps.collect::<Result<Vec<(String, Sweep)>, Refused>>()?;
            let subject = Subject::Sweep {
                sweeps: &sweeps,
                statistics: of.as_slice(),
            };
            draw(&subject, drawn)
        }
    }
}

fn damaged(problem: String) -> Refused {
    let remedy = "give what run(), trade(), sweep() or calibrate() returned, or load() of its file";
    let subject = ("subject", "a data set".to_string());
    (Some(subject), problem, remedy.into())
}

fn draw(
    subject: &Subject,
    (only, dark, width, log, title, labels): Drawn,
) -> Result<Drawing, Refused> {
    let argument = |name, value: &dyn ToString| Some((name, value.to_string()));
    if !(60.0..=400.0).contains(&width) {
        let problem = "too narrow or too wide for the text".to_string();
        let remedy = "must be between 60 and 400 mm".to_string();
        return Err((argument("width", &width), problem, remedy));
    }
    let theme = if dark { Theme::Dark } else { Theme::Light };
    let style = Style {
        theme,
        width,
        log,
        title: title.as_deref(),
        labels: &labels,
    };
    let only = only.map(|name| {
        let unknown = |problem| {
            (
                argument("only", &name),
                problem,
                "choose a figure that help(stickslip.plot) names".into(),
            )
        };
        Only::named(&name, figures()).map_err(unknown)
    });
    stickslip_figure::draw(only.transpose()?, figures(), subject, &style).map_err(|no| match no {
        NoPage::Without(figure, absent) => {
            let remedy = match absent {
                Absent::Panel(..) => "choose one of them, or omit the letter to draw all",
                _ => "choose another figure or another path",
            };
            (
                argument("only", &figure.name),
                absent.to_string(),
                remedy.into(),
            )
        }
        NoPage::Empty => {
            let problem = "nothing to draw: every path was lost".into();
            (None, problem, "draw another run".into())
        }
        NoPage::Label(name, known) => {
            let remedy = format!("use a statistic, or one of {known}");
            let problem = "the sweep has no such key".into();
            (argument("labels", &name), problem, remedy)
        }
    })
}
