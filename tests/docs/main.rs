//! What the documentation says, held against the code: names, constants, tables, links, and who
//! knows whom.
//!
//! Each test compares two lists or two numbers that must be equal, so a change on either side that
//! the other does not follow fails.

#[path = "../common/command.rs"]
mod command;
mod commands;
mod constants;
mod json;
mod links;
mod markdown;
mod modules;
mod names;
mod output_format;
mod outputs;
mod rooms;
mod scenario;
mod source;
