//! The elastic-plastic hybrid law of a lubricated asperity.
//!
//! # Formula
//! The rows of the elastic law ([`super::emd`]), and above the critical interference (Shi and Polycarpou
//! 2005, eqs. 17 to 23):
//!
//! | regime | interval | F_s | P |
//! |---|---|---|---|
//! | elastoplastic1 | ω_c < δ ≤ 6ω_c | Kogut-Etsion | Kogut-Etsion |
//! | elastoplastic2 | 6ω_c < δ ≤ 110ω_c | Kogut-Etsion | Kogut-Etsion |
//! | plastic | δ > 110ω_c | 0 | 2πRδH |
//!
//! # Validity
//! All λ in 1e-6..1e6; independent asperities. The joints at ω_c, 6ω_c and 110ω_c are jumps of the published
//! fits.

use super::{emd, kogut_etsion};
use crate::asperity::error::LawError;
use crate::asperity::law::Law;
use crate::asperity::parameters::LawParameters;
use crate::asperity::table::Table;

/// The law `hybrid`.
///
/// # Errors
/// [`LawError`] for a λ that is not solved.
pub fn hybrid(parameters: &LawParameters) -> Result<Box<dyn Law>, LawError> {
    Ok(Box::new(Table::new(emd::rows(parameters)?.into_iter().chain(kogut_etsion::plastic_rows(parameters)))))
}
