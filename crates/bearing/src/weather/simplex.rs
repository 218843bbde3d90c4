//! The minimum of a smooth function of a few numbers, without derivatives.
//!
//! Nelder and Mead, *A simplex method for function minimization*, Computer Journal 7 (1965).

/// The lowest point found, and its value. The search begins at `start` with steps of length `step`,
/// and ends when the values of the simplex agree within `enough`. A value that is not a number
/// counts as infinite, and an infinite lowest value also ends the search.
pub fn lowest(
    start: &[f64],
    step: f64,
    enough: f64,
    mut f: impl FnMut(&[f64]) -> f64,
) -> (Vec<f64>, f64) {
    let n = start.len();
    let mut f = |x: &[f64]| {
        Some(f(x))
            .filter(|value| !value.is_nan())
            .unwrap_or(f64::INFINITY)
    };
    let mut all: Vec<(Vec<f64>, f64)> = (0..=n)
        .map(|i| {
            let mut x = start.to_vec();
            if i > 0 {
                x[i - 1] += step;
            }
            let value = f(&x);
            (x, value)
        })
        .collect();
    for _ in 0..MOST_STEPS {
        all.sort_by(|a, b| a.1.total_cmp(&b.1));
        let (best, worst) = (all[0].1, all[n].1);
        if !best.is_finite() || worst - best <= enough {
            break;
        }
        let centre: Vec<f64> = (0..n)
            .map(|k| all[..n].iter().map(|(x, _)| x[k]).sum::<f64>() / n as f64)
            .collect();
        let mut at = |share: f64| {
            let x: Vec<f64> = centre
                .iter()
                .zip(&all[n].0)
                .map(|(c, w)| c + share * (w - c))
                .collect();
            let value = f(&x);
            (x, value)
        };
        let reflected = at(-1.0);
        let next = if reflected.1 < best {
            let expanded = at(-2.0);
            Some(if expanded.1 < reflected.1 {
                expanded
            } else {
                reflected
            })
        } else if reflected.1 < all[n - 1].1 {
            Some(reflected)
        } else {
            let contracted = at(if reflected.1 < worst { -0.5 } else { 0.5 });
            (contracted.1 < worst.min(reflected.1)).then_some(contracted)
        };
        match next {
            Some(next) => all[n] = next,
            None => {
                let kept = all[0].0.clone();
                for (x, value) in &mut all[1..] {
                    x.iter_mut()
                        .zip(&kept)
                        .for_each(|(x, best)| *x = 0.5 * (*x + best));
                    *value = f(x);
                }
            }
        }
    }
    all.sort_by(|a, b| a.1.total_cmp(&b.1));
    all.swap_remove(0)
}

/// Largest number of steps, far more than are needed.
const MOST_STEPS: usize = 2000;

#[cfg(test)]
mod tests {
    use super::*;

    /// Infinity less infinity is not a number, and no step would make the values of the simplex
    /// agree.
    #[test]
    fn a_function_without_finite_values_is_given_up_at_once() {
        for nowhere in [f64::INFINITY, f64::NEG_INFINITY, f64::NAN] {
            let mut calls = 0;
            let (_, value) = lowest(&[0.0; 3], 0.5, 1e-9, |_| {
                calls += 1;
                nowhere
            });
            assert!(
                !value.is_finite() && calls == 4,
                "{nowhere}: {value} after {calls} calls"
            );
        }
        let beside = |x: &[f64]| {
            if x[0] < 0.5 {
                f64::NAN
            } else {
                (x[0] - 2.0).powi(2)
            }
        };
        let (x, value) = lowest(&[0.0], 1.0, 1e-12, beside);
        assert!((x[0] - 2.0).abs() < 1e-5 && value < 1e-10, "{x:?}");
    }

    /// Rosenbrock's function, which has a curved valley, in two and in four dimensions. Its minimum
    /// is where all coordinates are 1.
    #[test]
    fn the_end_of_a_curved_valley_is_found() {
        for n in [2, 4] {
            let valley = |x: &[f64]| {
                x.windows(2)
                    .map(|x| 100.0 * (x[1] - x[0] * x[0]).powi(2) + (1.0 - x[0]).powi(2))
                    .sum::<f64>()
            };
            let (x, value) = lowest(&vec![-0.5; n], 0.5, 1e-14, valley);
            assert!(
                value < 1e-10 && x.iter().all(|x| (x - 1.0).abs() < 1e-4),
                "{x:?}"
            );
        }
    }
}
