//! A scenario without a text.

use super::Scenario;
use crate::model::{NamedSeries, Series};
use crate::scheme::CheckError;
use std::sync::Arc;

impl Scenario {
    /// Nothing: only a text names measured values.
    pub fn samples(&self) -> Vec<NamedSeries> {
        Vec::new()
    }

    /// Nothing: only a text can express every scenario.
    pub(crate) fn to_toml(&self) -> String {
        String::new()
    }

    pub(crate) fn series_start(&self) -> Option<String> {
        None
    }

    pub(super) fn inputs(&self) -> impl Iterator<Item = (String, &Arc<Series>)> {
        std::iter::empty()
    }

    pub(super) fn check_white_noise(&self) -> Option<CheckError> {
        None
    }

    pub(super) fn as_written(&self, check_error: CheckError) -> CheckError {
        check_error
    }
}
