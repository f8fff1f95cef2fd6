//! Hertz contact without adhesion: the law of Greenwood and Williamson's rough surface.
//!
//! # Formula
//! a² = Rω, P = K√R ω^(3/2) for ω ≥ 0; nothing before contact.
//!
//! # Validity
//! Elastic spheres without adhesion. Sources: Hertz, J. reine angew. Math. 92 (1882) 156; for rough surfaces Greenwood and
//! Williamson, Proc. R. Soc. Lond. A 295 (1966) 300.

use crate::asperity::error::LawError;
use crate::asperity::formula::{ClosedForm, Constant, Formula};
use crate::asperity::law::{Law, Regime};
use crate::asperity::setting::Setting;
use crate::asperity::table::{Part, Row, Table};
use std::f64::consts::PI;

/// The law `hertz`, which is that of the rough surface `gw`.
///
/// # Errors
/// None for a checked setting.
pub fn hertz(setting: &Setting) -> Result<Box<dyn Law>, LawError> {
    Ok(Box::new(Table::new([
        Row::below(Regime::Noncontact, 0.0, Constant::NOTHING),
        Row::last(Regime::Elastic, contact(setting, 0.0)),
    ])))
}

/// The contact of Hertz under a constant adhesion force of `pull` πΔγR.
pub fn contact(setting: &Setting, pull: f64) -> impl Part + use<> {
    let pull = pull * setting.scale.force;
    ClosedForm::new(move |_: f64| pull, load(setting), area(setting)).with_root(0.0, 2)
}

/// P = K√R δ^(3/2).
pub fn load(setting: &Setting) -> impl Formula + use<> {
    let (unit, per_length) = (setting.scale.force, 1.0 / setting.scale.length);
    move |delta: f64| unit * (delta * per_length) * (delta * per_length).sqrt()
}

/// πa² = πRδ.
pub fn area(setting: &Setting) -> impl Formula + use<> {
    let (unit, per_length) = (PI * setting.scale.radius * setting.scale.radius, 1.0 / setting.scale.length);
    move |delta: f64| unit * (delta * per_length)
}
