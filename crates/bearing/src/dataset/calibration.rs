//! A calibration as a data set: the measured record, the estimates, and the model.

use crate::calibration::{
    Calibration, CalibrationMethod, CalibrationQuestion, Lag, LagProfile, Motion,
    ParameterEstimate, Quantity, SearchStart, SeenSlip, Values, response_of,
};
use stickslip::dataset::layout::{Unit, Variable, coordinate, table, variable};
use stickslip::dataset::{
    Dataset, Format, Source, Walk, Walked, columns_of, counted, read_other_program, texts,
    walk_origin,
};
use stickslip::engine::Program;
use stickslip::stats::Units;
use stickslip_data::Start;

/// Name and version of the format.
pub const CALIBRATION_FORMAT: Format = ("stick-slip calibration", (2, 0));

/// A calibration read from a data set.
#[derive(Clone, Debug, PartialEq)]
pub struct StoredCalibration {
    /// The title of the calibration, one line.
    pub title: String,
    /// The scenario, as written.
    pub scenario_text: String,
    /// The result. If it was read from a data set, its list of warnings is empty; they are in
    /// `warnings`.
    pub calibration: Calibration,
    /// Name and sentence of each warning.
    pub warnings: Vec<(String, String)>,
    /// The program that wrote the calibration, if it was a different one.
    pub other_program: Option<String>,
}

impl StoredCalibration {
    /// A calibration to be stored. `title` is one line, and `scenario_text` is the scenario as
    /// written.
    pub fn of(title: &str, scenario_text: &str, calibration: Calibration) -> Self {
        let warnings = calibration.warnings.iter();
        let warnings = warnings
            .map(|warning| (warning.name().to_string(), warning.to_string()))
            .collect();
        let (title, scenario_text) = (title.to_string(), scenario_text.to_string());
        StoredCalibration {
            title,
            scenario_text,
            calibration,
            warnings,
            other_program: None,
        }
    }

    /// The calibration in a data set. Fails if the data set is not that of a calibration.
    pub fn read(from: &dyn Source) -> Result<StoredCalibration, String> {
        let other_program = read_other_program(from)?;
        let mut stored = StoredCalibration {
            other_program,
            ..StoredCalibration::of("", "", Calibration::default())
        };
        walk(&mut Walk::Reading(from), &mut stored)?;
        Ok(stored)
    }

    /// Its data set.
    pub fn dataset(&self) -> Dataset {
        Dataset::written(&units(), |to| walk(to, &mut self.clone()))
    }
}

/// Labels of the units of a calibration.
pub(crate) fn units() -> Units {
    let [time, length, force, temperature] = ["s", "m", "N", "K"].map(String::from);
    Units {
        time,
        length,
        force,
        temperature,
    }
}

/// Write name, symbol and unit of each quantity.
pub(super) fn write_quantities(to: &mut Dataset) {
    to.write(&QUANTITY, &texts(Quantity::ALL.map(Quantity::key)));
    to.write(
        &QUANTITY_SYMBOL,
        &texts(Quantity::ALL.map(Quantity::symbol)),
    );
    to.write(&QUANTITY_UNIT, &texts(Quantity::ALL.map(Quantity::unit)));
}

/// Walk over a calibration. Derived data are computed again.
fn walk(walk: &mut Walk, stored: &mut StoredCalibration) -> Walked {
    attributes(walk, stored)?;
    let calibration = &mut stored.calibration;
    asked(walk, &mut calibration.question)?;
    found(walk, calibration)?;
    calibration.response = response_of(&calibration.estimates.map(|estimate| estimate.estimate));
    calibration.question.starts = calibration.starts.len() as u32;
    measured(walk, calibration)
}

fn attributes(walk: &mut Walk, stored: &mut StoredCalibration) -> Walked {
    let StoredCalibration {
        title,
        scenario_text,
        calibration,
        warnings,
        ..
    } = stored;
    let Calibration { question, lag, .. } = calibration;
    walk_origin(walk, CALIBRATION_FORMAT, title, &mut Program::mine())?;
    walk.attribute("scenario", scenario_text)?;
    let mut method = question.method.name().to_owned();
    let mut choice = if question.lag == Lag::Auto {
        "auto"
    } else {
        "given"
    }
    .to_owned();
    let mut start = calibration.record.start.map(|start| start.to_string());
    walk.attribute("record_start", &mut start)?;
    calibration.record.start = start.as_deref().and_then(Start::parse);
    walk.attribute("method", &mut method)?;
    question.method =
        CalibrationMethod::from_name(&method).ok_or_else(|| "unknown method".to_string())?;
    walk.attribute("lag_choice", &mut choice)?;
    walk.attribute("shear_stiffness", &mut question.shear_stiffness)?;
    walk.attribute("interval", &mut question.level)?;
    walk.attribute("lag", &mut lag.estimate)?;
    walk.attribute("lag_low", &mut lag.low)?;
    walk.attribute("lag_high", &mut lag.high)?;
    question.lag = if choice == "auto" {
        Lag::Auto
    } else {
        Lag::Known(lag.estimate)
    };
    walk.attribute("residual_rms", &mut calibration.residuals.rms)?;
    walk.attribute("temperature_resolution", &mut calibration.resolution)?;
    walk.attribute("temperature_roughness", &mut calibration.roughness)?;
    walk.attribute("sensor_drift", &mut calibration.zero.drift)?;
    friction_range(walk, &mut calibration.friction_range)?;
    if let Some(profile) = walk.present(&LAG, &mut calibration.lag_profile) {
        walk.attribute("lag_likeliest", &mut profile.likeliest)?;
        walk.attribute("lag_gain", &mut profile.gain)?;
        walk.attribute("clock_shift", &mut profile.clock)?;
    }
    for (name, window) in ["temperature_averaged", "displacement_averaged"]
        .iter()
        .zip(&mut calibration.record.averaged)
    {
        let mut seconds = Some(*window).filter(|seconds| *seconds > 0.0);
        walk.attribute(name, &mut seconds)?;
        *window = seconds.unwrap_or(0.0);
    }
    let mut mirrored: u64 = calibration.is_mirrored.into();
    walk.attribute("mirrored", &mut mirrored)?;
    calibration.is_mirrored = mirrored != 0;
    walk.attribute("temperature_repeats", &mut calibration.repeats)?;
    let mut named: Vec<String> = warnings
        .iter()
        .map(|(name, sentence)| format!("{name}: {sentence}"))
        .collect();
    sentences(walk, "warnings", &mut named)?;
    let split = |line: &String| {
        line.split_once(": ")
            .map(|(name, text)| (name.to_string(), text.to_string()))
    };
    *warnings = named.iter().filter_map(split).collect();
    sentences(walk, "repairs", &mut calibration.record.repairs)
}

/// Walk over sentences, one in each line of an attribute; without any, it is absent.
fn sentences(walk: &mut Walk, name: &str, sentences: &mut Vec<String>) -> Walked {
    let mut lines = Some(sentences.join("\n")).filter(|lines| !lines.is_empty());
    walk.attribute(name, &mut lines)?;
    *sentences = lines
        .unwrap_or_default()
        .lines()
        .map(String::from)
        .collect();
    Ok(())
}

/// The smallest and the largest A over the record relative to its mean, each with its interval.
const FRICTION: [[&str; 3]; 2] = [
    ["friction_low", "friction_low_from", "friction_low_to"],
    ["friction_high", "friction_high_from", "friction_high_to"],
];

fn friction_range(walk: &mut Walk, range: &mut Option<[ParameterEstimate; 2]>) -> Walked {
    let mut ends = range.unwrap_or([ParameterEstimate::default(); 2]);
    for ([at, from, to], end) in FRICTION.into_iter().zip(&mut ends) {
        for (name, value) in [
            (at, &mut end.estimate),
            (from, &mut end.low),
            (to, &mut end.high),
        ] {
            let mut stored = range.is_some().then_some(*value);
            walk.attribute(name, &mut stored)?;
            *value = stored.unwrap_or(f64::NAN);
        }
    }
    *range = Some(ends).filter(|[low, _]| low.estimate.is_finite());
    Ok(())
}

/// The question, except what follows from the answer.
fn asked(walk: &mut Walk, question: &mut CalibrationQuestion) -> Walked {
    let Motion { reach, jump, start } = &mut question.guess;
    walk.attribute("guess_reach", reach)?;
    walk.attribute("guess_jump", jump)?;
    walk.attribute("guess_start", start)?;
    let held = |quantity| {
        question
            .held
            .iter()
            .find(|held| held.0 == quantity)
            .map_or(f64::NAN, |held| held.1)
    };
    let bound = |quantity| {
        question
            .bounds
            .iter()
            .find(|bound| bound.0 == quantity)
            .map_or([f64::NAN; 2], |bound| bound.1)
    };
    let mut held = Quantity::ALL.map(held).to_vec();
    let [mut low, mut high] = columns_of(Quantity::ALL.map(bound));
    if let Walk::Writing(to) = walk {
        write_quantities(to);
    }
    for (variable, values) in [
        (&HELD, &mut held),
        (&BOUND_LOW, &mut low),
        (&BOUND_HIGH, &mut high),
    ] {
        walk.sized(variable, values, Quantity::ALL.len())?;
    }
    let known = |quantity: Quantity, value: f64| (!value.is_nan()).then_some((quantity, value));
    let fitted = Quantity::FITTED.into_iter();
    question.held = fitted
        .filter_map(|quantity| known(quantity, held[quantity as usize]))
        .collect();
    let bound = |quantity| {
        known(quantity, low[quantity as usize]).map(|(of, low)| (of, [low, high[of as usize]]))
    };
    question.bounds = Quantity::ALL.into_iter().filter_map(bound).collect();
    Ok(())
}

/// One estimate for each of [`Quantity::ALL`].
type ParameterEstimates = [ParameterEstimate; Quantity::ALL.len()];

fn estimates(
    walk: &mut Walk,
    variables: [&Variable; 3],
    estimates: &mut ParameterEstimates,
) -> Walked {
    let mut columns = columns_of(estimates.map(
        |ParameterEstimate {
             estimate,
             low,
             high,
         }| [estimate, low, high],
    ));
    for (variable, values) in variables.into_iter().zip(&mut columns) {
        walk.sized(variable, values, Quantity::ALL.len())?;
    }
    let [estimate, low, high] = columns;
    *estimates = std::array::from_fn(|i| ParameterEstimate {
        estimate: estimate[i],
        low: low[i],
        high: high[i],
    });
    Ok(())
}

/// The estimates, and intermediate results.
fn found(walk: &mut Walk, calibration: &mut Calibration) -> Walked {
    let all = Quantity::ALL.len();
    let rows = |values: &[f64]| -> Vec<Values> {
        values
            .chunks_exact(all)
            .map(|row| std::array::from_fn(|i| row[i]))
            .collect()
    };
    estimates(walk, [&ESTIMATE, &LOW, &HIGH], &mut calibration.estimates)?;
    if let Some(others) = walk.present(&ERR_ESTIMATE, &mut calibration.least_squares) {
        estimates(walk, [&ERR_ESTIMATE, &ERR_LOW, &ERR_HIGH], others)?;
    }
    let mut correlations = calibration.correlations.concat();
    if !correlations.is_empty() {
        walk.derived(&OTHER, &texts(Quantity::ALL.map(Quantity::key)));
    }
    walk.variable(&CORRELATION, &mut correlations)?;
    calibration.correlations = rows(&correlations);

    let slips = &mut calibration.slips;
    let [mut times, mut temperatures, mut jumps] = columns_of(
        slips
            .iter()
            .map(|slip| [slip.time, slip.temperature, slip.jump]),
    );
    let mut usual: Vec<i8> = slips.iter().map(|slip| slip.is_usual.into()).collect();
    walk.derived(&SLIP, &counted(0, slips.len()));
    walk.variable(&SLIP_TIME, &mut times)?;
    walk.sized(&SLIP_TEMPERATURE, &mut temperatures, times.len())?;
    walk.sized(&SLIP_JUMP, &mut jumps, times.len())?;
    walk.variable(&SLIP_USUAL, &mut usual)?;
    let slip = |(i, time)| {
        let is_usual = usual.get(i) == Some(&1);
        SeenSlip {
            time,
            temperature: temperatures[i],
            jump: jumps[i],
            is_usual,
        }
    };
    *slips = times.into_iter().enumerate().map(slip).collect();

    let mut errs: Vec<f64> = calibration.starts.iter().map(|start| start.err).collect();
    let mut values = calibration.start_values().concat();
    walk.derived(&START, &counted(0, errs.len()));
    walk.variable(&START_ERR, &mut errs)?;
    walk.sized(&START_VALUE, &mut values, errs.len() * all)?;
    let starts = errs.into_iter().zip(rows(&values));
    calibration.starts = starts
        .map(|(err, values)| SearchStart {
            err,
            response: response_of(&values),
        })
        .collect();
    pairs(walk, [&ZERO_TIME, &ZERO_STEP], &mut calibration.zero.steps)?;
    if let Some(LagProfile { profile, .. }) = &mut calibration.lag_profile {
        pairs(walk, [&LAG, &LAG_DEVIANCE], profile)?;
    }
    pairs(
        walk,
        [&DELAY, &AUTOCORRELATION],
        &mut calibration.residuals.autocorrelation,
    )
}

/// Walk over points: their places, and the values there.
fn pairs(walk: &mut Walk, [at, of]: [&Variable; 2], pairs: &mut Vec<(f64, f64)>) -> Walked {
    let (mut places, mut values): (Vec<f64>, Vec<f64>) = pairs.iter().copied().unzip();
    walk.variable(at, &mut places)?;
    walk.sized(of, &mut values, places.len())?;
    *pairs = places.into_iter().zip(values).collect();
    Ok(())
}

/// The measurement and the model.
fn measured(walk: &mut Walk, calibration: &mut Calibration) -> Walked {
    let Calibration {
        record,
        steel,
        modelled,
        ..
    } = calibration;
    walk.variable(&TIME, &mut record.times)?;
    let n = record.times.len();
    walk.sized(&TEMPERATURE, &mut record.temperatures, n)?;
    calibration.zero.start = record.times.first().copied().unwrap_or(0.0);
    walk.sized(&STEEL, steel, n)?;
    let mut flags = vec![0_i8; n];
    record.interpolated.iter().for_each(|i| flags[*i] = 1);
    walk.sized(&INTERPOLATED, &mut flags, n)?;
    record.interpolated = (0..n).filter(|i| flags[*i] == 1).collect();
    walk.sized(&READING, &mut record.readings, n)?;
    walk.sized(&MODELLED, modelled, n)
}

/// A number of each quantity.
pub(super) const fn of_quantity(name: &'static str, meaning: &'static str) -> Variable {
    variable(name, &["quantity"], Unit::None, meaning)
        .with(&[("coordinates", "quantity_symbol quantity_unit")])
}

table! {
    QUANTITY = coordinate!("quantity", Unit::None, "key of the quantity");
    QUANTITY_SYMBOL = variable("quantity_symbol", &["quantity"], Unit::None, "symbol of the quantity");
    QUANTITY_UNIT = variable("quantity_unit", &["quantity"], Unit::None, "unit of the quantity");
    ESTIMATE = of_quantity("estimate", "estimate");
    LOW = of_quantity("interval_low", "lower end of the interval");
    HIGH = of_quantity("interval_high", "upper end of the interval");
    ERR_ESTIMATE = of_quantity("least_squares", "least-squares estimate, from the best start");
    ERR_LOW = of_quantity("least_squares_low", "lower end of the least-squares interval");
    ERR_HIGH = of_quantity("least_squares_high", "upper end of the least-squares interval");
    HELD = of_quantity("held", "value at which the quantity was fixed, missing if fitted");
    BOUND_LOW = of_quantity("bound_low", "lower bound of the search, missing if there was none");
    BOUND_HIGH = of_quantity("bound_high", "upper bound of the search, missing if there was none");
    OTHER = coordinate!("other", Unit::None, "key of the other quantity");
    CORRELATION = variable("correlation", &["quantity", "other"], Unit::ONE,
        "correlation of the errors of two quantities");
    SLIP = coordinate!("slip", Unit::ONE, "number of the slip");
    SLIP_TIME = variable("slip_time", &["slip"], Unit::Seconds, "time of the slip, midway between two samples");
    SLIP_TEMPERATURE = variable("slip_temperature", &["slip"], Unit::TEMPERATURE, "temperature of the steel \
        at the slip");
    SLIP_JUMP = variable("slip_jump", &["slip"], Unit::LENGTH, "jump of the displacement minus kappa beta T");
    SLIP_USUAL = variable("slip_usual", &["slip"], Unit::None, "whether the slip is isolated and of typical size")
        .flags(&[0, 1], &[("flag_meanings", "left_out fitted")]);
    START = coordinate!("start", Unit::ONE, "number of the least-squares start");
    START_ERR = variable("start_err", &["start"], Unit::AREA,
        "mean square of model minus measurement");
    START_VALUE = variable("start_value", &["start", "quantity"], Unit::None, "result of the start");
    LAG = coordinate!("lag", Unit::Seconds, "lag of the steel behind the thermometer");
    LAG_DEVIANCE = variable("lag_deviance", &["lag"], Unit::ONE,
        "twice the log of the ratio of the largest likelihood to that of this lag");
    ZERO_TIME = coordinate!("zero_time", Unit::Seconds, "time at which the zero of the sensor was set");
    ZERO_STEP = variable("zero_step", &["zero_time"], Unit::LENGTH, "shift of the readings when the zero was set");
    DELAY = coordinate!("delay", Unit::None, "delay in hours").with(&[("units", "h")]);
    AUTOCORRELATION = variable("residual_autocorrelation", &["delay"], Unit::ONE,
        "autocorrelation of the residuals at this delay");
    TIME = coordinate!("time", Unit::Seconds, "time since the first sample");
    TEMPERATURE = variable("temperature", &["time"], Unit::TEMPERATURE, "measured temperature");
    STEEL = variable("steel_temperature", &["time"], Unit::TEMPERATURE, "temperature of the steel, lagging \
        the measured one");
    INTERPOLATED = variable("temperature_interpolated", &["time"], Unit::None,
        "whether the temperature is interpolated between readings")
        .flags(&[0, 1], &[("flag_meanings", "measured interpolated")]);
    READING = variable("displacement", &["time"], Unit::LENGTH, "measured displacement");
    MODELLED = variable("displacement_modelled", &["time"], Unit::LENGTH, "modelled displacement");
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::calibration::MeasuredRecord;

    #[test]
    fn the_documentation_names_every_variable() {
        let text = include_str!("../../../../docs/output-format.md");
        for variable in ALL {
            // The page leaves the ends of an interval out.
            let of = variable
                .name
                .strip_suffix("_low")
                .or_else(|| variable.name.strip_suffix("_high"));
            let is_there = |name: &str| text.contains(&format!("`{name}`"));
            assert!(
                is_there(variable.name) || of.is_some_and(is_there),
                "{}",
                variable.name
            );
        }
    }

    /// Each variable holds what its name says, for a reader that knows only the names, and the
    /// question comes back.
    #[test]
    fn variables_hold_what_their_names_say() {
        let mut calibration = Calibration {
            record: MeasuredRecord {
                times: vec![0.0],
                temperatures: vec![1.0],
                readings: vec![2.0],
                ..MeasuredRecord::default()
            },
            steel: vec![1.0],
            modelled: vec![2.0],
            ..Calibration::default()
        };
        calibration.estimates = std::array::from_fn(|i| ParameterEstimate {
            estimate: 10.0 + i as f64,
            low: 9.0 + i as f64,
            high: 12.0 + i as f64,
        });
        calibration.question.held = vec![(Quantity::Stiffness, 7.0)];
        calibration.question.bounds = vec![(Quantity::Static, [2.0, 3.0])];
        calibration.slips = vec![SeenSlip {
            time: 1.0,
            temperature: 2.0,
            jump: 3.0,
            is_usual: true,
        }];
        let dataset = StoredCalibration::of("a title", "", calibration.clone()).dataset();
        let of = |name: &str, i: usize| {
            let entry = dataset.entry(name).unwrap_or_else(|| panic!("{name}"));
            <&[f64]>::try_from(&entry.column).expect("reals")[i]
        };
        let [stiffness, f_s] = [Quantity::Stiffness, Quantity::Static].map(|of| of as usize);
        for (name, i, wanted) in [
            ("estimate", f_s, 10.0 + f_s as f64),
            ("interval_low", f_s, 9.0 + f_s as f64),
            ("interval_high", f_s, 12.0 + f_s as f64),
            ("held", stiffness, 7.0),
            ("bound_low", f_s, 2.0),
            ("bound_high", f_s, 3.0),
            ("slip_time", 0, 1.0),
            ("slip_temperature", 0, 2.0),
            ("slip_jump", 0, 3.0),
        ] {
            assert_eq!(of(name, i), wanted, "{name}");
        }
        let read = StoredCalibration::read(&dataset)
            .expect("whole")
            .calibration;
        assert_eq!(read.estimates, calibration.estimates);
        assert_eq!(read.question.held, calibration.question.held);
        assert_eq!(read.question.bounds, calibration.question.bounds);
    }
}
