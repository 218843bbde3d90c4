//! A run on very many ranks: the cost of its messages, measured here, and the time that it would
//! take, simulated.
//!
//! The leases are those of the program (`ensemble::Leases`); ranks, clock and network are
//! simulated. Prints the tables of docs/scaling.md.
//!
//! ```text
//! cargo run --release --example scaling
//! ```

mod measured;
mod simulated;

use measured::Costs;
use simulated::{Machine, Outcome, simulate};
use stick_slip::scenario::Scenario;

/// The number of paths of the large run.
const PATHS: u64 = 10_000_000_000;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut scenario = Scenario::shipped("rho025")?;
    for has_rows in [true, false] {
        scenario.record.paths = has_rows;
        let costs = Costs::of(&scenario)?;
        costs.print(has_rows);
        println!(
            "\n| ranks | time | efficiency | rank 0 is busy | a lease | messages | to rank 0 |\n|---|---|---|---|---|---|---|"
        );
        for ranks in [1, 4, 16, 64, 125, 250, 1000] {
            let Outcome { seconds, busy, lease, messages, bytes } = simulate(PATHS, &Machine { ranks, costs: &costs });
            let alone = PATHS as f64 / 256.0 * costs.block;
            println!(
                "| {ranks} | {seconds:.0} s | {:.0} % | {:.0} % | {lease:.2} s | {messages} | {:.2} GB/s |",
                100.0 * alone / seconds / ranks as f64,
                100.0 * busy / seconds,
                bytes / seconds / 1e9
            );
        }
        println!();
    }
    Ok(())
}
