//! Arguments that several verbs share, and what is said about words that are wrong.

pub(crate) mod accuracy;
pub(crate) mod completion;
pub(crate) mod extension;
pub(crate) mod mistakes;
pub(crate) mod overrides;
pub(crate) mod threads;
