//! Trades as results: how the commands show, draw and verify them.

use super::{Again, AnyResult, Kind, Shown, StoredResult, page, pictures, provenance};
use crate::arguments::threads::Threads;
use crate::commands::plot;
use crate::output::dataset;
use crate::output::failure::Failure;
use crate::report::{self, Report, ShownStatistics};
use std::path::Path;
use stickslip::dataset::{Dataset, TRADE_FORMAT};
use stickslip_figure::{Drawing, Subject};
use stickslip_files::store::{self, CheckedBytes, StoredTrade};

/// A trade: the cost of accuracy for each scheme.
pub const TRADE: Kind = Kind {
    name: "a trade",
    format: TRADE_FORMAT,
    is_resumable: false,
    read: |path| Ok(Box::new(store::read_trade(path)?)),
    figures: stickslip_figure::TRADE,
};

impl AnyResult for StoredTrade {
    fn report(&self, _: &Path, shown: &Shown) -> Result<Report, Failure> {
        let title = &self.scenario.title;
        Ok(match shown.all && shown.is_text {
            true => report::trade(title, &self.trade, None),
            false => report::costs(title, &self.trade, shown.chosen),
        })
    }

    fn json(&self, file: &Path) -> Result<String, Failure> {
        let dataset = Dataset::of_trade(&self.scenario, &self.trade);
        Ok(dataset::json(&dataset, Some(file)))
    }

    fn page(&self, file: &Path) -> Result<String, Failure> {
        let scenario = self.scenario.to_toml();
        let mut page = page(file, &scenario);
        if let Some(costs) = self.cost_curves(None) {
            page.pictures = pictures(TRADE.figures, &Subject::Trade(&costs), "");
        }
        page.report = report::costs(&self.scenario.title, &self.trade, ShownStatistics::First);
        page.provenance = provenance(file, self.other_program.as_deref());
        Ok(page.html())
    }
}

impl StoredResult for StoredTrade {
    fn scenario(&self) -> (String, bool) {
        let scenario = &self.scenario;
        (scenario.to_toml(), !scenario.written.measured.is_empty())
    }

    fn other_program(&self) -> Option<String> {
        self.other_program.clone()
    }

    fn draw(&self, asked: &plot::Arguments) -> Result<Drawing, Failure> {
        let nothing = || {
            Failure::run_of(
                &asked.subject,
                "it has no costs for any statistic",
                "measure again with a larger --budget",
            )
        };
        let costs = self.cost_curves(asked.statistic).ok_or_else(nothing)?;
        asked.draw(&Subject::Trade(&costs))
    }

    /// Everything that follows from its measurements is computed again.
    fn again(&self, file: &Path, _: &Threads, _: CheckedBytes) -> Result<Again, Failure> {
        let again = Dataset::of_trade(&self.scenario, &self.trade);
        Ok(Again {
            simulated: "nothing: times cannot be reproduced, and estimates depend on them".into(),
            compared: "every bias, order and prediction with the stored measurements, attributes, \
                       coordinates and units",
            found: store::verify(file, &again)?,
        })
    }
}
