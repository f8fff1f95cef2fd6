//! Maugis-Dugdale in contact, and before it the same law with the Dugdale stress kept at σ₀.
//!
//! # Formula
//! Before contact, with the adhesive radius C, b = 8λ/(3π) and Δ_on = −2/(πλ):
//!
//! F̂_s = (π/2)λC², Δ = C²/2 − bC + Δ_on, so C = b + √(b² + 2(Δ − Δ_on)) on the stable branch, 0 ≤ C ≤
//! c̄(π/2), where it joins [`super::md`] exactly.
//!
//! On approach nothing acts before Δ_on; there the force jumps to that of C = 2b or, if this exceeds c̄(π/2),
//! which is so for λ > (9/32)^(1/3), into contact. On retraction contact is kept to the end of its stable
//! branch, then, below λ_f, this branch down to its fold Δ_on − b²/2, then nothing.
//!
//! # Validity
//! Elastic, dry spheres of every λ; the constant stress overestimates adhesion before contact and cuts it
//! off. Sources: Kim, McMeeking and Johnson, J. Mech. Phys. Solids 46 (1998) 243; for rough surfaces Morrow,
//! Lovell and Ning, J. Phys. D 36 (2003) 534.

use super::md::MaugisContact;
use crate::asperity::contact::Contact;
use crate::asperity::error::LawError;
use crate::asperity::formula::ClosedForm;
use crate::asperity::history::Path;
use crate::asperity::law::{Law, Regime};
use crate::asperity::parameters::LawParameters;
use crate::asperity::table::{Row, Table};
use std::f64::consts::PI;

/// The law `md_kim`.
///
/// # Errors
/// [`LawError`] for a λ that is not solved.
pub fn md_kim(parameters: &LawParameters) -> Result<Box<dyn Law>, LawError> {
    let (scale, contact) = (parameters.scale, MaugisContact::new(parameters, f64::INFINITY)?);
    let lambda = scale.lambda;
    // b, and Δ where the attraction sets in on approach and at its fold.
    let half = 8.0 * lambda / (3.0 * PI);
    let onset = -2.0 / (PI * lambda);
    let fold = onset - 0.5 * half * half;
    // Above λ_f = [9π/(16(π−1))]^(1/3) the zone at the fold would be wider than at first touch: contact ends
    // before it.
    let folds_first = 16.0 * (PI - 1.0) * lambda * lambda * lambda > 9.0 * PI;
    // Nothing acts below; on approach contact begins there if that is deeper than first touch.
    let (begin, end) = match parameters.path {
        Path::Approach => (onset, contact.begin().max(onset * scale.length)),
        Path::Retraction if folds_first => (f64::INFINITY, contact.begin()),
        Path::Retraction => (fold, contact.begin()),
    };
    // ∫F̂ dΔ with dΔ = (C − b)dC from C = 0 to the fold, or to first touch, where Δ = −(4λ/3)c̄(π/2).
    let last = half.min(-0.75 / lambda * Contact::new(lambda).first_touch());
    let unstable = 0.5 * PI * lambda * last.powi(3) * (half / 3.0 - last / 4.0);
    let (per_length, begin) = (1.0 / scale.length, begin * scale.length);
    let adhesion = move |delta: f64| {
        let outer = half + (2.0 * (delta * per_length - fold)).max(0.0).sqrt();
        if delta < begin { 0.0 } else { 0.5 * PI * scale.force * lambda * outer * outer }
    };
    let before = ClosedForm::attraction(adhesion)
        .with_root_from(begin, fold * scale.length, 2)
        .with_capture(onset * scale.length)
        .with_unstable_work(unstable * scale.energy());
    Ok(Box::new(Table::new([
        Row::below(Regime::Noncontact, end, before),
        Row::last(Regime::Elastic, contact),
    ])))
}
