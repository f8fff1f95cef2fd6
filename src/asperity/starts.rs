//! Starting points of solves for any λ: bicubic polynomials of the place on the branch and of a column coordinate that
//! depends on λ.
//!
//! A column of cells is made when its λ is first met, by solves on the safeguarded path; it depends on nothing
//! else, so all surfaces share it.

use crate::math::chebyshev;
use std::sync::OnceLock;

/// Points of a cell along either of its sides.
const POINTS: usize = 4;
/// Cells along a branch.
pub(super) const ROWS: usize = 24;
/// 1.5·2⁵²: what is added to it is rounded to a whole number, which is then in the low bits.
const ROUNDING: f64 = 6_755_399_441_055_744.0;

/// Coefficients of a cell: the powers of the place on the branch, for each power of the column coordinate.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
struct Cell([[f64; POINTS]; POINTS]);

/// The cells along a branch.
type Cells = [Cell; ROWS];

/// Makes a value of a column coordinate and a place.
type Sample = dyn Fn(f64, f64) -> f64 + Send + Sync;

/// A table of starting values over a column coordinate x in 0..columns and a place in 0..1.
pub(super) struct Starts {
    columns: Vec<OnceLock<Box<Cells>>>,
    sample: Box<Sample>,
}

/// The values of a table at one column coordinate.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Column {
    /// None beyond the table.
    cells: Option<&'static Cells>,
    /// The column coordinate in −1..1 of the cells.
    v: f64,
}

/// The cell of a place in 0..1, and where the place is in −1..1 of it; the nearest of other places.
#[inline(always)]
pub(super) fn cell_of(place: f64) -> (u32, f64) {
    let s = place * ROWS as f64 - 0.5;
    let shifted = s + ROUNDING;
    (shifted.to_bits() as u32, 2.0 * (s - (shifted - ROUNDING)))
}

impl Starts {
    /// A table of `columns` columns of `sample`(x, place).
    pub fn new(columns: usize, sample: impl Fn(f64, f64) -> f64 + Send + Sync + 'static) -> Self {
        Self { columns: (0..columns).map(|_| OnceLock::new()).collect(), sample: Box::new(sample) }
    }

    fn cell(&self, column: usize, row: usize) -> Cell {
        let node = |i: usize| 0.5 * (1.0 + libm::cos(chebyshev::angle(i, POINTS)));
        let powers = |samples: [f64; POINTS]| chebyshev::powers::<POINTS>(&chebyshev::coefficients(&samples));
        let along: [[f64; POINTS]; POINTS] = std::array::from_fn(|i| {
            let x = column as f64 + node(i);
            powers(std::array::from_fn(|j| (self.sample)(x, (row as f64 + node(j)) / ROWS as f64)))
        });
        let across: [[f64; POINTS]; POINTS] =
            std::array::from_fn(|j| powers(std::array::from_fn(|i| along[i][j])));
        Cell(std::array::from_fn(|i| std::array::from_fn(|j| across[j][i])))
    }

    /// The values at a column coordinate.
    pub fn column(&'static self, x: f64) -> Column {
        // NaN is 0 as an integer.
        let column = x as usize;
        if (column >= self.columns.len()) | !(x >= 0.0) {
            return Column::default();
        }
        let make = || Box::new(std::array::from_fn(|row| self.cell(column, row)));
        Column { cells: Some(self.columns[column].get_or_init(make)), v: 2.0 * (x - column as f64) - 1.0 }
    }
}

impl Column {
    /// The value at a place t in −1..1 of a cell; NaN beyond the table.
    #[inline(always)]
    pub fn value(&self, (row, t): (u32, f64)) -> f64 {
        let Some(cells) = self.cells else { return f64::NAN };
        let Cell(cell) = &cells[(row as usize).min(ROWS - 1)];
        let mut sum = cell[POINTS - 1];
        for power in (0..POINTS - 1).rev() {
            for j in 0..POINTS {
                sum[j] = sum[j] * self.v + cell[power][j];
            }
        }
        (sum[0] + t * sum[1]) + t * t * (sum[2] + t * sum[3])
    }
}
