//! f_s = f_d under noise: which statistics have a limit as the resolution becomes finer, and which
//! depend on the resolution.
//!
//! **The number of sticks.** At a stick exit b = f_s = f_d, so the slip starts with zero net force.
//! Near the threshold b - f_d is a Brownian motion of intensity s = K beta rho sigma, so m x' is an
//! integrated Brownian motion that starts at rest. The resolution, which is a step h or a shortest
//! slip h, gives it a start of that scale. The probability that it has not come back to zero by t
//! then falls like (h/t)^{1/4} (McKean 1963; Sinai 1992), so that slips last t >> h with this tail.
//! A stick ends when the Brownian motion is back at the threshold, with tail (h/t)^{1/2}, and every
//! exit starts anew. Of N slips the longest takes h N^4. It fills the time T in which the force
//! changes, so that N ~ (T/h)^{1/4}, while shares of time, positions and work are determined by the
//! long slips and have limits.
//!
//! Therefore the number of sticks is proportional to h^{-1/4}, and likewise in the shortest slip
//! that the event-driven scheme resolves.

use super::common::estimate;
use stickslip::advice::Warning;
use stickslip::config::Override;
use stickslip::scenario::Scenario;
use stickslip::stats::{Statistic, Summary};
use stickslip_text::numbers::short;

fn scenario(settings: &[(&str, String)]) -> Scenario {
    let overrides: Vec<Override> = settings
        .iter()
        .map(|(key, value)| Override::flag("--set", key, value))
        .collect();
    Scenario::read("scenarios/equal-friction.toml".as_ref(), &overrides)
        .unwrap_or_else(|e| panic!("{e}"))
}

/// The weighted fit of ln(sticks) as a linear function of ln(resolution): slope, its standard
/// error, chi square.
fn exponent(rows: &[(f64, (f64, f64))]) -> (f64, f64, f64) {
    let points: Vec<_> = rows
        .iter()
        .map(|(r, (n, e))| (r.ln(), n.ln(), (n / e).powi(2)))
        .collect();
    let w: f64 = points.iter().map(|p| p.2).sum();
    let mean = |f: fn(&(f64, f64, f64)) -> f64| points.iter().map(|p| p.2 * f(p)).sum::<f64>() / w;
    let (mx, my) = (mean(|p| p.0), mean(|p| p.1));
    let sxx: f64 = points.iter().map(|p| p.2 * (p.0 - mx).powi(2)).sum();
    let slope = points
        .iter()
        .map(|p| p.2 * (p.0 - mx) * (p.1 - my))
        .sum::<f64>()
        / sxx;
    let chi = points
        .iter()
        .map(|p| p.2 * (p.1 - my - slope * (p.0 - mx)).powi(2))
        .sum();
    (slope, sxx.sqrt().recip(), chi)
}

/// The statistics that have a limit.
const SETTLED: [Statistic; 4] = [
    Statistic::StickingFraction,
    Statistic::DisplacementEndMean,
    Statistic::DisplacementEndSd,
    Statistic::FrictionWorkMean,
];

fn show(resolution: f64, summary: &Summary) {
    let of = |s| estimate(summary, s);
    print!(
        "{resolution:.3e}: sticks {:.2} +- {:.2}",
        of(Statistic::SticksPerPath).0,
        of(Statistic::SticksPerPath).1
    );
    for s in SETTLED {
        print!(", {} {:.4} +- {:.4}", s.name(), of(s).0, of(s).1);
    }
    println!();
}

#[test]
fn sticks_multiply_at_finer_resolution_the_rest_settles() {
    let by_step: Vec<(f64, Summary)> = (0..5)
        .map(|k| {
            let h = 0.005 / 4f64.powi(k);
            let scenario = scenario(&[
                ("time.step", format!("{h}")),
                ("ensemble.paths", "256".into()),
            ]);
            assert!(
                scenario
                    .warnings()
                    .iter()
                    .any(|warning| warning.name() == "equal-friction")
            );
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
            let says = short(resolution.shortest_slip);
            let is_said = |warning: &Warning| {
                warning.name() == "resolution" && warning.to_string().contains(&says)
            };
            assert!(scenario.warnings().iter().any(is_said));
            (resolution.shortest_slip, scenario.plan().run(2))
        })
        .into();
    // Null hypothesis: the statistics with a limit are equal for every resolution, up to the error
    // of the step, which here is below a standard error. Sample size: 10 runs compared with the one
    // of the finest tolerance, fixed seed. False-alarm rate: 1e-4 for each of 4 comparisons in a
    // run, at 3.9 combined standard errors. The numbers of sticks differ by a factor of 44
    // meanwhile.
    let (_, finest) = &by_tolerance[4];
    for (resolution, summary) in by_step.iter().chain(&by_tolerance[..4]) {
        for statistic in SETTLED {
            let ((a, ea), (b, eb)) = (estimate(summary, statistic), estimate(finest, statistic));
            assert!(
                (a - b).abs() <= 3.9 * ea.hypot(eb),
                "{resolution:e} {}: {a} {b}",
                statistic.name()
            );
        }
    }
    for runs in [&by_step, &by_tolerance] {
        runs.iter().for_each(|(r, summary)| show(*r, summary));
        let rows: Vec<_> = runs
            .iter()
            .map(|(r, summary)| (*r, estimate(summary, Statistic::SticksPerPath)))
            .collect();
        let (slope, error, chi) = exponent(&rows);
        println!("sticks ~ resolution^{slope:.4} +- {error:.4}, chi square {chi:.1}");
        // 0.02 is four standard errors of the fit over the steps. A number of sticks proportional
        // to h^{-1/2}, or one with a limit, is far outside.
        assert!(
            (slope + 0.25).abs() < 0.02 && chi < 21.1,
            "{slope} +- {error}"
        );
    }
}

/// The warnings of `mc check` and `mc run` say which statistics have a limit.
#[test]
fn the_warning_says_which_statistics_have_a_limit() {
    for scheme in ["discrete-vi", "corrected-vi", "event-driven"] {
        let scenario = scenario(&[("scheme.kind", scheme.into())]);
        let texts: Vec<String> = scenario
            .warnings()
            .iter()
            .map(ToString::to_string)
            .collect();
        let says = |text: &&String| {
            text.contains("Stick counts and durations depend on")
                && text.contains("sticking fraction and positions converge")
        };
        assert_eq!(texts.iter().filter(says).count(), 1, "{scheme}: {texts:?}");
    }
}
