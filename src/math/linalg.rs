//! The linear algebra of the joint test, by faer, in a fixed order of operations.

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
