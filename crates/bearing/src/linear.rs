//! Symmetric matrices of a few rows, by Cholesky factors: regressions, inverses, and correlated
//! draws.

/// A square matrix, row by row.
pub type Matrix = Vec<Vec<f64>>;

/// The normal equations of a weighted least-squares fit. Only the lower triangle of the matrix is
/// used.
#[derive(Clone, Debug, PartialEq)]
pub struct Normal {
    pub matrix: Matrix,
    pub right: Vec<f64>,
}

impl Normal {
    /// The equations of this number of coefficients, without any observation.
    pub fn of(coefficients: usize) -> Self {
        Normal {
            matrix: vec![vec![0.0; coefficients]; coefficients],
            right: vec![0.0; coefficients],
        }
    }

    /// Add an observation: `y` should equal the coefficients times `row`.
    pub fn add(&mut self, row: &[f64], y: f64, weight: f64) {
        for i in 0..row.len() {
            for j in 0..=i {
                self.matrix[i][j] += weight * row[i] * row[j];
            }
            self.right[i] += weight * row[i] * y;
        }
    }

    /// The coefficients; `None` if the observations do not determine them.
    pub fn solve(&self) -> Option<Vec<f64>> {
        Some(solve(&cholesky(&self.matrix)?, &self.right))
    }
}

/// L of A = L L^T. Only the lower triangle of A is read. `None` if A is not positive definite.
pub fn cholesky(a: &[Vec<f64>]) -> Option<Matrix> {
    let mut factor = vec![vec![0.0; a.len()]; a.len()];
    for i in 0..a.len() {
        for j in 0..=i {
            let known: f64 = (0..j).map(|k| factor[i][k] * factor[j][k]).sum();
            let rest = a[i][j] - known;
            if i == j {
                if rest <= 1e-12 * a[i][i] || rest.is_nan() {
                    return None;
                }
                factor[i][i] = rest.sqrt();
            } else {
                factor[i][j] = rest / factor[j][j];
            }
        }
    }
    Some(factor)
}

/// The solution x of L L^T x = b.
pub fn solve(factor: &Matrix, b: &[f64]) -> Vec<f64> {
    let (mut x, n) = (b.to_vec(), b.len());
    for i in 0..n {
        let known: f64 = (0..i).map(|k| factor[i][k] * x[k]).sum();
        x[i] = (x[i] - known) / factor[i][i];
    }
    for i in (0..n).rev() {
        let known: f64 = (i + 1..n).map(|k| factor[k][i] * x[k]).sum();
        x[i] = (x[i] - known) / factor[i][i];
    }
    x
}

/// The inverse of L L^T.
pub fn inverse(factor: &Matrix) -> Matrix {
    let n = factor.len();
    (0..n)
        .map(|i| {
            solve(
                factor,
                &(0..n)
                    .map(|j| f64::from(u8::from(i == j)))
                    .collect::<Vec<_>>(),
            )
        })
        .collect()
}

/// The product L x.
pub fn times(factor: &Matrix, x: &[f64]) -> Vec<f64> {
    factor
        .iter()
        .map(|row| row.iter().zip(x).map(|(a, b)| a * b).sum())
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_system_solved_by_hand() {
        // [[4, 2], [2, 3]] x = [8, 7] has the solution x = [5/4, 3/2], and the inverse is [[3, -2],
        // [-2, 4]]/8.
        let factor = cholesky(&[vec![4.0, 2.0], vec![2.0, 3.0]]).expect("positive");
        let x = solve(&factor, &[8.0, 7.0]);
        assert!(
            (x[0] - 1.25).abs() < 1e-15 && (x[1] - 1.5).abs() < 1e-15,
            "{x:?}"
        );
        let inverse = inverse(&factor);
        let expected = [[0.375, -0.25], [-0.25, 0.5]];
        assert!(
            (0..2).all(|i| (0..2).all(|j| (inverse[i][j] - expected[i][j]).abs() < 1e-15)),
            "{inverse:?}"
        );
        assert_eq!(cholesky(&[vec![1.0, 2.0], vec![2.0, 1.0]]), None);
        let back = times(&factor, &[1.0, 0.0]);
        assert!((back[0] - 2.0).abs() < 1e-15 && (back[1] - 1.0).abs() < 1e-15);
    }
}
