//! Figures of a calibration and of a forecast.

mod calendar;
mod calibration;
mod hysteresis;
mod measured;
mod residuals;
mod years;

pub use years::years;

use stickslip_figure::Figure;

/// The figures of a calibration, in the order in which a page shows them.
pub const FIGURES: &[Figure] = &[
    Figure {
        name: "calibration",
        draws: calibration::draw,
    },
    Figure {
        name: "loops",
        draws: hysteresis::draw,
    },
    Figure {
        name: "residuals",
        draws: residuals::draw,
    },
];
