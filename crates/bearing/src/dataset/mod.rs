//! Results of studies of a bearing as data sets: the contents of each kind, described once.

mod calibration;
mod forecast;
mod twin;

pub use calibration::{CALIBRATION_FORMAT, StoredCalibration};
pub use forecast::forecast;
pub use twin::twin;
