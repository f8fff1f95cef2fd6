//! Zhao, Maietta and Chang: Hertz's contact, fully plastic contact, and a smooth passage between them, dry.
//!
//! # Formula
//! With k = 0.4, ω₁ = (3πkH/4E_r)²R, where the mean pressure of Hertz's contact is kH, ω₂ = 54ω₁, and u = (ω − ω₁)/(ω₂ −
//! ω₁):
//!
//! | ω | contact area/πRω | P/area | F_s |
//! |---|---|---|---|
//! | before contact | 0 | | that of [`super::idmt`] |
//! | 0..ω₁ | 1 | Hertz's | the Lennard-Jones stress over the Hertz gap around the contact |
//! | ω₁..ω₂ | 1 − 2u³ + 3u² | H[1 − (1 − k) ln(ω₂/ω)/ln(ω₂/ω₁)] | 2πRΔγ |
//! | above | 2 | H | 2πRΔγ |
//!
//! The publication has no adhesion. That of this law is [`super::ceb`]'s, with its assumption above ω₁.
//!
//! # Validity
//! Low λ, dry. Load and area are continuous, the area has its slope at both ends; F_s drops to 2πRΔγ at ω₁. Source: Zhao,
//! Maietta and Chang, J. Tribol. 122 (2000) 86.

use super::ceb::{attraction_around, rows_below};
use super::kogut_etsion::{Critical, OF_CRITICAL};
use crate::asperity::error::LawError;
use crate::asperity::formula::{ClosedForm, Formula};
use crate::asperity::law::{Law, Regime};
use crate::asperity::parameters::LawParameters;
use crate::asperity::radius::Place;
use crate::asperity::table::{Row, Table};

/// k, the mean pressure over H where plastic deformation begins.
const FIRST_PRESSURE: f64 = 0.4;
/// ω₂/ω₁.
const FULLY_PLASTIC: f64 = 54.0;
/// Relative accuracy of the table of the load: a few roundings, as in its products.
const TABLE_TOLERANCE: f64 = 4e-15;

/// The law `zmc`.
///
/// # Errors
/// [`LawError::Elastic`] without a critical interference.
pub fn zmc(parameters: &LawParameters) -> Result<Box<dyn Law>, LawError> {
    let own = parameters.plastic("zmc")?;
    // Of ω_c the largest pressure is KH, of ω₁ it is 3kH/2.
    let ratio = 1.5 * FIRST_PRESSURE / own.pressure_factor;
    let first = ratio * ratio * own.critical_interference;
    let own = LawParameters { critical_interference: first, ..*own };
    let critical = Critical::new(&own);
    let (disc, hardness) = (critical.disc, critical.load / (FIRST_PRESSURE * critical.disc));
    let area = move |x: f64| {
        let u = (x - 1.0) / (FULLY_PLASTIC - 1.0);
        disc * x * (1.0 + u * u * (3.0 - 2.0 * u))
    };
    let pressure = move |x: f64| {
        hardness * (1.0 - (1.0 - FIRST_PRESSURE) * libm::log(FULLY_PLASTIC / x) / libm::log(FULLY_PLASTIC))
    };
    let load = critical.tabulated(move |x| area(x) * pressure(x), TABLE_TOLERANCE, (1.0, FULLY_PLASTIC));
    let between = ClosedForm::new(
        attraction_around(&own),
        load.following(OF_CRITICAL),
        (move |delta: f64| area(delta / first)).following(OF_CRITICAL),
    );
    let above = ClosedForm::new(
        attraction_around(&own),
        critical.multiple(2.0 * disc * hardness),
        critical.multiple(2.0 * disc),
    );
    let plastic = [
        Row::up_to(Regime::Elastoplastic1, Place::proportional(FULLY_PLASTIC * first, 1.0), between),
        Row::last(Regime::Plastic, above),
    ];
    Ok(Box::new(Table::new(rows_below(&own, first).into_iter().chain(plastic))))
}
