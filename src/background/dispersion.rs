//! Forces of van der Waals between planes, across gaps that no asperity owns.
//!
//! # Formula
//! W = A/[12πz²(1 + bz)] and p = −dW/dz between planes z apart, b = 5.32/λ_r with retardation at the
//! wavelength λ_r and 0 without (Gregory, J. Colloid Interface Sci. 83 (1981) 138): p = A/6πz³ close by, and
//! A/4πbz⁴ far away. Faces that touch are Z₀ apart, as in the laws of asperities, so a gap g is z = g + Z₀ less
//! the film between them.
//!
//! # What asperities own
//! Laws with an attraction of a finite range own all gaps below it, and the background the others. Laws whose
//! attraction has no end own [`Caps`] of the surface, and the background the share of it that these leave.

use super::caps::Caps;
use super::roughness;
use super::{MeanPlaneForce, Strength};
use crate::format::{percent, si};
use std::f64::consts::PI;

/// λ_r b (Gregory 1981).
const RETARDATION: f64 = 5.32;

/// Dispersion forces between planes.
///
/// # Examples
/// ```
/// use stiction::background::VanDerWaals;
///
/// let retarded = VanDerWaals::new(1e-19, Some(100e-9));
/// assert!((retarded.at(10e-9).pressure / 4064.162214 - 1.0).abs() < 1e-9);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VanDerWaals {
    /// Hamaker constant A, J.
    hamaker_constant: f64,
    /// b, 1/m; 0 without retardation.
    retardation: f64,
}

impl VanDerWaals {
    /// Planes with a Hamaker constant A, J, whose forces are retarded by a wavelength λ_r, m, or not at all.
    pub fn new(hamaker_constant: f64, wavelength: Option<f64>) -> Self {
        Self { hamaker_constant, retardation: wavelength.map_or(0.0, |wavelength| RETARDATION / wavelength) }
    }

    /// The Hamaker constant that the Lennard-Jones attraction of asperities has, 16πΔγZ₀², J, from Δγ, J/m²,
    /// and Z₀, m.
    pub fn lennard_jones(work_of_adhesion: f64, equilibrium_spacing: f64) -> f64 {
        16.0 * PI * work_of_adhesion * equilibrium_spacing * equilibrium_spacing
    }

    /// The Hamaker constant A, J.
    pub fn hamaker_constant(&self) -> f64 {
        self.hamaker_constant
    }

    /// b, 1/m, of planes that are retarded.
    pub fn retardation(&self) -> Option<f64> {
        (self.retardation > 0.0).then_some(self.retardation)
    }

    /// The strength at a distance z, m, above 0.
    pub fn at(&self, distance: f64) -> Strength {
        let x = self.retardation * distance;
        let delay = 1.0 + x;
        let energy = self.hamaker_constant / (12.0 * PI * distance * distance * delay);
        let pressure = energy * (2.0 + 3.0 * x) / (distance * delay);
        let slope = -energy * (6.0 + x * (16.0 + 12.0 * x)) / (distance * distance * delay * delay);
        Strength { energy, pressure, slope }
    }
}

/// Dispersion forces between rough surfaces.
///
/// # Examples
/// ```
/// use stiction::background::{Background, Dispersion, VanDerWaals};
/// use std::sync::Arc;
///
/// let dispersion = Dispersion {
///     planes: VanDerWaals::new(1e-19, None),
///     smallest_gap: 1e-9,
///     contact_distance: 0.0,
///     caps: None,
/// };
/// let background = Background::new(vec![("van_der_waals", Arc::new(dispersion))], 1e-9, (4e-9, 6e-9));
/// assert!((background.pressure(5e-9) / 57774.21452 - 1.0).abs() < 1e-9);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Dispersion {
    /// Dispersion forces between planes.
    pub planes: VanDerWaals,
    /// The gap from which on the background acts, m.
    pub smallest_gap: f64,
    /// The distance of planes whose gap is 0, Z₀ less the film, m; with the smallest gap it comes to more than 0.
    pub contact_distance: f64,
    /// Caps of asperities whose attraction has no end.
    pub caps: Option<Caps>,
}

impl Dispersion {
    /// The strength between planes at a gap, m.
    fn at(&self, gap: f64) -> Strength {
        self.planes.at(gap + self.contact_distance)
    }
}

impl MeanPlaneForce for Dispersion {
    fn strength(&self, std: f64, separation: f64) -> Strength {
        let mean = roughness::mean_over_gaps(std, separation, (self.smallest_gap, 0.0), |gap| self.at(gap));
        self.caps
            .as_ref()
            .map_or(mean, |caps| mean.times(1.0 - caps.share).plus(caps.beyond(separation).times(-1.0)))
    }

    fn pressure(&self, std: f64, separation: f64) -> f64 {
        let mean = roughness::mean_pressure(std, separation, (self.smallest_gap, 0.0), |gap| self.at(gap));
        let rest = |caps: &Caps| (1.0 - caps.share) * mean - caps.pressure_beyond(separation);
        self.caps.as_ref().map_or(mean, rest)
    }

    fn cancelled(&self, separation: f64) -> f64 {
        self.caps.as_ref().map_or(0.0, |caps| caps.pressure_beyond(separation))
    }

    fn about(&self) -> String {
        let retarded = if self.planes.retardation().is_some() { ", retarded" } else { "" };
        let owned = match &self.caps {
            Some(caps) => format!("asperities own caps of {} of the area", percent(caps.share)),
            None => format!("asperities own gaps below {}", si(self.smallest_gap, "m")),
        };
        format!("van der Waals, A = {}{retarded}: {owned}", si(self.planes.hamaker_constant(), "J"))
    }
}
