//! Measures what a block, its rows and its sums cost on this machine.

use std::io::Write as _;
use std::time::Instant;
use stick_slip::ensemble::Plan;
use stick_slip::scenario::Scenario;
use stick_slip::stats::{Reader, RunTotals, Totals};
use stick_slip::store;

/// The lengths in blocks of the leases that are measured: a short lease, and one whose sketches are
/// full.
const LEASES: [u64; 2] = [8, 128];

/// Costs in seconds and bytes.
pub struct Costs {
    /// Seconds to simulate and sum a block.
    pub block: f64,
    /// Bytes of the rows of a block, and seconds that rank 0 needs for them.
    pub rows: [f64; 2],
    /// Bytes of the sums of a lease, seconds to write them, and seconds that rank 0 needs to read
    /// and to join them, for a short lease and for a long one.
    pub sums: [[f64; 3]; 2],
}

/// Seconds that some work takes: the least of several measurements, because other programs may be
/// running.
fn fastest(
    mut work: impl FnMut() -> Result<(), Box<dyn std::error::Error>>,
) -> Result<f64, Box<dyn std::error::Error>> {
    let mut least = f64::INFINITY;
    for _ in 0..7 {
        let start = Instant::now();
        work()?;
        least = start.elapsed().as_secs_f64().min(least);
    }
    Ok(least)
}

impl Costs {
    pub fn of(scenario: &Scenario) -> Result<Costs, Box<dyn std::error::Error>> {
        let plan = Plan { paths: 1 << 20, ..scenario.plan() };
        let empty = RunTotals::empty(plan.model(), plan.timeline());
        let (mut block, mut rows, mut sums) = (f64::INFINITY, [0.0; 2], [[0.0; 3]; 2]);
        let mut first = 0;
        for (lease, sums) in LEASES.into_iter().zip(&mut sums) {
            let (mut totals, mut bytes) = (empty.clone(), Vec::new());
            for index in first..first + lease {
                let start = Instant::now();
                let result = plan.block(index);
                store::write_block(&result, &mut bytes);
                totals.push(index, result.totals)?;
                block = start.elapsed().as_secs_f64().min(block);
            }
            // The rows are read and written to a log.
            let none = Totals::empty(plan.model(), &plan.timeline().without_rows());
            let taken = fastest(|| {
                let (mut from, mut log, mut file) = (Reader::new(&bytes), Vec::new(), tempfile::tempfile()?);
                for _ in 0..lease {
                    store::write_block(&store::read_block(&mut from, &none)?, &mut log);
                }
                file.write_all(&log)?;
                Ok(())
            })?;
            rows = [bytes.len() as f64, taken].map(|all| all / lease as f64);
            // The sums are written, read, and joined to those of as many blocks.
            let mut before = empty.clone();
            (0..first).try_for_each(|index| before.push(index, plan.block(index).totals))?;
            first += lease;
            let sent = totals.to_bytes();
            let written = fastest(|| {
                totals.to_bytes();
                Ok(())
            })?;
            let joined = fastest(|| {
                before.clone().merge(empty.clone().read(&sent)?)?;
                Ok(())
            })?;
            *sums = [sent.len() as f64, written, joined];
        }
        Ok(Costs { block, rows, sums })
    }

    /// Bytes of a message with a lease of so many blocks, and seconds that rank 0 needs for it.
    /// Sketches grow until they are full.
    pub fn message(&self, blocks: f64) -> [f64; 2] {
        let [small, large] = self.sums;
        let share = ((blocks.ln() - (LEASES[0] as f64).ln()) / ((LEASES[1] / LEASES[0]) as f64).ln()).clamp(0.0, 1.0);
        let of = |k: usize| small[k] + share * (large[k] - small[k]);
        [self.rows[0] * blocks + of(0), self.rows[1] * blocks + of(2)]
    }

    pub fn print(&self, has_rows: bool) {
        println!("{} rows of single paths", if has_rows { "With" } else { "Without" });
        let Costs { block, rows: [bytes, seconds], sums } = self;
        println!("- a block of 256 paths: {:.2} ms to simulate", 1e3 * block);
        if has_rows {
            let (per_path, ms) = (bytes / 256.0, 1e3 * seconds);
            println!("- its rows: {:.1} kB, {per_path:.0} B a path; rank 0 takes {ms:.3} ms for them", bytes / 1e3);
        }
        for (lease, [bytes, written, joined]) in LEASES.iter().zip(sums) {
            let [mb, written, joined] = [bytes / 1e6, 1e3 * written, 1e3 * joined];
            println!(
                "- the sums of {lease} blocks: {mb:.2} MB, {written:.2} ms to write; rank 0 takes {joined:.2} ms for them"
            );
        }
    }
}
