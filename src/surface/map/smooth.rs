//! Smoothing: an areal Gaussian filter takes away what is shorter than a cut-off wavelength, noise first.

use super::{HeightMap, MapError};
use crate::math::instruction_set::InstructionSet;
use rayon::prelude::*;
use std::f64::consts::{LN_2, PI};
use std::ops::RangeInclusive;

/// Least cut-off, pixels: waves that are shorter are not on a map.
const FEWEST_PIXELS: f64 = 2.0;
/// Largest cut-off over the shorter side of a map: half of it is then within the border.
const LARGEST_SHARE: f64 = 0.5;
/// Part of a cut-off along the border within which the weights are one-sided. A straight border at this
/// distance takes 0.4 % of them.
const BORDER: f64 = 0.5;
/// Cut-offs beyond which weights are left out: of a profile they are 2.6e-11 of all.
const REACH: f64 = 1.25;
/// Pixels that are summed side by side, in registers.
const LANES: usize = 32;

impl HeightMap {
    /// The cut-off wavelengths that the map can be smoothed with, m: from two pixels to half the shorter side.
    pub fn cutoffs(&self) -> RangeInclusive<f64> {
        FEWEST_PIXELS * self.pixel[0].max(self.pixel[1])..=LARGEST_SHARE * self.shorter_side()
    }

    /// The shorter side of the map, m.
    pub(super) fn shorter_side(&self) -> f64 {
        (self.rows as f64 * self.pixel[0]).min(self.columns as f64 * self.pixel[1])
    }

    /// The map less what is shorter than a cut-off wavelength λ, m: an areal Gaussian filter (ISO 16610-61)
    /// with the weight s(x, y) = exp(−π(x² + y²)/(α²λ²))/(α²λ²), α² = ln 2/π, by which a wave of length λ
    /// keeps half of its amplitude, and one of length ℓ the part 2^−(λ/ℓ)².
    ///
    /// Next to the border and missing heights the weights are normalised over the heights that are there, a
    /// Gaussian regression of order zero (ISO 16610-71). A missing height stays missing. Half a cut-off along
    /// the border, where the weights are one-sided, is left out of summits, spectral moments and areas
    /// ([`Self::within_border`]).
    ///
    /// The weights are values of the formula at the middle of pixels. With a cut-off of p pixels, from three
    /// on, a wave of its length keeps 2^−(p − 1)² of its amplitude more than half, to leading order.
    ///
    /// # Errors
    /// [`MapError::Cutoff`] when the cut-off is not within [`Self::cutoffs`].
    pub fn smoothed(&self, cutoff: f64) -> Result<Self, MapError> {
        let cutoffs = self.cutoffs();
        if !cutoffs.contains(&cutoff) {
            return Err(MapError::Cutoff { given: cutoff, least: *cutoffs.start(), most: *cutoffs.end() });
        }
        let kernels = self.pixel.map(|pixel| kernel(cutoff / pixel));
        let known: Vec<f64> = self.heights.iter().map(|z| if z.is_nan() { 0.0 } else { *z }).collect();
        let mut heights = self.convolved(known, &kernels);
        if self.missing() > 0 {
            let is_known = self.heights.iter().map(|z| if z.is_nan() { 0.0 } else { 1.0 }).collect();
            let weights = self.convolved(is_known, &kernels);
            heights.par_iter_mut().zip(&weights).for_each(|(height, weight)| *height /= weight);
            heights
                .par_iter_mut()
                .zip(&self.heights)
                .filter(|(_, z)| z.is_nan())
                .for_each(|(height, z)| *height = *z);
        } else {
            let [down, along] =
                [(self.rows, 0), (self.columns, 1)].map(|(count, side)| weights(count, &kernels[side]));
            heights.par_chunks_exact_mut(self.columns).zip(&down).for_each(|(row, down)| {
                row.iter_mut().zip(&along).for_each(|(height, along)| *height /= along * down)
            });
        }
        Ok(Self { heights, ..self.clone() }.within_border(cutoff))
    }

    /// The map, of which half a cut-off along the border, m, rounded up to pixels, is not searched for summits
    /// and has no part in spectral moments: that of a map which has been smoothed.
    pub fn within_border(self, cutoff: f64) -> Self {
        let margin = self.pixel.map(|pixel| (BORDER * cutoff / pixel * (1.0 - 1e-12)).ceil() as usize);
        Self { margin, ..self }
    }

    /// Heights, 0 where none is known, with the weights of both directions.
    fn convolved(&self, heights: Vec<f64>, kernels: &[Vec<f64>; 2]) -> Vec<f64> {
        let along = transposed(&rows_convolved(heights, self.columns, &kernels[1]), self.columns);
        transposed(&rows_convolved(along, self.rows, &kernels[0]), self.rows)
    }
}

/// The weights of the pixels from −reach to reach; a cut-off in pixels. Their sum is close to 1, but it is what
/// they are divided by that makes it 1.
fn kernel(cutoff: f64) -> Vec<f64> {
    let reach = (REACH * cutoff).ceil() as i64;
    let weight = |pixel: i64| {
        let distance = pixel as f64 / cutoff;
        libm::exp(-PI * PI / LN_2 * distance * distance)
    };
    (-reach..=reach).map(weight).collect()
}

/// The sum of the weights of known heights, for each of `count` pixels in a row.
fn weights(count: usize, kernel: &[f64]) -> Vec<f64> {
    rows_convolved(vec![1.0; count], count, kernel)
}

/// Convolves each row with a kernel; there is nothing beyond its ends.
fn rows_convolved(mut heights: Vec<f64>, columns: usize, kernel: &[f64]) -> Vec<f64> {
    let (reach, set) = (kernel.len() / 2, InstructionSet::current());
    let padded = columns.next_multiple_of(LANES) + 2 * reach;
    heights.par_chunks_exact_mut(columns).for_each_init(
        || vec![0.0; padded],
        |wide, row| {
            wide[reach..reach + columns].copy_from_slice(row);
            set.run(
                #[inline(always)]
                || {
                    for (block, out) in row.chunks_mut(LANES).enumerate() {
                        let from = &wide[block * LANES..block * LANES + LANES + 2 * reach];
                        let mut sums = [0.0; LANES];
                        for (weight, part) in kernel.iter().zip(from.windows(LANES)) {
                            sums.iter_mut().zip(part).for_each(|(sum, z)| *sum += weight * z);
                        }
                        out.iter_mut().zip(sums).for_each(|(z, sum)| *z = sum);
                    }
                },
            );
        },
    );
    heights
}

/// Rows for columns.
fn transposed(heights: &[f64], columns: usize) -> Vec<f64> {
    let rows = heights.len() / columns;
    let mut turned = vec![0.0; heights.len()];
    turned.par_chunks_mut(LANES * rows).enumerate().for_each(|(block, lines)| {
        let first = block * LANES;
        for (row, line) in heights.chunks_exact(columns).enumerate() {
            for (i, z) in line[first..(first + LANES).min(columns)].iter().enumerate() {
                lines[i * rows + row] = *z;
            }
        }
    });
    turned
}

#[cfg(test)]
mod tests {
    use super::*;

    fn map(shape: [usize; 2], pixel: [f64; 2], height: impl Fn(f64, f64) -> f64) -> HeightMap {
        let [rows, columns] = shape;
        let at = |i: usize| height((i % columns) as f64 * pixel[1], (i / columns) as f64 * pixel[0]);
        HeightMap::new((0..rows * columns).map(at).collect(), shape, pixel).unwrap()
    }

    /// exp(−πα²λ²/ℓ²) = 2^−(λ/ℓ)² in the interior, along x, along y and askew, with pixels that are not
    /// square: half at the cut-off.
    #[test]
    fn waves_keep_their_part() {
        let (pixel, cutoff) = ([1.5e-9, 1e-9], 20e-9);
        for (length, direction) in
            [(20e-9, 0.0), (20e-9, 0.5 * PI), (20e-9, 0.6), (40e-9, 0.3), (15e-9, 2.0), (10e-9, 1.1)]
        {
            let (kx, ky) = (2.0 * PI / length * f64::cos(direction), 2.0 * PI / length * f64::sin(direction));
            let wave = |x: f64, y: f64| 1e-9 * (kx * x + ky * y + 0.4).sin();
            let (given, smooth) =
                (map([80, 101], pixel, wave), map([80, 101], pixel, wave).smoothed(cutoff).unwrap());
            let part = 2.0_f64.powf(-(cutoff / length).powi(2));
            for row in 30..50 {
                for (a, b) in smooth.row(row)[30..70].iter().zip(&given.row(row)[30..70]) {
                    assert!((a - part * b).abs() < 2e-10 * 1e-9, "{length:e}: {a:e} {b:e}");
                }
            }
        }
    }

    /// A constant everywhere, with holes too; a plane where the weights are symmetric.
    #[test]
    fn constants_and_planes_are_kept() {
        let mut flat = map([60, 50], [1e-9, 2e-9], |_, _| 3e-9);
        flat.heights[..7].fill(f64::NAN);
        flat.heights[1234] = f64::NAN;
        let smooth = flat.smoothed(16e-9).unwrap();
        for (a, b) in smooth.heights.iter().zip(&flat.heights) {
            assert!(a.is_nan() && b.is_nan() || (a / b - 1.0).abs() < 1e-14, "{a:e} {b:e}");
        }
        assert_eq!((smooth.missing(), smooth.margin), (8, [8, 4]));
        let tilted = map([60, 50], [1e-9, 2e-9], |x, y| 0.1 * x - 0.3 * y + 1e-9);
        let smooth = tilted.smoothed(16e-9).unwrap();
        for row in 20..40 {
            for (a, b) in smooth.row(row)[10..40].iter().zip(&tilted.row(row)[10..40]) {
                assert!((a - b).abs() < 1e-22, "{a:e} {b:e}");
            }
        }
        // Half a cut-off from the border a tilt is off by little of what it rises over a cut-off.
        let off = |row: usize| (smooth.row(row)[25] - tilted.row(row)[25]).abs() / (0.3 * 16e-9);
        assert!(off(8) < 2.2e-3 && off(0) > 0.1, "{} {}", off(8), off(0));
    }

    /// Every pixel against the formula, summed one by one, with missing heights, at the border too.
    #[test]
    fn the_filter_is_its_formula() {
        let mut rough =
            map([23, 40], [1e-9, 1.3e-9], |x, y| 1e-9 * ((1.7e9 * x).sin() + (2.9e9 * y + x).cos()));
        (0..rough.heights.len()).filter(|i| i % 17 == 3).for_each(|i| rough.heights[i] = f64::NAN);
        let cutoff = 7.7e-9;
        let smooth = rough.smoothed(cutoff).unwrap();
        let alpha = (LN_2 / PI).sqrt();
        for (i, z) in smooth.heights.iter().enumerate() {
            let (mut sum, mut weights) = (0.0, 0.0);
            for (j, other) in rough.heights.iter().enumerate().filter(|(_, other)| !other.is_nan()) {
                let x = ((i % 40) as f64 - (j % 40) as f64) * 1.3e-9;
                let y = ((i / 40) as f64 - (j / 40) as f64) * 1e-9;
                let weight = (-PI * (x * x + y * y) / (alpha * cutoff).powi(2)).exp();
                (sum, weights) = (sum + weight * other, weights + weight);
            }
            assert_eq!(z.is_nan(), rough.heights[i].is_nan());
            assert!(z.is_nan() || (z - sum / weights).abs() < 1e-19, "{i}: {z:e} {:e}", sum / weights);
        }
    }

    /// A cut-off of few pixels passes more than half of its own wave, as the sum over its weights has it.
    #[test]
    fn few_pixels_pass_more() {
        let passed = |pixels: f64, length: f64| {
            let kernel = kernel(pixels);
            let middle = kernel.len() / 2;
            let wave = |i: usize| (2.0 * PI * (i as f64 - middle as f64) / length).cos();
            kernel.iter().enumerate().map(|(i, weight)| weight * wave(i)).sum::<f64>()
                / kernel.iter().sum::<f64>()
        };
        assert!((passed(2.0, 2.0) - 0.8923).abs() < 1e-3, "{}", passed(2.0, 2.0));
        assert!((passed(3.0, 3.0) - 0.5 - 2.0_f64.powi(-4)).abs() < 4e-3, "{}", passed(3.0, 3.0));
        assert!((passed(5.0, 5.0) - 0.5).abs() < 2e-5 && (passed(8.0, 8.0) - 0.5).abs() < 1e-9);
    }

    #[test]
    fn the_bits_do_not_depend_on_threads() {
        let rough = map([70, 90], [1e-9, 1e-9], |x, y| 1e-9 * ((1.7e9 * x).sin() + (2.9e9 * y + x).cos()));
        let smooth = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| rough.smoothed(12.3e-9).unwrap())
        };
        let one = smooth(1);
        for threads in [2, 3, 8] {
            let bits = |map: &HeightMap| map.heights.iter().map(|z| z.to_bits()).collect::<Vec<u64>>();
            assert_eq!(bits(&smooth(threads)), bits(&one), "{threads}");
        }
    }

    #[test]
    fn cutoffs_that_no_map_has_are_refused() {
        let rough = map([40, 60], [1e-9, 2e-9], |x, y| (1e9 * x + 2e9 * y).sin() * 1e-9);
        for cutoff in [3.99e-9, 20.1e-9, f64::NAN, 0.0, -1e-8, f64::INFINITY] {
            match rough.smoothed(cutoff).unwrap_err() {
                MapError::Cutoff { least, most, .. } => assert_eq!((least, most), (4e-9, 20e-9)),
                other => panic!("{other}"),
            }
        }
        assert!(rough.smoothed(4e-9).is_ok() && rough.smoothed(20e-9).is_ok());
    }
}
