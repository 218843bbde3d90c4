//! The cascade of phases, which describes a path completely: every statistic is a function of it.
//!
//! ```text
//! tau_j        start of static phase j (tau_0 = 0 is an initial condition, not an event)
//! tau_{j+1/2}  its end, and the start of dynamic phase j:  inf{t >= tau_j : |b(x_j, t)| > f_s}
//! tau_j^k      sub-phase boundaries of dynamic phase j:
//!              tau_j^0 = tau_{j+1/2},   tau_j^{k+1} = inf{t > tau_j^k : x'(t) = 0}
//! k(j)         its number of sub-phases:  inf{k >= 1 : |b(x_j^k, tau_j^k)| <= f_s}
//! tau_{j+1}    = tau_j^{k(j)}
//! ```
//!
//! (Paper, section 2.4.) Every path starts in a static phase at t = 0. This phase is empty if
//! |b(x0, 0)| > f_s; then the first event is the start of a slip at t = 0.

/// A direction of motion, or of a force.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Sign {
    /// -1
    Negative,
    /// +1
    #[default]
    Positive,
}

impl Sign {
    /// The sign of a number; zero counts as positive.
    pub fn of(value: f64) -> Self {
        if value < 0.0 {
            Sign::Negative
        } else {
            Sign::Positive
        }
    }

    /// -1.0 or 1.0.
    pub fn value(self) -> f64 {
        match self {
            Sign::Negative => -1.0,
            Sign::Positive => 1.0,
        }
    }
}

/// The phase of a path between two events.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// A static phase: x' = 0 and |b| <= f_s.
    Static,
    /// A sub-phase of a dynamic phase, in which x' has this sign.
    Slip(Sign),
}

/// The kind of an event of the cascade.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EventKind {
    /// tau_{j+1}: x' = 0 and |b| <= f_s; a dynamic phase ends.
    StickEntered,
    /// tau_{j+1/2} = tau_j^0: |b| exceeds f_s; a dynamic phase begins, moving in the direction
    /// eps_j^0.
    SlipStarted(Sign),
    /// tau_j^k, 0 < k < k(j): x' = 0 and |b| > f_s; the next sub-phase moves in the direction
    /// eps_j^k.
    SubPhaseBoundary(Sign),
}

impl EventKind {
    /// The kind of an event at which x' = 0: a stick begins if friction holds the body (`is_held`);
    /// otherwise the next sub-phase begins, in the direction of `force`.
    #[inline]
    pub fn at_rest(is_held: bool, force: f64) -> Self {
        if is_held {
            EventKind::StickEntered
        } else {
            EventKind::SubPhaseBoundary(Sign::of(force))
        }
    }

    /// The phase that begins with the event.
    #[inline]
    pub fn phase(self) -> Phase {
        match self {
            EventKind::StickEntered => Phase::Static,
            EventKind::SlipStarted(sign) | EventKind::SubPhaseBoundary(sign) => Phase::Slip(sign),
        }
    }
}

/// One event of the cascade, with the state at its time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Event {
    /// What begins or ends.
    pub kind: EventKind,
    /// tau_j, tau_{j+1/2} or tau_j^k, a time.
    pub time: f64,
    /// x at that time, a length.
    pub displacement: f64,
    /// b at that time, a force.
    pub force: f64,
}
