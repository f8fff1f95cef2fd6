//! Hertz contact without adhesion: the law of Greenwood and Williamson's rough surface.
//!
//! # Formula
//! a² = Rω, P = K√R ω^(3/2) for ω ≥ 0; nothing before contact.
//!
//! # Validity
//! Elastic spheres without adhesion. Sources: Hertz, J. reine angew. Math. 92 (1882) 156; for rough surfaces
//! Greenwood and Williamson, Proc. R. Soc. Lond. A 295 (1966) 300.

use crate::asperity::error::LawError;
use crate::asperity::formula::{ClosedForm, Constant, Formula};
use crate::asperity::law::{Law, Regime};
use crate::asperity::parameters::LawParameters;
use crate::asperity::radius::Similarity;
use crate::asperity::table::{Row, Table};
use std::f64::consts::PI;

/// The law `hertz`, which is that of the rough surface `gw`.
///
/// # Errors
/// None for a checked setting.
pub fn hertz(parameters: &LawParameters) -> Result<Box<dyn Law>, LawError> {
    Ok(Box::new(Table::new([
        Row::below(Regime::Noncontact, 0.0, Constant::NOTHING),
        Row::last(Regime::Elastic, contact(parameters, 0.0)),
    ])))
}

/// The contact of Hertz under a constant adhesion force of `pull` πΔγR.
pub fn contact(parameters: &LawParameters, pull: f64) -> impl Law + use<> {
    let pull = pull * parameters.scale.force;
    let pull = (move |_: f64| pull).following(Similarity::new(0.0, 1.0));
    ClosedForm::new(pull, load(parameters), area(parameters)).with_root(0.0, 2)
}

/// P = K√R δ^(3/2).
pub fn load(parameters: &LawParameters) -> impl Formula + use<> {
    let (unit, per_length) = (parameters.scale.force, 1.0 / parameters.scale.length);
    let load = move |delta: f64| unit * (delta * per_length) * (delta * per_length).sqrt();
    load.following(Similarity::new(0.0, 0.5))
}

/// πa² = πRδ.
pub fn area(parameters: &LawParameters) -> impl Formula + use<> {
    let (unit, per_length) =
        (PI * parameters.scale.radius * parameters.scale.radius, 1.0 / parameters.scale.length);
    (move |delta: f64| unit * (delta * per_length)).following(Similarity::new(0.0, 1.0))
}
