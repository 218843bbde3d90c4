//! The text of a scenario: a scenario or an error, and a scenario that is written comes back as it was. Without what follows from it
//! (warnings, derived numbers), which takes most of the time of `mc check`.
#![no_main]

use libfuzzer_sys::fuzz_target;
use stick_slip::scenario::Scenario;

fuzz_target!(|text: &str| {
    if let Ok(scenario) = Scenario::parse("fuzz", text, &[]) {
        let written = scenario.to_toml();
        let again = Scenario::parse_stored("fuzz", &written, &[], scenario.model.temperature.series.as_ref());
        assert_eq!(again.expect("what was written is read").to_toml(), written);
    }
});
