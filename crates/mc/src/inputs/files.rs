//! Files of results as the verbs read them. Every verb says of a file without a checksum that it
//! has none.

use crate::kinds::{self, Kind, RUN};
use crate::output::failure::{Failure, note};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use stickslip_files::store::{self, StoreError};

/// What one of the readers of the store reads from a file.
pub fn read<T>(
    path: &Path,
    reader: impl FnOnce(&Path) -> Result<T, StoreError>,
) -> Result<T, Failure> {
    look(path);
    reader(path).map_err(|error| explained(path, error))
}

/// The error of a reader. A file of another kind is named, and so is the likeliest reason why
/// something is missing from a file without a checksum.
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
        // A run that the readers of runs do not know lacks its version.
        StoreError::Foreign { .. } => match kinds::of(path) {
            Ok(Some(kind)) if kind.format != RUN.format => other(kind),
            _ => error.into(),
        },
        StoreError::Damaged { cause, .. } if matches!(store::is_sealed(path), Ok(false)) => {
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

/// Says once of each file that it has no checksum. What cannot be read at all is reported by the
/// reader that comes next.
pub fn look(path: &Path) {
    static SEEN: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());
    let mut seen = SEEN.lock().unwrap_or_else(PoisonError::into_inner);
    if seen.insert(path.to_owned()) && matches!(store::is_sealed(path), Ok(false)) {
        let name = path.display();
        note(&format!(
            "warning: {name} has no checksum: another program changed it, or an earlier version of mc wrote it"
        ));
    }
}
