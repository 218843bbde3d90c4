//! A synthetic run for the tests of the store: its rows and its summary depend on the path numbers
//! alone.
#![allow(dead_code, reason = "each test file uses its own part")]

use ndarray::Array2;
use std::path::Path;
use stickslip::engine::{Program, Provenance, Status};
use stickslip::stats::{
    Band, Bands, Bias, BlockRows, Distribution, Estimate, EventColumns, FirstSticks, Histogram,
    PathColumns, PeriodMoments, QUANTILE_LEVELS, Record, Statistic, SubPhaseCounts, Summary,
    TrajectoryRows, Transient, Units,
};
use stickslip::sums::{Ends, Measurement};
use stickslip_files::store::Writer;

pub const EVERYTHING: Record = Record {
    paths: true,
    events: true,
    trajectories: 40,
    ..Record::NOTHING
};
pub const NOTHING: Record = Record::NOTHING;

/// A deterministic number in [0, 1) that differs for every pair of arguments.
pub fn noise(path: u64, salt: u64) -> f64 {
    let mut z = path
        .wrapping_mul(0x9E37_79B9_7F4A_7C15)
        .wrapping_add(salt.wrapping_mul(0xD1B5_4A32_D192_ED03));
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    (z >> 11) as f64 / (1_u64 << 53) as f64
}

pub fn header(paths: u64) -> Provenance {
    Provenance {
        title: "A synthetic ensemble, \u{03c1} = 0.25".to_owned(),
        scenario_text: "[oscillator]\nmass = 1.0\n\n[ensemble]\npaths = 1000\n".to_owned(),
        scheme: "event-driven".to_owned(),
        step: Some(0.01),
        resolution: Some(1e-6),
        // The seed is above 2^63, so that reading it as a signed or a floating-point number would
        // fail the test.
        seed: 0xFEDC_BA98_7654_3211,
        paths,
        antithetic: true,
        program: Program {
            version: "0.1.0".to_owned(),
            git_hash: "0123456789abcdef".to_owned(),
            generator: "PCG64DXSM, ziggurat".to_owned(),
            block_size: 256,
        },
        units: Units {
            time: "s".into(),
            length: "m".into(),
            force: "N".into(),
            temperature: "K".into(),
        },
        time: (0..61).map(f64::from).collect(),
        samples: Vec::new(),
        series_start: None,
        bearing: None,
    }
}

/// The rows of consecutive paths, which depend on their numbers alone. Path 7 diverged.
#[derive(Default)]
pub struct Block {
    pub first_path: u64,
    pub paths: u64,
    pub columns: PathColumns,
    pub events: EventColumns,
    pub trajectories: TrajectoryRows,
}

pub fn block(first_path: u64, paths: u64, rows: usize, kept: u64) -> Block {
    let mut block = Block {
        first_path,
        paths,
        ..Block::default()
    };
    for path in first_path..first_path + paths {
        let diverged = path == 7;
        let real = |salt| {
            if diverged {
                f64::NAN
            } else {
                noise(path, salt)
            }
        };
        let count = if diverged { 0 } else { (path % 5) as u32 };
        let columns = &mut block.columns;
        columns.displacement_end.push(real(1) - 0.5);
        columns.max_displacement.push(real(2) + 1.0);
        columns
            .first_stick_duration
            .push(if path % 11 == 0 { f64::NAN } else { real(3) });
        columns.stick_time.push(60.0 * real(4));
        columns.friction_work.push(100.0 * real(5));
        columns.sticks.push(count);
        columns.slips.push(count);
        columns.sub_phases.push(2 * count);
        columns.diverged.push(diverged.into());
        block.events.count.push(count);
        for event in 0..u64::from(count) {
            block
                .events
                .time
                .push(event as f64 + noise(path, 10 + event));
            block.events.displacement.push(noise(path, 20 + event));
            block.events.force.push(noise(path, 30 + event));
            block.events.sign.push([0, 1, -1][event as usize % 3]);
            block.events.kind.push([0, 1, 2][event as usize % 3]);
        }
        if path < kept {
            let trajectories = &mut block.trajectories;
            trajectories.path.push(path);
            for row in 0..rows as u64 {
                trajectories.displacement.push(noise(path, 100 + row));
                trajectories.velocity.push(noise(path, 1000 + row));
                trajectories.temperature.push(noise(path, 2000 + row));
                trajectories.force.push(noise(path, 3000 + row));
                trajectories.friction.push(noise(path, 4000 + row));
                trajectories.is_static.push(i8::from(row % 2 == 0));
            }
        }
    }
    block
}

impl Block {
    pub fn rows(&self, record: &Record) -> BlockRows {
        BlockRows {
            first_path: self.first_path,
            paths: self.paths,
            path_columns: record.paths.then(|| self.columns.clone()),
            events: record.events.then(|| self.events.clone()),
            trajectories: (!self.trajectories.path.is_empty()).then(|| self.trajectories.clone()),
        }
    }
}

/// Made-up ends of intervals, none of them missing. Those that the data do not bound are infinite.
pub fn ends(points: usize, salt: u64) -> Ends {
    let end = |point: usize| {
        if point == 3 {
            f64::INFINITY
        } else {
            noise(point as u64, salt)
        }
    };
    (0..points)
        .map(|point| [end(point) - 1.0, end(point)])
        .collect()
}

pub fn band(rows: usize, salt: u64) -> Band {
    let levels = QUANTILE_LEVELS.len();
    Band {
        mean: (0..rows as u64).map(|row| noise(row, salt)).collect(),
        mean_ends: ends(rows, salt + 3),
        sd_ends: ends(rows, salt + 5),
        quantile_ends: ends(levels * rows, salt + 7),
        sd: (0..rows as u64).map(|row| noise(row, salt + 1)).collect(),
        quantiles: Array2::from_shape_fn((levels, rows), |(level, row)| {
            level as f64 + noise(row as u64, salt + 2)
        }),
    }
}

/// A summary that agrees with `block`, and contains every kind of missing number.
pub fn summary(paths: u64, header: &Provenance) -> Summary {
    let block = block(0, paths, 0, 0);
    let places: Vec<f64> = block
        .columns
        .displacement_end
        .iter()
        .copied()
        .filter(|x| x.is_finite())
        .collect();
    let mean = places.iter().sum::<f64>() / places.len() as f64;
    let rows = header.time.len();
    let estimate = |statistic: Statistic| {
        let index = statistic.index();
        let value = match statistic {
            Statistic::DisplacementEndMean => mean,
            Statistic::StickDurationMean => f64::INFINITY,
            Statistic::DriftVelocity => f64::NAN,
            _ => index as f64,
        };
        Estimate {
            statistic,
            estimate: value,
            standard_error: 0.1,
            low: value - 0.2,
            high: value + 0.2,
            bias: index.is_multiple_of(2).then_some(Bias {
                estimate: -0.01,
                uncertainty: 0.004,
                order: index.is_multiple_of(4).then_some(0.5),
            }),
        }
    };
    Summary {
        completed_paths: paths,
        diverged: if paths > 7 { vec![7] } else { Vec::new() },
        estimates: Statistic::ALL.map(estimate),
        stick_durations: Distribution {
            step: header.step,
            completed: 10,
            censored: 3,
            histogram: Histogram {
                edges: vec![0.0, 0.1, 1.0, 10.0, f64::INFINITY],
                counts: vec![1, 4, 5, 0],
            },
            censored_counts: vec![0, 1, 2, 0],
            survival: vec![0.9, 0.5, 0.1, 0.0],
            survival_ends: ends(4, 82),
            quantiles: vec![0.05, 0.2, 0.5, 2.0, 7.0],
            quantile_ends: ends(5, 83),
        },
        first_sticks: FirstSticks {
            completed: 4,
            censored: 0,
        },
        laws: None,
        densities: None,
        spectrum: None,
        extremes: None,
        cycle: None,
        asked: Statistic::ALL.to_vec(),
        sub_phases: SubPhaseCounts {
            counts: vec![7, 2, 1],
            shares: vec![0.7, 0.2, 0.1],
            share_ends: ends(3, 85),
            censored: 2,
        },
        periods: PeriodMoments {
            drift_limit: Some(0.0),
            time: vec![25.1, 50.3],
            mean: vec![0.1, -0.2],
            mean_ends: ends(2, 86),
            variance: vec![1.0, 2.0],
            variance_ends: ends(2, 87),
        },
        transient: Some(Transient {
            end: 25.1,
            sticks: 5,
            slips: 6,
            displacement: Measurement {
                estimate: -0.5,
                standard_error: 0.1,
                low: -0.7,
                high: -0.3,
            },
        }),
        bands: Bands {
            time: header.time.clone(),
            displacement: band(rows, 40),
            velocity: band(rows, 50),
            temperature: band(rows, 60),
            static_probability: (0..rows as u64).map(|row| noise(row, 70)).collect(),
            static_probability_ends: ends(rows, 88),
        },
    }
}

/// Writes a file of `paths` paths in blocks of this size.
pub fn write(
    target: &Path,
    paths: u64,
    block_size: u64,
    record: &Record,
    status: Status,
) -> (Provenance, Summary) {
    let header = header(if status == Status::Complete {
        paths
    } else {
        10 * paths
    });
    let summary = summary(paths, &header);
    let mut writer = Writer::create(target, &header, record, false).unwrap();
    for first in (0..paths).step_by(block_size as usize) {
        let size = block_size.min(paths - first);
        let block = block(first, size, header.time.len(), record.trajectories);
        writer.append(&block.rows(record)).unwrap();
    }
    writer.finish(&summary, status).unwrap();
    (header, summary)
}
