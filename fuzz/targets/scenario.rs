//! Reads the text of a scenario. The result is a scenario or an error, and a scenario that is
//! written and read again is the same. What follows from a scenario (warnings, derived numbers) is
//! left out, because it takes most of the time of `mc check`.
#![no_main]

use libfuzzer_sys::fuzz_target;
use stickslip::scenario::Scenario;

fuzz_target!(|text: &str| {
    if let Ok(scenario) = Scenario::parse("fuzz", text, &[]) {
        let written = scenario.to_toml();
        let again = Scenario::parse_stored("fuzz", &written, &[], &scenario.samples());
        assert_eq!(again.expect("what was written is read").to_toml(), written);
    }
});
