//! How the files are opened that this program makes for itself while it works.
//!
//! Their names are known beforehand, so anything may lie under them: a link to a file of somebody
//! else, or a pipe, which would hold up whoever opens it. Only regular files are opened, a new file
//! is always made anew, and nothing else is removed.

use rustix::fs::OFlags;
use std::fs::{self, File, OpenOptions};
use std::io;
use std::os::unix::fs::{MetadataExt as _, OpenOptionsExt as _};
use std::path::Path;

/// Open a regular file that exists. A link is not followed, and a pipe holds nobody up.
pub(super) fn open(path: &Path, options: &mut OpenOptions) -> io::Result<File> {
    let flags = (OFlags::NOFOLLOW | OFlags::NONBLOCK).bits() as i32;
    let file = match options.custom_flags(flags).open(path) {
        // What the system says of a link or of a pipe does not name the matter.
        Err(_) if fs::symlink_metadata(path).is_ok_and(|there| !there.is_file()) => {
            return Err(no_file(path));
        }
        opened => opened?,
    };
    if file.metadata()?.is_file() {
        Ok(file)
    } else {
        Err(no_file(path))
    }
}

/// Create a file. A regular file of this name, which a killed process has left, is removed first.
pub(super) fn create(path: &Path) -> io::Result<File> {
    remove(path)?;
    File::options().create_new(true).write(true).open(path)
}

/// Remove a regular file, if there is one. Anything else of this name is an error.
pub(super) fn remove(path: &Path) -> io::Result<()> {
    match fs::symlink_metadata(path) {
        Ok(there) if !there.is_file() => Err(no_file(path)),
        Ok(_) => fs::remove_file(path),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(()),
        Err(error) => Err(error),
    }
}

/// What distinguishes a file from all others on this machine; none if there is no such file.
pub(super) fn identity(path: &Path) -> Option<(u64, u64)> {
    fs::symlink_metadata(path)
        .ok()
        .map(|there| (there.dev(), there.ino()))
}

fn no_file(path: &Path) -> io::Error {
    let name = path.file_name().unwrap_or_default().display();
    io::Error::other(format!(
        "{name} is not a regular file and was not created by mc; move it"
    ))
}
