//! The Ornstein-Uhlenbeck process dv = -theta v dt + sigma dW, exactly.

/// The exact transition over a time h: v(t + h) = decay v(t) + kick xi, xi standard normal, with
///
/// ```text
/// decay = e^{-theta h},   kick = sigma sqrt((1 - e^{-2 theta h}) / (2 theta))
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transition {
    /// e^{-theta h}
    pub decay: f64,
    /// The standard deviation of what is added.
    pub kick: f64,
}

impl Transition {
    /// Over a time `h` >= 0, for theta > 0 and sigma >= 0. Without cancellation for any theta h (expm1).
    pub fn new(theta: f64, sigma: f64, h: f64) -> Self {
        Transition {
            decay: libm::exp(-theta * h),
            kick: sigma * (-libm::expm1(-2.0 * theta * h) / (2.0 * theta)).sqrt(),
        }
    }
}
