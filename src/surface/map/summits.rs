//! Summits: pixels that are higher than their 8 neighbours (Greenwood 1984, Proc. R. Soc. Lond. A 393, 133).

use super::HeightMap;

/// A summit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Summit {
    /// The row.
    pub row: usize,
    /// The column.
    pub column: usize,
    /// Height of its pixel above the mean plane of the surface, m.
    pub height: f64,
    /// −∂²z/∂y² and −∂²z/∂x² there by the pixels on either side, (2z − z₋ − z₊)/pixel², 1/m; positive.
    pub curvature: [f64; 2],
    /// −∂²z/∂x∂y there by the four pixels at the corners, (z₊₋ + z₋₊ − z₊₊ − z₋₋)/(4 dx dy), 1/m.
    pub twist: f64,
}

impl Summit {
    /// Mean curvature κ, 1/m.
    pub fn mean_curvature(&self) -> f64 {
        0.5 * (self.curvature[0] + self.curvature[1])
    }

    /// Radius 1/κ, m.
    pub fn radius(&self) -> f64 {
        1.0 / self.mean_curvature()
    }

    /// Principal curvatures κ₁ ≥ κ₂, 1/m: the eigenvalues of the matrix of second derivatives, which are the
    /// curvatures of the surface where it is level. The second is not positive where the pixels along a
    /// slanting direction rise: a saddle, of which the 8 neighbours are lower none the less.
    pub fn principal_curvatures(&self) -> [f64; 2] {
        let [along_y, along_x] = self.curvature;
        let sharp = self.mean_curvature() + (0.5 * (along_x - along_y)).hypot(self.twist);
        // The product is the determinant: the difference of mean and root would lose the digits of a ridge.
        [sharp, (along_x * along_y - self.twist * self.twist) / sharp]
    }

    /// Radius for laws of spheres, m: the geometric mean of the principal radii, 1/√(κ₁κ₂), with which a sphere
    /// has the adhesion of the ellipsoid exactly where Derjaguin's approximation holds, and its Hertz force
    /// [nearly](super::forces_of_spheres). For a saddle it is the radius of the mean curvature.
    pub fn equivalent_radius(&self) -> f64 {
        let [sharp, blunt] = self.principal_curvatures();
        if blunt > 0.0 { 1.0 / (sharp.sqrt() * blunt.sqrt()) } else { self.radius() }
    }
}

/// The summits of a map.
///
/// # Examples
/// ```
/// use stiction::surface::map::{HeightMap, Summit, Summits};
///
/// # let wave = std::f64::consts::PI / 8.0;
/// # let height = |k: i32| 1e-9 * (wave * f64::from(k / 64)).cos() * (wave * f64::from(k % 64)).cos();
/// # let map = HeightMap::new((0..64 * 64).map(height).collect(), [64, 64], [1e-8, 1e-8])?;
/// // An egg box: every summit is 1 nm high.
/// let Summits { summits, compared } = map.summits();
/// assert_eq!((summits.len(), compared), (25, 62 * 62));
/// let is_high = |summit: &Summit| (summit.height / 1e-9 - 1.0).abs() < 1e-9;
/// assert!(summits.iter().all(is_high));
/// # Ok::<(), stiction::surface::map::MapError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Summits {
    /// Row by row.
    pub summits: Vec<Summit>,
    /// Pixels that were compared: those whose own height and whose 8 neighbours' are known, the border left
    /// out.
    pub compared: usize,
}

impl HeightMap {
    /// The pixels that are higher than each of their 8 neighbours by more than rounding. Pixels of the
    /// border, of a smoothed map those within half a cut-off of it, and those next to a missing height are not
    /// compared, and their area does not count; plateaus of equally high pixels are no summits.
    pub fn summits(&self) -> Summits {
        let (mut summits, mut compared) = (Vec::new(), 0);
        let [rows, columns] = self.searched(1);
        for row in rows {
            let [above, here, below] = [row - 1, row, row + 1].map(|row| self.row(row));
            for column in columns.clone() {
                let height = here[column];
                let (left, right) = (here[column - 1], here[column + 1]);
                let around = [
                    above[column - 1],
                    above[column],
                    above[column + 1],
                    left,
                    right,
                    below[column - 1],
                    below[column],
                    below[column + 1],
                ];
                if height.is_nan() || around.iter().any(|height| height.is_nan()) {
                    continue;
                }
                compared += 1;
                if around.iter().all(|neighbour| height - neighbour > self.resolution) {
                    let [dy, dx] = self.pixel;
                    let bend = |before: f64, after: f64| (height - before) + (height - after);
                    let curvature =
                        [bend(above[column], below[column]) / (dy * dy), bend(left, right) / (dx * dx)];
                    let rising =
                        (above[column - 1] - above[column + 1]) + (below[column + 1] - below[column - 1]);
                    let twist = -0.25 * rising / (dx * dy);
                    summits.push(Summit { row, column, height, curvature, twist });
                }
            }
        }
        Summits { summits, compared }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A flat map with raised pixels.
    fn map(raised: &[(usize, usize, f64)]) -> HeightMap {
        let mut heights = vec![0.0; 90];
        raised.iter().for_each(|(row, column, height)| heights[row * 10 + column] = *height);
        HeightMap::new(heights, [9, 10], [2e-9, 1e-9]).unwrap()
    }

    #[test]
    fn a_summit_is_higher_than_all_eight() {
        let found = map(&[(3, 4, 1e-9), (6, 7, 2e-9)]).summits();
        assert_eq!(found.compared, 7 * 8);
        let places: Vec<(usize, usize)> =
            found.summits.iter().map(|summit| (summit.row, summit.column)).collect();
        assert_eq!(places, [(3, 4), (6, 7)]);
        let summit = found.summits[0];
        assert!(
            (summit.curvature[0] / 5e8 - 1.0).abs() < 1e-15
                && (summit.curvature[1] / 2e9 - 1.0).abs() < 1e-15
        );
        assert!((summit.radius() * 1.25e9 - 1.0).abs() < 1e-15);
        // Each of the neighbours can take it away, by being as high.
        for (i, j) in (2..5).flat_map(|i| (3..6).map(move |j| (i, j))).filter(|place| *place != (3, 4)) {
            assert!(map(&[(3, 4, 1e-9), (i, j, 1e-9)]).summits().summits.is_empty(), "{i}, {j}");
        }
        // What is higher by rounding only is not higher.
        assert!(map(&[(3, 4, 1.0), (3, 5, 1.0 - 1e-15)]).summits().summits.is_empty());
        assert_eq!(map(&[(3, 4, 1.0), (3, 5, 1.0 - 1e-13)]).summits().summits.len(), 1);
    }

    /// z = −(x'²/R₁ + y'²/R₂)/2 about a pixel, turned by any angle, with pixels that are not square: second
    /// differences of a parabola are exact.
    #[test]
    fn ellipsoids_have_their_curvatures_at_any_angle() {
        let (dy, dx) = (1.5e-9, 1e-9);
        for (blunt_radius, step) in [(1.0, 0.0), (1.7, 0.3), (3.0, 1.0), (20.0, 2.4), (3.0, 1.58), (5.0, 3.0)]
        {
            let (sharp, blunt) = (1.0 / 50e-9, 1.0 / (blunt_radius * 50e-9));
            let (sin, cos) = f64::sin_cos(step);
            let height = |i: i32| {
                let (x, y) = (f64::from(i % 11 - 5) * dx, f64::from(i / 11 - 4) * dy);
                let (along, across) = (cos * x + sin * y, cos * y - sin * x);
                -0.5 * (sharp * along * along + blunt * across * across)
            };
            let map = HeightMap::new((0..99).map(height).collect(), [9, 11], [dy, dx]).unwrap();
            let found = map.summits().summits;
            let [summit] = found[..] else { panic!("{found:?}") };
            assert_eq!((summit.row, summit.column), (4, 5));
            let principal = summit.principal_curvatures();
            let close =
                |value: f64, exact: f64| assert!((value / exact - 1.0).abs() < 1e-12, "{value:e} {exact:e}");
            close(principal[0], sharp);
            close(principal[1], blunt);
            close(summit.radius(), 2.0 / (sharp + blunt));
            close(summit.equivalent_radius(), 1.0 / (sharp * blunt).sqrt());
            let twist = (sharp - blunt) * sin * cos;
            assert!((summit.twist - twist).abs() < 1e-13 * sharp, "{:e} {twist:e}", summit.twist);
        }
    }

    /// Higher than its 8 neighbours, and yet a saddle: two of the corners are nearly as high.
    #[test]
    fn a_saddle_may_be_higher_than_all_eight() {
        let map = map(&[
            (4, 4, 1e-9),
            (3, 3, 0.99e-9),
            (5, 5, 0.99e-9),
            (4, 3, 0.9e-9),
            (4, 5, 0.9e-9),
            (3, 4, 0.9e-9),
            (5, 4, 0.9e-9),
            (3, 5, -3e-9),
            (5, 3, -3e-9),
        ]);
        let summit = map.summits().summits[0];
        let [sharp, blunt] = summit.principal_curvatures();
        assert!(sharp > 0.0 && blunt < 0.0, "{sharp:e} {blunt:e}");
        assert_eq!(summit.equivalent_radius(), summit.radius());
    }

    #[test]
    fn the_border_and_what_is_next_to_a_missing_height_are_not_compared() {
        assert!(map(&[(0, 4, 1e-9), (8, 2, 1e-9), (5, 0, 1e-9), (5, 9, 1e-9)]).summits().summits.is_empty());
        let found = map(&[(3, 4, 1e-9), (2, 5, f64::NAN), (6, 7, 1e-9)]).summits();
        assert_eq!((found.summits.len(), found.compared), (1, 56 - 9));
    }
}
