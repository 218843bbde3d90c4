//! A user-defined statistic: the share of sticks that last longer than 1.
//!
//! `cargo run --release -p stickslip --example own_statistic`

use stickslip::engine::Run;
use stickslip::model::{Event, EventKind};
use stickslip::noise::AddressedDraws;
use stickslip::scenario::Scenario;
use stickslip::stats::{PathMeans, PathState, Tally};
use stickslip::sums::Measurement;

/// The share of sticks that last longer than this. The first stick of each path is left out.
struct LongSticks(f64);

impl Tally<2> for LongSticks {
    /// The time at which the present stick was entered (none before the first slip), the number of
    /// long sticks, and the number of all sticks that ended.
    type Path = (Option<f64>, f64, f64);

    fn start(&self, _: AddressedDraws) -> Self::Path {
        (None, 0.0, 0.0)
    }

    fn event(&self, (entered, long, ended): &mut Self::Path, event: &Event) {
        match (event.kind, *entered) {
            (EventKind::StickEntered, _) => *entered = Some(event.time),
            (EventKind::SlipStarted(_), Some(start)) => {
                *long += f64::from(u8::from(event.time - start > self.0));
                *ended += 1.0;
            }
            _ => {}
        }
    }

    fn end(&self, (_, long, ended): Self::Path, _: PathState) -> [f64; 2] {
        [long, ended]
    }

    fn estimate(&self, paths: &PathMeans<2>) -> Measurement {
        paths.ratio(0, 1)
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut scenario = Scenario::shipped("rho025")?;
    scenario.ensemble.paths = 4_000;
    let (_, share) = Run::of(&scenario)
        .without_bias()
        .tallied(&LongSticks(1.0))?;
    let Measurement {
        estimate,
        low,
        high,
        ..
    } = share;
    println!("share of sticks longer than 1: {estimate:.4}, 95 % interval [{low:.4}, {high:.4}]");
    Ok(())
}
