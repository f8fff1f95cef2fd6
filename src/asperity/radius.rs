//! Quantities of a law as they follow the radius, and the law of one radius.
//!
//! # Formula
//! ρ is the radius over that of the law. A quantity of a closed form is similar: f(δ; ρ) = ρ^v f(o + (δ − o)ρ^(−w)), with
//! exponents v, w and an origin o of its own. Elastic adhesive parts have λ ρ^(1/3), s_δ ρ^(1/3), s_a ρ^(2/3), s_F ρ, and are
//! solved ([`super::elastic`]).

use super::block::Responses;
use super::history::Path;
use super::lane::{Lane, Lanes, Numbered};
use super::law::{Boundary, Law, Method, Piece, RadiusDependence, Regime};
use super::outline::OutlinedSummit;
use super::stats::SolverStats;
use std::ops::Range;
use std::sync::Arc;

/// The similarity by which a quantity follows the radius: ρ^value times itself at o + (δ − o)ρ^(−place).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Similarity {
    /// o, m.
    pub origin: f64,
    /// Exponent of ρ in lengths.
    pub place: f64,
    /// Exponent of ρ in values.
    pub value: f64,
}

impl Similarity {
    /// Lengths as ρ^place from δ = 0, values as ρ^value.
    pub const fn new(place: f64, value: f64) -> Self {
        Self { origin: 0.0, place, value }
    }

    /// Interference, m, of an asperity that corresponds to one of the law.
    pub fn interference(&self, interference: f64, lane: &Lane) -> f64 {
        if self.place == 0.0 || interference.is_infinite() {
            return interference;
        }
        let power = if self.place == 1.0 { lane.ratio } else { libm::pow(lane.ratio, self.place) };
        self.origin + (interference - self.origin) * power
    }
}

/// An interference at which a regime ends, and its dependence on the radius.
#[derive(Clone)]
pub struct Place {
    pub(super) interference: f64,
    follows: Follows,
}

#[derive(Clone)]
enum Follows {
    /// As lengths of a similarity do.
    Similar(Similarity),
    /// The beginning or the end of elastic contact, in units of `length` at ρ = 1, at least `least`, plus `offset`, m.
    Elastic { path: Path, length: f64, least: f64, offset: f64 },
    /// As a function of the asperity.
    Law(Arc<dyn Fn(&Lane) -> f64 + Send + Sync>),
}

impl From<f64> for Place {
    /// One place for every radius.
    fn from(interference: f64) -> Self {
        Self { interference, follows: Follows::Similar(Similarity::new(0.0, 0.0)) }
    }
}

impl Place {
    /// An interference, m, that is proportional to ρ^exponent.
    pub fn proportional(interference: f64, exponent: f64) -> Self {
        Self { interference, follows: Follows::Similar(Similarity::new(exponent, 0.0)) }
    }

    /// The beginning or end of elastic contact by the history, with s_δ = `length` at ρ = 1: the larger of
    /// that and `least`, plus `offset`, m. It is at `interference` for ρ = 1.
    pub fn elastic(interference: f64, path: Path, length: f64, (least, offset): (f64, f64)) -> Self {
        Self { interference, follows: Follows::Elastic { path, length, least, offset } }
    }

    /// An interference, m, that is a function of the asperity. It is at `interference` for ρ = 1.
    pub fn following(interference: f64, of: impl Fn(&Lane) -> f64 + Send + Sync + 'static) -> Self {
        Self { interference, follows: Follows::Law(Arc::new(of)) }
    }

    /// δ, m, for an asperity.
    pub fn of(&self, lane: &Lane) -> f64 {
        match &self.follows {
            Follows::Similar(similarity) => similarity.interference(self.interference, lane),
            &Follows::Elastic { path, length, least, offset } => {
                (lane.elastic.end(path) * (length * lane.cube_root)).max(least) + offset
            }
            Follows::Law(of) => of(lane),
        }
    }
}

/// The law of the asperities of one radius, as lanes that are alike.
pub struct RadiusLaw {
    law: Arc<dyn Law>,
    lane: [Lane; 1],
    boundaries: Vec<Boundary>,
}

impl RadiusLaw {
    /// The law of an asperity, from one that follows the radius.
    pub fn new(law: &Arc<dyn Law>, lane: Lane) -> Self {
        let mut ends = Vec::new();
        law.ends(&lane, &mut ends);
        let boundary = |(own, end): (&Boundary, f64)| Boundary { interference: end, ..*own };
        let boundaries = law.boundaries().iter().zip(ends).map(boundary).collect();
        Self { law: Arc::clone(law), lane: [lane], boundaries }
    }
}

/// Lanes are relative to the law that this one is made of.
impl Law for RadiusLaw {
    fn regimes(&self) -> &[Regime] {
        self.law.regimes()
    }

    fn boundaries(&self) -> &[Boundary] {
        &self.boundaries
    }

    fn radius_dependence(&self) -> RadiusDependence {
        self.law.radius_dependence()
    }

    fn end(&self, regime: usize, lane: &Lane) -> Option<f64> {
        self.law.end(regime, lane)
    }

    fn pieces_within(&self, regime: usize, lane: Option<&Lane>, within: Range<f64>) -> Vec<Piece> {
        self.law.pieces_within(regime, lane.or(self.lane.first()), within)
    }

    fn capture(&self, lane: Option<&Lane>) -> Option<f64> {
        self.law.capture(lane.or(self.lane.first()))
    }

    fn kinks_of_summit(&self, regime: usize, lane: &Lane, summit: &OutlinedSummit) -> Vec<f64> {
        self.law.kinks_of_summit(regime, lane, summit)
    }

    fn method(&self, regime: usize) -> Method {
        match self.law.method(regime) {
            Method::Constant(force) => Method::Constant(force * self.lane[0].ratio),
            // The series that takes the place of solves is another.
            Method::Noncontact { .. } => Method::Noncontact { far: None },
            method => method,
        }
    }

    fn evaluate(
        &self,
        regime: usize,
        lanes: Lanes<'_>,
        interference: &[f64],
        out: &mut Responses,
        stats: &mut SolverStats,
    ) {
        let lanes = match lanes {
            Lanes::Own => Lanes::Each(Numbered::alike(&self.lane)),
            each => each,
        };
        self.law.evaluate(regime, lanes, interference, out, stats);
    }
}
