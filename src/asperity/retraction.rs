//! The law of the asperities of a loop at one distance from the closest approach.

use super::law::{BLOCK, Boundary, End, Flattened, Law, Method, Piece, Regime, Responses, Smoothness};
use super::stats::SolverStats;
use super::unloading::{Loop, begin_of};
use crate::math::roots::{Sample, safe_newton};

/// The powers of r are no power series in any root of it; in the tenth what is left is too smooth to matter.
const ORDER: i32 = 10;
/// Parts of a regime of lowered tops of which each is looked at for a place where their attraction is not
/// smooth.
const KINK_PARTS: usize = 64;

impl Loop {
    /// The ω_max, m, of the asperities whose contact has ended and that are `further` ≥ 0, m, beyond, at a
    /// distance, m; of radii of their own; ω_c where all that have flowed are.
    fn let_go_from(&self, flattened: &dyn Flattened, distance: f64, further: f64) -> f64 {
        let wanted = distance - further;
        let beyond = |largest: f64| {
            let release = flattened.release(self.radius_ratio(largest));
            Sample { value: wanted - (self.recovery(largest) - release), slope: -self.plastic.slope(largest) }
        };
        let low = self.top().next_up();
        let high = self.plastic.recovered_from(wanted).max(low) * (1.0 + 1e-12);
        if beyond(low).value <= 0.0 {
            return self.top();
        }
        let close = |_: f64, sample: Sample| sample.value.abs() <= 2.0 * f64::EPSILON * wanted;
        safe_newton(beyond, low, high, high, close).x
    }

    /// The law at the distance `distance` ≥ 0, m, from the closest approach, in the variable ω_max.
    #[doc(hidden)]
    pub fn at(&self, distance: f64) -> Retraction<'_> {
        Retraction::with(self, distance, |flattened, further| self.let_go_from(flattened, distance, further))
    }

    /// The law at a distance, m, for a few asperities alone: the interference ω_max and the detachment, m,
    /// rising, of those that have flowed say which of them are in contact.
    #[doc(hidden)]
    pub fn at_for(&self, distance: f64, flowed: &[(f64, f64)]) -> Retraction<'_> {
        Retraction::with(self, distance, |_, further| {
            let lost = flowed.iter().take_while(|(_, detachment)| distance - further >= *detachment).count();
            flowed.get(lost).map_or(f64::INFINITY, |(largest, _)| *largest)
        })
    }
}

/// The fate of an asperity, and the regime of the law that it is in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Condition {
    /// It has never touched.
    Untouched(usize),
    /// It is elastic and has touched.
    Elastic(usize),
    /// It has flowed and is out of contact.
    Lowered(usize),
    /// It has flowed and is in contact; the regime is that of ω_max.
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

/// The law of a [`Loop`] at one distance from the closest approach. Its interference is ω_max. Its regimes
/// are those of the law, some more than once: [`Retraction::base`].
pub struct Retraction<'a> {
    cycle: &'a Loop,
    distance: f64,
    conditions: Vec<Condition>,
    regimes: Vec<Regime>,
    base: Vec<usize>,
    boundaries: Vec<Boundary>,
}

impl<'a> Retraction<'a> {
    /// The law at a distance, m. `let_go` says up to which ω_max, m, tops of radii of their own have ended
    /// their contact and are so far beyond, m.
    fn with(cycle: &'a Loop, distance: f64, let_go: impl Fn(&dyn Flattened, f64) -> f64) -> Self {
        let mut law = Self {
            cycle,
            distance,
            conditions: Vec::with_capacity(12),
            regimes: Vec::with_capacity(12),
            base: Vec::with_capacity(12),
            boundaries: Vec::with_capacity(12),
        };
        let Loop { approach, retraction, capture, first_contact, first_plastic, .. } = cycle;
        let shifted =
            |boundary: Boundary| Boundary { interference: boundary.interference + distance, ..boundary };
        let captured = Boundary { interference: *capture, belongs_below: false };
        for regime in 0..*first_contact {
            law.push(
                Condition::Untouched(regime),
                Some(lower(shifted(approach.boundaries()[regime]), captured)),
            );
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
        let Some(top) = top.filter(|_| flows) else { return law };
        let mut end = top;
        for regime in 0..*first_contact {
            let Boundary { interference, belongs_below } = shifted(retraction.boundaries()[regime]);
            let interference = match &cycle.flattened {
                None => cycle.plastic.recovered_from(interference),
                Some(flattened) => {
                    let further = cycle.release() - retraction.boundaries()[regime].interference;
                    let_go(flattened.as_ref(), further)
                }
            };
            end = higher(Boundary { interference, belongs_below }, top);
            law.push(Condition::Lowered(regime), Some(end));
        }
        for regime in *first_plastic..approach.regimes().len() {
            law.push(
                Condition::Unloading(regime),
                approach.boundaries().get(regime).map(|upper| higher(*upper, end)),
            );
        }
        law
    }

    fn push(&mut self, condition: Condition, end: Option<Boundary>) {
        self.conditions.push(condition);
        self.base.push(condition.regime());
        self.regimes.push(self.cycle.approach.regimes()[condition.regime()]);
        self.boundaries.extend(end);
    }

    /// For each of its regimes, which one it is of the law on approach.
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
        let pieces =
            self.law(condition).pieces().into_iter().filter(move |piece| piece.regime == condition.regime());
        let moved = pieces.map(move |piece| Piece {
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

    /// Pieces of a contact that is unloaded: without load, and under it.
    fn unloading(&self, index: usize, limits: (f64, f64)) -> Vec<Piece> {
        let unloaded = self.cycle.plastic.recovered_from(self.distance);
        let bare = self.moved(index, (limits.0, limits.1.min(unloaded)), |place| place);
        let loaded = self.moved(index, (limits.0.max(unloaded), limits.1), |place| place);
        let smoothness = Smoothness::Root { end: End::Lower, place: unloaded, order: ORDER };
        bare.chain(loaded.map(|piece| Piece { smoothness, ..piece })).collect()
    }

    /// Pieces of lowered tops of radii of their own: between jumps of the radius, and on both sides of a jump
    /// of the attraction.
    fn flattened(&self, index: usize, flattened: &dyn Flattened, (lower, upper): (f64, f64)) -> Vec<Piece> {
        let mut ends: Vec<f64> =
            self.cycle.approach.boundaries().iter().map(|end| end.interference).collect();
        ends.retain(|end| lower < *end && *end < upper);
        ends.push(upper);
        let mut pieces = Vec::new();
        let mut lower = lower;
        for end in ends {
            let kink =
                (self.conditions[index].regime() == 0).then(|| self.kink(flattened, (lower, end))).flatten();
            if let Some(place) = kink {
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

    /// The ω_max, m, within limits at which the attraction of lowered tops of radii of their own jumps.
    fn kink(&self, flattened: &dyn Flattened, (lower, upper): (f64, f64)) -> Option<f64> {
        let cycle = self.cycle;
        if !(upper - lower > 4.0 * KINK_PARTS as f64 * f64::EPSILON * upper) {
            return None;
        }
        let beyond = |largest: f64| {
            let kink = flattened.kink(cycle.radius_ratio(largest))?;
            Some(kink - (cycle.recovery(largest) - self.distance))
        };
        let place = |part: usize| lower + (upper - lower) * part as f64 / KINK_PARTS as f64;
        let inside = |part: usize| place(part).clamp(lower.next_up(), upper.next_down());
        let (mut low, mut high) =
            (0..KINK_PARTS).map(|part| (inside(part), inside(part + 1))).find(|&(low, high)| {
                beyond(low).is_some_and(|b| b > 0.0) && beyond(high).is_some_and(|b| b <= 0.0)
            })?;
        while 0.5 * (low + high) > low && 0.5 * (low + high) < high {
            let middle = 0.5 * (low + high);
            *(if beyond(middle)? > 0.0 { &mut low } else { &mut high }) = middle;
        }
        Some(high)
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

    fn pieces(&self) -> Vec<Piece> {
        let mut pieces = Vec::new();
        let mut lower = f64::NEG_INFINITY;
        for (index, condition) in self.conditions.iter().enumerate() {
            let upper = self.boundaries.get(index).map_or(f64::INFINITY, |end| end.interference);
            let limits = (lower, upper);
            match condition {
                Condition::Untouched(_) | Condition::Elastic(_) => {
                    pieces.extend(self.moved(index, limits, |place| place + self.distance));
                }
                Condition::Lowered(_) if let Some(flattened) = &self.cycle.flattened => {
                    pieces.extend(self.flattened(index, flattened.as_ref(), limits));
                }
                Condition::Lowered(_) => {
                    pieces.extend(self.moved(index, limits, |place| {
                        self.cycle.plastic.recovered_from(place + self.distance)
                    }));
                }
                Condition::Unloading(_) => pieces.extend(self.unloading(index, limits)),
            }
            lower = upper;
        }
        pieces
    }

    fn method(&self, regime: usize) -> Method {
        let condition = self.conditions[regime];
        let varies = match condition {
            Condition::Unloading(_) => true,
            Condition::Lowered(_) => self.cycle.flattened.is_some(),
            Condition::Untouched(_) | Condition::Elastic(_) => false,
        };
        match self.law(condition).method(condition.regime()) {
            Method::Constant(_) if varies => Method::ClosedForm,
            method => method,
        }
    }

    fn evaluate(&self, regime: usize, interference: &[f64], out: &mut Responses, stats: &mut SolverStats) {
        let condition = self.conditions[regime];
        let (law, base) = (self.law(condition), condition.regime());
        if let Condition::Unloading(_) = condition {
            law.evaluate(base, interference, out, stats);
            self.cycle.plastic.unload(interference, |_| self.distance, out);
            return;
        }
        let mut own = [0.0; BLOCK];
        let own = &mut own[..interference.len()];
        if let Condition::Lowered(_) = condition {
            self.cycle.plastic.recoveries(interference, own);
        } else {
            own.copy_from_slice(interference);
        }
        own.iter_mut().for_each(|delta| *delta -= self.distance);
        let flattened = self.cycle.flattened.as_ref().filter(|_| matches!(condition, Condition::Lowered(_)));
        let Some(flattened) = flattened else {
            // Rounding must not lead out of the regime.
            let upper = law.boundaries().get(base).map_or(f64::INFINITY, |end| end.interference);
            let lower = begin_of(law, base).min(upper);
            own.iter_mut().for_each(|delta| *delta = delta.clamp(lower, upper));
            return law.evaluate(base, own, out, stats);
        };
        let mut ratios = [0.0; BLOCK];
        let ratios = &mut ratios[..interference.len()];
        self.cycle.radius_ratios(interference, ratios, out, stats);
        match law.method(base) {
            Method::Constant(adhesion) => {
                law.evaluate(base, own, out, stats);
                out.adhesion.iter_mut().zip(ratios).for_each(|(out, ratio)| *out = adhesion * *ratio);
            }
            _ => flattened.attraction(ratios, own, out, stats),
        }
    }
}
