//! Friction, stiffness and dilatation of a bearing from measured temperatures and displacements, as
//! in the paper's section on the experimental campaign.
//!
//! ```text
//! Record         a thermometer and a displacement sensor (prepared, samples)
//!   -> DetectedSlips  jumps of z that temperature does not explain (steel, detect,
//!                     stick_analysis, slips)
//!     -> Response       A, G, xi(0), z0 and two slopes, computed from the slips (fit)
//!       -> Replicates     bias and errors from synthetic records (synthetic, uncertainty, by_slips)
//!     -> SearchStart    the paper's least squares, in a box around those (objective, starts)
//!       -> Calibration    each quantity with an interval (quantity, report)
//! ```
//!
//! The model is that of [`Motion`] and [`Sensor`]: quasi-static, and exact from sample to sample.

mod air;
mod bearing;
mod by_slips;
mod calibrate;
mod course;
mod detect;
mod evolve;
mod fit;
mod friction;
mod hold;
mod lag;
mod level;
mod lowest;
mod motion;
mod objective;
mod possible;
mod prepared;
mod quantity;
mod question;
mod report;
mod roughness;
mod samples;
mod slips;
mod starts;
mod steel;
mod stick_analysis;
mod sticks;
mod synthetic;
mod trajectory;
mod twin;
mod uncertainty;
mod warnings;
mod zero;

pub use crate::warning::CalibrationWarning;
pub use air::Air;
pub use bearing::{Response, Sensor};
pub use calibrate::{calibrate, calibrate_again};
pub(super) use course::{Course, CourseShape};
pub use lag::LagProfile;
pub use motion::Motion;
pub use objective::FitObjective;
pub use quantity::{Held, Quantity, Values, response_of, values};
pub use question::{CalibrationError, CalibrationMethod, CalibrationQuestion, Lag, NotHeld};
pub use report::{Calibration, ParameterEstimate, Residuals, SeenSlip};
pub use samples::MeasuredRecord;
pub use starts::SearchStart;
pub(super) use trajectory::{Body, farthest};
pub use twin::{Imperfections, Twin, twin};
pub use zero::Zero;
