//! The files of `mc`: their contents, and what becomes of them when the process is killed, the disk
//! fails, or somebody changes them.

#[path = "../common/command.rs"]
mod command;
#[path = "../common/edit.rs"]
mod edit;
#[path = "../common/shim.rs"]
mod shim;
#[path = "../../../../tests/synthetic/mod.rs"]
mod synthetic;

mod asked;
mod failing_writes;
mod file_contents;
mod foreign_files;
mod full_disk;
mod hostile;
mod resume;
mod verify;
