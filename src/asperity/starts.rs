//! Parameters from which solves start, for any λ: bicubic polynomials over a column coordinate, the logarithm of λ,
//! and a place on the branch.
//!
//! A column of cells is made when its λ is first met, by solves on the safeguarded path; it depends on nothing
//! else, so all surfaces share it.

use crate::math::chebyshev;
use std::sync::OnceLock;

/// Points of a cell along either of its sides.
const POINTS: usize = 4;
/// Coefficients of a cell: the powers of the place on the branch, for each power of the column coordinate.
type Cell = [[f64; POINTS]; POINTS];

/// A table of starting values over a column coordinate x in 0..columns and a place in 0..1.
pub(super) struct Starts {
    columns: Vec<OnceLock<Vec<Cell>>>,
    rows: usize,
    sample: Box<dyn Fn(f64, f64) -> f64 + Send + Sync>,
}

impl Starts {
    /// A table of `columns` × `rows` cells of `sample`(x, place).
    pub fn new(
        columns: usize,
        rows: usize,
        sample: impl Fn(f64, f64) -> f64 + Send + Sync + 'static,
    ) -> Self {
        Self { columns: (0..columns).map(|_| OnceLock::new()).collect(), rows, sample: Box::new(sample) }
    }

    #[inline(always)]
    fn column(&self, column: usize) -> &[Cell] {
        match self.columns[column].get() {
            Some(cells) => cells,
            None => self.make(column),
        }
    }

    #[cold]
    fn make(&self, column: usize) -> &[Cell] {
        self.columns[column].get_or_init(|| (0..self.rows).map(|row| self.cell(column, row)).collect())
    }

    fn cell(&self, column: usize, row: usize) -> Cell {
        let node = |i: usize| 0.5 * (1.0 + libm::cos(chebyshev::angle(i, POINTS)));
        let powers = |samples: [f64; POINTS]| chebyshev::powers::<POINTS>(&chebyshev::coefficients(&samples));
        let along: Cell = std::array::from_fn(|i| {
            let x = column as f64 + node(i);
            powers(std::array::from_fn(|j| (self.sample)(x, (row as f64 + node(j)) / self.rows as f64)))
        });
        let across: Cell = std::array::from_fn(|j| powers(std::array::from_fn(|i| along[i][j])));
        std::array::from_fn(|i| std::array::from_fn(|j| across[j][i]))
    }

    /// The value at a column coordinate and a place; NaN beyond the table.
    #[inline(always)]
    pub fn value(&self, x: f64, place: f64) -> f64 {
        let s = place * self.rows as f64;
        // What is no number is 0 as an integer.
        let (column, row) = (x as usize, s as usize);
        if (column >= self.columns.len()) | (row >= self.rows) | !(x >= 0.0) | !(s >= 0.0) {
            return f64::NAN;
        }
        let cell = &self.column(column)[row];
        let (v, t) = (2.0 * (x - column as f64) - 1.0, 2.0 * (s - row as f64) - 1.0);
        let mut sum = cell[POINTS - 1];
        for power in (0..POINTS - 1).rev() {
            sum = std::array::from_fn(|j| sum[j] * v + cell[power][j]);
        }
        sum[0] + t * sum[1] + t * t * (sum[2] + t * sum[3])
    }
}
