//! The cells of time that paths are simulated in.
//!
//! The length of a cell follows from the scene and the tolerance alone, never from the instants at
//! which somebody looks. n at the ends of the cells is the skeleton of a path, a function of (seed,
//! path, cell); what happens inside a cell is drawn given n at its end. So two scenes with the same
//! cells see the same noise, and looking at a path does not change it.

use super::scene::Scene;
use crate::lanes::small_unit;
use crate::model::Complex;

/// One cell, with what all paths share in it.
#[derive(Clone, Debug)]
pub struct Cell {
    /// Its number.
    pub index: u64,
    /// When it begins.
    pub start: f64,
    /// How long it lasts.
    pub length: f64,
    /// The terms of B where it begins.
    pub terms: Vec<Complex>,
    /// B and its derivatives where it begins.
    pub first: Forcing,
    /// The same where it ends.
    pub last: Forcing,
    frequencies: Vec<f64>,
}

/// B and its first two derivatives.
#[derive(Clone, Copy, Debug, Default)]
pub struct Forcing {
    pub value: f64,
    pub slope: f64,
    pub curvature: f64,
}

impl Cell {
    /// The cell with this number, for a scene.
    pub fn new(scene: &Scene, length: f64, index: u64) -> Self {
        let mut cell = Cell {
            index,
            start: 0.0,
            length,
            terms: vec![Complex::ZERO; scene.harmonics.len()],
            first: Forcing::default(),
            last: Forcing::default(),
            frequencies: scene.harmonics.iter().map(|h| h.angular_frequency).collect(),
        };
        cell.move_to(scene, index);
        cell
    }

    /// Make it the cell with another number.
    pub fn move_to(&mut self, scene: &Scene, index: u64) {
        self.index = index;
        self.start = index as f64 * self.length;
        scene.set_terms(self.end(), &mut self.terms);
        self.last = self.derivatives(|term, _| term);
        scene.set_terms(self.start, &mut self.terms);
        self.first = self.derivatives(|term, _| term);
    }

    /// When it ends, and the next one begins.
    pub fn end(&self) -> f64 {
        (self.index + 1) as f64 * self.length
    }

    /// B and its derivatives a time after the start.
    #[inline(always)]
    pub fn forcing(&self, after: f64) -> Forcing {
        // A cell is at most 1/w long.
        self.derivatives(|term, w| term * unit(w * after))
    }

    #[inline(always)]
    fn derivatives(&self, turned: impl Fn(Complex, f64) -> Complex) -> Forcing {
        let mut all = Forcing::default();
        for (term, &w) in self.terms.iter().zip(&self.frequencies) {
            let p = turned(*term, w);
            all.value += p.re;
            all.slope -= w * p.im;
            all.curvature -= w * w * p.re;
        }
        all
    }

    /// The terms of B a time after the start.
    #[inline(always)]
    pub fn set_terms(&self, after: f64, terms: &mut [Complex]) {
        for ((to, term), &w) in terms.iter_mut().zip(&self.terms).zip(&self.frequencies) {
            *to = *term * unit(w * after);
        }
    }
}

/// e^{i angle} for |angle| <= 1.
#[inline(always)]
fn unit(angle: f64) -> Complex {
    let (re, im) = small_unit(angle);
    Complex { re, im }
}

/// The largest of 1, 2, 2.5 and 5 times a power of ten that is at most `length`: such cells end where
/// people look, which then takes no extra draw.
pub fn round_down(length: f64) -> f64 {
    let mut decade = 10f64.powi(libm::log10(length).floor() as i32);
    // The logarithm may be off by a rounding.
    if decade > length {
        decade /= 10.0;
    }
    [5.0, 2.5, 2.0].into_iter().map(|m| m * decade).find(|rounded| *rounded <= length).unwrap_or(decade)
}
