//! The extended Maugis-Dugdale law of one elastic asperity: noncontact and contact branches joined by
//! history.
//!
//! # Validity
//! Elastic spheres, every adhesion parameter λ in [`super::scale::LAMBDA_RANGE`]. Source: Maugis (1992) in
//! contact, Shi and Polycarpou (2005) before it; the branch rules belong to displacement control.

use super::branch::Branch;
use super::contact::Contact;
use super::curve::{Anchor, BranchCurve, Solution};
use super::error::LawError;
use super::folds::inner_fold;
use super::history::Path;
use super::noncontact::{Branches, Noncontact};
use super::scale::Scale;
use super::stats::SolverStats;
use crate::math::piecewise::{Piecewise, leading};

/// The law for one λ and one history, in scaled form.
#[derive(Clone, Debug)]
pub struct Emd {
    contact: Branch<Contact>,
    outer: Branch<Noncontact>,
    inner: Option<Branch<Noncontact>>,
    /// F̂_s far away, over the distance |Δ − Δ_ref| from where the outer branch is anchored.
    far: Piecewise,
    /// Δ of the jump from the outer branch to the inner one, or back.
    split: f64,
    end: f64,
}

/// From this distance |Δ − Δ_ref| on, asperities before contact need no solve: their force falls like an
/// inverse square, and a Chebyshev series on each of a few intervals has it to [`FAR_TOLERANCE`].
const FAR: f64 = 2.0;
/// Relative accuracy of that series, which is that of a solve.
const FAR_TOLERANCE: f64 = 2e-15;

impl Emd {
    /// The law for the adhesion parameter `lambda` along `path`.
    ///
    /// # Errors
    /// [`LawError`] when `lambda` is outside [`super::scale::LAMBDA_RANGE`] or not a number.
    pub fn new(lambda: f64, path: Path) -> Result<Self, LawError> {
        let Scale { lambda, .. } = Scale::unit(lambda)?;
        let curve = Contact::new(lambda);
        let fold =
            Anchor { displacement: curve.at(curve.end()).displacement, parameter: curve.end(), fold: true };
        let end = match path {
            Path::Approach => curve.first_touch(),
            Path::Retraction => fold.displacement,
        };
        let (outer, inner) = noncontact_branches(lambda, end);
        let split = outer.anchor().displacement;
        Ok(Self { contact: Branch::new(curve, fold), outer, inner, far: Piecewise::default(), split, end })
    }

    /// The law of an asperity that comes out of contact. Before contact it stays on the inner of two states for
    /// as long as that exists.
    pub fn staying(mut self) -> Self {
        let lambda = self.outer.curve().lambda();
        if let (Some(fold), Some(_)) = (inner_fold(lambda), &self.inner) {
            let curve = Noncontact::up_to(lambda, fold);
            let displacement = curve.at(fold).displacement;
            self.split = displacement;
            self.inner = Some(Branch::new(curve, Anchor { displacement, parameter: fold, fold: true }));
        }
        self
    }

    /// Δ from which an asperity that retracts before contact is on the inner of two states, if it stays on it
    /// ([`Emd::staying`]).
    pub fn capture(&self) -> Option<f64> {
        let anchor = self.outer.anchor();
        inner_fold(self.outer.curve().lambda()).and(anchor.fold.then_some(anchor.displacement))
    }

    /// ∫(−F̂_s) dΔ along the unstable branch before contact, from the fold of the outer state to the fold of the inner one; 0 if
    /// an asperity does not stay on the inner state.
    pub fn unstable_work_before(&self) -> f64 {
        let curve = self.outer.curve();
        match inner_fold(curve.lambda()) {
            Some(inner) if self.outer.anchor().fold => {
                curve.unstable_work([self.outer.anchor().parameter, inner])
            }
            _ => 0.0,
        }
    }

    /// The law with starting tables for displacements in `lowest..=highest`, which make solves in that
    /// range fast.
    pub fn with_tables(self, lowest: f64, highest: f64) -> Self {
        self.with_contact_table(highest).with_noncontact_tables(lowest).with_far_series(lowest)
    }

    /// The law with a starting table for the contact branch up to the displacement `highest`.
    pub fn with_contact_table(mut self, highest: f64) -> Self {
        if highest > self.contact.anchor().displacement {
            self.contact = self.contact.with_table(highest);
        }
        self
    }

    /// The law with starting tables for the noncontact branches down to the displacement `lowest`.
    pub fn with_noncontact_tables(mut self, lowest: f64) -> Self {
        if lowest < self.outer.anchor().displacement {
            self.outer = self.outer.with_table(lowest);
        }
        // The inner part reaches from the split to where contact begins.
        let (split, end) = (self.split, self.end);
        let other = |inner: &Branch<Noncontact>| if inner.anchor().fold { end } else { split };
        self.inner = self.inner.map(|inner| {
            let other = other(&inner);
            inner.with_table(other)
        });
        self
    }

    /// The law with a series in the place of solves far from contact, down to the displacement `lowest`.
    /// It is made by solves, which are fast with tables.
    pub fn with_far_series(mut self, lowest: f64) -> Self {
        let innermost = self.outer.anchor().displacement;
        let force =
            |distance: f64| self.outer.solve(innermost - distance, &mut SolverStats::default()).adhesion;
        self.far = Piecewise::new(force, |_, force| FAR_TOLERANCE * force, FAR, innermost - lowest);
        self
    }

    /// Δ where contact begins on approach or ends on retraction; −δ_A in units of s_δ.
    pub fn end(&self) -> f64 {
        self.end
    }

    /// Δ of the fold at which the force jumps from the outer branch before contact to the inner one; if an asperity
    /// stays on the inner one, Δ of the jump to the outer one.
    pub fn noncontact_fold(&self) -> Option<f64> {
        self.outer.anchor().fold.then_some(self.split)
    }

    /// Δ of the fold of the outer branch, if an asperity stays on the inner one.
    pub fn fold_behind(&self) -> Option<f64> {
        let anchor = self.outer.anchor();
        (anchor.fold && self.split < anchor.displacement).then_some(anchor.displacement)
    }

    /// Δ below which a series takes the place of solves, where there is one.
    pub fn far(&self) -> Option<f64> {
        (!self.far.is_empty()).then(|| self.outer.anchor().displacement - FAR)
    }

    /// The end of the stable contact branch, where A and F̂_s vary like a square root; at or below
    /// [`Emd::end`] but for rounding.
    pub fn contact_fold(&self) -> f64 {
        self.contact.anchor().displacement
    }

    /// ∫F̂ dΔ along the unstable part of the contact curve, from first touch to its end.
    pub fn unstable_work(&self) -> f64 {
        self.contact.curve().unstable_work()
    }

    /// The state at any displacement: the branch that the history selects.
    pub fn respond(&self, displacement: f64, stats: &mut SolverStats) -> Solution {
        if displacement >= self.end {
            self.contact(displacement, stats)
        } else {
            self.noncontact(displacement, stats)
        }
    }

    /// The contact branch; displacements below its end are taken as the end.
    pub fn contact(&self, displacement: f64, stats: &mut SolverStats) -> Solution {
        self.contact.solve(displacement.max(self.contact.anchor().displacement), stats)
    }

    /// The contact branch at up to [`super::BLOCK`] displacements; those below its end are taken as the end.
    pub fn contact_block(
        &self,
        displacements: &mut [f64],
        adhesion: &mut [f64],
        radius: &mut [f64],
        stats: &mut SolverStats,
    ) {
        for displacement in displacements.iter_mut() {
            *displacement = displacement.max(self.contact.anchor().displacement);
        }
        self.contact.solve_block(displacements, adhesion, radius, stats);
    }

    /// The noncontact branch at up to [`super::BLOCK`] displacements below [`Emd::end`]: the outermost roots.
    #[inline(always)]
    pub fn noncontact_block(&self, displacements: &mut [f64], adhesion: &mut [f64], stats: &mut SolverStats) {
        let anchor = self.outer.anchor().displacement;
        let split = self.split;
        // The split itself is the first of the inner part, if there is one.
        let outer_end = if self.inner.is_some() { split.next_down() } else { anchor };
        let begin_of_far = if self.far.is_empty() { f64::NEG_INFINITY } else { anchor - FAR };
        let part = |displacement: f64| match displacement {
            far if far < begin_of_far => (Segment::Far, f64::NEG_INFINITY, begin_of_far.next_down()),
            outer if outer < split || self.inner.is_none() => {
                (Segment::Outer, begin_of_far.next_down(), outer_end)
            }
            _ => (Segment::Inner, split.next_down(), f64::INFINITY),
        };
        let mut begin = 0;
        while begin < displacements.len() {
            let (part, low, high) = part(displacements[begin]);
            let run = begin..begin + leading(&displacements[begin..], low, high).max(1);
            begin = run.end;
            let (displacements, adhesion) = (&mut displacements[run.clone()], &mut adhesion[run]);
            match (part, &self.inner) {
                (Segment::Far, _) => self.far_block(displacements, adhesion, stats),
                (Segment::Inner, Some(inner)) => {
                    inner.solve_block(displacements, adhesion, &mut [0.0; super::BLOCK], stats)
                }
                _ => {
                    displacements
                        .iter_mut()
                        .for_each(|displacement| *displacement = displacement.min(anchor));
                    self.outer.solve_block(displacements, adhesion, &mut [0.0; super::BLOCK], stats);
                }
            }
        }
    }

    /// Displacements far from contact: the series, and solves where it does not reach.
    #[inline(always)]
    fn far_block(&self, displacements: &[f64], adhesion: &mut [f64], stats: &mut SolverStats) {
        let anchor = self.outer.anchor().displacement;
        let mut distances = [0.0; super::BLOCK];
        let distances = &mut distances[..displacements.len()];
        distances
            .iter_mut()
            .zip(displacements)
            .for_each(|(distance, displacement)| *distance = anchor - displacement);
        self.far.values(distances, adhesion);
        let missing = adhesion.iter().fold(0, |missing, force| missing + u64::from(force.is_nan()));
        stats.far += displacements.len() as u64 - missing;
        if missing > 0 {
            for (force, &displacement) in
                adhesion.iter_mut().zip(displacements).filter(|(force, _)| force.is_nan())
            {
                *force = self.outer.solve(displacement, stats).adhesion;
            }
        }
    }

    /// The noncontact branch at a displacement below [`Emd::end`]: the outermost root.
    pub fn noncontact(&self, displacement: f64, stats: &mut SolverStats) -> Solution {
        let mut adhesion = [0.0];
        self.noncontact_block(&mut [displacement], &mut adhesion, stats);
        Solution { adhesion: adhesion[0], radius: 0.0 }
    }
}

/// The segments of the law before contact.
enum Segment {
    Far,
    Outer,
    Inner,
}

/// The noncontact branches needed below `end`. Anchored at the outer fold where that is reached first, else
/// at `end`.
fn noncontact_branches(lambda: f64, end: f64) -> (Branch<Noncontact>, Option<Branch<Noncontact>>) {
    let regular = |curve: Noncontact| {
        let anywhere = Anchor { displacement: end, parameter: f64::NAN, fold: false };
        let (parameter, _) = Branch::new(curve, anywhere).locate(end);
        Branch::new(curve, Anchor { parameter, ..anywhere })
    };
    match Noncontact::branches(lambda) {
        Branches::Single(curve) => (regular(curve), None),
        Branches::Folded { outer, inner, fold } => {
            let displacement = outer.at(fold).displacement;
            if displacement < end {
                (
                    Branch::new(outer, Anchor { displacement, parameter: fold, fold: true }),
                    Some(regular(inner)),
                )
            } else {
                (regular(outer), None)
            }
        }
    }
}
