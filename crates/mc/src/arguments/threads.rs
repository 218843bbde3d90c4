//! The option `--threads`, and checks that this machine has the threads and the memory for it.

use crate::output::failure::Failure;
use crate::output::numbers::{bytes, counted};
use stickslip::ensemble::{MOST_THREADS, ThreadsError, check_threads};
use stickslip::memory::{Need, Short};

/// How many threads a verb uses.
#[derive(Debug, clap::Args)]
pub struct Threads {
    /// Number of threads [default: one for each core]
    #[arg(long, value_name = "K", value_parser = clap::value_parser!(u16).range(1..=MOST_THREADS as i64))]
    threads: Option<u16>,
}

impl Threads {
    /// The requested number, or one for each core.
    pub fn number(&self) -> usize {
        self.threads
            .map_or_else(crate::cores, usize::from)
            .min(MOST_THREADS)
    }

    /// The number, if the system can start this number of threads and has `used` bytes of memory
    /// for their work, which a message calls `work`.
    pub fn ready(&self, work: &str, used: f64) -> Result<usize, Failure> {
        let threads = self.number();
        enough_memory(work, used, threads)?;
        check_threads(threads).map_err(refused)?;
        Ok(threads)
    }
}

/// Refuses work for which there is too little memory.
pub fn enough_memory(work: &str, used: f64, threads: usize) -> Result<(), Failure> {
    Need {
        bytes: used,
        threads,
    }
    .check()
    .map_err(
        |Short {
             needed,
             free,
             limit,
         }| {
            let threads = counted(threads as u64, "thread");
            let (needed, free) = (bytes(needed), bytes(free));
            let problem = format!(
                "{work} on {threads} needs about {needed} of memory, but {limit} leaves {free}"
            );
            let remedy =
                "use fewer --threads, a larger `time.output_step`, or record less per path";
            Failure::usage(problem, remedy)
        },
    )
}

/// The message if the system cannot start this number of threads.
pub fn refused(error: ThreadsError) -> Failure {
    Failure::usage(format!("--threads: {error}"), ThreadsError::REMEDY)
}
