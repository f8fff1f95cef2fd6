//! The flattened summit of an asperity that has yielded, and its response on unloading and reloading.
//!
//! # Formula
//! A summit that was loaded to ω_max is lowered by its residual depth ω_r and has an outline whose apex has the radius ρ
//! ([`super::laws::md_plastic`]). It recovers elastically by ω_max − ω_r, the displacement of the elastic contact of that outline
//! with the radius a₀, and unloads as this contact ([`super::outline`]). Out of contact it is an asperity of the radius ρ.

use super::block::{BLOCK, Responses};
use super::lane::{EACH, Lane, Lanes};
use super::law::Law;
use super::loading::State;
use super::outline::{OutlinedSummit, Pressed};
use super::stats::SolverStats;

/// Largest number of kinks in the force of a flattened summit: jumps of its attraction, the adhesive zone that passes the edge of
/// the outline, and, the last two, the break of the film or bridge and the end of contact.
pub const SUMMIT_KINKS: usize = 10;

/// The flattened summit of an asperity that has yielded.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct FlattenedSummit {
    /// Elastic recovery ω_max − ω_r, m.
    pub recovery: f64,
    /// ρ over the radius of the law.
    pub ratio: f64,
    /// Outline and the ends of its stable branches.
    pub outlined: OutlinedSummit,
    /// λ of a sphere of the radius of the law, 0 without adhesion, and the radius of the undeformed asperity over that radius.
    pub units: [f64; 2],
    /// Interferences, m, of its kinks ([`SUMMIT_KINKS`]), from the lowered apex; NaN for a kink that it does not have.
    pub kinks: [f64; SUMMIT_KINKS],
}

impl FlattenedSummit {
    /// The summit that remains after loading to a state, with the unit of displacements, m.
    pub fn new(state: &State, length: f64) -> Self {
        let Pressed { lambda, apex, sphere, .. } = state.contact;
        Self {
            recovery: length * state.recovery(),
            ratio: apex,
            outlined: OutlinedSummit::new(state.contact.outline(), state.zone),
            units: [lambda, sphere],
            kinks: [f64::NAN; SUMMIT_KINKS],
        }
    }

    /// The distances, m, from the closest approach at which it passes its kinks.
    pub fn passes(&self) -> [f64; SUMMIT_KINKS] {
        self.kinks.map(|kink| self.recovery - kink)
    }

    /// Visits its numbers, as [`OutlinedSummit::each`]; the accuracy of lengths is relative to the recovery.
    pub fn each(&mut self, mut visit: impl FnMut(&mut f64, Option<f64>)) {
        let recovery = self.recovery.abs();
        visit(&mut self.recovery, Some(0.0));
        visit(&mut self.ratio, Some(0.0));
        self.kinks.iter_mut().filter(|kink| kink.is_finite()).for_each(|kink| visit(kink, Some(recovery)));
        self.outlined.each(visit);
    }

    /// Which optional numbers it has, as bits.
    pub fn kind(&self) -> u64 {
        self.kinks.iter().fold(self.outlined.kind(), |bits, kink| 2 * bits + u64::from(kink.is_finite()))
    }

    /// Computes the quantities that follow from its numbers.
    pub fn close(&mut self) {
        let [lambda, sphere] = self.units;
        self.outlined.outline.lambda = lambda * libm::cbrt(self.ratio);
        self.outlined.outline.outside = self.ratio / sphere;
    }

    /// The asperity whose radius is that of the apex.
    pub fn lane(&self) -> Lane {
        Lane::of_summit(self.ratio, Some(&self.outlined).filter(|summit| summit.outline.lambda > 0.0))
    }
}

/// Flattened summits in a row, each with the asperity of its apex.
#[derive(Clone, Debug, Default)]
pub(super) struct FlattenedSummits {
    lanes: Vec<Lane>,
    outlined: Vec<OutlinedSummit>,
    recovery: Vec<f64>,
}

impl FlattenedSummits {
    /// Makes room for more summits.
    pub fn reserve(&mut self, count: usize) {
        self.lanes.reserve(count);
        self.outlined.reserve(count);
        self.recovery.reserve(count);
    }

    /// Adds a summit.
    pub fn push(&mut self, summit: FlattenedSummit) {
        self.lanes.push(summit.lane());
        self.outlined.push(summit.outlined);
        self.recovery.push(summit.recovery);
    }

    /// The number of summits.
    pub fn count(&self) -> usize {
        self.lanes.len()
    }

    /// Writes the responses of the summits that `which` numbers, in a regime of a law at a distance, m, from the closest approach.
    /// Interferences are limited to the regime, as each summit has it, so that rounding does not lead out of it. Contact has no
    /// upper limit, as it is elastic up to ω_max.
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
        law.evaluate(regime, Lanes::of_summits(&self.lanes, &self.outlined, which), own, out, stats);
    }

    /// The responses of all of at most [`BLOCK`] summits.
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
