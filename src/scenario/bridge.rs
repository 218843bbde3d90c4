//! The parts of a scenario that a calibration needs. A run needs more, but a calibration simulates
//! nothing.

/// A bearing as a scenario describes it: where the search for its parameters begins, and how its
/// data are read.
#[derive(Clone, Debug, PartialEq)]
pub struct BridgeScene {
    /// Title, one line.
    pub title: String,
    /// K, stiffness of the spring.
    pub stiffness: f64,
    /// beta, displacement of the rest position per degree.
    pub dilatation: f64,
    /// f_s, static friction.
    pub f_s: f64,
    /// f_d, dynamic friction.
    pub f_d: f64,
    /// K_BP, shear stiffness of the bearing, if it is known.
    pub shear_stiffness: Option<f64>,
    /// z0, reading of the sensor at x = 0.
    pub offset: f64,
    /// x(0); `None` if it is missing or a word ("balanced", "free").
    pub displacement: Option<f64>,
    /// The file of the temperature, relative to the folder of the scenario.
    pub file: Option<String>,
    /// The name of the column of times.
    pub time: String,
    /// The name of the column of temperatures. `None` means the column whose name begins with
    /// `temperature`.
    pub value: Option<String>,
    /// The time zone of stamps that name none.
    pub zone: Option<String>,
    /// The text of the scenario.
    pub text: String,
}
