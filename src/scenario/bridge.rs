//! The parts of a scenario that a study of measurements needs.

use stickslip_data::ColumnSource;

/// A bearing as described by a scenario: starting values for its parameters, and the sources of its
/// data.
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
    /// Where the temperatures are measured; the file is relative to the folder of the scenario.
    pub temperature_source: ColumnSource,
    /// Where the displacements are measured. Keys missing in `[displacement.series]` are as for the
    /// temperatures, except for the file, the column and the unit.
    pub displacement_source: ColumnSource,
    /// The text of the scenario.
    pub text: String,
}
