//! Jackson and Green: elastic-plastic contact by fits to finite elements in which the hardness falls as the contact grows,
//! dry.
//!
//! # Formula
//! With the yield strength Y = H/2.84, e = Y/E_r, C = 1.295 exp(0.736ν), ω_c = (πCe/2)²R, P_c = (4/3)(R/E_r)²(πCY/2)³, the
//! Hertz load at ω_c, and x = ω/ω_c:
//!
//! | x | P/P_c | contact area/πRω_c | F_s |
//! |---|---|---|---|
//! | before contact | 0 | 0 | that of [`super::idmt`] |
//! | 0..1.9 | x^1.5 | x | the Lennard-Jones stress over the Hertz gap around the contact |
//! | above | exp(−x^(5/12)/4) x^1.5 + (4H_G/CY)[1 − exp(−x^(5/9)/25)] x | x(x/1.9)^B | 2πRΔγ |
//!
//! with B = 0.14 exp(23e) and H_G = 2.84Y[1 − exp(−0.82(a/R)^(−0.7))] at the contact radius a. H is the hardness of a scene,
//! 2.84Y by Tabor, which H_G comes to at small a/R. The publication has no adhesion. That of this law is [`super::ceb`]'s,
//! with its assumption above 1.9ω_c.
//!
//! # Validity
//! Low λ, dry. Above e of about 0.02 the area of deep contacts exceeds the 2πRω of fully plastic
//! ones, so that harder materials are outside of what B was fitted to. P jumps up by about half a per cent at x = 1.9,
//! and F_s drops to 2πRΔγ there. Source: Jackson and Green, J. Tribol. 127 (2005) 343.

use super::ceb::{attraction_around, rows_below};
use super::kogut_etsion::{Critical, OF_CRITICAL};
use crate::asperity::error::LawError;
use crate::asperity::formula::{ClosedForm, Formula};
use crate::asperity::law::{Law, Regime};
use crate::asperity::parameters::LawParameters;
use crate::asperity::scale::poisson_ratio;
use crate::asperity::table::{Row, Table};
use std::f64::consts::PI;

/// x up to which the contact is Hertz's.
const FIRST_END: f64 = 1.9;
/// H/Y (Tabor 1951).
pub(super) const HARDNESS: f64 = 2.84;
/// Largest H/E_r that B is taken of, where it is 8: the powers of what is harder are no numbers, and contacts are as wide as
/// their asperities before they yield.
const HARDEST: f64 = 0.5;
/// x up to which there are tables.
const TABULATED: f64 = 1e3;
/// Relative accuracy of tables: a few roundings, as in exponentials and products.
const TABLE_TOLERANCE: f64 = 8e-15;

/// C, the largest pressure over Y where a sphere yields.
fn yielding(parameters: &LawParameters) -> f64 {
    1.295 * libm::exp(0.736 * poisson_ratio(parameters.pressure_factor))
}

/// ω_c of Jackson and Green, m: (πCY/2E_r)²R, from (πkH/2E_r)²R.
pub(super) fn critical_interference(parameters: &LawParameters) -> f64 {
    let ratio = yielding(parameters) / (HARDNESS * parameters.pressure_factor);
    ratio * ratio * parameters.critical_interference
}

/// The law `jg`.
///
/// # Errors
/// [`LawError::Elastic`] without a critical interference, [`LawError::Hardness`] without H/E*.
pub fn jg(parameters: &LawParameters) -> Result<Box<dyn Law>, LawError> {
    let own = parameters.plastic("jg")?;
    let hardness = own.hardness_ratio.ok_or(LawError::Hardness("jg"))?;
    let strain = hardness / HARDNESS;
    let c = yielding(own);
    let b = 0.14 * libm::exp(23.0 * strain.min(HARDEST / HARDNESS));
    let root = 0.5 * PI * c * strain;
    let own = LawParameters { critical_interference: critical_interference(own), ..*own };
    let critical = Critical::new(&own);
    let (load, disc) = (critical.load, critical.disc);
    let area = move |x: f64| x * libm::pow(x / FIRST_END, b);
    let force = move |x: f64| {
        let share = -libm::expm1(-0.82 * libm::pow(root * area(x).sqrt(), -0.7));
        let plastic = -4.0 * HARDNESS * share / c * libm::expm1(-libm::pow(x, 5.0 / 9.0) / 25.0) * x;
        libm::exp(-0.25 * libm::pow(x, 5.0 / 12.0)) * x * x.sqrt() + plastic
    };
    let x = (FIRST_END, TABULATED);
    let plastic = ClosedForm::new(
        attraction_around(&own),
        critical.tabulated(move |x| load * force(x), TABLE_TOLERANCE, x).following(OF_CRITICAL),
        critical.tabulated(move |x| disc * area(x), TABLE_TOLERANCE, x).following(OF_CRITICAL),
    );
    let below = rows_below(&own, FIRST_END * own.critical_interference);
    Ok(Box::new(Table::new(below.into_iter().chain([Row::last(Regime::Elastoplastic1, plastic)]))))
}
