//! Attraction before contact of asperities that are alike but for their radii, as plastic flow leaves them:
//! each top has the radius R′ = 4E_r a³/(3P) of the sphere whose elastic contact has the radius a at the load
//! P.
//!
//! # Formula
//! With the ratio ρ = R′/R, λ′ = λρ^(1/3), s_δ′ = s_δ ρ^(1/3) and s_F′ = s_F ρ: the extended Maugis-Dugdale
//! law is solved anew for each λ′, the attraction of an undeformed sphere is proportional to ρ.
//!
//! # Validity
//! The validity of the laws. Hertz's relation between a, P and R is Johnson's (Contact Mechanics, 1985,
//! section 6.4) for the unloading of a plastic indentation.

use super::branch::Branch;
use super::contact::Contact;
use super::curve::{Anchor, Curve};
use super::folds::outer_fold;
use super::history::Path;
use super::law::{Flattened, Responses};
use super::noncontact::{Branches, Noncontact};
use super::scale::Scale;
use super::stats::SolverStats;

/// The extended Maugis-Dugdale law across the lubricant.
#[derive(Clone, Debug)]
pub struct ExtendedMaugisDugdale {
    scale: Scale,
    path: Path,
    thickness: f64,
}

impl ExtendedMaugisDugdale {
    /// The law of asperities of the units of a law, their history and lubricant thickness, m.
    pub fn new(scale: Scale, path: Path, thickness: f64) -> Self {
        Self { scale, path, thickness }
    }

    /// λ′, and the unit of the displacement, m.
    fn scaled(&self, ratio: f64) -> (f64, f64) {
        let root = libm::cbrt(ratio);
        (self.scale.lambda * root, self.scale.length * root)
    }

    /// Δ at which contact ends.
    fn end(&self, lambda: f64) -> f64 {
        let contact = Contact::new(lambda);
        match self.path {
            Path::Approach => contact.first_touch(),
            Path::Retraction => contact.at(contact.end()).displacement,
        }
    }
}

impl Flattened for ExtendedMaugisDugdale {
    fn release(&self, ratio: f64) -> f64 {
        let (lambda, length) = self.scaled(ratio);
        self.end(lambda) * length
    }

    fn kink(&self, ratio: f64) -> Option<f64> {
        let (lambda, length) = self.scaled(ratio);
        match Noncontact::branches_at(lambda, outer_fold(lambda)) {
            Branches::Folded { outer, fold, .. } => {
                let displacement = outer.at(fold).displacement;
                (displacement < self.end(lambda)).then_some(displacement * length - self.thickness)
            }
            Branches::Single(_) => None,
        }
    }

    fn attraction(&self, ratios: &[f64], interference: &[f64], out: &mut Responses, stats: &mut SolverStats) {
        for (i, (&ratio, delta)) in ratios.iter().zip(interference).enumerate() {
            let (lambda, length) = self.scaled(ratio);
            let displacement = (delta + self.thickness) / length;
            out.adhesion[i] = self.scale.force * ratio * outermost(lambda, displacement, stats);
        }
        out.contact[..interference.len()].fill(0.0);
        out.area[..interference.len()].fill(0.0);
        stats.noncontact_solves += interference.len() as u64;
    }
}

/// Most Newton steps from outside, and the last, relative to ε: the error that it leaves is of the order of
/// its square.
const NEWTON_STEPS: (usize, f64) = (12, 2e-9);

/// F̂_s of the outermost root before contact.
///
/// Outside the outer fold −Δ is a convex function of ε, so Newton's method from outside of all roots falls
/// monotonically to the outermost. Where that is inside of a fold, or close to one, the branches are told
/// apart.
fn outermost(lambda: f64, displacement: f64, stats: &mut SolverStats) -> f64 {
    let (Branches::Single(whole) | Branches::Folded { outer: whole, .. }) =
        Noncontact::branches_at(lambda, None);
    let mut gap = whole.bracket(displacement).1;
    for _ in 0..NEWTON_STEPS.0 {
        let state = whole.at(gap);
        let step = (displacement - state.displacement) / state.slope;
        stats.evaluations += 1;
        if !(state.slope < 0.0 && step <= NEWTON_STEPS.1 * gap && -step < gap) {
            break;
        }
        if -step <= NEWTON_STEPS.1 * gap {
            return state.adhesion + state.adhesion_slope * step;
        }
        gap += step;
    }
    branch_of(lambda, displacement).solve(displacement, stats).adhesion
}

/// The branch on which the outermost root is.
fn branch_of(lambda: f64, displacement: f64) -> Branch<Noncontact> {
    let regular = Anchor { displacement, parameter: f64::NAN, fold: false };
    match Noncontact::branches_at(lambda, outer_fold(lambda)) {
        Branches::Single(curve) => Branch::new(curve, regular),
        Branches::Folded { outer, inner, fold } => {
            let end = outer.at(fold).displacement;
            if displacement < end {
                Branch::new(outer, Anchor { displacement: end, parameter: fold, fold: true })
            } else {
                Branch::new(inner, regular)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::asperity::emd::Emd;

    /// The law of each radius made anew, at radii that lead over the first fold and beyond 1.116, where the
    /// branch is left before it.
    #[test]
    fn other_radii_have_the_law_of_their_own_lambda() {
        for path in [Path::Approach, Path::Retraction] {
            for base in [0.15, 0.8, 1.0, 2.5] {
                let law = ExtendedMaugisDugdale::new(Scale::unit(base).unwrap(), path, 0.0);
                for ratio in [0.5, 0.87, 1.0, 1.38, 1.7, 3.0, 30.0_f64] {
                    let (lambda, length) = (base * libm::cbrt(ratio), libm::cbrt(ratio));
                    let own = Emd::new(lambda, path).unwrap();
                    assert_eq!(law.release(ratio), own.end() * length);
                    let (kink, fold) = (law.kink(ratio), own.noncontact_fold().map(|fold| fold * length));
                    assert_eq!(kink.is_some(), fold.is_some(), "{base} {ratio}");
                    let place = kink.unwrap_or(f64::NAN);
                    assert!(kink.is_none() || (place / fold.unwrap() - 1.0).abs() < 1e-14);
                    let mut out = Responses::default();
                    for below in [1e-9, 1e-3, 0.02, 0.1, 1.0, 20.0] {
                        let delta = (own.end() - below) * length;
                        if ((delta - place) / place).abs() < 1e-9 {
                            continue;
                        }
                        law.attraction(&[ratio], &[delta], &mut out, &mut SolverStats::default());
                        let expected =
                            ratio * own.noncontact(delta / length, &mut SolverStats::default()).adhesion;
                        assert!((out.adhesion[0] / expected - 1.0).abs() < 1e-12, "{base} {ratio} {below}");
                    }
                }
            }
        }
    }
}
