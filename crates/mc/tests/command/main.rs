//! The command `mc` as a person uses it: what it prints, writes and refuses.

#[path = "../common/command.rs"]
mod command;
#[path = "../common/edit.rs"]
mod edit;
#[path = "../../../../src/study/tests/reference.rs"]
mod reference;
#[path = "../common/shim.rs"]
mod shim;

mod assets;
mod bounds;
mod calibrate;
mod cli;
mod forecast;
mod inputs;
mod measured;
mod mistakes;
mod parts;
mod pictures;
mod report;
mod run;
mod sweep;
mod trade;
mod tutorial;
