//! The improved Derjaguin-Muller-Toporov law: the Lennard-Jones attraction of an undeformed sphere before
//! contact, DMT in contact.
//!
//! # Formula
//! At the gap g = Z₀ − δ ≥ Z₀: F_s = (8/3)πRΔγ[(Z₀/g)² − (1/4)(Z₀/g)⁸]; in contact as [`super::dmt`].
//!
//! # Validity
//! Elastic spheres of low λ. Source: Muller, Derjaguin and Toporov, Colloids Surf. 7 (1983) 251.

use super::hertz::contact;
use crate::asperity::error::LawError;
use crate::asperity::formula::{ClosedForm, Formula};
use crate::asperity::law::{Law, Regime};
use crate::asperity::parameters::LawParameters;
use crate::asperity::radius::Similarity;
use crate::asperity::scale::Scale;
use crate::asperity::table::{Row, Table};

/// The law `idmt`.
///
/// # Errors
/// None for a checked setting.
pub fn idmt(parameters: &LawParameters) -> Result<Box<dyn Law>, LawError> {
    Ok(Box::new(Table::new([
        Row::below(Regime::Noncontact, 0.0, attraction(parameters, 0.0)),
        Row::last(Regime::Elastic, contact(parameters, 2.0)),
    ])))
}

/// The attraction of an undeformed sphere across the gap, Z₀ − δ less the `thickness` of a lubricant, m.
pub fn attraction(parameters: &LawParameters, thickness: f64) -> impl Law + use<> {
    let of_gap = across(&parameters.scale);
    let force = move |delta: f64| of_gap(-(delta + thickness));
    ClosedForm::attraction(force.following(Similarity::new(0.0, 1.0)))
}

/// F_s, N, of an undeformed sphere whose distance of surfaces is larger than at equilibrium by a gap ≥ 0, m.
pub fn across(scale: &Scale) -> impl Fn(f64) -> f64 + Clone + Send + Sync + use<> {
    let factor = 8.0 / 3.0 * scale.force;
    let per_spacing = 1.0 / scale.equilibrium_spacing();
    move |gap: f64| {
        let u = 1.0 / (1.0 + gap * per_spacing);
        let square = u * u;
        factor * square * (1.0 - 0.25 * (square * square * square))
    }
}
