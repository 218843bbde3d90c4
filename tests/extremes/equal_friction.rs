//! f_s = f_d under noise: what has a limit as the resolution gets finer, and what is a property of
//! the resolution.
//!
//! **How many sticks.** At a stick exit b = f_s = f_d: the slip starts without a push. Near the
//! threshold b - f_d is a Brownian motion of intensity s = K beta rho sigma, so m x' is an
//! integrated Brownian motion from rest. What the scheme does not resolve, a step h or a shortest
//! slip, gives it a start of that scale, and the chance not to have come back to zero by t falls
//! like (h/t)^{1/4} (McKean 1963; Sinai 1992): slips last t >> h with that tail. A stick ends when
//! the Brownian motion is back at the threshold, with tail (h/t)^{1/2}; every exit starts afresh.
//! Of N slips the longest takes h N^4, which fills the time T in which the force changes: N ~
//! (T/h)^{1/4} sticks, while shares of time, positions and work are those of the long slips and
//! have limits.
//!
//! So sticks ~ h^{-1/4}, and likewise in the shortest slip that the event-driven scheme resolves.

use super::common::estimate;
use stick_slip::advice::{EqualFriction, Unresolved};
use stick_slip::config::Override;
use stick_slip::scenario::Scenario;
use stick_slip::stats::{Statistic, Summary};

fn scenario(settings: &[(&str, String)]) -> Scenario {
    let overrides: Vec<Override> = settings.iter().map(|(key, value)| Override::flag("--set", key, value)).collect();
    Scenario::read("scenarios/equal-friction.toml".as_ref(), &overrides).unwrap_or_else(|e| panic!("{e}"))
}

/// The weighted fit of ln(sticks) on ln(resolution): slope, its standard error, chi square.
fn exponent(rows: &[(f64, (f64, f64))]) -> (f64, f64, f64) {
    let points: Vec<_> = rows.iter().map(|(r, (n, e))| (r.ln(), n.ln(), (n / e).powi(2))).collect();
    let w: f64 = points.iter().map(|p| p.2).sum();
    let mean = |f: fn(&(f64, f64, f64)) -> f64| points.iter().map(|p| p.2 * f(p)).sum::<f64>() / w;
    let (mx, my) = (mean(|p| p.0), mean(|p| p.1));
    let sxx: f64 = points.iter().map(|p| p.2 * (p.0 - mx).powi(2)).sum();
    let slope = points.iter().map(|p| p.2 * (p.0 - mx) * (p.1 - my)).sum::<f64>() / sxx;
    let chi = points.iter().map(|p| p.2 * (p.1 - my - slope * (p.0 - mx)).powi(2)).sum();
    (slope, sxx.sqrt().recip(), chi)
}

/// What has a limit.
const SETTLED: [Statistic; 4] = [
    Statistic::StickingFraction,
    Statistic::DisplacementEndMean,
    Statistic::DisplacementEndSd,
    Statistic::FrictionWorkMean,
];

fn show(resolution: f64, summary: &Summary) {
    let of = |s| estimate(summary, s);
    print!("{resolution:.3e}: sticks {:.2} +- {:.2}", of(Statistic::SticksPerPath).0, of(Statistic::SticksPerPath).1);
    for s in SETTLED {
        print!(", {} {:.4} +- {:.4}", s.name(), of(s).0, of(s).1);
    }
    println!();
}

#[test]
fn sticks_multiply_as_the_resolution_gets_finer_and_the_rest_settles() {
    let by_step: Vec<(f64, Summary)> = (0..5)
        .map(|k| {
            let h = 0.005 / 4f64.powi(k);
            let scenario = scenario(&[("time.step", format!("{h}")), ("ensemble.paths", "256".into())]);
            assert!(scenario.warnings().contains(&EqualFriction.into()));
            (h, scenario.plan().run(2))
        })
        .collect();
    let by_tolerance: Vec<(f64, Summary)> = [1e-2, 1e-3, 1e-4, 1e-5, 1e-6]
        .map(|tolerance: f64| {
            let scenario = scenario(&[
                ("scheme.kind", "event-driven".into()),
                ("scheme.tolerance", format!("{tolerance}")),
                ("ensemble.paths", "512".into()),
            ]);
            let resolution = scenario.resolution().expect("stated");
            assert!(scenario.warnings().contains(&Unresolved { resolution }.into()));
            (resolution.shortest_slip, scenario.plan().run(2))
        })
        .into();
    // Null: equal up to the error of the step in what settles, below a standard error here. 10 runs
    // against the finest of the second kind, 4 comparisons each at 3.9 combined standard errors
    // (1e-4); fixed seed. Sticks differ by a factor 44 meanwhile.
    let (_, finest) = &by_tolerance[4];
    for (resolution, summary) in by_step.iter().chain(&by_tolerance[..4]) {
        for statistic in SETTLED {
            let ((a, ea), (b, eb)) = (estimate(summary, statistic), estimate(finest, statistic));
            assert!((a - b).abs() <= 3.9 * ea.hypot(eb), "{resolution:e} {}: {a} {b}", statistic.name());
        }
    }
    for runs in [&by_step, &by_tolerance] {
        runs.iter().for_each(|(r, summary)| show(*r, summary));
        let rows: Vec<_> = runs.iter().map(|(r, summary)| (*r, estimate(summary, Statistic::SticksPerPath))).collect();
        let (slope, error, chi) = exponent(&rows);
        println!("sticks ~ resolution^{slope:.4} +- {error:.4}, chi square {chi:.1}");
        // 0.02 is four standard errors of the steps; a count that falls like h^{-1/2}, or one with
        // a limit, is far outside.
        assert!((slope + 0.25).abs() < 0.02 && chi < 21.1, "{slope} +- {error}");
    }
}

/// The engine says which is which, in the words of `mc check` and `mc run`.
#[test]
fn the_warning_says_which_statistics_have_a_limit() {
    for scheme in ["discrete-vi", "corrected-vi", "event-driven"] {
        let scenario = scenario(&[("scheme.kind", scheme.into())]);
        let texts: Vec<String> = scenario.warnings().iter().map(ToString::to_string).collect();
        let says = |text: &&String| {
            text.contains("Stick counts and durations here are properties of")
                && text.contains("sticking fraction and positions do have limits")
        };
        assert_eq!(texts.iter().filter(says).count(), 1, "{scheme}: {texts:?}");
    }
}
