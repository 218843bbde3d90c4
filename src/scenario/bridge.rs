//! What a scenario says of a bearing that is calibrated: less than a run takes, because nothing is
//! run.

/// A bearing in a scenario: where a search begins, and how its data are read.
#[derive(Clone, Debug, PartialEq)]
pub struct BridgeScene {
    /// What it is about, in a line.
    pub title: String,
    /// K.
    pub stiffness: f64,
    /// beta.
    pub dilatation: f64,
    /// f_s.
    pub f_s: f64,
    /// f_d.
    pub f_d: f64,
    /// K_BP, if it is known.
    pub shear_stiffness: Option<f64>,
    /// z0.
    pub offset: f64,
    /// x(0); none where it is not a number ("balanced", "free").
    pub displacement: Option<f64>,
    /// Where the temperature of the scenario is, relative to it.
    pub file: Option<String>,
    /// The column of times.
    pub time: String,
    /// The column of temperatures; none for the one whose name begins with `temperature`.
    pub value: Option<String>,
    /// The zone of stamps that name none.
    pub zone: Option<String>,
    /// The text of the scenario.
    pub text: String,
}
