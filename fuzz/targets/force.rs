//! Reads the text of a force with two parameters. The result is an error at a place in the text, or
//! an expression that has values, the same for one path and for eight, and doubts about its places.
#![no_main]

use libfuzzer_sys::fuzz_target;
use stickslip::lanes::InstructionSet;
use stickslip::model::{Expression, Force, Scales, doubts};

fuzz_target!(|text: &str| {
    match Expression::parse(text, &[("mu".into(), 0.3), ("vs".into(), 0.1)]) {
        Ok(expression) => {
            let scales = Scales { displacement: 2.0, velocity: 1.5, end: 30.0 };
            assert!(doubts(&expression, scales).iter().all(|doubt| text.get(doubt.start..doubt.end).is_some()));
            let force = Force::new(expression);
            let x = [0.0, 1.0, -1.0, 0.3, -2.7, 1e-9, 40.0, -1e5];
            let velocity = [0.5, 0.0, -3.0, 1e3, 0.0, -0.1, 2.0, 1.0];
            for set in InstructionSet::ALL.into_iter().filter(|set| set.is_available()) {
                let mut all = [0.0; 8];
                force.fill(set, &x, &velocity, 0.7, &mut all);
                for (i, g) in all.into_iter().enumerate() {
                    let one = force.at(set, x[i], velocity[i], 0.7);
                    assert!(g.to_bits() == one.to_bits() || (g.is_nan() && one.is_nan()), "{text}: {g} is not {one}");
                }
            }
        }
        Err(error) => assert!(text.get(error.start..error.end).is_some(), "{error:?}"),
    }
});
