//! Symmetric matrices of a few rows, by Cholesky factors: regressions, inverses, and correlated
//! draws.
//!
//! Rows are arrays, which is fast, where their number is known at compile time, and vectors
//! elsewhere.

/// Write L of A = L L^T into `factor`. Only the lower triangle of A is read. `None` if A is not
/// positive definite.
#[inline(always)]
fn factorise<R: AsRef<[f64]> + AsMut<[f64]>>(a: &[R], mut factor: impl AsMut<[R]>) -> Option<()> {
    let factor = factor.as_mut();
    for i in 0..a.len() {
        for j in 0..=i {
            let known: f64 = (0..j).map(|k| factor[i].as_ref()[k] * factor[j].as_ref()[k]).sum();
            let rest = a[i].as_ref()[j] - known;
            if i == j {
                if rest <= 1e-12 * a[i].as_ref()[i] || rest.is_nan() {
                    return None;
                }
                factor[i].as_mut()[i] = rest.sqrt();
            } else {
                factor[i].as_mut()[j] = rest / factor[j].as_ref()[j];
            }
        }
    }
    Some(())
}

/// Solve L L^T x = b; `x` holds b at first and the solution at the end.
#[inline(always)]
fn substitute<R: AsRef<[f64]>>(factor: &[R], x: &mut [f64]) {
    let n = x.len();
    for i in 0..n {
        let known: f64 = (0..i).map(|k| factor[i].as_ref()[k] * x[k]).sum();
        x[i] = (x[i] - known) / factor[i].as_ref()[i];
    }
    for i in (0..n).rev() {
        let known: f64 = (i + 1..n).map(|k| factor[k].as_ref()[i] * x[k]).sum();
        x[i] = (x[i] - known) / factor[i].as_ref()[i];
    }
}

/// The normal equations of a weighted least-squares fit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Normal<const N: usize> {
    matrix: [[f64; N]; N],
    right: [f64; N],
}

impl<const N: usize> Default for Normal<N> {
    fn default() -> Self {
        Normal { matrix: [[0.0; N]; N], right: [0.0; N] }
    }
}

impl<const N: usize> Normal<N> {
    /// The normal equations with this matrix, of which only the lower triangle is read, and this
    /// right side.
    pub fn of(matrix: [[f64; N]; N], right: [f64; N]) -> Self {
        Normal { matrix, right }
    }

    /// Add an observation: `y` should equal the coefficients times `row`.
    #[inline(always)]
    pub fn add(&mut self, row: [f64; N], y: f64, weight: f64) {
        for i in 0..N {
            for j in 0..=i {
                self.matrix[i][j] += weight * row[i] * row[j];
            }
            self.right[i] += weight * row[i] * y;
        }
    }

    /// The coefficients; `None` if the observations do not determine them.
    pub fn solve(&self) -> Option<[f64; N]> {
        let mut factor = [[0.0; N]; N];
        factorise(&self.matrix, &mut factor)?;
        let mut x = self.right;
        substitute(&factor, &mut x);
        Some(x)
    }
}

/// A square matrix, row by row.
pub type Matrix = Vec<Vec<f64>>;

/// L of A = L L^T. Only the lower triangle of A is read. `None` if A is not positive definite.
pub fn cholesky(a: &Matrix) -> Option<Matrix> {
    let mut factor = vec![vec![0.0; a.len()]; a.len()];
    factorise(a, &mut factor)?;
    Some(factor)
}

/// The solution x of L L^T x = b.
pub fn solve(factor: &Matrix, b: &[f64]) -> Vec<f64> {
    let mut x = b.to_vec();
    substitute(factor, &mut x);
    x
}

/// The inverse of L L^T.
pub fn inverse(factor: &Matrix) -> Matrix {
    let n = factor.len();
    (0..n).map(|i| solve(factor, &(0..n).map(|j| f64::from(u8::from(i == j))).collect::<Vec<_>>())).collect()
}

/// The product L x.
pub fn times(factor: &Matrix, x: &[f64]) -> Vec<f64> {
    factor.iter().map(|row| row.iter().zip(x).map(|(a, b)| a * b).sum()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_system_solved_by_hand() {
        // [[4, 2], [2, 3]] x = [8, 7] has the solution x = [5/4, 3/2], and the inverse is [[3, -2],
        // [-2, 4]]/8.
        let factor = cholesky(&vec![vec![4.0, 2.0], vec![2.0, 3.0]]).expect("positive");
        let x = solve(&factor, &[8.0, 7.0]);
        assert!((x[0] - 1.25).abs() < 1e-15 && (x[1] - 1.5).abs() < 1e-15, "{x:?}");
        let inverse = inverse(&factor);
        let expected = [[0.375, -0.25], [-0.25, 0.5]];
        assert!((0..2).all(|i| (0..2).all(|j| (inverse[i][j] - expected[i][j]).abs() < 1e-15)), "{inverse:?}");
        assert_eq!(cholesky(&vec![vec![1.0, 2.0], vec![2.0, 1.0]]), None);
        let back = times(&factor, &[1.0, 0.0]);
        assert!((back[0] - 2.0).abs() < 1e-15 && (back[1] - 1.0).abs() < 1e-15);
    }
}
