//! A static phase: x rests, the noise wanders, and the first exit of b = B(t) - K x + n from |b| <=
//! f_s ends it.
//!
//! Step by step ([`StickStep`]) with lengths from a ladder. The length of a step follows from the
//! state at its start, which biases nothing:
//!
//! - h <= width^2/(8 s^2): the chance that one bridge meets both thresholds is below 2 exp(-16);
//! - |c| h^2/8 <= kappa s sqrt(h), kappa the stick share of the tolerance: the chord error against
//!   the noise;
//! - or any length within which no threshold can be met at all (7 standard deviations, moving
//!   thresholds included), so that quiet phases, slow forcing and feeble noise cost few steps.

use super::path_loop::Path;
use super::scene::{Scene, forcing};
use super::stick_step::StickStep;
use super::work::{Unresolved, Work};
use crate::model::{Complex, Event, EventKind, Sign};
use crate::noise::Stream;

/// Exact steps of a ladder of lengths, longest first.
#[derive(Clone, Debug)]
pub struct StickSteps {
    ladder: Vec<StickStep>,
    /// The rung whose length is at most width^2/(8 s^2).
    width_rung: usize,
}

/// Where a static path is.
pub struct StickState<'a> {
    /// t.
    pub time: f64,
    /// K x.
    pub spring_force: f64,
    /// n.
    pub noise: f64,
    /// The terms of B at t.
    pub terms: &'a mut [Complex],
}

/// Rungs of the ladder: lengths down to 2^-59 of the longest.
const RUNGS: usize = 60;

/// The width rule: steps of at most width^2 / (this s^2).
const WIDTH_RULE: f64 = 8.0;

impl StickSteps {
    /// For a scene, with the chord error held below `kappa` standard deviations of the noise over a
    /// step.
    pub fn new(scene: &Scene, kappa: f64, end: f64) -> Self {
        // Beyond a few relaxation times a longer step saves nothing.
        let longest = (4.0 / scene.relaxation_rate).min(end.max(f64::MIN_POSITIVE));
        let ladder: Vec<_> = (0..RUNGS)
            .map(|k| StickStep::new(scene, kappa, longest * 0.5f64.powi(k as i32)).with_turns(scene))
            .collect();
        let width = 2.0 * scene.friction.static_force;
        let allowed = width * width / (WIDTH_RULE * scene.diffusion * scene.diffusion);
        let width_rung = ladder.iter().position(|step| step.length <= allowed || allowed.is_nan()).unwrap_or(RUNGS - 1);
        StickSteps { ladder, width_rung }
    }

    /// Take a path in a static phase to its exit or the horizon, whichever is first; the terms are
    /// those of B at its time.
    #[inline(always)]
    pub fn advance_path<M>(
        &self,
        scene: &Scene,
        path: &mut Path<M>,
        terms: &mut [Complex],
        horizon: f64,
    ) -> Result<Option<Event>, Unresolved> {
        let spring_force = scene.oscillator.stiffness * path.displacement;
        let mut state = StickState { time: path.time, spring_force, noise: path.noise, terms };
        let exit = self.advance(scene, &mut state, horizon, &mut path.draws, &mut path.work)?;
        (path.time, path.noise) = (state.time, state.noise);
        Ok(exit.map(|force| Event {
            kind: EventKind::SlipStarted(Sign::of(force)),
            time: path.time,
            displacement: path.displacement,
            force,
        }))
    }

    /// Simulate until the exit or the horizon, whichever is first. At an exit, b at its time: f_s
    /// with a sign where it met it, or more where it started beyond.
    pub fn advance(
        &self,
        scene: &Scene,
        state: &mut StickState<'_>,
        horizon: f64,
        draws: &mut Stream,
        work: &mut Work,
    ) -> Result<Option<f64>, Unresolved> {
        let f_s = scene.friction.static_force;
        let mut force = forcing(state.terms) - state.spring_force + state.noise;
        if force.abs() >= f_s {
            return Ok(Some(force));
        }
        loop {
            work.spend()?;
            let remaining = horizon - state.time;
            if remaining <= 0.0 {
                return Ok(None);
            }
            let rung = &self.ladder[self.rung(scene, state, force)];
            let start_curvature = scene.forcing_curvature(state.terms);
            let partial;
            let step = if rung.length > remaining {
                partial = StickStep::new(scene, 0.0, remaining);
                scene.set_terms(horizon, state.terms);
                &partial
            } else {
                for (term, turn) in state.terms.iter_mut().zip(&rung.turns) {
                    *term = *term * *turn;
                }
                rung
            };
            let noise = step.noise.transition.next(state.noise, draws.normal());
            let end_force = forcing(state.terms) - state.spring_force + noise;
            let ends = (force, end_force);
            // Chord deviation of the threshold seen by n: c = U'' - theta^2 U with U'' = -B'',
            // averaged over the ends.
            let bend = -0.5 * (start_curvature + scene.forcing_curvature(state.terms));
            let mean_noise = 0.5 * (state.noise + noise);
            if let Some((sign, after)) = step.exit(scene, f_s, ends, bend, mean_noise, draws) {
                state.time += after;
                scene.set_terms(state.time, state.terms);
                let force = sign.value() * f_s;
                state.noise = force - forcing(state.terms) + state.spring_force;
                return Ok(Some(force));
            }
            state.noise = noise;
            force = end_force;
            // The last step ends on the horizon itself, not a rounding beside it.
            state.time = if rung.length > remaining { horizon } else { state.time + step.length };
        }
    }

    /// The rung to step with from here.
    #[inline]
    fn rung(&self, scene: &Scene, state: &StickState<'_>, force: f64) -> usize {
        let (f_s, theta) = (scene.friction.static_force, scene.relaxation_rate);
        let bend = scene.largest_forcing_curvature + theta * theta * (state.noise.abs() + 2.0 * f_s);
        let mut rung = self.width_rung;
        while rung + 1 < RUNGS && self.ladder[rung].bend_limit < bend {
            rung += 1;
        }
        let clear = f_s - force.abs();
        // Most steps are near a threshold: decide that first, with the noise alone.
        while rung > 0 && clear > self.ladder[rung - 1].farthest {
            let h = self.ladder[rung - 1].length;
            let slope = scene.forcing_slope(state.terms).abs() + theta * state.noise.abs();
            if clear <= self.ladder[rung - 1].farthest + h * (slope + 0.5 * h * scene.largest_forcing_curvature) {
                break;
            }
            rung -= 1;
        }
        rung
    }
}

#[cfg(test)]
mod tests {
    use super::super::harness::{exits, mean_and_error};
    use super::super::step_rules::{DEFAULT_TOLERANCE, StepRules};
    use crate::model::paper::paper;
    use crate::model::{Harmonic, Sign};

    /// Statistical tests: null hypothesis, the mean is the exact one; n paths; they fail by chance
    /// once in 1e4 (3.9 standard errors), with fixed seeds.
    const FALSE_ALARM: f64 = 3.9;

    fn assert_mean(name: &str, values: &[f64], exact: f64) {
        let (mean, error) = mean_and_error(values);
        assert!((mean - exact).abs() <= FALSE_ALARM * error, "{name}: {mean} +- {error}, exact {exact}");
    }

    /// Exit of dv = -v dt + dW from (lower, upper), started at `from`: Siegert's integrals by
    /// high-precision quadrature.
    #[test]
    fn exit_from_a_fixed_corridor_has_siegert_s_mean_and_side() {
        // (lower, upper, from, mean, probability of the upper side)
        let cases = [
            (-0.25, 0.25, 0.0, 0.063_824_078_626_031_84, 0.5),
            (-0.5, 0.5, 0.0, 0.272_300_063_376_112_1, 0.5),
            (-0.8, 0.8, 0.0, 0.803_432_748_833_375_6, 0.5),
            (-0.8, 0.8, 0.4, 0.634_522_479_697_277_3, f64::NAN),
            (-2.0, 2.0, 0.0, 27.432_739_152_499_77, 0.5),
            (-1.0, 0.5, 0.0, 0.590_704_042_576_515_5, 0.728_543_256_592_702),
            (-0.4, 1.2, 0.0, 0.553_861_940_553_424, 0.164_777_335_275_732_8),
        ];
        for (case, (lower, upper, from, mean, up)) in cases.into_iter().enumerate() {
            // K = beta = rho = 1 and no harmonics: b = n - x0 with threshold (upper - lower)/2.
            let mut model = paper(0.25, 1.0);
            model.oscillator.dilatation = 1.0;
            model.temperature.harmonics.clear();
            model.friction.static_force = 0.5 * (upper - lower);
            model.initial_displacement = 0.5 * (upper + lower);
            let found = exits(&model, from, 0.1, 1e4, case as u64, 100_000);
            let times: Vec<f64> = found.iter().map(|e| e.0).collect();
            assert_mean("mean exit time", &times, mean);
            if !up.is_nan() {
                let sides: Vec<f64> = found.iter().map(|e| f64::from(u8::from(e.1 == Sign::Positive))).collect();
                assert_mean("share of upward exits", &sides, up);
            }
        }
    }

    #[test]
    fn exit_does_not_depend_on_the_units_of_the_noise() {
        // theta, sigma general: time scales by 1/theta and v by sigma/sqrt(theta); survival P(T >
        // t) of the corridor 0.8.
        let (theta, sigma) = (3.0, 0.2);
        let mut model = paper(0.25, 1.0);
        model.oscillator.dilatation = 1.0;
        model.temperature.harmonics.clear();
        model.initial_displacement = 0.0;
        model.friction.static_force = 0.8 * sigma / f64::sqrt(theta);
        if let Some(noise) = &mut model.temperature.noise {
            (noise.relaxation_rate, noise.diffusion) = (theta, sigma);
        }
        let found = exits(&model, 0.0, 0.1, 1e4, 77, 200_000);
        for (t, survival) in
            [(0.25, 0.828_946_889_68), (0.5, 0.577_189_766_468), (1.0, 0.276_890_707_225), (2.0, 0.063_707_309_437)]
        {
            let alive: Vec<f64> = found.iter().map(|e| f64::from(u8::from(e.0 * theta > t))).collect();
            assert_mean("survival", &alive, survival);
        }
    }

    #[test]
    fn first_stick_of_the_paper_s_noisy_scene_has_its_exact_mean() {
        // The corridor moves with the forcing; means from the backward Kolmogorov equation (12
        // digits) and, for the two smallest rho, from a Volterra equation
        // (tests/reference/first_stick.py, 7 digits).
        for (rho, mean) in [
            (0.01, 2.571_426),
            (0.02, 2.563_677),
            (0.1, 2.289_610_431_7),
            (0.25, 0.775_576_827_665),
            (1.0, 0.040_539_066_2),
        ] {
            let found = exits(&paper(0.25, rho), 0.0, 0.1, 60.0, (rho * 1000.0) as u64, 200_000);
            let times: Vec<f64> = found.iter().map(|e| e.0).collect();
            assert_mean("first stick", &times, mean);
        }
    }

    #[test]
    fn feeble_noise_costs_few_steps_and_tends_to_the_deterministic_exit() {
        for rho in [1e-4, 1e-6, 1e-9, 1e-12] {
            let found = exits(&paper(0.25, rho), 0.0, 0.1, 60.0, 5, 1_000);
            let times: Vec<f64> = found.iter().map(|e| e.0).collect();
            let (mean, _) = mean_and_error(&times);
            // The exit moves by about sd(n)/B' ~ 6 rho.
            assert!((mean - 2.574_004_435_173_137_6).abs() < 6.0 * rho + 1e-9, "{rho}: {mean}");
        }
    }

    /// Where the threshold bends, 1 + 100 (1 - cos((t - 2.5)/10)) above the noise with theta = 0.0354 and s = 1, the length of a step is a matter of its chord error
    /// alone; the rungs of the ladder are such that four times the error would be steps of four times the length. Null: the chance to leave in the first
    /// dip, and when, are the exact ones (`tests/reference/first_stick.py`) but for the default tolerance, 0.1 %. 8e5 paths, which tell the two to 0.12 and 0.06 %,
    /// two comparisons at 1e-4 each. At twice the chord error the time is 0.4 % too long, at four times 4 %.
    #[test]
    fn a_bent_threshold_is_left_when_it_should_be_at_the_default_tolerance() {
        let kappa = StepRules::new(DEFAULT_TOLERANCE).chord_error;
        let (amplitude, w): (f64, f64) = (100.0, 0.1);
        let mut model = paper(0.25, 1.0);
        model.oscillator.dilatation = 1.0;
        model.temperature.harmonics = vec![Harmonic { amplitude, angular_frequency: w, phase: -2.5 * w }];
        model.friction.static_force = amplitude + 1.0;
        model.initial_displacement = 0.0;
        if let Some(noise) = &mut model.temperature.noise {
            (noise.relaxation_rate, noise.diffusion) = (0.0354, 1.0);
        }
        let found = exits(&model, 0.0, kappa, 1e6, 9, 800_000);
        let (times, later): (Vec<f64>, Vec<f64>) = found.iter().map(|e| e.0).partition(|t| *t < 8.0);
        let is_early: Vec<f64> = times.iter().map(|_| 1.0).chain(later.iter().map(|_| 0.0)).collect();
        for (what, values, exact) in [("share", &is_early, 0.479_575_06), ("time", &times, 1.894_435_19)] {
            let (mean, error) = mean_and_error(values);
            println!("{what}: {mean} +- {error}, exact {exact}");
            assert!(
                (mean - exact).abs() <= FALSE_ALARM * error + DEFAULT_TOLERANCE * exact,
                "{what}: {mean} +- {error}, exact {exact}"
            );
        }
    }
}
