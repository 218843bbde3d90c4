//! Output files whose extension does not match their format.

use crate::{Failure, writable};
use std::path::Path;

/// Checks like [`writable`] that results may be written at `path`. Refuses to write HDF5 under an
/// extension of another format, and names the command that makes that format from the HDF5 file.
pub fn writable_hdf5<P: AsRef<Path>>(
    path: &Path,
    force: bool,
    inputs: impl IntoIterator<Item = P>,
) -> Result<(), Failure> {
    writable(path, force, inputs)?;
    let (shown, file) = (path.display(), path.with_extension("h5"));
    let file = file.display();
    let makes = match ending(path).as_str() {
        "csv" => format!("mc show {file} --format csv > {shown}"),
        "tex" => format!("mc show {file} --format latex > {shown}"),
        "md" => format!("mc show {file} --format markdown > {shown}"),
        "json" => format!("mc show {file} --json > {shown}"),
        "svg" | "png" | "pdf" => format!("mc plot {file} -o {shown}"),
        "html" | "htm" => format!("mc report {file} -o {shown}"),
        _ => return Ok(()),
    };
    let problem =
        format!("-o {shown}: results are written as HDF5, but this name has another extension");
    Err(Failure::usage(
        problem,
        format!("write `-o {file}`, then run `{makes}`"),
    ))
}

/// Refuses to write an HTML page under another extension.
pub fn check_page(path: &Path, of: &Path) -> Result<(), Failure> {
    let (shown, of) = (path.display(), of.display());
    let remedy = match ending(path).as_str() {
        "html" | "htm" => return Ok(()),
        "svg" | "png" | "pdf" => {
            format!("use the extension .html, or draw it with `mc plot {of} -o {shown}`")
        }
        _ => "use the extension .html".to_string(),
    };
    Err(Failure::usage(
        format!("-o {shown}: a report is an HTML page"),
        remedy,
    ))
}

/// The extension of a file's name, in lower case; empty if it has none.
pub fn ending(path: &Path) -> String {
    path.extension()
        .map(|ending| ending.to_string_lossy().to_lowercase())
        .unwrap_or_default()
}
