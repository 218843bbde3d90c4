//! The quantities that a calibration estimates, with the keys of the scenario.

use super::bearing::{Response, Sensor};
use super::motion::Motion;

/// A quantity that a calibration estimates.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// K, stiffness.
    Stiffness,
    /// beta, dilatation.
    Dilatation,
    /// f_s, static friction.
    Static,
    /// f_d, dynamic friction.
    Dynamic,
    /// f_s - f_d.
    Gap,
    /// z0, offset of the sensor.
    Offset,
    /// x(0), initial displacement.
    Displacement,
    /// kappa = K/K_BP.
    Shear,
    /// A = f_s/(K beta).
    Reach,
    /// G = 2 (f_s - f_d)/(K beta).
    Jump,
    /// f_s/K.
    StaticWay,
    /// f_d/K.
    DynamicWay,
}

use Quantity::*;

impl Quantity {
    /// All quantities: first the seven parameters, then those that follow from them.
    pub const ALL: [Quantity; 12] = [
        Stiffness,
        Dilatation,
        Static,
        Dynamic,
        Gap,
        Offset,
        Displacement,
        Shear,
        Reach,
        Jump,
        StaticWay,
        DynamicWay,
    ];

    /// Number of parameters.
    pub const PARAMETERS: usize = 7;

    /// The parameters that can be fitted or fixed; f_s - f_d follows from them.
    pub const FITTED: [Quantity; 6] =
        [Stiffness, Dilatation, Static, Dynamic, Offset, Displacement];

    /// The quantities that determine motion and reading. K, f_s and f_d follow from them, and a year
    /// forgets x(0).
    pub(crate) const DRAWN: [Quantity; 5] = [Dilatation, Shear, Offset, Reach, Jump];

    /// The quantity of [`Quantity::FITTED`] with this key.
    pub fn fitted(key: &str) -> Option<Quantity> {
        Quantity::FITTED
            .into_iter()
            .find(|quantity| quantity.key() == key)
    }

    /// The key of the scenario, or a name of the same form if the scenario has no such key.
    pub fn key(self) -> &'static str {
        ROWS[self as usize].key
    }

    /// The symbol in formulas.
    pub fn symbol(self) -> &'static str {
        ROWS[self as usize].symbol
    }

    /// The unit, in metres, newtons and kelvin.
    pub fn unit(self) -> &'static str {
        ROWS[self as usize].unit
    }

    /// Its meaning, for a reader who does not know the model.
    pub fn words(self) -> &'static str {
        ROWS[self as usize].words
    }

    /// Whether the quantity can be known only if K_BP is.
    pub fn needs_shear_stiffness(self) -> bool {
        matches!(self, Stiffness | Static | Dynamic | Gap)
    }
}

/// The names of a quantity.
struct Row {
    key: &'static str,
    symbol: &'static str,
    unit: &'static str,
    words: &'static str,
}

const fn row(
    key: &'static str,
    symbol: &'static str,
    unit: &'static str,
    words: &'static str,
) -> Row {
    Row {
        key,
        symbol,
        unit,
        words,
    }
}

/// One row for each of [`Quantity::ALL`].
const ROWS: [Row; Quantity::ALL.len()] = [
    row(
        "oscillator.stiffness",
        "K",
        "N/m",
        "stiffness of the structure against the bearing",
    ),
    row(
        "oscillator.dilatation",
        "beta",
        "m/K",
        "movement of the joint per kelvin",
    ),
    row(
        "friction.static",
        "f_s",
        "N",
        "friction force at which the bearing slips",
    ),
    row(
        "friction.dynamic",
        "f_d",
        "N",
        "friction force while it slides",
    ),
    row(
        "friction.gap",
        "f_s - f_d",
        "N",
        "difference of the two friction forces",
    ),
    row("bearing.offset", "z0", "m", "offset of the sensor"),
    row(
        "initial.displacement",
        "x(0)",
        "m",
        "displacement at the start",
    ),
    row(
        "bearing.shear",
        "K/K_BP",
        "1",
        "share of the movement that shears the bearing",
    ),
    row("reach", "A", "K", "change of temperature from rest to slip"),
    row(
        "jump",
        "G",
        "K",
        "change of temperature that a slip releases",
    ),
    row(
        "static_way",
        "f_s/K",
        "m",
        "restrained movement before a slip",
    ),
    row(
        "dynamic_way",
        "f_d/K",
        "m",
        "restrained movement while it slides",
    ),
];

/// One value for each of [`Quantity::ALL`].
pub type Values = [f64; Quantity::ALL.len()];

/// A quantity, and the value at which it is fixed.
pub type Held = (Quantity, f64);

/// The quantities of a response. `shear_stiffness` is K_BP, if it is known; without it, the
/// quantities that need it are NaN.
pub fn values(response: &Response, shear_stiffness: Option<f64>) -> Values {
    let Response { motion, sensor } = response;
    let beta = sensor.dilatation();
    let kappa = sensor.still / beta;
    let kinetic = motion.kinetic_reach();
    let shear = shear_stiffness.unwrap_or(f64::NAN);
    // K beta = kappa beta K_BP.
    let slope = sensor.still * shear;
    Quantity::ALL.map(|quantity| match quantity {
        Stiffness => kappa * shear,
        Dilatation => beta,
        Static => motion.reach * slope,
        Dynamic => kinetic * slope,
        Gap => 0.5 * motion.jump * slope,
        Offset => sensor.offset,
        Displacement => beta * motion.start,
        Shear => kappa,
        Reach => motion.reach,
        Jump => motion.jump,
        StaticWay => motion.reach * beta,
        DynamicWay => kinetic * beta,
    })
}

/// The response that has these values.
pub fn response_of(values: &Values) -> Response {
    let of = |quantity: Quantity| values[quantity as usize];
    let (beta, kappa) = (of(Dilatation), of(Shear));
    Response {
        motion: Motion {
            reach: of(Reach),
            jump: of(Jump),
            start: of(Displacement) / beta,
        },
        sensor: Sensor::sheared(of(Offset), beta, kappa),
    }
}

/// All quantities from K, beta, f_s, f_d, z0 and x(0); the other values are computed again.
pub fn with_derived(values: &Values, shear_stiffness: f64) -> Values {
    let of = |quantity: Quantity| values[quantity as usize];
    let (stiffness, slope) = (of(Stiffness), of(Stiffness) * of(Dilatation));
    Quantity::ALL.map(|quantity| match quantity {
        Gap => of(Static) - of(Dynamic),
        Shear => stiffness / shear_stiffness,
        Reach => of(Static) / slope,
        Jump => 2.0 * (of(Static) - of(Dynamic)) / slope,
        StaticWay => of(Static) / stiffness,
        DynamicWay => of(Dynamic) / stiffness,
        Stiffness | Dilatation | Static | Dynamic | Offset | Displacement => of(quantity),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_and_responses_are_the_same_thing() {
        let slope = 1.9e8 * 3e-4;
        let response = Response {
            motion: Motion {
                reach: 4.7e5 / slope,
                jump: 1e5 / slope,
                start: 0.004 / 3e-4,
            },
            sensor: Sensor {
                offset: -0.01,
                moving: 0.905 * 3e-4,
                still: 0.095 * 3e-4,
            },
        };
        let found = values(&response, Some(2e9));
        let expected = [1.9e8, 3e-4, 4.7e5, 4.2e5, 5e4, -0.01, 0.004];
        let near = |a: f64, b: f64| (a / b - 1.0).abs() < 1e-12;
        assert!(
            found.iter().zip(expected).all(|(a, b)| near(*a, b)),
            "{found:?}"
        );
        let again = values(&response_of(&found), Some(2e9));
        assert!(found.iter().zip(again).all(|(a, b)| near(*a, b)));
        assert!(
            found
                .iter()
                .zip(with_derived(&found, 2e9))
                .all(|(a, b)| near(*a, b))
        );
        let unsheared = values(&response, None);
        assert!(
            Quantity::ALL
                .iter()
                .all(|q| unsheared[*q as usize].is_nan() == q.needs_shear_stiffness())
        );
    }
}
