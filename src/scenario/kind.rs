//! The schemes by name, and what each can be asked for.

use crate::scheme::DEFAULT_TOLERANCE;

/// The schemes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SchemeKind {
    /// The paper's discrete variational inequality.
    DiscreteVi,
    /// The same step with the stick exit corrected for being looked at only every h.
    CorrectedVi,
    /// From event to event, exact in law in between.
    EventDriven {
        /// Relative error that discretisation may leave in the statistics.
        tolerance: f64,
    },
    /// The paper's recursion for slow forcing.
    QuasiStatic {
        /// The same, for the exits.
        tolerance: f64,
    },
}

impl SchemeKind {
    /// Every name, as in a scenario.
    pub const NAMES: [&'static str; 4] = ["discrete-vi", "corrected-vi", "event-driven", "quasi-static"];

    /// One of each, in the order of the names.
    pub const ALL: [SchemeKind; 4] = [
        SchemeKind::DiscreteVi,
        SchemeKind::CorrectedVi,
        SchemeKind::EventDriven { tolerance: DEFAULT_TOLERANCE },
        SchemeKind::QuasiStatic { tolerance: DEFAULT_TOLERANCE },
    ];

    /// The name in scenarios, tables, JSON and files.
    pub fn name(self) -> &'static str {
        match self {
            SchemeKind::DiscreteVi => "discrete-vi",
            SchemeKind::CorrectedVi => "corrected-vi",
            SchemeKind::EventDriven { .. } => "event-driven",
            SchemeKind::QuasiStatic { .. } => "quasi-static",
        }
    }

    /// The scheme of this name, with its default tolerance.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.name() == name)
    }

    /// What it is, in a line.
    pub fn meaning(self) -> &'static str {
        match self {
            SchemeKind::DiscreteVi => "the discrete variational inequality",
            SchemeKind::CorrectedVi => "the discrete variational inequality with corrected stick exits",
            SchemeKind::EventDriven { .. } => "from event to event, exact in law in between",
            SchemeKind::QuasiStatic { .. } => "the recursion for slow forcing",
        }
    }

    /// Whether it needs a time step.
    pub fn is_time_stepping(self) -> bool {
        matches!(self, SchemeKind::DiscreteVi | SchemeKind::CorrectedVi)
    }

    /// Its tolerance, if it has one.
    pub fn tolerance(self) -> Option<f64> {
        match self {
            SchemeKind::DiscreteVi | SchemeKind::CorrectedVi => None,
            SchemeKind::EventDriven { tolerance } | SchemeKind::QuasiStatic { tolerance } => Some(tolerance),
        }
    }

    /// The same with another tolerance; a scheme that has none stays as it is.
    pub fn with_tolerance(self, tolerance: f64) -> Self {
        match self {
            SchemeKind::DiscreteVi | SchemeKind::CorrectedVi => self,
            SchemeKind::EventDriven { .. } => SchemeKind::EventDriven { tolerance },
            SchemeKind::QuasiStatic { .. } => SchemeKind::QuasiStatic { tolerance },
        }
    }
}
