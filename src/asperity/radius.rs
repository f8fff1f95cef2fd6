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
    /// Elastic branches of the asperity, of a law that solves them.
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

/// The asperities of a block.
#[derive(Clone, Copy)]
pub enum Lanes<'a> {
    /// All have the radius of the law.
    Own,
    /// Each has a radius.
    Each(Numbered<'a>),
}

/// Asperities of a block, by their numbers among many.
#[derive(Clone, Copy)]
pub struct Numbered<'a> {
    all: &'a [Lane],
    which: &'a [u32],
}

impl<'a> Lanes<'a> {
    /// The asperities of `all` that `which` numbers.
    pub fn new(all: &'a [Lane], which: &'a [u32]) -> Self {
        Self::Each(Numbered { all, which })
    }

    /// The displacements Δ of interferences δ, m, to which an `offset`, m, is added.
    pub fn displacements(self, scale: &Scale, offset: f64, interference: &[f64], out: &mut [f64]) {
        let inverse = 1.0 / scale.length;
        InstructionSet::current().run(
            #[inline(always)]
            || {
                let out = out.iter_mut().zip(interference);
                match self {
                    Self::Own => out.for_each(|(own, delta)| *own = (delta + offset) * inverse),
                    Self::Each(lanes) => out.enumerate().for_each(|(i, (own, delta))| {
                        *own = (delta + offset) * (inverse * lanes.at(i).per_cube_root);
                    }),
                }
            },
        );
    }

    /// Completes the first contacts from their scaled adhesion forces, which are in place, and scaled contact radii A:
    /// F_s and P = A³ in the unit of force, area πa².
    #[inline(always)]
    pub fn scale_contacts(self, scale: &Scale, radius: &[f64], out: &mut Responses) {
        let area_unit = PI * scale.radius * scale.radius;
        let Responses { adhesion, contact, area } = out;
        let contacts = radius.iter().zip(adhesion).zip(contact).zip(area).enumerate();
        for (i, (((radius, adhesion), contact), area)) in contacts {
            let (force, area_unit) = match self {
                Self::Own => (scale.force, area_unit),
                Self::Each(lanes) => {
                    let Lane { ratio, cube_root, .. } = *lanes.at(i);
                    (scale.force * ratio, area_unit * (ratio * cube_root))
                }
            };
            let square = radius * radius;
            *adhesion *= force;
            *contact = force * square * radius;
            *area = area_unit * square;
        }
    }
}

impl<'a> Numbered<'a> {
    /// A full block of asperities that are alike.
    pub fn alike(lane: &'a [Lane; 1]) -> Self {
        Self { all: lane, which: &[0; BLOCK] }
    }

    /// The lanes from one on.
    pub fn from(self, first: usize) -> Self {
        Self { which: &self.which[first..], ..self }
    }

    /// The asperity of a lane.
    #[inline(always)]
    pub fn at(self, lane: usize) -> &'a Lane {
        &self.all[self.which[lane] as usize]
    }

    /// Multiplies values by ρ^exponent, lane by lane.
    #[inline(always)]
    pub fn times_power(self, exponent: f64, values: &mut [f64]) {
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

    fn follows_radius(&self) -> bool {
        self.law.follows_radius()
    }

    fn lambda(&self) -> Option<f64> {
        self.law.lambda()
    }

    fn end(&self, regime: usize, lane: &Lane) -> Option<f64> {
        self.law.end(regime, lane)
    }

    fn pieces(&self, lane: Option<&Lane>) -> Vec<Piece> {
        self.law.pieces(lane.or(self.lane.first()))
    }

    fn capture(&self, lane: Option<&Lane>) -> Option<f64> {
        self.law.capture(lane.or(self.lane.first()))
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
