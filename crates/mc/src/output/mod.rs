//! What is printed: messages, numbers, JSON.

pub(crate) mod dataset;
pub(crate) mod document;
pub(crate) mod failure;
pub(crate) mod numbers;
pub(crate) mod safe;
pub(crate) mod terminal;
