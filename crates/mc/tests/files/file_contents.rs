//! The contents of a file that `mc run` writes, read without the store. This finds numbers that a
//! program which writes and reads with the same mistake would not notice: each is compared with rows
//! of the same file.

use crate::command;
use hdf5::File;
use hdf5::types::VarLenUnicode;
use std::path::PathBuf;
use std::sync::LazyLock;

const RHO025: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenarios/rho025.toml");
const PATHS: usize = 64;
const SEED: u64 = 4711;

/// A run of the noisy scene, whose slips have sub-phases, with everything that can be recorded,
/// unit labels, and a seed that no scenario has; and a replay of its path 11.
static FOLDER: LazyLock<PathBuf> = LazyLock::new(|| {
    // This is not a temporary folder, because a static is never dropped, and the folder would remain.
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("file_contents");
    std::fs::create_dir_all(&folder).expect("a folder");
    let paths = PATHS.to_string();
    let mut run = vec![
        "run",
        RHO025,
        "--paths",
        &paths,
        "--seed",
        "4711",
        "--quiet",
        "--no-bias",
        "--force",
        "-o",
        "run.h5",
    ];
    let set = [
        "record.events=true",
        "record.trajectories=64",
        "time.output_step=0.1",
        "units.time=s",
        "units.length=mm",
    ];
    set.iter().for_each(|set| run.extend(["--set", set]));
    let output = command::mc(&folder, &run);
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    let output = command::mc(
        &folder,
        &[
            "replay",
            "run.h5",
            "--path",
            "11",
            "--force",
            "-o",
            "replay.h5",
        ],
    );
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    folder
});

fn file(name: &str) -> File {
    File::open(FOLDER.join(name)).expect("HDF5")
}

fn values<T: hdf5::H5Type>(file: &File, name: &str) -> Vec<T> {
    file.dataset(name)
        .and_then(|dataset| dataset.read_raw())
        .unwrap_or_else(|e| panic!("{name}: {e}"))
}

fn text(place: &hdf5::Location, name: &str) -> String {
    place
        .attr(name)
        .and_then(|attr| attr.read_scalar::<VarLenUnicode>())
        .expect(name)
        .as_str()
        .to_string()
}

fn seed(file: &File) -> u64 {
    file.attr("seed")
        .and_then(|attr| attr.read_scalar())
        .expect("a seed")
}

#[test]
fn the_seed_is_the_one_that_was_asked_for_to_its_last_bit() {
    for name in ["run.h5", "replay.h5"] {
        assert_eq!(seed(&file(name)), SEED, "{name}");
        assert!(
            text(&file(name), "scenario").contains("seed = 4711"),
            "{name}"
        );
    }
    // A seed beyond the range of signed numbers and of exact doubles.
    let folder = tempfile::tempdir().expect("a folder");
    let greatest = u64::MAX.to_string();
    let run = [
        "run", RHO025, "--paths", "1", "--until", "1", "--seed", &greatest, "--quiet", "-o",
        "run.h5",
    ];
    assert!(command::mc(folder.path(), &run).status.success());
    assert_eq!(
        seed(&File::open(folder.path().join("run.h5")).expect("HDF5")),
        u64::MAX
    );
}

#[test]
fn a_replay_says_which_path_it_is() {
    let replay = file("replay.h5");
    assert_eq!(
        (
            values::<u64>(&replay, "path"),
            values::<u64>(&replay, "trajectory")
        ),
        (vec![11], vec![11])
    );
    let count: Vec<u32> = values(&file("run.h5"), "event_count");
    assert_eq!(values::<u32>(&replay, "event_count"), [count[11]]);
    let numbers: Vec<u64> = (0..PATHS as u64).collect();
    assert_eq!(values::<u64>(&file("run.h5"), "path"), numbers);
    assert_eq!(values::<u64>(&file("run.h5"), "trajectory"), numbers);
}

/// An event that starts a sub-phase has the sign of the change of x up to the next event or to
/// t_end. Where a stick starts, the sign is 0 and x does not change. The events include turns.
#[test]
fn the_sign_of_an_event_is_that_of_the_motion_that_follows() {
    let run = file("run.h5");
    let (x, sign, kind) = (
        values::<f64>(&run, "event_displacement"),
        values::<i8>(&run, "event_sign"),
        values::<i8>(&run, "event_kind"),
    );
    let ends: Vec<f64> = values(&run, "path_displacement_end");
    let (mut first, mut moves, mut turns) = (0, 0, 0);
    for (path, count) in values::<u32>(&run, "event_count").into_iter().enumerate() {
        let last = first + count as usize;
        for event in first..last {
            let next = if event + 1 < last {
                x[event + 1]
            } else {
                ends[path]
            };
            let change = next - x[event];
            if kind[event] == 0 {
                assert_eq!(
                    (sign[event], change),
                    (0, 0.0),
                    "path {path}, event {event}"
                );
            } else {
                assert!(
                    f64::from(sign[event]) * change > 0.0,
                    "path {path}, event {event}: {} and {change}",
                    sign[event]
                );
                moves += 1;
                turns += u32::from(kind[event] == 2);
            }
        }
        first = last;
    }
    assert!(moves > 1000 && turns > 200, "{moves} {turns}");
}

#[test]
fn a_variance_is_measured_in_squares() {
    let run = file("run.h5");
    let unit = |name: &str| text(&run.dataset(name).expect(name), "units");
    assert_eq!(unit("displacement_period_mean"), "mm");
    assert_eq!(unit("displacement_period_variance"), "mm2");
    assert_eq!(
        (unit("displacement_sd"), unit("velocity_sd")),
        ("mm".to_string(), "mm s-1".to_string())
    );
    let names: Vec<VarLenUnicode> = values(&run, "statistic");
    let units: Vec<VarLenUnicode> = values(&run, "statistic_unit");
    let of = |name: &str| {
        units[names.iter().position(|n| n.as_str() == name).expect(name)]
            .as_str()
            .to_string()
    };
    assert_eq!(
        (of("diffusion_coefficient"), of("displacement_end_sd")),
        ("mm2 s-1".to_string(), "mm".to_string())
    );
}

/// The quantiles have the level along the first axis and the time along the second. Each lies
/// between those two of the 64 ordered values that its level lies between, or is as near to one of
/// them as a bin is wide. A bin is 2^-8 of the distance from the centre and of the scale of the
/// scene, which is below 16.
#[test]
fn quantiles_lie_along_the_axes_that_they_are_said_to_lie_along() {
    let run = file("run.h5");
    let levels: Vec<f64> = values(&run, "quantile");
    let times: Vec<f64> = values(&run, "time");
    assert_eq!(levels, [0.05, 0.25, 0.5, 0.75, 0.95]);
    for name in ["displacement", "velocity", "temperature"] {
        let quantiles = run.dataset(&format!("{name}_quantile")).expect(name);
        assert_eq!(quantiles.shape(), [levels.len(), times.len()], "{name}");
        let quantiles: Vec<f64> = quantiles.read_raw().expect(name);
        let rows: Vec<f64> = values(&run, &format!("trajectory_{name}"));
        assert_eq!(rows.len(), PATHS * times.len(), "{name}");
        for time in 0..times.len() {
            let mut at: Vec<f64> = rows
                .iter()
                .skip(time)
                .step_by(times.len())
                .copied()
                .collect();
            at.sort_by(f64::total_cmp);
            for (i, level) in levels.iter().enumerate() {
                let rank = level * (PATHS - 1) as f64;
                let (below, above) = (at[rank.floor() as usize], at[rank.ceil() as usize]);
                let width = (below.abs().max(above.abs()) + 6.0 + 4.0) / 256.0;
                let q = quantiles[i * times.len() + time];
                let is_near = below - width <= q && q <= above + width;
                assert!(
                    is_near,
                    "{name} at {level}, row {time}: {q}, not between {below} and {above}"
                );
            }
        }
    }
}

/// The mean and the standard deviation over all paths at every time, and the share of static paths.
#[test]
fn bands_are_those_of_the_trajectories() {
    let run = file("run.h5");
    let rows = values::<f64>(&run, "time").len();
    let n = PATHS as f64;
    for name in ["displacement", "velocity", "temperature"] {
        let all: Vec<f64> = values(&run, &format!("trajectory_{name}"));
        let (means, sds): (Vec<f64>, Vec<f64>) = (
            values(&run, &format!("{name}_mean")),
            values(&run, &format!("{name}_sd")),
        );
        for row in 0..rows {
            let at: Vec<f64> = all.iter().skip(row).step_by(rows).copied().collect();
            let mean = at.iter().sum::<f64>() / n;
            let sd = (at.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (n - 1.0)).sqrt();
            // Both are sums of 64 numbers below 20, in different orders.
            assert!(
                (means[row] - mean).abs() < 1e-12 && (sds[row] - sd).abs() < 1e-10,
                "{name}, row {row}"
            );
        }
    }
    let is_static: Vec<i8> = values(&run, "trajectory_static");
    for (row, share) in values::<f64>(&run, "static_probability")
        .into_iter()
        .enumerate()
    {
        let counted: i32 = is_static
            .iter()
            .skip(row)
            .step_by(rows)
            .map(|&s| i32::from(s))
            .sum();
        assert_eq!(share, f64::from(counted) / n, "row {row}");
    }
}
