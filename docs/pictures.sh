#!/usr/bin/env bash
# Draw the pictures of docs/pictures.md and docs/gallery.md again: some seconds.
# tests/command/pictures.rs runs the same lines and compares what comes out.
set -euo pipefail
cd "$(dirname "$0")/.."
cargo build --release --quiet --bin mc
root=$PWD folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
ln -s "$root/scenarios" "$folder/scenarios"
ln -s "$root/examples" "$folder/examples"
cd "$folder"
mc() { "$root/target/release/mc" "$@"; }

mc plot scenarios/shaw.toml --until 27 -o path-shaw.png
mc plot scenarios/rho025.toml --path 41 --until 30 -o path-rho025.png
mc plot scenarios/belt.toml --until 40 -o path-belt.png
mc plot scenarios/stribeck-belt.toml --until 40 -o path-stribeck-belt.png
mc plot scenarios/duffing.toml --until 60 -o path-duffing.png
mc plot scenarios/self-excited.toml --until 60 -o path-self-excited.png
mc plot scenarios/belt.toml --set oscillator.stiffness=0 --set oscillator.damping=0.1 --set temperature.trend=0 --set temperature.offset=1.5 --until 60 --title Incline -o path-incline.png
mc plot scenarios/belt.toml --set oscillator.stiffness=0 --set temperature.trend=0 --set temperature.noise.intensity=1 --set friction.static=1 --set friction.dynamic=0.5 --until 25 --title Free -o path-free.png
mc plot scenarios/damped.toml --set scheme.kind=event-driven --set temperature.harmonics=[] --set temperature.noise.intensity=0 --set initial.displacement=0 --set force.expression=k --set input.k.process=telegraph --set input.k.low=-2 --set input.k.high=2 --set input.k.rate_up=0.3 --until 40 --title Telegraph -o noise-telegraph.png
mc plot scenarios/damped.toml --set scheme.kind=event-driven --set temperature.harmonics=[] --set temperature.noise.intensity=0 --set initial.displacement=0 --set force.expression=k --set input.k.process=shot --set input.k.rate=0.3 --set input.k.size=0 --set input.k.sizes=normal --set input.k.size_sd=2 --until 40 --title Kicks -o noise-kicks.png
mc plot scenarios/damped.toml --set scheme.kind=event-driven --set temperature.harmonics=[] --set temperature.noise.intensity=0 --set initial.displacement=0 --set force.expression=k --set input.k.process=kanai-tajimi --set input.k.angular_frequency=3 --set input.k.damping_ratio=0.3 --set input.k.intensity=0.5 --set input.k.step=0.02 --until 40 --title Kanai-Tajimi -o noise-ground.png
mc run scenarios/belt.toml --set oscillator.stiffness=0 --set temperature.trend=0 --set temperature.noise.intensity=1 --set friction.static=1 --set friction.dynamic=1 --set temperature.noise.relaxation_rate=100 --set temperature.noise.diffusion=100 --until 40 --set statistics.after=20 --set time.output_step=0.4 --paths 400 --set record.density=true --quiet -o white.h5
mc plot white.h5 --only density -o free-density.png
mc sweep scenarios/shaw.toml --scheme event-driven --set friction.static=1 --set friction.dynamic=1 --set initial.displacement=0 --set oscillator.damping=0.1 --vary w=temperature.harmonics.0.angular_frequency=1.1:3:20 --until 800 --set statistics.after=600 --quiet -o den-hartog-w.h5
mc plot den-hartog-w.h5 --only section -o den-hartog.png
mc run scenarios/rho025.toml --scheme event-driven --paths 4000 -o run.h5
mc plot run.h5 --only overview --path 41 -o overview.png
mc plot run.h5 --only fan -o fan.png
mc plot run.h5 --only sticks --log -o sticks.png
mc plot run.h5 --only sub-phases --log -o sub-phases.png
mc run scenarios/rho025.toml --scheme event-driven --paths 2000 --until 176 --set statistics.after=50 -o long.h5
mc plot long.h5 --only drift -o drift.png
mc run scenarios/rho025.toml --scheme event-driven --paths 4000 --until 150 --set statistics.after=30 --set time.output_step=0.15 --set record.laws=true --set record.density=true --set record.spectrum=true --quiet -o asked.h5
mc plot asked.h5 --only laws -o laws.png
mc plot asked.h5 --only density -o density.png
mc plot asked.h5 --only spectrum -o spectrum.png
mc run scenarios/rho025.toml --scheme event-driven --paths 4000 --set statistics.levels=[6.5,8,10,12] --quiet -o levels.h5
mc plot levels.h5 --only passages -o passages.png
mc sweep scenarios/shaw.toml --scheme event-driven --until 4000 --set statistics.after=3000 --set oscillator.damping=0.02 --vary w=temperature.harmonics.0.angular_frequency=0.15:0.45:241 --quiet -o shaw-w.h5
mc plot shaw-w.h5 --only section -o section.png
mc sweep scenarios/belt.toml --vary V=temperature.trend=0.05:1.25:25 --vary rho=temperature.noise.intensity=0,0.05,0.2 --set record.laws=true --until 400 --set statistics.after=100 --paths 400 --quiet -o belt-v.h5
mc plot belt-v.h5 --statistic sticking_fraction -o belt-sticking.png
mc plot belt-v.h5 --statistic recurrence_time_cv -o belt-recurrence.png
mc plot run.h5 --theme dark -o page-dark.png
mc sweep scenarios/rho025.toml --scheme event-driven --vary rho=temperature.noise.intensity=0:1:21 --paths 4000 --quiet -o event-driven.h5
mc sweep scenarios/rho025.toml --vary rho=temperature.noise.intensity=0:1:21 --paths 4000 --quiet --no-bias -o discrete-vi.h5
mc sweep scenarios/rho025.toml --scheme corrected-vi --vary rho=temperature.noise.intensity=0:1:21 --paths 4000 --quiet --no-bias -o corrected-vi.h5
mc plot event-driven.h5 discrete-vi.h5 corrected-vi.h5 -o sweep.png
mc sweep scenarios/rho025.toml --scheme event-driven --elasticity friction.static,friction.dynamic,oscillator.stiffness,oscillator.dilatation,temperature.noise.intensity,temperature.noise.relaxation_rate --paths 4000 --quiet -o elasticity.h5
mc plot elasticity.h5 -o tornado.png
mc calibrate examples/bridge/bridge.toml examples/bridge/twin.csv -o fit.h5
mc plot fit.h5 --only calibration -o calibration.png
mc plot fit.h5 --only loops -o loops.png
mc plot fit.h5 --only residuals -o residuals.png

cp ./*.png "$root/docs/pictures/"
