//! Without noise: phases are closed forms, events are roots, and there is no time step.
//!
//! ```text
//! segment         the one path that there is, segment by segment, for every lane
//! one_path        its segments
//!   first_root      the first zero of a smooth function, without ever missing one
//!   exact_time      time with twice the digits of a double
//! general         the same for any force, where slips have no closed form
//! dense_output    the motion between events, for an observer that follows it
//! unfelt_noise    the fluctuations of the temperature, if they do not change the motion
//! ```

mod dense_output;
mod exact_time;
mod first_root;
mod general;
mod one_path;
mod path_segment;
mod unfelt_noise;

pub use dense_output::{FollowedSlip, Kinematics, Knots};
pub use exact_time::ExactTime;
pub use general::GeneralNoiseless;
pub use one_path::Noiseless;
pub use path_segment::{End, PathSegment, PathSegments};
pub use unfelt_noise::unfelt_noise;
