#!/usr/bin/env bash
# Write a file of every kind with `mc run`, open each with every reader that docs/output-format.md
# names, and recompute what is measured on request. `tools/setup --tests` installs the readers.
set -euo pipefail
cd "$(dirname "$0")/.."

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

run() { # NAME SCENARIO ARGUMENTS...
    cargo run --release --quiet --bin mc -- run "scenarios/$2.toml" --quiet -o "$folder/$1.h5" "${@:3}" 2>"$folder/messages" || {
        cat "$folder/messages" >&2
        return 1
    }
}

# Several blocks, the last of them not full, with everything that can be recorded and with unit
# labels.
run recorded rho025 --paths 600 --set record.events=true --set record.trajectories=3 \
    --set units.time=s --set units.length=mm --set units.force=N --set units.temperature=K
# So many paths that biases are known.
run biased rho025 --paths 4000 --set record.paths=false
# No rows of single paths at all.
run summary rho025 --paths 600 --set record.paths=false
# One path without noise: no interval exists.
run one-path shaw
# A measured temperature and a bearing.
run bearing bridge --set units.length=mm --set units.temperature=K --set record.events=true --set record.trajectories=1
# No stick ends: the dimension of durations is absent.
run no-sticks never-slips
# No time step: the attribute is absent.
run no-step rho025 --paths 600 --scheme event-driven
# A step so long that some paths diverge.
run diverged rho025 --paths 600 --step 0.4 --set time.output_step=6
# One path of a stored ensemble.
cargo run --release --quiet --bin mc -- replay "$folder/recorded.h5" --path 7 -o "$folder/replayed.h5" >"$folder/messages" 2>&1
# What `mc trade` writes.
cargo run --release --quiet --bin mc -- trade scenarios/rho025.toml --budget 2s -o "$folder/trade.h5" >"$folder/messages" 2>&1

target/venv/bin/python tests/python/check.py "$folder"/*.h5
target/venv/bin/python tests/python/derived.py "$folder"/{recorded,biased,one-path,bearing,no-step,diverged}.h5

# Antithetic pairs, in which the pair is the unit of errors.
mkdir "$folder/pairs"
run pairs/pairs rho025 --scheme event-driven --paths 600 --set ensemble.antithetic=true
target/venv/bin/python tests/python/pairs.py "$folder/pairs/pairs.h5"

# A sweep of two axes, and the run at its last point.
mkdir "$folder/sweeps"
cargo run --release --quiet --bin mc -- sweep scenarios/rho025.toml --scheme event-driven --paths 600 \
    --vary rho=temperature.noise.intensity=0.2,0.3 --vary friction.static=1.2,1.25,1.3 -o "$folder/sweeps/sweep.h5" >"$folder/messages" 2>&1
run sweeps/run rho025 --scheme event-driven --paths 600 --set temperature.noise.intensity=0.3 --set friction.static=1.3
target/venv/bin/python tests/python/sweep.py "$folder/sweeps/sweep.h5" "$folder/sweeps/run.h5"

# A calibration of the shipped synthetic measurements, and files of every kind as xarray writes them.
mkdir "$folder/calibrations"
cargo run --release --quiet --bin mc -- calibrate examples/bridge/bridge.toml examples/bridge/twin.csv --method both -o "$folder/calibrations/fit.h5" >"$folder/messages" 2>&1
target/venv/bin/python tests/python/calibration.py "$folder/calibrations/fit.h5"
target/venv/bin/python tests/python/comes_back.py target/release/mc \
    "$folder/recorded.h5" "$folder/trade.h5" "$folder/sweeps/sweep.h5" "$folder/calibrations/fit.h5"

# Everything that is measured on request, of three blocks with a burn-in and of antithetic pairs.
for pairs in false true; do
    run "requested-$pairs" rho025 --scheme event-driven --paths 600 --until 60 --set statistics.after=10 \
        --set ensemble.antithetic=$pairs --set record.laws=true --set record.density=true --set record.spectrum=true \
        --set record.energy=true --set statistics.levels=[12.0,13.5] --set oscillator.damping=0.05 \
        --set record.events=true --set record.trajectories=600
    target/venv/bin/python tests/python/on_request.py "$folder/requested-$pairs.h5"
    target/venv/bin/python tests/python/derived.py "$folder/requested-$pairs.h5"
done
