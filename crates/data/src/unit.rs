//! The unit that the name of a column gives: `temperature_degC`, `displacement [mm]`, `Temp, °F`.

use super::error::ProblemAndRemedy;

/// What a column measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ColumnQuantity {
    /// Temperature. Degrees Celsius and kelvin are kept as given, because only differences act on
    /// the body; other units are converted to degrees Celsius or kelvin. Without a unit, values are
    /// kept as given.
    Temperature,
    /// Displacement, converted to metres. A column without a unit is an error.
    Displacement,
    /// An input that acts on a body: an acceleration, a force or a length, converted to SI units.
    /// Without a unit, values are kept as given. Inputs are not repaired.
    Input,
}

impl ColumnQuantity {
    /// Its name, with which the name of its column begins.
    pub fn word(self) -> &'static str {
        match self {
            ColumnQuantity::Temperature => "temperature",
            ColumnQuantity::Displacement => "displacement",
            ColumnQuantity::Input => "input",
        }
    }

    /// The permitted units, in words.
    pub(super) fn units(self) -> &'static str {
        match self {
            ColumnQuantity::Temperature => "degC, K, degF or degR",
            ColumnQuantity::Displacement => "m, cm, mm or um",
            ColumnQuantity::Input => {
                "m/s2, cm/s2, mm/s2, ft/s2, in/s2, g, mg, gal, N, kN, MN, lbf, m, cm, mm, ft, in, or none for values as they are"
            }
        }
    }

    /// The unit with this name, if there is one.
    pub(super) fn unit(self, name: &str) -> Option<InputUnit> {
        match self {
            ColumnQuantity::Temperature => temperature(name),
            ColumnQuantity::Displacement => displacement(name),
            ColumnQuantity::Input => input(name).map(|(unit, _)| unit),
        }
    }
}

/// A unit: value = times (cell - origin) / over. The scale is kept as a ratio of two numbers, so
/// that 2.5 mm becomes the double nearest to 0.0025.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct InputUnit {
    times: f64,
    over: f64,
    origin: f64,
    /// The lowest value that a cell may hold: absolute zero for temperatures.
    pub least: f64,
    /// The name of a unit of an input.
    pub name: &'static str,
}

impl InputUnit {
    pub const AS_GIVEN: InputUnit = InputUnit {
        times: 1.0,
        over: 1.0,
        origin: 0.0,
        least: f64::NEG_INFINITY,
        name: "",
    };

    fn larger(times: f64) -> InputUnit {
        InputUnit {
            times,
            ..Self::AS_GIVEN
        }
    }

    fn smaller(over: f64) -> InputUnit {
        InputUnit {
            over,
            ..Self::AS_GIVEN
        }
    }

    /// The value of a cell in the unit of the results.
    pub fn of(&self, cell: f64) -> f64 {
        self.times * (cell - self.origin) / self.over
    }

    /// The number that a cell in another unit would have in this one.
    pub fn cell_of(&self, other: &InputUnit, cell: f64) -> f64 {
        // Results of one unit may be in kelvin, and those of the other in degrees Celsius.
        let shift = self.of(self.least) - other.of(other.least);
        let value = other.of(cell) + if shift.is_finite() { shift } else { 0.0 };
        value * self.over / self.times + self.origin
    }
}

/// The scale at the beginning of a unit, as in `0.1degC`, `0,01 mm` and `1/10 K`, and the rest.
fn scaled(name: &str) -> Option<(InputUnit, &str)> {
    let end = name
        .find(|c: char| !(c.is_ascii_digit() || ".,/".contains(c)))
        .unwrap_or(name.len());
    let (number, rest) = (name[..end].replace(',', "."), name[end..].trim_start());
    if number.is_empty() {
        return Some((InputUnit::AS_GIVEN, name));
    }
    let (times, over) = number.split_once('/').unwrap_or((&number, "1"));
    let (times, over) = (times.parse::<f64>().ok()?, over.parse::<f64>().ok()?);
    let scale = Some(times / over).filter(|scale| *scale > 0.0)?;
    // A scale of 0.1 is kept as one over 10, so that 155 tenths are the double nearest to 15.5.
    Some(match scale < 1.0 {
        true => (InputUnit::smaller((1.0 / scale).round()), rest),
        false => (InputUnit::larger(scale), rest),
    })
}

/// A unit of temperature, which may have a scale: `degC`, `°F`, `mK`, `0.1degC`, `degrees Celsius`.
fn temperature(name: &str) -> Option<InputUnit> {
    let name = name.replace('\u{2103}', "C").replace('\u{2109}', "F");
    let name: String = name
        .chars()
        .filter(|c| !c.is_whitespace() && !"_*\u{ba}\u{b0}".contains(*c))
        .collect();
    let (scale, name) = match name.trim_end_matches('.') {
        "mK" => (InputUnit::smaller(1e3), "K"),
        name => scaled(name)?,
    };
    let lower = name.to_lowercase();
    let bare = ["degrees", "degree", "degs", "deg"]
        .iter()
        .find_map(|prefix| lower.strip_prefix(prefix))
        .unwrap_or(&lower);
    let (unit, least) = match bare {
        "c" | "celsius" | "centigrade" => (InputUnit::AS_GIVEN, -273.15),
        "k" | "kelvin" | "kelvins" => (InputUnit::AS_GIVEN, 0.0),
        "f" | "fahrenheit" => (
            InputUnit {
                over: 1.8,
                origin: 32.0,
                ..InputUnit::AS_GIVEN
            },
            -459.67,
        ),
        "r" | "rankine" => (InputUnit::smaller(1.8), 0.0),
        _ => return None,
    };
    // (cell scale - origin) / over, with the scale taken into the origin and the ratio.
    let of_scale = scale.times / scale.over;
    let origin = unit.origin / of_scale;
    let (times, over) = (scale.times, unit.over * scale.over);
    Some(InputUnit {
        times,
        over,
        origin,
        least: least / of_scale,
        ..InputUnit::AS_GIVEN
    })
}

/// A row of a table of units: the names of a unit, and its ratio to the SI unit.
type UnitRow = (&'static [&'static str], [f64; 2]);

/// The unit of a table with this name, and its standard name. Case is ignored unless two units
/// differ only in it, like MN and mN.
fn in_table(table: &[UnitRow], name: &str) -> Option<(InputUnit, &'static str)> {
    let has = |same: fn(&str, &str) -> bool| {
        let mut rows = table
            .iter()
            .filter(move |(names, _)| names.iter().any(|known| same(known, name)));
        rows.next().filter(|_| rows.next().is_none())
    };
    let (names, [times, over]) = has(|a, b| a == b).or_else(|| has(str::eq_ignore_ascii_case))?;
    Some((
        InputUnit {
            times: *times,
            over: *over,
            ..InputUnit::AS_GIVEN
        },
        names[0],
    ))
}

/// Units of length. Those of a displacement end with um.
const LENGTHS: [UnitRow; 6] = [
    (&["m", "metre", "metres", "meter", "meters"], [1.0, 1.0]),
    (&["cm"], [1.0, 1e2]),
    (
        &[
            "mm",
            "millimetre",
            "millimetres",
            "millimeter",
            "millimeters",
        ],
        [1.0, 1e3],
    ),
    (
        &[
            "um",
            "\u{b5}m",
            "\u{3bc}m",
            "micron",
            "microns",
            "micrometre",
            "micrometer",
        ],
        [1.0, 1e6],
    ),
    (&["ft", "foot", "feet"], [3048.0, 1e4]),
    (&["in", "inch", "inches"], [254.0, 1e4]),
];

/// The units of acceleration that are a length over the square of a second, as `LENGTHS`.
const ACCELERATIONS: [&str; 6] = ["m/s2", "cm/s2", "mm/s2", "um/s2", "ft/s2", "in/s2"];

/// The part after the length in the name of such a unit, without blanks, slashes and carets.
const PER_SECOND_SQUARED: [&str; 5] = ["s2", "ss", "s-2", "sec2", "secsec"];

/// Standard gravity, in m/s2.
const GRAVITY: f64 = 9.80665;

/// Other units of acceleration.
const GRAVITIES: [UnitRow; 3] = [
    (&["g", "g's", "gs"], [GRAVITY, 1.0]),
    (&["mg"], [GRAVITY, 1e3]),
    (&["gal", "gals"], [1.0, 1e2]),
];

/// Units of force.
const FORCES: [UnitRow; 8] = [
    (&["N", "newton", "newtons"], [1.0, 1.0]),
    (&["mN"], [1.0, 1e3]),
    (&["kN"], [1e3, 1.0]),
    (&["MN"], [1e6, 1.0]),
    (&["GN"], [1e9, 1.0]),
    (&["lbf"], [POUND_FORCE, 1.0]),
    (&["kip", "kips"], [1e3 * POUND_FORCE, 1.0]),
    (&["kgf"], [GRAVITY, 1.0]),
];

/// 0.45359237 kg times standard gravity, in N.
const POUND_FORCE: f64 = 4.448_221_615_260_5;

/// The unit of unconverted values: in SI units, or in those of the scenario.
const PLAIN: [UnitRow; 1] = [(&["none"], [1.0, 1.0])];

/// A unit of displacement, which may have a scale, as in `1/100 mm`.
fn displacement(name: &str) -> Option<InputUnit> {
    let (scale, name) = scaled(name)?;
    let (unit, _) = in_table(&LENGTHS[..4], name)?;
    Some(InputUnit {
        times: unit.times * scale.times,
        over: unit.over * scale.over,
        ..unit
    })
}

/// Whether a name or a unit contains a factor, as in `T x10` and `degC/10`. It may be the one that
/// was applied, or the one that is to be applied.
pub(super) fn has_factor(quantity: ColumnQuantity, text: &str) -> bool {
    // `*C` is a degree sign.
    let lower = text.to_lowercase().replace("*c", "c").replace("*f", "f");
    let is_between = |c: char| c.is_whitespace() || "_,;[]()".contains(c);
    let words: Vec<&str> = lower
        .split(is_between)
        .filter(|word| !word.is_empty())
        .collect();
    let power = |text: &str| text.parse::<f64>().map_or(0.0, f64::log10);
    let is_ten =
        |text: &str| power(text) != 0.0 && (power(text) - power(text).round()).abs() < 1e-9;
    let is_factor = |word: &str| {
        let mut sides = "x/*\u{d7}\u{b7}"
            .chars()
            .filter_map(|sign| Some((sign, word.rsplit_once(sign)?)));
        sides.any(|(sign, (a, b))| {
            let is_beside = |text: &str| {
                text.is_empty() || !"x/".contains(sign) || quantity.unit(text).is_some()
            };
            is_ten(a) && is_beside(b) || is_ten(b) && is_beside(a)
        })
    };
    let named = [
        "tenth",
        "hundredth",
        "zehntel",
        "hundertstel",
        "10^",
        "10e-",
        "1e-",
    ];
    words
        .iter()
        .any(|word| is_factor(word) || named.iter().any(|name| word.starts_with(name)))
        || words.windows(2).any(|pair| is_factor(&pair.concat()))
}

/// The error of a name or a unit with a factor.
pub(super) fn factor(quantity: ColumnQuantity, of: &str) -> ProblemAndRemedy {
    let example = match quantity {
        ColumnQuantity::Displacement => "0.01mm",
        _ => "0.1degC",
    };
    (
        format!(
            "{of} contains a factor, by which the numbers may have to be multiplied or divided"
        ),
        format!("give the unit of the numbers as `unit`, e.g. `{example}`"),
    )
}

/// A unit of an input, and the SI unit to which it is converted; empty for `none`.
fn input(name: &str) -> Option<(InputUnit, &'static str)> {
    let bare: String = name
        .replace('\u{b2}', "2")
        .chars()
        .filter(|c| !" ^*\u{b7}/.".contains(*c))
        .collect();
    let lower = bare.to_ascii_lowercase();
    let length = PER_SECOND_SQUARED
        .iter()
        .find_map(|end| in_table(&LENGTHS, lower.strip_suffix(end)?));
    if let Some((unit, length)) = length {
        let of_length = |called: &&&str| called.strip_suffix("/s2") == Some(length);
        return Some((
            InputUnit {
                name: ACCELERATIONS.iter().find(of_length)?,
                ..unit
            },
            "m/s2",
        ));
    }
    if name.contains('/') {
        return None;
    }
    let tables: [(&[UnitRow], _); 4] = [
        (&GRAVITIES, "m/s2"),
        (&FORCES, "N"),
        (&LENGTHS, "m"),
        (&PLAIN, ""),
    ];
    let known = tables
        .into_iter()
        .find_map(|(table, si)| Some((in_table(table, &bare)?, si)));
    known.map(|((unit, name), si)| (InputUnit { name, ..unit }, si))
}

/// The unit of an input with this name: the SI unit to which it is converted, and its value in that
/// unit.
///
/// ```
/// use stickslip_data::input_unit;
///
/// assert_eq!(input_unit("g"), Some(("m/s2", 9.80665)));
/// assert_eq!(input_unit("mg"), Some(("m/s2", 9.80665e-3)));
/// assert_eq!(input_unit("furlong"), None);
/// ```
pub fn input_unit(name: &str) -> Option<(&'static str, f64)> {
    input(name).map(|(unit, si)| (si, unit.of(1.0)))
}

/// A unit of time, converted to seconds.
pub(super) fn time(name: &str) -> Option<InputUnit> {
    match name.to_lowercase().as_str() {
        "ms" | "msec" => Some(InputUnit::smaller(1e3)),
        "s" | "sec" | "second" | "seconds" => Some(InputUnit::AS_GIVEN),
        "min" | "minute" | "minutes" => Some(InputUnit::larger(60.0)),
        "h" | "hour" | "hours" => Some(InputUnit::larger(3600.0)),
        "d" | "day" | "days" => Some(InputUnit::larger(86_400.0)),
        _ => None,
    }
}

/// The text in the last pair of brackets of a name, if only blanks and other brackets follow.
fn bracketed(name: &str) -> impl Iterator<Item = &str> {
    name.split(['[', '('])
        .skip(1)
        .filter_map(|part| part.split([']', ')']).next())
        .map(str::trim)
}

/// The units in a name. A unit is one of its parts between blanks, underscores and commas, up to
/// three parts together as in `0.1 deg C`, or a capital at the end of a part as in `tempF` and
/// `AirTC`. The first part is the noun, and not a unit by itself.
fn words(quantity: ColumnQuantity, name: &str) -> Vec<InputUnit> {
    let is_input = quantity == ColumnQuantity::Input;
    let parts = parts(quantity, name);
    let unit = |text: &str| {
        quantity.unit(text).filter(|_| {
            !(is_input
                && WORDS_OR_UNITS
                    .iter()
                    .any(|word| word.eq_ignore_ascii_case(text)))
        })
    };
    let mut found: Vec<InputUnit> = parts
        .iter()
        .filter_map(|part| quantity.unit(joined_to_noun(part)?))
        .collect();
    // `a/g` and `acc/cm/s2`, as DIN 1313 writes the heading of a column.
    let of_noun = || unit(parts.first()?.split_once('/')?.1);
    found.extend(is_input.then(of_noun).flatten());
    let mut at = 1;
    while at < parts.len() {
        let most = 3.min(parts.len() - at);
        let longest = (1..=most)
            .rev()
            .find_map(|n| Some((n, unit(&parts[at..at + n].concat())?)));
        at += longest.map_or(1, |(n, _)| n);
        found.extend(longest.map(|(_, unit)| unit));
    }
    found
}

/// The parts of a name. A slash is within a unit of an input, and between words elsewhere.
fn parts(quantity: ColumnQuantity, name: &str) -> Vec<&str> {
    let is_between =
        |c: char| " _,;\t-[]()".contains(c) || c == '/' && quantity != ColumnQuantity::Input;
    name.split(is_between)
        .filter(|part| !part.is_empty())
        .collect()
}

/// Units that may also be words at the end of a name: north, and input or inside. They count only
/// in brackets.
const WORDS_OR_UNITS: [&str; 2] = ["N", "in"];

/// Symbols of units that are not units of an input, in addition to those of a prefix and a unit.
const FOREIGN: [&str; 12] = [
    "Pa", "bar", "psi", "ksi", "Hz", "rad", "deg", "degC", "lb", "lbs", "mph", "mA",
];

/// Whether a part of the name of an input can only be a unit: it has a slash before a small letter,
/// a square, a degree or a per cent sign, it is a prefix with a symbol (`mV`, `kPa`, `km`), or the
/// symbol of a unit of something else. Words, single letters and numbers are names.
pub(super) fn is_claim(part: &str) -> bool {
    let prefixed = part.strip_prefix(['G', 'M', 'k', 'h', 'd', 'c', 'm', 'u', '\u{b5}', 'n']);
    let is_over = |(_, under): (&str, &str)| under.starts_with(|c: char| c.is_ascii_lowercase());
    part.split_once('/').is_some_and(is_over)
        || part.contains(['^', '\u{b2}', '\u{b0}', '%'])
        || prefixed.is_some_and(|symbol| ["m", "g", "N", "Pa", "V"].contains(&symbol))
        || FOREIGN.contains(&part)
}

/// The end of a part that gives the unit without a separator.
fn joined_to_noun(part: &str) -> Option<&str> {
    if let Some(at) = part.find(['\u{b0}', '\u{2103}', '\u{2109}', '*']) {
        return Some(&part[at..]);
    }
    let before = part.trim_end_matches(['C', 'F', 'K', 'R', 'T']);
    let after = &part[before.len()..];
    let is_noun = |text: &str| {
        ["temperature", "temp", "tmp"]
            .iter()
            .any(|end| text.to_lowercase().ends_with(end))
    };
    match after {
        "C" | "F" | "K" | "R" if is_noun(before) => Some(after),
        "TC" | "TF" | "TK" => Some(&after[1..]),
        _ => {
            let at = part
                .to_lowercase()
                .find("deg")
                .filter(|at| part.is_char_boundary(*at) && is_noun(&part[..*at]))?;
            Some(&part[at..])
        }
    }
}

/// Words in brackets that are not a unit but name a sensor or a statistic.
fn is_note(text: &str) -> bool {
    let lower = text.to_lowercase();
    text.contains(':')
        || [
            "avg", "mean", "min", "max", "smp", "std", "raw", "air", "steel",
        ]
        .contains(&lower.as_str())
}

/// The unit in the name of a column; an error if there are two, or an unknown one.
pub(super) fn of_name(
    quantity: ColumnQuantity,
    column: &str,
) -> Result<Option<InputUnit>, ProblemAndRemedy> {
    if quantity != ColumnQuantity::Input && has_factor(quantity, column) {
        return Err(factor(quantity, &format!("the name of column `{column}`")));
    }
    let mut found: Option<InputUnit> = None;
    let mut unknown = None;
    for text in bracketed(column) {
        match quantity.unit(text).or_else(|| {
            text.split([' ', ',', ';'])
                .find_map(|word| quantity.unit(word))
        }) {
            Some(unit) if found.is_none_or(|known| known == unit) => found = Some(unit),
            Some(_) => return Err(two(column)),
            None if is_note(text) || text.parse::<u32>().is_ok() => {}
            None => unknown = Some(text),
        }
    }
    if found.is_some() {
        return Ok(found);
    }
    if let Some(unit) = unknown {
        return Err(unknown_unit(quantity, column, unit));
    }
    let named = words(quantity, column);
    let claim = || {
        parts(quantity, column)
            .into_iter()
            .skip(1)
            .find(|part| is_claim(part))
    };
    if let Some(unit) = claim().filter(|_| quantity == ColumnQuantity::Input && named.is_empty()) {
        return Err(unknown_unit(quantity, column, unit));
    }
    if named.iter().any(|unit| *unit != named[0]) {
        Err(two(column))
    } else {
        Ok(named.first().copied())
    }
}

/// Whether a cell below the names of the columns is a unit of this quantity.
pub(super) fn is_unit(quantity: ColumnQuantity, cell: &str) -> bool {
    let inside = cell.trim_matches(['[', ']', '(', ')', ' ']);
    quantity.unit(inside).is_some() || has_factor(quantity, inside)
}

pub(super) fn unknown_unit(quantity: ColumnQuantity, column: &str, unit: &str) -> ProblemAndRemedy {
    (
        format!("column `{column}` has the unknown unit `{unit}`"),
        format!(
            "convert it to one of {}, and give that in the name or as `unit`",
            quantity.units()
        ),
    )
}

fn two(column: &str) -> ProblemAndRemedy {
    (
        format!("the name of column `{column}` gives two units"),
        "keep only the right unit in the name".into(),
    )
}

/// The conversion to seconds for a column of numeric times; `None` if the name of the column gives
/// no unit.
pub(super) fn of_time(column: &str) -> Option<InputUnit> {
    let suffix = column.rsplit_once('_').map(|(_, unit)| unit);
    let last = column.rsplit_once([' ', ',']).map(|(_, unit)| unit);
    bracketed(column).chain(suffix).chain(last).find_map(time)
}
