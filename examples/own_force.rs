//! A user-defined force in Rust: a spring that hardens, beside that of the scenario.
//!
//! `cargo run --release -p stickslip --example own_force`

use stickslip::engine::Run;
use stickslip::lanes::Lanes;
use stickslip::model::{Force, ForceLaw};
use stickslip::scenario::Scenario;
use stickslip::scheme::EventDriven;
use stickslip::stats::Statistic;

/// g = -k3 x^3.
#[derive(Debug)]
struct Hardening(f64);

impl ForceLaw for Hardening {
    #[inline(always)]
    fn value<L: Lanes>(&self, x: L, _velocity: L, _time: L) -> L {
        -(x * x * x * self.0)
    }

    fn depends_on_time(&self) -> bool {
        false
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut scenario = Scenario::shipped("rho025")?.with_scheme(EventDriven { tolerance: 1e-3 })?;
    scenario.model.force = Some(Force::new(Hardening(0.02)));
    let outcome = Run::of(&scenario).paths(10_000).simulate()?;
    let sticks = outcome.summary.estimate(Statistic::StickDurationMean);
    println!(
        "mean stick {:.4} +- {:.4}",
        sticks.estimate, sticks.standard_error
    );
    Ok(())
}
