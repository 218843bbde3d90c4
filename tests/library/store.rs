//! The store from outside: what is written is read back, damaged files are refused by name, and a
//! full disk causes no crash.

use crate::synthetic::{Block, EVERYTHING, NOTHING, block, header, summary, write};
use std::fs;
use std::path::{Path, PathBuf};
use stickslip::engine::Status;
use stickslip::stats::{Bias, Estimate, Histogram, PeriodMoments, Record, Statistic, Summary};
use stickslip::sums::Ends;
use stickslip_files::store::{StoreError, Writer, check_space, partial_path, read};

/// Compares as text: NaN does not equal itself but prints the same, and `{:?}` prints every digit
/// of a number.
fn assert_same<T: std::fmt::Debug>(left: &T, right: &T) {
    assert_eq!(format!("{left:?}"), format!("{right:?}"));
}

fn reals(path: &Path, name: &str) -> Vec<u64> {
    let file = hdf5::File::open(path).unwrap();
    file.dataset(name)
        .unwrap()
        .read_raw::<f64>()
        .unwrap()
        .into_iter()
        .map(f64::to_bits)
        .collect()
}

#[test]
fn a_summary_with_missing_and_infinite_numbers_comes_back() {
    let folder = tempfile::tempdir().unwrap();
    let target = folder.path().join("run.h5");
    let (header, summary) = write(&target, 1000, 256, &EVERYTHING, Status::Complete);
    let stored = read(&target).unwrap();
    assert_eq!(stored.header, header);
    assert_eq!(
        (stored.status, stored.completed_paths),
        (Status::Complete, 1000)
    );
    assert_same(&stored.summary, &summary);
    assert!(!partial_path(&target).exists());
}

/// The numbers of statistics, and the ends of the corrected interval as a reader of the file computes
/// them.
#[test]
fn numbers_of_statistics_are_under_their_names() {
    let folder = tempfile::tempdir().unwrap();
    let target = folder.path().join("run.h5");
    let (_, s) = write(&target, 1000, 256, &EVERYTHING, Status::Complete);
    let file = hdf5::File::open(&target).unwrap();
    let there = |name: &str| file.dataset(name).unwrap().read_raw::<f64>().unwrap();
    let bias = |e: &Estimate| {
        let known = |bias: Bias| [Some(bias.estimate), Some(bias.uncertainty), bias.order];
        e.bias
            .map_or([None; 3], known)
            .map(|number| number.unwrap_or(f64::NAN))
    };
    type Number<'a> = &'a dyn Fn(&Estimate) -> f64;
    let numbers: [(&str, Number); 9] = [
        ("estimate", &|e| e.estimate),
        ("standard_error", &|e| e.standard_error),
        ("interval_low", &|e| e.low),
        ("interval_high", &|e| e.high),
        ("bias", &|e| bias(e)[0]),
        ("bias_uncertainty", &|e| bias(e)[1]),
        ("bias_order", &|e| bias(e)[2]),
        ("estimate_corrected_low", &|e| {
            e.estimate - bias(e)[0] - (e.estimate - e.low).hypot(bias(e)[1])
        }),
        ("estimate_corrected_high", &|e| {
            e.estimate - bias(e)[0] + (e.high - e.estimate).hypot(bias(e)[1])
        }),
    ];
    for (name, number) in numbers {
        let finite = |x: &f64| if x.is_finite() { *x } else { f64::NAN };
        let [stored, expected]: [Vec<f64>; 2] = [there(name), s.reported().map(number).collect()];
        let shown = |all: Vec<f64>| all.iter().map(finite).collect::<Vec<f64>>();
        assert_eq!(
            format!("{name} {:?}", shown(stored)),
            format!("{name} {:?}", shown(expected))
        );
    }
}

/// One walk writes and reads, so a walk that took one number for another would read it back all the
/// same.
#[test]
fn each_variable_has_the_values_that_its_name_says() {
    let folder = tempfile::tempdir().unwrap();
    let target = folder.path().join("run.h5");
    let (header, s) = write(&target, 1000, 256, &EVERYTHING, Status::Complete);
    let file = hdf5::File::open(&target).unwrap();
    let there = |name: &str| -> Vec<f64> {
        let dataset = file.dataset(name).unwrap();
        match dataset.dtype().unwrap().is::<u64>() {
            true => dataset
                .read_raw::<u64>()
                .unwrap()
                .into_iter()
                .map(|count| count as f64)
                .collect(),
            false => dataset.read_raw().unwrap(),
        }
    };
    let counts = |counts: &[u64]| counts.iter().map(|&count| count as f64).collect::<Vec<_>>();
    let (sticks, sub, periods, transient) = (
        &s.stick_durations,
        &s.sub_phases,
        &s.periods,
        s.transient.unwrap(),
    );
    let moved = transient.displacement;
    let curves = [
        (
            "static_probability",
            s.bands.static_probability.clone(),
            &s.bands.static_probability_ends,
        ),
        (
            "law_survival",
            sticks.survival.clone(),
            &sticks.survival_ends,
        ),
        (
            "law_quantile",
            sticks.quantiles.clone(),
            &sticks.quantile_ends,
        ),
        ("sub_phase_share", sub.shares.clone(), &sub.share_ends),
        (
            "displacement_period_mean",
            periods.mean.clone(),
            &periods.mean_ends,
        ),
        (
            "displacement_period_variance",
            periods.variance.clone(),
            &periods.variance_ends,
        ),
    ]
    .map(|(name, values, ends)| (name.to_string(), values, ends.clone()));
    for (name, expected) in [
        ("law_count", &sticks.histogram.counts),
        ("law_censored_count", &sticks.censored_counts),
        ("law_completed", &vec![sticks.completed]),
        ("law_censored", &vec![sticks.censored]),
        (
            "first_stick_duration_completed",
            &vec![s.first_sticks.completed],
        ),
        (
            "first_stick_duration_censored",
            &vec![s.first_sticks.censored],
        ),
        ("sub_phase_count", &sub.counts),
        ("sub_phase_censored", &vec![sub.censored]),
        ("transient_sticks", &vec![transient.sticks]),
        ("transient_slips", &vec![transient.slips]),
    ] {
        assert_same(&there(name), &counts(expected));
    }
    let numbers = [(
        "transient_displacement".to_string(),
        vec![moved.estimate],
        Ends::from_iter([[moved.low, moved.high]]),
    )];
    let bands = [
        ("displacement", &s.bands.displacement),
        ("velocity", &s.bands.velocity),
        ("temperature", &s.bands.temperature),
    ];
    let bands = bands.map(|(name, band)| {
        let quantiles = band.quantiles.iter().copied().collect();
        [
            (
                format!("{name}_mean"),
                band.mean.clone(),
                band.mean_ends.clone(),
            ),
            (format!("{name}_sd"), band.sd.clone(), band.sd_ends.clone()),
            (
                format!("{name}_quantile"),
                quantiles,
                band.quantile_ends.clone(),
            ),
        ]
    });
    for (name, values, ends) in curves
        .into_iter()
        .chain(numbers)
        .chain(bands.into_iter().flatten())
    {
        assert_same(&there(&name), &values);
        assert_same(
            &there(&format!("{name}_interval")),
            &[ends.low, ends.high].concat(),
        );
    }
    assert_same(&there("transient_end"), &vec![transient.end]);
    assert_same(
        &there("transient_displacement_error"),
        &vec![moved.standard_error],
    );
    let text = |name: &str| {
        file.attr(name)
            .unwrap()
            .read_scalar::<hdf5::types::VarLenUnicode>()
            .unwrap()
            .to_string()
    };
    for (name, value) in [
        ("title", &header.title),
        ("scenario", &header.scenario_text),
        ("scheme", &header.scheme),
        ("generator", &header.program.generator),
        ("program_version", &header.program.version),
        ("git_hash", &header.program.git_hash),
    ] {
        assert_eq!(text(name), *value, "{name}");
    }
    let count = |name: &str| file.attr(name).unwrap().read_scalar::<u64>().unwrap();
    assert_eq!(
        ["seed", "paths", "block_size", "antithetic"].map(count),
        [header.seed, header.paths, header.program.block_size, 1]
    );
    let real = |name: &str| file.attr(name).unwrap().read_scalar::<f64>().unwrap();
    assert_eq!(
        ["step", "resolution"].map(real).map(Some),
        [header.step, header.resolution]
    );
}

#[test]
fn a_summary_of_nothing_comes_back() {
    let folder = tempfile::tempdir().unwrap();
    let target = folder.path().join("run.h5");
    let mut header = header(0);
    header.step = None;
    header.units = Default::default();
    header.time = vec![0.0];
    header.scenario_text = "x".repeat(100_000);
    let nan = |statistic| Estimate {
        statistic,
        estimate: f64::NAN,
        standard_error: f64::NAN,
        low: f64::NAN,
        high: f64::NAN,
        bias: None,
    };
    let mut summary = summary(0, &header);
    summary.estimates = Statistic::ALL.map(nan);
    summary.periods = PeriodMoments {
        drift_limit: None,
        time: Vec::new(),
        mean: Vec::new(),
        mean_ends: Ends::default(),
        variance: Vec::new(),
        variance_ends: Ends::default(),
    };
    summary.sub_phases.counts = Vec::new();
    summary.sub_phases.shares = Vec::new();
    summary.sub_phases.share_ends = Ends::default();
    summary.stick_durations.histogram = Histogram {
        edges: Vec::new(),
        counts: Vec::new(),
    };
    summary.stick_durations.censored_counts = Vec::new();
    summary.stick_durations.survival = Vec::new();
    summary.stick_durations.survival_ends = Ends::default();
    let writer = Writer::create(&target, &header, &EVERYTHING, false).unwrap();
    writer.finish(&summary, Status::Interrupted).unwrap();
    let stored = read(&target).unwrap();
    assert_eq!(stored.header, header);
    assert_same(&stored.summary, &summary);
}

#[test]
fn data_do_not_depend_on_the_size_of_blocks() {
    let folder = tempfile::tempdir().unwrap();
    // There are more paths than rows in a chunk, so that whole chunks, a chunk in two pieces and a
    // last incomplete one occur.
    let paths = 20_000;
    let targets = [256, 17_000, paths].map(|size| {
        let target = folder.path().join(format!("{size}.h5"));
        write(&target, paths, size, &EVERYTHING, Status::Complete);
        target
    });
    for name in ["path_displacement_end", "event_time", "trajectory_velocity"] {
        let data = reals(&targets[0], name);
        assert!(!data.is_empty());
        assert!(
            targets.iter().all(|target| reals(target, name) == data),
            "{name}"
        );
    }
    let whole = block(0, paths, 61, 40);
    assert_eq!(
        reals(&targets[0], "event_force"),
        whole
            .events
            .force
            .iter()
            .map(|x| x.to_bits())
            .collect::<Vec<_>>()
    );
}

#[test]
fn equal_runs_give_equal_files() {
    let folder = tempfile::tempdir().unwrap();
    let [first, second] = ["a.h5", "b.h5"].map(|name| {
        let target = folder.path().join(name);
        write(&target, 500, 100, &EVERYTHING, Status::Complete);
        fs::read(target).unwrap()
    });
    assert!(first == second, "the files differ");
}

#[test]
fn an_interrupted_run_says_how_far_it_came() {
    let folder = tempfile::tempdir().unwrap();
    let target = folder.path().join("run.h5");
    write(&target, 300, 100, &EVERYTHING, Status::Interrupted);
    let stored = read(&target).unwrap();
    assert_eq!(
        (stored.status, stored.completed_paths, stored.header.paths),
        (Status::Interrupted, 300, 3000)
    );
    assert_eq!(reals(&target, "path_stick_time").len(), 300);
}

/// Two writers cannot make one file at the same time, and a writer that gives up leaves nothing
/// behind.
#[test]
fn a_file_is_made_by_one_at_a_time_and_given_up_without_a_trace() {
    let folder = tempfile::tempdir().unwrap();
    let target = folder.path().join("run.h5");
    let mut writer = Writer::create(&target, &header(1000), &EVERYTHING, false).unwrap();
    writer
        .append(&block(0, 100, 61, 40).rows(&EVERYTHING))
        .unwrap();
    assert!(partial_path(&target).is_dir() && !target.exists());
    for force in [false, true] {
        let error = Writer::create(&target, &header(1000), &NOTHING, force).unwrap_err();
        assert!(matches!(error, StoreError::Busy { .. }), "{error}");
    }
    drop(writer);
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
    Writer::create(&target, &header(1000), &NOTHING, false).unwrap();
}

/// A file of others with the name of the folder stays, and so does a file that has the name of the
/// target at the end.
#[test]
fn nothing_of_others_is_replaced() {
    let folder = tempfile::tempdir().unwrap();
    let target = folder.path().join("run.h5");
    let create = |force| Writer::create(&target, &header(1000), &NOTHING, force);
    std::os::unix::fs::symlink("elsewhere", partial_path(&target)).unwrap();
    for force in [false, true] {
        assert!(matches!(
            create(force).unwrap_err(),
            StoreError::InTheWay { .. }
        ));
    }
    fs::remove_file(partial_path(&target)).unwrap();
    fs::create_dir(partial_path(&target)).unwrap();
    fs::write(partial_path(&target).join("thesis.tex"), "by hand").unwrap();
    for force in [false, true] {
        assert!(matches!(
            create(force).unwrap_err(),
            StoreError::InTheWay { .. }
        ));
    }
    fs::remove_dir_all(partial_path(&target)).unwrap();
    let writer = create(false).unwrap();
    fs::write(&target, "by hand").unwrap();
    let error = writer
        .finish(&summary(1000, &header(1000)), Status::Complete)
        .unwrap_err();
    assert!(matches!(error, StoreError::Overtaken { .. }), "{error}");
    assert_eq!(fs::read(&target).unwrap(), b"by hand");
    create(true)
        .unwrap()
        .finish(&summary(1000, &header(1000)), Status::Complete)
        .unwrap();
    assert_eq!(read(&target).unwrap().completed_paths, 1000);
}

#[test]
fn foreign_files_are_refused_by_name() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    fs::write(path("text.h5"), "time,x\n0,1\n").unwrap();
    fs::write(path("empty.h5"), "").unwrap();
    hdf5::File::create(path("foreign.h5"))
        .unwrap()
        .new_dataset::<f64>()
        .create("x")
        .unwrap();
    write(&path("newer.h5"), 10, 10, &NOTHING, Status::Complete);
    let file = hdf5::File::open_rw(path("newer.h5")).unwrap();
    let version = "9.3".parse::<hdf5::types::VarLenUnicode>().unwrap();
    file.attr("format_version")
        .unwrap()
        .write_scalar(&version)
        .unwrap();
    drop(file);
    let message = |name: &str| {
        let message = read(&path(name)).unwrap_err().to_string();
        let (first, rest) = message.split_once('\n').unwrap_or((&message, "  fix: "));
        assert!(
            first.contains(name) && rest.starts_with("  fix: ") && !rest.contains('\n'),
            "{message}"
        );
        message
    };
    assert!(message("text.h5").contains("not an HDF5 file"));
    assert!(message("empty.h5").contains("not an HDF5 file"));
    assert!(message("foreign.h5").contains("not written by this program"));
    assert!(message("newer.h5").contains("format 9.3"));
    assert!(message("missing.h5").contains("No such file"));
    assert!(
        read(folder.path())
            .unwrap_err()
            .to_string()
            .contains("directory")
    );
}

#[test]
fn a_truncated_file_is_an_error_at_every_length() {
    let folder = tempfile::tempdir().unwrap();
    let target = folder.path().join("run.h5");
    write(&target, 1000, 256, &EVERYTHING, Status::Complete);
    let whole = fs::read(&target).unwrap();
    for piece in 0..64 {
        let length = whole.len() * piece / 64;
        let path = folder.path().join(format!("cut{length}.h5"));
        fs::write(&path, &whole[..length]).unwrap();
        let message = read(&path).unwrap_err().to_string();
        assert!(message.contains(&format!("cut{length}.h5")), "{message}");
        assert!(
            length < 8 || message.contains("damaged or truncated"),
            "{message}"
        );
    }
}

#[test]
fn a_missing_folder_and_one_that_cannot_be_written_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let error = Writer::create(
        &folder.path().join("no/run.h5"),
        &header(1),
        &NOTHING,
        false,
    )
    .unwrap_err();
    assert!(
        matches!(error, StoreError::NoFolder { .. }) && error.to_string().contains("run.h5"),
        "{error}"
    );
    // Not even the superuser can make files here.
    let error =
        Writer::create(Path::new("/proc/self/run.h5"), &header(1), &NOTHING, false).unwrap_err();
    assert!(
        matches!(error, StoreError::NotCreated { .. }) && error.to_string().contains("run.h5"),
        "{error}"
    );
    let error = check_space(&folder.path().join("no"), 1).unwrap_err();
    assert!(matches!(error, StoreError::Space { .. }), "{error}");
}

#[test]
fn a_run_that_does_not_fit_is_refused_before_it_starts() {
    let folder = tempfile::tempdir().unwrap();
    check_space(folder.path(), 1).unwrap();
    let error = check_space(folder.path(), u64::MAX / 2).unwrap_err();
    assert!(
        matches!(error, StoreError::TooLittleSpace { .. }),
        "{error}"
    );
}

/// Measures how fast rows are written to the disk, with the sizes of a real run: `cargo test
/// --release --test library speed -- --ignored --nocapture`.
#[test]
#[ignore = "a measurement, not a check"]
fn speed_of_writing() {
    let folder = tempfile::tempdir().unwrap();
    let paths = 256 * 3906;
    for (name, record) in [
        (
            "paths",
            Record {
                paths: true,
                ..NOTHING
            },
        ),
        (
            "events",
            Record {
                events: true,
                ..NOTHING
            },
        ),
    ] {
        let header = header(paths);
        let blocks: Vec<Block> = (0..256)
            .map(|index| block(256 * index, 256, 0, 0))
            .collect();
        let target = folder.path().join(name);
        let mut writer = Writer::create(&target, &header, &record, false).unwrap();
        let start = std::time::Instant::now();
        let mut bytes = 0;
        for index in 0..paths / 256 {
            let block = &blocks[index as usize % blocks.len()];
            bytes += if record.paths {
                256 * 61
            } else {
                256 * 12 + 26 * block.events.time.len()
            };
            writer.append(&block.rows(&record)).unwrap();
        }
        writer
            .finish(
                &Summary {
                    completed_paths: paths,
                    ..summary(100, &header)
                },
                Status::Complete,
            )
            .unwrap();
        let (seconds, size) = (
            start.elapsed().as_secs_f64(),
            fs::metadata(&target).unwrap().len(),
        );
        println!(
            "{name}: {:.0} MB in {seconds:.2} s, {:.0} MB on disk",
            bytes as f64 / 1e6,
            size as f64 / 1e6
        );
    }
}

/// A file of every kind is read back, and has the rows that were asked for and no others.
/// `STORE_SAMPLES=DIR cargo test --test library every_kind` writes these files to DIR, for readers
/// in other languages.
#[test]
fn a_file_of_every_kind_comes_back() {
    let temporary = tempfile::tempdir().unwrap();
    let folder =
        std::env::var_os("STORE_SAMPLES").map_or(temporary.path().to_owned(), PathBuf::from);
    fs::create_dir_all(&folder).unwrap();
    for (name, paths, record, status) in [
        ("complete.h5", 1000, EVERYTHING, Status::Complete),
        ("interrupted.h5", 300, EVERYTHING, Status::Interrupted),
        ("summary.h5", 1000, NOTHING, Status::Complete),
        (
            "paths.h5",
            1000,
            Record {
                paths: true,
                ..NOTHING
            },
            Status::Complete,
        ),
        (
            "events.h5",
            1000,
            Record {
                events: true,
                ..NOTHING
            },
            Status::Complete,
        ),
        (
            "trajectories.h5",
            1000,
            Record {
                trajectories: 40,
                ..NOTHING
            },
            Status::Complete,
        ),
    ] {
        let target = folder.join(name);
        let (header, summary) = write(&target, paths, 256, &record, status);
        let stored = read(&target).unwrap();
        assert_eq!(
            (stored.header, stored.status, stored.completed_paths),
            (header, status, paths),
            "{name}"
        );
        assert_same(&stored.summary, &summary);
        let file = hdf5::File::open(&target).unwrap();
        let rows = |variable: &str| {
            file.dataset(variable)
                .map_or(0, |dataset| dataset.shape()[0] as u64)
        };
        let whole = block(0, paths, 61, 40);
        let kept = |is_kept: bool, rows: u64| if is_kept { rows } else { 0 };
        assert_eq!(rows("path_stick_time"), kept(record.paths, paths), "{name}");
        assert_eq!(rows("event_count"), kept(record.events, paths), "{name}");
        assert_eq!(
            rows("event_time"),
            kept(record.events, whole.events.time.len() as u64),
            "{name}"
        );
        assert_eq!(rows("trajectory_force"), record.trajectories, "{name}");
    }
}
