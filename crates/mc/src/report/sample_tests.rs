//! A synthetic run for the tests of the report.

use super::{RunInfo, ShownStatistics};
use ndarray::Array2;
use stickslip::engine::{Provenance, Status};
use stickslip::scenario::{Scenario, Units};
use stickslip::stats::{
    Band, Bands, Distribution, Estimate, FirstSticks, Histogram, PeriodMoments, QUANTILE_LEVELS,
    Record, Statistic, SubPhaseCounts, Summary,
};
use stickslip::sums::Ends;

/// An ensemble like that of `rho025`, with made-up standard errors.
pub fn summary() -> Summary {
    let band = || Band {
        mean: vec![0.0],
        mean_ends: Ends::default(),
        sd: vec![0.0],
        sd_ends: Ends::default(),
        quantiles: Array2::zeros((QUANTILE_LEVELS.len(), 1)),
        quantile_ends: Ends::default(),
    };
    let estimates = Statistic::ALL.map(|statistic| {
        let (estimate, standard_error) = match statistic {
            Statistic::StickDurationMean => (0.538572, 0.000266),
            Statistic::SticksPerPath => (14.1226, 0.0073),
            Statistic::DisplacementEndMean => (-4.2316, 0.016),
            _ => (1.0, 0.01),
        };
        let (low, high) = (
            estimate - 1.96 * standard_error,
            estimate + 1.96 * standard_error,
        );
        Estimate {
            statistic,
            estimate,
            standard_error,
            low,
            high,
            bias: None,
        }
    });
    Summary {
        completed_paths: 10_000,
        diverged: vec![],
        estimates,
        stick_durations: Distribution {
            step: None,
            completed: 141_226,
            censored: 812,
            histogram: Histogram {
                edges: vec![0.0, 1.0],
                counts: vec![141_226],
            },
            censored_counts: vec![812],
            survival: vec![0.0],
            survival_ends: Ends::default(),
            quantiles: vec![0.5; QUANTILE_LEVELS.len()],
            quantile_ends: Ends::default(),
        },
        first_sticks: FirstSticks {
            completed: 10_000,
            censored: 0,
        },
        laws: None,
        densities: None,
        spectrum: None,
        extremes: None,
        cycle: None,
        asked: Statistic::asked_by(&Record::NOTHING),
        sub_phases: SubPhaseCounts {
            counts: vec![100_000, 42_000],
            shares: vec![0.704, 0.296],
            share_ends: Ends::default(),
            censored: 9_000,
        },
        periods: PeriodMoments {
            drift_limit: Some(0.0),
            time: vec![25.1, 50.3],
            mean: vec![0.0; 2],
            mean_ends: Ends::default(),
            variance: vec![1.0; 2],
            variance_ends: Ends::default(),
        },
        transient: None,
        bands: Bands {
            time: vec![0.0],
            displacement: band(),
            velocity: band(),
            temperature: band(),
            static_probability: vec![1.0],
            static_probability_ends: Ends::default(),
        },
    }
}

pub fn info() -> RunInfo {
    RunInfo {
        scenario: "scenarios/rho025.toml".into(),
        provenance: Provenance {
            scheme: "discrete-vi".into(),
            step: Some(0.01),
            seed: 1,
            paths: 10_000,
            units: Units::default(),
            ..Provenance::of(&Scenario::shipped("rho025").expect("shipped"))
        },
        part: None,
        threads: Some(2),
        seconds: Some(0.6),
        bias_seconds: Some(0.0),
        no_bias: None,
        period: None,
        is_free: false,
        steps_per_path: Some(6_000),
        file: "rho025.h5".into(),
        status: Status::Complete,
        ended_by: None,
    }
}

/// The same run with other units.
pub fn info_in(units: Units) -> RunInfo {
    RunInfo {
        provenance: Provenance {
            units,
            ..info().provenance
        },
        ..info()
    }
}

/// The table with everything in it.
pub fn table(summary: &Summary, info: &RunInfo) -> String {
    super::text(&super::run(summary, info, ShownStatistics::All, true))
}

pub fn set(summary: &mut Summary, statistic: Statistic, estimate: f64) {
    for e in summary
        .estimates
        .iter_mut()
        .filter(|e| e.statistic == statistic)
    {
        *e = Estimate {
            estimate,
            standard_error: f64::NAN,
            low: f64::NAN,
            high: f64::NAN,
            ..*e
        };
    }
}

/// The reason why a number in a row is missing, from the row or from a footnote.
pub fn reason<'a>(table: &'a str, name: &str) -> &'a str {
    let row = row(table, name);
    let mark = row.rsplit(' ').next().unwrap_or_default();
    if mark.len() != 3 {
        return row
            .split_once('(')
            .map_or("", |(_, reason)| reason.trim_end_matches(')'));
    }
    table
        .lines()
        .find_map(|line| line.strip_prefix(mark))
        .unwrap_or_else(|| panic!("{mark}:\n{table}"))
        .trim()
}

pub fn row<'a>(table: &'a str, name: &str) -> &'a str {
    table
        .lines()
        .find(|line| line.split(' ').next() == Some(name))
        .unwrap_or_else(|| panic!("{name}:\n{table}"))
}
