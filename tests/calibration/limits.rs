//! Limits of a calibration: what cannot be known, and what is refused.

use crate::bridge::{BRIDGE, RED_CAMPAIGN, ask, question, record, twin_of, warns};
use stick_slip::bearing::calibration::{
    Bearing, CalibrationError, CalibrationMethod, CalibrationQuestion, MeasuredRecord, Quantity, calibrate,
};

/// Without K_BP the data determine beta, f_s/K and f_d/K, but no force. This holds for a rigid
/// bearing, and for a sheared one whose K_BP is not given.
#[test]
fn without_the_shear_stiffness_there_are_no_forces() {
    for shear_stiffness in [f64::INFINITY, 2.0e9] {
        let bearing = Bearing { shear_stiffness, ..BRIDGE };
        let (twin, truth) = twin_of(&bearing, &RED_CAMPAIGN, 42);
        let fit =
            ask(&record(&twin), &CalibrationQuestion { shear_stiffness: None, ..question(CalibrationMethod::Slips) });
        assert!(warns(&fit, "no_shear_stiffness"));
        for quantity in Quantity::ALL {
            let estimate = fit.estimate(quantity);
            assert_eq!(estimate.estimate.is_nan(), quantity.needs_shear_stiffness(), "{quantity:?}");
        }
        for quantity in [Quantity::Dilatation, Quantity::StaticWay, Quantity::DynamicWay] {
            let off = fit.estimate(quantity).estimate / truth[quantity as usize] - 1.0;
            assert!(off.abs() < 0.04, "{quantity:?}: {off}");
        }
    }
}

/// A bearing with f_s = f_d slides without slips, and noise larger than its motion makes some of
/// the motion look like slips. The fit warns about it and still determines f_d/K to 5 %. It does
/// not warn for bearings that slip.
#[test]
fn sliding_without_slips_is_said() {
    let said = |bearing: &Bearing| {
        let (twin, truth) = twin_of(bearing, &RED_CAMPAIGN, 43);
        let fit = ask(&record(&twin), &question(CalibrationMethod::Slips));
        let off = fit.estimate(Quantity::DynamicWay).estimate / truth[Quantity::DynamicWay as usize] - 1.0;
        assert!(off.abs() < 0.05, "{off}");
        warns(&fit, "gap_not_identified")
    };
    assert!(said(&Bearing { f_d: BRIDGE.f_s, ..BRIDGE }));
    assert!(!said(&BRIDGE));
}

#[test]
fn no_record_is_refused() {
    let flat = |n: usize, z: fn(usize) -> f64, t: fn(usize) -> f64| MeasuredRecord {
        times: (0..n).map(|i| 600.0 * i as f64).collect(),
        temperatures: (0..n).map(t).collect(),
        readings: (0..n).map(z).collect(),
    };
    let ask = |record: MeasuredRecord| {
        calibrate(&record, &question(CalibrationMethod::Both), 1, &Default::default()).map(|_| ())
    };
    let wave = |i: usize| (0.1 * i as f64).sin();
    assert_eq!(ask(flat(20, wave, wave)).unwrap_err(), CalibrationError::TooShort(20));
    assert_eq!(ask(flat(0, wave, wave)).unwrap_err(), CalibrationError::TooShort(0));
    assert_eq!(ask(flat(2000, wave, |_| 20.0)).unwrap_err(), CalibrationError::Constant("temperature"));
    assert_eq!(ask(flat(2000, |_| 0.0, wave)).unwrap_err(), CalibrationError::Constant("displacement"));
    // If the body never slips, z follows T, and nothing else can be determined.
    let still = CalibrationQuestion { starts: 1, ..question(CalibrationMethod::Both) };
    let fit = calibrate(&flat(2000, wave, wave), &still, 1, &Default::default()).expect("an answer with warnings");
    assert!(warns(&fit, "no_slips"));
}
