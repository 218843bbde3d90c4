//! Changes an HDF5 file as a user would with h5py, while other tests start processes.

use std::fs;
use std::path::Path;

/// Changes a file with HDF5.
///
/// A process that another test starts meanwhile inherits the open file with its lock, and keeps
/// both until it ends. So the change is made in a copy, and its bytes are written to the file.
#[track_caller]
pub fn edited(path: &Path, change: impl FnOnce(&hdf5::File)) {
    let copy = path.with_extension("copy");
    let _ = fs::remove_file(&copy);
    fs::copy(path, &copy).expect("copied");
    let file = hdf5::File::open_rw(&copy).expect("HDF5");
    change(&file);
    drop(file);
    fs::write(path, fs::read(&copy).expect("there")).expect("written");
    fs::remove_file(&copy).expect("removed");
}
