//! Warnings about the quasi-static recursion, which treats the forcing as constant during a slip.

use super::case::Case;
use super::slip::Slip;
use stickslip_text::numbers::short;

pub(super) fn never_moves(case: &Case) -> Option<String> {
    case.slip.as_ref().is_some_and(|slip| !slip.moves).then(|| {
        "f_s = f_d: in the quasi-static recursion a slip moves the body by 2 (f_s - f_d)/K = 0, so x stays at \
         x0 and only the times of slips are meaningful"
            .to_string()
    })
}

/// If the change of the force during a slip, relative to the force released, is above this, the
/// stopping place is visibly wrong. In the paper's scenario without noise the error of the jumps is
/// 0.85 times that ratio.
const SLOW_FORCING: f64 = 0.01;

/// The force changes too much during a slip for the quasi-static recursion. It does not apply if
/// slips do not move the body, or if the body creeps.
pub(super) fn forcing_during_slip(case: &Case) -> Option<String> {
    let slip = case
        .slip
        .as_ref()
        .filter(|slip| slip.moves && !slip.creeps())?;
    let &Slip {
        duration,
        change,
        released,
        ..
    } = slip;
    (change > SLOW_FORCING * released).then(|| {
        format!(
            "the forcing is not slow: a slip lasts {}, in which the forcing changes the force by \
             about {}, while the slip releases {}. The quasi-static recursion keeps the forcing \
             constant during a slip, so its displacements will be off by about {} %; `scheme.kind = \
             \"event-driven\"` has no such error",
            short(duration),
            short(change),
            short(released),
            short((100.0 * change / released).ceil())
        )
    })
}

/// The damped body does not return fast enough to end a slip of the quasi-static recursion while
/// the forcing changes: the body creeps.
pub(super) fn creep(case: &Case) -> Option<String> {
    let slip = case.slip.as_ref().filter(|slip| slip.creeps())?;
    Some(format!(
        "the damped body returns too slowly to end a slip: the harmonics change the force by up to {} per \
         unit of time, and above {} the body creeps behind the temperature until the temperature turns. The \
         quasi-static recursion shows sticks and slips instead; `scheme.kind = \"event-driven\"` follows the creep",
        short(slip.rate),
        short(slip.limit)
    ))
}
