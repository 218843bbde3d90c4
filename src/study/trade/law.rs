//! The law by which a bias falls with the step, C h^p, fitted to measurements.

use super::Number;

/// The difference S(h) - S(h/2), measured on one realisation of the noise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Change {
    /// The step h.
    pub h: f64,
    /// The difference with its standard error.
    pub change: Number,
}

/// The fitted law bias(h) = C h^p.
#[derive(Clone, Debug, PartialEq)]
pub struct Law {
    /// The order p with its error.
    pub order: Number,
    /// The coarsest step to which the law was fitted.
    pub coarsest: f64,
    /// (p, C, standard error of C) for every p within the error of the order.
    within_error: Vec<[f64; 3]>,
    /// The same at the best p.
    best: [f64; 3],
}

/// Relative error of the power law itself, added to the error of each observation.
const REMAINDER: f64 = 0.05;
/// Chi-square per degree of freedom above which the law does not fit: either coarse steps do not
/// follow it yet, or no power law holds.
const MISFIT: f64 = 3.0;
/// The orders that are tried: p = 0.01 i.
const ORDERS: std::ops::RangeInclusive<i32> = 10..=300;
/// C must differ from zero by at least this many standard errors.
const RESOLVED: f64 = 3.0;

impl Law {
    /// Fit the law to the changes between neighbouring steps (coarse to fine) and to the bias at
    /// the finest step,
    ///
    /// ```text
    /// S(h) - S(h/2) = C h^p (1 - 2^-p),    S(finest) - reference = C finest^p
    /// ```
    ///
    /// by least squares. For each p the best C has a closed form, then the best p is chosen; its
    /// error is where chi-square has risen by one. The coarsest steps are left out until the rest
    /// fits. `None` if nothing fits, or if C is not resolved.
    pub fn fit(changes: &[Change], finest: f64, finest_bias: Number) -> Option<Law> {
        // At least three observations are needed for the two parameters.
        (0..changes.len().saturating_sub(1))
            .find_map(|first| Law::fit_all(&changes[first..], finest, finest_bias))
    }

    fn fit_all(changes: &[Change], finest: f64, finest_bias: Number) -> Option<Law> {
        let at = |p: f64| {
            let mut sums = [0.0; 3]; // The sums of y^2, g y and g^2 over squared errors, where y = C g.
            let mut add = |y: Number, g: f64| {
                let weight = (y.error.powi(2) + (REMAINDER * y.value).powi(2)).recip();
                for (sum, term) in sums.iter_mut().zip([y.value * y.value, g * y.value, g * g]) {
                    *sum += weight * term;
                }
            };
            changes
                .iter()
                .for_each(|c| add(c.change, c.h.powf(p) * (1.0 - 2f64.powf(-p))));
            add(finest_bias, finest.powf(p));
            let [yy, gy, gg] = sums;
            (yy - gy * gy / gg, [p, gy / gg, gg.sqrt().recip()])
        };
        let fits: Vec<(f64, [f64; 3])> = ORDERS.map(|i| at(0.01 * f64::from(i))).collect();
        let (least, best) = fits.iter().copied().min_by(|a, b| a.0.total_cmp(&b.0))?;
        let freedom = (changes.len() + 1 - 2) as f64;
        let is_inside = best[0] > fits[0].1[0] && best[0] < fits[fits.len() - 1].1[0];
        let is_resolved = best[1].abs() > RESOLVED * best[2];
        if !(least <= MISFIT * freedom && is_inside && is_resolved) {
            return None;
        }
        // If the fit is worse than expected by chance, the errors are increased accordingly.
        let inflation = (least / freedom).max(1.0);
        let within_error: Vec<_> = fits
            .iter()
            .filter(|(chi, _)| *chi <= least + inflation)
            .map(|(_, [p, c, e])| [*p, *c, e * inflation.sqrt()])
            .collect();
        let reach = within_error
            .iter()
            .map(|[p, ..]| (p - best[0]).abs())
            .fold(0.0, f64::max);
        let order = Number {
            value: best[0],
            error: reach,
        };
        Some(Law {
            order,
            coarsest: changes[0].h,
            within_error,
            best,
        })
    }

    /// C h^p, with an error from the errors of both parameters.
    pub fn bias(&self, h: f64) -> Number {
        let at = |[p, c, _]: [f64; 3]| c * h.powf(p);
        let value = at(self.best);
        let of_order = self
            .within_error
            .iter()
            .map(|fit| (at(*fit) - value).abs())
            .fold(0.0, f64::max);
        let [p, _, error] = self.best;
        Number {
            value,
            error: of_order.hypot(error * h.powf(p)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid(bias: impl Fn(f64) -> f64, error: f64) -> (Vec<Change>, f64, Number) {
        let steps: Vec<f64> = (0..8).map(|k| 0.1 * 0.5f64.powi(k)).collect();
        let number = |value| Number { value, error };
        let changes = steps
            .iter()
            .map(|&h| Change {
                h,
                change: number(bias(h) - bias(h / 2.0)),
            })
            .collect();
        let finest = steps[7] / 2.0;
        (changes, finest, number(bias(finest)))
    }

    #[test]
    fn a_power_is_found_and_carried_on() {
        for (c, p) in [(2.4, 0.5), (-0.17, 1.0), (0.3, 2.0)] {
            let (changes, finest, finest_bias) = grid(|h| c * h.powf(p), 1e-9);
            let law = Law::fit(&changes, finest, finest_bias).expect("a law");
            assert!((law.order.value - p).abs() < 0.011, "{law:?}");
            let beyond = law.bias(1e-5);
            assert!(
                (beyond.value / (c * 1e-5f64.powf(p)) - 1.0).abs() < 0.06,
                "{beyond:?}"
            );
        }
    }

    #[test]
    fn steps_that_are_too_coarse_for_the_law_are_left_out() {
        // A bias like that of the corrected scheme: flat for coarse steps, of order one for fine
        // ones.
        let (changes, finest, finest_bias) = grid(|h| -h / (1.0 + (h / 0.01).powi(2)).sqrt(), 1e-6);
        let law = Law::fit(&changes, finest, finest_bias).expect("a law");
        assert!(
            (law.order.value - 1.0).abs() < 0.05 && law.coarsest < 0.01,
            "{law:?}"
        );
    }

    #[test]
    fn what_is_not_resolved_or_not_a_power_has_no_law() {
        let (changes, finest, finest_bias) = grid(|h| 1e-3 * h, 1e-2);
        assert_eq!(Law::fit(&changes, finest, finest_bias), None);
        let (changes, finest, finest_bias) = grid(|h| h * (1.0 / h).sin(), 1e-9);
        assert_eq!(Law::fit(&changes, finest, finest_bias), None);
    }
}
