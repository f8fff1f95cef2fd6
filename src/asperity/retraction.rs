//! The law of the asperities of a loop at one distance from the closest approach.

use super::block::{BLOCK, Responses};
use super::condition::{AtDistance, Condition};
use super::lane::{Lane, Lanes};
use super::law::{Boundary, End, Law, Method, Piece, Regime, Smoothness};
use super::response_table::ResponseTable;
use super::stats::SolverStats;
use super::top::{TOP_KINKS, Tops};
use super::unloading::Loop;
use crate::math::roots::false_position;
use std::ops::Range;
use std::sync::{Arc, PoisonError};

/// Share of a place by which the side of a jump is away from it.
const BESIDE: f64 = 1e-12;
/// Relative accuracy of tables of the responses of tops, some roundings of these, and halvings of a piece at most.
const TOLERANCE: f64 = 1e-13;
const HALVINGS: u32 = 9;

impl Loop {
    /// The ω_max, m, between limits on one regime of flow, above which asperities are still in contact, or deeper than a regime
    /// before it, at a distance, m: the lower limit where all are, the upper where none is.
    fn let_go_from(&self, distance: f64, regime: usize, (begin, end): (f64, f64)) -> f64 {
        // Where the plastic contact jumps no state is next to the beginning.
        let low = begin + BESIDE * begin.abs();
        let beyond = |largest: f64| distance - self.left_at(regime, largest);
        if !(low < end) {
            return begin;
        }
        let at_low = beyond(low);
        if !(at_low > 0.0) {
            return begin;
        }
        let at_end = if end.is_finite() { beyond(end) } else { f64::NEG_INFINITY };
        if at_end > 0.0 {
            return end;
        }
        let (mut low, mut high) = ((low, at_low), (end, at_end));
        let kink = self.end_kink(regime);
        let known = self.stretches().iter().flat_map(|stretch| stretch.places.iter().zip(&stretch.kinks));
        for (place, kinks) in known {
            if !(low.0 < *place && *place < high.0) {
                continue;
            }
            let here = (*place, distance - kinks[kink]);
            if here.1 > 0.0 {
                low = here;
            } else {
                high = here;
                break;
            }
        }
        while high.0.is_infinite() {
            let further = 2.0 * low.0 + self.critical().abs();
            let here = (further, beyond(further));
            *(if here.1 > 0.0 { &mut low } else { &mut high }) = here;
        }
        let close = |_: f64, value: f64| value.abs() <= 2.0 * f64::EPSILON * distance;
        false_position(beyond, low, high, close)
    }

    /// The law at the distance `distance` ≥ 0, m, from the closest approach, in the variable ω_max.
    #[doc(hidden)]
    pub fn at(&self, distance: f64) -> Retraction<'_> {
        Retraction::with(self, distance, |regime, limits| self.let_go_from(distance, regime, limits))
    }

    /// The law at a distance, m, as [`Loop::at`] has it, with tables of the responses of tops. It is kept, as all surfaces of a run
    /// are at some distances.
    #[doc(hidden)]
    pub fn tabulated_at(&self, distance: f64) -> Retraction<'_> {
        let lock = || self.at_distances.lock().unwrap_or_else(PoisonError::into_inner);
        let known = lock().get(&distance.to_bits()).cloned();
        // Not while the others wait.
        let at = known.unwrap_or_else(|| {
            let at = self.at(distance).tabulated().at;
            Arc::clone(lock().entry(distance.to_bits()).or_insert(at))
        });
        Retraction { cycle: self, at }
    }

    /// Distances, m, at which two boundaries of the law at a distance coincide. Every radius has the same number of them in the same
    /// order, NaN for two that never coincide. They depend on the radius, so the expected force at one distance has a kink at
    /// the radius whose boundaries coincide there.
    #[doc(hidden)]
    pub fn meetings(&self) -> Vec<f64> {
        let ends = self.retraction.boundaries()[..self.first_contact].iter().map(|end| end.interference);
        let attraction = self.retraction.pieces_of(0, None).first().map_or(f64::NAN, |piece| piece.upper);
        let further: Vec<f64> = ends.chain([attraction]).map(|end| self.release() - end).collect();
        let mut meetings: Vec<f64> =
            further.iter().map(|further| self.capture - self.release() + further).collect();
        let boundaries = &self.approach.boundaries()[self.first_plastic - 1..];
        for largest in boundaries.iter().map(|end| end.interference) {
            meetings.extend(further.iter().map(|further| largest - self.release() + further));
            meetings.push(largest);
            if self.flows() {
                let above = self.top_of(largest + BESIDE * largest.abs());
                let passes = above.passes();
                meetings.push(passes[self.end_kink(self.first_contact - 1)] + further[self.first_contact]);
                meetings.push(above.recovery);
                meetings.extend(passes);
            }
        }
        // Tops pass their kinks at other distances below a joint than above it.
        for joint in boundaries.iter().skip(1).filter(|_| self.flows()) {
            meetings.extend(self.top_of(joint.interference).passes());
        }
        meetings
    }

    /// The law at a distance, m, for asperities that have not flowed alone.
    #[doc(hidden)]
    pub fn elastic_at(&self, distance: f64) -> Retraction<'_> {
        Retraction::with(self, distance, |_, (_, end)| end)
    }
}

/// The law of a [`Loop`] at one distance from the closest approach. Its interference is ω_max. It has the
/// regimes of the law, some more than once: [`Retraction::base`].
pub struct Retraction<'a> {
    cycle: &'a Loop,
    at: Arc<AtDistance>,
}

impl<'a> Retraction<'a> {
    /// The law at a distance, m. `let_go` says up to which ω_max, m, between limits, tops of radii of their own are in a regime
    /// before contact or below it.
    fn with(cycle: &'a Loop, distance: f64, let_go: impl Fn(usize, (f64, f64)) -> f64) -> Self {
        let mut law = AtDistance { distance, ..AtDistance::default() };
        let Loop { approach, retraction, capture, first_contact, first_plastic, .. } = cycle;
        let regimes = approach.regimes();
        let shifted =
            |boundary: Boundary| Boundary { interference: boundary.interference + distance, ..boundary };
        let captured = Boundary { interference: *capture, belongs_below: false };
        for regime in 0..*first_contact {
            let end = lower(shifted(approach.boundaries()[regime]), captured);
            law.push(Condition::Untouched(regime), regimes, Some(end));
        }
        let flows = cycle.flows();
        // Where a law without plastic flow ends, it is not known; on retraction it is known again.
        let top =
            approach.boundaries().get(first_plastic - 1).map(|end| if flows { *end } else { shifted(*end) });
        for regime in 0..*first_plastic {
            let end = retraction.boundaries().get(regime).filter(|_| regime + 1 < *first_plastic);
            let end = end.map(|end| higher(shifted(*end), captured));
            let end = match (end, top) {
                (Some(end), Some(top)) => Some(lower(end, top)),
                (end, top) => end.or(top),
            };
            law.push(Condition::Elastic(regime), regimes, end);
        }
        if let Some(top) = top.filter(|_| flows) {
            push_flowed(&mut law, cycle, top, let_go);
        }
        Self { cycle, at: Arc::new(law) }
    }

    /// The law with tables of the responses of tops.
    fn tabulated(mut self) -> Self {
        let deepest = self.cycle.deepest();
        let table = |index: usize| {
            let is_of_tops =
                matches!(self.at.conditions[index], Condition::Lowered(_) | Condition::Unloading(_));
            let pieces = if is_of_tops { self.pieces_of(index, None) } else { Vec::new() };
            let respond = |largest: &[f64], out: &mut Responses| {
                self.evaluate(index, Lanes::Own, largest, out, &mut SolverStats::default());
            };
            ResponseTable::new(&pieces, deepest, (TOLERANCE, HALVINGS), respond)
        };
        let tables = (0..self.at.conditions.len()).map(table).collect();
        if let Some(at) = Arc::get_mut(&mut self.at) {
            at.tables = tables;
        }
        self
    }

    /// Index of each of its regimes in the law on approach.
    pub fn base(&self) -> &[usize] {
        &self.at.base
    }

    /// The law that acts under a condition.
    fn law(&self, condition: Condition) -> &dyn Law {
        match condition {
            Condition::Untouched(_) | Condition::Unloading(_) => self.cycle.approach.as_ref(),
            Condition::Elastic(_) | Condition::Lowered(_) => self.cycle.retraction.as_ref(),
        }
    }

    /// Pieces of a condition, of which `place` says where an interference of the law is, m, within `limits`.
    fn moved(
        &self,
        index: usize,
        limits: (f64, f64),
        place: impl Fn(f64) -> f64,
    ) -> impl Iterator<Item = Piece> {
        let condition = self.at.conditions[index];
        let pieces = self.law(condition).pieces_of(condition.regime(), None);
        let moved = pieces.into_iter().map(move |piece| Piece {
            regime: index,
            lower: place(piece.lower).max(limits.0),
            upper: place(piece.upper).min(limits.1),
            smoothness: match piece.smoothness {
                Smoothness::Root { place: root, end, order } => {
                    Smoothness::Root { place: place(root), end, order }
                }
                Smoothness::Smooth => Smoothness::Smooth,
            },
        });
        moved.filter(|piece| piece.lower < piece.upper)
    }

    /// Pieces of contacts that are unloaded, which end like a root.
    fn unloading(&self, index: usize, limits: (f64, f64)) -> Vec<Piece> {
        let first = match self.order() {
            1 => Smoothness::Smooth,
            order => Smoothness::Root { end: End::Lower, place: limits.0, order },
        };
        let mut pieces = self.of_tops(index, limits);
        pieces.iter_mut().take(1).for_each(|piece| piece.smoothness = first);
        pieces
    }

    /// Order of the root by which a contact varies at its end.
    fn order(&self) -> i32 {
        let pieces = self.cycle.retraction.pieces_of(self.cycle.first_contact, None);
        match pieces.first().map(|piece| piece.smoothness) {
            Some(Smoothness::Root { end: End::Lower, order, .. }) => order,
            _ => 1,
        }
    }

    /// Pieces of tops of outlines of their own: between the joints of the law on approach, and between places where tops pass
    /// kinks.
    fn of_tops(&self, index: usize, (lower, upper): (f64, f64)) -> Vec<Piece> {
        let mut ends: Vec<f64> = self.cycle.approach.pieces(None).iter().map(|piece| piece.upper).collect();
        ends.retain(|end| lower < *end && *end < upper);
        ends.push(upper);
        let mut pieces = Vec::new();
        let mut lower = lower;
        for end in ends {
            for place in self.passed((lower, end)) {
                // Most kinks are where a fold is.
                let smoothness = Smoothness::Root { end: End::Upper, place, order: 2 };
                pieces.push(Piece { regime: index, lower, upper: place, smoothness });
                lower = place;
            }
            pieces.push(Piece { regime: index, lower, upper: end, smoothness: Smoothness::Smooth });
            lower = end;
        }
        pieces.retain(|piece| piece.lower < piece.upper);
        pieces
    }

    /// The ω_max, m, rising, within limits at which tops pass kinks of theirs.
    fn passed(&self, (lower, upper): (f64, f64)) -> Vec<f64> {
        let cycle = self.cycle;
        let beyond = |largest: f64, kink: usize| self.at.distance - cycle.top_of(largest).passes()[kink];
        let mut passed = Vec::new();
        for stretch in cycle.stretches() {
            for (i, ends) in stretch.places.windows(2).enumerate() {
                if ends[1] <= lower || ends[0] >= upper {
                    continue;
                }
                // The last two are ends of regimes.
                for kink in 0..TOP_KINKS - 2 {
                    let [low, high] = [i, i + 1].map(|i| self.at.distance - stretch.kinks[i][kink]);
                    let is_between = low.is_finite() && high.is_finite() && (low > 0.0) != (high > 0.0);
                    if is_between {
                        let close = |_: f64, value: f64| value.abs() <= 2.0 * f64::EPSILON * self.at.distance;
                        let at = |largest: f64| beyond(largest, kink);
                        passed.push(false_position(at, (ends[0], low), (ends[1], high), close));
                    }
                }
            }
        }
        passed.retain(|place| lower < *place && *place < upper);
        passed.sort_by(f64::total_cmp);
        passed
    }
}

/// Adds the conditions of asperities that have flowed, from the boundary where they begin to. Where loading jumps from one
/// regime to the next, tops can let go sooner above the jump than below it.
fn push_flowed(
    law: &mut AtDistance,
    cycle: &Loop,
    onset: Boundary,
    let_go: impl Fn(usize, (f64, f64)) -> f64,
) {
    let (boundaries, regimes) = (cycle.approach.boundaries(), cycle.approach.regimes());
    let mut begin = onset;
    for regime in cycle.first_plastic..regimes.len() {
        let top = boundaries.get(regime).map(|top| higher(*top, begin));
        let limits = (begin.interference, top.map_or(f64::INFINITY, |top| top.interference));
        let mut end = begin;
        for before in 0..cycle.first_contact {
            let Boundary { belongs_below, .. } = cycle.retraction.boundaries()[before];
            end = higher(Boundary { interference: let_go(before, limits), belongs_below }, begin);
            end = top.map_or(end, |top| lower(end, top));
            law.push(Condition::Lowered(before), regimes, Some(end));
        }
        let upper = boundaries.get(regime).map(|upper| higher(*upper, end));
        law.push(Condition::Unloading(regime), regimes, upper);
        begin = top.unwrap_or(end);
    }
}

/// The lower of two boundaries, the second where they are at the same place.
fn lower(a: Boundary, b: Boundary) -> Boundary {
    if a.interference < b.interference { a } else { b }
}

/// The higher of two boundaries, the second where they are at the same place.
fn higher(a: Boundary, b: Boundary) -> Boundary {
    if a.interference > b.interference { a } else { b }
}

impl Law for Retraction<'_> {
    fn regimes(&self) -> &[Regime] {
        &self.at.regimes
    }

    fn boundaries(&self) -> &[Boundary] {
        &self.at.boundaries
    }

    fn pieces_within(&self, index: usize, _: Option<&Lane>, within: Range<f64>) -> Vec<Piece> {
        let upper = self.at.boundaries.get(index).map_or(f64::INFINITY, |end| end.interference);
        let limits = (self.begin(index).max(within.start), upper.min(within.end));
        match self.at.conditions[index] {
            Condition::Untouched(_) | Condition::Elastic(_) => {
                self.moved(index, limits, |place| place + self.at.distance).collect()
            }
            Condition::Lowered(_) => self.of_tops(index, limits),
            Condition::Unloading(_) => self.unloading(index, limits),
        }
    }

    fn method(&self, regime: usize) -> Method {
        let condition = self.at.conditions[regime];
        let varies = matches!(condition, Condition::Unloading(_) | Condition::Lowered(_));
        match self.law(condition).method(condition.regime()) {
            Method::Constant(_) if varies => Method::ClosedForm,
            method => method,
        }
    }

    fn evaluate(
        &self,
        index: usize,
        lanes: Lanes<'_>,
        interference: &[f64],
        out: &mut Responses,
        stats: &mut SolverStats,
    ) {
        let condition = self.at.conditions[index];
        let (law, base) = (self.law(condition), condition.regime());
        let of_tops = match condition {
            Condition::Unloading(_) => Some(self.cycle.first_contact),
            Condition::Lowered(base) => Some(base),
            Condition::Untouched(_) | Condition::Elastic(_) => None,
        };
        if let Some(regime) = of_tops {
            let mut solve = |largest: &[f64], out: &mut Responses| {
                let mut tops = Tops::default();
                tops.reserve(largest.len());
                self.cycle.tops(largest, stats, |top| tops.push(top));
                tops.respond_all((self.cycle.retraction(), regime), self.at.distance, out, stats);
            };
            return match self.at.tables.get(index) {
                Some(table) => table.respond(interference, out, solve),
                None => solve(interference, out),
            };
        }
        let mut own = [0.0; BLOCK];
        let own = &mut own[..interference.len()];
        own.copy_from_slice(interference);
        own.iter_mut().for_each(|delta| *delta -= self.at.distance);
        // Rounding must not lead out of the regime.
        let upper = law.boundaries().get(base).map_or(f64::INFINITY, |end| end.interference);
        let lower = law.begin(base).min(upper);
        own.iter_mut().for_each(|delta| *delta = delta.clamp(lower, upper));
        law.evaluate(base, lanes, own, out, stats);
    }
}
