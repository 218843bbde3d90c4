//! Laws that were fitted to a distribution, as a table and as JSON.

use crate::cli::document::document;
use crate::cli::numbers::{Digits, significant};
use crate::cli::table::{Row, aligned};
use serde_json::{Map, json};
use stick_slip::stats::{Family, Fit, PhaseLaw};

/// The table: a row for each parameter.
pub fn fits_table(law: PhaseLaw, from: f64, unit: &str, fits: &[Fit]) -> String {
    let headings = ["parameter", "estimate", "95 % from", "to", "distance"];
    let mut rows = vec![Row::labelled("law", headings).noted(if unit.is_empty() { "" } else { "unit" })];
    for fit in fits {
        for (i, (name, [value, low, high])) in fit.family.parameters().iter().zip(&fit.parameters).enumerate() {
            let digits = Digits::of(*value, (high - low) / 4.0);
            let ends = if low.is_finite() { digits.show_all([*low, *high]) } else { ["none".into(), String::new()] };
            let [low, high] = ends;
            let distance = if i == 0 { significant(fit.distance, 2) } else { String::new() };
            let family = if i == 0 { fit.family.name() } else { "" };
            let has_unit = matches!((fit.family, *name), (Family::Exponential, _) | (Family::Weibull, "scale"));
            let cells = [(*name).to_string(), digits.show(*value), low, high, distance];
            rows.push(Row::labelled(family, cells).noted(if has_unit { unit } else { "" }));
        }
    }
    let beyond = if from > 0.0 { format!(", beyond {from:?}") } else { String::new() };
    format!(
        "laws fitted to the {}{beyond}\n\n{}\nintervals come from batches of paths; the distance is the largest \
         difference between the law and the survival curve\n",
        law.words(),
        aligned(&rows, "  ")
    )
}

/// The same as one JSON object.
pub fn fits_json(law: PhaseLaw, from: f64, fits: &[Fit]) -> String {
    let fits = fits.iter().map(|fit| {
        let named = fit.family.parameters().iter().zip(&fit.parameters);
        let parameters = named.map(|(name, [estimate, low, high])| {
            ((*name).to_string(), json!({ "estimate": estimate, "low": low, "high": high }))
        });
        json!({
            "family": fit.family.name(),
            "parameters": parameters.collect::<Map<_, _>>(),
            "distance": fit.distance,
        })
    });
    document("fit", json!({ "law": law.name(), "beyond": from, "fits": fits.collect::<Vec<_>>() }))
}
