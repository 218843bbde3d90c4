//! The native part of the Python package: it exposes the engine to the functions in `stickslip/`.
//!
//! ```text
//! scenario   text or file with overrides -> a checked Scenario, and what follows from it
//! watched    work on another thread, while this one handles signals and reports progress
//! run        a run, its parts, one of its paths -> data sets
//! own        user-defined statistics, over the events of finished blocks
//! studies    the choice for an accuracy, sweeps, trades
//! bearing    calibration, weather and forecast of measured bearings, synthetic measurements
//! plot       pictures of all of them
//! dataset    a data set -> NumPy arrays, which take over its memory; and back
//! verify     a run compared with a second simulation
//! errors     an error of the engine -> an exception of stickslip.errors
//! ```

#![expect(
    clippy::too_many_arguments,
    reason = "they are keywords of one Python function"
)]

mod bearing;
mod dataset;
mod errors;
mod own;
mod plot;
mod run;
mod scenario;
mod studies;
mod verify;
mod watched;

/// Native part of the package; use the functions of `stickslip` itself.
#[pyo3::pymodule]
mod _native {
    #[pymodule_export]
    use super::bearing::{calibrate, fit_temperature, forecast, repaired, twin};
    #[pymodule_export]
    use super::plot::{Picture, plot};
    #[pymodule_export]
    use super::run::{merge, motion, replay, run};
    #[pymodule_export]
    use super::scenario::{Scenario, key_meant, option_meant, parse, shipped};
    #[pymodule_export]
    use super::studies::{choose, sweep, trade};
    #[pymodule_export]
    use super::verify::{checksum, verify};

    #[pymodule_init]
    fn init(module: &pyo3::Bound<'_, pyo3::types::PyModule>) -> pyo3::PyResult<()> {
        use pyo3::types::PyModuleMethods as _;
        module.add("VERSION", stickslip::engine::PROGRAM_VERSION)?;
        stickslip::engine::built_from(env!("STICKSLIP_COMMIT"));
        module.add("GIT_HASH", stickslip::engine::commit())?;
        let statistics = stickslip::stats::Statistic::ALL.map(stickslip::stats::Statistic::name);
        module.add("STATISTICS", statistics.to_vec())?;
        module.add("OPTIONS", stickslip::config::OPTIONS.to_vec())?;
        module.add(
            "SHIPPED",
            stickslip::config::SHIPPED
                .map(|shipped| shipped.name)
                .to_vec(),
        )
    }
}
