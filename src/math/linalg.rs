//! Linear algebra in a fixed order of operations.
//!
//! Products of long matrices are formed here, eigenvalues are by faer. faer's products split their sums by the
//! size of the caches where these have more than [`LARGEST`] terms, and with its feature `std` take a buffer
//! of twice the last cache, however small the matrices: so this feature is off, and no larger matrix is
//! decomposed.

use super::instruction_set::InstructionSet;
use faer::{Mat, Par, Side};

/// Most rows of a matrix that is decomposed: no sum within has more terms, and up to this number the products
/// of faer (`gemm`, the block of depth in `cache.rs`) are summed at once on every processor.
pub const LARGEST: usize = 512;
/// Columns of a panel of a matrix: its products with another panel stay in registers.
const PANEL: usize = 8;

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

/// The eigendecomposition of a symmetric matrix, row-major, n × n; `None` when it does not converge (not
/// finite).
pub fn symmetric_eigen(matrix: &[f64], n: usize) -> Option<Eigen> {
    sequential();
    debug_assert!(n <= LARGEST, "{n}");
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
    Some(Eigen {
        values: (0..n).rev().map(|i| values[i]).collect(),
        vectors: (0..n).rev().map(vector).collect(),
    })
}

/// The smallest real part of the eigenvalues of a matrix, given by its columns, of which only the first n numbers
/// count; NaN where they cannot be had.
pub fn smallest_real_part(columns: &[Vec<f64>]) -> f64 {
    sequential();
    let n = columns.len();
    let at = |i: usize, j: usize| columns[j].get(i).copied().unwrap_or(0.0);
    if n == 0 || n > LARGEST || columns.iter().flatten().any(|x| !x.is_finite()) {
        return f64::NAN;
    }
    let eigenvalues = Mat::from_fn(n, n, at).eigenvalues();
    eigenvalues.map_or(f64::NAN, |all| all.iter().map(|value| value.re).fold(f64::INFINITY, f64::min))
}

/// Functionals that are uncorrelated and of unit variance when `covariance`, row-major, n × n, is the
/// covariance of the vectors that they act on: its eigenvectors over the roots of the eigenvalues, largest
/// first, of all eigenvalues that are at least `smallest` of the largest. There are fewer than n of them
/// where components are collinear, and none when the matrix is not finite.
pub fn whitening(covariance: &[f64], n: usize, smallest: f64) -> Vec<Vec<f64>> {
    let Some(eigen) = symmetric_eigen(covariance, n) else { return Vec::new() };
    let limit = (smallest * eigen.values[0]).max(f64::MIN_POSITIVE);
    let kept = eigen.values.iter().zip(&eigen.vectors).filter(|(value, _)| **value >= limit);
    kept.map(|(value, vector)| vector.iter().map(|x| x / value.sqrt()).collect()).collect()
}

/// RᵀR of a matrix R of columns of the same length: n × n, row-major. Each element is one sum from the first
/// row to the last.
pub fn gram(columns: &[Vec<f64>]) -> Vec<f64> {
    let n = columns.len();
    let panels: Vec<Vec<[f64; PANEL]>> = columns.chunks(PANEL).map(panel).collect();
    let mut product = vec![0.0; n * n];
    for (i, left) in panels.iter().enumerate() {
        for (j, right) in panels.iter().enumerate().take(i + 1) {
            let tile = InstructionSet::current().run(
                #[inline(always)]
                || products(left, right),
            );
            for (row, sums) in (i * PANEL..n).zip(&tile) {
                for (column, sum) in (j * PANEL..n).zip(sums) {
                    (product[row * n + column], product[column * n + row]) = (*sum, *sum);
                }
            }
        }
    }
    product
}

/// A few columns side by side, with zeros for those that are missing.
fn panel(columns: &[Vec<f64>]) -> Vec<[f64; PANEL]> {
    let row = |i: usize| std::array::from_fn(|c| columns.get(c).map_or(0.0, |column| column[i]));
    (0..columns[0].len()).map(row).collect()
}

/// Products of the columns of two panels.
#[allow(clippy::needless_range_loop)]
#[inline(always)]
fn products(left: &[[f64; PANEL]], right: &[[f64; PANEL]]) -> [[f64; PANEL]; PANEL] {
    let mut sums = [[0.0; PANEL]; PANEL];
    for (left, right) in left.iter().zip(right) {
        // Rows by number: by iterators some builds keep the sums in memory, which takes 2.6 times as long.
        for i in 0..PANEL {
            for j in 0..PANEL {
                sums[i][j] += left[i] * right[j];
            }
        }
    }
    sums
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
        // A share of the largest, however large that is.
        for (values, kept) in [([100.0, 1e-3], 1), ([100.0, 0.1], 2), ([1e-3, 1e-8], 1), ([1e-3, 1e-6], 2)] {
            assert_eq!(whitening(&[values[0], 0.0, 0.0, values[1]], 2, 1e-4).len(), kept, "{values:?}");
        }
    }

    /// faer's products of matrices of up to LARGEST rows sum each element from the first term to the last, as
    /// no splitting of sums does: so nothing in a decomposition depends on the sizes of caches.
    #[test]
    fn products_within_decompositions_are_not_split() {
        let element = |i: usize, j: usize| libm::sin((i * 517 + j * 29) as f64);
        for (rows, columns) in [(LARGEST, LARGEST), (40, 24), (LARGEST, 8), (96, 3)] {
            let left = Mat::from_fn(rows, LARGEST, element);
            let right = Mat::from_fn(LARGEST, columns, |i, j| element(j, i + 1));
            sequential();
            let product = &left * &right;
            for (i, j) in (0..rows).step_by(7).flat_map(|i| (0..columns).map(move |j| (i, j))) {
                let add = |sum: f64, k: usize| sum + left[(i, k)] * right[(k, j)];
                assert_eq!(product[(i, j)], (0..LARGEST).fold(0.0, add), "{i} {j}");
            }
        }
    }

    #[test]
    fn a_gram_matrix_is_formed() {
        assert_eq!(gram(&[vec![1.0, 3.0], vec![2.0, 4.0]]), [10.0, 14.0, 14.0, 20.0]);
        // Of integers every order has the same sum.
        let columns: Vec<Vec<f64>> =
            (0..19).map(|c| (0..7).map(|i| f64::from((c * 5 + i * i * 3) % 11)).collect()).collect();
        let product =
            |i: usize| columns[i / 19].iter().zip(&columns[i % 19]).map(|(x, y)| x * y).sum::<f64>();
        assert_eq!(gram(&columns), (0..19 * 19).map(product).collect::<Vec<f64>>());
    }
}
