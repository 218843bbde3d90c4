//! The table of docs/bearing/calibration.md: how accurate estimates are, how often their intervals hold the
//! truth, and which warnings appear, in records of known bearings that loggers keep in many ways.

use crate::bridge::{BRIDGE, Bearing, DAY, ask, bias, covered, question, rmse};
use crate::loggers::{FREQUENT, Logger, PLAIN, kept_of};
use std::f64::consts::TAU;
use stickslip::noise::{Stream, Transition};
use stickslip_bearing::calibration::{
    Calibration, CalibrationMethod, CalibrationQuestion, Lag, MeasuredRecord, Quantity, Values,
    calibrate,
};
use stickslip_bearing::weather;

/// A way in which records are made.
struct Situation {
    name: &'static str,
    logger: Logger,
    bearing: Bearing,
    /// The factor of friction at a time, and its mean over a year or over the record.
    share: fn(f64) -> f64,
    mean_share: f64,
    /// What is wrong with the record beyond that.
    change: fn(MeasuredRecord, u64) -> MeasuredRecord,
}

const SOUND: Situation = Situation {
    name: "every 10 minutes",
    logger: PLAIN,
    bearing: BRIDGE,
    share: |_| 1.0,
    mean_share: 1.0,
    change: |record, _| record,
};

const HOURLY: Logger = Logger {
    every: [60; 2],
    ..PLAIN
};

/// A logger under the name of what is special about it.
const fn kept(name: &'static str, logger: Logger) -> Situation {
    Situation {
        name,
        logger,
        ..SOUND
    }
}

/// A record that something is wrong with.
const fn wrong(name: &'static str, change: fn(MeasuredRecord, u64) -> MeasuredRecord) -> Situation {
    Situation {
        name,
        change,
        ..SOUND
    }
}

/// The temperature of another place, which differs by `sd` kelvin for some hours.
fn elsewhere(record: MeasuredRecord, seed: u64, sd: f64, hours: f64) -> MeasuredRecord {
    let mut random = Stream::new(seed, 71);
    let memory = 3600.0 * hours;
    let passing = Transition::new(1.0 / memory, sd * (2.0 / memory).sqrt(), 600.0);
    let mut off = sd * random.normal();
    let mut shown = |t: &f64| {
        off = passing.next(off, random.normal());
        t + off
    };
    let temperatures = record.temperatures.iter().map(&mut shown).collect();
    MeasuredRecord {
        temperatures,
        ..record
    }
}

/// A thermometer that follows the air with this time constant, in minutes.
fn slow(record: MeasuredRecord, minutes: f64) -> MeasuredRecord {
    record
        .clone()
        .with_temperatures(&record.times, &record.lagged(60.0 * minutes).temperatures)
}

/// The sensor sees the mean of this bearing and one with less friction.
fn two_bearings(record: MeasuredRecord, seed: u64) -> MeasuredRecord {
    let weak = Bearing {
        f_s: 3.0e5,
        f_d: 2.4e5,
        ..BRIDGE
    };
    mean_with(record, &weak, seed)
}

/// The sensor sees the mean of this bearing and one of twice the stiffness.
fn stiff_and_soft(record: MeasuredRecord, seed: u64) -> MeasuredRecord {
    let stiff = Bearing {
        stiffness: 2.0 * BRIDGE.stiffness,
        ..BRIDGE
    };
    mean_with(record, &stiff, seed)
}

/// The mean of the readings of this record and of another bearing.
fn mean_with(record: MeasuredRecord, bearing: &Bearing, seed: u64) -> MeasuredRecord {
    let (other, _) = kept_of(&PLAIN, bearing, |_| 1.0, seed);
    let readings = record.readings.iter().zip(&other.readings);
    MeasuredRecord {
        readings: readings.map(|(a, b)| 0.5 * (a + b)).collect(),
        ..record
    }
}

/// A sensor that shows nothing above what 95 % of its readings are below.
fn saturated(record: MeasuredRecord, _: u64) -> MeasuredRecord {
    let mut sorted: Vec<f64> = record
        .readings
        .iter()
        .copied()
        .filter(|z| z.is_finite())
        .collect();
    sorted.sort_by(f64::total_cmp);
    let end = sorted[95 * sorted.len() / 100];
    let shown = |z: &f64| if *z > end { end } else { *z };
    MeasuredRecord {
        readings: record.readings.iter().map(shown).collect(),
        ..record
    }
}

/// The situations whose records are those of the model and of its loggers.
const KNOWN: [Situation; 31] = [
    SOUND,
    kept(
        "thermometer noise of 0.1 K",
        Logger {
            noise: 0.1,
            ..PLAIN
        },
    ),
    kept(
        "thermometer noise of 0.3 K",
        Logger {
            noise: 0.3,
            ..PLAIN
        },
    ),
    kept("30 um of white noise alone", Logger { red: 0.0, ..PLAIN }),
    kept(
        "thermometer every hour",
        Logger {
            every: [60, 10],
            ..PLAIN
        },
    ),
    kept(
        "thermometer every hour, no red noise",
        Logger {
            every: [60, 10],
            red: 0.0,
            ..PLAIN
        },
    ),
    kept(
        "thermometer a minute after the sensor",
        Logger { after: 1, ..PLAIN },
    ),
    kept(
        "thermometer a minute before the sensor",
        Logger { after: 9, ..PLAIN },
    ),
    kept("every hour", HOURLY),
    kept(
        "every hour, fast weather of 2 h",
        Logger {
            memory: 2.0,
            ..HOURLY
        },
    ),
    kept(
        "means of 10 minutes",
        Logger {
            means: [true; 2],
            ..PLAIN
        },
    ),
    kept(
        "means of the temperature alone",
        Logger {
            means: [true, false],
            ..PLAIN
        },
    ),
    kept(
        "means of the displacement alone",
        Logger {
            means: [false, true],
            ..PLAIN
        },
    ),
    kept(
        "means of an hour",
        Logger {
            means: [true; 2],
            ..HOURLY
        },
    ),
    kept("steel 30 minutes behind", Logger { lag: 30.0, ..PLAIN }),
    Situation {
        bearing: FREQUENT,
        ..kept(
            "steel 6 hours behind, f_s of 230 kN",
            Logger {
                lag: 360.0,
                red: 0.0,
                ..PLAIN
            },
        )
    },
    kept(
        "thermometer on steel 2 hours behind",
        Logger {
            lag: 120.0,
            is_on_steel: true,
            ..PLAIN
        },
    ),
    kept("clocks 5 minutes apart", Logger { behind: 5, ..PLAIN }),
    kept(
        "clocks 30 minutes apart",
        Logger {
            behind: 30,
            ..PLAIN
        },
    ),
    Situation {
        bearing: FREQUENT,
        ..kept("f_s of 230 kN, many slips", Logger { red: 0.0, ..PLAIN })
    },
    wrong("displacement in steps of 0.05 mm", |record, _| {
        MeasuredRecord {
            readings: record
                .readings
                .iter()
                .map(|z| (z / 5e-5).round() * 5e-5)
                .collect(),
            ..record
        }
    }),
    kept(
        "displacement every hour",
        Logger {
            every: [10, 60],
            ..PLAIN
        },
    ),
    kept(
        "displacement every 15 minutes",
        Logger {
            every: [10, 15],
            ..PLAIN
        },
    ),
    kept(
        "displacement every 30 minutes, thermometer every 20",
        Logger {
            every: [20, 30],
            ..PLAIN
        },
    ),
    kept(
        "displacement every hour, thermometer a minute later",
        Logger {
            every: [10, 60],
            after: 1,
            red: 0.0,
            ..PLAIN
        },
    ),
    kept("20 % of samples lost", Logger { lost: 0.2, ..PLAIN }),
    kept("30 % of samples lost", Logger { lost: 0.3, ..PLAIN }),
    kept(
        "thermometer repeats values for 30 minutes",
        Logger {
            repeats: 30,
            ..PLAIN
        },
    ),
    kept(
        "thermometer repeats values for an hour",
        Logger {
            repeats: 60,
            ..PLAIN
        },
    ),
    kept(
        "thermometer on steel 2 hours behind, every hour",
        Logger {
            every: [60, 10],
            lag: 120.0,
            is_on_steel: true,
            ..PLAIN
        },
    ),
    kept(
        "steel 2 hours behind",
        Logger {
            lag: 120.0,
            ..PLAIN
        },
    ),
];

/// The situations that the model does not describe, of which a warning is wanted.
const UNKNOWN: [Situation; 10] = [
    Situation {
        name: "f_s varies by 10 % over the year",
        share: |time| 1.0 + 0.1 * (TAU * time / (365.25 * DAY)).sin(),
        ..SOUND
    },
    Situation {
        name: "f_s falls by 30 %",
        share: |time| 1.0 - 0.3 * time / (300.0 * DAY),
        mean_share: 0.85,
        ..SOUND
    },
    Situation {
        name: "f_s varies by 20 % over the year",
        share: |time| 1.0 + 0.2 * (TAU * time / (365.25 * DAY)).cos(),
        ..SOUND
    },
    wrong("temperature off by 1 K for 3 h", |record, seed| {
        elsewhere(record, seed, 1.0, 3.0)
    }),
    wrong("temperature off by 2 K for 12 h", |record, seed| {
        elsewhere(record, seed, 2.0, 12.0)
    }),
    wrong(
        "thermometer 15 minutes slower than the steel",
        |record, _| slow(record, 15.0),
    ),
    wrong("thermometer an hour slower than the steel", |record, _| {
        slow(record, 60.0)
    }),
    wrong("mean of two bearings", two_bearings),
    wrong("mean of two bearings, one twice as stiff", stiff_and_soft),
    wrong("sensor at the end of its range", saturated),
];

/// The quantities whose intervals are compared with the truth.
const COVERED: [Quantity; 4] = [
    Quantity::Static,
    Quantity::Reach,
    Quantity::Stiffness,
    Quantity::Dilatation,
];

/// What the records of a situation came to.
#[derive(Default)]
struct Row {
    fits: Vec<(Calibration, Values)>,
    refused: usize,
}

impl Situation {
    /// Calibrate the record of this number, with a seed that no other record of the table has, so that
    /// all intervals are independent.
    fn add(&self, row: &mut Row, place: usize, number: u64) {
        let seed = 1000 * (1 + place as u64) + number;
        let (record, mut truth) = kept_of(&self.logger, &self.bearing, self.share, seed);
        for quantity in [Quantity::Static, Quantity::Reach] {
            truth[quantity as usize] *= self.mean_share;
        }
        let record = (self.change)(record, seed);
        let asked = question(CalibrationMethod::Slips);
        match calibrate(&record, &asked, 2, &Default::default()) {
            Ok(fit) => row.fits.push((fit, truth)),
            Err(_) => row.refused += 1,
        }
    }

    /// The row of the table.
    fn shown(&self, row: &Row) -> String {
        let n = row.fits.len();
        let errors = |quantity| {
            let [off, rms] = [bias(&row.fits, quantity), rmse(&row.fits, quantity)];
            let error = ((rms * rms - off * off) / n as f64).sqrt();
            format!("{:+.2}±{:.2}", 100.0 * off, 100.0 * error)
        };
        let warnings = row.fits.iter().flat_map(|(fit, _)| &fit.warnings);
        let mut names: Vec<&str> = warnings.map(|warning| warning.name()).collect();
        names.sort_unstable();
        let same = names.chunk_by(|a, b| a == b);
        let mut named: Vec<String> = same
            .map(|same| format!("{} {}", same.len(), same[0]))
            .collect();
        if row.refused > 0 {
            named.push(format!("{} refused", row.refused));
        }
        let covered = COVERED.map(|quantity| covered(&row.fits, quantity).to_string());
        format!(
            "| {} | {} | {} | {} | {} |\n",
            self.name,
            errors(Quantity::Static),
            errors(Quantity::Reach),
            covered.join("/"),
            named.join(", ")
        )
        .replace("|  |", "| |")
    }
}

/// Prints the table, and writes it to the file `TABLE` after every round of one record of each
/// situation. `SEEDS` is the number of records of each situation, 20 by default, and `ONLY` a part of the
/// names of the situations.
#[test]
#[ignore = "ten minutes; prints a table"]
fn table() {
    let seeds: u64 = std::env::var("SEEDS").map_or(20, |seeds| seeds.parse().expect("a number"));
    let only = std::env::var("ONLY").unwrap_or_default();
    let all: Vec<&Situation> = KNOWN.iter().chain(&UNKNOWN).collect();
    let mut rows: Vec<Row> = all.iter().map(|_| Row::default()).collect();
    let mut text = String::new();
    for number in 0..seeds {
        for (place, (situation, row)) in all.iter().zip(&mut rows).enumerate() {
            if situation.name.contains(&only) {
                situation.add(row, place, number);
            }
        }
        text = "| record | error of f_s, % | error of A, % | covered: f_s/A/K/beta | warnings |\n|---|---|---|---|---|\n".to_string();
        for (place, (situation, row)) in all.iter().zip(&rows).enumerate() {
            if place == KNOWN.len() {
                text += "| **not in the model** | | | | |\n";
            }
            if !row.fits.is_empty() {
                text += &situation.shown(row);
            }
        }
        text += &pooled(&rows[..KNOWN.len()]);
        if let Ok(file) = std::env::var("TABLE") {
            std::fs::write(file, &text).expect("a file that can be written");
        }
    }
    println!("{text}");
}

/// How many intervals of the sound records contain the truth.
fn pooled(rows: &[Row]) -> String {
    let n: usize = rows.iter().map(|row| row.fits.len()).sum();
    let all = |quantity: Quantity| {
        let covered: usize = rows.iter().map(|row| covered(&row.fits, quantity)).sum();
        format!("{} {covered}", quantity.symbol())
    };
    format!("of {n} sound records: {}\n", COVERED.map(all).join(", "))
}

/// The false alarms of what the table does not show: in how many sound records another lag than the
/// true one is said to fit better, and the temperature is said to be smooth or of a varying memory.
#[test]
#[ignore = "twenty minutes; prints counts"]
fn false_alarms() {
    let names = ["other_lag", "smooth_temperature", "memory_varies"];
    let mut counts = [0; 3];
    let sound = [0, 3, 8, 19];
    let all = (0..5).flat_map(|number| sound.map(|place| (number, place)));
    for (number, place) in all {
        let situation = &KNOWN[place];
        let seed = 1000 * (1 + place as u64) + 500 + number;
        let (record, _) = kept_of(&situation.logger, &situation.bearing, |_| 1.0, seed);
        let asked = CalibrationQuestion {
            lag: Lag::Known(0.0),
            ..question(CalibrationMethod::Slips)
        };
        let fit = ask(&record, &asked);
        let [times, temperatures] = record.thermometer();
        let weather = weather::fit(&times, &temperatures, &weather::PERIODS, 2, 0.0);
        let of_weather = weather.expect("weather").named_warnings();
        let of_weather = of_weather.iter().map(|(name, _)| &name[..]);
        let all = fit.warnings.iter().map(|warning| warning.name());
        let all: Vec<&str> = all.chain(of_weather).collect();
        for (count, name) in counts.iter_mut().zip(names) {
            *count += usize::from(all.contains(&name));
        }
        println!("{} {seed}: {all:?}", situation.name);
    }
    println!("{names:?}: {counts:?} of 20");
}
