//! Whether the asperities of a patch may be taken as independent of each other, judged from its integral.
//!
//! A patch of side L rests on its own half-space. A uniform pressure p̄ on it makes the mean displacement
//! c p̄ L/E*, so it rests on a spring k_s = E* L/c, and by mean field its force is F(d) = F_GW(d + F/k_s): a
//! shift of the separation, as long as no attraction is as stiff as the spring. What the mean leaves out, for
//! asperities at places that are uniformly random, scatters their displacements by
//! σ_u² = 2π η ⟨f²⟩ ln(L/b)/(πE*)², with b half of 1/√η. A modulation of wavelength Λ is held by πE*/Λ per
//! area: an attraction of the stiffness s per area is stable against wavelengths below Λ_c = πE*/s.
//!
//! Under a body of the radius R_m at its apex the load F acts on a circle, and Hertz's contact of the smooth body is displaced by
//! δ = (9F²/16R_m E*²)^(1/3), in place of the shift F/k_s. Roughness spreads a load, so it is displaced by less; JKR's contact,
//! which at its pull-off has the radius of Hertz's under an equal load, is stretched by δ/3. σ/δ is α of Johnson. The patch is
//! the circle of the radius a² = R_m δ + 2R_m σ: that of Hertz's contact, and what is within σ of the apex under small loads.
//!
//! Sources: Johnson, Contact Mechanics (1985), sections 3.3 (c) and 13.5; Greenwood and Tripp, J. Appl. Mech.
//! 34 (1967) 153; Fuller and Tabor, Proc. R. Soc. A 345 (1975) 327; Ciavarella, Greenwood and Paggi, Wear 265
//! (2008) 729 (mean field).

use super::expectations::Expectations;
use crate::asperity::Quantity;
use crate::asperity::scale::Asperity;
use crate::surface::Surface;
use std::f64::consts::PI;

/// c of a square, (4/π)(ln(1 + √2) + (1 − √2)/3).
const SQUARE: f64 = 0.946_402_008_818_677_1;

/// Accuracy of the separation from which on asperities may be taken as independent, in σ.
const ACCURACY: f64 = 1e-5;

/// Stiffness k_s, N/m, of a half-space of the modulus E*, Pa, under a uniform pressure on a square of an area,
/// m².
///
/// # Examples
/// ```
/// use stiction::integral::substrate_stiffness;
///
/// let stiffness = substrate_stiffness(85.29e9, 1000e-12);
/// assert!((stiffness / 2.85e6 - 1.0).abs() < 1e-3);
/// ```
pub fn substrate_stiffness(reduced_modulus: f64, area: f64) -> f64 {
    reduced_modulus * area.sqrt() / SQUARE
}

/// The limits of a figure by which independence is judged.
///
/// # Examples
/// ```
/// use stiction::integral::{Independence, Limit};
///
/// let [_, Limit { name, good, invalid }, ..] = Independence::LIMITS;
/// assert_eq!((name, good, invalid), ("relative_attractive_stiffness", 0.05, 1.0));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limit {
    /// The figure, by its name in files.
    pub name: &'static str,
    /// Independence is good up to here.
    pub good: f64,
    /// Independence is invalid from here on; infinite where the figure makes a shift only.
    pub invalid: f64,
}

/// The verdict on the independence of the asperities.
///
/// # Examples
/// ```
/// use stiction::integral::IndependenceVerdict;
///
/// let scene = stiction::Scene::from_toml_file("configs/quick.toml")?;
/// let verdict: IndependenceVerdict = stiction::integrate(&scene)?.main.independence.verdict();
/// assert_eq!(verdict.name(), "good");
/// # Ok::<(), stiction::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum IndependenceVerdict {
    /// Coupling through the substrate changes little where the surfaces are pulled off.
    Good,
    /// Every force of the curve is at another separation, by mean field.
    Shift,
    /// The patch has another curve.
    Invalid,
}

impl IndependenceVerdict {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Good, Self::Shift, Self::Invalid];

    /// The word, in files and on the terminal.
    pub fn name(self) -> &'static str {
        match self {
            Self::Good => "good",
            Self::Shift => "a shift",
            Self::Invalid => "invalid",
        }
    }
}

/// The integral along the path on which surfaces are pulled off, as it is judged.
pub struct IntegralCurve<'a> {
    /// The separations h, m, rising.
    pub separations: &'a [f64],
    /// The external force at them, N.
    pub force: &'a [f64],
    /// The largest load, N, after which surfaces are pulled back; infinite where it is the one at the smallest separation.
    pub largest_load: f64,
    /// The integral at pull-off, or at the smallest separation where nothing pulls.
    pub at_pull_off: &'a Expectations,
    /// The largest slope of the external force, N/m.
    pub largest_slope: f64,
}

/// Figures by which the independence of the asperities of a patch is judged: at the pull-off of its
/// integral, or at the smallest separation where nothing pulls.
///
/// # Examples
/// ```
/// use stiction::integral::Independence;
///
/// let scene = stiction::Scene::from_toml_file("configs/case_iii.toml")?;
/// let independence: Independence = stiction::integrate(&scene)?.main.independence;
/// assert_eq!(independence.verdict().name(), "invalid");
/// let ratio = independence.relative_attractive_stiffness();
/// assert!((21.5..22.5).contains(&ratio), "attraction is 22 times as stiff as the half-space");
/// # Ok::<(), stiction::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Independence {
    /// Standard deviation σ of the surface heights, m.
    pub surface_height_std: f64,
    /// Side L of the patch, m: the root of its area, the nominal one, or the one that is loaded under a body.
    pub patch_side: f64,
    /// Stiffness k_s of the half-space under the patch, N/m.
    pub substrate_stiffness: f64,
    /// Shift F/k_s, m, by which the asperities are further from the other surface, or Hertz's δ of a body; negative at a pull-off.
    pub shift: f64,
    /// Largest dF/dh of the external force along the path, N/m; 0 where it nowhere rises.
    pub attractive_stiffness: f64,
    /// Standard deviation σ_u of the displacements of asperities at uniformly random places, m.
    pub fluctuation: f64,
    /// Share of the area of the patch in contact.
    pub contact_share: f64,
    /// Shift under the largest load, m: the largest preload, or what acts at the smallest separation.
    pub closest_shift: f64,
    /// Separation h, m, from which on no shift is beyond its limit; NaN where it still is at the largest one.
    pub independent_from: f64,
    /// μ = (8/3) η σ_s √(2 R_m R) of Greenwood and Tripp: 1.2 times the pressure of asperities that overlap by σ_s over that of
    /// Hertz's contact of the smooth body under the displacement σ_s. Nothing without an apex.
    pub greenwood_tripp: Option<f64>,
    /// θ = E* σ_s^(3/2)/(√R Δγ) of Fuller and Tabor. JKR's asperity is stretched by (3/4)(π/θ)^(2/3) σ_s where it lets go.
    pub fuller_tabor: f64,
}

impl Independence {
    /// Limits of the figures in the order of [`Independence::figures`]. Up to 0.05 a length in σ, or a stiffness
    /// in k_s, changes forces at a separation by some per cent; up to 0.01 in contact 4 % of contacts at random
    /// overlap another. From k_s on the force at a separation is no longer one; from 0.3 σ on the heights seem
    /// wider by 4 %; from 0.1 in contact one contact in three overlaps another.
    pub const LIMITS: [Limit; 4] = [
        Limit { name: "relative_shift", good: 0.05, invalid: f64::INFINITY },
        Limit { name: "relative_attractive_stiffness", good: 0.05, invalid: 1.0 },
        Limit { name: "relative_fluctuation", good: 0.05, invalid: 0.3 },
        Limit { name: "contact_share", good: 0.01, invalid: 0.1 },
    ];

    /// Judges a surface of asperities, on bodies of their modulus, by the curve of its integral, which is `force_at`, N,
    /// at any separation h, m.
    #[doc(hidden)]
    pub fn new(
        surface: &Surface,
        asperity: &Asperity,
        curve: &IntegralCurve<'_>,
        force_at: impl Fn(f64) -> f64,
    ) -> Self {
        let IntegralCurve { force, largest_load, at_pull_off, largest_slope, .. } = *curve;
        let (modulus, apex) = (asperity.reduced_modulus, surface.apex());
        let expected = |quantity: Quantity| at_pull_off.expected[quantity.index()][0];
        let pull_off = expected(Quantity::ExternalForce);
        let hertz = apex.map(|radius| 4.0 / 3.0 * modulus * radius.sqrt());
        let of_hertz = |force: f64| hertz.map(|hertz| libm::cbrt((force / hertz).powi(2)).copysign(force));
        let of_contact =
            apex.zip(of_hertz(pull_off)).map_or(0.0, |(radius, depth)| PI * radius * depth.abs());
        let area = surface.loaded_area() + of_contact;
        let stiffness = substrate_stiffness(modulus, area);
        let shift = |force: f64| of_hertz(force).unwrap_or(force / stiffness);
        let count = surface.asperity_count as f64;
        // L/b = 2 √N.
        let variance =
            2.0 * PI * count / area * at_pull_off.mean_square_force[0] * libm::log(2.0 * count.sqrt())
                / (PI * modulus).powi(2);
        let accuracy = ACCURACY * surface.surface_height_std;
        let largest_shift = Self::LIMITS[0].good * surface.surface_height_std;
        let largest_force =
            hertz.map_or(largest_shift * stiffness, |hertz| hertz * largest_shift * largest_shift.sqrt());
        let (sigma, radius) = (surface.heights.std, surface.asperity_radius);
        Self {
            surface_height_std: surface.surface_height_std,
            patch_side: area.sqrt(),
            substrate_stiffness: stiffness,
            shift: shift(pull_off),
            attractive_stiffness: if largest_slope < 0.0 { 0.0 } else { largest_slope },
            fluctuation: variance.sqrt(),
            contact_share: expected(Quantity::ContactArea) / area,
            closest_shift: shift(force[0].min(largest_load)),
            independent_from: from_where(curve, largest_force, accuracy, force_at),
            greenwood_tripp: apex
                .map(|apex| 8.0 / 3.0 * surface.asperity_density * sigma * (2.0 * apex * radius).sqrt()),
            fuller_tabor: modulus * sigma * (sigma / radius).sqrt() / asperity.work_of_adhesion,
        }
    }

    /// The shift over σ.
    pub fn relative_shift(&self) -> f64 {
        self.shift / self.surface_height_std
    }

    /// The shift under the largest load over σ.
    pub fn relative_closest_shift(&self) -> f64 {
        self.closest_shift / self.surface_height_std
    }

    /// The attractive stiffness over that of the half-space.
    pub fn relative_attractive_stiffness(&self) -> f64 {
        self.attractive_stiffness / self.substrate_stiffness
    }

    /// The fluctuation over σ.
    pub fn relative_fluctuation(&self) -> f64 {
        self.fluctuation / self.surface_height_std
    }

    /// The longest wavelength Λ_c, m, at which the surfaces are stable where they attract most stiffly;
    /// infinite without attraction.
    pub fn longest_stable_wavelength(&self) -> f64 {
        // E* = c k_s/L, and the stiffness is that of the area L².
        PI * SQUARE * self.patch_side / self.relative_attractive_stiffness()
    }

    /// The figures that [`Independence::LIMITS`] are of.
    pub fn figures(&self) -> [f64; 4] {
        [
            self.relative_shift().abs(),
            self.relative_attractive_stiffness(),
            self.relative_fluctuation(),
            self.contact_share,
        ]
    }

    /// The verdict on independence; invalid where a figure is not a number.
    pub fn verdict(&self) -> IndependenceVerdict {
        let all = |is_within: fn(f64, &Limit) -> bool| {
            self.figures().into_iter().zip(&Self::LIMITS).all(|(figure, limit)| is_within(figure, limit))
        };
        match () {
            () if all(|figure, limit| figure <= limit.good) => IndependenceVerdict::Good,
            () if all(|figure, limit| figure < limit.invalid) => IndependenceVerdict::Shift,
            () => IndependenceVerdict::Invalid,
        }
    }
}

/// The separation from which on no force is larger than a limit, N, to an accuracy, m; NaN where the force at
/// the largest one is.
fn from_where(
    IntegralCurve { separations, force, .. }: &IntegralCurve<'_>,
    limit: f64,
    accuracy: f64,
    force_at: impl Fn(f64) -> f64,
) -> f64 {
    let is_within = |force: f64| force.abs() <= limit;
    let Some(last) = force.iter().rposition(|&force| !is_within(force)) else { return separations[0] };
    let Some(&next) = separations.get(last + 1) else { return f64::NAN };
    let (mut beyond, mut within) = (separations[last], next);
    while within - beyond > accuracy {
        let middle = 0.5 * (beyond + within);
        if middle <= beyond || middle >= within {
            break;
        }
        *(if is_within(force_at(middle)) { &mut within } else { &mut beyond }) = middle;
    }
    within
}
