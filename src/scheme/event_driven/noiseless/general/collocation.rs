//! A step of a slip by collocation at the nodes of Radau (Hairer and Wanner, *Solving Ordinary
//! Differential Equations II*, IV.5), for a body that is damped so strongly that 2 alpha/m is far
//! faster than all other rates.
//!
//! The motion is a polynomial that obeys the equation of motion at each of n nodes, the last of
//! which is the end of the step. It is found by Newton's method, with the slopes of all forces at
//! the start of the step. So the length of a step follows from the forces and not from the
//! relaxation time of the velocity.

use super::super::super::work::{Resolved, WorkLeft};
use super::super::dense_output::Kinematics;
use super::slip_motion::SlipMotion;

/// The largest number of nodes.
const MOST: usize = 9;

/// The numbers of nodes, and the factor from one step to the next where that number was enough.
const NODES: [(usize, f64); 4] = [(3, 4.0), (5, 4.0), (7, 2.0), (MOST, 1.0)];

/// Newton steps; where the slopes at the start are those of the whole step, two suffice.
const MOST_STEPS: usize = 12;

/// The last Newton step, as a fraction of the error that is allowed.
const SETTLED: f64 = 0.02;

/// Newton steps must become shorter by this factor.
const APPROACH: f64 = 0.7;

/// The displacement and speed from which the slopes of a force are computed, relatively.
const ASIDE: f64 = 1e-7;

/// Collocation is used if damping is this many times faster than any other change, and than the
/// run.
const STIFF: (f64, f64) = (20.0, 1e4);

/// The rules for a strongly damped body.
#[derive(Clone, Debug)]
pub struct Collocation {
    rules: Vec<Rule>,
    /// 2 alpha/m.
    damping_rate: f64,
    /// The rate from which on damping is strong.
    strong_rate: f64,
}

/// The forces at the start of a step.
#[derive(Clone, Copy)]
pub struct ForceScale {
    /// The sizes of all forces, divided by m.
    pub size: f64,
    /// The time in which damping settles the velocity, if it is strong; infinite otherwise.
    pub settling_time: f64,
}

/// A rule with some nodes.
#[derive(Clone, Debug)]
struct Rule {
    nodes: Vec<f64>,
    /// The integrals from 0 to each node of the polynomial that is 1 at one node and 0 at the others.
    integrals: [[f64; MOST]; MOST],
}

impl Collocation {
    /// The rules for a body with this 2 alpha/m, beside the fastest of all other rates, in a run
    /// until `end`.
    pub fn new(damping_rate: f64, others: f64, end: f64) -> Self {
        Collocation {
            rules: NODES.iter().map(|(n, _)| Rule::new(*n)).collect(),
            damping_rate,
            strong_rate: (STIFF.0 * others).max(STIFF.1 / end),
        }
    }

    /// Whether 2 alpha alone damps the body strongly.
    pub fn is_always_used(&self) -> bool {
        self.damping_rate > self.strong_rate
    }

    /// The forces at a state. Damping is strong because of 2 alpha, or of a force that falls steeply
    /// with x' there.
    pub fn scale(
        &self,
        slip: &SlipMotion<'_>,
        from: &Kinematics,
        work: &mut WorkLeft,
    ) -> Resolved<ForceScale> {
        let size = slip.size(from);
        let speed = from.velocity.abs() + size / self.strong_rate;
        let rate = self
            .damping_rate
            .max(-slope_by_velocity(slip, from, speed, work)?);
        let settling_time = if rate > self.strong_rate {
            1.0 / rate
        } else {
            f64::INFINITY
        };
        Ok(ForceScale {
            size,
            settling_time,
        })
    }

    /// The increments of x and x' in a step, and the factor to the next step; none if they do not
    /// converge.
    pub fn increments(
        &self,
        slip: &SlipMotion<'_>,
        from: &Kinematics,
        h: f64,
        scale: ForceScale,
        work: &mut WorkLeft,
    ) -> Resolved<Option<([f64; 2], f64)>> {
        let Kinematics {
            after,
            displacement: x,
            velocity: v,
            acceleration,
        } = *from;
        let speed = v.abs() + scale.size * scale.settling_time;
        let dx = slip.direction.value() * ASIDE * (x.abs() + speed * scale.settling_time);
        let by_x = (slip.acceleration(x + dx, v, after, work)? - acceleration) / dx;
        let slopes = [by_x, slope_by_velocity(slip, from, speed, work)?];
        let mut last: Option<([f64; 2], [f64; MOST], &Rule)> = None;
        for (rule, (_, growth)) in self.rules.iter().zip(NODES) {
            let mut rises = [0.0; MOST];
            if let Some((_, known, coarser)) = &last {
                for (rise, node) in rises.iter_mut().zip(&rule.nodes) {
                    *rise = coarser.at(known, *node);
                }
            }
            let Some(best) = rule.solve(slip, from, h, (scale, slopes), &mut rises, work)? else {
                return Ok(None);
            };
            if last.is_some_and(|(coarse, ..)| slip.error(from, h, scale, [best, coarse]) <= 1.0) {
                return Ok(Some((best, growth)));
            }
            last = Some((best, rises, rule));
        }
        Ok(None)
    }
}

/// The derivative of x'' by x' at a state, where x' changes by about this speed.
fn slope_by_velocity(
    slip: &SlipMotion<'_>,
    from: &Kinematics,
    speed: f64,
    work: &mut WorkLeft,
) -> Resolved<f64> {
    let dv = slip.direction.value() * ASIDE * speed;
    let Kinematics {
        after,
        displacement,
        velocity,
        acceleration,
    } = *from;
    let aside = slip.acceleration(displacement, velocity + dv, after, work)?;
    Ok((aside - acceleration) / dv)
}

impl Rule {
    fn new(n: usize) -> Self {
        // The nodes are the zeros of P_n - P_{n-1}, and 1 is the last of them.
        let off = |u: f64| legendre(n, 2.0 * u - 1.0) - legendre(n - 1, 2.0 * u - 1.0);
        let grid = |i: u32| f64::from(i) / f64::from(GRID);
        let turns = (0..GRID - 1).filter(|&i| off(grid(i)) * off(grid(i + 1)) <= 0.0);
        let mut nodes: Vec<f64> = turns.map(|i| zero(off, grid(i), grid(i + 1))).collect();
        nodes.push(1.0);
        let weight = |u: f64| u / (n as f64 * legendre(n - 1, 2.0 * u - 1.0)).powi(2);
        let mut integrals = [[0.0; MOST]; MOST];
        for (row, to) in integrals.iter_mut().zip(&nodes) {
            for (j, entry) in row.iter_mut().enumerate().take(n) {
                let terms = nodes
                    .iter()
                    .map(|u| to * weight(*u) * cardinal(&nodes, j, to * u));
                *entry = terms.sum();
            }
        }
        Rule { nodes, integrals }
    }

    /// The interpolation of these values at the nodes, and 0 at the start.
    fn at(&self, values: &[f64; MOST], u: f64) -> f64 {
        let terms = self
            .nodes
            .iter()
            .enumerate()
            .map(|(j, node)| values[j] * cardinal(&self.nodes, j, u) * u / node);
        terms.sum()
    }

    /// The integral from the start to a node.
    fn integral(&self, i: usize, values: &[f64; MOST]) -> f64 {
        self.integrals[i]
            .iter()
            .zip(values)
            .map(|(a, value)| a * value)
            .sum()
    }

    /// The increments of x and x' in a step, from a first guess of those of x' at the nodes; none if
    /// they do not converge.
    fn solve(
        &self,
        slip: &SlipMotion<'_>,
        from: &Kinematics,
        h: f64,
        (scale, [by_x, by_v]): (ForceScale, [f64; 2]),
        rises: &mut [f64; MOST],
        work: &mut WorkLeft,
    ) -> Resolved<Option<[f64; 2]>> {
        let n = self.nodes.len();
        let mut matrix = [[0.0; MOST]; MOST];
        for (i, row) in matrix.iter_mut().enumerate().take(n) {
            for (j, macro_step) in row.iter_mut().enumerate().take(n) {
                let twice: f64 = (0..n)
                    .map(|k| self.integrals[i][k] * self.integrals[k][j])
                    .sum();
                *macro_step =
                    f64::from(i == j) - h * (self.integrals[i][j] * by_v + h * twice * by_x);
            }
        }
        let mut previous = f64::INFINITY;
        for _ in 0..MOST_STEPS {
            let mut accelerations = [0.0; MOST];
            for (i, node) in self.nodes.iter().enumerate() {
                let way = h * (node * from.velocity + self.integral(i, rises));
                let (x, v) = (from.displacement + way, from.velocity + rises[i]);
                accelerations[i] = slip.acceleration(x, v, from.after + node * h, work)?;
            }
            let mut off = [0.0; MOST];
            for (i, off) in off.iter_mut().enumerate().take(n) {
                *off = h * self.integral(i, &accelerations) - rises[i];
            }
            let change = solved(matrix, off, n);
            for (rise, change) in rises.iter_mut().zip(change) {
                *rise += change;
            }
            let increments = |rises: &[f64; MOST]| {
                [
                    h * (from.velocity + self.integral(n - 1, rises)),
                    rises[n - 1],
                ]
            };
            let farthest = change
                .into_iter()
                .fold(0.0, |most: f64, change| most.max(change.abs()));
            let best = increments(rises);
            let error = slip.error(
                from,
                h,
                scale,
                [best, [best[0] - h * farthest, best[1] - farthest]],
            );
            if error <= SETTLED {
                return Ok(Some(best));
            }
            if error.is_nan() || error > APPROACH * previous {
                return Ok(None);
            }
            previous = error;
        }
        Ok(None)
    }
}

/// The intervals in which nodes are searched.
const GRID: u32 = 1000;

/// P_n.
fn legendre(n: usize, x: f64) -> f64 {
    let (mut before, mut here) = (1.0, x);
    for k in 1..n {
        let k = k as f64;
        (before, here) = (here, ((2.0 * k + 1.0) * x * here - k * before) / (k + 1.0));
    }
    if n == 0 { 1.0 } else { here }
}

/// The zero between two places, by bisection.
fn zero(of: impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    let at_low = of(low);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        *(if of(middle) * at_low > 0.0 {
            &mut low
        } else {
            &mut high
        }) = middle;
    }
    0.5 * (low + high)
}

/// The polynomial that is 1 at the j-th node and 0 at the others.
fn cardinal(nodes: &[f64], j: usize, u: f64) -> f64 {
    let others = nodes.iter().enumerate().filter(|(k, _)| *k != j);
    others
        .map(|(_, node)| (u - node) / (nodes[j] - node))
        .product()
}

/// The solution of n linear equations, by elimination with pivots.
fn solved(mut matrix: [[f64; MOST]; MOST], mut right: [f64; MOST], n: usize) -> [f64; MOST] {
    for i in 0..n {
        let pivot = (i..n)
            .max_by(|a, b| matrix[*a][i].abs().total_cmp(&matrix[*b][i].abs()))
            .unwrap_or(i);
        matrix.swap(i, pivot);
        right.swap(i, pivot);
        for k in i + 1..n {
            let share = matrix[k][i] / matrix[i][i];
            let above = matrix[i];
            for (macro_step, above) in matrix[k].iter_mut().zip(above) {
                *macro_step -= share * above;
            }
            right[k] -= share * right[i];
        }
    }
    for i in (0..n).rev() {
        let known: f64 = (i + 1..n).map(|j| matrix[i][j] * right[j]).sum();
        right[i] = (right[i] - known) / matrix[i][i];
    }
    right
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The rule of n nodes integrates powers up to 2 n - 2 exactly, and on the way those up to n - 1.
    #[test]
    fn the_nodes_integrate_powers_exactly() {
        for (n, _) in NODES {
            let rule = Rule::new(n);
            assert_eq!(rule.nodes.len(), n);
            for power in 0..2 * n as i32 - 1 {
                let mut values = [0.0; MOST];
                for (value, node) in values.iter_mut().zip(&rule.nodes) {
                    *value = node.powi(power);
                }
                for (i, node) in rule.nodes.iter().enumerate() {
                    let off =
                        rule.integral(i, &values) - node.powi(power + 1) / f64::from(power + 1);
                    assert!(
                        off.abs() < 1e-14 || (power as usize >= n && i + 1 < n),
                        "{n} {power} {i}: {off:e}"
                    );
                }
            }
        }
    }
}
