//! The dimension of a number, and its unit written with the unit labels of a scenario.

/// The dimension of a number: its unit is a product of these powers of the units of time, length,
/// force and temperature.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Dimension {
    /// Power of time.
    pub time: i32,
    /// Power of length.
    pub length: i32,
    /// Power of force.
    pub force: i32,
    /// Power of temperature.
    pub temperature: i32,
}

/// Unit labels. A label is empty where the scenario is dimensionless.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Units {
    /// Label of time, e.g. "s".
    pub time: String,
    /// Label of length, e.g. "m".
    pub length: String,
    /// Label of force, e.g. "N".
    pub force: String,
    /// Label of temperature, e.g. "K".
    pub temperature: String,
}

impl Dimension {
    /// A pure number.
    pub const ONE: Dimension = Dimension {
        time: 0,
        length: 0,
        force: 0,
        temperature: 0,
    };
    /// time
    pub const TIME: Dimension = Dimension {
        time: 1,
        ..Dimension::ONE
    };
    /// length
    pub const LENGTH: Dimension = Dimension {
        length: 1,
        ..Dimension::ONE
    };
    /// force
    pub const FORCE: Dimension = Dimension {
        force: 1,
        ..Dimension::ONE
    };
    /// temperature
    pub const TEMPERATURE: Dimension = Dimension {
        temperature: 1,
        ..Dimension::ONE
    };
    /// length / time
    pub const VELOCITY: Dimension = Dimension {
        length: 1,
        time: -1,
        ..Dimension::ONE
    };
    /// length^2
    pub const AREA: Dimension = Dimension {
        length: 2,
        ..Dimension::ONE
    };
    /// length^2 / time
    pub const DIFFUSIVITY: Dimension = Dimension {
        length: 2,
        time: -1,
        ..Dimension::ONE
    };
    /// force * length
    pub const WORK: Dimension = Dimension {
        force: 1,
        length: 1,
        ..Dimension::ONE
    };

    /// The labels with their powers, in the order in which products are written, as in newton metre
    /// or metre per second.
    fn factors(self, units: &Units) -> [(&str, i32); 4] {
        let Dimension {
            time,
            length,
            force,
            temperature,
        } = self;
        [
            (&units.force, force),
            (&units.length, length),
            (&units.temperature, temperature),
            (&units.time, time),
        ]
        .map(|(label, power)| (label.as_str(), power))
    }

    /// The unit as people write it: `m²/s`, `N m`, `1/s`; empty where nothing has a label.
    pub fn label(self, units: &Units) -> String {
        let product = |of: &[(&str, i32)]| {
            let factors = of
                .iter()
                .filter(|(label, power)| !label.is_empty() && *power > 0);
            let written = factors.map(|(label, power)| match power {
                1 => label.to_string(),
                2 => format!("{label}\u{b2}"),
                _ => format!("{label}^{power}"),
            });
            written.collect::<Vec<_>>().join(" ")
        };
        let factors = self.factors(units);
        let (above, below) = (
            product(&factors),
            product(&factors.map(|(label, power)| (label, -power))),
        );
        match (above.is_empty(), below.is_empty()) {
            (_, true) => above,
            (true, false) => format!("1/{below}"),
            (false, false) => format!("{above}/{below}"),
        }
    }

    /// The unit in the notation of UDUNITS, which netCDF files use: `m2 s-1`, `N m`, `s-1`; `1`
    /// where nothing has a label.
    pub fn udunits(self, units: &Units) -> String {
        let factors = self
            .factors(units)
            .into_iter()
            .filter_map(|(label, power)| udunits_factor(label, power));
        let factors: Vec<String> = factors.collect();
        if factors.is_empty() {
            "1".to_owned()
        } else {
            factors.join(" ")
        }
    }
}

/// One factor of a unit in UDUNITS notation. `m` to the power 2 is `m2`; a label that is itself an
/// expression is put in brackets.
fn udunits_factor(label: &str, power: i32) -> Option<String> {
    let label = label.trim();
    let is_simple = label.chars().all(char::is_alphabetic);
    match power {
        0 => None,
        _ if label.is_empty() || label == "1" => None,
        1 => Some(label.to_owned()),
        _ if is_simple => Some(format!("{label}{power}")),
        _ => Some(format!("({label})^{power}")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn units(labels: [&str; 4]) -> Units {
        let [time, length, force, temperature] = labels.map(String::from);
        Units {
            time,
            length,
            force,
            temperature,
        }
    }

    const EVERY: [Dimension; 9] = [
        Dimension::ONE,
        Dimension::TIME,
        Dimension::LENGTH,
        Dimension::FORCE,
        Dimension::TEMPERATURE,
        Dimension::VELOCITY,
        Dimension::AREA,
        Dimension::DIFFUSIVITY,
        Dimension::WORK,
    ];

    #[test]
    fn units_label_are_fractions() {
        let si = units(["s", "m", "N", "K"]);
        assert_eq!(
            EVERY.map(|d| d.label(&si)),
            ["", "s", "m", "N", "K", "m/s", "m²", "m²/s", "N m"]
        );
        let no_length = units(["s", "", "N", "K"]);
        assert_eq!(
            EVERY.map(|d| d.label(&no_length)),
            ["", "s", "", "N", "K", "1/s", "", "1/s", "N"]
        );
        let no_time = units(["", "m", "", "K"]);
        assert_eq!(
            EVERY.map(|d| d.label(&no_time)),
            ["", "", "m", "", "K", "m", "m²", "m²", "m"]
        );
        assert!(EVERY.iter().all(|d| d.label(&Units::default()).is_empty()));
    }

    #[test]
    fn units_of_a_file_are_udunits_notation() {
        let si = units(["s", "m", "N", "K"]);
        assert_eq!(
            EVERY.map(|d| d.udunits(&si)),
            ["1", "s", "m", "N", "K", "m s-1", "m2", "m2 s-1", "N m"]
        );
        let mixed = units(["1/w0", "", "MN", " 1 "]);
        let expected = [
            "1",
            "1/w0",
            "1",
            "MN",
            "1",
            "(1/w0)^-1",
            "1",
            "(1/w0)^-1",
            "MN",
        ];
        assert_eq!(EVERY.map(|d| d.udunits(&mixed)), expected);
    }
}
