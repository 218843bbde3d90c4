//! A statistic with chance of its own: inspectors come at random, as a Poisson process, and see
//! whether the body sticks. Poisson arrivals see time averages (R. W. Wolff, *Operations Research*
//! 30 (1982)), so the share that finds it stuck is the sticking fraction.
//!
//! `cargo run --release -p stickslip --example own_chance`

use rand_distr::{Distribution as _, Exp};
use stickslip::engine::Run;
use stickslip::model::{Event, EventKind};
use stickslip::noise::AddressedDraws;
use stickslip::scenario::Scenario;
use stickslip::stats::{PathMeans, PathState, Statistic, Tally};
use stickslip::sums::Measurement;

/// The time between two inspections.
struct Inspections(Exp<f64>);

/// One path, seen by its inspectors.
#[derive(Clone)]
struct Inspected {
    /// The random numbers of the path that its noise does not use.
    draws: AddressedDraws,
    next: f64,
    is_stuck: bool,
    stuck: f64,
    all: f64,
}

impl Inspections {
    /// The inspections before this time, which all see the same phase.
    fn until(&self, path: &mut Inspected, time: f64) {
        while path.next < time {
            path.all += 1.0;
            path.stuck += f64::from(u8::from(path.is_stuck));
            path.next += self.0.sample(&mut path.draws);
        }
    }
}

impl Tally<2> for Inspections {
    type Path = Inspected;

    fn start(&self, mut draws: AddressedDraws) -> Inspected {
        let next = self.0.sample(&mut draws);
        Inspected {
            draws,
            next,
            is_stuck: true,
            stuck: 0.0,
            all: 0.0,
        }
    }

    fn event(&self, path: &mut Inspected, event: &Event) {
        self.until(path, event.time);
        match event.kind {
            EventKind::StickEntered => path.is_stuck = true,
            EventKind::SlipStarted(_) => path.is_stuck = false,
            _ => {}
        }
    }

    fn end(&self, mut path: Inspected, state: PathState) -> [f64; 2] {
        self.until(&mut path, state.time);
        [path.stuck, path.all]
    }

    fn estimate(&self, paths: &PathMeans<2>) -> Measurement {
        paths.ratio(0, 1)
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut scenario = Scenario::shipped("rho025")?;
    scenario.ensemble.paths = 4_000;
    let (outcome, stuck) = Run::of(&scenario)
        .without_bias()
        .tallied(&Inspections(Exp::new(0.2)?))?;
    let Measurement {
        estimate,
        standard_error,
        ..
    } = stuck;
    let sticking = outcome
        .summary
        .estimate(Statistic::StickingFraction)
        .estimate;
    println!(
        "stuck at {estimate:.4} +- {standard_error:.4} of inspections; sticking fraction {sticking:.4}"
    );
    // 4 standard errors: wrong once in 16 000 seeds.
    assert!((estimate - sticking).abs() < 4.0 * standard_error);
    Ok(())
}
