//! Hertz contact without adhesion: the law of Greenwood and Williamson's rough surface.
//!
//! # Formula
//! a² = Rω, P = K√R ω^(3/2) for ω ≥ 0; nothing before contact.
//!
//! # Validity
//! Elastic spheres without adhesion. Sources: Hertz, J. reine angew. Math. 92 (1882) 156; for rough surfaces Greenwood and
//! Williamson, Proc. R. Soc. Lond. A 295 (1966) 300.

use crate::asperity::scale::Scale;
use crate::asperity::table::{Constant, Part, Row, Table};
use crate::asperity::{End, Law, LawError, Regime, Responses, Setting, Smoothness, Work};
use std::f64::consts::PI;

/// The law `hertz`, which is that of the rough surface `gw`.
///
/// # Errors
/// None for a checked setting.
pub fn hertz(setting: &Setting) -> Result<Box<dyn Law>, LawError> {
    Ok(Box::new(Table::new([
        Row::below(Regime::Noncontact, 0.0, Constant::NOTHING),
        Row::last(Regime::Elastic, Hertzian::with_pull(setting, 0.0)),
    ])))
}

/// The contact of Hertz under a constant pull.
#[derive(Clone, Copy, Debug)]
pub struct Hertzian {
    scale: Scale,
    pull: f64,
}

impl Hertzian {
    /// With an adhesion force of `pull` πΔγR.
    pub fn with_pull(setting: &Setting, pull: f64) -> Self {
        Self { scale: setting.scale, pull: pull * setting.scale.force }
    }
}

impl Part for Hertzian {
    fn smoothness(&self, lower: f64, _: f64) -> (Vec<f64>, Vec<Smoothness>) {
        (Vec::new(), vec![Smoothness::Root { end: End::Lower, place: lower, order: 2 }])
    }

    fn cost(&self) -> f64 {
        4.0
    }

    fn evaluate(&self, interference: &[f64], out: &mut Responses, work: &mut Work) {
        let inverse = 1.0 / self.scale.length;
        let area_unit = PI * self.scale.radius * self.scale.radius;
        for (i, &delta) in interference.iter().enumerate() {
            let square = delta * inverse;
            out.adhesion[i] = self.pull;
            out.contact[i] = self.scale.force * square * square.sqrt();
            out.area[i] = area_unit * square;
        }
        work.closed_form += interference.len() as u64;
    }
}
