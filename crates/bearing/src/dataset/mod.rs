//! What a study of a bearing leaves as a data set: the contents of each kind, described once.

mod calibration;
mod forecast;
mod twin;

pub use calibration::{CALIBRATION_FORMAT, StoredCalibration};
pub use forecast::forecast;
pub use twin::twin;
