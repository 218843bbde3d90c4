//! What multilevel Monte Carlo takes for two means of `scenarios/rho025.toml`, level by level, on
//! one thread.
//!
//!     cargo run --release --example multilevel

mod method;

use method::Multilevel;
use std::error::Error;
use std::sync::atomic::AtomicBool;
use std::time::Instant;
use stickslip::scenario::Scenario;
use stickslip::stats::Statistic;

fn main() -> Result<(), Box<dyn Error>> {
    let scenario = Scenario::read("scenarios/rho025.toml".as_ref(), &[])?;
    // The approximate values of the statistics, to which targets are relative.
    for (statistic, value) in [
        (Statistic::DisplacementEndMean, 4.22),
        (Statistic::FrictionWorkMean, 69.6),
    ] {
        let means = Multilevel::new(
            &scenario.model,
            scenario.time.end,
            statistic,
            scenario.ensemble.seed,
        )
        .ok_or("not a mean over paths, or no noise")?;
        for target in [1e-2, 1e-3, 3e-4] {
            let start = Instant::now();
            let outcome = means.run(target * value, 1, &AtomicBool::new(false))?;
            println!(
                "{} to {target}: {:.2} s",
                statistic.name(),
                start.elapsed().as_secs_f64()
            );
            println!(
                "  {:.4} +- {:.4}, bias {:.4}",
                outcome.estimate, outcome.standard_error, outcome.bias
            );
            for level in &outcome.levels {
                println!(
                    "  h {:.5}  {:8} paths  variance {:.5}",
                    level.step, level.paths, level.variance
                );
            }
        }
    }
    Ok(())
}
