//! Asperities of a law that differ in their radii: what follows the radius is a lane of a block, not a law of its own.
//!
//! # Formula
//! ρ is the radius over that of the law. A quantity of a closed form is similar: f(δ; ρ) = ρ^v f(o + (δ − o)ρ^(−w)), with
//! exponents v, w and an origin o of its own. Elastic adhesive parts have λ ρ^(1/3), s_δ ρ^(1/3), s_a ρ^(2/3), s_F ρ, and are
//! solved ([`super::elastic`]).

use super::elastic::Elastic;
use super::history::Path;
use super::law::{Boundary, Law, Method, Piece, Regime, Responses};
use super::scale::Scale;
use super::stats::SolverStats;
use std::f64::consts::PI;
use std::sync::Arc;

/// An asperity of a radius.
#[derive(Clone, Copy, Debug)]
pub struct Lane {
    /// ρ.
    pub ratio: f64,
    /// ρ^(1/2).
    pub root: f64,
    /// ρ^(1/3).
    pub cube_root: f64,
    /// Its elastic branches, of a law that solves them.
    pub elastic: Elastic,
}

impl Lane {
    /// The asperity of ρ = `ratio`, of a law whose adhesion parameter is `lambda` at ρ = 1 if it solves elastic branches.
    pub fn new(ratio: f64, lambda: Option<f64>) -> Self {
        let cube_root = libm::cbrt(ratio);
        let elastic = lambda.map(|lambda| Elastic::new(lambda * cube_root)).unwrap_or_default();
        Self { ratio, root: ratio.sqrt(), cube_root, elastic }
    }
}

/// Some of many asperities, in lanes.
#[derive(Clone, Copy)]
pub struct Lanes<'a> {
    all: &'a [Lane],
    which: &'a [u32],
}

impl<'a> Lanes<'a> {
    /// Those of `all` that `which` numbers.
    pub fn new(all: &'a [Lane], which: &'a [u32]) -> Self {
        Self { all, which }
    }

    /// The asperity of a lane.
    #[inline(always)]
    pub fn at(&self, lane: usize) -> &'a Lane {
        &self.all[self.which[lane] as usize]
    }

    /// Completes the first contacts from their scaled adhesion forces, which are in place, and scaled contact radii A, in the
    /// units at ρ = 1: as [`Responses::scale_contacts`].
    pub fn scale_contacts(&self, scale: &Scale, radius: &[f64], out: &mut Responses) {
        let area_unit = PI * scale.radius * scale.radius;
        for (i, &radius) in radius.iter().enumerate() {
            let Lane { ratio, cube_root, .. } = *self.at(i);
            let (force, square) = (scale.force * ratio, radius * radius);
            out.adhesion[i] *= force;
            out.contact[i] = force * square * radius;
            out.area[i] = area_unit * (ratio * cube_root) * square;
        }
    }

    /// Multiplies values by ρ^exponent, lane by lane.
    #[inline(always)]
    pub fn times_power(&self, exponent: f64, values: &mut [f64]) {
        let mut times = |power: &dyn Fn(&Lane) -> f64| {
            values.iter_mut().enumerate().for_each(|(lane, value)| *value *= power(self.at(lane)));
        };
        match exponent {
            0.0 => {}
            0.5 => times(&|lane| lane.root),
            1.0 => times(&|lane| lane.ratio),
            -1.0 => times(&|lane| 1.0 / lane.ratio),
            2.0 => times(&|lane| lane.ratio * lane.ratio),
            // Of asperities that are alike the power is the same.
            _ if self.all.len() == 1 => {
                let power = libm::pow(self.all[0].ratio, exponent);
                values.iter_mut().for_each(|value| *value *= power);
            }
            _ => times(&|lane| libm::pow(lane.ratio, exponent)),
        }
    }
}

/// How a quantity follows the radius: ρ^value times itself at o + (δ − o)ρ^(−place).
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

    /// Where an interference of the law is, m, for an asperity.
    pub fn interference(&self, interference: f64, lane: &Lane) -> f64 {
        if self.place == 0.0 || interference.is_infinite() {
            return interference;
        }
        let power = if self.place == 1.0 { lane.ratio } else { libm::pow(lane.ratio, self.place) };
        self.origin + (interference - self.origin) * power
    }
}

/// An interference at which a regime ends, and how it follows the radius.
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
    /// The same for every radius.
    fn from(interference: f64) -> Self {
        Self { interference, follows: Follows::Similar(Similarity::new(0.0, 0.0)) }
    }
}

impl Place {
    /// An interference, m, that is proportional to ρ^exponent.
    pub fn proportional(interference: f64, exponent: f64) -> Self {
        Self { interference, follows: Follows::Similar(Similarity::new(exponent, 0.0)) }
    }

    /// Where elastic contact begins or ends by the history, with s_δ = `length` at ρ = 1: the larger of that and `least`,
    /// plus `offset`, m. It is at `interference` for ρ = 1.
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

/// A law as that of asperities of other radii.
pub trait OfRadii: Send + Sync {
    /// λ at ρ = 1, if elastic branches are solved.
    fn lambda(&self) -> Option<f64>;

    /// The ends of regimes of an asperity, m, rising.
    fn ends(&self, lane: &Lane, out: &mut Vec<f64>);

    /// The end of a regime of an asperity, m, if it has one.
    fn end(&self, regime: usize, lane: &Lane) -> Option<f64>;

    /// The pieces of an asperity.
    fn pieces_of(&self, lane: &Lane) -> Vec<Piece>;

    /// Fills the first responses for asperities, at most [`BLOCK`](super::law::BLOCK), at interferences δ, m, which lie in
    /// one regime.
    fn evaluate_lanes(
        &self,
        regime: usize,
        lanes: Lanes<'_>,
        interference: &[f64],
        out: &mut Responses,
        stats: &mut SolverStats,
    );
}

/// The law of the asperities of one radius, as lanes that are alike.
pub struct RadiusLaw {
    law: Arc<dyn Law>,
    lane: [Lane; 1],
    boundaries: Vec<Boundary>,
}

impl RadiusLaw {
    /// The law of an asperity.
    ///
    /// # Panics
    /// When it is not known how the law follows the radius.
    pub fn new(law: &Arc<dyn Law>, lane: Lane) -> Self {
        let of_radii = law.of_radii().expect("a family is of a law that follows the radius");
        let mut ends = Vec::new();
        of_radii.ends(&lane, &mut ends);
        let boundary = |(own, end): (&Boundary, f64)| Boundary { interference: end, ..*own };
        let boundaries = law.boundaries().iter().zip(ends).map(boundary).collect();
        Self { law: Arc::clone(law), lane: [lane], boundaries }
    }

    fn of_radii(&self) -> &dyn OfRadii {
        self.law.of_radii().expect("a family is of a law that follows the radius")
    }
}

impl Law for RadiusLaw {
    fn regimes(&self) -> &[Regime] {
        self.law.regimes()
    }

    fn boundaries(&self) -> &[Boundary] {
        &self.boundaries
    }

    fn pieces(&self) -> Vec<Piece> {
        self.of_radii().pieces_of(&self.lane[0])
    }

    fn method(&self, regime: usize) -> Method {
        match self.law.method(regime) {
            Method::Constant(force) => Method::Constant(force * self.lane[0].ratio),
            // The series that takes the place of solves is another.
            Method::Noncontact { .. } => Method::Noncontact { far: None },
            method => method,
        }
    }

    fn evaluate(&self, regime: usize, interference: &[f64], out: &mut Responses, stats: &mut SolverStats) {
        const ALIKE: [u32; super::law::BLOCK] = [0; super::law::BLOCK];
        let lanes = Lanes::new(&self.lane, &ALIKE[..interference.len()]);
        self.of_radii().evaluate_lanes(regime, lanes, interference, out, stats);
    }
}
