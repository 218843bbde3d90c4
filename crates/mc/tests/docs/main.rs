//! What the documentation says agrees with the code: constants, tables, links and commands.
//!
//! Each test compares two lists or two numbers that must be equal. So it fails if one side changes
//! and the other does not.

#[path = "../common/command.rs"]
mod command;
mod commands;
mod constants;
mod json;
mod links;
mod markdown;
mod output_format;
mod outputs;
mod own_scene;
mod scenario;
