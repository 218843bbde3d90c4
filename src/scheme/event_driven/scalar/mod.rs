//! Scalar paths: paths that cross a macro step one after the other.
//!
//! ```text
//! path           the state of a path, and how it crosses a macro step: stick, slip, stick, ..
//!   stick          does b leave the stick band before the end of the macro step?
//!   slip           steps, each of which is searched for a stop
//!     user_force      a step under a user-defined force
//!     stop_search    bisects a step from left to right
//!     step_flow      the motion of the step without noise, for weak noise and for observers
//! observation        draws the state at instants inside a macro step, without changing the path
//! paths     all paths, one after the other
//! ```

mod observation;
mod path;
mod paths;
mod slip;
mod step_flow;
mod stick;
mod stop_search;
mod user_force;

pub use observation::{MotionObserver, NullObserver, ObservedSegment, ObservedTimes, PathObserver};
pub use path::{Cascade, Path, Propagation, cross, start};
pub use paths::ScalarPaths;
pub use slip::SlipBuffers;
pub use stick::PendingNodes;
