//! The cheapest runs that the file of a trade holds, as a table.

use crate::cli::numbers::{grouped, percent, significant, time};
use crate::cli::table::{TableRow, aligned};
use stick_slip::stats::Statistic;
use stick_slip::store::StoredTrade;
use stick_slip::study::trade::{Choice, TARGETS};

/// What the columns mean.
pub const LEGEND: &str = "The cheapest run for a root mean square error of this size; CPU time on one thread. Paths marked p are\n\
                          antithetic pairs. `none`: no run that was measured or predicted reaches it.";

/// The cheapest run for each statistic and target; none if no run reaches the target.
fn cheapest(stored: &StoredTrade) -> impl Iterator<Item = (Statistic, f64, Option<Choice>)> {
    let of = |statistic, target| (statistic, target, stored.trade.best(None, &[statistic], target).ok());
    Statistic::ALL.into_iter().flat_map(move |statistic| TARGETS.map(|target| of(statistic, target)))
}

/// The table for people: the cheapest run for each statistic and target.
pub fn stored_table(trade: &StoredTrade) -> String {
    format!("{}\n\n{}\n{LEGEND}\n", trade.scenario.title, aligned(&stored_rows(trade, Statistic::name), "  "))
}

/// The rows of the table, headings first, with statistics as `named`.
pub fn stored_rows(trade: &StoredTrade, named: impl Fn(Statistic) -> &'static str) -> Vec<TableRow> {
    let mut rows = vec![TableRow::labelled("statistic", ["error", "scheme", "step or tolerance", "paths", "CPU time"])];
    let mut last = None;
    for (statistic, target, cheapest) in cheapest(trade) {
        let cells = match cheapest {
            Some(Choice { scheme, paths, is_antithetic, seconds, .. }) => {
                let pairs = if is_antithetic { " p" } else { "" };
                [
                    scheme.name().to_string(),
                    significant(scheme.parameter(), 3),
                    format!("{}{pairs}", grouped(paths)),
                    time(seconds),
                ]
            }
            None => ["none", "", "", ""].map(String::from),
        };
        let name = if last == Some(statistic) { "" } else { named(statistic) };
        rows.push(TableRow::labelled(name, std::iter::once(percent(target)).chain(cells)));
        last = Some(statistic);
    }
    rows
}
