//! Small systems of linear equations, by factors of lower and upper triangles.

/// The factors of a matrix, for systems of a few unknowns.
#[derive(Clone, Debug)]
pub struct Lu {
    /// U, and L below its diagonal of ones, column by column.
    factors: Vec<f64>,
    /// The row that each row was exchanged with, one after the other.
    exchanges: Vec<usize>,
}

impl Lu {
    /// The factors of the n × n matrix of `element(row, column)`, by the largest pivots of columns.
    pub fn new(n: usize, element: impl Fn(usize, usize) -> f64) -> Self {
        let mut factors = Vec::with_capacity(n * n);
        for column in 0..n {
            factors.extend((0..n).map(|row| element(row, column)));
        }
        let mut exchanges = Vec::with_capacity(n);
        for k in 0..n {
            let size = |row: usize| factors[k * n + row].abs();
            let largest = (k + 1..n).fold(k, |best, row| if size(row) > size(best) { row } else { best });
            exchanges.push(largest);
            factors.chunks_exact_mut(n).for_each(|column| column.swap(k, largest));
            let (own, others) = factors[k * n..].split_at_mut(n);
            let (pivot, own) = own[k..].split_first_mut().expect("k is below n");
            // Of zeros alone a column is left as it is: the matrix is singular.
            if *pivot != 0.0 {
                let inverse = 1.0 / *pivot;
                own.iter_mut().for_each(|x| *x *= inverse);
                for other in others.chunks_exact_mut(n) {
                    let (first, rest) = other[k..].split_first_mut().expect("k is below n");
                    subtract(rest, *first, own);
                }
            }
        }
        Self { factors, exchanges }
    }

    /// The determinant.
    pub fn determinant(&self) -> f64 {
        let n = self.exchanges.len();
        let sign = |k: usize| if self.exchanges[k] == k { 1.0 } else { -1.0 };
        (0..n).map(|k| sign(k) * self.factors[k * n + k]).product()
    }

    /// The solution of a right-hand side; `None` where the matrix is singular.
    pub fn solved(&self, mut right: Vec<f64>) -> Option<Vec<f64>> {
        let n = self.exchanges.len();
        self.exchanges.iter().enumerate().for_each(|(k, other)| right.swap(k, *other));
        for (k, column) in self.factors.chunks_exact(n).enumerate() {
            let (own, below) = right[k..].split_first_mut().expect("k is below n");
            subtract(below, *own, &column[k + 1..]);
        }
        for (k, column) in self.factors.chunks_exact(n).enumerate().rev() {
            let (above, own) = right.split_at_mut(k);
            if column[k] == 0.0 {
                return None;
            }
            own[0] /= column[k];
            subtract(above, own[0], &column[..k]);
        }
        Some(right)
    }
}

/// x − factor · y in the place of x.
fn subtract(x: &mut [f64], factor: f64, y: &[f64]) {
    x.iter_mut().zip(y).for_each(|(x, y)| *x -= factor * y);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Inverse and determinant of a matrix that needs exchanges; a singular one has no solution.
    #[test]
    fn systems_are_solved() {
        let matrix = [[0.0, 2.0, 1.0], [1.0, 1.0, 0.0], [4.0, 0.0, 3.0]];
        let lu = Lu::new(3, |i, j| matrix[i][j]);
        assert!((lu.determinant() + 10.0).abs() < 1e-14, "{}", lu.determinant());
        for k in 0..3 {
            let solved = lu.solved((0..3).map(|i| f64::from(u8::from(i == k))).collect()).unwrap();
            for (i, row) in matrix.iter().enumerate() {
                let product: f64 = row.iter().zip(&solved).map(|(x, y)| x * y).sum();
                assert!((product - f64::from(u8::from(i == k))).abs() < 1e-15, "{i} {k}: {product}");
            }
        }
        let singular = Lu::new(3, |i, j| [[1.0, 2.0, 0.0], [2.0, 4.0, 0.0], [0.0, 1.0, 0.0]][i][j]);
        assert!(singular.determinant() == 0.0 && singular.solved(vec![1.0; 3]).is_none());
        let element =
            |i: usize, j: usize| libm::sin((i * 517 + j * 29) as f64) + if i == j { 2.0 } else { 0.0 };
        let exact: Vec<f64> = (0..150).map(|i| libm::cos(i as f64)).collect();
        let right = (0..150).map(|i| (0..150).map(|j| element(i, j) * exact[j]).sum()).collect();
        let solved = Lu::new(150, element).solved(right).unwrap();
        let worst = solved.iter().zip(&exact).map(|(x, y)| (x - y).abs()).fold(0.0, f64::max);
        assert!(worst < 1e-12, "{worst:e}");
    }
}
