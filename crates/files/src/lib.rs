//! Results as bytes and as HDF5.
// Some of this is used by files only.
#![cfg_attr(not(feature = "store"), allow(dead_code, unused_imports))]

pub mod saved;
#[cfg(feature = "store")]
pub mod store;
