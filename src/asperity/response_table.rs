//! Responses of asperities of one radius, tabulated over an interference.

use super::block::{BLOCK, Responses};
use super::law::{End, Piece, Smoothness};
use crate::math::instruction_set::InstructionSet;
use crate::math::piecewise::{Piecewise, leading};

/// F_s, P and the area, piece by piece of a law. Interferences at which no polynomial is accurate are in no cell, and are solved.
#[derive(Default)]
pub(super) struct ResponseTable {
    parts: Vec<Part>,
}

/// The table of a piece.
struct Part {
    lower: f64,
    upper: f64,
    variable: Variable,
    /// F_s, N, P, N, and the area, m².
    columns: [Piecewise; 3],
}

/// The variable in which a piece is smooth.
#[derive(Clone, Copy)]
enum Variable {
    /// δ itself, m.
    Interference,
    /// |δ − place|^(1/2), by the place of a fold, m, and the side of it.
    Root { place: f64, side: f64 },
}

impl Variable {
    fn of(smoothness: Smoothness) -> Self {
        match smoothness {
            Smoothness::Root { end: End::Lower, place, order: 2 } => Self::Root { place, side: 1.0 },
            Smoothness::Root { end: End::Upper, place, order: 2 } => Self::Root { place, side: -1.0 },
            _ => Self::Interference,
        }
    }

    /// The variable at an interference, m.
    #[inline(always)]
    fn at(self, interference: f64) -> f64 {
        match self {
            Self::Interference => interference,
            Self::Root { place, side } => (side * (interference - place)).max(0.0).sqrt(),
        }
    }

    /// The interference, m, at a value of the variable.
    fn interference(self, variable: f64) -> f64 {
        match self {
            Self::Interference => variable,
            Self::Root { place, side } => place + side * variable * variable,
        }
    }
}

impl ResponseTable {
    /// The table of the responses that `respond` gives on pieces up to the interference `deepest`, m, to a relative `tolerance`;
    /// cells are halved `halvings` times at most.
    pub fn new(
        pieces: &[Piece],
        deepest: f64,
        (tolerance, halvings): (f64, u32),
        mut respond: impl FnMut(&[f64], &mut Responses),
    ) -> Self {
        let mut responses = Responses::default();
        let part = |piece: &Piece| {
            let (lower, upper) = (piece.lower, piece.upper.min(deepest));
            let variable = Variable::of(piece.smoothness);
            let mut ends = [lower, upper].map(|end| variable.at(end));
            ends.sort_by(f64::total_cmp);
            let mut interference = Vec::new();
            let samples = |places: &[f64]| {
                interference.clear();
                interference
                    .extend(places.iter().map(|place| variable.interference(*place).clamp(lower, upper)));
                respond(&interference, &mut responses);
                let Responses { adhesion, contact, area } = &responses;
                (0..places.len()).map(|i| [adhesion[i], contact[i], area[i]]).collect()
            };
            let columns = if lower < upper {
                Piecewise::together(samples, tolerance, ends.into(), halvings)
            } else {
                Default::default()
            };
            Part { lower, upper, variable, columns }
        };
        Self { parts: pieces.iter().map(part).collect() }
    }

    /// Writes the responses at interferences, m, at most [`BLOCK`]; `solve` finds the responses that are in no cell.
    pub fn respond(
        &self,
        interference: &[f64],
        out: &mut Responses,
        solve: impl FnOnce(&[f64], &mut Responses),
    ) {
        let has_all = InstructionSet::current().run(
            #[inline(always)]
            || self.read(interference, out),
        );
        if has_all {
            return;
        }
        let (mut missing, mut which, mut count) = ([0.0; BLOCK], [0; BLOCK], 0);
        for (i, own) in interference.iter().enumerate() {
            if out.adhesion[i].is_nan() {
                (missing[count], which[count]) = (*own, i);
                count += 1;
            }
        }
        let mut solved = Responses::default();
        solve(&missing[..count], &mut solved);
        for (i, at) in which[..count].iter().enumerate() {
            out.adhesion[*at] = solved.adhesion[i];
            out.contact[*at] = solved.contact[i];
            out.area[*at] = solved.area[i];
        }
    }

    /// Reads the responses that are in cells, and returns whether all are; F_s is NaN for the others.
    #[inline(always)]
    fn read(&self, interference: &[f64], out: &mut Responses) -> bool {
        let mut variable = [0.0; BLOCK];
        let (mut begin, mut has_all) = (0, true);
        while begin < interference.len() {
            let from = interference[begin];
            let part = self.parts.iter().find(|part| part.lower < from && from <= part.upper);
            let length =
                part.map_or(1, |part| leading(&interference[begin..], part.lower, part.upper).max(1));
            let own = begin..begin + length;
            begin += length;
            let Some(part) = part else {
                out.adhesion[own].fill(f64::NAN);
                has_all = false;
                continue;
            };
            let variable = &mut variable[..length];
            variable
                .iter_mut()
                .zip(&interference[own.clone()])
                .for_each(|(v, own)| *v = part.variable.at(*own));
            let Responses { adhesion, contact, area } = out;
            let columns = [&mut adhesion[own.clone()], &mut contact[own.clone()], &mut area[own.clone()]];
            for (table, column) in part.columns.iter().zip(columns) {
                table.values(variable, column);
            }
            has_all &= !out.adhesion[own].iter().fold(false, |any, value| any | value.is_nan());
        }
        has_all
    }
}
