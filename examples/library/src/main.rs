//! A spring that hardens, in noise: the engine as a library.
//!
//! `cargo run --release -p stickslip-library-example`

use stickslip::prelude::*;

/// A body on a spring that hardens, driven by a noisy temperature.
fn problem() -> Problem {
    Problem::oscillator(1.0, 1.0) // m, K
        .dilatation(6.0)
        .friction(1.2, 1.0) // f_s, f_d
        .temperature(Temperature::harmonic(1.0, 0.25).with(OrnsteinUhlenbeck::new(0.25, 1.0, 1.0)))
        .force(|x, _v, _t| -0.02 * x.powi(3))
        .start(6.0, 0.0)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let run = Run::new(problem())
        .scheme(EventDriven::default())
        .paths(1_000)
        .end(60.0)
        .seed(1)
        .simulate()?;
    println!("{}", run[Statistic::StickDurationMean]);
    println!("{}", run[Statistic::SticksPerPath]);
    let x = run.array("displacement_mean")?; // along `time`
    println!("x(60) is {:.2} on average", x[x.len() - 1]);
    let path = Run::new(problem())
        .end(60.0)
        .seed(1)
        .motion(0, &[30.0, 60.0])?; // x and x'
    println!(
        "on the first path x(30) is {:.2}, x(60) {:.2}",
        path[0][0], path[1][0]
    );
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The cascade of the paper without noise, from 40-digit arithmetic: tau_1/2, tau_1 and x_1.
    #[test]
    fn a_built_problem_has_the_cascade_of_the_paper() {
        let record = Record {
            events: true,
            ..Record::default()
        };
        let mut memory = stickslip::engine::Memory::default();
        let problem = Problem::oscillator(1.0, 1.0)
            .dilatation(6.0)
            .friction(1.2, 1.0)
            .temperature(Temperature::harmonic(1.0, 0.25))
            .start(6.0, 0.0);
        Run::new(problem)
            .end(20.0)
            .paths(1)
            .record(record)
            .into_sink(&mut memory)
            .simulate()
            .expect("a sound problem");
        let events = memory.blocks[0].rows.events.as_ref().expect("events");
        let times = [2.574_004_435_173_137_5, 13.361_322_057_547_958];
        for (found, right) in events.time.iter().zip(times) {
            assert!((found - right).abs() < 1e-12, "{found} for {right}");
        }
        assert!((events.displacement[1] + 6.188_472_475_367_625).abs() < 1e-12);
    }

    /// A function that is linear in x acts as a stiffer spring. The mean sticks of both agree
    /// within 4 standard errors of 500 paths each: false alarms, 6e-5.
    #[test]
    fn a_function_acts_as_the_spring_that_it_is() {
        let built = |stiffness: f64, beta: f64| {
            Problem::oscillator(1.0, stiffness)
                .dilatation(beta)
                .friction(1.2, 1.0)
                .temperature(Temperature::harmonic(1.0, 0.25))
                .temperature(OrnsteinUhlenbeck::new(0.25, 1.0, 1.0).into())
                .start(6.0, 0.0)
        };
        let run = |problem, seed| {
            Run::new(problem)
                .end(40.0)
                .paths(500)
                .seed(seed)
                .simulate()
                .expect("a sound problem")[Statistic::SticksPerPath]
        };
        let function = run(built(0.8, 7.5).force(|x, _, _| -0.2 * x), 1);
        let spring = run(built(1.0, 6.0), 2);
        let error = function.standard_error.hypot(spring.standard_error);
        assert!((function.estimate - spring.estimate).abs() < 4.0 * error);
    }

    /// The array of the means ends with the mean of the final displacements.
    #[test]
    fn arrays_hold_what_the_statistics_say() {
        let run = Run::new(problem()).paths(300).end(10.0).simulate();
        let run = run.expect("a sound problem");
        let array = |name: &str| run.array(name).map_err(|error| error.to_string());
        let [time, x] = ["time", "displacement_mean"].map(|name| array(name).expect("there"));
        assert_eq!((time.shape(), time[time.len() - 1]), (x.shape(), 10.0));
        let last = run[Statistic::DisplacementEndMean].estimate;
        assert!((x[x.len() - 1] - last).abs() < 1e-12);
        let missing = array("x_mean").expect_err("its name is another one");
        assert!(missing.contains("displacement_mean"), "{missing}");
    }

    #[test]
    fn values_out_of_range_are_refused() {
        let refused = |problem: Problem| {
            let error = Run::new(problem).end(1.0).simulate();
            error.expect_err("refused").to_string()
        };
        let message = refused(Problem::oscillator(-1.0, 1.0));
        assert!(
            message.contains("`oscillator.mass` = -1.0 must be finite and positive"),
            "{message}"
        );
        let message = refused(Problem::free(1.0).friction(1.0, 2.0));
        assert!(message.contains("friction.dynamic"), "{message}");
        let message = refused(Problem::free(f64::NAN));
        assert!(message.contains("oscillator.mass"), "{message}");
    }
}
