//! The macro steps in which paths are simulated.
//!
//! The length of a macro step follows from the scene and the tolerance alone, never from the
//! instants at which the state is observed. The values of n at the ends of the macro steps are the
//! skeleton of a path, a function of (seed, path, macro step). Events inside a macro step are drawn
//! given n at its end. So two scenarios with the same macro steps have the same noise, and
//! observing a path does not change it.

use super::scene::Scene;
use super::step_grid::StepGrid;
use crate::lanes::{Lanes, small_unit};
use crate::model::Complex;
use crate::noise::Transition;

/// Places of the random numbers of a macro step: n at its end, the motion of a slip over the whole
/// macro step, and from `EVENT_PLACE` on everything else inside the macro step.
pub const NOISE_PLACE: u64 = 0;
pub const WHOLE_PLACE: u64 = 1;
pub const EVENT_PLACE: u64 = 2;

/// One macro step, with the quantities in it that are the same for all paths.
#[derive(Clone, Debug)]
pub struct MacroStep {
    /// Its number.
    pub index: u64,
    /// When it begins.
    pub start: f64,
    /// When it ends, and the next one begins.
    pub end: f64,
    /// How long it lasts.
    pub length: f64,
    /// The transition of n over the macro step.
    pub transition: Transition,
    /// The transition of each of two noises over the macro step, if there are two.
    pub two_transitions: Option<[Transition; 2]>,
    /// The terms of B at the start of the macro step.
    pub terms: Vec<Complex>,
    /// B and B'' at the start of the macro step.
    pub first: Forcing,
    /// B and B'' at the end of the macro step.
    pub last: Forcing,
    frequencies: Vec<f64>,
}

/// B and its second derivative.
#[derive(Clone, Copy, Debug)]
pub struct Forcing<L = f64> {
    pub value: L,
    pub curvature: L,
}

impl MacroStep {
    /// The macro step with this number, for a scene.
    pub fn new(scene: &Scene, grid: &StepGrid, index: u64) -> Self {
        let nothing = Forcing {
            value: 0.0,
            curvature: 0.0,
        };
        let mut macro_step = MacroStep {
            index,
            start: 0.0,
            end: 0.0,
            // Different from that of any macro step, so that the transitions are computed.
            length: f64::NAN,
            transition: Transition {
                decay: 1.0,
                increment_sd: 0.0,
            },
            two_transitions: None,
            terms: vec![Complex::ZERO; scene.harmonics.len()],
            first: nothing,
            last: nothing,
            frequencies: scene
                .harmonics
                .iter()
                .map(|h| h.angular_frequency)
                .collect(),
        };
        macro_step.move_to(scene, grid, index);
        macro_step
    }

    /// Turns this macro step into the macro step with another number.
    pub fn move_to(&mut self, scene: &Scene, grid: &StepGrid, index: u64) {
        let place = grid.place(index);
        if place.length != self.length || scene.is_pinned {
            self.length = place.length;
            self.transition = scene.transition(&place);
            self.two_transitions = scene.two_noises.map(|both| both.transitions(place.length));
        }
        (self.index, self.start, self.end) = (index, place.start, place.end);
        scene.set_terms(self.end, &mut self.terms);
        scene.set_line(place.sample, self.end, &mut self.terms);
        self.last = self.forcing(0.0);
        scene.set_terms(self.start, &mut self.terms);
        scene.set_line(place.sample, self.start, &mut self.terms);
        self.first = self.forcing(0.0);
    }

    /// B and B'' a time after the start of the macro step.
    #[inline(always)]
    pub fn forcing<L: Lanes>(&self, after: L) -> Forcing<L> {
        let mut all = Forcing {
            value: L::splat(0.0),
            curvature: L::splat(0.0),
        };
        for (term, &w) in self.terms.iter().zip(&self.frequencies) {
            // The length of a macro step is at most 1/w, for which `small_unit` is accurate.
            let (cos, sin) = small_unit(after * w);
            let re = cos * term.re - sin * term.im;
            all.value = all.value + re;
            all.curvature = all.curvature - re * (w * w);
        }
        all
    }

    /// The term of one harmonic of B, a time after the start of the macro step.
    #[inline(always)]
    pub fn term<L: Lanes>(&self, harmonic: usize, after: L) -> Complex<L> {
        let p = self.terms[harmonic];
        let (cos, sin) = small_unit(after * self.frequencies[harmonic]);
        Complex {
            re: cos * p.re - sin * p.im,
            im: sin * p.re + cos * p.im,
        }
    }

    /// Sets all terms of B to those a time after the start of the macro step.
    #[inline(always)]
    pub fn set_terms(&self, after: f64, terms: &mut [Complex]) {
        for (harmonic, to) in terms.iter_mut().enumerate() {
            *to = self.term(harmonic, after);
        }
    }
}

/// The length of the macro steps of a run that lasts until `end`, from the longest that the scene
/// allows. It depends on `end` only for a run that is extremely short: the search inside a macro
/// step resolves no times below 2^-40 of a step.
pub fn macro_step_length(longest: f64, end: f64) -> f64 {
    round_down(if end > 0.0 {
        longest.min((end * MOST_RUNS).max(longest * SHORTEST_MACRO_STEP))
    } else {
        longest
    })
}

/// A macro step lasts at most this many times as long as the run.
const MOST_RUNS: f64 = 1e6;

/// The shortest macro step of a very short run, as a fraction of the longest that the scene allows.
/// The fifth power of its length occurs in the variances of a step, and must be representable.
const SHORTEST_MACRO_STEP: f64 = 1e-24;

/// The largest of 1, 2, 2.5 and 5 times a power of ten that is at most `length`. Output times are
/// usually multiples of such numbers, so they fall on ends of macro steps, where the state is known
/// without a further draw.
fn round_down(length: f64) -> f64 {
    let mut decade = 10f64.powi(libm::log10(length).floor() as i32);
    // Rounding of the logarithm may have raised it to the next integer.
    if decade > length {
        decade /= 10.0;
    }
    [5.0, 2.5, 2.0]
        .into_iter()
        .map(|m| m * decade)
        .find(|rounded| *rounded <= length)
        .unwrap_or(decade)
}
