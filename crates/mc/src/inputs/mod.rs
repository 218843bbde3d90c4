//! Files of results that a verb reads.

pub(crate) mod files;
pub(crate) mod results;
