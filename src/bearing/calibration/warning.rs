//! Warnings about a calibration.

use super::quantity::Quantity;
use super::spikes::Spikes;
use std::fmt;

/// A reason why a result means less than it seems to.
#[derive(Clone, Debug, PartialEq)]
pub enum Warning {
    /// K_BP is not known.
    NoShearStiffness,
    /// No slips can be distinguished from noise.
    NoSlips,
    /// f_s - f_d is hardly distinguishable from zero, or slips do not explain all of the motion.
    GapNotIdentified,
    /// The sizes of slips differ more than noise explains. The number is their standard deviation
    /// beyond the noise, divided by their mean.
    Scatter(f64),
    /// The steel lags behind the thermometer by this many seconds.
    Lag(f64),
    /// A lag was given, but the data indicate the second one; both in seconds.
    OtherLag(f64, f64),
    /// The intervals by slips and by least squares do not overlap for these quantities.
    MethodsApart(Vec<Quantity>),
    /// The starts did not all find the same minimum. The number is the largest err divided by the
    /// smallest, minus one.
    StartsDisagree(f64),
    /// Samples were taken out as spikes.
    Spikes(Spikes),
    /// The displacement falls as the temperature rises, so its sign was changed.
    Mirrored,
    /// A quantity has a value that no bearing can have.
    Unphysical(Quantity),
}

impl Warning {
    /// The name in files and for programs.
    pub fn name(&self) -> &'static str {
        match self {
            Warning::NoShearStiffness => "no_shear_stiffness",
            Warning::NoSlips => "no_slips",
            Warning::GapNotIdentified => "gap_not_identified",
            Warning::Scatter(_) => "scatter",
            Warning::Lag(_) => "lag",
            Warning::OtherLag(..) => "other_lag",
            Warning::MethodsApart(_) => "methods_apart",
            Warning::StartsDisagree(_) => "starts_disagree",
            Warning::Spikes(_) => "spikes",
            Warning::Mirrored => "mirrored",
            Warning::Unphysical(_) => "unphysical",
        }
    }
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let minutes = |seconds: &f64| seconds / 60.0;
        match self {
            Warning::NoShearStiffness => write!(
                f,
                "the shear stiffness of the bearing is not known, so the data tell beta, f_s/K and f_d/K and no force; \
                 give bearing.stiffness to know K, f_s and f_d"
            ),
            Warning::NoSlips => write!(
                f,
                "no slips are visible, so the parameters are those of the least squares alone, searched from the scenario's \
                 values, and have no intervals"
            ),
            Warning::GapNotIdentified => write!(
                f,
                "f_s - f_d is not identified: slips are too few, or do not explain all of the way, because they are hardly larger than \
                 the noise or the body slides without them"
            ),
            Warning::Scatter(share) => write!(
                f,
                "slips differ in size by {:.0} % more than noise explains: f_s changes from slip to slip, or the body slides \
                 without slips. So the estimates are those of the mean f_s, the interval of f_s - f_d is too narrow, and the \
                 slips are more accurate than the least squares, which assume a constant f_s",
                100.0 * share
            ),
            Warning::Lag(lag) => write!(
                f,
                "steel is {:.1} minutes behind the thermometer; the estimates take that into account, and give --lag if it is \
                 known (without it K comes out too small, by 7 to 12 % for 15 minutes)",
                minutes(lag)
            ),
            Warning::OtherLag(given, likeliest) => write!(
                f,
                "the data say a lag of {:.1} minutes rather than {:.1}; try --lag auto",
                minutes(likeliest),
                minutes(given)
            ),
            Warning::MethodsApart(which) => {
                let keys: Vec<&str> = which.iter().map(|quantity| quantity.key()).collect();
                write!(
                    f,
                    "slips and least squares are farther apart than their intervals in {}: the model does not describe all \
                     that was measured; see the residuals",
                    keys.join(", ")
                )
            }
            Warning::StartsDisagree(share) => write!(
                f,
                "the starts of the least squares differ by {:.2} % of err: some of them did not find the minimum, so give more \
                 with --starts",
                100.0 * share
            ),
            Warning::Spikes(Spikes { readings, temperatures }) => write!(
                f,
                "{readings} displacements and {temperatures} temperatures stood out of those around them, and were left out"
            ),
            Warning::Mirrored => write!(
                f,
                "the displacement falls as the temperature rises, so it was taken with the other sign; z0 is that of the other sign"
            ),
            Warning::Unphysical(quantity) => {
                write!(f, "{} = {} has an estimate that no bearing can have", quantity.key(), quantity.symbol())
            }
        }
    }
}
