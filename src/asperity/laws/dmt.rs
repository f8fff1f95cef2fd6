//! Derjaguin-Muller-Toporov: the profile of Hertz under a constant pull.
//!
//! # Formula
//! F_s = 2πRΔγ, P as [`super::hertz`] for ω ≥ 0, so F̂ = Δ^(3/2) − 2; nothing before contact.
//!
//! # Validity
//! Elastic spheres of low λ; the limit of Maugis-Dugdale as λ → 0. Source: Derjaguin, Muller and Toporov, J.
//! Colloid Interface Sci. 53 (1975) 314, in the form of Maugis (1992).

use super::hertz::contact;
use crate::asperity::error::LawError;
use crate::asperity::formula::Constant;
use crate::asperity::law::{Law, Regime};
use crate::asperity::parameters::LawParameters;
use crate::asperity::table::{Row, Table};

/// The law `dmt`.
///
/// # Errors
/// None for a checked setting.
pub fn dmt(parameters: &LawParameters) -> Result<Box<dyn Law>, LawError> {
    Ok(Box::new(Table::new([
        Row::below(Regime::Noncontact, 0.0, Constant::NOTHING),
        Row::last(Regime::Elastic, contact(parameters, 2.0)),
    ])))
}
