//! Asperities of a block that differ in their radii: the radius is a lane of the block, not a law of its own.

use super::block::{BLOCK, Responses};
use super::elastic::Elastic;
use super::outline::OutlinedSummit;
use super::scale::Scale;
use crate::math::exponential::exp;
use crate::math::instruction_set::InstructionSet;
use std::f64::consts::PI;

/// The numbers of a block of asperities in their order.
pub(super) const EACH: [u32; BLOCK] = {
    let (mut each, mut i) = ([0; BLOCK], 0);
    while i < BLOCK {
        each[i] = i as u32;
        i += 1;
    }
    each
};

/// An asperity by its radius, with ρ the radius over that of the law.
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

    /// The asperity of a flattened summit whose apex has the radius ρ = `ratio`, with the branches of its outline if the law solves
    /// them.
    pub(super) fn of_summit(ratio: f64, summit: Option<&OutlinedSummit>) -> Self {
        let elastic =
            summit.map(|summit| Elastic::of_ends(summit.outline.lambda, &summit.ends)).unwrap_or_default();
        Self { elastic, ..Self::new(ratio, None) }
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
    /// The flattened summits of all if they have yielded; else empty.
    summits: &'a [OutlinedSummit],
}

impl<'a> Lanes<'a> {
    /// The asperities of `all` that `which` numbers.
    pub fn new(all: &'a [Lane], which: &'a [u32]) -> Self {
        Self::Each(Numbered::new(all, which))
    }

    /// The asperities of `all` that `which` numbers, with flattened summits.
    pub(super) fn of_summits(all: &'a [Lane], summits: &'a [OutlinedSummit], which: &'a [u32]) -> Self {
        Self::Each(Numbered { all, which, summits })
    }

    /// At most [`BLOCK`] asperities in their order.
    pub fn each(all: &'a [Lane]) -> Self {
        Self::new(all, &EACH[..all.len()])
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
        if let Self::Each(lanes) = self
            && lanes.have_summits()
        {
            for (i, radius) in radius.iter().enumerate() {
                let Lane { ratio, cube_root, .. } = *lanes.at(i);
                let force = scale.force * ratio;
                adhesion[i] *= force;
                contact[i] = force * lanes.summit(i).outline.load(*radius);
                area[i] = area_unit * (ratio * cube_root) * (radius * radius);
            }
            return;
        }
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
    /// The asperities of `all` that `which` numbers.
    pub fn new(all: &'a [Lane], which: &'a [u32]) -> Self {
        Self { all, which, summits: &[] }
    }

    /// A full block of asperities that are alike.
    pub fn alike(lane: &'a [Lane; 1]) -> Self {
        Self { all: lane, which: &[0; BLOCK], summits: &[] }
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

    /// Whether the asperities have flattened summits.
    #[inline(always)]
    pub(super) fn have_summits(self) -> bool {
        !self.summits.is_empty()
    }

    /// The summit of a lane.
    #[inline(always)]
    pub(super) fn summit(self, lane: usize) -> &'a OutlinedSummit {
        &self.summits[self.which[lane] as usize]
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
            // Asperities that are alike have one power.
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
