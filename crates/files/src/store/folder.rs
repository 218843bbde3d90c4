//! The names of the folder `NAME.partial` and of the files in it, and whose such a folder is.

use super::{own, state};
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// The state of a run.
pub(super) const STATE: &str = "state";
/// The rows of its single paths.
pub(super) const ROWS: &str = "rows";
/// The file itself, while it is written.
pub(super) const RESULTS: &str = "results.h5";
/// A new state, before it replaces the old one.
pub(super) const NEW_STATE: &str = "state.new";
/// A second name of the results, from which they are renamed to replace an earlier file.
pub(super) const LINK: &str = "results.link";

/// The mark of the folder. It is the first file in it, and it is removed last.
pub(super) const MARK: &str = "made-by-mc";

/// The files of the folder in the order of their removal. If the process is interrupted in between,
/// the files that remain still show what the folder was.
pub(super) const NAMES: [&str; 6] = [ROWS, NEW_STATE, LINK, STATE, RESULTS, MARK];

/// The name of the folder in which a file is written: `NAME.partial`.
pub fn partial_path(target: &Path) -> PathBuf {
    let mut name = target.as_os_str().to_owned();
    name.push(".partial");
    PathBuf::from(name)
}

/// The target that a path stands for: `NAME` if the path is `NAME.partial`, and the path itself
/// otherwise.
pub fn file_of(path: &Path) -> PathBuf {
    if path
        .extension()
        .is_some_and(|extension| extension == "partial")
    {
        path.with_extension("")
    } else {
        path.to_owned()
    }
}

/// Whether this program has made a folder.
pub(super) fn is_ours(folder: &Path) -> bool {
    let is_file =
        |name: &str| fs::symlink_metadata(folder.join(name)).is_ok_and(|there| there.is_file());
    let is_empty = || fs::read_dir(folder).is_ok_and(|mut entries| entries.next().is_none());
    is_file(MARK) || is_file(STATE) && state::has_mark(&folder.join(STATE)) || is_empty()
}

/// The name of something in a folder of ours that this program has not made, if there is any.
pub(super) fn foreign_file(folder: &Path) -> Option<String> {
    let names = fs::read_dir(folder)
        .ok()?
        .filter_map(|entry| Some(entry.ok()?.file_name().display().to_string()));
    let is_file =
        |name: &str| fs::symlink_metadata(folder.join(name)).is_ok_and(|there| there.is_file());
    names
        .into_iter()
        .find(|name| !NAMES.contains(&name.as_str()) || !is_file(name))
}

/// Remove the files of this program, and then the folder. The folder stays, with an error, if it
/// holds anything else.
pub(super) fn clear(folder: &Path) -> io::Result<()> {
    NAMES
        .iter()
        .try_for_each(|name| own::remove(&folder.join(name)))?;
    fs::remove_dir(folder)
}
