//! The enums of all schemes, made from one list: [`Kind`] without a parameter, [`Scheme`] with its
//! parameter, and `OfScheme`, ready to simulate. Each is matched once, outside all loops; the
//! code inside the loops is compiled for the one scheme.

use super::{Kind, Parameter, Scheme};
use std::fmt;

/// Makes the enums from the types that implement `Method`, and forwards their methods.
macro_rules! schemes {
    ($($Scheme:ident),+ $(,)?) => {
        /// The schemes by name, without their parameters.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        pub enum Kind {
            $(#[doc = concat!("[`", stringify!($Scheme), "`] with any parameter.")] $Scheme,)+
        }

        /// How to simulate: a scheme with its step or its tolerance.
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub enum Scheme {
            $(#[doc = concat!("[`", stringify!($Scheme), "`].")] $Scheme($Scheme),)+
        }

        /// A scheme on one model without random inputs and one timeline.
        #[derive(Clone, Debug)]
        pub(super) enum OfScheme {
            $(#[doc = concat!("That of [`", stringify!($Scheme), "`].")] $Scheme(Box<<$Scheme as Method>::Simulation>),)+
        }

        impl Kind {
            /// All schemes, in the order of tables and pictures.
            pub const ALL: &'static [Kind] = &[$(Kind::$Scheme),+];

            /// The name in scenarios, tables, JSON and files.
            pub fn name(self) -> &'static str {
                match self { $(Kind::$Scheme => $Scheme::NAME,)+ }
            }

            /// A description of the scheme in one line.
            pub fn meaning(self) -> &'static str {
                match self { $(Kind::$Scheme => $Scheme::MEANING,)+ }
            }

            /// Which parameter the scheme has.
            pub fn parameter(self) -> Parameter {
                match self { $(Kind::$Scheme => $Scheme::PARAMETER,)+ }
            }

            /// The appearance of the scheme in pictures.
            pub fn appearance(self) -> Appearance {
                match self { $(Kind::$Scheme => $Scheme::APPEARANCE,)+ }
            }

            /// The scheme with this step or tolerance.
            pub fn with(self, parameter: f64) -> Scheme {
                match self { $(Kind::$Scheme => Scheme::$Scheme($Scheme::with(parameter)),)+ }
            }
        }

        impl Scheme {
            /// The scheme without its parameter.
            pub fn kind(self) -> Kind {
                match self { $(Scheme::$Scheme(_) => Kind::$Scheme,)+ }
            }

            /// The step (a time) or the relative tolerance of the scheme. A smaller value gives a
            /// smaller error.
            pub fn parameter(self) -> f64 {
                match self { $(Scheme::$Scheme(scheme) => scheme.parameter(),)+ }
            }

            fn of_scheme(self, model: &Problem, timeline: &Timeline) -> OfScheme {
                match self {
                    $(Scheme::$Scheme(scheme) => OfScheme::$Scheme(Box::new(scheme.simulation(model, timeline))),)+
                }
            }

            /// How its discretisation error can be measured.
            pub fn discretisation(self) -> Discretisation {
                match self { $(Scheme::$Scheme(scheme) => scheme.discretisation(),)+ }
            }

            /// The limit beyond which slips grow without bound; none for a scheme without a step.
            pub fn stability(self, model: &Problem) -> Option<Stability> {
                match self { $(Scheme::$Scheme(scheme) => scheme.stability(model),)+ }
            }

            /// The threshold that is simulated instead of f_s where f_s and f_d are (nearly) equal
            /// under noise; usually none.
            pub fn resolution(self, model: &Problem, timeline: &Timeline) -> Option<Resolution> {
                match self { $(Scheme::$Scheme(scheme) => scheme.resolution(model, timeline),)+ }
            }

            /// Checks whether the scheme can simulate this model up to `end`.
            pub fn check(self, model: &Problem, end: f64) -> Result<(), CheckError> {
                match self { $(Scheme::$Scheme(scheme) => scheme.check(model, end),)+ }
            }
        }

        impl Simulate for OfScheme {
            fn model(&self) -> &Problem {
                match self { $(OfScheme::$Scheme(simulation) => simulation.model(),)+ }
            }

            fn timeline(&self) -> &Timeline {
                match self { $(OfScheme::$Scheme(simulation) => simulation.timeline(),)+ }
            }

            fn simulate_counting(&self, seed: u64, paths: &[u64], observer: &mut dyn Observer) -> Simulated {
                match self {
                    $(OfScheme::$Scheme(simulation) => simulation.simulate_counting(seed, paths, observer),)+
                }
            }

            fn step(&self) -> Option<f64> {
                match self { $(OfScheme::$Scheme(simulation) => simulation.step(),)+ }
            }

            fn vectorised_paths(&self) -> usize {
                match self { $(OfScheme::$Scheme(simulation) => simulation.vectorised_paths(),)+ }
            }

            fn kernel(&self) -> String {
                match self { $(OfScheme::$Scheme(simulation) => simulation.kernel(),)+ }
            }

            fn fed_by_finer(self, refinement: usize) -> Self {
                match self {
                    $(OfScheme::$Scheme(simulation) => {
                        OfScheme::$Scheme(Box::new(simulation.fed_by_finer(refinement)))
                    })+
                }
            }

            fn observed_every(self, steps: u64) -> Self {
                match self {
                    $(OfScheme::$Scheme(simulation) => OfScheme::$Scheme(Box::new(simulation.observed_every(steps))),)+
                }
            }

            fn with_additional_rows(self, row_stride: usize) -> Self {
                match self {
                    $(OfScheme::$Scheme(simulation) => {
                        OfScheme::$Scheme(Box::new(simulation.with_additional_rows(row_stride)))
                    })+
                }
            }

            fn with_work_limit(self, limit: u64) -> Self {
                match self {
                    $(OfScheme::$Scheme(simulation) => {
                        OfScheme::$Scheme(Box::new(simulation.with_work_limit(limit)))
                    })+
                }
            }
        }

        $(impl From<$Scheme> for Scheme {
            fn from(scheme: $Scheme) -> Self {
                Scheme::$Scheme(scheme)
            }
        })+
    };
}

impl Kind {
    /// The scheme of this name; none if there is no such scheme.
    pub fn from_name(name: &str) -> Option<Self> {
        Kind::ALL.iter().copied().find(|kind| kind.name() == name)
    }

    /// Whether the parameter is a time step.
    pub fn has_step(self) -> bool {
        self.parameter() == Parameter::Step
    }
}

impl Scheme {
    /// The name in scenarios, tables, JSON and files.
    pub fn name(self) -> &'static str {
        self.kind().name()
    }

    /// The time step h; none for a scheme with a tolerance.
    pub fn step(self) -> Option<f64> {
        self.kind().has_step().then(|| self.parameter())
    }

    /// The tolerance; none for a scheme with a step.
    pub fn tolerance(self) -> Option<f64> {
        (!self.kind().has_step()).then(|| self.parameter())
    }
}

/// Writes the scheme with its parameter: `corrected-vi step 0.005`.
impl fmt::Display for Scheme {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = match self.kind().parameter() {
            Parameter::Step => "step",
            Parameter::Tolerance { .. } => "tolerance",
        };
        write!(f, "{} {name} {:?}", self.name(), self.parameter())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scheme::{CorrectedVi, EventDriven};

    #[test]
    fn no_two_schemes_are_called_or_drawn_alike() {
        for (i, one) in Kind::ALL.iter().enumerate() {
            for other in &Kind::ALL[..i] {
                assert_ne!(one.name(), other.name());
                assert_ne!(one.appearance().colour, other.appearance().colour);
                assert_ne!(one.appearance().dash, other.appearance().dash);
            }
        }
    }

    #[test]
    fn a_scheme_is_shown_with_its_parameter() {
        let shown = |scheme: Scheme| scheme.to_string();
        assert_eq!(
            shown(CorrectedVi { step: 0.005 }.into()),
            "corrected-vi step 0.005"
        );
        assert_eq!(
            shown(EventDriven { tolerance: 1e-4 }.into()),
            "event-driven tolerance 0.0001"
        );
    }
}
