//! The unit that the name of a column gives: `temperature_degC`, `displacement [mm]`, `time_h`.

/// What a column measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ColumnQuantity {
    /// Temperature. Degrees Celsius and kelvin are kept as given, because only differences act on
    /// the body; Fahrenheit is converted to Celsius. Without a unit, values are kept as given.
    Temperature,
    /// Displacement, converted to metres. A column without a unit is an error.
    Displacement,
}

/// A unit: value = times (cell - origin) / over. The scale is kept as a ratio of two numbers, so
/// that 2.5 mm becomes the double nearest to 0.0025.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Unit {
    times: f64,
    over: f64,
    origin: f64,
    /// The lowest value that a cell may hold: absolute zero for temperatures.
    pub least: f64,
}

impl Unit {
    const AS_GIVEN: Unit = Unit { times: 1.0, over: 1.0, origin: 0.0, least: f64::NEG_INFINITY };

    fn larger(times: f64) -> Unit {
        Unit { times, ..Self::AS_GIVEN }
    }

    fn smaller(over: f64) -> Unit {
        Unit { over, ..Self::AS_GIVEN }
    }

    /// The value of a cell in the unit of the results.
    pub fn of(&self, cell: f64) -> f64 {
        self.times * (cell - self.origin) / self.over
    }
}

/// The unit of temperature that is called so, if there is one.
fn temperature(name: &str) -> Option<Unit> {
    match name {
        "degc" | "c" | "celsius" | "\u{b0}c" => Some(Unit { least: -273.15, ..Unit::AS_GIVEN }),
        "k" | "kelvin" => Some(Unit { least: 0.0, ..Unit::AS_GIVEN }),
        "degf" | "f" | "fahrenheit" | "\u{b0}f" => {
            Some(Unit { over: 1.8, origin: 32.0, least: -459.67, ..Unit::AS_GIVEN })
        }
        _ => None,
    }
}

fn displacement(name: &str) -> Option<Unit> {
    match name {
        "m" => Some(Unit::AS_GIVEN),
        "cm" => Some(Unit::smaller(1e2)),
        "mm" => Some(Unit::smaller(1e3)),
        "um" | "\u{b5}m" | "\u{3bc}m" => Some(Unit::smaller(1e6)),
        _ => None,
    }
}

fn time(name: &str) -> Option<Unit> {
    match name {
        "ms" => Some(Unit::smaller(1e3)),
        "s" | "sec" | "second" | "seconds" => Some(Unit::AS_GIVEN),
        "min" | "minute" | "minutes" => Some(Unit::larger(60.0)),
        "h" | "hour" | "hours" => Some(Unit::larger(3600.0)),
        "d" | "day" | "days" => Some(Unit::larger(86_400.0)),
        _ => None,
    }
}

/// The conversion of numbers in this unit of time to seconds; `None` if the unit is unknown.
#[cfg(feature = "store")]
pub(super) fn seconds_of(unit: &str) -> Option<impl Fn(f64) -> f64 + use<>> {
    let unit = time(&unit.to_lowercase())?;
    Some(move |number| unit.of(number))
}

/// The part of a name that may be a unit: in brackets at its end (the flag is then true), or after
/// its last underscore.
fn suffix(name: &str) -> Option<(&str, bool)> {
    let brackets =
        |open: char, close: char| name.strip_suffix(close)?.rsplit_once(open).map(|(_, unit)| (unit.trim(), true));
    let underscore = || name.rsplit_once('_').map(|(_, unit)| (unit, false));
    brackets('[', ']').or_else(|| brackets('(', ')')).or_else(underscore)
}

/// The unit of a column of values; the error is what is wrong and the remedy.
pub(super) fn of_values(quantity: ColumnQuantity, column: &str, given: Option<&str>) -> Result<Unit, (String, String)> {
    let (known, names): (fn(&str) -> Option<Unit>, _) = match quantity {
        ColumnQuantity::Temperature => (temperature, "degC, K or degF"),
        ColumnQuantity::Displacement => (displacement, "m, cm, mm or um"),
    };
    if let Some(given) = given {
        let unknown = || (format!("no unit is called `{given}`"), format!("give {names}"));
        return known(&given.to_lowercase()).ok_or_else(unknown);
    }
    let named = suffix(column);
    match (named.and_then(|(unit, _)| known(&unit.to_lowercase())), named, quantity) {
        (Some(unit), ..) => Ok(unit),
        (None, Some((unit, true)), _) => Err((
            format!("column `{column}` has a unit that is not known, `{unit}`"),
            format!("convert it to one of {names}, and say so in the name"),
        )),
        (None, _, ColumnQuantity::Temperature) => Ok(Unit::AS_GIVEN),
        (None, _, ColumnQuantity::Displacement) => Err((
            format!("the name of column `{column}` says no unit"),
            format!("rename it, e.g. to `{column}_mm`, or give the unit, one of {names}"),
        )),
    }
}

/// The conversion to seconds for a column of numeric times; `None` if the name of the column gives
/// no unit.
pub(super) fn of_time(column: &str) -> Option<Unit> {
    suffix(column).and_then(|(unit, _)| time(&unit.to_lowercase()))
}
