//! From SI quantities to the scaled variables of the elastic laws and back.

use super::error::LawError;
use std::f64::consts::PI;

/// σ₀Z₀/Δγ: the stress of the Dugdale zone in units of Δγ/Z₀ (Shi and Polycarpou 2005, eq. 6).
pub const STRESS_RATIO: f64 = 1.03;

/// One asperity against a flat: geometry and material, SI.
///
/// # Examples
/// ```
/// use stiction::asperity::{Asperity, LawParameters, Path, SolvedAsperity, model};
/// use std::f64::consts::PI;
///
/// let asperity = Asperity {
///     radius: 1e-6,
///     reduced_modulus: 100e9,
///     work_of_adhesion: 0.05,
///     equilibrium_spacing: 0.2e-9,
///     hardness: 5e9,
///     poisson_ratio: 0.3,
///     lubricant_thickness: 0.0,
/// };
/// let parameters = LawParameters::new(&asperity, Path::Approach, (-1e-9, 1e-9))?;
/// let law = model("dmt").unwrap().law(&parameters)?;
/// // Derjaguin, Muller and Toporov's pull-off, where contact begins.
/// let force = SolvedAsperity::new(law.as_ref(), 0.0).external_force();
/// assert!((force / (-2.0 * PI * 1e-6 * 0.05) - 1.0).abs() < 1e-14);
/// # Ok::<(), stiction::asperity::LawError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Asperity {
    /// Radius of curvature R, m.
    pub radius: f64,
    /// Reduced modulus E*, Pa.
    pub reduced_modulus: f64,
    /// Work of adhesion Δγ, J/m².
    pub work_of_adhesion: f64,
    /// Equilibrium spacing Z₀, m.
    pub equilibrium_spacing: f64,
    /// Hardness H of the softer body, Pa; infinite where nothing yields.
    pub hardness: f64,
    /// Poisson ratio ν of the softer body; of no use where nothing yields.
    pub poisson_ratio: f64,
    /// Lubricant thickness t, m; 0 when dry.
    pub lubricant_thickness: f64,
}

impl Asperity {
    /// Maximum contact pressure factor k.
    pub fn pressure_factor(&self) -> f64 {
        pressure_factor(self.poisson_ratio)
    }

    /// Range Z₀/1.03 of the attraction of dry solids with the stress of Dugdale, m.
    pub fn attraction_range(&self) -> f64 {
        self.equilibrium_spacing / STRESS_RATIO
    }

    /// Critical interference ω_c = (πkH/2E_r)²R at which plastic plastic deformation begins, m.
    pub fn critical_interference(&self) -> f64 {
        if self.hardness == f64::INFINITY {
            return f64::INFINITY;
        }
        let strain = 0.5 * PI * self.pressure_factor() * self.hardness / self.reduced_modulus;
        strain * strain * self.radius
    }

    /// Plasticity index ψ = √(σ/ω_c) of heights with a standard deviation, m: that of the asperities for
    /// Greenwood and Williamson's (1966), to which the limits 0.6 of elastic and 1 of plastic contact belong,
    /// that of the surface for what Shi and Polycarpou (2005, eq. 14) print.
    pub fn plasticity_index(&self, height_std: f64) -> f64 {
        (height_std / self.critical_interference()).sqrt()
    }
}

/// Maximum contact pressure factor k = 0.454 + 0.41ν (Chang, Etsion and Bogy 1987).
pub fn pressure_factor(poisson_ratio: f64) -> f64 {
    0.454 + 0.41 * poisson_ratio
}

/// ν of a maximum contact pressure factor.
pub fn poisson_ratio(pressure_factor: f64) -> f64 {
    (pressure_factor - 0.454) / 0.41
}

/// The adhesion parameters that the equations are solved for.
pub const LAMBDA_RANGE: (f64, f64) = (1e-6, 1e6);

/// Units, SI, that leave room for the powers and sums that are taken of them, and lengths as multiples of a
/// unit.
pub const UNIT_RANGE: (f64, f64) = (1e-60, 1e60);

/// Whether a unit is within [`UNIT_RANGE`].
fn has_room(unit: f64) -> bool {
    (UNIT_RANGE.0..=UNIT_RANGE.1).contains(&unit)
}

/// The units of the scaled variables (Maugis 1992).
///
/// # Examples
/// ```
/// use stiction::asperity::{Asperity, Scale};
///
/// # let asperity = Asperity {
/// #     radius: 1e-6,
/// #     reduced_modulus: 100e9,
/// #     work_of_adhesion: 0.05,
/// #     equilibrium_spacing: 0.2e-9,
/// #     hardness: 5e9,
/// #     poisson_ratio: 0.3,
/// #     lubricant_thickness: 0.0,
/// # };
/// let scale: Scale = Scale::new(&asperity)?;
/// assert_eq!(scale.force, std::f64::consts::PI * asperity.work_of_adhesion * asperity.radius);
/// assert!((scale.equilibrium_spacing() / 0.2e-9 - 1.0).abs() < 1e-14);
/// # Ok::<(), stiction::asperity::LawError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scale {
    /// Adhesion parameter λ = 2σ₀(R/(πΔγK²))^(1/3), σ₀ = 1.03Δγ/Z₀, K = 4E_r/3.
    pub lambda: f64,
    /// Unit of the approach, s_δ = (π²Δγ²R/K²)^(1/3), m.
    pub length: f64,
    /// Unit of the contact radius, s_a = (πΔγR²/K)^(1/3), m.
    pub radius: f64,
    /// Unit of force, s_F = πΔγR, N.
    pub force: f64,
}

impl Scale {
    /// The units of an asperity of `ratio` times the radius.
    #[doc(hidden)]
    pub fn of_ratio(&self, ratio: f64) -> Self {
        let root = libm::cbrt(ratio);
        Self {
            lambda: self.lambda * root,
            length: self.length * root,
            radius: self.radius * (root * root),
            force: self.force * ratio,
        }
    }

    /// The units for an asperity.
    ///
    /// # Errors
    /// [`LawError::NotPositive`] when one of R, E*, Δγ, Z₀ is not positive and finite, [`LawError::Unit`]
    /// when a unit of the scaled variables is outside [`UNIT_RANGE`], [`LawError::Lambda`] when λ is outside
    /// [`LAMBDA_RANGE`].
    pub fn new(asperity: &Asperity) -> Result<Self, LawError> {
        let positive = [
            ("asperity_radius", asperity.radius),
            ("reduced_modulus", asperity.reduced_modulus),
            ("work_of_adhesion", asperity.work_of_adhesion),
            ("equilibrium_spacing", asperity.equilibrium_spacing),
        ];
        if let Some(&(name, value)) = positive.iter().find(|(_, value)| !(*value > 0.0 && value.is_finite()))
        {
            return Err(LawError::NotPositive { name, value });
        }
        let k = 4.0 / 3.0 * asperity.reduced_modulus;
        let r = asperity.radius;
        let force = PI * asperity.work_of_adhesion * r;
        let strain = PI * asperity.work_of_adhesion / (k * r);
        let strain_root = libm::cbrt(strain);
        let (length, radius) = (strain_root * strain_root * r, strain_root * r);
        let units = [("force", force), ("approach", length), ("contact radius", radius)];
        if let Some(&(name, value)) = units.iter().find(|(_, unit)| !has_room(*unit)) {
            return Err(LawError::Unit { name, value });
        }
        // A product below the normal numbers has lost digits, though the units may look well.
        if !(strain.is_normal() && (k * r).is_normal()) {
            return Err(LawError::Unit { name: "strain", value: strain });
        }
        let lambda = 2.0 * STRESS_RATIO / PI * length / asperity.equilibrium_spacing;
        Ok(Self { radius, force, length, ..Self::unit(lambda)? })
    }

    /// Scaled variables as they are: every unit 1.
    ///
    /// # Errors
    /// [`LawError::Lambda`] when λ is outside [`LAMBDA_RANGE`] or not a number.
    pub fn unit(lambda: f64) -> Result<Self, LawError> {
        if !(lambda >= LAMBDA_RANGE.0 && lambda <= LAMBDA_RANGE.1) {
            return Err(LawError::Lambda(lambda));
        }
        Ok(Self { lambda, length: 1.0, radius: 1.0, force: 1.0 })
    }

    /// The units of the same sphere for `ratio` times the work of adhesion, with a Dugdale stress of that over `range`, m.
    ///
    /// # Errors
    /// [`LawError::Lambda`] when λ is outside [`LAMBDA_RANGE`], [`LawError::Unit`] as [`Scale::new`].
    pub fn with_energy(&self, ratio: f64, range: f64) -> Result<Self, LawError> {
        let root = libm::cbrt(ratio);
        let (length, radius, force) = (self.length * root * root, self.radius * root, self.force * ratio);
        let units = [("force", force), ("approach", length), ("contact radius", radius)];
        if let Some(&(name, value)) = units.iter().find(|(_, unit)| !has_room(*unit)) {
            return Err(LawError::Unit { name, value });
        }
        Ok(Self { length, radius, force, ..Self::unit(2.0 / PI * length / range)? })
    }

    /// The radius of the asperity, m: s_a²/s_δ.
    pub fn asperity_radius(&self) -> f64 {
        self.radius * self.radius / self.length
    }

    /// K = 4E_r/3, Pa: s_F/(s_a s_δ).
    pub fn stiffness(&self) -> f64 {
        self.force / (self.radius * self.length)
    }

    /// Δγ, J/m²: s_F/(πR).
    pub fn work_of_adhesion(&self) -> f64 {
        self.force / (PI * self.asperity_radius())
    }

    /// The unit of energy, s_F s_δ, J.
    pub fn energy(&self) -> f64 {
        self.force * self.length
    }

    /// Z₀, m.
    pub fn equilibrium_spacing(&self) -> f64 {
        2.0 * STRESS_RATIO / (PI * self.lambda) * self.length
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The paper's Table 2.
    fn case(radius: f64, work_of_adhesion: f64) -> Asperity {
        Asperity {
            radius,
            reduced_modulus: 85.29e9,
            work_of_adhesion,
            equilibrium_spacing: 0.2e-9,
            hardness: 2.5e9,
            poisson_ratio: 0.196,
            lubricant_thickness: 0.0,
        }
    }

    #[test]
    fn reproduces_the_parameters_of_table_2() {
        let rows = [
            ((1.66e-6, 0.01), (3.40e-9, 8.51e12), (0.16, 1.76)),
            ((3.33e-6, 0.09), (1.619e-9, 7.39e12), (0.90, 0.84)),
            ((6.38e-6, 0.30), (0.6541e-9, 9.87e12), (2.49, 0.39)),
        ];
        for ((radius, work), (std, density), (lambda, psi)) in rows {
            let asperity = case(radius, work);
            // The table rounds λ of case I up from 0.1549 to 0.16, and ψ, of σ_s, to two digits.
            assert!((Scale::new(&asperity).unwrap().lambda - lambda).abs() < 0.01);
            let asperity_std = f64::sqrt(std * std - 3.717e-4 / (density * radius).powi(2));
            let [of_asperities, of_surface] = [asperity_std, std].map(|std| asperity.plasticity_index(std));
            assert!((of_asperities - psi).abs() < 0.005, "{of_asperities}");
            assert!((of_surface - psi).abs() > 0.005, "{of_surface}");
        }
    }

    #[test]
    fn units_follow_their_definitions_away_from_one() {
        let asperity = case(3.33e-6, 0.09);
        let scale = Scale::new(&asperity).unwrap();
        let k = 4.0 / 3.0 * 85.29e9;
        let (pi, g, r) = (PI, 0.09_f64, 3.33e-6_f64);
        let close = |a: f64, b: f64| assert!((a / b - 1.0).abs() < 1e-14, "{a} {b}");
        close(scale.length, (pi * pi * g * g * r / (k * k)).cbrt());
        close(scale.radius, (pi * g * r * r / k).cbrt());
        close(scale.force, pi * g * r);
        close(scale.lambda, 2.0 * 1.03 * g / 0.2e-9 * (r / (pi * g * k * k)).cbrt());
    }

    #[test]
    fn refuses_what_is_not_positive() {
        for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(Scale::new(&case(bad, 0.09)).is_err());
            assert!(Scale::new(&case(1e-6, bad)).is_err());
        }
    }
}
