//! Springback of contacts that have flowed: the shape of their tops, and the forces while there is contact.
//!
//! # Formula
//! The contact radius a and the load P at ω_max make the top, of the radius R′ and the recovery ω_max − ω_res:
//!
//! | unloading | R′ | ω_max − ω_res | contact |
//! |---|---|---|---|
//! | Etsion, Kligerman and Kadin | R, or 4E_r a³/(3P) | `plastic_unloading` | powers, F_s as below |
//! | secant | 4E_r a³/(3P) | 3P/(4E_r a) | the law's elastic contact with R′ |
//! | flattened top | 4E_r a³/(3P) | δ of the law's elastic contact with R′ where its radius is a | the law's elastic contact with R′ |
//! | Thornton and Ning | 4E_r a³/(3P) | 3P/(4E_r a) | JKR's contact with R′ |
//! | Mesarovic and Johnson | πE_r a³/P | 2P/(πE_r a) | `decohesion`, p₀ = P/(πa²) |
//!
//! Powers have F_s = q F_s(ω_max) + (1 − q) f(δ′), q = ω_res/ω_max, where f = F_s − P + P_H is what adhesion takes from Hertz's
//! load P_H in the law's elastic contact, at the δ′ that is as far on its way from ω_c: the excess over the elastic law
//! vanishes with what has flowed.
//!
//! The first R′ and recovery belong to the sphere whose Hertz contact has the radius a at the load P, the
//! last ones to the middle of the area that a uniform pressure P/(πa²) has pressed flat, when it is taken off
//! (Johnson 1985, section 3.4).

use super::block::{BLOCK, Responses};
use super::decohesion::Decohesion;
use super::flattened::Around;
use super::lane::{Lane, Lanes};
use super::law::{End, Law, Regime, Smoothness};
use super::plastic_unloading::PlasticUnloading;
use super::radius::RadiusLaw;
use super::scale::Scale;
use super::stats::SolverStats;
use std::f64::consts::PI;
use std::sync::Arc;

/// The powers of r are no power series in any root of it; in the tenth what is left is too smooth to matter.
pub(super) const POWERS: i32 = 10;

/// The springback of contacts that have flowed.
pub(super) enum Springback {
    /// Powers of the rest of the way, with an adhesion between that at ω_max and that of the elastic law.
    Powers(PlasticUnloading),
    /// Elastic contacts: of the law on retraction, or of a law of their own.
    Elastic(Option<Arc<dyn Law>>),
    /// The elastic contact of the law on retraction, from the state that it had, with its surroundings in
    /// units of the radius that others are multiples of.
    Flattened(Around),
    /// Punches whose edges open; the law is of elastic contacts which end alike.
    Punch(Arc<dyn Law>),
}

/// The top of an asperity that has flowed.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Top {
    /// ω_max − ω_res, m.
    pub recovery: f64,
    /// R′/R.
    pub ratio: f64,
    /// μ of its decohesion.
    adhesion: f64,
}

/// Tops, each with the lane of R′, and the law of their asperities on retraction.
#[derive(Clone, Copy)]
pub(super) struct Tops<'a> {
    pub law: &'a dyn Law,
    pub tops: &'a [Top],
    pub lanes: &'a [Lane],
}

impl Springback {
    /// The springback of asperities of another radius.
    pub fn of(&self, lane: Lane) -> Self {
        let own = |law: &Arc<dyn Law>| -> Arc<dyn Law> { Arc::new(RadiusLaw::new(law, lane)) };
        match self {
            Self::Powers(plastic) => Self::Powers(plastic.of_radius(lane.ratio)),
            Self::Elastic(law) => Self::Elastic(law.as_ref().map(own)),
            Self::Flattened(around) => Self::Flattened(*around),
            Self::Punch(law) => Self::Punch(own(law)),
        }
    }

    /// The top of a contact of P, N, and the area, m², at ω_max; but for the recovery along powers.
    pub fn top(&self, scale: &Scale, load: f64, area: f64) -> Top {
        let radius = (area / PI).sqrt() / scale.radius;
        let ratio = scale.force * radius * radius * radius / load;
        let recovery = scale.length * radius * radius / ratio;
        match self {
            Self::Powers(_) | Self::Elastic(_) => Top { recovery, ratio, adhesion: 0.0 },
            Self::Flattened(around) => {
                let recovery = around.scale.length * around.pressed(load, area).displacement();
                Top { recovery, ratio, adhesion: 0.0 }
            }
            Self::Punch(_) => Top {
                recovery: 8.0 / (3.0 * PI) * recovery,
                ratio: 0.75 * PI * ratio,
                adhesion: 0.25 * PI * 6.0_f64.sqrt() * ratio / (radius * radius.sqrt()),
            },
        }
    }

    /// The law of which the end of contact is that of a contact which springs back; `law` is that of the asperity on
    /// retraction.
    pub fn contact<'a>(&'a self, law: &'a dyn Law) -> &'a dyn Law {
        match self {
            Self::Elastic(Some(own)) | Self::Punch(own) => own.as_ref(),
            Self::Powers(_) | Self::Elastic(None) | Self::Flattened(_) => law,
        }
    }

    /// The interference, m, from the lowered top at which its contact ends.
    pub fn release(&self, law: &dyn Law, top: &Top, lane: &Lane) -> f64 {
        match self {
            Self::Punch(_) => top.recovery * (1.0 - Decohesion::new(top.adhesion).end()),
            _ => lower_limit(self.contact(law), first_contact(self.contact(law)), lane),
        }
    }

    /// The interference, m, from the lowered top at which a contact is not smooth, if there is one.
    pub fn kink(&self, top: &Top) -> f64 {
        match self {
            Self::Powers(_) => 0.0,
            Self::Elastic(_) | Self::Flattened(_) => f64::NAN,
            Self::Punch(_) => top.recovery * (1.0 - top.adhesion),
        }
    }

    /// Order of the root by which a contact varies at its end.
    pub fn order(&self, law: &dyn Law) -> i32 {
        let contact = self.contact(law);
        match contact.pieces_of(first_contact(contact), None).first().map(|piece| piece.smoothness) {
            Some(Smoothness::Root { end: End::Lower, order, .. }) => order,
            _ => 1,
        }
    }

    /// Unloads tops, whose responses at ω_max `out` has, to a distance, m, from there. Contacts that follow
    /// powers have no tops.
    pub fn unload(
        &self,
        Tops { law, tops, lanes }: Tops<'_>,
        distance: f64,
        out: &mut Responses,
        stats: &mut SolverStats,
    ) {
        match self {
            Self::Powers(_) => unreachable!("powers have no tops"),
            Self::Elastic(_) | Self::Flattened(_) => {
                let contact = self.contact(law);
                let mut own = [0.0; BLOCK];
                let own = &mut own[..tops.len()];
                own.iter_mut().zip(tops).for_each(|(own, top)| *own = top.recovery - distance);
                // Deeper than ω_c it stays elastic.
                let first = first_contact(contact);
                within(contact, first, lanes, own, f64::INFINITY);
                contact.evaluate(first, Lanes::each(lanes), own, out, stats);
            }
            Self::Punch(_) => {
                for (i, top) in tops.iter().enumerate() {
                    let peeled = Decohesion::new(top.adhesion).at(distance / top.recovery);
                    out.adhesion[i] = out.contact[i] * peeled.pull;
                    out.contact[i] *= peeled.load;
                    out.area[i] *= peeled.radius * peeled.radius;
                }
            }
        }
    }
}

/// Mixes the adhesion of contacts that follow powers with that of the elastic law, by the share that they
/// spring back.
pub(super) fn fade(
    plastic: &PlasticUnloading,
    (law, scale): (&dyn Law, &Scale),
    (largest, distance): (&[f64], f64),
    out: &mut Responses,
    stats: &mut SolverStats,
) {
    let (mut shares, mut places) = ([0.0; BLOCK], [distance; BLOCK]);
    let (shares, places) = (&mut shares[..largest.len()], &mut places[..largest.len()]);
    plastic.elastic_places(largest, shares, places);
    let first = first_contact(law);
    let end = first.checked_sub(1).map_or(f64::NEG_INFINITY, |below| law.boundaries()[below].interference);
    places.iter_mut().for_each(|place| *place = place.max(end));
    let mut elastic = Responses::default();
    law.evaluate(first, Lanes::Own, places, &mut elastic, stats);
    for (i, (share, place)) in shares.iter().zip(&*places).enumerate() {
        out.adhesion[i] = share * out.adhesion[i] + (1.0 - share) * pull(scale, *place, &elastic, i);
    }
}

/// The part that adhesion takes from the load of Hertz's contact at an interference δ, m, N: F_s − P + P_H,
/// of responses at a place.
pub(super) fn pull(scale: &Scale, interference: f64, responses: &Responses, place: usize) -> f64 {
    let depth = (interference / scale.length).max(0.0);
    responses.adhesion[place] - responses.contact[place] + scale.force * depth * depth.sqrt()
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
