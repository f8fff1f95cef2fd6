//! Asperities of a law that differ in their radii: what follows the radius is a lane of a block, not a law of its own.
//!
//! # Formula
//! ρ is the radius over that of the law. A quantity of a closed form is similar: f(δ; ρ) = ρ^v f(o + (δ − o)ρ^(−w)), with
//! exponents v, w and an origin o of its own. Elastic adhesive parts have λ ρ^(1/3), s_δ ρ^(1/3), s_a ρ^(2/3), s_F ρ, and are
//! solved ([`super::elastic`]).

use super::elastic::Elastic;
use super::history::Path;
use super::law::{BLOCK, Boundary, Law, Method, Piece, Regime, Responses};
use super::scale::Scale;
use super::stats::SolverStats;
use crate::math::exponential::exp;
use crate::math::instruction_set::InstructionSet;
use std::f64::consts::PI;
use std::sync::Arc;

/// An asperity of a radius.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub struct Lane {
    /// Its elastic branches, of a law that solves them.
    pub elastic: Elastic,
    /// ρ.
    pub ratio: f64,
    /// ρ^(1/2).
    pub root: f64,
    /// ρ^(1/3).
    pub cube_root: f64,
    /// ρ^(−1/3).
    pub per_cube_root: f64,
    /// ln ρ.
    pub logarithm: f64,
}

impl Lane {
    /// The asperity of ρ = `ratio`, of a law whose adhesion parameter is `lambda` at ρ = 1 if it solves elastic branches.
    pub fn new(ratio: f64, lambda: Option<f64>) -> Self {
        let cube_root = libm::cbrt(ratio);
        let elastic = lambda.map(|lambda| Elastic::new(lambda * cube_root)).unwrap_or_default();
        Self {
            elastic,
            ratio,
            root: ratio.sqrt(),
            cube_root,
            per_cube_root: 1.0 / cube_root,
            logarithm: libm::log(ratio),
        }
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

    /// The lanes from one on.
    pub fn from(&self, first: usize) -> Self {
        Self { which: &self.which[first..], ..*self }
    }

    /// The asperity of a lane.
    #[inline(always)]
    pub fn at(&self, lane: usize) -> &'a Lane {
        &self.all[self.which[lane] as usize]
    }

    /// Completes the first contacts from their scaled adhesion forces, which are in place, and scaled contact radii A, which
    /// are in the place of areas, in the units at ρ = 1: as [`Responses::scale_contacts`].
    pub fn scale_contacts(&self, scale: &Scale, count: usize, out: &mut Responses) {
        let area_unit = PI * scale.radius * scale.radius;
        let Responses { adhesion, contact, area } = out;
        let lanes = adhesion[..count].iter_mut().zip(&mut contact[..count]).zip(&mut area[..count]);
        for (i, ((adhesion, contact), area)) in lanes.enumerate() {
            let Lane { ratio, cube_root, .. } = *self.at(i);
            let (force, radius) = (scale.force * ratio, *area);
            let square = radius * radius;
            *adhesion *= force;
            *contact = force * square * radius;
            *area = area_unit * (ratio * cube_root) * square;
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
                let power = exp(exponent * self.all[0].logarithm);
                values.iter_mut().for_each(|value| *value *= power);
            }
            _ => InstructionSet::current().run(
                #[inline(always)]
                || {
                    let mut powers = [0.0; BLOCK];
                    let powers = &mut powers[..values.len()];
                    for (lane, power) in powers.iter_mut().enumerate() {
                        *power = exponent * self.at(lane).logarithm;
                    }
                    values.iter_mut().zip(powers).for_each(|(value, power)| *value *= exp(*power));
                },
            ),
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

    /// As [`Law::capture`], of an asperity.
    fn capture_of(&self, lane: &Lane) -> Option<f64>;

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

    fn lanes(&self) -> &dyn OfRadii {
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
        self.lanes().pieces_of(&self.lane[0])
    }

    fn capture(&self) -> Option<f64> {
        self.lanes().capture_of(&self.lane[0])
    }

    // Lanes are relative to the law that this one is made of.
    fn of_radii(&self) -> Option<&dyn OfRadii> {
        self.law.of_radii()
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
        const ALIKE: [u32; BLOCK] = [0; BLOCK];
        let lanes = Lanes::new(&self.lane, &ALIKE[..interference.len()]);
        self.lanes().evaluate_lanes(regime, lanes, interference, out, stats);
    }
}
