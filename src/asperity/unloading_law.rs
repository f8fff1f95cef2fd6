//! The law of unloading: the forces of asperities of one radius at one distance from the closest approach, by their ω_max.

use super::block::{BLOCK, Responses};
use super::condition::{AtDistance, Condition};
use super::cycle::Loop;
use super::lane::{Lane, Lanes};
use super::law::{Boundary, End, Law, Method, Piece, Regime, Smoothness};
use super::response_table::ResponseTable;
use super::stats::SolverStats;
use super::summit::{FlattenedSummits, SUMMIT_KINKS};
use crate::math::roots::false_position;
use std::ops::Range;
use std::sync::{Arc, PoisonError};

/// Relative distance from a jump at which one side of it is evaluated.
const BESIDE: f64 = 1e-12;
/// Relative accuracy of tables of the responses of summits, some roundings of these, and largest number of halvings of a piece.
const TOLERANCE: f64 = 1e-13;
const HALVINGS: u32 = 9;

impl Loop {
    /// The largest ω_max, m, of asperities that have detached at a distance, m: their summits are in a regime before contact, or
    /// below it. It is searched for within the limits of one plastic regime on loading, and is the lower limit if all asperities
    /// are deeper, the upper limit if none is.
    fn detached_to(&self, distance: f64, regime: usize, (begin, end): (f64, f64)) -> f64 {
        // The plastic contact may jump at the beginning.
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

    /// The law at a distance ≥ 0, m, from the closest approach, in the variable ω_max.
    #[doc(hidden)]
    pub fn at(&self, distance: f64) -> UnloadingLaw<'_> {
        UnloadingLaw::with(self, distance, |regime, limits| self.detached_to(distance, regime, limits))
    }

    /// The law of [`Loop::at`] with tables of the responses of summits. It is kept, because all surfaces of a run share some
    /// distances.
    #[doc(hidden)]
    pub fn tabulated_at(&self, distance: f64) -> UnloadingLaw<'_> {
        let lock = || self.at_distances.lock().unwrap_or_else(PoisonError::into_inner);
        let known = lock().get(&distance.to_bits()).cloned();
        // Computed without the lock, so that other threads need not wait.
        let at = known.unwrap_or_else(|| {
            let at = self.at(distance).tabulated().at;
            Arc::clone(lock().entry(distance.to_bits()).or_insert(at))
        });
        UnloadingLaw { cycle: self, at }
    }

    /// Distances, m, at which two boundaries of the law at a distance coincide. Every radius has the same number of them in the same
    /// order, NaN for two boundaries that never coincide. The expected force at one distance thus has a kink at the radius whose
    /// boundaries coincide there.
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
            if self.yields() {
                let above = self.summit_of(largest + BESIDE * largest.abs());
                let passes = above.passes();
                meetings.push(passes[self.end_kink(self.first_contact - 1)] + further[self.first_contact]);
                meetings.push(above.recovery);
                meetings.extend(passes);
            }
        }
        // The distances at which summits pass their kinks jump at a joint.
        for joint in boundaries.iter().skip(1).filter(|_| self.yields()) {
            meetings.extend(self.summit_of(joint.interference).passes());
        }
        meetings
    }

    /// The law at a distance, m, without the asperities that have yielded.
    #[doc(hidden)]
    pub fn elastic_at(&self, distance: f64) -> UnloadingLaw<'_> {
        UnloadingLaw::with(self, distance, |_, (_, end)| end)
    }
}

/// The law of unloading of a [`Loop`] at one distance from the closest approach. Its variable is ω_max in the place of the
/// interference. It has the regimes of the law, some more than once: [`UnloadingLaw::base`].
pub struct UnloadingLaw<'a> {
    cycle: &'a Loop,
    at: Arc<AtDistance>,
}

impl<'a> UnloadingLaw<'a> {
    /// The law at a distance, m. `detached` gives the largest ω_max, m, between limits, of flattened summits that are in a regime
    /// before contact or below it.
    fn with(cycle: &'a Loop, distance: f64, detached: impl Fn(usize, (f64, f64)) -> f64) -> Self {
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
        let yields = cycle.yields();
        // A law of loading alone has no force beyond its end on approach, but again when it has unloaded to below that.
        let onset =
            approach.boundaries().get(first_plastic - 1).map(|end| if yields { *end } else { shifted(*end) });
        for regime in 0..*first_plastic {
            let end = retraction.boundaries().get(regime).filter(|_| regime + 1 < *first_plastic);
            let end = end.map(|end| higher(shifted(*end), captured));
            let end = match (end, onset) {
                (Some(end), Some(onset)) => Some(lower(end, onset)),
                (end, onset) => end.or(onset),
            };
            law.push(Condition::Elastic(regime), regimes, end);
        }
        if let Some(onset) = onset.filter(|_| yields) {
            push_yielded(&mut law, cycle, onset, detached);
        }
        Self { cycle, at: Arc::new(law) }
    }

    /// The law with tables of the responses of summits.
    fn tabulated(mut self) -> Self {
        let deepest = self.cycle.deepest();
        let table = |index: usize| {
            let is_of_summits =
                matches!(self.at.conditions[index], Condition::Detached(_) | Condition::Unloading(_));
            let pieces = if is_of_summits { self.pieces_of(index, None) } else { Vec::new() };
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
            Condition::Elastic(_) | Condition::Detached(_) => self.cycle.retraction.as_ref(),
        }
    }

    /// The pieces of a condition within limits; `place` gives the ω_max, m, of an interference, m, of its law.
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

    /// The pieces of contacts on unloading, which end like a root.
    fn unloading(&self, index: usize, limits: (f64, f64)) -> Vec<Piece> {
        let first = match self.order() {
            1 => Smoothness::Smooth,
            order => Smoothness::Root { end: End::Lower, place: limits.0, order },
        };
        let mut pieces = self.of_summits(index, limits);
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

    /// The pieces of flattened summits, divided at the joints of the law on approach, and where summits pass their kinks.
    fn of_summits(&self, index: usize, (lower, upper): (f64, f64)) -> Vec<Piece> {
        let mut ends: Vec<f64> = self.cycle.approach.pieces(None).iter().map(|piece| piece.upper).collect();
        ends.retain(|end| lower < *end && *end < upper);
        ends.push(upper);
        let mut pieces = Vec::new();
        let mut lower = lower;
        for end in ends {
            for place in self.passed((lower, end)) {
                // Most kinks are folds.
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

    /// The ω_max, m, rising, of the summits within limits that pass one of their kinks at this distance.
    fn passed(&self, (lower, upper): (f64, f64)) -> Vec<f64> {
        let cycle = self.cycle;
        let beyond = |largest: f64, kink: usize| self.at.distance - cycle.summit_of(largest).passes()[kink];
        let mut passed = Vec::new();
        for stretch in cycle.stretches() {
            for (i, ends) in stretch.places.windows(2).enumerate() {
                if ends[1] <= lower || ends[0] >= upper {
                    continue;
                }
                // The last two are ends of regimes.
                for kink in 0..SUMMIT_KINKS - 2 {
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

/// Adds the conditions of asperities that have yielded, from the onset of plastic deformation on. Where loading jumps from one
/// regime to the next, summits above the jump may detach at smaller distances than summits below it.
fn push_yielded(
    law: &mut AtDistance,
    cycle: &Loop,
    onset: Boundary,
    detached: impl Fn(usize, (f64, f64)) -> f64,
) {
    let (boundaries, regimes) = (cycle.approach.boundaries(), cycle.approach.regimes());
    let mut begin = onset;
    for regime in cycle.first_plastic..regimes.len() {
        let upper = boundaries.get(regime).map(|upper| higher(*upper, begin));
        let limits = (begin.interference, upper.map_or(f64::INFINITY, |upper| upper.interference));
        let mut end = begin;
        for before in 0..cycle.first_contact {
            let Boundary { belongs_below, .. } = cycle.retraction.boundaries()[before];
            end = higher(Boundary { interference: detached(before, limits), belongs_below }, begin);
            end = upper.map_or(end, |upper| lower(end, upper));
            law.push(Condition::Detached(before), regimes, Some(end));
        }
        let last = boundaries.get(regime).map(|last| higher(*last, end));
        law.push(Condition::Unloading(regime), regimes, last);
        begin = upper.unwrap_or(end);
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

impl Law for UnloadingLaw<'_> {
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
            Condition::Detached(_) => self.of_summits(index, limits),
            Condition::Unloading(_) => self.unloading(index, limits),
        }
    }

    fn method(&self, regime: usize) -> Method {
        let condition = self.at.conditions[regime];
        let varies = matches!(condition, Condition::Unloading(_) | Condition::Detached(_));
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
        let of_summits = match condition {
            Condition::Unloading(_) => Some(self.cycle.first_contact),
            Condition::Detached(base) => Some(base),
            Condition::Untouched(_) | Condition::Elastic(_) => None,
        };
        if let Some(regime) = of_summits {
            let mut solve = |largest: &[f64], out: &mut Responses| {
                let mut summits = FlattenedSummits::default();
                summits.reserve(largest.len());
                self.cycle.summits(largest, stats, |summit| summits.push(summit));
                summits.respond_all((self.cycle.retraction(), regime), self.at.distance, out, stats);
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
