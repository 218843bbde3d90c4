//! Global minimum of a rugged function of a few variables, by differential evolution.
//!
//! Storn and Price, *Differential evolution*, Journal of Global Optimization 11 (1997), in the form
//! current-to-best/1 with a random scale. If a function has many minima of nearly equal depth, a
//! population stops in one of them. The search is then repeated in a smaller box around the best
//! point found, until no better point is found.

use stickslip::noise::Stream;

/// Number of candidates per variable.
const CANDIDATES: usize = 20;

/// Largest number of generations of a population.
const GENERATIONS: usize = 150;

/// Largest number of repeated searches.
const REPEATS: u32 = 8;

/// Width of the box of a repeated search, relative to the first box.
const REPEAT_WIDTH: f64 = 0.1;

/// The search ends after this many populations in a row that found nothing better.
const ENOUGH: u32 = 2;

/// A value counts as better if it is lower by this share of the best value.
const BETTER: f64 = 1e-5;

/// Share of the trials that use `leap`.
const LEAPS: f64 = 0.05;

/// Seed of the random numbers.
const SEED: u64 = 0xD1FF;

/// The interval of each number.
type Box<const N: usize> = [[f64; 2]; N];

/// A point, and the value of the function there.
type Found<const N: usize> = ([f64; N], f64);

/// The lowest point found in a box, with its value; `None` if the search was stopped. The number
/// `start` determines the random numbers.
///
/// `leap` takes a point and a number from -1 to 1, and returns another point where the function may
/// be equally low. It is needed for minima that lie side by side, because mixing the points of one
/// of them does not find the other.
pub fn lowest<const N: usize>(
    bounds: &Box<N>,
    start: u64,
    leap: impl Fn([f64; N], f64) -> [f64; N],
    f: impl Fn(&[f64; N]) -> f64,
    is_stopped: impl Fn() -> bool,
) -> Option<Found<N>> {
    let mut random = Stream::new(SEED, start);
    let mut best = population(bounds, &mut random, &leap, &f, &is_stopped)?;
    let mut in_vain = 0;
    for _ in 0..REPEATS {
        let near = std::array::from_fn(|k| {
            let [low, high] = bounds[k];
            let half = 0.5 * REPEAT_WIDTH * (high - low);
            [(best.0[k] - half).max(low), (best.0[k] + half).min(high)]
        });
        let next = population(&near, &mut random, &leap, &f, &is_stopped)?;
        in_vain = if next.1 < best.1 * (1.0 - BETTER) {
            0
        } else {
            in_vain + 1
        };
        if next.1 < best.1 {
            best = next;
        }
        if in_vain == ENOUGH {
            break;
        }
    }
    Some(best)
}

/// One search in a box, until all points of the population are about equally low.
fn population<const N: usize>(
    bounds: &Box<N>,
    random: &mut Stream,
    leap: &impl Fn([f64; N], f64) -> [f64; N],
    f: &impl Fn(&[f64; N]) -> f64,
    is_stopped: &impl Fn() -> bool,
) -> Option<Found<N>> {
    let mut anywhere = || {
        let x = std::array::from_fn(|k| {
            bounds[k][0] + (bounds[k][1] - bounds[k][0]) * random.uniform()
        });
        (x, f(&x))
    };
    let mut all: Vec<Found<N>> = (0..CANDIDATES * N).map(|_| anywhere()).collect();
    let lower = |a: Found<N>, b: Found<N>| if b.1 < a.1 { b } else { a };
    let lowest = |all: &[Found<N>]| all.iter().copied().fold(all[0], lower);
    for _ in 0..GENERATIONS {
        if is_stopped() {
            return None;
        }
        let best = lowest(&all);
        let worst = all.iter().map(|found| found.1).fold(best.1, f64::max);
        if worst - best.1 <= 0.1 * BETTER * best.1.abs() {
            break;
        }
        for i in 0..all.len() {
            let mut other = || all[(random.uniform() * all.len() as f64) as usize].0;
            let (a, b) = (other(), other());
            let (scale, towards) = (0.5 + 0.5 * random.uniform(), 0.25 * random.uniform());
            let (x, value) = all[i];
            let wanted: [f64; N] = if random.uniform() < LEAPS {
                leap(best.0, 2.0 * random.uniform() - 1.0)
            } else {
                std::array::from_fn(|k| {
                    let moved = x[k] + towards * (best.0[k] - x[k]) + scale * (a[k] - b[k]);
                    if random.uniform() < 0.9 { moved } else { x[k] }
                })
            };
            let trial = std::array::from_fn(|k| wanted[k].clamp(bounds[k][0], bounds[k][1]));
            let found = f(&trial);
            if found <= value {
                all[i] = (trial, found);
            }
        }
    }
    Some(lowest(&all))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rastrigin's function has a hundred minima in this box; the lowest is at (0.3, -0.7).
    #[test]
    fn the_lowest_of_many_valleys_is_found() {
        let rugged = |x: &[f64; 2]| {
            let valley = |x: f64| x * x + 10.0 * (1.0 - libm::cos(std::f64::consts::TAU * x));
            1.0 + valley(x[0] - 0.3) + valley(x[1] + 0.7)
        };
        for start in 0..10 {
            let (at, value) =
                lowest(&[[-5.0, 5.0]; 2], start, |x, _| x, rugged, || false).expect("not stopped");
            assert!(
                (value - 1.0).abs() < 1e-3,
                "start {start}: {value} at {at:?}"
            );
        }
    }
}
