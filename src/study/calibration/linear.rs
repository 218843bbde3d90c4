//! Least squares with few unknowns.

/// The normal equations of weighted rows.
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
    /// Of a matrix, of which the lower half is enough, and a right side.
    pub fn of(matrix: [[f64; N]; N], right: [f64; N]) -> Self {
        Normal { matrix, right }
    }

    /// A row: what y should be a combination of.
    #[inline(always)]
    pub fn add(&mut self, row: [f64; N], y: f64, weight: f64) {
        for i in 0..N {
            for j in 0..=i {
                self.matrix[i][j] += weight * row[i] * row[j];
            }
            self.right[i] += weight * row[i] * y;
        }
    }

    /// The coefficients, by Cholesky's factors; none where the rows do not tell them.
    pub fn solve(&self) -> Option<[f64; N]> {
        let mut factor = [[0.0; N]; N];
        for i in 0..N {
            for j in 0..=i {
                let known: f64 = (0..j).map(|k| factor[i][k] * factor[j][k]).sum();
                let rest = self.matrix[i][j] - known;
                if i == j {
                    if rest <= 1e-12 * self.matrix[i][i] || rest.is_nan() {
                        return None;
                    }
                    factor[i][i] = rest.sqrt();
                } else {
                    factor[i][j] = rest / factor[j][j];
                }
            }
        }
        let mut x = self.right;
        for i in 0..N {
            let known: f64 = (0..i).map(|k| factor[i][k] * x[k]).sum();
            x[i] = (x[i] - known) / factor[i][i];
        }
        for i in (0..N).rev() {
            let known: f64 = (i + 1..N).map(|k| factor[k][i] * x[k]).sum();
            x[i] = (x[i] - known) / factor[i][i];
        }
        Some(x)
    }
}
