//! Flags whose values a shell can complete.

use clap::Command;
use clap::builder::{PossibleValue, TypedValueParser};
use std::ffi::OsStr;
use stickslip::config;
use stickslip::scheme::Kind;
use stickslip::stats::Statistic;

/// Reads a value with a function, and lists the words that a shell completes it with. Values
/// outside the list reach the function too, whose error messages are more specific than those of
/// clap.
#[derive(Clone, Copy)]
pub struct Completed<T> {
    words: fn() -> Vec<String>,
    read: fn(&str) -> Result<T, String>,
}

/// The name of a statistic.
pub const STATISTIC: Completed<Statistic> = Completed {
    words: || {
        Statistic::ALL
            .map(|statistic| statistic.name().to_string())
            .into()
    },
    read: statistic,
};

/// The name of a scheme. An unknown name is reported when the scenario is checked.
pub const SCHEME: Completed<String> = Completed {
    words: || {
        Kind::ALL
            .iter()
            .map(|kind| kind.name().to_string())
            .collect()
    },
    read: as_it_is,
};

/// A key with a value, `key=value`. An unknown key or a wrong value is reported when the scenario
/// is checked.
pub const SETTING: Completed<String> = Completed {
    words: || {
        config::keys()
            .iter()
            .map(|known| format!("{}=", known.key))
            .collect()
    },
    read: as_it_is,
};

fn as_it_is(text: &str) -> Result<String, String> {
    Ok(text.to_string())
}

/// The statistic with this name.
fn statistic(name: &str) -> Result<Statistic, String> {
    Statistic::from_name(name)
        .ok_or_else(|| format!("unknown statistic; use one of {}", crate::statistic_names()))
}

impl<T: Clone + Send + Sync + 'static> TypedValueParser for Completed<T> {
    type Value = T;

    fn parse_ref(
        &self,
        command: &Command,
        arg: Option<&clap::Arg>,
        value: &OsStr,
    ) -> Result<T, clap::Error> {
        self.read.parse_ref(command, arg, value)
    }

    fn possible_values(&self) -> Option<Box<dyn Iterator<Item = PossibleValue> + '_>> {
        Some(Box::new((self.words)().into_iter().map(PossibleValue::new)))
    }
}
