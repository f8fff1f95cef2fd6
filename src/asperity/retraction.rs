//! The law of the asperities of a loop at one distance from the closest approach.

use super::block::{BLOCK, Responses};
use super::lane::{Lane, Lanes};
use super::law::{Boundary, End, Law, Method, Piece, Regime, Smoothness};
use super::stats::SolverStats;
use super::top::{Top, Tops};
use super::unloading::{Loop, TOP_KINKS, begin_of};
use crate::math::roots::{Sample, safe_newton};

/// Parts of a regime of lowered tops of which each is looked at for a place where their attraction is not
/// smooth.
const KINK_PARTS: usize = 64;
/// The step of a slope by differences, relative to its place.
const STEP: f64 = 1e-6;

impl Loop {
    /// The ω_max, m, between limits on one regime of flow, above which asperities are still in contact, or deeper than a regime
    /// before it, at a distance, m: the lower limit where all are, the upper where none is.
    fn let_go_from(&self, distance: f64, regime: usize, (begin, end): (f64, f64)) -> f64 {
        let low = begin.next_up();
        let beyond = |largest: f64| distance - self.left_at(regime, largest);
        if !(low < end && beyond(low) > 0.0) {
            return begin;
        }
        if end.is_finite() && beyond(end) > 0.0 {
            return end;
        }
        let slope = |largest: f64| {
            let step = STEP * largest.abs().max(self.critical().abs());
            (self.recovery(largest + step) - self.recovery(largest)) / step
        };
        let mut reach = low.abs();
        while low + reach < end && beyond(low + reach) > 0.0 {
            reach = 2.0 * reach + low.abs();
        }
        let high = end.min(low + reach);
        let sample = |largest: f64| Sample { value: beyond(largest), slope: -slope(largest) };
        let close = |_: f64, sample: Sample| sample.value.abs() <= 2.0 * f64::EPSILON * distance;
        safe_newton(sample, low, high, high, close).x
    }

    /// The law at the distance `distance` ≥ 0, m, from the closest approach, in the variable ω_max.
    #[doc(hidden)]
    pub fn at(&self, distance: f64) -> Retraction<'_> {
        Retraction::with(self, distance, |regime, limits| self.let_go_from(distance, regime, limits))
    }

    /// Distances, m, at which two ends of the law at a distance meet, as many of every radius and in the same order; NaN where
    /// they do not. At another radius they meet elsewhere, so what is expected at one distance is not smooth in the radius
    /// where they do there.
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
                let above = largest.next_up();
                let detachment = self.detachment(above).unwrap_or(f64::NAN);
                meetings.extend((0..self.first_contact).map(|regime| self.left_at(regime, above)));
                meetings.push(detachment + further[self.first_contact]);
                meetings.push(self.recovery(above));
            }
        }
        // Tops let go at other distances below a joint than above it.
        for joint in boundaries.iter().skip(1).filter(|_| self.flows()) {
            meetings.extend((0..self.first_contact).map(|regime| self.left_at(regime, joint.interference)));
        }
        meetings
    }

    /// The law at a distance, m, for a few asperities alone: the interference ω_max, rising, of those that have flowed, and
    /// the distances, m, at which their film or bridge breaks and contact is lost, say what they are in.
    #[doc(hidden)]
    pub fn at_for(&self, distance: f64, flowed: &[(f64, [f64; 2])]) -> Retraction<'_> {
        Retraction::with(self, distance, |regime, (begin, end)| {
            let ends = usize::from(regime + 1 == self.first_contact);
            let mut within = flowed.iter().filter(|(largest, _)| *largest > begin && *largest <= end);
            let held = within.find(|(_, passed)| distance < passed[ends]);
            held.map_or(end, |(largest, _)| *largest)
        })
    }
}

/// The contact history of an asperity, and the regime of the law that it is in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Condition {
    /// An asperity that has never touched.
    Untouched(usize),
    /// An elastic asperity that has touched.
    Elastic(usize),
    /// An asperity that has flowed and is out of contact.
    Lowered(usize),
    /// An asperity that has flowed and is in contact; the regime is that of ω_max.
    Unloading(usize),
}

impl Condition {
    pub fn regime(self) -> usize {
        let (Self::Untouched(regime)
        | Self::Elastic(regime)
        | Self::Lowered(regime)
        | Self::Unloading(regime)) = self;
        regime
    }
}

/// The law of a [`Loop`] at one distance from the closest approach. Its interference is ω_max. It has the
/// regimes of the law, some more than once: [`Retraction::base`].
pub struct Retraction<'a> {
    cycle: &'a Loop,
    distance: f64,
    conditions: Vec<Condition>,
    regimes: Vec<Regime>,
    base: Vec<usize>,
    boundaries: Vec<Boundary>,
}

impl<'a> Retraction<'a> {
    /// The law at a distance, m. `let_go` says up to which ω_max, m, between limits, tops of radii of their own are in a regime
    /// before contact or below it.
    fn with(cycle: &'a Loop, distance: f64, let_go: impl Fn(usize, (f64, f64)) -> f64) -> Self {
        let mut law = Self {
            cycle,
            distance,
            conditions: Vec::with_capacity(16),
            regimes: Vec::with_capacity(16),
            base: Vec::with_capacity(16),
            boundaries: Vec::with_capacity(16),
        };
        let Loop { approach, retraction, capture, first_contact, first_plastic, .. } = cycle;
        let shifted =
            |boundary: Boundary| Boundary { interference: boundary.interference + distance, ..boundary };
        let captured = Boundary { interference: *capture, belongs_below: false };
        for regime in 0..*first_contact {
            let end = lower(shifted(approach.boundaries()[regime]), captured);
            law.push(Condition::Untouched(regime), Some(end));
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
            law.push(Condition::Elastic(regime), end);
        }
        if let Some(top) = top.filter(|_| flows) {
            law.push_flowed(top, let_go);
        }
        law
    }

    /// Adds the conditions of asperities that have flowed, from the boundary where they begin to. Where loading jumps from one
    /// regime to the next, tops can let go sooner above the jump than below it.
    fn push_flowed(&mut self, onset: Boundary, let_go: impl Fn(usize, (f64, f64)) -> f64) {
        let Self { cycle, .. } = *self;
        let boundaries = cycle.approach.boundaries();
        let mut begin = onset;
        for regime in cycle.first_plastic..cycle.approach.regimes().len() {
            let top = boundaries.get(regime).map(|top| higher(*top, begin));
            let limits = (begin.interference, top.map_or(f64::INFINITY, |top| top.interference));
            let mut end = begin;
            for before in 0..cycle.first_contact {
                let Boundary { belongs_below, .. } = cycle.retraction.boundaries()[before];
                end = higher(Boundary { interference: let_go(before, limits), belongs_below }, begin);
                end = top.map_or(end, |top| lower(end, top));
                self.push(Condition::Lowered(before), Some(end));
            }
            self.push(Condition::Unloading(regime), boundaries.get(regime).map(|upper| higher(*upper, end)));
            begin = top.unwrap_or(end);
        }
    }

    fn push(&mut self, condition: Condition, end: Option<Boundary>) {
        self.conditions.push(condition);
        self.base.push(condition.regime());
        self.regimes.push(self.cycle.approach.regimes()[condition.regime()]);
        self.boundaries.extend(end);
    }

    /// Index of each of its regimes in the law on approach.
    pub fn base(&self) -> &[usize] {
        &self.base
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
        let condition = self.conditions[index];
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
            for (place, jumps) in self.passed((lower, end)) {
                let smoothness = if jumps {
                    Smoothness::Root { end: End::Upper, place, order: 2 }
                } else {
                    Smoothness::Smooth
                };
                pieces.push(Piece { regime: index, lower, upper: place, smoothness });
                lower = place;
            }
            pieces.push(Piece { regime: index, lower, upper: end, smoothness: Smoothness::Smooth });
            lower = end;
        }
        pieces.retain(|piece| piece.lower < piece.upper);
        pieces
    }

    /// The ω_max, m, rising, within limits at which tops pass kinks of theirs, and whether they jump there.
    fn passed(&self, (lower, upper): (f64, f64)) -> Vec<(f64, bool)> {
        let cycle = self.cycle;
        if !(upper - lower > 4.0 * KINK_PARTS as f64 * f64::EPSILON * upper.abs()) {
            return Vec::new();
        }
        let beyond = |top: &Top| cycle.kinks_of(top).map(|kink| kink - (top.recovery - self.distance));
        let place = |part: usize| lower + (upper - lower) * part as f64 / KINK_PARTS as f64;
        let places: [f64; KINK_PARTS + 1] =
            std::array::from_fn(|part| place(part).clamp(lower.next_up(), upper.next_down()));
        let mut beyond_at = Vec::with_capacity(KINK_PARTS + 1);
        cycle.tops(&places, &mut SolverStats::default(), |top| beyond_at.push(beyond(&top)));
        let mut passed = Vec::new();
        for kink in 0..TOP_KINKS - 2 {
            for (ends, own) in places.windows(2).zip(beyond_at.windows(2)) {
                // Kinks that not all have are in no fixed order.
                let [at_low, at_high] = [own[0][kink], own[1][kink]];
                if !((at_low > 0.0) != (at_high > 0.0) && at_low.is_finite() && at_high.is_finite()) {
                    continue;
                }
                let [mut low, mut high] = [ends[0], ends[1]];
                while 0.5 * (low + high) > low && 0.5 * (low + high) < high {
                    let middle = 0.5 * (low + high);
                    let here = beyond(&cycle.top_of(middle))[kink];
                    *(if (here > 0.0) == (at_low > 0.0) { &mut low } else { &mut high }) = middle;
                }
                passed.push((high, true));
            }
        }
        passed.sort_by(|a, b| a.0.total_cmp(&b.0));
        passed
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
        &self.regimes
    }

    fn boundaries(&self) -> &[Boundary] {
        &self.boundaries
    }

    fn pieces_of(&self, index: usize, _: Option<&Lane>) -> Vec<Piece> {
        let upper = self.boundaries.get(index).map_or(f64::INFINITY, |end| end.interference);
        let limits = (begin_of(self, index), upper);
        match self.conditions[index] {
            Condition::Untouched(_) | Condition::Elastic(_) => {
                self.moved(index, limits, |place| place + self.distance).collect()
            }
            Condition::Lowered(_) => self.of_tops(index, limits),
            Condition::Unloading(_) => self.unloading(index, limits),
        }
    }

    fn method(&self, regime: usize) -> Method {
        let condition = self.conditions[regime];
        let varies = matches!(condition, Condition::Unloading(_) | Condition::Lowered(_));
        match self.law(condition).method(condition.regime()) {
            Method::Constant(_) if varies => Method::ClosedForm,
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
        let condition = self.conditions[regime];
        let (law, base) = (self.law(condition), condition.regime());
        let of_tops = match condition {
            Condition::Unloading(_) => Some(self.cycle.first_contact),
            Condition::Lowered(base) => Some(base),
            Condition::Untouched(_) | Condition::Elastic(_) => None,
        };
        if let Some(regime) = of_tops {
            let mut tops = Tops::default();
            self.cycle.tops(interference, stats, |top| tops.push(top));
            return tops.respond_all((self.cycle.retraction(), regime), self.distance, out, stats);
        }
        let mut own = [0.0; BLOCK];
        let own = &mut own[..interference.len()];
        own.copy_from_slice(interference);
        own.iter_mut().for_each(|delta| *delta -= self.distance);
        // Rounding must not lead out of the regime.
        let upper = law.boundaries().get(base).map_or(f64::INFINITY, |end| end.interference);
        let lower = begin_of(law, base).min(upper);
        own.iter_mut().for_each(|delta| *delta = delta.clamp(lower, upper));
        law.evaluate(base, lanes, own, out, stats);
    }
}
