//! Arguments that several verbs share, and messages about wrong ones.

pub(crate) mod accuracy;
pub(crate) mod completion;
pub(crate) mod extension;
pub(crate) mod mistakes;
pub(crate) mod overrides;
pub(crate) mod threads;
