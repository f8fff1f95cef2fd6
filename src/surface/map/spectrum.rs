//! Spectral moments of profiles, from differences of neighbouring pixels.

use super::{HeightMap, MapError};

/// Spectral moments of profiles along both directions (Nayak 1971, J. Lubr. Technol. 93, 398), and the shape
/// of the height distribution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpectralMoments {
    /// Mean square height m₀ over all known pixels within the [margin](HeightMap::margin), m².
    pub m0: f64,
    /// Mean square slope along y and along x, in the middle between neighbouring pixels, (z₊ − z)/pixel. Over
    /// two pixels its discretisation error would be four times as large.
    pub slope: [f64; 2],
    /// Mean square second derivative along y and along x, (z₊ − 2z + z₋)/pixel², 1/m².
    pub curvature: [f64; 2],
    /// Skewness of the heights; 0 for Gaussian ones.
    pub skewness: f64,
    /// Excess kurtosis of the heights; 0 for Gaussian ones.
    pub excess_kurtosis: f64,
}

impl SpectralMoments {
    /// Computes the moments of a levelled map.
    ///
    /// # Errors
    /// [`MapError::NoNeighbours`] when missing heights leave no slope or curvature.
    pub fn new(map: &HeightMap) -> Result<Self, MapError> {
        let [m0, third, fourth] = powers(map);
        let (mut slope, mut curvature) = ([0.0; 2], [0.0; 2]);
        for (direction, step) in [map.columns, 1].into_iter().enumerate() {
            let pixel = map.pixel[direction];
            let [(rises, pairs), (bends, triples)] = differences(map, step);
            if triples == 0 {
                return Err(MapError::NoNeighbours);
            }
            slope[direction] = rises / pairs as f64 / (pixel * pixel);
            curvature[direction] = bends / triples as f64 / (pixel * pixel) / (pixel * pixel);
        }
        let (skewness, excess_kurtosis) = (third / (m0 * m0.sqrt()), fourth / (m0 * m0) - 3.0);
        let moments = Self { m0, slope, curvature, skewness, excess_kurtosis };
        if moments.m2() > 0.0 && moments.m4() > 0.0 { Ok(moments) } else { Err(MapError::Flat) }
    }

    /// Mean square slope m₂ of profiles, over both directions.
    pub fn m2(&self) -> f64 {
        0.5 * (self.slope[0] + self.slope[1])
    }

    /// Mean square second derivative m₄ of profiles, over both directions, 1/m².
    pub fn m4(&self) -> f64 {
        0.5 * (self.curvature[0] + self.curvature[1])
    }

    /// Nayak's bandwidth parameter α = m₀m₄/m₂²; at least 3/2 for a random isotropic surface.
    pub fn alpha(&self) -> f64 {
        self.m0 * (self.m4() / self.m2()) / self.m2()
    }

    /// Mean distance between maxima of a profile, 2π√(m₂/m₄), m.
    pub fn wavelength(&self) -> f64 {
        2.0 * std::f64::consts::PI * (self.m2() / self.m4()).sqrt()
    }
}

/// Mean second, third and fourth powers of the known heights, m², m³, m⁴; summed row by row.
fn powers(map: &HeightMap) -> [f64; 3] {
    let (mut sums, mut known) = ([0.0; 3], 0_u64);
    let [rows, columns] = map.searched(0);
    for row in rows {
        let mut of_row = [0.0; 3];
        for height in map.row(row)[columns.clone()].iter().filter(|height| !height.is_nan()) {
            let square = height * height;
            [square, square * height, square * square]
                .iter()
                .zip(&mut of_row)
                .for_each(|(power, sum)| *sum += power);
            known += 1;
        }
        sums.iter_mut().zip(of_row).for_each(|(sum, of_row)| *sum += of_row);
    }
    sums.map(|sum| sum / known as f64)
}

/// Sums of (z₊ − z)² and of (z₊ − 2z + z₋)², m², each with its number of terms: all pixels of which the
/// heights are known. The neighbours are `step` places before and behind, 1 along the rows, or the columns of
/// the map along them.
fn differences(map: &HeightMap, step: usize) -> [(f64, u64); 2] {
    let mut sums = [(0.0, 0); 2];
    let [rows, columns] = map.searched(0);
    // The last has no neighbour behind it.
    let (down, along) = if step == 1 { (0, 1) } else { (1, 0) };
    for row in rows.start..rows.end - down {
        let mut of_row = [(0.0, 0); 2];
        let mut add = |sum: usize, difference: f64| {
            if !difference.is_nan() {
                of_row[sum].0 += difference * difference;
                of_row[sum].1 += 1;
            }
        };
        for column in columns.start..columns.end - along {
            let place = row * map.columns + column;
            let rise = map.heights[place + step] - map.heights[place];
            add(0, rise);
            if if step == 1 { column > columns.start } else { row > rows.start } {
                add(1, rise - (map.heights[place] - map.heights[place - step]));
            }
        }
        for (sum, of_row) in sums.iter_mut().zip(of_row) {
            *sum = (sum.0 + of_row.0, sum.1 + of_row.1);
        }
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::*;

    /// z = a cos(kx) cos(qy) over whole periods: the differences are exact multiples of the derivatives, 2
    /// sin(k dx/2)/dx for k and its square for k², and the mean squares of cosines over rows and columns are
    /// 1/2.
    #[test]
    fn differences_of_a_wave_are_those_of_its_frequency() {
        let (dy, dx, a) = (2e-9, 1e-9, 3e-9);
        let (q, k) = (2.0 * std::f64::consts::PI / (25.0 * dy), 2.0 * std::f64::consts::PI / (20.0 * dx));
        let wave = |i: u32| a * (k * dx * f64::from(i % 402)).cos() * (q * dy * f64::from(i / 402)).cos();
        // One pixel more on each side, so that the differences cover whole periods too.
        let map = HeightMap::new((0..402 * 502).map(wave).collect(), [502, 402], [dy, dx]).unwrap();
        let moments = SpectralMoments::new(&map).unwrap();
        // Along the other direction, 2 of 402 and 502 lines are more than whole periods.
        let close =
            |value: f64, exact: f64| assert!((value / exact - 1.0).abs() < 0.011, "{value:e} {exact:e}");
        close(moments.m0, a * a / 4.0);
        let of_frequency = |k: f64, dx: f64| 2.0 * (0.5 * k * dx).sin() / dx;
        close(moments.slope[1], a * a / 4.0 * of_frequency(k, dx).powi(2));
        close(moments.slope[0], a * a / 4.0 * of_frequency(q, dy).powi(2));
        close(moments.curvature[1], a * a / 4.0 * of_frequency(k, dx).powi(4));
        close(moments.curvature[0], a * a / 4.0 * of_frequency(q, dy).powi(4));
        close(moments.excess_kurtosis, 9.0 / 4.0 - 3.0);
        assert!(moments.skewness.abs() < 0.02, "{}", moments.skewness);
    }

    /// A missing height takes away the slopes and curvatures that need it, and no others.
    #[test]
    fn missing_heights_are_left_out() {
        let heights: Vec<f64> = (0..100).map(|i| 1e-9 * f64::from(i * i % 13)).collect();
        let map = HeightMap::new(heights, [10, 10], [1e-9; 2]).unwrap();
        let mut holed = map.clone();
        holed.heights[34] = f64::NAN;
        let counts = |map: &HeightMap, step: usize| differences(map, step).map(|(_, count)| count);
        assert_eq!((counts(&map, 1), counts(&map, 10)), ([90, 80], [90, 80]));
        assert_eq!((counts(&holed, 1), counts(&holed, 10)), ([88, 77], [88, 77]));
        let every_other = HeightMap {
            heights: map
                .heights
                .iter()
                .enumerate()
                .map(|(i, z)| if i % 2 == 0 { *z } else { f64::NAN })
                .collect(),
            ..map
        };
        assert_eq!(SpectralMoments::new(&every_other), Err(MapError::NoNeighbours));
    }
}
