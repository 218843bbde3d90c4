//! The command as one of several ranks of MPI. The first rank does what it would do alone; the
//! other ranks simulate for it.
//!
//! Without the feature `mpi` there is one process, and these functions do nothing special.

pub use here::{crew, once, threads};

#[cfg(feature = "mpi")]
mod here {
    use std::process::ExitCode;
    use std::sync::OnceLock;
    use stick_slip::engine::Crew;
    use stick_slip::ranks::{Coordinator, Place, join};

    /// The other ranks as seen by the first one, if a launcher has started several.
    static COORDINATOR: OnceLock<Coordinator> = OnceLock::new();

    /// Calls the command on the first rank only, however many ranks there are.
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

    /// The ranks that simulate, if there are several.
    pub fn crew() -> Option<&'static dyn Crew> {
        COORDINATOR.get().filter(|all| all.ranks() > 1).map(|all| all as &dyn Crew)
    }

    /// How many of the threads that this process may use it should use.
    pub fn threads(usable: usize) -> usize {
        COORDINATOR.get().map_or(usable, |all| all.threads(usable))
    }
}

#[cfg(not(feature = "mpi"))]
mod here {
    use std::process::ExitCode;
    use stick_slip::engine::Crew;

    /// Calls the command.
    pub fn once(command: impl FnOnce() -> ExitCode) -> ExitCode {
        command()
    }

    /// None, because there are no other ranks.
    pub fn crew() -> Option<&'static dyn Crew> {
        None
    }

    /// All threads that this process may use.
    pub fn threads(usable: usize) -> usize {
        usable
    }
}
