//! Synthetic measurements of the bridge of the paper: its calibrated mean parameters, under weather
//! made for the tests.

use std::f64::consts::TAU;
use std::sync::LazyLock;
use stickslip::noise::{Stream, Transition};
use stickslip_bearing::calibration::{
    Air, Calibration, CalibrationMethod, CalibrationQuestion, Imperfections, Lag, MeasuredRecord,
    Motion, Quantity, Response, Sensor, Twin, Values, calibrate, twin, values,
};
use stickslip_data::{ColumnQuantity, Layout, arrays};

/// Seconds of a day.
pub const DAY: f64 = 86_400.0;

/// The parameters of a bearing, in the units of a scenario.
#[derive(Clone, Copy, Debug)]
pub struct Bearing {
    /// K.
    pub stiffness: f64,
    /// beta.
    pub dilatation: f64,
    /// Static and dynamic friction.
    pub f_s: f64,
    pub f_d: f64,
    /// z0.
    pub offset: f64,
    /// x(0).
    pub displacement: f64,
    /// K_BP.
    pub shear_stiffness: f64,
}

impl Bearing {
    /// The motion, and how the sensor sees it.
    pub fn response(&self) -> Response {
        let slope = self.stiffness * self.dilatation;
        let kappa = self.stiffness / self.shear_stiffness;
        let jump = 2.0 * (self.f_s - self.f_d) / slope;
        let motion = Motion {
            reach: self.f_s / slope,
            jump,
            start: self.displacement / self.dilatation,
        };
        let (moving, still) = ((1.0 - kappa) * self.dilatation, kappa * self.dilatation);
        Response {
            motion,
            sensor: Sensor {
                offset: self.offset,
                moving,
                still,
            },
        }
    }
}

/// The mean parameters of the paper, and a shear stiffness for which its z0 is plausible.
pub const BRIDGE: Bearing = Bearing {
    stiffness: 1.89e8,
    dilatation: 3.06e-4,
    f_s: 4.69e5,
    f_d: 4.22e5,
    offset: -9.67e-3,
    displacement: 3.82e-3,
    shear_stiffness: 2.0e9,
};

/// 30 um of white noise, and 150 um of red noise with a correlation time of a day.
pub const RED: Imperfections = Imperfections {
    white: 30e-6,
    red: 150e-6,
    memory: DAY,
    ..Imperfections::NONE
};

/// How a synthetic measurement is sampled.
#[derive(Clone, Copy, Debug)]
pub struct Campaign {
    /// Its length in days.
    pub days: f64,
    /// Seconds between samples.
    pub interval: f64,
    /// The errors of the measurement.
    pub imperfections: Imperfections,
    /// How the temperature moves between samples.
    pub between: Between,
}

/// How a temperature moves between samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Between {
    /// As the weather does: as rough as from one sample to the next.
    Weather,
    /// In straight lines.
    Lines,
}

/// 300 days with a sample every ten minutes, with red noise, under a temperature that moves between
/// samples as the weather does.
pub const RED_CAMPAIGN: Campaign = Campaign {
    days: 300.0,
    interval: 600.0,
    imperfections: RED,
    between: Between::Weather,
};

/// The standard deviation and the memory in days of the two processes of the weather.
pub const WEATHER: [[f64; 2]; 2] = [[1.8, 1.0 / 3.0], [2.5, 3.0]];

/// The temperature: a yearly and a daily cycle, and two processes of weather. Times are in seconds,
/// temperatures in degrees.
pub fn weather(seed: u64, campaign: &Campaign, processes: [[f64; 2]; 2]) -> Air {
    let mut random = Stream::new(seed, 9);
    let process = |sd: f64, memory: f64| {
        Transition::new(1.0 / memory, sd * (2.0 / memory).sqrt(), campaign.interval)
    };
    let [fast, slow] = processes.map(|[sd, days]| process(sd, days * DAY));
    let [mut a, mut b] = processes.map(|[sd, _]| sd * random.normal());
    let count = (campaign.days * DAY / campaign.interval) as usize;
    let times: Vec<f64> = (0..count).map(|i| i as f64 * campaign.interval).collect();
    let temperature = |t: &f64| {
        (a, b) = (fast.next(a, random.normal()), slow.next(b, random.normal()));
        let day = t / DAY;
        12.4 + 9.0 * (TAU * day / 365.25).cos() + 4.1 * (TAU * day + 2.36).cos() + a + b
    };
    let temperatures = times.iter().map(temperature).collect();
    let roughness = match campaign.between {
        Between::Weather => processes
            .map(|[sd, days]| 2.0 * sd * sd / (days * DAY))
            .iter()
            .sum(),
        Between::Lines => 0.0,
    };
    Air {
        roughness,
        ..Air::straight(times, temperatures)
    }
}

/// Synthetic measurements of a bearing that starts at rest at a random place, and the true
/// parameters.
pub fn twin_of(bearing: &Bearing, campaign: &Campaign, seed: u64) -> (Twin, Values) {
    twin_under(bearing, campaign, WEATHER, seed)
}

/// The same under weather of other processes.
pub fn twin_under(
    bearing: &Bearing,
    campaign: &Campaign,
    processes: [[f64; 2]; 2],
    seed: u64,
) -> (Twin, Values) {
    let air = weather(seed, campaign, processes);
    let mut response = bearing.response();
    let place = 2.0 * Stream::new(seed, 77).uniform() - 1.0;
    response.motion.start = air.temperatures[0] + 0.9 * response.motion.reach * place;
    let twin = twin(&response, &air, &campaign.imperfections, seed);
    (twin, values(&response, Some(bearing.shear_stiffness)))
}

/// The part of them that a user has.
pub fn record(twin: &Twin) -> MeasuredRecord {
    MeasuredRecord {
        times: twin.times.clone(),
        temperatures: twin.temperatures.clone(),
        readings: twin.readings.clone(),
        ..MeasuredRecord::default()
    }
}

/// The same, read with `--outliers 8`.
pub fn without_outliers(twin: &Twin) -> MeasuredRecord {
    let Twin {
        times,
        temperatures,
        readings,
        ..
    } = twin;
    let layout = Layout {
        outliers: Some(8),
        ..Layout::default()
    };
    let both = [
        (ColumnQuantity::Temperature, temperatures),
        (ColumnQuantity::Displacement, readings),
    ];
    let both = both.map(|(quantity, values)| (quantity, &times[..], &values[..]));
    let (columns, _) = arrays(&both, &layout).expect("sound samples");
    let [air, sensor] = [0, 1].map(|i| [&columns[i].times[..], &columns[i].values[..]]);
    MeasuredRecord::of(air, sensor)
}

/// The question that `mc calibrate` asks without options, for a bearing with a shear stiffness of
/// 2.0e9 N/m.
pub fn question(method: CalibrationMethod) -> CalibrationQuestion {
    let guess = Motion {
        reach: 9.0,
        jump: 1.2,
        start: 15.0,
    };
    CalibrationQuestion {
        method,
        shear_stiffness: Some(2.0e9),
        starts: 10,
        lag: Lag::Auto,
        level: 0.9,
        held: Vec::new(),
        bounds: Vec::new(),
        guess,
    }
}

/// Whether a calibration has the warning of this name.
pub fn warns(fit: &Calibration, name: &str) -> bool {
    fit.warnings.iter().any(|warning| warning.name() == name)
}

/// Calibrates on two threads.
pub fn ask(record: &MeasuredRecord, question: &CalibrationQuestion) -> Calibration {
    calibrate(record, question, 2, &Default::default()).expect("a record with slips")
}

/// Calibrates synthetic measurements with each of these seeds from their slips. Returns each
/// calibration with the truth.
pub fn by_slips(campaign: &Campaign, seeds: std::ops::Range<u64>) -> Vec<(Calibration, Values)> {
    let one = |seed| {
        let (twin, truth) = twin_of(&BRIDGE, campaign, seed);
        let record = if campaign.imperfections.spikes > 0.0 {
            without_outliers(&twin)
        } else {
            record(&twin)
        };
        (ask(&record, &question(CalibrationMethod::Slips)), truth)
    };
    seeds.map(one).collect()
}

/// The calibrations of 24 synthetic measurements with red noise (seeds 100 to 123), which the tests
/// share.
pub static SOUND: LazyLock<Vec<(Calibration, Values)>> =
    LazyLock::new(|| by_slips(&RED_CAMPAIGN, 100..124));

/// 300 days under steel that is 15 minutes behind the thermometer.
const LAGGING_CAMPAIGN: Campaign = Campaign {
    imperfections: Imperfections { lag: 900.0, ..RED },
    ..RED_CAMPAIGN
};

/// Those of 12 synthetic measurements of such steel (seeds 520 to 531).
pub static LAGGING: LazyLock<Vec<(Calibration, Values)>> =
    LazyLock::new(|| by_slips(&LAGGING_CAMPAIGN, 520..532));

/// The root mean square error of a quantity, relative to its truth.
pub fn rmse(all: &[(Calibration, Values)], quantity: Quantity) -> f64 {
    let error = |(fit, truth): &(Calibration, Values)| {
        fit.estimate(quantity).estimate / truth[quantity as usize] - 1.0
    };
    (all.iter().map(|one| error(one).powi(2)).sum::<f64>() / all.len() as f64).sqrt()
}

/// The mean relative error of a quantity.
pub fn bias(all: &[(Calibration, Values)], quantity: Quantity) -> f64 {
    let error = |(fit, truth): &(Calibration, Values)| {
        fit.estimate(quantity).estimate / truth[quantity as usize] - 1.0
    };
    all.iter().map(error).sum::<f64>() / all.len() as f64
}

/// The number of calibrations whose interval holds the truth.
pub fn covered(all: &[(Calibration, Values)], quantity: Quantity) -> usize {
    all.iter()
        .filter(|(fit, truth)| fit.estimate(quantity).holds(truth[quantity as usize]))
        .count()
}
