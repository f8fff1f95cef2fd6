//! The improved law of Stanley, Etsion and Bogy: lubricated, with the elastic-plastic contact of Kogut and
//! Etsion.
//!
//! # Formula
//! | interval | F_s | P |
//! |---|---|---|
//! | δ < −t | attraction of an undeformed sphere ([`super::idmt`]) at δ + t | 0 |
//! | −t ≤ δ < 0 | 2πRΔγ | 0 |
//! | δ ≥ 0 | Kogut-Etsion ([`super::kogut_etsion`]) | Kogut-Etsion |
//!
//! # Validity
//! Low λ. Sources: Lee, in Shi and Polycarpou (2005), eq. B.2, whose limits are read as d + ω_c, d + 6ω_c, d
//! + 110ω_c.

use super::{idmt, kogut_etsion};
use crate::asperity::error::LawError;
use crate::asperity::formula::Constant;
use crate::asperity::law::{Law, Regime};
use crate::asperity::parameters::LawParameters;
use crate::asperity::table::{Row, Table};

/// The law `isbl`.
///
/// # Errors
/// [`LawError::Elastic`] without a critical interference.
pub fn isbl(parameters: &LawParameters) -> Result<Box<dyn Law>, LawError> {
    parameters.plastic("isbl")?;
    Ok(Box::new(Table::new(
        rows_before_contact(parameters).into_iter().chain(kogut_etsion::contact_rows(parameters)),
    )))
}

/// The rows before the solids touch.
pub fn rows_before_contact(parameters: &LawParameters) -> [Row; 2] {
    let thickness = parameters.lubricant_thickness;
    [
        Row::below(Regime::Noncontact, -thickness, idmt::attraction(parameters, thickness)),
        Row::below(Regime::Lubricant, 0.0, Constant::lubricant(parameters)),
    ]
}
