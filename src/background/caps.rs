//! Caps of asperities whose attraction has no end.
//!
//! # Formula
//! The attraction of a paraboloid to a plane, 2πRW(D) by Derjaguin, reaches over the whole paraboloid. Of a
//! surface with η asperities per area it would count the same area over and over, and the mean planes once
//! more. An asperity owns a cap of the radius ρ, so that ηπρ² is the share s of the area: that has 2πR[W(D) −
//! W(D + ρ²/2R)], ρ²/2R = s/2πηR. The law has the first term; the second, of what is beyond the caps, is taken off
//! here, as a mean over heights and radii. W = Δγ[(4/3)(Z₀/z)² − (1/3)(Z₀/z)⁸], the Lennard-Jones attraction of
//! the laws, at z = D + Z₀ less the film between the surfaces; Δγ where that is below Z₀.
//!
//! The laws know no retardation. Where the mean planes are retarded, b > 0, what caps keep is so too, from the distance z_c on
//! where the range of Dugdale's stress ends; up to there a law has all of its Δγ. In the place of W from there on is W − W_e,
//!
//! W_e = (4/3)ΔγZ₀²/z² [1 − (1 + bz_c)/(1 + bz)], z > z_c,
//!
//! and so 2πR[W_e(D) + (W − W_e)(D + ρ²/2R)] is taken off.
//!
//! # Validity
//! The second term hardly depends on the height: replicas differ in it by far less than in the first.

use super::Strength;
use crate::math::quadrature::{NODES, Rule};
use std::f64::consts::PI;
use std::fmt::Debug;
use std::sync::Arc;

/// Relative accuracy of the quadrature over heights.
const TOLERANCE: f64 = 1e-13;

/// A law of heights of asperities, as means over it need it.
pub trait CapHeights: Debug + Send + Sync {
    /// The mean of given heights, each as likely, and their deviations from it, m; none where there is a density.
    fn given(&self) -> Option<(f64, &[f64])>;

    /// Probability density at a height, m: 1/m.
    fn density(&self, height: f64) -> f64;

    /// Rising heights, m, from where the lowest are that count to where the highest are, between which the density is
    /// smooth.
    fn ends(&self) -> Vec<f64>;
}

/// Asperities of a radius.
#[derive(Clone, Debug)]
pub struct Cap {
    /// Radius, m.
    pub radius: f64,
    /// The share of the asperities with this radius.
    pub weight: f64,
    /// Heights of these asperities above the mean plane of all.
    pub heights: Arc<dyn CapHeights>,
}

impl PartialEq for Cap {
    fn eq(&self, other: &Self) -> bool {
        let of = |own: &Self| (own.radius, own.weight, format!("{:?}", own.heights));
        of(self) == of(other)
    }
}

/// The caps of a surface.
///
/// # Examples
/// ```
/// use std::sync::Arc;
/// use stiction::background::{Cap, CapHeights, Caps};
/// use stiction::surface::Heights;
///
/// let heights: Arc<dyn CapHeights> = Arc::new(Heights::sample(vec![0.0, 0.0]));
/// let caps = Caps {
///     share: 1.0,
///     density: 7.39e12,
///     work_of_adhesion: 0.09,
///     equilibrium_spacing: 0.2e-9,
///     contact_distance: 0.2e-9,
///     mean_plane_offset: 0.0,
///     classes: vec![Cap { radius: 3.33e-6, weight: 1.0, heights }],
///     retardation: None,
/// };
/// // ρ²/2R = 6.4674 nm, which with D = 2 nm is 8.6674 nm between the surfaces: 4/3 of (0.2/8.6674)² Δγ.
/// let expected = 2.0 * std::f64::consts::PI * 7.39e12 * 3.33e-6 * 0.09 * 4.0 / 3.0 * (0.2_f64 / 8.6674).powi(2);
/// assert!((caps.beyond(2e-9).pressure / expected - 1.0).abs() < 1e-4);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Caps {
    /// The share ηπρ² of the area, above 0 and at most 1.
    pub share: f64,
    /// Asperities per area η, 1/m².
    pub density: f64,
    /// Work of adhesion Δγ, J/m².
    pub work_of_adhesion: f64,
    /// Equilibrium spacing Z₀, m.
    pub equilibrium_spacing: f64,
    /// The distance of surfaces whose gap is 0, Z₀ less the film, m.
    pub contact_distance: f64,
    /// Height of the mean plane of the asperities above the mean plane of the surface, m.
    pub mean_plane_offset: f64,
    /// The asperities by their radii; their weights add up to 1.
    pub classes: Vec<Cap>,
    /// Retardation of the attraction that they keep, if it is retarded.
    pub retardation: Option<CapRetardation>,
}

/// The retardation of caps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CapRetardation {
    /// b, 1/m.
    pub rate: f64,
    /// z_c, m.
    pub from: f64,
}

impl CapRetardation {
    /// W_e over (4/3)ΔγZ₀², with its integral and derivative, at a distance, m: 1/m², 1/m, 1/m³.
    fn excess(&self, distance: f64) -> Strength {
        let Self { rate, from } = *self;
        let z = distance.max(from);
        let (inverse, delay, kept) = (1.0 / z, 1.0 + rate * z, 1.0 + rate * from);
        let logarithm = libm::log1p(1.0 / (rate * z));
        let slope = -2.0 + kept * (2.0 + 3.0 * rate * z) / (delay * delay);
        Strength {
            energy: inverse - kept * (inverse - rate * logarithm),
            pressure: rate * (z - from) / delay * inverse * inverse,
            slope: if distance < from { 0.0 } else { slope * inverse * inverse * inverse },
        }
    }
}

impl Caps {
    /// The attraction that is taken off the asperities, of what is beyond the caps and of what retardation leaves out, per
    /// nominal area, at a separation h of the mean planes, m.
    pub fn beyond(&self, separation: f64) -> Strength {
        let of = |Strength { energy, pressure, slope }| [energy, pressure, slope];
        let [energy, pressure, slope] = self.taken_off(separation, of);
        Strength { energy, pressure, slope }
    }

    /// The pressure of it, Pa.
    pub fn pressure_beyond(&self, separation: f64) -> f64 {
        self.taken_off(separation, |strength| [strength.pressure])[0]
    }

    fn taken_off<const N: usize>(&self, separation: f64, of: impl Fn(Strength) -> [f64; N]) -> [f64; N] {
        let mut sums = [0.0; N];
        for (factor, cap) in self.weighted() {
            // The distance of an asperity is this less its height.
            let largest = self.contact_distance + separation - self.mean_plane_offset;
            let depth = self.share / (2.0 * PI * self.density * cap.radius);
            let beyond =
                self.mean(cap, largest + depth, |z| of(self.work(z).plus(self.excess(z).times(-1.0))));
            sums.iter_mut().zip(beyond).for_each(|(sum, own)| *sum += factor * own);
            if self.retardation.is_some() {
                let excess = self.mean(cap, largest, |z| of(self.excess(z)));
                sums.iter_mut().zip(excess).for_each(|(sum, own)| *sum += factor * own);
            }
        }
        sums
    }

    /// W_e as a pressure, with its integral and derivative.
    fn excess(&self, distance: f64) -> Strength {
        let unit = 4.0 / 3.0 * self.work_of_adhesion * self.equilibrium_spacing * self.equilibrium_spacing;
        self.retardation.map_or(Strength::default(), |own| own.excess(distance).times(unit))
    }

    /// The asperities of each radius, and their share of 2πηR, 1/m.
    fn weighted(&self) -> impl Iterator<Item = (f64, &Cap)> {
        self.classes.iter().map(|cap| (cap.weight * 2.0 * PI * self.density * cap.radius, cap))
    }

    /// The mean of a function of a distance, m, which is `largest`, m, less the height of an asperity, over the asperities of a radius.
    fn mean<const N: usize>(&self, cap: &Cap, largest: f64, of: impl Fn(f64) -> [f64; N]) -> [f64; N] {
        if let Some((mean, deviations)) = cap.heights.given() {
            let mut sums = [0.0; N];
            for deviation in deviations {
                let own = of(largest - (mean + deviation));
                sums.iter_mut().zip(own).for_each(|(sum, own)| *sum += own / deviations.len() as f64);
            }
            return sums;
        }
        // W is constant from Z₀ on, and rises steeply towards that; W_e ends at z_c.
        let kinks = [Some(self.equilibrium_spacing), self.retardation.map(|own| own.from)];
        let mut ends = cap.heights.ends();
        ends.dedup();
        for kink in kinks.into_iter().flatten().map(|distance| largest - distance) {
            if ends.first().is_some_and(|first| *first < kink) && ends.last().is_some_and(|last| kink < *last)
            {
                ends.push(kink);
                ends.sort_by(f64::total_cmp);
            }
        }
        let weighted = |heights: &[f64; NODES], values: &mut [[f64; N]; NODES]| {
            for (value, height) in values.iter_mut().zip(heights) {
                let density = cap.heights.density(*height);
                *value = of(largest - height).map(|own| density * own);
            }
        };
        Rule::shared().integrate(&ends, TOLERANCE, weighted).value
    }

    /// W between planes at a distance, m, as a pressure, with its integral and derivative.
    fn work(&self, distance: f64) -> Strength {
        let (work, spacing) = (self.work_of_adhesion, self.equilibrium_spacing);
        let q = (spacing / distance.max(spacing)).min(1.0);
        let (square, eighth) = (q * q, q.powi(8));
        Strength {
            energy: work * (spacing * (4.0 / 3.0 * q - q.powi(7) / 21.0) + (spacing - distance).max(0.0)),
            pressure: work * (4.0 * square - eighth) / 3.0,
            slope: -8.0 / 3.0 * work / spacing * q * (square - eighth),
        }
    }
}
