//! Polynomials of a law on one offset or segment.

use super::geometry::Geometry;
use super::lanes::{DEGREE, TERMS};
use crate::asperity::{BLOCK, Lanes, Law, Piece, Responses, SolverStats};
use crate::math::chebyshev;

/// Nodes of an interpolant: more than terms, so that its tail shows how fast it converges.
const NODES: usize = 24;
/// The share of the tolerance that the tail may take; the rest is for rounding.
const TAIL: f64 = 0.5;

/// Adhesion force, contact force and area as polynomials of v in −1..1.
#[derive(Clone, Copy, Debug)]
pub(super) struct Polynomials {
    /// Regime of the law.
    pub regime: usize,
    /// Index of its smooth piece.
    pub piece: usize,
    /// Terms that are not 0.
    pub terms: usize,
    /// Whether contact force and area are not 0.
    pub touches: bool,
    /// F_s, P, area.
    pub coefficients: [[f64; TERMS]; 3],
}

/// A segment of an offset.
#[derive(Clone, Debug)]
pub(super) enum Cell {
    /// The law has ended.
    Nothing,
    /// Summed by moments.
    Smooth(Box<Polynomials>),
    /// Solved asperity by asperity.
    Direct {
        /// Regime of the law.
        regime: usize,
    },
}

/// One offset.
#[derive(Clone, Debug)]
pub(super) enum Offset {
    /// Summed by the moments of the whole period.
    Whole(Box<Polynomials>),
    /// Summed by segments.
    Split(Vec<Cell>),
}

impl Offset {
    /// Terms of the polynomials of the whole.
    pub fn terms(&self) -> Option<usize> {
        match self {
            Self::Whole(polynomials) => Some(polynomials.terms),
            Self::Split(_) => None,
        }
    }

    /// Segments that are solved asperity by asperity, and their regimes.
    pub fn solved(&self) -> impl Iterator<Item = (usize, usize)> {
        let cells = match self {
            Self::Whole(_) => &[],
            Self::Split(cells) => cells.as_slice(),
        };
        cells.iter().enumerate().filter_map(|(segment, cell)| match cell {
            Cell::Direct { regime } => Some((segment, *regime)),
            _ => None,
        })
    }

    /// The offset `offset` of a law with these pieces.
    pub fn new(law: &dyn Law, pieces: &[Piece], geometry: &Geometry, offset: i64, tolerance: f64) -> Self {
        let segments = geometry.segments();
        let whole = [geometry.interference(offset, 0)[0], geometry.interference(offset, segments - 1)[1]];
        if let Cell::Smooth(polynomials) = cell(law, pieces, whole, geometry.step, tolerance) {
            return Self::Whole(polynomials);
        }
        let segment =
            |segment| cell(law, pieces, geometry.interference(offset, segment), geometry.step, tolerance);
        Self::Split((0..segments).map(segment).collect())
    }
}

/// The piece that an interval lies in, up to rounding of its ends.
fn piece_of(pieces: &[Piece], [low, high]: [f64; 2], step: f64) -> Option<usize> {
    let slack = 1e-9 * step;
    pieces.iter().position(|piece| piece.lower <= low + slack && high - slack <= piece.upper)
}

fn cell(law: &dyn Law, pieces: &[Piece], interval: [f64; 2], step: f64, tolerance: f64) -> Cell {
    let Some(index) = piece_of(pieces, interval, step) else { return Cell::Nothing };
    let piece = &pieces[index];
    let low = interval[0].max(piece.lower);
    let high = interval[1].min(piece.upper);
    match polynomials(law, piece, [low, high], tolerance) {
        Some(polynomials) => Cell::Smooth(Box::new(Polynomials { piece: index, ..polynomials })),
        None => Cell::Direct { regime: piece.regime },
    }
}

/// The polynomials on an interval of a piece, or that none of degree ≤ [`DEGREE`] meets the tolerance.
fn polynomials(law: &dyn Law, piece: &Piece, [low, high]: [f64; 2], tolerance: f64) -> Option<Polynomials> {
    let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
    let mut nodes = [0.0; BLOCK];
    for (i, node) in nodes[..NODES].iter_mut().enumerate() {
        *node = (middle - half * libm::cos(chebyshev::angle(i, NODES))).clamp(low, high);
    }
    let (mut responses, mut stats) = (Responses::default(), SolverStats::default());
    law.evaluate(piece.regime, Lanes::Own, &nodes[..NODES], &mut responses, &mut stats);
    let samples = [&responses.adhesion, &responses.contact, &responses.area].map(|values| &values[..NODES]);
    let largest = samples.map(|values| values.iter().fold(0.0, |most: f64, value| most.max(value.abs())));
    // Forces are judged by the larger of both: their difference is what counts.
    let scale = [largest[0].max(largest[1]), largest[0].max(largest[1]), largest[2]];
    let mut result = Polynomials {
        regime: piece.regime,
        piece: 0,
        terms: 1,
        touches: largest[1] + largest[2] > 0.0,
        coefficients: [[0.0; TERMS]; 3],
    };
    for (q, values) in samples.into_iter().enumerate() {
        let mut chebyshev = chebyshev::coefficients(values);
        // The nodes rise, so they are the nodes of −v: odd coefficients change their sign.
        chebyshev.iter_mut().skip(1).step_by(2).for_each(|coefficient| *coefficient = -*coefficient);
        let allowed = TAIL * tolerance * scale[q];
        let mut tail = 0.0;
        let mut terms = NODES;
        while terms > 1 && tail + chebyshev[terms - 1].abs() <= allowed {
            tail += chebyshev[terms - 1].abs();
            terms -= 1;
        }
        if terms > DEGREE + 1 || tail.is_nan() || chebyshev[0].is_nan() {
            return None;
        }
        result.terms = result.terms.max(terms);
        result.coefficients[q] = chebyshev::powers(&chebyshev[..terms]);
    }
    Some(result)
}
