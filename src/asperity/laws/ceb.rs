//! Chang, Etsion and Bogy: Hertz's contact up to the critical interference, a contact of constant volume
//! above it, dry.
//!
//! # Formula
//! With x = ω/ω_c, ω_c = (πKH/2E_r)²R, K = 0.454 + 0.41ν, and P_c = (2/3)πKHRω_c, which is the Hertz load at
//! ω_c:
//!
//! | x | P/P_c | contact area/πRω_c | F_s |
//! |---|---|---|---|
//! | before contact | 0 | 0 | (8/3)πRΔγ[(Z₀/g)² − (1/4)(Z₀/g)⁸] at the gap g = Z₀ − δ |
//! | 0..1 | x^1.5 | x | the Lennard-Jones stress over the Hertz gap around the contact |
//! | above | 3x − 1.5 | 2x − 1 | 2πRΔγ |
//!
//! The volume of the asperity that yields is conserved, so the area is πRω(2 − ω_c/ω), under the mean pressure
//! KH. The attraction around an elastic contact is that of [`super::sbl`]. Around a plastic contact of the
//! radius a the gap is taken as that of the undeformed sphere, z = Z₀ + (r² − a²)/2R, over which the stress
//! integrates to 2πRΔγ exactly, DMT's force. That gap is an assumption of this program, made without the print
//! at hand: the form of 1988 above ω_c may be another.
//!
//! # Validity
//! Low λ, dry. At ω_c the load jumps by half and F_s drops to 2πRΔγ, because neither form passes into the
//! other. Sources: Chang, Etsion and Bogy, J. Tribol. 109 (1987) 257 (loads, areas); J. Tribol. 110 (1988) 50
//! (adhesion around an elastic contact).

use super::kogut_etsion::{Critical, OF_CRITICAL};
use super::{hertz, idmt, sbl};
use crate::asperity::error::LawError;
use crate::asperity::formula::{ClosedForm, Formula};
use crate::asperity::law::{Law, Regime};
use crate::asperity::parameters::LawParameters;
use crate::asperity::radius::{Place, Similarity};
use crate::asperity::table::{Row, Table};

/// The law `ceb`.
///
/// # Errors
/// [`LawError::Elastic`] without a critical interference.
pub fn ceb(parameters: &LawParameters) -> Result<Box<dyn Law>, LawError> {
    let critical = parameters.plastic("ceb")?.critical_interference;
    let Critical { load, disc, .. } = Critical::new(parameters);
    let x = move |delta: f64| delta / critical;
    let plastic = ClosedForm::new(
        attraction_around(parameters),
        (move |delta: f64| load * (3.0 * x(delta) - 1.5)).following(OF_CRITICAL),
        (move |delta: f64| disc * (2.0 * x(delta) - 1.0)).following(OF_CRITICAL),
    );
    let below = rows_below(parameters, critical);
    Ok(Box::new(Table::new(below.into_iter().chain([Row::last(Regime::Plastic, plastic)]))))
}

/// The rows up to the interference `end`, m, where a dry asperity begins to yield that is Hertz's below, with the attraction
/// around it.
pub fn rows_below(parameters: &LawParameters, end: f64) -> [Row; 2] {
    let elastic =
        ClosedForm::new(sbl::ring_attraction(parameters), hertz::load(parameters), hertz::area(parameters));
    [
        Row::below(Regime::Noncontact, 0.0, idmt::attraction(parameters, 0.0)),
        Row::up_to(Regime::Elastic, Place::proportional(end, 1.0), elastic.with_root(0.0, 2)),
    ]
}

/// The attraction around a contact that yields, 2πRΔγ.
pub fn attraction_around(parameters: &LawParameters) -> impl Formula + use<> {
    let pull = 2.0 * parameters.scale.force;
    (move |_: f64| pull).following(Similarity::new(0.0, 1.0))
}
