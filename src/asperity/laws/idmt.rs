//! The improved Derjaguin-Muller-Toporov law: the Lennard-Jones attraction of an undeformed sphere before contact, DMT in contact.
//!
//! # Formula
//! At the gap g = Z₀ − δ ≥ Z₀: F_s = (8/3)πRΔγ[(Z₀/g)² − (1/4)(Z₀/g)⁸]; in contact as [`super::dmt`].
//!
//! # Validity
//! Elastic spheres of low λ. Source: Muller, Derjaguin and Toporov, Colloids Surf. 7 (1983) 251.

use super::hertz::Hertzian;
use crate::asperity::flattened::{Flattened, UndeformedSphere};
use crate::asperity::table::{Part, Row, Table};
use crate::asperity::{Law, LawError, Regime, Responses, Setting, Work};

/// The law `idmt`.
///
/// # Errors
/// None for a checked setting.
pub fn idmt(setting: &Setting) -> Result<Box<dyn Law>, LawError> {
    Ok(Box::new(Table::new([
        Row::below(Regime::Noncontact, 0.0, LennardJones::dry(setting)),
        Row::last(Regime::Elastic, Hertzian::with_pull(setting, 2.0)),
    ])))
}

/// The attraction of an undeformed sphere across the gap, whose excess over Z₀ is −(δ + t).
#[derive(Clone, Copy, Debug)]
pub struct LennardJones {
    factor: f64,
    inverse_spacing: f64,
    thickness: f64,
}

impl LennardJones {
    /// Without lubricant.
    pub fn dry(setting: &Setting) -> Self {
        Self {
            factor: 8.0 / 3.0 * setting.scale.force,
            inverse_spacing: 1.0 / setting.scale.equilibrium_spacing(),
            thickness: 0.0,
        }
    }

    /// Across the lubricant, which takes its thickness off the gap.
    pub fn lubricated(setting: &Setting) -> Self {
        Self { thickness: setting.lubricant_thickness, ..Self::dry(setting) }
    }
}

impl Part for LennardJones {
    fn cost(&self) -> f64 {
        3.0
    }

    fn flattened(&self) -> Option<Box<dyn Flattened>> {
        Some(Box::new(UndeformedSphere::new(*self)))
    }

    fn evaluate(&self, interference: &[f64], out: &mut Responses, work: &mut Work) {
        for (i, &delta) in interference.iter().enumerate() {
            let u = 1.0 / (1.0 - (delta + self.thickness) * self.inverse_spacing);
            let square = u * u;
            let cube = square * square * square;
            out.adhesion[i] = self.factor * square * (1.0 - 0.25 * cube);
        }
        out.contact[..interference.len()].fill(0.0);
        out.area[..interference.len()].fill(0.0);
        work.closed_form += interference.len() as u64;
    }
}
