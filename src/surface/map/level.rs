//! Levelling: a smooth surface, fitted by least squares, is subtracted, and with it tilt, bow and offset of
//! the measurement.

use super::{HeightMap, MapError};
use crate::math::linalg::symmetric_eigen;

/// Most terms of a surface that is subtracted.
const TERMS: usize = 6;
/// Smallest eigenvalue of the normal equations over the largest at which the heights still determine the
/// surface.
const DETERMINED: f64 = 1e-9;

/// The surface that is subtracted from a map.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Levelling {
    /// The mean.
    None,
    /// The plane of least squares.
    #[default]
    Plane,
    /// The quadratic surface of least squares.
    Quadratic,
}

impl Levelling {
    /// All of them, by name.
    pub const ALL: [(&'static str, Self); 3] =
        [("none", Self::None), ("plane", Self::Plane), ("quadratic", Self::Quadratic)];

    /// The name on the command line and in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Plane => "plane",
            Self::Quadratic => "quadratic",
        }
    }

    /// The subtracted surface in words.
    pub fn surface(self) -> &'static str {
        match self {
            Self::None => "mean",
            Self::Plane => "plane of least squares",
            Self::Quadratic => "quadratic surface of least squares",
        }
    }

    fn terms(self) -> usize {
        match self {
            Self::None => 1,
            Self::Plane => 3,
            Self::Quadratic => TERMS,
        }
    }
}

impl HeightMap {
    /// The map less the surface of least squares through its known heights, all of equal weight: heights
    /// above the mean plane.
    ///
    /// # Errors
    /// [`MapError::Undetermined`] when the known heights do not determine the surface, [`MapError::Flat`]
    /// when nothing is left.
    pub fn levelled(mut self, levelling: Levelling) -> Result<Self, MapError> {
        let (pixels, missing) = (self.heights.len(), self.missing());
        let undetermined =
            || MapError::Undetermined { known: pixels - missing, pixels, surface: levelling.surface() };
        // Twice: the second fit, of what the first has left, takes its rounding away.
        for _ in 0..2 {
            let coefficients = self.fitted(levelling.terms()).ok_or_else(undetermined)?;
            self.subtract(&coefficients);
        }
        let highest = self.heights.iter().fold(0.0_f64, |highest, height| highest.max(height.abs()));
        if highest > self.resolution { Ok(self) } else { Err(MapError::Flat) }
    }

    /// Coefficients of the first `terms` terms by the normal equations, summed row by row.
    fn fitted(&self, terms: usize) -> Option<Vec<f64>> {
        let (mut matrix, mut right) = ([0.0; TERMS * TERMS], [0.0; TERMS]);
        for row in 0..self.rows {
            let (mut row_matrix, mut row_right) = ([0.0; TERMS * TERMS], [0.0; TERMS]);
            for (column, height) in self.row(row).iter().enumerate().filter(|(_, height)| !height.is_nan()) {
                let basis = self.basis(row, column);
                for i in 0..terms {
                    row_right[i] += basis[i] * height;
                    for j in 0..=i {
                        row_matrix[i * terms + j] += basis[i] * basis[j];
                    }
                }
            }
            matrix.iter_mut().zip(row_matrix).for_each(|(sum, of_row)| *sum += of_row);
            right.iter_mut().zip(row_right).for_each(|(sum, of_row)| *sum += of_row);
        }
        for i in 0..terms {
            for j in 0..i {
                matrix[j * terms + i] = matrix[i * terms + j];
            }
        }
        let eigen = symmetric_eigen(&matrix[..terms * terms], terms)?;
        if !(eigen.values[terms - 1] > DETERMINED * eigen.values[0]) {
            return None;
        }
        let mut coefficients = vec![0.0; terms];
        for (value, vector) in eigen.values.iter().zip(&eigen.vectors) {
            let component = vector.iter().zip(&right).map(|(v, r)| v * r).sum::<f64>() / value;
            coefficients.iter_mut().zip(vector).for_each(|(sum, v)| *sum += component * v);
        }
        Some(coefficients)
    }

    fn subtract(&mut self, coefficients: &[f64]) {
        for place in 0..self.heights.len() {
            let basis = self.basis(place / self.columns, place % self.columns);
            self.heights[place] -= coefficients.iter().zip(basis).map(|(c, b)| c * b).sum::<f64>();
        }
    }

    /// 1, u, v, u², uv, v² with u and v from −1 to 1 over the columns and over the rows.
    fn basis(&self, row: usize, column: usize) -> [f64; TERMS] {
        let centred = |index: usize, count: usize| 2.0 * index as f64 / (count - 1) as f64 - 1.0;
        let (u, v) = (centred(column, self.columns), centred(row, self.rows));
        [1.0, u, v, u * u, u * v, v * v]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A wave with as many periods as the map has columns and rows to spare, on an offset that is a million
    /// times larger, a tilt and a bow.
    fn map(bow: f64) -> HeightMap {
        let heights = (0..40 * 50).map(|i| {
            let (y, x) = (f64::from(i / 50), f64::from(i % 50));
            1e-3 + 2e-9 * x - 3e-9 * y
                + bow * (x - 7.0) * (y + 3.0)
                + 1e-9 * (2.1 * x).sin() * (1.7 * y).cos()
        });
        HeightMap::new(heights.collect(), [40, 50], [2e-9, 1e-9]).unwrap()
    }

    /// The rest is orthogonal to what was subtracted, and levelling it once more changes nothing.
    #[test]
    fn what_is_left_is_orthogonal_to_what_was_subtracted() {
        for (levelling, bow) in [(Levelling::Plane, 0.0), (Levelling::Quadratic, 1e-10)] {
            let mut map = map(bow);
            map.heights[777] = f64::NAN;
            let levelled = map.levelled(levelling).unwrap();
            let highest = levelled.heights.iter().fold(0.0_f64, |highest, z| highest.max(z.abs()));
            assert!(highest < 1.3e-9, "{levelling:?}: {highest:e}");
            for term in 0..levelling.terms() {
                let known = levelled.heights.iter().enumerate().filter(|(_, z)| !z.is_nan());
                let product: f64 = known.map(|(i, z)| z * levelled.basis(i / 50, i % 50)[term]).sum();
                assert!(product.abs() < 2000.0 * 1e-22, "{levelling:?}, term {term}: {product:e}");
            }
            assert!(levelled.heights[777].is_nan());
        }
        // A plane leaves the bow.
        let bowed = map(1e-10).levelled(Levelling::Plane).unwrap();
        assert!(bowed.heights.iter().any(|z| z.abs() > 2e-8));
    }

    #[test]
    fn without_levelling_the_mean_is_subtracted() {
        let (map, levelled) = (map(0.0), map(0.0).levelled(Levelling::None).unwrap());
        let mean = map.heights.iter().sum::<f64>() / 2000.0;
        assert!(map.heights.iter().zip(&levelled.heights).all(|(a, b)| (a - mean - b).abs() < 1e-17));
    }

    #[test]
    fn what_determines_no_plane_is_refused() {
        let mut line = map(0.0);
        line.heights.iter_mut().enumerate().filter(|(i, _)| i % 50 != 4).for_each(|(_, z)| *z = f64::NAN);
        let error = line.levelled(Levelling::Plane).unwrap_err();
        assert_eq!(
            error,
            MapError::Undetermined { known: 40, pixels: 2000, surface: "plane of least squares" }
        );
        let none = HeightMap::new(vec![f64::NAN; 64], [8, 8], [1e-9; 2]).unwrap();
        assert!(matches!(none.levelled(Levelling::None), Err(MapError::Undetermined { known: 0, .. })));
        let tilted = (0..100).map(|i| 1e-3 + 1e-7 * f64::from(i % 10) - 3e-8 * f64::from(i / 10)).collect();
        let tilted = HeightMap::new(tilted, [10, 10], [1e-9; 2]).unwrap();
        assert_eq!(tilted.levelled(Levelling::Plane), Err(MapError::Flat));
    }
}
