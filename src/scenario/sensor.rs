//! The sensor at the bearing.

/// The sensor at the bearing: z = z0 + x + F/K_BP. The bearing does not act on the body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SensorBearing {
    /// K_BP > 0, the shear stiffness of the bearing under the friction force F; `None` for a rigid
    /// bearing.
    pub stiffness: Option<f64>,
    /// z0, the reading at x = 0 and F = 0.
    pub offset: f64,
}

impl SensorBearing {
    /// The reading z at displacement x and friction force F.
    pub fn displacement(&self, x: f64, friction: f64) -> f64 {
        self.offset + x + self.stiffness.map_or(0.0, |stiffness| friction / stiffness)
    }
}
