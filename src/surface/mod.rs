//! The rough surface: its asperity heights and the conversions from what is measured to what the model takes.

mod curved;
mod heights;
#[doc(hidden)]
pub mod nayak;
mod places;
mod radii;
mod scheme;
mod shape;

#[doc(hidden)]
pub use heights::{HEIGHT_LAWS, Lowered, NamedLaw, Parameter, ParameterValue};
pub use heights::{HeightLaw, Heights, LogNormal, Truncated, Weibull};
pub use nayak::Spectrum;
pub use places::{MeasuredPlaces, Places, PlacesError};
pub use radii::Radii;
#[doc(hidden)]
pub use radii::{RADIUS_RANGE, RadiusClass, RadiusPanels};
#[doc(hidden)]
pub use scheme::STRATA;
pub use scheme::SamplingScheme;
#[doc(hidden)]
pub use shape::{Depths, Shape};

use crate::background::{Background, MeanPlaneForce};
use crate::format::{rounded, si};
use crate::liquid::{Spread, Spreads};
use curved::Curved;
use std::borrow::Cow;
use std::sync::Arc;
use thiserror::Error;

/// Factor of σ² − σ_s² = 3.717·10⁻⁴/(ηR)² (McCool 1986; Bush, Gibson and Thomas 1975).
pub const VARIANCE_FACTOR: f64 = 3.717e-4;
/// Factor of y_s = 0.045944/(ηR) (Etsion and Front 1994).
pub const OFFSET_FACTOR: f64 = 0.045944;

/// Most asperities of a patch.
pub const MOST_ASPERITIES: u64 = 200_000_000;

/// Lengths of a surface, m, whose squares and quotients are numbers that a computer has.
pub const LENGTHS: std::ops::RangeInclusive<f64> = 1e-100..=1e100;

/// The known properties of a surface, SI.
///
/// # Examples
/// ```
/// use stiction::surface::{Roughness, Surface};
///
/// let roughness = Roughness {
///     asperity_radius: 3.33e-6,
///     asperity_density: 7.39e12,
///     nominal_area: 1e-9,
///     surface_height_std: Some(1.62e-9),
///     asperity_height_std: None,
///     mean_plane_offset: None,
/// };
/// let surface = Surface::new(&roughness)?;
/// assert_eq!(surface.asperity_count, 7390);
/// # Ok::<(), stiction::surface::SurfaceError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Roughness {
    /// Asperity radius R, m.
    pub asperity_radius: f64,
    /// Asperities per area η, 1/m².
    pub asperity_density: f64,
    /// Nominal area A_n, m².
    pub nominal_area: f64,
    /// Standard deviation σ of the surface heights, m, if given.
    pub surface_height_std: Option<f64>,
    /// Standard deviation σ_s of the asperity heights, m, if given: taken as it is.
    pub asperity_height_std: Option<f64>,
    /// Height of the asperity mean plane above the surface mean plane, m; `None` for 0.045944/(ηR).
    pub mean_plane_offset: Option<f64>,
}

/// The law of the number of asperities of a replica.
///
/// # Examples
/// ```
/// use stiction::surface::{CountLaw, Surface};
///
/// let mut surface = Surface::uniform(1e-9, 1e-6, 100, 1e-10);
/// surface.count_law = CountLaw::Poisson;
/// assert_eq!(surface.count_law.name(), "poisson");
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum CountLaw {
    /// Always the same number.
    #[default]
    Fixed,
    /// Poisson-distributed, as on a patch that is cut out of a large surface of independent asperities.
    Poisson,
}

impl CountLaw {
    /// All of them, by name.
    pub const ALL: [(&'static str, Self); 2] = [("fixed", Self::Fixed), ("poisson", Self::Poisson)];

    /// The name in scenes and files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Fixed => "fixed",
            Self::Poisson => "poisson",
        }
    }
}

/// The surface that the model takes.
///
/// # Examples
/// ```
/// use stiction::surface::{HeightLaw, Heights, Surface, Weibull};
///
/// let mut surface = Surface::uniform(1e-9, 1e-6, 100, 1e-10);
/// surface.heights = Heights { law: HeightLaw::Weibull(Weibull::new(2.0)), ..Heights::gaussian(1e-9) };
/// let (mean, std) = surface.heights.moments();
/// assert!(mean.abs() < 1e-15 && (std - 1e-9).abs() < 1e-15);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Surface {
    /// Standard deviation σ of the surface heights, m.
    pub surface_height_std: f64,
    /// Heights of the asperities above their mean plane.
    pub heights: Heights,
    /// Radii of the asperities.
    pub radii: Radii,
    /// Mean radius of the asperities, m.
    pub asperity_radius: f64,
    /// Height y_s of the asperity mean plane above the surface mean plane, m.
    pub mean_plane_offset: f64,
    /// Number N of asperities; the mean one, where it varies.
    pub asperity_count: usize,
    /// The law of this number.
    pub count_law: CountLaw,
    /// Whether every replica is the given sample of asperities itself, so that nothing is left to chance.
    pub whole: bool,
    /// The map on random places of which a body lands, with [`Radii::Measured`] asperities in their order; places are independent
    /// without one.
    pub landing: Option<MeasuredPlaces>,
    /// Heights of the asperities of given patches above their mean plane, m, one patch after the other; drawn by the law
    /// without them.
    pub patches: Option<Arc<[f64]>>,
    /// Asperities per area η, 1/m².
    pub asperity_density: f64,
    /// Nominal area A_n, m².
    pub nominal_area: f64,
    /// The attraction between its mean plane and that of the other surface, if there is one.
    pub background: Option<Arc<Background>>,
    /// The excess pull of liquid over its bridges, on each way of the surface; nothing where bridges are
    /// apart.
    pub spread: Spreads,
}

/// Reasons why no surface follows from a roughness.
///
/// # Examples
/// ```
/// use stiction::surface::{Roughness, Surface, SurfaceError};
///
/// let small = Roughness {
///     asperity_radius: 1e-6,
///     asperity_density: 1e13,
///     nominal_area: 1e-14,
///     surface_height_std: None,
///     asperity_height_std: Some(1e-9),
///     mean_plane_offset: None,
/// };
/// assert_eq!(Surface::new(&small), Err(SurfaceError::NoAsperity(0.1)), "a tenth of an asperity");
/// ```
#[derive(Clone, Copy, Debug, Error, PartialEq)]
pub enum SurfaceError {
    /// σ² is smaller than what the conversion subtracts.
    #[error(
        "with this asperity_radius R and asperity_density eta a Gaussian surface has more than {}, not {} \
         (sigma_s^2 = sigma^2 - 3.717e-4/(eta R)^2 would be negative): R above {} or eta above {} /um^2 would do; or give also \
         asperity_height_std, the height std of the summits",
        si(*least, "m"),
        si(*given, "m"),
        si(*radius, "m"),
        rounded(1e-12 * density, 4)
    )]
    NegativeVariance {
        /// σ, m.
        given: f64,
        /// The σ at which σ_s = 0, m.
        least: f64,
        /// The R at which σ_s = 0, m.
        radius: f64,
        /// The η at which σ_s = 0, 1/m².
        density: f64,
    },
    /// σ is larger than R.
    #[error("is above asperity_radius, {}: summits have radii far larger than the roughness; check the units of both", si(*.0, "m"))]
    AboveRadius(f64),
    /// Neither standard deviation is known.
    #[error("neither surface_height_std nor asperity_height_std is given")]
    NoHeightStd,
    /// ηA_n rounds to no asperity.
    #[error("asperity_density x nominal_area = {0:.4e} asperities; at least 0.5 are needed")]
    NoAsperity(f64),
    /// ηA_n is more than [`MOST_ASPERITIES`].
    #[error(
        "asperity_density x nominal_area = {count:.4e} asperities, and a patch has at most {most:e}: \
         a nominal_area of {largest:.4e} m^2 would do, with more replicas for a smaller error",
        most = MOST_ASPERITIES as f64
    )]
    TooMany {
        /// ηA_n.
        count: f64,
        /// The largest A_n, m².
        largest: f64,
    },
    /// A length of the surface is beyond [`LENGTHS`].
    #[error(
        "{name} = {value:.4e} m, which follows from the quantities of the surface, is outside 1e-100..1e100 m: check their units"
    )]
    Length {
        /// Name of the length.
        name: &'static str,
        /// The length, m.
        value: f64,
    },
}

impl Surface {
    /// Applies the conversions σ → σ_s (or back, when only σ_s is given), and rounds N = ηA_n.
    ///
    /// # Errors
    /// [`SurfaceError`].
    pub fn new(roughness: &Roughness) -> Result<Self, SurfaceError> {
        let inverse = 1.0 / (roughness.asperity_density * roughness.asperity_radius);
        if !(inverse <= *LENGTHS.end()) {
            return Err(SurfaceError::Length { name: "asperity_density", value: inverse });
        }
        let difference = VARIANCE_FACTOR * inverse * inverse;
        let (surface_height_std, asperity_height_std) =
            match (roughness.surface_height_std, roughness.asperity_height_std) {
                (Some(surface), Some(asperity)) => (surface, asperity),
                (None, Some(asperity)) => ((asperity * asperity + difference).sqrt(), asperity),
                (Some(surface), None) => {
                    let variance = surface * surface - difference;
                    if !(variance > 0.0) {
                        let (given, least) = (surface, difference.sqrt());
                        let radius = roughness.asperity_radius * least / given;
                        let density = roughness.asperity_density * least / given;
                        return Err(SurfaceError::NegativeVariance { given, least, radius, density });
                    }
                    (surface, variance.sqrt())
                }
                (None, None) => return Err(SurfaceError::NoHeightStd),
            };
        let count = (roughness.asperity_density * roughness.nominal_area).round();
        if !(count >= 1.0) {
            return Err(SurfaceError::NoAsperity(roughness.asperity_density * roughness.nominal_area));
        }
        if count > MOST_ASPERITIES as f64 {
            let largest = MOST_ASPERITIES as f64 / roughness.asperity_density;
            return Err(SurfaceError::TooMany { count, largest });
        }
        let mean_plane_offset = roughness.mean_plane_offset.unwrap_or(OFFSET_FACTOR * inverse);
        let lengths =
            [("asperity_height_std", asperity_height_std), ("surface_height_std", surface_height_std)];
        if let Some(&(name, value)) = lengths.iter().find(|(_, value)| !LENGTHS.contains(value)) {
            return Err(SurfaceError::Length { name, value });
        }
        // A plane may be anywhere, and with the other one too.
        if !(mean_plane_offset >= 0.0 && mean_plane_offset <= *LENGTHS.end()) {
            return Err(SurfaceError::Length { name: "mean_plane_offset", value: mean_plane_offset });
        }
        let Roughness { asperity_radius, asperity_density, nominal_area, .. } = *roughness;
        Ok(Self {
            surface_height_std,
            mean_plane_offset,
            asperity_density,
            ..Self::uniform(asperity_height_std, asperity_radius, count as usize, nominal_area)
        })
    }

    /// Asperities of one kind: Gaussian heights of standard deviation `std`, m, about the mean plane of the
    /// surface.
    pub fn uniform(std: f64, asperity_radius: f64, asperity_count: usize, nominal_area: f64) -> Self {
        Self {
            surface_height_std: std,
            heights: Heights::gaussian(std),
            radii: Radii::Common,
            asperity_radius,
            mean_plane_offset: 0.0,
            asperity_count,
            count_law: CountLaw::Fixed,
            whole: false,
            landing: None,
            patches: None,
            asperity_density: asperity_count as f64 / nominal_area,
            nominal_area,
            background: None,
            spread: Spreads::default(),
        }
    }

    /// Whether asperities differ in their radii.
    pub fn is_polydisperse(&self) -> bool {
        self.radii != Radii::Common
    }

    /// Whether asperities are alike but for Gaussian heights, of which there is a fixed number.
    pub fn is_plain(&self) -> bool {
        !self.is_polydisperse()
            && self.heights.law == HeightLaw::Gaussian
            && self.count_law == CountLaw::Fixed
    }

    /// The asperities of each radius, for integrals.
    #[doc(hidden)]
    pub fn parts(&self) -> Vec<RadiusClass> {
        match &self.heights.law {
            HeightLaw::Lowered(lowered) if self.is_polydisperse() => {
                let under = |part: RadiusClass| {
                    let (radius, heights) = lowered.of_radius(part.radius, part.heights);
                    RadiusClass { radius, heights, ..part }
                };
                self.radii.parts(lowered.depths.tip, &lowered.base).into_iter().map(under).collect()
            }
            _ => self.radii.parts(self.asperity_radius, &self.heights),
        }
    }

    /// The law of the radii, if it has a density.
    #[doc(hidden)]
    pub fn radius_panels(&self) -> Option<RadiusPanels> {
        match &self.heights.law {
            HeightLaw::Lowered(lowered) => {
                let panels = self.radii.panels(lowered.depths.tip, &lowered.base)?;
                let lowered = Arc::clone(lowered);
                Some(panels.map(move |(radius, heights)| lowered.of_radius(radius, heights)))
            }
            _ => self.radii.panels(self.asperity_radius, &self.heights),
        }
    }

    /// The attraction between the mean planes, N, at a separation h of them, m.
    pub fn background_force(&self, separation: f64) -> f64 {
        self.nominal_area * self.background.as_ref().map_or(0.0, |background| background.pressure(separation))
    }

    /// The excess pull of liquid over its bridges on the way there or back, N, at a separation h of the mean
    /// planes, m.
    fn spread_force(&self, way: Option<&Spread>, separation: f64) -> f64 {
        self.nominal_area * way.map_or(0.0, |spread| spread.pressure(separation))
    }

    /// The external force, N, at a separation h of the mean planes, m: that of the asperities, N, less the
    /// attraction of the mean planes and of liquid that spreads between bridges.
    pub fn external_force(&self, separation: f64, of_asperities: f64) -> f64 {
        self.less(self.spread.first(), separation, of_asperities)
    }

    /// The external force on retraction of a loop, N, likewise.
    pub fn external_force_back(&self, separation: f64, of_asperities: f64) -> f64 {
        self.less(self.spread.get(1), separation, of_asperities)
    }

    /// The external force on the second approach of a loop, N, likewise.
    pub fn external_force_again(&self, separation: f64, of_asperities: f64) -> f64 {
        self.less(self.spread.get(2), separation, of_asperities)
    }

    fn less(&self, way: Option<&Spread>, separation: f64, of_asperities: f64) -> f64 {
        if self.background.is_none() && way.is_none() {
            return of_asperities;
        }
        of_asperities - self.background_force(separation) - self.spread_force(way, separation)
    }

    /// The surface under a body, on the area of all places that are at most as deep as `depth`, m, and a little more, so that
    /// the mean number of asperities is whole. Tips keep a least distance, m; 0 for none.
    pub fn under(self, shape: &Arc<dyn Shape>, depth: f64, distance: f64) -> Self {
        let (tip, density) = (self.asperity_radius, self.asperity_density);
        let largest = shape.area(shape.end(), tip);
        let count = (density * shape.area(depth, tip).min(largest)).ceil().max(1.0);
        let area = (count / density).min(largest);
        let depths = Depths { shape: Arc::clone(shape), tip, area, distance };
        let base = self.heights.clone();
        let law = HeightLaw::Lowered(Arc::new(Lowered::new(self.heights, depths)));
        Self {
            heights: Heights { law, ..base },
            asperity_radius: shape.touching(tip),
            asperity_count: (density * area).round().max(1.0) as usize,
            nominal_area: area,
            count_law: CountLaw::Poisson,
            ..self
        }
    }

    /// The flat surface that a body is over; itself without one.
    pub fn plane(&self) -> Cow<'_, Self> {
        let HeightLaw::Lowered(lowered) = &self.heights.law else { return Cow::Borrowed(self) };
        let Lowered { base, depths, .. } = &**lowered;
        Cow::Owned(Self { heights: base.clone(), asperity_radius: depths.tip, ..self.clone() })
    }

    /// The pressure, Pa, over the nominal area, of one, Pa, between flat faces, or over tips of a radius, m, at a separation h, m, at
    /// most `deepest`, m, behind the nearest point of a body. Faces are as tips of the radius 0.
    pub fn over_body(&self, tip: f64, deepest: f64, pressure: impl Fn(f64) -> f64, separation: f64) -> f64 {
        let Some(depths) = self.heights.depths() else { return pressure(separation) };
        let at = |depth: f64| [pressure(separation + depth)];
        let depths = Depths { tip, ..depths.clone() };
        depths.integral(self.surface_height_std, deepest, at)[0] / self.nominal_area
    }

    /// The force between the mean planes, per nominal area, of one that is between flat faces, at separations h, m, from the
    /// nearest on.
    pub fn force_over_body(&self, force: Arc<dyn MeanPlaneForce>, nearest: f64) -> Arc<dyn MeanPlaneForce> {
        match self.heights.depths() {
            Some(depths) => {
                let of_faces = Depths { tip: 0.0, ..depths.clone() };
                Arc::new(Curved::new(force, of_faces, self.nominal_area, nearest))
            }
            None => force,
        }
    }

    /// The area, m², that a small load is spread over: the nominal area, or under a body the area of the places that are at most
    /// σ deep.
    pub fn loaded_area(&self) -> f64 {
        match self.heights.depths() {
            Some(depths) => depths.share(self.surface_height_std) * depths.area,
            None => self.nominal_area,
        }
    }

    /// The geometric mean, m, of the principal radii of a body at its apex; nothing for flat patches and bodies without one.
    pub fn apex(&self) -> Option<f64> {
        self.heights.depths().and_then(|depths| depths.shape.apex(depths.tip))
    }

    /// d = h − y_s, m, from a separation h of the mean planes of the surfaces, m.
    pub fn asperity_separation(&self, separation: f64) -> f64 {
        separation - self.mean_plane_offset
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn case_ii() -> Roughness {
        Roughness {
            asperity_radius: 3.33e-6,
            asperity_density: 7.39e12,
            nominal_area: 1000e-12,
            surface_height_std: Some(1.619e-9),
            asperity_height_std: None,
            mean_plane_offset: None,
        }
    }

    #[test]
    fn conversions_follow_their_formulas() {
        let surface = Surface::new(&case_ii()).unwrap();
        let eta_r: f64 = 7.39e12 * 3.33e-6;
        let variance = 1.619e-9_f64.powi(2) - 3.717e-4 / eta_r.powi(2);
        assert!((surface.heights.std - variance.sqrt()).abs() < 1e-24);
        assert!((surface.mean_plane_offset - 0.045944 / eta_r).abs() < 1e-24);
        assert_eq!(surface.asperity_count, 7390);
        // Back from σ_s alone.
        let back = Roughness {
            surface_height_std: None,
            asperity_height_std: Some(surface.heights.std),
            ..case_ii()
        };
        assert!((Surface::new(&back).unwrap().surface_height_std - 1.619e-9).abs() < 1e-23);
    }

    #[test]
    fn what_cannot_be_is_refused() {
        let smooth = Roughness { surface_height_std: Some(1e-13), ..case_ii() };
        assert!(matches!(Surface::new(&smooth), Err(SurfaceError::NegativeVariance { .. })));
        let small = Roughness { nominal_area: 1e-14, ..case_ii() };
        assert!(matches!(Surface::new(&small), Err(SurfaceError::NoAsperity(_))));
        let large = Roughness { nominal_area: 1e-4, ..case_ii() };
        let Err(SurfaceError::TooMany { largest, .. }) = Surface::new(&large) else {
            panic!("it is too large")
        };
        let fits = Roughness { nominal_area: largest, ..case_ii() };
        assert_eq!(Surface::new(&fits).unwrap().asperity_count as u64, MOST_ASPERITIES);
        let unknown = Roughness { surface_height_std: None, ..case_ii() };
        assert_eq!(Surface::new(&unknown), Err(SurfaceError::NoHeightStd));
    }

    #[test]
    fn probabilities_keep_their_digits_in_the_tails() {
        let unit = Heights::gaussian(1.0);
        // Upper tail at 10 σ, 50-digit value.
        assert!((unit.probability(10.0, f64::INFINITY) / 7.619853024160526e-24 - 1.0).abs() < 1e-13);
        assert!((unit.probability(f64::NEG_INFINITY, -10.0) / 7.619853024160526e-24 - 1.0).abs() < 1e-13);
        assert!((unit.probability(-1.0, 1.0) - 0.682689492137086).abs() < 1e-15);
        assert_eq!(unit.probability(f64::NEG_INFINITY, f64::INFINITY), 1.0);
    }

    /// Probabilities and 50-digit quantiles.
    const QUANTILES: [(f64, f64); 6] = [
        (1e-17, -8.493793224109598),
        (1e-9, -5.9978070150076869),
        (3e-4, -3.431614403623269),
        (0.0625, -1.5341205443525463),
        (0.25, -0.6744897501960817),
        (0.4375, -0.1573106846101707),
    ];

    #[test]
    fn quantiles_keep_their_digits_in_the_lower_tail() {
        let unit = Heights::gaussian(1.0);
        for (probability, quantile) in QUANTILES {
            assert!((unit.gaussian_quantile(probability) / quantile - 1.0).abs() < 1e-15, "{probability:e}");
        }
        assert_eq!(Heights::gaussian(2.0).gaussian_quantile(0.5), 0.0);
    }
}
