//! The top of an asperity that has flowed, and its response while it is unloaded and loaded again.
//!
//! # Formula
//! A top that was pressed to ω is lower by its residual depth, has an apex of the radius ρ and an outline
//! ([`super::laws::md_plastic`]). It springs back by its recovery, the displacement of that outline's elastic contact of the radius
//! a₀, and unloads as this contact ([`super::outline`]). Out of contact it is an asperity whose apex has the radius ρ.

use super::block::{BLOCK, Responses};
use super::flattened::State;
use super::lane::{EACH, Lane, Lanes};
use super::law::Law;
use super::outline::{OutlinedTop, Pressed};
use super::stats::SolverStats;

/// Kinks of a top that has flowed, at most: where its attraction jumps, where its adhesive zone ends at the edge of its outline,
/// and, the last two, where the film or bridge breaks, and where contact ends.
pub const TOP_KINKS: usize = 10;

/// The top of an asperity that has flowed.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Top {
    /// ω_max less the residual depth, m.
    pub recovery: f64,
    /// ρ over the radius that others are multiples of.
    pub ratio: f64,
    /// The outline, with the ends of its states.
    pub outlined: OutlinedTop,
    /// λ of a sphere of the radius that others are multiples of, 0 without adhesion, and the radius of the asperity over it.
    pub units: [f64; 2],
    /// Interferences, m, from the lowered apex, of its kinks ([`TOP_KINKS`]); NaN of what it has not.
    pub kinks: [f64; TOP_KINKS],
}

impl Top {
    /// The top that a state leaves, with the unit of displacements, m.
    pub fn new(state: &State, length: f64) -> Self {
        let Pressed { lambda, apex, sphere, .. } = state.contact;
        Self {
            recovery: length * state.recovery(),
            ratio: apex,
            outlined: OutlinedTop::new(state.contact.outline(), state.zone),
            units: [lambda, sphere],
            kinks: [f64::NAN; TOP_KINKS],
        }
    }

    /// The distances, m, at which it passes its kinks.
    pub fn passes(&self) -> [f64; TOP_KINKS] {
        self.kinks.map(|kink| self.recovery - kink)
    }

    /// Visits its numbers, as [`OutlinedTop::each`]; these of lengths are relative to the recovery.
    pub fn each(&mut self, mut visit: impl FnMut(&mut f64, Option<f64>)) {
        let recovery = self.recovery.abs();
        visit(&mut self.recovery, Some(0.0));
        visit(&mut self.ratio, Some(0.0));
        self.kinks.iter_mut().filter(|kink| kink.is_finite()).for_each(|kink| visit(kink, Some(recovery)));
        self.outlined.each(visit);
    }

    /// What it has and what not, as bits.
    pub fn kind(&self) -> u64 {
        self.kinks.iter().fold(self.outlined.kind(), |bits, kink| 2 * bits + u64::from(kink.is_finite()))
    }

    /// Finds what follows from its numbers.
    pub fn close(&mut self) {
        let [lambda, sphere] = self.units;
        self.outlined.outline.lambda = lambda * libm::cbrt(self.ratio);
        self.outlined.outline.outside = self.ratio / sphere;
    }

    /// The asperity of its apex.
    pub fn lane(&self) -> Lane {
        Lane::of_top(self.ratio, Some(&self.outlined).filter(|top| top.outline.lambda > 0.0))
    }
}

/// Tops in a row, with the asperities of their apexes.
#[derive(Clone, Debug, Default)]
pub(super) struct Tops {
    lanes: Vec<Lane>,
    outlined: Vec<OutlinedTop>,
    recovery: Vec<f64>,
}

impl Tops {
    /// Makes room for more tops.
    pub fn reserve(&mut self, count: usize) {
        self.lanes.reserve(count);
        self.outlined.reserve(count);
        self.recovery.reserve(count);
    }

    /// Adds a top.
    pub fn push(&mut self, top: Top) {
        self.lanes.push(top.lane());
        self.outlined.push(top.outlined);
        self.recovery.push(top.recovery);
    }

    /// The number of tops.
    pub fn count(&self) -> usize {
        self.lanes.len()
    }

    /// Writes the responses of the tops that `which` numbers at a distance, m, from ω_max in a regime of a law. Neither rounding
    /// nor a boundary of asperities that have not flowed leads out of it: before contact it ends where it does for each top, and
    /// contact is elastic however deep.
    pub fn respond(
        &self,
        (law, regime): (&dyn Law, usize),
        (which, distance): (&[u32], f64),
        out: &mut Responses,
        stats: &mut SolverStats,
    ) {
        let mut own = [0.0; BLOCK];
        let own = &mut own[..which.len()];
        let is_contact = law.regimes()[regime].is_contact();
        for (own, i) in own.iter_mut().zip(which) {
            let (recovery, lane) = (self.recovery[*i as usize], &self.lanes[*i as usize]);
            let upper = if is_contact { None } else { law.end(regime, lane) };
            let lower = regime.checked_sub(1).and_then(|below| law.end(below, lane));
            let here = (recovery - distance).max(lower.unwrap_or(f64::NEG_INFINITY));
            *own = here.min(upper.unwrap_or(f64::INFINITY));
        }
        law.evaluate(regime, Lanes::of_tops(&self.lanes, &self.outlined, which), own, out, stats);
    }

    /// The responses of all of at most [`BLOCK`] tops.
    pub fn respond_all(
        &self,
        law: (&dyn Law, usize),
        distance: f64,
        out: &mut Responses,
        stats: &mut SolverStats,
    ) {
        self.respond(law, (&EACH[..self.count()], distance), out, stats);
    }
}
