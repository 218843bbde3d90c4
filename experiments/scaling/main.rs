//! A run on very many ranks: the cost of its messages, measured here, and the time that it would
//! take, simulated.
//!
//! The leases are those of the program (`mpi/src/leases.rs`); ranks, clock and network are
//! simulated. Prints the tables of docs/scaling.md.
//!
//! ```text
//! cargo run --release --example scaling
//! ```

#[expect(dead_code, reason = "the ranks use more of it")]
#[path = "../../mpi/src/leases.rs"]
mod leases;
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
        costs.print();
        println!(
            "\n| ranks | paths | file | efficiency | rank 0 is busy | a lease | to rank 0 |\n|---|---|---|---|---|---|---|"
        );
        let blocks = PATHS as f64 / 256.0;
        let file = costs.rows.map_or(0.0, |rows| rows.filed * blocks);
        for ranks in [1, 4, 16, 64, 250, 1000, 4000] {
            let Outcome { seconds, busy, lease, bytes } = simulate(PATHS, &Machine { ranks, costs: &costs });
            println!(
                "| {ranks} | {seconds:.0} s | {file:.0} s | {:.0} % | {:.0} % | {lease:.2} s | {:.3} GB/s |",
                100.0 * blocks * costs.block / (seconds + file) / ranks as f64,
                100.0 * busy / seconds,
                bytes / seconds / 1e9
            );
        }
        println!();
    }
    Ok(())
}
