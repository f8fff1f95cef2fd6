//! Maugis-Dugdale in contact, and before it the same law with the Dugdale stress kept at σ₀.
//!
//! # Formula
//! Before contact, with the adhesive radius C, b = 8λ/(3π) and Δ_on = −2/(πλ):
//!
//! F̂_s = (π/2)λC², Δ = C²/2 − bC + Δ_on, so C = b + √(b² + 2(Δ − Δ_on)) on the stable branch, 0 ≤ C ≤ c̄(π/2), where it joins
//! [`super::md`] exactly.
//!
//! On approach nothing acts before Δ_on; there the force jumps to that of C = 2b or, if this exceeds c̄(π/2), which is so for
//! λ > (9/32)^(1/3), into contact. On retraction contact is kept to the end of its stable branch, then, below λ_f, this branch down to
//! its fold Δ_on − b²/2, then nothing.
//!
//! # Validity
//! Elastic, dry spheres of every λ; the constant stress overestimates adhesion before contact and cuts it off. Sources: Kim, McMeeking
//! and Johnson, J. Mech. Phys. Solids 46 (1998) 243; for rough surfaces Morrow, Lovell and Ning, J. Phys. D 36 (2003) 534.

use super::md::MaugisContact;
use crate::asperity::scale::Scale;
use crate::asperity::table::{Part, Row, Table};
use crate::asperity::{End, Law, LawError, Path, Regime, Responses, Setting, Smoothness, Work};
use std::f64::consts::PI;

/// The law `md_kim`.
///
/// # Errors
/// [`LawError`] for a λ that is not solved.
pub fn md_kim(setting: &Setting) -> Result<Box<dyn Law>, LawError> {
    let (before, contact) = (ConstantStress::new(setting), MaugisContact::new(setting, f64::INFINITY)?);
    // On approach contact begins where the attraction does if that is deeper than first touch.
    let begin = match setting.path {
        Path::Approach => contact.begin().max(before.onset * setting.scale.length),
        Path::Retraction => contact.begin(),
    };
    Ok(Box::new(Table::new([Row::below(Regime::Noncontact, begin, before), Row::last(Regime::Elastic, contact)])))
}

/// The attraction before contact.
#[derive(Clone, Copy, Debug)]
struct ConstantStress {
    scale: Scale,
    /// b.
    half: f64,
    /// Δ_on.
    onset: f64,
    /// Δ of the fold.
    fold: f64,
    /// Δ below which nothing acts; infinite where nothing ever does.
    begin: f64,
}

impl ConstantStress {
    fn new(setting: &Setting) -> Self {
        let lambda = setting.scale.lambda;
        let half = 8.0 * lambda / (3.0 * PI);
        let onset = -2.0 / (PI * lambda);
        let fold = onset - 0.5 * half * half;
        // Above λ_f = [9π/(16(π−1))]^(1/3) the zone at the fold would be wider than at first touch: contact ends before it.
        let folds_first = 16.0 * (PI - 1.0) * lambda * lambda * lambda > 9.0 * PI;
        let begin = match setting.path {
            Path::Approach => onset,
            Path::Retraction if folds_first => f64::INFINITY,
            Path::Retraction => fold,
        };
        Self { scale: setting.scale, half, onset, fold, begin }
    }
}

impl Part for ConstantStress {
    fn smoothness(&self, lower: f64, upper: f64) -> (Vec<f64>, Vec<Smoothness>) {
        let [begin, place] = [self.begin, self.fold].map(|approach| approach * self.scale.length);
        if lower < begin && begin < upper {
            (vec![begin], vec![Smoothness::Smooth, Smoothness::Root { end: End::Lower, place, order: 2 }])
        } else {
            (Vec::new(), vec![Smoothness::Smooth])
        }
    }

    fn cost(&self) -> f64 {
        4.0
    }

    fn capture(&self) -> Option<f64> {
        Some(self.onset * self.scale.length)
    }

    fn evaluate(&self, interference: &[f64], out: &mut Responses, work: &mut Work) {
        let (inverse, begin) = (1.0 / self.scale.length, self.begin * self.scale.length);
        for (i, &delta) in interference.iter().enumerate() {
            out.adhesion[i] = if delta < begin {
                0.0
            } else {
                let outer = self.half + (2.0 * (delta * inverse - self.fold)).max(0.0).sqrt();
                0.5 * PI * self.scale.force * self.scale.lambda * outer * outer
            };
        }
        out.contact[..interference.len()].fill(0.0);
        out.area[..interference.len()].fill(0.0);
        work.closed_form += interference.len() as u64;
    }
}
