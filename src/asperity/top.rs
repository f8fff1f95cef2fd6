//! The top of an asperity that has flowed, and its contact while it is unloaded.
//!
//! # Formula
//! The contact radius a and the load P at ω_max leave a top of the radius R′ = K a³/P, of the sphere whose Hertz contact has that
//! radius at that load. It springs back by its recovery ω_max − ω_res, the interference of the law's elastic contact with R′ where
//! the radius of that is a ([`super::flattened`]), and unloads as this contact.

use super::block::{BLOCK, Responses};
use super::flattened::Around;
use super::lane::{Lane, Lanes};
use super::law::{Law, Regime};
use super::scale::Scale;
use super::stats::SolverStats;
use std::f64::consts::PI;

/// The top of an asperity that has flowed.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Top {
    /// ω_max − ω_res, m.
    pub recovery: f64,
    /// R′/R.
    pub ratio: f64,
}

impl Top {
    /// The top of a contact of P, N, and the area, m², at ω_max, with its surroundings in units of the radius that others are
    /// multiples of.
    pub fn new(scale: &Scale, around: &Around, load: f64, area: f64) -> Self {
        let radius = (area / PI).sqrt() / scale.radius;
        Self {
            recovery: around.scale.length * around.pressed(load, area).displacement(),
            ratio: scale.force * radius * radius * radius / load,
        }
    }
}

/// Writes the responses of tops, each with the lane of R′, at a distance, m, from ω_max, by the law on retraction.
pub(super) fn unload(
    law: &dyn Law,
    (tops, lanes): (&[Top], &[Lane]),
    distance: f64,
    out: &mut Responses,
    stats: &mut SolverStats,
) {
    let mut own = [0.0; BLOCK];
    let own = &mut own[..tops.len()];
    own.iter_mut().zip(tops).for_each(|(own, top)| *own = top.recovery - distance);
    // Deeper than ω_c it stays elastic.
    let first = first_contact(law);
    within(law, first, lanes, own, f64::INFINITY);
    law.evaluate(first, Lanes::each(lanes), own, out, stats);
}

/// The regime in which contact begins.
pub(super) fn first_contact(law: &dyn Law) -> usize {
    law.regimes().iter().position(|regime: &Regime| regime.is_contact()).unwrap_or(law.regimes().len())
}

/// The interference, m, from which an asperity is in a regime.
fn lower_limit(law: &dyn Law, regime: usize, lane: &Lane) -> f64 {
    regime.checked_sub(1).and_then(|below| law.end(below, lane)).unwrap_or(f64::NEG_INFINITY)
}

/// Puts interferences, m, of asperities into a regime, or above it up to `beyond`, m: neither rounding nor a
/// contact that ends earlier than the law's own may lead out of it.
pub(super) fn within(law: &dyn Law, regime: usize, lanes: &[Lane], interference: &mut [f64], beyond: f64) {
    for (delta, lane) in interference.iter_mut().zip(lanes) {
        let upper = || law.end(regime, lane).unwrap_or(f64::INFINITY);
        let upper = if beyond == f64::INFINITY { beyond } else { upper().max(beyond) };
        *delta = delta.max(lower_limit(law, regime, lane)).min(upper);
    }
}
