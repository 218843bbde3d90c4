//! Forecasts as results: how the commands show and draw them.

use super::calibration::page;
use crate::kinds::{AnyResult, Shown};
use crate::output::dataset;
use crate::output::failure::Failure;
use crate::report::Report;
use std::path::Path;
use stickslip::scenario::BridgeScene;
use stickslip_bearing::dataset::{StoredCalibration, forecast};
use stickslip_bearing::forecast::BearingForecast;
use stickslip_bearing::report;

/// A forecast, with its scenario.
pub struct Years<'a> {
    pub scene: &'a BridgeScene,
    pub found: &'a BearingForecast,
}

impl AnyResult for Years<'_> {
    fn report(&self, _: &Path, _: &Shown) -> Result<Report, Failure> {
        let (title, found) = (&self.scene.title, &self.found.forecast);
        Ok(report::forecast(title, found, false))
    }

    fn json(&self, _: &Path) -> Result<String, Failure> {
        let BridgeScene { title, text, .. } = self.scene;
        let dataset = forecast(title, text, self.found);
        Ok(dataset::json_with(&dataset, &self.found.warnings()))
    }

    fn page(&self, _: &Path) -> Result<String, Failure> {
        let BridgeScene { title, text, .. } = self.scene;
        let stored = StoredCalibration::of(title, text, self.found.calibration.clone());
        Ok(page(&stored, Some(self)))
    }
}
