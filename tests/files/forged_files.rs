//! Files whose checksum was cut off and whose bytes were changed on purpose. HDF5 may crash or loop
//! for ever while it reads them, and a verb must not.

use crate::command::{done, text};
use rand_pcg::Pcg64Dxsm;
use rand_pcg::rand_core::{Rng, SeedableRng};
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::time::Duration;

const RHO025: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/scenarios/rho025.toml");
const EXAMPLE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/bridge");

/// Length of the checksum at the end of a file.
const SEAL: usize = 24;
/// The child process that reads a file first has 20 seconds of a processor.
const LIMIT: Duration = Duration::from_secs(150);

/// The first bytes of the structures that HDF5 follows.
const STRUCTURES: [&[u8]; 9] = [b"\x89HDF", b"OHDR", b"TREE", b"HEAP", b"SNOD", b"GCOL", b"FRHP", b"BTHD", b"OCHK"];

/// One small file of each kind, without its checksum.
fn files(here: &Path) -> Vec<(&'static str, Vec<u8>)> {
    let bridge = format!("{EXAMPLE}/bridge.toml");
    let twin = format!("{EXAMPLE}/twin.csv");
    let small = ["run", RHO025, "--step", "0.05", "--quiet", "--set", "record.events=true", "--set"];
    let run = [&small[..], &["record.trajectories=2", "--paths", "40", "-o", "run.h5"]].concat();
    let part = [&small[..], &["record.trajectories=2", "--paths", "600", "--part", "1/2", "-o", "part.h5"]].concat();
    let sweep = ["sweep", RHO025, "--vary", "friction.static=1.1:1.3:3", "--paths", "40", "--quiet", "-o", "sweep.h5"];
    let trade = ["trade", RHO025, "--budget", "1s", "-o", "trade.h5"];
    let calibration = ["calibrate", &bridge, &twin, "--starts", "1", "-o", "calibration.h5"];
    for verb in [&run[..], &part, &sweep, &trade, &calibration] {
        done(here, verb);
    }
    let cut = |name: &'static str| {
        let mut bytes = fs::read(here.join(format!("{name}.h5"))).expect("written");
        bytes.truncate(bytes.len() - SEAL);
        (name, bytes)
    };
    ["run", "part", "sweep", "trade", "calibration"].map(cut).to_vec()
}

/// The places of all structures in a file.
fn structures(bytes: &[u8]) -> Vec<usize> {
    let begins = |at: &usize| STRUCTURES.iter().any(|name| bytes[*at..].starts_with(name));
    (0..bytes.len()).filter(begins).collect()
}

/// Changes some bytes: near a structure, or anywhere; a bit, a byte or an address.
fn forge(bytes: &mut [u8], structures: &[usize], below: &mut impl FnMut(usize) -> usize) {
    for _ in 0..=below(4) {
        let near = structures[below(structures.len())] + below(200);
        let at = (if below(5) > 0 { near } else { below(bytes.len()) }).min(bytes.len() - 8);
        match below(3) {
            0 => bytes[at] ^= 1 << below(8),
            1 => bytes[at] = [0, 1, 127, 128, 254, 255, below(256) as u8][below(7)],
            _ => {
                let address = [u64::MAX, 0, bytes.len() as u64, below(bytes.len()) as u64][below(4)];
                bytes[at..at + 8].copy_from_slice(&address.to_le_bytes());
            }
        }
    }
}

fn try_forged(tries: usize, seed: u64) {
    let here = tempfile::tempdir().expect("a folder");
    let files = files(here.path());
    let mut rng = Pcg64Dxsm::seed_from_u64(seed);
    let mut below = |end: usize| (rng.next_u64() % end as u64) as usize;
    let verbs: [&[&str]; 6] = [
        &["show", "f.h5"],
        &["plot", "f.h5", "-o", "f.svg", "--force"],
        &["report", "f.h5", "-o", "f.html", "--force"],
        &["verify", "f.h5", "--threads", "2"],
        &["replay", "f.h5", "--path", "1", "-o", "r.h5"],
        &["merge", "f.h5", "-o", "m.h5", "--force"],
    ];
    let mut ends: BTreeMap<i32, usize> = BTreeMap::new();
    for i in 0..tries {
        let (name, whole) = &files[i % files.len()];
        let mut forged = whole.clone();
        forge(&mut forged, &structures(whole), &mut below);
        fs::write(here.path().join("f.h5"), &forged).expect("room");
        let _ = fs::remove_file(here.path().join("r.h5"));
        let verb = verbs[i / files.len() % verbs.len()];
        let mut command = assert_cmd::Command::cargo_bin("mc").expect("built");
        let output = command.current_dir(here.path()).args(verb).timeout(LIMIT).output().expect("runs");
        let said = text(&output.stderr);
        match output.status.code() {
            Some(code @ 0..=2) => *ends.entry(code).or_default() += 1,
            code => {
                let kept = std::env::temp_dir().join(format!("forged-{name}-{seed}-{i}.h5"));
                fs::write(&kept, &forged).expect("room");
                panic!("{name}, try {i}, {verb:?}: {code:?} {said}\n{} holds the file", kept.display());
            }
        }
    }
    println!("{ends:?}");
    assert!(ends.contains_key(&0) && ends.contains_key(&1), "{ends:?}");
}

#[test]
fn a_forged_file_ends_every_verb_with_an_exit_code() {
    try_forged(300, 1);
}

/// Last result: this test has not been run to its end. 1500 files that were forged in the same way
/// by a script gave 322 times exit code 0, 583 times 1 and 595 times 2; the slowest verb took 33 s.
#[test]
#[ignore = "takes an hour"]
fn ten_thousand_forged_files_end_every_verb_with_an_exit_code() {
    try_forged(10_000, 2);
}
