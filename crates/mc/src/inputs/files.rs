//! Reads files of results. Every verb warns about a file without a checksum.

use crate::kinds::{self, Kind, RUN};
use crate::output::failure::{Failure, note};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use stickslip_files::store::{self, StoreError};

/// Reads a file with one of the readers of the store.
pub fn read<T>(
    path: &Path,
    reader: impl FnOnce(&Path) -> Result<T, StoreError>,
) -> Result<T, Failure> {
    look(path);
    reader(path).map_err(|error| explained(path, error))
}

/// The error of a reader. It names the kind of a file of another kind, and the likeliest reason for
/// a missing variable in a file without a checksum.
pub fn explained(path: &Path, error: StoreError) -> Failure {
    let other = |kind: &Kind| {
        let resume = if kind.is_resumable {
            " `mc resume`"
        } else {
            ""
        };
        let problem = format!(
            "{} is {}, which this command cannot read",
            path.display(),
            kind.name
        );
        Failure::usage(
            problem,
            format!("`mc show`, `mc plot`, `mc report`,{resume} and `mc verify` accept it"),
        )
    };
    match error {
        // A run that cannot be read as one has no version.
        StoreError::Foreign { .. } => match kinds::of(path) {
            Ok(Some(kind)) if kind.format != RUN.format => other(kind),
            _ => error.into(),
        },
        StoreError::Damaged { cause, .. } if matches!(store::has_checksum(path), Ok(false)) => {
            let problem = format!(
                "{}: {cause}; another program removed or changed it, or the file was truncated",
                path.display()
            );
            Failure::run(
                problem,
                "save all variables with it, or use the file as mc wrote it",
            )
        }
        error => error.into(),
    }
}

/// Warns once about each file without a checksum. An unreadable file is reported by the next
/// reader.
pub fn look(path: &Path) {
    static SEEN: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());
    let mut seen = SEEN.lock().unwrap_or_else(PoisonError::into_inner);
    if seen.insert(path.to_owned()) && matches!(store::has_checksum(path), Ok(false)) {
        let name = path.display();
        note(&format!(
            "warning: {name} has no checksum: another program changed it, or an earlier version of mc wrote it"
        ));
    }
}
