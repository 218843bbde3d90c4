//! The columns of single paths as arrays of `ndarray`, in memory and without a file: does a path
//! that sticks more often end farther from where it began?
//!
//! `cargo run --release -p stickslip --example own_columns`

use ndarray::{Axis, stack};
use ndarray_stats::{CorrelationExt as _, QuantileExt as _};
use stickslip::dataset::Recorder;
use stickslip::engine::Run;
use stickslip::scenario::Scenario;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut scenario = Scenario::shipped("rho025")?;
    scenario.ensemble.paths = 2_000;
    let mut recorder = Recorder::default();
    Run::of(&scenario)
        .without_bias()
        .into_sink(&mut recorder)
        .simulate()?;
    let data = recorder.into_dataset();

    let sticks = data
        .array::<u32>("path_sticks")
        .ok_or("no path_sticks")?
        .mapv(f64::from);
    let distance = data
        .array::<f64>("path_displacement_end")
        .ok_or("no path_displacement_end")?
        .mapv(f64::abs);
    let correlation = stack(Axis(0), &[sticks.view(), distance.view()])?
        .into_dimensionality()?
        .pearson_correlation()?;
    println!(
        "most sticks of a path: {}; correlation with its distance: {:.3}",
        sticks.max()?,
        correlation[[0, 1]]
    );
    Ok(())
}
