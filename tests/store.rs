//! The store from outside: what is written comes back, bad files are refused by name, and a full disk is no crash.

use ndarray::Array2;
use rustix::mount::{MountFlags, UnmountFlags, mount, unmount};
use std::ffi::CString;
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use stick_slip::engine::Status;
use stick_slip::provenance::Provenance;
use stick_slip::stats::{
    Band, Bands, Bias, Estimate, EventColumns, Histogram, PathColumns, PeriodMoments, QUANTILE_LEVELS, Record,
    Statistic, StickDurations, SubPhaseCounts, Summary, TrajectoryRows, Units,
};
use stick_slip::store::{Rows, StoreError, Writer, check_space, discard_partial, partial_path, read};

const EVERYTHING: Record = Record { paths: true, events: true, trajectories: 40 };
const NOTHING: Record = Record { paths: false, events: false, trajectories: 0 };

/// A deterministic number in [0, 1) that is different for every pair of arguments.
fn noise(path: u64, salt: u64) -> f64 {
    let mut z = path.wrapping_mul(0x9E37_79B9_7F4A_7C15).wrapping_add(salt.wrapping_mul(0xD1B5_4A32_D192_ED03));
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    (z >> 11) as f64 / (1_u64 << 53) as f64
}

fn header(paths: u64) -> Provenance {
    Provenance {
        title: "A synthetic ensemble, \u{03c1} = 0.25".to_owned(),
        scenario_text: "[oscillator]\nmass = 1.0\n\n[ensemble]\npaths = 1000\n".to_owned(),
        scheme: "event-driven".to_owned(),
        step: Some(0.01),
        resolution: Some(1e-6),
        // Beyond 2^63: a reader that takes it for a signed or a floating-point number shows.
        seed: 0xFEDC_BA98_7654_3211,
        generator: "PCG64DXSM, ziggurat".to_owned(),
        paths,
        block_size: 256,
        program_version: "0.1.0".to_owned(),
        git_hash: "0123456789abcdef".to_owned(),
        units: Units { time: "s".into(), length: "m".into(), force: "N".into(), temperature: "K".into() },
        time: (0..61).map(f64::from).collect(),
    }
}

/// Rows of consecutive paths, a function of their numbers alone. Path 7 diverged.
#[derive(Default)]
struct Block {
    first_path: u64,
    paths: u64,
    columns: PathColumns,
    events: EventColumns,
    trajectories: TrajectoryRows,
}

fn block(first_path: u64, paths: u64, rows: usize, kept: u64) -> Block {
    let mut block = Block { first_path, paths, ..Block::default() };
    for path in first_path..first_path + paths {
        let diverged = path == 7;
        let real = |salt| if diverged { f64::NAN } else { noise(path, salt) };
        let count = if diverged { 0 } else { (path % 5) as u32 };
        let columns = &mut block.columns;
        columns.displacement_end.push(real(1) - 0.5);
        columns.max_displacement.push(real(2) + 1.0);
        columns.first_stick_duration.push(if path % 11 == 0 { f64::NAN } else { real(3) });
        columns.stick_time.push(60.0 * real(4));
        columns.friction_work.push(100.0 * real(5));
        columns.sticks.push(count);
        columns.slips.push(count);
        columns.sub_phases.push(2 * count);
        columns.diverged.push(diverged);
        block.events.count.push(count);
        for event in 0..u64::from(count) {
            block.events.time.push(event as f64 + noise(path, 10 + event));
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
    fn rows(&self, record: &Record) -> Rows<'_> {
        Rows {
            first_path: self.first_path,
            paths: self.paths,
            path_columns: record.paths.then_some(&self.columns),
            events: record.events.then_some(&self.events),
            trajectories: (!self.trajectories.path.is_empty()).then_some(&self.trajectories),
        }
    }
}

fn band(rows: usize, salt: u64) -> Band {
    let levels = QUANTILE_LEVELS.len();
    Band {
        mean: (0..rows as u64).map(|row| noise(row, salt)).collect(),
        sd: (0..rows as u64).map(|row| noise(row, salt + 1)).collect(),
        quantiles: Array2::from_shape_fn((levels, rows), |(level, row)| level as f64 + noise(row as u64, salt + 2)),
    }
}

/// A summary that agrees with `block`, and holds every kind of missing number.
fn summary(paths: u64, header: &Provenance) -> Summary {
    let block = block(0, paths, 0, 0);
    let ends: Vec<f64> = block.columns.displacement_end.iter().copied().filter(|x| x.is_finite()).collect();
    let mean = ends.iter().sum::<f64>() / ends.len() as f64;
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
        stick_durations: StickDurations {
            completed: 10,
            censored: 3,
            first_completed: 4,
            first_censored: 0,
            histogram: Histogram { edges: vec![0.0, 0.1, 1.0, 10.0, f64::INFINITY], counts: vec![1, 4, 5, 0] },
            censored_counts: vec![0, 1, 2, 0],
            survival: vec![0.9, 0.5, 0.1, 0.0],
            quantiles: vec![0.05, 0.2, 0.5, 2.0, 7.0],
        },
        sub_phases: SubPhaseCounts { counts: vec![7, 2, 1], censored: 2 },
        periods: PeriodMoments { time: vec![25.1, 50.3], mean: vec![0.1, -0.2], variance: vec![1.0, 2.0] },
        bands: Bands {
            time: header.time.clone(),
            displacement: band(rows, 40),
            velocity: band(rows, 50),
            temperature: band(rows, 60),
            static_probability: (0..rows as u64).map(|row| noise(row, 70)).collect(),
        },
    }
}

/// Write a file of so many paths in blocks of this size.
fn write(target: &Path, paths: u64, block_size: u64, record: &Record, status: Status) -> (Provenance, Summary) {
    let header = header(if status == Status::Complete { paths } else { 10 * paths });
    let summary = summary(paths, &header);
    let mut writer = Writer::create(target, &header, record).unwrap();
    for first in (0..paths).step_by(block_size as usize) {
        let size = block_size.min(paths - first);
        let block = block(first, size, header.time.len(), record.trajectories);
        writer.append_rows(block.rows(record)).unwrap();
    }
    writer.finish(&summary, status).unwrap();
    (header, summary)
}

/// NaN is not equal to itself, but it prints the same; and `{:?}` of a number is exact.
fn assert_same<T: std::fmt::Debug>(left: &T, right: &T) {
    assert_eq!(format!("{left:?}"), format!("{right:?}"));
}

fn reals(path: &Path, name: &str) -> Vec<u64> {
    let file = hdf5::File::open(path).unwrap();
    file.dataset(name).unwrap().read_raw::<f64>().unwrap().into_iter().map(f64::to_bits).collect()
}

#[test]
fn a_summary_with_missing_and_infinite_numbers_comes_back() {
    let folder = tempfile::tempdir().unwrap();
    let target = folder.path().join("run.h5");
    let (header, summary) = write(&target, 1000, 256, &EVERYTHING, Status::Complete);
    let stored = read(&target).unwrap();
    assert_eq!(stored.header, header);
    assert_eq!((stored.status, stored.completed_paths), (Status::Complete, 1000));
    assert_same(&stored.summary, &summary);
    assert!(!partial_path(&target).exists());
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
    summary.periods = PeriodMoments { time: Vec::new(), mean: Vec::new(), variance: Vec::new() };
    summary.sub_phases.counts = Vec::new();
    summary.stick_durations.histogram = Histogram { edges: Vec::new(), counts: Vec::new() };
    summary.stick_durations.censored_counts = Vec::new();
    summary.stick_durations.survival = Vec::new();
    let writer = Writer::create(&target, &header, &EVERYTHING).unwrap();
    writer.finish(&summary, Status::Interrupted).unwrap();
    let stored = read(&target).unwrap();
    assert_eq!(stored.header, header);
    assert_same(&stored.summary, &summary);
}

#[test]
fn data_do_not_depend_on_the_size_of_blocks() {
    let folder = tempfile::tempdir().unwrap();
    // More paths than a chunk has rows, so that whole chunks, a chunk in two pieces and a last incomplete one occur.
    let paths = 20_000;
    let targets = [256, 17_000, paths].map(|size| {
        let target = folder.path().join(format!("{size}.h5"));
        write(&target, paths, size, &EVERYTHING, Status::Complete);
        target
    });
    for name in ["path_displacement_end", "event_time", "trajectory_velocity"] {
        let data = reals(&targets[0], name);
        assert!(!data.is_empty());
        assert!(targets.iter().all(|target| reals(target, name) == data), "{name}");
    }
    let whole = block(0, paths, 61, 40);
    assert_eq!(reals(&targets[0], "event_force"), whole.events.force.iter().map(|x| x.to_bits()).collect::<Vec<_>>());
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
    assert_eq!((stored.status, stored.completed_paths, stored.header.paths), (Status::Interrupted, 300, 3000));
    assert_eq!(reals(&target, "path_stick_time").len(), 300);
}

#[test]
fn the_partial_file_claims_what_it_holds() {
    let folder = tempfile::tempdir().unwrap();
    let target = folder.path().join("run.h5");
    let mut writer = Writer::create(&target, &header(1000), &EVERYTHING).unwrap();
    writer.append_rows(block(0, 100, 61, 40).rows(&EVERYTHING)).unwrap();
    writer.checkpoint().unwrap();
    writer.append_rows(block(100, 100, 61, 40).rows(&EVERYTHING)).unwrap();
    // What a killed process leaves behind is what is on disk now.
    let killed = folder.path().join("killed.h5.partial");
    fs::copy(partial_path(&target), &killed).unwrap();
    assert!(!target.exists());
    let error = read(&killed).unwrap_err();
    assert!(matches!(error, StoreError::Unfinished { completed_paths: 100, paths: 1000, .. }), "{error}");
    assert_eq!(reals(&killed, "path_stick_time").len(), 100);
    // A second run to the same target is refused while the first one is going ...
    let error = Writer::create(&target, &header(1000), &NOTHING).unwrap_err();
    assert!(matches!(error, StoreError::InUse { .. }), "{error}");
    assert!(matches!(discard_partial(&target), Err(StoreError::InUse { .. })));
    // ... and when it has died, until its file is discarded.
    drop(writer);
    let error = Writer::create(&target, &header(1000), &NOTHING).unwrap_err();
    assert!(matches!(error, StoreError::LeftOver { .. }), "{error}");
    assert!(read(&target).unwrap_err().to_string().contains("run.h5.partial exists"));
    assert!(discard_partial(&target).unwrap());
    assert!(!discard_partial(&target).unwrap());
    Writer::create(&target, &header(1000), &NOTHING).unwrap();
}

#[test]
fn foreign_files_are_refused_by_name() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    fs::write(path("text.h5"), "time,x\n0,1\n").unwrap();
    fs::write(path("empty.h5"), "").unwrap();
    hdf5::File::create(path("foreign.h5")).unwrap().new_dataset::<f64>().create("x").unwrap();
    write(&path("newer.h5"), 10, 10, &NOTHING, Status::Complete);
    let file = hdf5::File::open_rw(path("newer.h5")).unwrap();
    let version = "2.3".parse::<hdf5::types::VarLenUnicode>().unwrap();
    file.attr("format_version").unwrap().write_scalar(&version).unwrap();
    drop(file);
    let message = |name: &str| {
        let message = read(&path(name)).unwrap_err().to_string();
        assert!(message.contains(name) && !message.contains('\n'), "{message}");
        message
    };
    assert!(message("text.h5").contains("not an HDF5 file"));
    assert!(message("empty.h5").contains("not an HDF5 file"));
    assert!(message("foreign.h5").contains("not one of this program"));
    assert!(message("newer.h5").contains("format 2.3"));
    assert!(message("missing.h5").contains("No such file"));
    assert!(read(folder.path()).unwrap_err().to_string().contains("directory"));
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
        assert!(length < 8 || message.contains("damaged or cut short"), "{message}");
    }
}

#[test]
fn a_missing_folder_and_one_that_cannot_be_written_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let error = Writer::create(&folder.path().join("no/run.h5"), &header(1), &NOTHING).unwrap_err();
    assert!(matches!(error, StoreError::NoFolder { .. }) && error.to_string().contains("run.h5"), "{error}");
    // Not even the superuser may make files here.
    let error = Writer::create(Path::new("/proc/self/run.h5"), &header(1), &NOTHING).unwrap_err();
    assert!(matches!(error, StoreError::NotCreated { .. }) && error.to_string().contains("run.h5"), "{error}");
    let error = check_space(&folder.path().join("no"), 1).unwrap_err();
    assert!(matches!(error, StoreError::Space { .. }), "{error}");
}

#[test]
fn a_run_that_does_not_fit_is_refused_before_it_starts() {
    let folder = tempfile::tempdir().unwrap();
    check_space(folder.path(), 1).unwrap();
    let error = check_space(folder.path(), u64::MAX / 2).unwrap_err();
    assert!(matches!(error, StoreError::TooLittleSpace { .. }), "{error}");
}

/// Say which part of a test did not happen. Not `eprintln!`, which the test harness hides.
fn skip(reason: &str) {
    let _ = writeln!(std::io::stderr(), "SKIPPED: {reason}");
}

/// A small disk that goes away with this value.
struct SmallDisk(PathBuf);

impl SmallDisk {
    /// None where this user may not mount a file system.
    fn mount(folder: &Path, size: &str) -> Option<SmallDisk> {
        // A system call and not the command: a child process would inherit the files that other tests have open, and their locks.
        let options = CString::new(format!("size={size}")).ok()?;
        let done = mount("tmpfs", folder, "tmpfs", MountFlags::empty(), options.as_c_str());
        done.is_ok().then(|| SmallDisk(folder.to_owned()))
    }
}

impl Drop for SmallDisk {
    fn drop(&mut self) {
        // Lazy: after a write error the file stays open on purpose until the process ends.
        let _ = unmount(&self.0, UnmountFlags::DETACH);
    }
}

#[test]
fn a_full_disk_is_one_clear_error_and_no_crash() {
    let folder = tempfile::tempdir().unwrap();
    let target = folder.path().join("run.h5");
    fill(&target).unwrap();
    let needed = fs::metadata(&target).unwrap().len();
    // Disks that fill up in `create`, in `append`, at a checkpoint, and, short of a few pages only, in `finish`.
    let small = (1..8).map(|step| step * 16_384);
    let large = (1..8).map(|step| step * needed / 8);
    let almost = (1..16).map(|step| needed - step * 4096);
    let mut failures = 0;
    for size in small.chain(large).chain(almost) {
        let small = tempfile::tempdir().unwrap();
        let Some(disk) = SmallDisk::mount(small.path(), &size.to_string()) else {
            // What a limit on the size of files comes to is tested in tests/run.rs, for any user.
            skip("this user may not mount a small tmpfs, so no disk is filled; a file that fits was written and is read");
            assert_eq!(read(&target).unwrap().completed_paths, 40_000);
            return;
        };
        let target = disk.0.join("run.h5");
        let Err(error) = fill(&target) else {
            // A file may need a little less than its size: a page of it that is never written takes no room.
            assert!(size > needed - 16_384, "{size} of {needed} bytes were enough");
            continue;
        };
        let message = error.to_string();
        assert!(matches!(error, StoreError::DiskFull { .. } | StoreError::NotCreated { .. }), "{size}: {error:?}");
        assert!(message.contains("run.h5.partial") && message.contains("No space left"), "{message}");
        assert!(!target.exists());
        failures += 1;
    }
    assert!(failures >= 20, "{failures}");
}

/// Write a run of about 2 MB.
fn fill(target: &Path) -> Result<(), StoreError> {
    let header = header(40_000);
    let mut writer = Writer::create(target, &header, &EVERYTHING)?;
    for first in (0..40_000).step_by(4_000) {
        let outcome = writer
            .append_rows(block(first, 4_000, 61, 40).rows(&EVERYTHING))
            .and_then(|()| if first > 20_000 { writer.checkpoint() } else { Ok(()) });
        if let Err(error) = outcome {
            // Whoever goes on regardless hears the same again.
            assert!(writer.checkpoint().is_err());
            assert!(writer.finish(&summary(first, &header), Status::Interrupted).is_err());
            return Err(error);
        }
    }
    writer.finish(&summary(40_000, &header), Status::Complete)
}

/// How fast rows reach the disk, in the sizes of a real run: `cargo test --release --test store speed -- --ignored --nocapture`.
#[test]
#[ignore = "a measurement, not a check"]
fn speed_of_writing() {
    let folder = tempfile::tempdir().unwrap();
    let paths = 256 * 3906;
    for (name, record) in [("paths", Record { paths: true, ..NOTHING }), ("events", Record { events: true, ..NOTHING })]
    {
        let header = header(paths);
        let blocks: Vec<Block> = (0..256).map(|index| block(256 * index, 256, 0, 0)).collect();
        let target = folder.path().join(name);
        let mut writer = Writer::create(&target, &header, &record).unwrap();
        let start = std::time::Instant::now();
        let mut bytes = 0;
        for index in 0..paths / 256 {
            let block = &blocks[index as usize % blocks.len()];
            bytes += if record.paths { 256 * 61 } else { 256 * 12 + 26 * block.events.time.len() };
            writer.append_rows(block.rows(&record)).unwrap();
        }
        writer.finish(&Summary { completed_paths: paths, ..summary(100, &header) }, Status::Complete).unwrap();
        let (seconds, size) = (start.elapsed().as_secs_f64(), fs::metadata(&target).unwrap().len());
        println!("{name}: {:.0} MB in {seconds:.2} s, {:.0} MB on disk", bytes as f64 / 1e6, size as f64 / 1e6);
    }
}

/// A file of every kind comes back, and has the rows that were asked for and no others. Readers of other languages find them where
/// `STORE_SAMPLES=DIR cargo test --test store every_kind` puts them.
#[test]
fn a_file_of_every_kind_comes_back_with_the_rows_it_was_asked_for() {
    let temporary = tempfile::tempdir().unwrap();
    let folder = std::env::var_os("STORE_SAMPLES").map_or(temporary.path().to_owned(), PathBuf::from);
    fs::create_dir_all(&folder).unwrap();
    for (name, paths, record, status) in [
        ("complete.h5", 1000, EVERYTHING, Status::Complete),
        ("interrupted.h5", 300, EVERYTHING, Status::Interrupted),
        ("summary.h5", 1000, NOTHING, Status::Complete),
        ("paths.h5", 1000, Record { paths: true, ..NOTHING }, Status::Complete),
        ("events.h5", 1000, Record { events: true, ..NOTHING }, Status::Complete),
        ("trajectories.h5", 1000, Record { trajectories: 40, ..NOTHING }, Status::Complete),
    ] {
        let target = folder.join(name);
        let (header, summary) = write(&target, paths, 256, &record, status);
        let stored = read(&target).unwrap();
        assert_eq!((stored.header, stored.status, stored.completed_paths), (header, status, paths), "{name}");
        assert_same(&stored.summary, &summary);
        let file = hdf5::File::open(&target).unwrap();
        let rows = |variable: &str| file.dataset(variable).map_or(0, |dataset| dataset.shape()[0] as u64);
        let whole = block(0, paths, 61, 40);
        let kept = |is_kept: bool, rows: u64| if is_kept { rows } else { 0 };
        assert_eq!(rows("path_stick_time"), kept(record.paths, paths), "{name}");
        assert_eq!(rows("event_count"), kept(record.events, paths), "{name}");
        assert_eq!(rows("event_time"), kept(record.events, whole.events.time.len() as u64), "{name}");
        assert_eq!(rows("trajectory_force"), record.trajectories, "{name}");
    }
}
