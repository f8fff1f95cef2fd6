//! The linear algebra of the joint test and of the control variates, by faer, in a fixed order of operations.

use faer::linalg::solvers::Solve;
use faer::{Mat, Par, Side};

/// Symmetric eigenvalues and eigenvectors.
#[derive(Clone, Debug)]
pub struct Eigen {
    /// Falling eigenvalues.
    pub values: Vec<f64>,
    /// `vectors[i]` belongs to `values[i]`, unit length; the sign makes its largest component positive.
    pub vectors: Vec<Vec<f64>>,
}

/// faer may split work by threads, which would make bits depend on their number.
fn sequential() {
    faer::set_global_parallelism(Par::Seq);
}

/// The eigendecomposition of a symmetric matrix, row-major, n × n; `None` when it does not converge (not finite).
pub fn symmetric_eigen(matrix: &[f64], n: usize) -> Option<Eigen> {
    sequential();
    if n == 0 || matrix.iter().any(|x| !x.is_finite()) {
        return None;
    }
    let eigen = Mat::from_fn(n, n, |i, j| matrix[i * n + j]).self_adjoint_eigen(Side::Lower).ok()?;
    let (values, vectors) = (eigen.S().column_vector(), eigen.U());
    let vector = |column: usize| {
        let raw: Vec<f64> = (0..n).map(|row| vectors[(row, column)]).collect();
        let largest = raw.iter().fold(0.0_f64, |best, x| if x.abs() > best.abs() { *x } else { best });
        let sign = if largest < 0.0 { -1.0 } else { 1.0 };
        raw.into_iter().map(|x| sign * x).collect()
    };
    Some(Eigen { values: (0..n).rev().map(|i| values[i]).collect(), vectors: (0..n).rev().map(vector).collect() })
}

/// Functionals that are uncorrelated and of unit variance when `covariance`, row-major, n × n, is that of what they act on: its
/// eigenvectors over the roots of the eigenvalues, largest first, of all eigenvalues that are at least `smallest` of the largest.
/// There are fewer than n of them where components are collinear, and none when the matrix is not finite.
pub fn whitening(covariance: &[f64], n: usize, smallest: f64) -> Vec<Vec<f64>> {
    let Some(eigen) = symmetric_eigen(covariance, n) else { return Vec::new() };
    let limit = (smallest * eigen.values[0]).max(f64::MIN_POSITIVE);
    let kept = eigen.values.iter().zip(&eigen.vectors).filter(|(value, _)| **value >= limit);
    kept.map(|(value, vector)| vector.iter().map(|x| x / value.sqrt()).collect()).collect()
}

/// xᵀ M⁻¹ x for a symmetric positive definite matrix, row-major, n × n; `None` when it is not.
pub fn inverse_quadratic_form(matrix: &[f64], x: &[f64]) -> Option<f64> {
    sequential();
    let n = x.len();
    let factor = Mat::from_fn(n, n, |i, j| matrix[i * n + j]).llt(Side::Lower).ok()?;
    let right = Mat::from_fn(n, 1, |i, _| x[i]);
    let solved = factor.solve(&right);
    Some((0..n).map(|i| x[i] * solved[(i, 0)]).sum())
}

/// RᵀR of a matrix of `rows` rows, row-major, each `n` long: n × n, row-major.
pub fn gram(rows: &[f64], n: usize) -> Vec<f64> {
    sequential();
    let count = rows.len().checked_div(n).unwrap_or(0);
    let matrix = faer::MatRef::from_row_major_slice(rows, count, n);
    let product = matrix.transpose() * matrix;
    (0..n * n).map(|i| product[(i / n, i % n)]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_known_matrix_is_decomposed() {
        let eigen = symmetric_eigen(&[2.0, 1.0, 1.0, 2.0], 2).unwrap();
        assert!((eigen.values[0] - 3.0).abs() < 1e-14 && (eigen.values[1] - 1.0).abs() < 1e-14);
        let half = 0.5_f64.sqrt();
        assert!((eigen.vectors[0][0] - half).abs() < 1e-14 && (eigen.vectors[0][1] - half).abs() < 1e-14);
        assert!(symmetric_eigen(&[f64::NAN], 1).is_none());
    }

    #[test]
    fn what_is_collinear_is_left_out_of_a_whitening() {
        // The third is the sum of the first two, which have variances 4 and 1 and covariance 1.
        let covariance = [4.0, 1.0, 5.0, 1.0, 1.0, 2.0, 5.0, 2.0, 7.0];
        let functionals = whitening(&covariance, 3, 1e-9);
        assert_eq!(functionals.len(), 2);
        for (i, a) in functionals.iter().enumerate() {
            for (j, b) in functionals.iter().enumerate() {
                let product: f64 = (0..9).map(|k| a[k / 3] * covariance[k] * b[k % 3]).sum();
                assert!((product - f64::from(u8::from(i == j))).abs() < 1e-12, "{i} {j}: {product}");
            }
        }
        assert!(whitening(&[0.0], 1, 1e-9).is_empty() && whitening(&[f64::NAN], 1, 1e-9).is_empty());
    }

    #[test]
    fn a_quadratic_form_is_inverted() {
        let form = inverse_quadratic_form(&[4.0, 1.0, 1.0, 3.0], &[1.0, 2.0]).unwrap();
        assert!((form - 15.0 / 11.0).abs() < 1e-14, "{form}");
        assert!(inverse_quadratic_form(&[1.0, 2.0, 2.0, 1.0], &[1.0, 1.0]).is_none());
    }

    #[test]
    fn a_gram_matrix_is_formed() {
        assert_eq!(gram(&[1.0, 2.0, 3.0, 4.0], 2), [10.0, 14.0, 14.0, 20.0]);
    }
}
