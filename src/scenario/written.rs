//! How a text spells a scenario, in addition to the physics that it describes.

use super::{INPUT, Scenario, TEMPERATURE_SERIES, WhiteNoise};
use crate::model::{
    Expression, NamedSeries, OrnsteinUhlenbeck, Oscillator, RandomInput, RandomProcess,
    Realisations, Series,
};
use crate::scheme::CheckError;
use std::sync::Arc;
use stickslip_data::Layout;

/// How a text spells a scenario. It does not affect the simulation.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct AsWritten {
    /// The measured temperature, if there is one, and then the inputs.
    pub measured: Vec<Measured>,
    /// The parameters with their values, which expressions contain and numbers name.
    pub parameters: Vec<(String, f64)>,
    /// The numbers that are written as the name of a parameter: the dotted key, and the name.
    pub named: Vec<(String, String)>,
    /// Whether x(0) is given as "balanced": it is then beta E T(0), at zero spring force.
    pub is_balanced: bool,
    /// White noise, if the scenario has it; the model contains a fast noise instead.
    pub white_noise: Option<WhiteNoise>,
    /// The noise beside white noise, which the model draws as a temperature of its own.
    pub beside_white: Option<OrnsteinUhlenbeck>,
    /// The user-defined force, if there is one. A linear one is in the stiffness and the damping of
    /// the model.
    pub force: Option<WrittenForce>,
    /// The realisations of random inputs in the model, by their tables.
    pub realised: Vec<(String, Arc<Series>)>,
}

/// A user-defined force as written in a scenario.
#[derive(Clone, Debug, PartialEq)]
pub struct WrittenForce {
    /// The expression, with its parameters.
    pub expression: Expression,
    /// The body as written, if the force is linear: the force is then part of the stiffness and
    /// damping of the model.
    pub without: Option<Oscillator>,
}

/// Measured values, and their source as stated in the scenario.
#[derive(Clone, Debug)]
pub struct Measured {
    /// The table that describes them, such as `temperature.series` or `input.ag`.
    pub table: String,
    /// The samples, which are also in the model.
    pub series: Arc<Series>,
    /// The file as the scenario names it, relative to the folder of the scenario.
    pub file: String,
    /// The name of the column of values; empty if the file has no columns.
    pub value: String,
    /// The unit in the file, if given: for temperatures by the scenario, for inputs by the scenario
    /// or the file.
    pub unit: Option<String>,
    /// The first time in a column of numbers, which is t = 0.
    pub begin: f64,
    /// The layout of the file, with the name of the time column.
    pub layout: Layout,
    /// The longest time allowed between two samples; `None` for no limit.
    pub max_gap: Option<f64>,
    /// The stamp of t = 0, if the file has stamps.
    pub start: Option<String>,
    /// Whether each value of the file lasts until the next one, in place of a straight line.
    pub is_held: bool,
    /// What was repaired in the file, in sentences; empty if the samples come from the file of a
    /// run.
    pub repairs: Vec<String>,
    /// The process from which each path draws the values, if they are not measured; the samples are
    /// those of the first path.
    pub random: Option<RandomInput>,
}

/// The repairs are not compared, because they are known only when the data file itself is read.
impl PartialEq for Measured {
    fn eq(&self, other: &Self) -> bool {
        let said = |m: &Self| {
            (
                m.file.clone(),
                m.value.clone(),
                m.unit.clone(),
                m.layout.clone(),
                m.start.clone(),
            )
        };
        let are_same = self.table == other.table && self.series == other.series;
        are_same
            && said(self) == said(other)
            && self.max_gap == other.max_gap
            && self.random == other.random
    }
}

impl Measured {
    /// Whether the samples belong to the scenario: a measurement, a spectrum or realisations.
    pub(crate) fn is_in_file(&self) -> bool {
        let process = self.random.as_ref().map(|random| &random.process);
        process.is_none_or(|process| {
            let is_spectrum = matches!(process, RandomProcess::Spectrum(_));
            is_spectrum || process.name() == Realisations::OF_FILE
        })
    }

    /// The name of an input, if it is one.
    pub fn input(&self) -> Option<&str> {
        self.table.strip_prefix(INPUT)
    }
}

impl Scenario {
    /// The inputs that the force and the load may name, each with the values on the path of the
    /// scenario, the first unless it is replayed.
    pub fn inputs_of_path(&self) -> impl Iterator<Item = (&Measured, &Series)> {
        let all = self.written.measured.iter();
        all.filter(|of| of.input().is_some()).map(|of| {
            let mut all = self.written.realised.iter();
            let realised = all.find(|(name, _)| *name == of.table);
            (of, &**realised.map_or(&of.series, |(_, series)| series))
        })
    }

    /// All measured values, each by the table that describes it.
    pub fn samples(&self) -> Vec<NamedSeries> {
        let samples = |measured: &Measured| NamedSeries {
            name: measured.table.clone(),
            series: measured.series.clone(),
        };
        let measured = self.written.measured.iter();
        measured.filter(|of| of.is_in_file()).map(samples).collect()
    }

    /// The stamp of t = 0 of the measured temperature, if its file has stamps.
    pub(crate) fn series_start(&self) -> Option<String> {
        let mut all = self.written.measured.iter();
        all.find(|measured| measured.table == TEMPERATURE_SERIES)?
            .start
            .clone()
    }

    /// The inputs, each with the words for it in messages.
    pub(super) fn inputs(&self) -> impl Iterator<Item = (String, &Arc<Series>)> {
        let measured = self.written.measured.iter();
        measured.filter(|of| of.random.is_none()).filter_map(|of| {
            let what = format!("the input `{}` ({})", of.input()?, of.file);
            Some((what, &of.series))
        })
    }

    /// Under white noise the force on a body at rest exceeds every threshold immediately.
    pub(super) fn check_white_noise(&self) -> Option<CheckError> {
        self.written.white_noise?.check_error(&self.model)
    }

    /// An error of the stiffness or the damping is attributed to a linear force that changed it.
    pub(super) fn as_written(&self, check_error: CheckError) -> CheckError {
        let Some(WrittenForce {
            expression,
            without: Some(body),
        }) = &self.written.force
        else {
            return check_error;
        };
        let (what, before) = match check_error.about.first() {
            Some(("oscillator.stiffness", _)) => ("stiffness K", body.stiffness),
            Some(("oscillator.damping", _)) => ("damping alpha", body.damping),
            _ => return check_error,
        };
        let value = check_error.about[0].1;
        if value == before {
            return check_error;
        }
        let problem = format!(
            "`force.expression` = \"{}\" is linear, and makes the {what} {value:?}, which {}",
            expression.shown(),
            check_error.problem
        );
        CheckError::new(
            &[("force.expression", f64::NAN)],
            problem,
            check_error.remedy,
        )
    }
}
