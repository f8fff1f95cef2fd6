//! Thornton and Ning: a contact whose pressure is cut off at that at which it yields, dry.
//!
//! # Formula
//! With the pressure p_y = KH at which the sphere yields, x = ω/ω_c and P_c, the Hertz load at ω_c, as in [`super::ceb`]:
//!
//! | x | P/P_c | contact area/πRω_c | F_s |
//! |---|---|---|---|
//! | before contact | 0 | 0 | that of [`super::idmt`] |
//! | 0..1 | x^1.5 | x | the Lennard-Jones stress over the Hertz gap around the contact |
//! | above | (3x − 1)/2 | x | 2πRΔγ |
//!
//! Above ω_c that is P = P_c + πp_yR(ω − ω_c). The publication has JKR's adhesion, which enters its loading too; here F_s is
//! [`super::ceb`]'s, with its assumption above ω_c.
//!
//! # Validity
//! Low λ, dry. Load and its slope are continuous; F_s drops to 2πRΔγ at ω_c. The area is that of the geometry for every ω,
//! which is half of that of fully plastic contacts. Source: Thornton and Ning, Powder Technol. 99 (1998) 154.

use super::ceb::{attraction_around, rows_below};
use super::kogut_etsion::{Critical, OF_CRITICAL};
use crate::asperity::error::LawError;
use crate::asperity::formula::{ClosedForm, Formula};
use crate::asperity::law::{Law, Regime};
use crate::asperity::parameters::LawParameters;
use crate::asperity::table::{Row, Table};

/// The law `tn`.
///
/// # Errors
/// [`LawError::Elastic`] without a critical interference.
pub fn tn(parameters: &LawParameters) -> Result<Box<dyn Law>, LawError> {
    let end = parameters.plastic("tn")?.critical_interference;
    let critical = Critical::new(parameters);
    let load = critical.load;
    let plastic = ClosedForm::new(
        attraction_around(parameters),
        (move |delta: f64| load * (1.5 * (delta / end) - 0.5)).following(OF_CRITICAL),
        critical.multiple(critical.disc),
    );
    Ok(Box::new(Table::new(
        rows_below(parameters, end).into_iter().chain([Row::last(Regime::Plastic, plastic)]),
    )))
}
