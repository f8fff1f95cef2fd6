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
use crate::asperity::block::Responses;
use crate::asperity::contact::Contact;
use crate::asperity::error::LawError;
use crate::asperity::history::Path;
use crate::asperity::lane::{Lane, Lanes};
use crate::asperity::law::{End, Law, Piece, RadiusDependence, Regime, Smoothness};
use crate::asperity::parameters::LawParameters;
use crate::asperity::radius::Place;
use crate::asperity::scale::Scale;
use crate::asperity::stats::SolverStats;
use crate::asperity::table::{Row, Table};
use crate::math::instruction_set::InstructionSet;
use std::f64::consts::PI;
use std::ops::Range;

/// The law `md_kim`.
///
/// # Errors
/// [`LawError`] for a λ that is not solved.
pub fn md_kim(parameters: &LawParameters) -> Result<Box<dyn Law>, LawError> {
    let (scale, path) = (parameters.scale, parameters.path);
    let contact = MaugisContact::new(parameters, f64::INFINITY)?;
    let before = ConstantStress { scale, path };
    // On approach contact begins where the attraction sets in, if that is deeper than first touch.
    let least = match path {
        Path::Approach => before.onset(),
        Path::Retraction => f64::NEG_INFINITY,
    };
    let end = Place::elastic(contact.begin().max(least), path, scale.length, (least, 0.0));
    Ok(Box::new(Table::new([
        Row::below(Regime::Noncontact, end, before),
        Row::last(Regime::Elastic, contact),
    ])))
}

/// The attraction before contact.
#[derive(Clone, Copy, Debug)]
struct ConstantStress {
    scale: Scale,
    path: Path,
}

/// The attraction of one λ, scaled.
#[derive(Clone, Copy)]
struct Zone {
    lambda: f64,
    /// 8λ/(3π), C at the fold.
    half: f64,
    /// Δ at the fold.
    fold: f64,
    /// Δ below which nothing acts.
    begin: f64,
}

impl ConstantStress {
    /// Δ where it sets in on approach, −2/(πλ), is a distance that no radius changes, m.
    fn onset(&self) -> f64 {
        -2.0 / (PI * self.scale.lambda) * self.scale.length
    }

    fn zone(&self, lambda: f64) -> Zone {
        let half = 8.0 * lambda / (3.0 * PI);
        let onset = -2.0 / (PI * lambda);
        let fold = onset - 0.5 * half * half;
        let begin = match self.path {
            Path::Approach => onset,
            Path::Retraction if Self::folds_first(lambda) => f64::INFINITY,
            Path::Retraction => fold,
        };
        Zone { lambda, half, fold, begin }
    }

    /// Whether contact ends before the fold: above λ_f = [9π/(16(π−1))]^(1/3) the zone there would be wider than at first
    /// touch.
    fn folds_first(lambda: f64) -> bool {
        16.0 * (PI - 1.0) * lambda * lambda * lambda > 9.0 * PI
    }

    /// From where it acts it varies like a root.
    fn pieces_in(zone: Zone, length: f64, within: Range<f64>) -> Vec<Piece> {
        let root = Smoothness::Root { end: End::Lower, place: zone.fold * length, order: 2 };
        let begin = zone.begin * length;
        // Where contact begins at once, the two places are one but for rounding.
        let rounding = 1e-14 * begin.abs();
        match begin {
            begin if begin <= within.start => Piece::cut(within, [], [root]),
            begin if begin + rounding < within.end => Piece::cut(within, [begin], [Smoothness::Smooth, root]),
            _ => Piece::cut(within, [], [Smoothness::Smooth]),
        }
    }
}

impl Zone {
    /// F̂_s.
    #[inline(always)]
    fn adhesion(&self, displacement: f64) -> f64 {
        let outer = self.half + (2.0 * (displacement - self.fold)).max(0.0).sqrt();
        if displacement < self.begin { 0.0 } else { 0.5 * PI * self.lambda * outer * outer }
    }
}

impl Law for ConstantStress {
    fn radius_dependence(&self) -> RadiusDependence {
        RadiusDependence::Elastic(self.scale.lambda)
    }

    fn pieces_within(&self, _: usize, lane: Option<&Lane>, within: Range<f64>) -> Vec<Piece> {
        let (zone, length) = match lane {
            None => (self.zone(self.scale.lambda), self.scale.length),
            Some(lane) => (self.zone(lane.elastic.lambda), self.scale.length * lane.cube_root),
        };
        Self::pieces_in(zone, length, within)
    }

    fn capture(&self, _: Option<&Lane>) -> Option<f64> {
        Some(self.onset())
    }

    // dΔ = (C − b)dC from C = 0 to the fold, or to first touch, where Δ = −(4λ/3)c̄(π/2).
    fn unstable_work(&self) -> f64 {
        let lambda = self.scale.lambda;
        let Zone { half, .. } = self.zone(lambda);
        let last = half.min(-0.75 / lambda * Contact::new(lambda).first_touch());
        0.5 * PI * lambda * last.powi(3) * (half / 3.0 - last / 4.0) * self.scale.energy()
    }

    fn evaluate(&self, _: usize, lanes: Lanes<'_>, at: &[f64], out: &mut Responses, _: &mut SolverStats) {
        let forces = out.adhesion.iter_mut().zip(at);
        match lanes {
            Lanes::Own => {
                let (zone, per_length) = (self.zone(self.scale.lambda), 1.0 / self.scale.length);
                InstructionSet::current().run(
                    #[inline(always)]
                    || {
                        for (adhesion, delta) in forces {
                            *adhesion = self.scale.force * zone.adhesion(delta * per_length);
                        }
                    },
                );
            }
            Lanes::Each(lanes) => {
                for (i, (adhesion, delta)) in forces.enumerate() {
                    let Lane { ratio, cube_root, elastic, .. } = lanes.at(i);
                    let displacement = delta / (self.scale.length * cube_root);
                    *adhesion = self.scale.force * ratio * self.zone(elastic.lambda).adhesion(displacement);
                }
            }
        }
        out.contact[..at.len()].fill(0.0);
        out.area[..at.len()].fill(0.0);
    }
}
