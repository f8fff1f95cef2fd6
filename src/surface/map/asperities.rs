//! The asperities of a measured surface, and the equivalent surface of McCool.

use super::{HeightMap, MapError, SpectralMoments, Summit, forces_of_spheres};
use crate::math::moments::Moments;
use crate::math::quantile::quantile;
use std::f64::consts::PI;

/// σ_s² = (1 − 0.8968/α) m₀ (Bush, Gibson and Thomas 1975; McCool 1987).
const SUMMIT_VARIANCE: f64 = 0.8968;

/// Fewer pixels from one maximum of a profile to the next leave summits unresolved.
const FEWEST_PIXELS: f64 = 10.0;
/// Fewer summits leave the density uncertain by more than a tenth.
const FEWEST_SUMMITS: usize = 100;
/// Skewness and excess kurtosis beyond which heights are far from Gaussian.
const NOT_GAUSSIAN: (f64, f64) = (0.3, 0.6);
/// Ratio of the mean square slopes along both directions from which a surface has a lay.
const ANISOTROPIC: f64 = 1.5;
/// Least α of a random isotropic surface.
const LEAST_ALPHA: f64 = 1.5;

/// Asperities of the Greenwood-Williamson surface that is equivalent to a measured one, from
/// spectral moments alone (McCool 1987, J. Tribol. 109, 264; mean height by Bush, Gibson and Thomas 1975,
/// Wear 35, 87).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Equivalent {
    /// Density η = m₄/(6π√3 m₂), 1/m².
    pub density: f64,
    /// Radius R = 3√π/(8√m₄), the reciprocal of the mean curvature of summits, m.
    pub radius: f64,
    /// Mean height of summits above the mean plane of the surface, 4√(m₀/(πα)), m.
    pub height_mean: f64,
    /// Standard deviation of summit heights, √((1 − 0.8968/α) m₀), m; 0 where α is too small for any.
    pub height_std: f64,
}

impl Equivalent {
    /// Computes the equivalent asperities from spectral moments.
    pub fn new(moments: &SpectralMoments) -> Self {
        let (alpha, m4) = (moments.alpha(), moments.m4());
        Self {
            density: m4 / moments.m2() / (6.0 * PI * 3.0_f64.sqrt()),
            radius: 3.0 * PI.sqrt() / (8.0 * m4.sqrt()),
            height_mean: 4.0 * (moments.m0 / (PI * alpha)).sqrt(),
            height_std: ((1.0 - SUMMIT_VARIANCE / alpha).max(0.0) * moments.m0).sqrt(),
        }
    }
}

/// Asperities by the summits themselves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// Summits over the area that was searched, 1/m².
    pub density: f64,
    /// Reciprocal of the mean of the mean curvatures, m.
    pub radius: f64,
    /// Mean height above the mean plane of the surface, m.
    pub height_mean: f64,
    /// Standard deviation of the heights, m; NaN for one summit.
    pub height_std: f64,
    /// Standard deviation of the mean curvatures, 1/m; NaN for one summit.
    pub curvature_std: f64,
}

impl Measured {
    /// Density and moments of summits, at least one, on an area, m².
    pub(super) fn new(summits: &[Summit], nominal_area: f64) -> Self {
        let mut sample = Moments::new(2);
        summits.iter().for_each(|summit| sample.push(&[summit.height, summit.mean_curvature()]));
        let (mean, std) = (sample.mean(), sample.std());
        Self {
            density: summits.len() as f64 / nominal_area,
            radius: 1.0 / mean[1],
            height_mean: mean[0],
            height_std: std[0],
            curvature_std: std[1],
        }
    }
}

/// Deviation of summits from spheres.
///
/// # Examples
/// ```
/// use stiction::surface::map::{Shape, Summit};
///
/// // 3 and 1 along x and y, and 3 and 1 along the diagonals.
/// let summit = Summit { row: 1, column: 1, height: 1e-9, curvature: [1e6, 3e6], twist: 0.0 };
/// let turned = Summit { curvature: [2e6, 2e6], twist: -1e6, ..summit };
/// let Shape { saddles, ratio, forces } = Shape::new(&[summit, turned]);
/// assert!(saddles == 0 && (ratio - 3.0).abs() < 1e-12);
/// assert!(forces[0] < forces[1] && forces[1] < 1.0);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shape {
    /// Summits whose smaller principal curvature is not positive.
    pub saddles: usize,
    /// Median of the ratio κ₁/κ₂ of the others' principal curvatures; NaN if there are none.
    pub ratio: f64,
    /// Hertz forces of spheres over that of an ellipsoid of this ratio, of R = 1/mean curvature and of 1/√(κ₁κ₂)
    /// ([`forces_of_spheres`]).
    pub forces: [f64; 2],
}

impl Shape {
    /// Looks at the principal curvatures of summits.
    pub fn new(summits: &[Summit]) -> Self {
        let principal = summits.iter().map(Summit::principal_curvatures);
        let mut ratios: Vec<f64> =
            principal.filter(|[_, blunt]| *blunt > 0.0).map(|[sharp, blunt]| sharp / blunt).collect();
        ratios.sort_unstable_by(f64::total_cmp);
        let ratio = if ratios.is_empty() { f64::NAN } else { quantile(&ratios, 0.5) };
        let forces = if ratio.is_finite() { forces_of_spheres(ratio) } else { [f64::NAN; 2] };
        Self { saddles: summits.len() - ratios.len(), ratio, forces }
    }
}

impl HeightMap {
    /// The map's summits that have at least a given prominence, m, and the prominence of each; all summits,
    /// and no prominences, where none is given.
    pub(super) fn prominent(
        &self,
        summits: Vec<Summit>,
        least: Option<f64>,
    ) -> (Vec<Summit>, Option<Vec<f64>>) {
        let Some(least) = least else { return (summits, None) };
        let prominences = self.prominences(&summits);
        let pairs = summits.into_iter().zip(prominences).filter(|(_, prominence)| *prominence >= least);
        let (summits, prominences) = pairs.unzip();
        (summits, Some(prominences))
    }
}

/// The asperities of a measured surface.
///
/// # Examples
/// ```
/// use stiction::surface::map::{Asperities, Equivalent, HeightMap, Measured, SpectralMoments};
///
/// # let wave = std::f64::consts::PI / 8.0;
/// # let height = |k: i32| 1e-9 * (wave * f64::from(k / 64)).cos() * (wave * f64::from(k % 64)).cos();
/// # let map = HeightMap::new((0..64 * 64).map(height).collect(), [64, 64], [1e-8, 1e-8])?;
/// // An egg box of 1 nm: the mean square of cos x cos y is 1/4, and all its summits are alike.
/// let Asperities { moments, equivalent, measured, .. } = Asperities::new(&map)?;
/// let SpectralMoments { m0, .. } = moments;
/// assert!((m0 / 0.25e-18 - 1.0).abs() < 1e-12);
/// let Measured { height_mean, height_std, .. } = measured;
/// assert!((height_mean / 1e-9 - 1.0).abs() < 1e-9 && height_std < 1e-15);
/// // McCool's have the mean height 4√(m₀/(πα)); of an egg box α = 1, but for the border of the map.
/// let Equivalent { height_mean, .. } = equivalent;
/// assert!((height_mean / 2e-9 * std::f64::consts::PI.sqrt() - 1.0).abs() < 0.05);
/// # Ok::<(), stiction::surface::map::MapError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Asperities {
    /// Every asperity, row by row.
    pub summits: Vec<Summit>,
    /// Prominence of each, m, where one was asked for.
    pub prominences: Option<Vec<f64>>,
    /// Their deviation from spheres.
    pub shape: Shape,
    /// Area that was searched for summits, m²: the pixels that were compared with 8 neighbours.
    pub nominal_area: f64,
    /// Spectral moments of the surface.
    pub moments: SpectralMoments,
    /// The equivalent asperities that follow from these.
    pub equivalent: Equivalent,
    /// The summits themselves.
    pub measured: Measured,
}

impl Asperities {
    /// Finds the asperities of a levelled map.
    ///
    /// # Errors
    /// [`MapError`] when the map has no summit, or no slopes.
    pub fn new(map: &HeightMap) -> Result<Self, MapError> {
        Self::found(map, None)
    }

    /// Finds those that have at least such a prominence, m ([`HeightMap::prominences`]).
    ///
    /// # Errors
    /// [`MapError`] when the map has no such summit, or no slopes.
    pub fn prominent(map: &HeightMap, least: f64) -> Result<Self, MapError> {
        Self::found(map, Some(least))
    }

    fn found(map: &HeightMap, least: Option<f64>) -> Result<Self, MapError> {
        let moments = SpectralMoments::new(map)?;
        let found = map.summits();
        if found.summits.is_empty() {
            return Err(MapError::NoSummit);
        }
        let [dy, dx] = map.pixel();
        let nominal_area = found.compared as f64 * dy * dx;
        let (summits, prominences) = map.prominent(found.summits, least);
        if summits.is_empty() {
            let all = map.prominences(&map.summits().summits);
            let most = all.into_iter().fold(0.0, f64::max);
            return Err(MapError::NotProminent { least: least.unwrap_or_default(), most });
        }
        Ok(Self {
            measured: Measured::new(&summits, nominal_area),
            shape: Shape::new(&summits),
            summits,
            prominences,
            nominal_area,
            moments,
            equivalent: Equivalent::new(&moments),
        })
    }

    /// Assumptions of the parameters that a surface measured with such pixels, m, does not meet, a line each:
    /// number and consequence.
    pub fn caveats(&self, pixel: [f64; 2]) -> Vec<String> {
        let moments = &self.moments;
        let mut caveats = self.resolution(pixel);
        let count = self.summits.len();
        if count < FEWEST_SUMMITS {
            let error = 100.0 / (count as f64).sqrt();
            caveats
                .push(format!("{count} summits are few: their density is uncertain by about {error:.0} %"));
        }
        if moments.skewness.abs() > NOT_GAUSSIAN.0 || moments.excess_kurtosis.abs() > NOT_GAUSSIAN.1 {
            let (skewness, kurtosis) = (moments.skewness, moments.excess_kurtosis);
            caveats.push(format!(
                "heights are far from Gaussian (skewness {skewness:.2}, excess kurtosis {kurtosis:.2}), which the parameters from \
                 moments take for granted"
            ));
        }
        let ratio = moments.slope[1] / moments.slope[0];
        if !(1.0 / ANISOTROPIC..=ANISOTROPIC).contains(&ratio) {
            caveats.push(format!(
                "mean square slopes along x and y differ {ratio:.2} times: the parameters from moments are of isotropic surfaces"
            ));
        }
        if moments.alpha() < LEAST_ALPHA {
            caveats.push(format!(
                "alpha = {:.3}, but that of a random isotropic surface is at least 1.5",
                moments.alpha()
            ));
        }
        caveats
    }

    /// Whether the pixels resolve the summits.
    fn resolution(&self, pixel: [f64; 2]) -> Vec<String> {
        let pixels = self.moments.wavelength() / pixel[0].max(pixel[1]);
        if pixels >= FEWEST_PIXELS {
            return Vec::new();
        }
        vec![format!(
            "{pixels:.1} pixels from one maximum of a profile to the next, fewer than {FEWEST_PIXELS}: pixels are too coarse for the \
             summits, which have a radius of {:.2} pixels",
            self.measured.radius / pixel[0].max(pixel[1])
        )]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Table 2 of the hybrid model's paper lists σ, R and η of three surfaces; the relations give them back
    /// from moments that follow from R and η: m₄ = (3√π/(8R))², m₂ = m₄/(6π√3 η).
    #[test]
    fn the_relations_agree_with_each_other() {
        let (radius, density, sigma): (f64, f64, f64) = (3.33e-6, 7.39e12, 1.619e-9);
        let m4 = (3.0 * PI.sqrt() / (8.0 * radius)).powi(2);
        let m2 = m4 / (6.0 * PI * 3.0_f64.sqrt() * density);
        let m0 = sigma * sigma;
        let moments =
            SpectralMoments { m0, slope: [m2; 2], curvature: [m4; 2], skewness: 0.0, excess_kurtosis: 0.0 };
        let surface = Equivalent::new(&moments);
        let close = |value: f64, expected: f64, within: f64| {
            assert!((value / expected - 1.0).abs() < within, "{value:e}")
        };
        close(surface.density, density, 1e-14);
        close(surface.radius, radius, 1e-14);
        // σ_s² = σ² − 3.717·10⁻⁴/(ηR)² and y_s = 0.045944/(ηR) have four digits.
        close(surface.height_std, (m0 - 3.717e-4 / (density * radius).powi(2)).sqrt(), 1e-4);
        close(surface.height_mean, 0.045944 / (density * radius), 1e-4);
    }
}
