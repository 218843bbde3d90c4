//! Why the saved data of a run cannot be used.

use std::path::PathBuf;

/// Why the saved bytes of a run cannot be used. `path` is their origin.
#[derive(Debug, thiserror::Error)]
pub enum SavedError {
    /// The run was begun by another version or build of the program.
    #[error(
        "{}: started by {theirs}; this is {mine}, whose results may differ\n  fix: continue it with the \
         program that started it, or run it again with this one", path.display()
    )]
    OtherProgram {
        /// The file with the state of the run.
        path: PathBuf,
        /// The program that began it.
        theirs: String,
        /// This program.
        mine: String,
    },
    /// The saved state or log of a run cannot be used: its bytes are not those that were saved.
    #[error("{}: damaged, or not saved by this program; restore it from a backup, or run again with --force", path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
    },
    /// A newer version of the program has saved the run.
    #[error("{}: saved by a newer version of mc; continue it with that version", path.display())]
    Newer {
        /// The file.
        path: PathBuf,
    },
}
