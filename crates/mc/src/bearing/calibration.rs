//! Calibrations as results: how the commands show, draw and verify them.

use super::years::Years;
use super::{LEFT_OUT, measurements};
use crate::arguments::threads::Threads;
use crate::commands::plot;
use crate::kinds::{Again, AnyResult, Kind, Shown, StoredResult, pictures};
use crate::output::document::{document, named};
use crate::output::failure::{Failure, warn};
use crate::report::html::Page;
use crate::report::{Report, ShownStatistics};
use crate::session::progress::during;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::fmt::Display;
use std::path::Path;
use std::sync::atomic::AtomicBool;
use stickslip_bearing::calibration::{
    Calibration, CalibrationQuestion, Lag, ParameterEstimate, Quantity, calibrate_again,
};
use stickslip_bearing::dataset::{CALIBRATION_FORMAT, StoredCalibration};
use stickslip_bearing::figures::{FIGURES, years};
use stickslip_bearing::report;
use stickslip_figure::{Drawing, Style, Subject};
use stickslip_files::store::{self, CheckedBytes};

/// A calibration: parameters fitted to a measurement.
pub const CALIBRATION: Kind = Kind {
    name: "a calibration",
    format: CALIBRATION_FORMAT,
    is_resumable: false,
    read: |path| {
        let stored = store::read_kind(path, CALIBRATION_FORMAT, StoredCalibration::read)?;
        Ok(Box::new(stored))
    },
    figures: FIGURES,
};

impl AnyResult for StoredCalibration {
    fn report(&self, file: &Path, shown: &Shown) -> Result<Report, Failure> {
        if let ShownStatistics::These(_) = shown.chosen {
            let problem = format!(
                "--statistics: {} is a calibration, which has no statistics",
                file.display()
            );
            return Err(Failure::usage(problem, "remove it"));
        }
        self.warnings
            .iter()
            .filter(|_| shown.is_text)
            .for_each(|(_, text)| warn(text));
        Ok(report::calibration(&self.title, &self.calibration, false))
    }

    fn json(&self, _: &Path) -> Result<String, Failure> {
        self.warnings.iter().for_each(|(_, text)| warn(text));
        Ok(object(self))
    }

    fn page(&self, _: &Path) -> Result<String, Failure> {
        Ok(page(self, None))
    }
}

impl StoredResult for StoredCalibration {
    fn scenario(&self) -> (String, bool) {
        (self.scenario_text.clone(), false)
    }

    fn other_program(&self) -> Option<String> {
        self.other_program.clone()
    }

    fn draw(&self, asked: &plot::Arguments) -> Result<Drawing, Failure> {
        asked.draw(&Subject::Dataset(&self.dataset()))
    }

    /// The question is read from the scenario again, and the fit is repeated with the record that is
    /// in the file.
    fn again(&self, file: &Path, threads: &Threads, _: CheckedBytes) -> Result<Again, Failure> {
        let wrong = |error: &dyn Display| Failure::Run(format!("{}: {error}", file.display()));
        // A scenario without a title is called by the name of its file.
        let scene =
            measurements::scene_again(&format!("{}.toml", self.title), &self.scenario_text)?;
        let Calibration {
            question, record, ..
        } = &self.calibration;
        let CalibrationQuestion {
            guess,
            shear_stiffness,
            ..
        } = CalibrationQuestion::of(&scene, record);
        let question = CalibrationQuestion {
            guess,
            shear_stiffness,
            held: Vec::new(),
            ..question.clone()
        };
        let is_held = |quantity: &Quantity| {
            self.calibration
                .question
                .held
                .iter()
                .any(|held| held.0 == *quantity)
        };
        let fitted: Vec<Quantity> = Quantity::FITTED
            .into_iter()
            .filter(|quantity| !is_held(quantity))
            .collect();
        let question = question
            .fitting(&fitted, &scene)
            .map_err(|error| wrong(&error))?;
        let mut asked = self.calibration.clone();
        asked.question = question;
        let again = during("calibrating the bearing again", || {
            calibrate_again(&asked, threads.number(), &AtomicBool::new(false))
        });
        let again = again.map_err(|error| wrong(&error))?;
        let again = StoredCalibration::of(&scene.title, &self.scenario_text, again);
        Ok(Again {
            simulated: "the fit, from the record in the file".into(),
            compared: "title, question, estimates, intervals, slips, the model, attributes, coordinates and units",
            found: store::verify(file, &again.dataset())?,
        })
    }
}

/// The page of a calibration, preceded by a forecast if there is one, for readers who did neither.
pub fn page(stored: &StoredCalibration, forecast: Option<&Years>) -> String {
    let StoredCalibration {
        title,
        scenario_text,
        calibration,
        ..
    } = stored;
    let mut tables = report::calibration(title, calibration, true);
    let found = forecast.map(|years| &years.found.forecast);
    let years_of = found.map(|found| report::forecast(title, found, true).tables);
    tables.tables.splice(0..0, years_of.unwrap_or_default());
    let warnings = forecast.map_or_else(|| stored.warnings.clone(), |years| years.found.warnings());
    let program = stored.other_program.clone().unwrap_or_else(crate::version);
    let page = Page {
        report: tables,
        lead: match found {
            Some(found) => report::typical_year(found),
            None => report::found(calibration),
        },
        leading_picture: found.map(|found| years(title, found, &Style::default())),
        warnings: warnings.into_iter().map(|(_, text)| text).collect(),
        words: vec![
            ("Results from the record", report::seen(calibration)),
            ("Symbols", report::SYMBOLS.into()),
            ("Not included", LEFT_OUT.into()),
        ],
        // Readers who did not calibrate do not need them.
        pictures: pictures(FIGURES, &Subject::Dataset(&stored.dataset()), "residuals"),
        scenario: scenario_text,
        provenance: vec![("program", format!("mc {program}"))],
    };
    page.html()
}

/// A calibration for programs, as one JSON object. A number that does not exist is null.
pub fn object(
    StoredCalibration {
        calibration,
        warnings,
        ..
    }: &StoredCalibration,
) -> String {
    let of = |quantities: &[Quantity]| -> BTreeMap<&str, Value> {
        quantities
            .iter()
            .map(|quantity| (quantity.key(), parameter(calibration.estimate(*quantity))))
            .collect()
    };
    let (parameters, derived) = Quantity::ALL.split_at(Quantity::PARAMETERS);
    let (lag, profile) = (&calibration.lag, calibration.lag_profile.as_ref());
    let starts = calibration
        .starts
        .iter()
        .zip(calibration.start_values())
        .map(|(start, values)| {
            let of_start = parameters
                .iter()
                .map(|quantity| (quantity.key(), values[*quantity as usize]));
            json!({ "err": start.err, "parameters": of_start.collect::<BTreeMap<_, _>>() })
        });
    let slips = calibration.slips.iter().map(
        |slip| json!({ "time": slip.time, "temperature": slip.temperature, "jump": slip.jump, "usual": slip.is_usual }),
    );
    let object = json!({
        "parameters": of(parameters),
        "derived": of(derived),
        "interval": calibration.question.level,
        "slips": slips.collect::<Vec<_>>(),
        "lag": {
            "estimate": lag.estimate,
            "low": lag.low,
            "high": lag.high,
            "estimated": calibration.question.lag == Lag::Auto,
            "likeliest": profile.map(|profile| profile.likeliest),
            "gain": profile.map(|profile| profile.gain),
            "clock": profile.and_then(|profile| profile.clock),
            "profile": profile.map_or(&[][..], |profile| &profile.profile[..]),
        },
        "repairs": calibration.record.repairs,
        "roughness": calibration.roughness,
        "zero": { "drift_per_year": calibration.zero.drift_per_year(), "steps": calibration.zero.steps },
        "starts": starts.collect::<Vec<_>>(),
        "residuals": {
            "rms": calibration.residuals.rms,
            "autocorrelation": calibration.residuals.autocorrelation,
        },
        "warnings": named(warnings),
    });
    document("calibration", object)
}

fn parameter(
    ParameterEstimate {
        estimate,
        low,
        high,
    }: ParameterEstimate,
) -> Value {
    json!({ "estimate": estimate, "low": low, "high": high })
}
