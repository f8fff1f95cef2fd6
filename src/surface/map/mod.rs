//! Measured surfaces: from a map of heights to asperities, and to the Greenwood-Williamson surface that is
//! equivalent to it.

mod asperities;
mod cutoffs;
mod ellipsoid;
mod level;
mod prominence;
mod smooth;
mod spectrum;
mod summits;

pub use asperities::{Asperities, Equivalent, Measured, Shape};
pub use cutoffs::AtCutoff;
pub use ellipsoid::{forces_of_spheres, hertz_radius};
pub use level::Levelling;
pub use spectrum::SpectralMoments;
pub use summits::{Summit, Summits};

use std::ops::{Range, RangeInclusive};
use thiserror::Error;

/// Fewest rows and columns of a map.
pub const SMALLEST: usize = 8;
/// Pixels, m: far smaller than atoms and larger than laboratories, so that a wrong unit shows.
pub const PIXELS: RangeInclusive<f64> = 1e-13..=1e3;
/// Largest height of either sign, m.
pub const HIGHEST: f64 = 1e6;
/// Roundings of the largest height within which heights are equal: levelling does not keep them apart.
const ROUNDINGS: f64 = 64.0;
/// Largest share of pixels that are missing, or as high as the next one, before it is said.
const NOTED_SHARE: f64 = 0.01;

/// Reasons why no asperities follow from a map.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum MapError {
    /// Too few pixels in a direction.
    #[error("the map has {rows} rows and {columns} columns; at least {SMALLEST} of each are needed")]
    TooSmall {
        /// Rows.
        rows: usize,
        /// Columns.
        columns: usize,
    },
    /// A pixel that is no length, or not one of a surface.
    #[error("a pixel of {0:e} m is outside 1e-13..1e3 m; check its unit")]
    Pixel(f64),
    /// A height that is no height.
    #[error(
        "row {row}, column {column}: the height is {height:e} m; finite ones up to 1e6 m, and NaN where it is missing, are needed"
    )]
    Height {
        /// Row, from 1.
        row: usize,
        /// Column, from 1.
        column: usize,
        /// The height, m.
        height: f64,
    },
    /// The heights that are there do not determine the surface that is to be subtracted.
    #[error("{known} of {pixels} heights are known, and they do not determine the {surface}")]
    Undetermined {
        /// Pixels with a height.
        known: usize,
        /// All pixels.
        pixels: usize,
        /// The surface that is to be subtracted.
        surface: &'static str,
    },
    /// No roughness.
    #[error("the levelled map is flat: no height differs from the others by more than rounding")]
    Flat,
    /// Slopes or curvatures are nowhere known.
    #[error("missing heights leave no neighbouring pixels to take slopes and curvatures from")]
    NoNeighbours,
    /// No pixel is a summit.
    #[error("no pixel is higher than its 8 neighbours: the map has no summit")]
    NoSummit,
    /// A cut-off that the map cannot be smoothed with.
    #[error(
        "a cut-off of {given:e} m: two pixels to half the shorter side of the map are possible, {least:e} to {most:e} m"
    )]
    Cutoff {
        /// The cut-off, m.
        given: f64,
        /// Two pixels, m.
        least: f64,
        /// Half the shorter side, m.
        most: f64,
    },
    /// A map on which no series of cut-offs has room.
    #[error("two pixels, {least:e} m, are not below a quarter of the shorter side of the map, {most:e} m")]
    NoCutoffs {
        /// Two pixels, m.
        least: f64,
        /// A quarter of the shorter side, m.
        most: f64,
    },
    /// No summit is prominent.
    #[error("no summit has a prominence of {least:e} m; the most prominent one has {most:e} m")]
    NotProminent {
        /// The least prominence that counts, m.
        least: f64,
        /// The largest that there is, m.
        most: f64,
    },
}

/// Heights of a surface over a grid.
///
/// # Examples
/// ```
/// use stiction::surface::map::{HeightMap, Levelling, MapError};
///
/// // An egg box of 64 x 64 pixels of 10 nm, 1 nm high.
/// let wave = std::f64::consts::PI / 8.0;
/// let height = |k: i32| 1e-9 * (wave * f64::from(k / 64)).cos() * (wave * f64::from(k % 64)).cos();
/// let map = HeightMap::new((0..64 * 64).map(height).collect(), [64, 64], [1e-8, 1e-8])?;
/// let map = map.levelled(Levelling::None)?;
/// assert_eq!((map.shape(), map.missing()), ([64, 64], 0));
/// assert!(matches!(HeightMap::new(vec![0.0; 9], [3, 3], [1e-8, 1e-8]), Err(MapError::TooSmall { .. })));
/// # Ok::<(), stiction::surface::map::MapError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct HeightMap {
    /// Row-major, rows × columns, m; NaN where a height is missing.
    heights: Vec<f64>,
    rows: usize,
    columns: usize,
    /// Height dy and width dx of a pixel, m.
    pixel: [f64; 2],
    /// Heights that differ by no more, m, are equally high.
    resolution: f64,
    /// Rows and columns along each side that have no part in summits and moments.
    margin: [usize; 2],
}

impl HeightMap {
    /// A map of `shape` rows × columns, row-major, m, NaN where a height is missing, with pixels dy high and
    /// dx wide, m.
    ///
    /// # Errors
    /// [`MapError`] when there are too few pixels, when a height is infinite or beyond [`HIGHEST`], or a
    /// pixel beyond [`PIXELS`].
    ///
    /// # Panics
    /// When there are not rows × columns heights.
    pub fn new(heights: Vec<f64>, shape: [usize; 2], pixel: [f64; 2]) -> Result<Self, MapError> {
        let [rows, columns] = shape;
        assert_eq!(heights.len(), rows * columns, "a map has as many heights as pixels");
        if rows < SMALLEST || columns < SMALLEST {
            return Err(MapError::TooSmall { rows, columns });
        }
        if let Some(size) = pixel.into_iter().find(|size| !PIXELS.contains(size)) {
            return Err(MapError::Pixel(size));
        }
        if let Some(place) = heights.iter().position(|height| height.abs() > HIGHEST) {
            let (row, column) = (place / columns + 1, place % columns + 1);
            return Err(MapError::Height { row, column, height: heights[place] });
        }
        let largest = heights.iter().fold(0.0_f64, |largest, height| largest.max(height.abs()));
        Ok(Self {
            heights,
            rows,
            columns,
            pixel,
            resolution: ROUNDINGS * f64::EPSILON * largest,
            margin: [0, 0],
        })
    }

    /// Rows and columns.
    pub fn shape(&self) -> [usize; 2] {
        [self.rows, self.columns]
    }

    /// Height dy and width dx of a pixel, m.
    pub fn pixel(&self) -> [f64; 2] {
        self.pixel
    }

    /// Heights, row-major, m; NaN where one is missing.
    pub fn heights(&self) -> &[f64] {
        &self.heights
    }

    /// Rows and columns along each side that have no part in summits and moments: none, or those within half
    /// the cut-off that the map was smoothed with.
    pub fn margin(&self) -> [usize; 2] {
        self.margin
    }

    /// Rows and columns within the margin, which is so wide at least.
    fn searched(&self, least: usize) -> [Range<usize>; 2] {
        [(self.rows, 0), (self.columns, 1)].map(|(count, side)| {
            let margin = self.margin[side].max(least);
            margin..count - margin
        })
    }

    /// Pixels whose height is missing.
    pub fn missing(&self) -> usize {
        self.heights.iter().filter(|height| height.is_nan()).count()
    }

    /// Share of the pairs of pixels side by side that are equally high: plateaus, or heights in coarse steps.
    /// The map is the one as measured: levelling tilts plateaus.
    pub fn equal_neighbours(&self) -> f64 {
        let pairs = self.heights.chunks_exact(self.columns).flat_map(|row| row.windows(2));
        let (mut equal, mut all) = (0_u64, 0_u64);
        for pair in pairs.filter(|pair| !pair[0].is_nan() && !pair[1].is_nan()) {
            equal += u64::from(pair[0] == pair[1]);
            all += 1;
        }
        equal as f64 / all.max(1) as f64
    }

    /// A line for each thing that the measurement has left out or not resolved. The map is as measured,
    /// before levelling.
    pub fn flaws(&self) -> Vec<String> {
        let mut flaws = Vec::new();
        let missing = self.missing() as f64 / self.heights.len() as f64;
        if missing > NOTED_SHARE {
            flaws.push(format!("{:.1} % of the heights are missing", 100.0 * missing));
        }
        let equal = self.equal_neighbours();
        if equal > NOTED_SHARE {
            flaws.push(format!(
                "{:.1} % of neighbouring pixels are equally high: plateaus are no summits, and steps of height make false ones",
                100.0 * equal
            ));
        }
        flaws
    }

    fn row(&self, row: usize) -> &[f64] {
        &self.heights[row * self.columns..(row + 1) * self.columns]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_map_is_refused() {
        let map =
            |heights: Vec<f64>, shape, pixel| HeightMap::new(heights, shape, pixel).map(|map| map.shape());
        assert_eq!(map(vec![0.0; 56], [7, 8], [1e-9; 2]), Err(MapError::TooSmall { rows: 7, columns: 8 }));
        assert_eq!(map(vec![0.0; 64], [8, 8], [1e-9, -1e-9]), Err(MapError::Pixel(-1e-9)));
        assert!(matches!(map(vec![0.0; 64], [8, 8], [f64::NAN, 1e-9]), Err(MapError::Pixel(_))));
        let mut heights = vec![0.0; 72];
        heights[19] = f64::NEG_INFINITY;
        let infinite = MapError::Height { row: 3, column: 2, height: f64::NEG_INFINITY };
        assert_eq!(map(heights.clone(), [8, 9], [1e-9; 2]), Err(infinite));
        heights[19] = f64::NAN;
        assert_eq!(map(heights, [8, 9], [1e-9; 2]), Ok([8, 9]));
    }

    #[test]
    fn equal_neighbours_are_counted_between_known_heights() {
        let mut heights: Vec<f64> = (0..64).map(f64::from).collect();
        heights[1] = 0.0;
        heights[10] = f64::NAN;
        let map = HeightMap::new(heights, [8, 8], [1e-9; 2]).unwrap();
        assert_eq!((map.missing(), map.equal_neighbours()), (1, 1.0 / 54.0));
    }
}
