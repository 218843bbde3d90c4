//! The command among several ranks of MPI: the first one does what it would do alone, the others
//! simulate for it.
//!
//! Without the feature `mpi` there is one process, and nothing here does anything.

pub use here::{crew, once, threads};

#[cfg(feature = "mpi")]
mod here {
    use std::process::ExitCode;
    use std::sync::OnceLock;
    use stick_slip::engine::Crew;
    use stick_slip::ranks::{Coordinator, Place, join};

    /// The ranks, where a launcher has started them.
    static COORDINATOR: OnceLock<Coordinator> = OnceLock::new();

    /// Call the command once, however many ranks there are.
    pub fn once(command: impl FnOnce() -> ExitCode) -> ExitCode {
        let Some((_membership, place)) = join() else { return command() };
        match place {
            Place::Other(code) => code,
            Place::First(coordinator) => {
                let coordinator = COORDINATOR.get_or_init(|| coordinator);
                let code = command();
                coordinator.end();
                code
            }
        }
    }

    /// The ranks that simulate, where there are several.
    pub fn crew() -> Option<&'static dyn Crew> {
        COORDINATOR.get().filter(|all| all.ranks() > 1).map(|all| all as &dyn Crew)
    }

    /// Of the threads that this process may use, those that it is to use.
    pub fn threads(usable: usize) -> usize {
        COORDINATOR.get().map_or(usable, |all| all.threads(usable))
    }
}

#[cfg(not(feature = "mpi"))]
mod here {
    use std::process::ExitCode;
    use stick_slip::engine::Crew;

    /// Call the command.
    pub fn once(command: impl FnOnce() -> ExitCode) -> ExitCode {
        command()
    }

    /// No other ranks.
    pub fn crew() -> Option<&'static dyn Crew> {
        None
    }

    /// All threads that this process may use.
    pub fn threads(usable: usize) -> usize {
        usable
    }
}
