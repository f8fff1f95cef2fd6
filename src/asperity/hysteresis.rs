//! The force of one asperity with hysteresis, whose interference may rise and fall in any order.
//!
//! # Formula
//! The force is a chain of segments in the interference δ, each one smooth function, with the segment that
//! follows beyond either end:
//!
//! | state | segments | left as δ rises | left as δ falls |
//! |---|---|---|---|
//! | has not touched | pieces of the law on approach | at the capture, into contact | |
//! | has touched | pieces of the law on retraction, and above ω_c those on approach | | at the end of the part that differs from approach, to "has not touched" |
//! | has yielded to ω_max | its summit is lowered by the residual depth ω_r: pieces before contact; contact; above ω_max the law on approach | at the capture, counted from the lowered summit | at the end of contact, likewise |
//!
//! Laws of loading alone retrace their approach in every state.
//!
//! Source of the unloading: [`super::cycle`].

use super::block::Responses;
use super::cycle::Loop;
use super::history::Path;
use super::lane::Lanes;
use super::law::{End, Law, Smoothness};
use super::stats::SolverStats;
use super::summit::FlattenedSummits;
use std::ops::{Deref, Range};

/// Order n of the root δ^(1/n) in which the load on unloading is treated as smooth. The load grows about as δ^(3/2), which is a
/// polynomial in the fourth root; the error of that approximation is negligible.
const UNLOADING: i32 = 4;

/// The function of a segment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Source {
    /// A regime of the law along a path, at δ.
    Law(Path, usize),
    /// A regime of the law along a path before contact, of the lowered summit.
    Detached(Path, usize),
    /// A contact that has yielded, below ω_max.
    Unloading,
    /// No force, beyond the end of the law.
    Nothing,
}

/// An interval of δ on which the force is one smooth function.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Segment {
    /// Function of the force.
    pub source: Source,
    /// Lower end δ, m.
    pub lower: f64,
    /// Upper end δ, m.
    pub upper: f64,
    /// Numbers of the segments that follow below and above.
    pub next: [Option<u8>; 2],
    /// Smoothness of the force.
    pub smoothness: Smoothness,
}

/// A value that is borrowed or owned; other than [`std::borrow::Cow`] it need not be cloned.
pub(crate) enum MaybeOwned<'a, T: ?Sized> {
    /// Borrowed.
    Shared(&'a T),
    /// Owned.
    Own(Box<T>),
}

impl<T: ?Sized> Deref for MaybeOwned<'_, T> {
    type Target = T;

    fn deref(&self) -> &T {
        match self {
            Self::Shared(shared) => shared,
            Self::Own(own) => own,
        }
    }
}

/// The laws of an asperity of one radius, with hysteresis or without.
pub(crate) enum Hysteresis<'a> {
    /// A law without hysteresis: retraction retraces approach.
    None(MaybeOwned<'a, dyn Law + 'a>),
    /// The laws of a loop.
    Loop(MaybeOwned<'a, Loop>),
}

/// An asperity that has yielded.
#[derive(Clone, Debug)]
pub(crate) struct Yielded {
    /// ω_max, m.
    pub largest: f64,
    /// Its summit.
    summits: FlattenedSummits,
    /// The regime of the law on approach at ω_max.
    pub regime: usize,
    /// Segments of its force.
    pub segments: Vec<Segment>,
    /// The number of segments out of contact, which come first.
    pub untouched: usize,
}

impl Hysteresis<'_> {
    /// The law along a path.
    pub fn law(&self, path: Path) -> &dyn Law {
        match (self, path) {
            (Self::None(law), _) => &**law,
            (Self::Loop(cycle), path) => cycle.law(path),
        }
    }

    /// ∫(P − F_s) dδ, J, along the unstable part of its force curve, from where contact begins to where it ends, of
    /// an asperity that has not yielded.
    pub fn unstable_work(&self) -> f64 {
        match self {
            Self::None(_) => 0.0,
            Self::Loop(cycle) => cycle.retraction().unstable_work(),
        }
    }

    /// The interference from which the asperity yields, m; ∞ if it does not, or if its law is one of loading alone.
    pub fn onset(&self) -> f64 {
        match self {
            Self::Loop(cycle) => cycle.onset(),
            Self::None(_) => f64::INFINITY,
        }
    }

    /// The segments of an asperity that has not yielded, and the number of these before it has touched, which come
    /// first.
    pub fn segments(&self) -> (Vec<Segment>, usize) {
        let approach = pieces(self.law(Path::Approach), Path::Approach, 0..usize::MAX);
        let Self::Loop(cycle) = self else {
            let count = approach.len();
            return (chain(approach), count);
        };
        let mut untouched = approach.clone();
        untouched.retain(|segment| segment.lower < cycle.capture);
        if let Some(last) = untouched.last_mut() {
            last.upper = last.upper.min(cycle.capture);
        }
        let critical = cycle.critical();
        let elastic = if cycle.yields() { cycle.first_plastic } else { usize::MAX };
        let mut touched = pieces(cycle.retraction(), Path::Retraction, 0..elastic);
        let lost = cycle.lost();
        let is_end = |segment: &Segment| segment.source == Source::Nothing;
        touched.retain(|segment| segment.upper > lost && (segment.lower < critical || is_end(segment)));
        if let Some(first) = touched.first_mut() {
            first.lower = first.lower.max(lost);
        }
        if cycle.yields() {
            touched.extend(approach.into_iter().filter(|segment| segment.lower >= critical));
        }
        let count = untouched.len();
        (joined(untouched, touched), count)
    }

    /// The state of an asperity that has yielded to ω_max, m; none below ω_c, or of a law of loading alone.
    pub fn yielded(&self, largest: f64) -> Option<Yielded> {
        let Self::Loop(cycle) = self else { return None };
        if !cycle.has_yielded(largest) {
            return None;
        }
        let summit = cycle.summit_of(largest);
        let residual = largest - summit.recovery;
        // A summit that has detached obeys the law of an asperity of the radius of its apex.
        let own = cycle.of(summit.lane());
        let kinks = summit.kinks.map(|kink| kink + residual);
        let lost_contact = lowered(&own, Path::Approach, f64::NEG_INFINITY..own.capture, residual);
        let mut contact = lowered(&own, Path::Retraction, own.lost()..own.release(), residual);
        contact.push(Segment::unloading(own.release() + residual..largest));
        let [lost_contact, mut contact] = [lost_contact, contact].map(|segments| split(segments, &kinks));
        let mut summits = FlattenedSummits::default();
        summits.push(summit);
        let mut virgin = pieces(cycle.approach(), Path::Approach, cycle.first_plastic..usize::MAX);
        virgin.retain(|segment| segment.upper > largest);
        virgin.iter_mut().for_each(|segment| segment.lower = segment.lower.max(largest));
        contact.append(&mut virgin);
        let regime = cycle.approach().boundaries().partition_point(|end| !end.is_above(largest));
        Some(Yielded {
            largest,
            summits,
            regime,
            untouched: lost_contact.len(),
            segments: joined(lost_contact, contact),
        })
    }

    /// F_s, N, P, N, and the area, m², of an asperity that has yielded, at δ, m, within one of its segments.
    pub fn respond(
        &self,
        yielded: &Yielded,
        segment: &Segment,
        interference: f64,
        out: &mut Responses,
        stats: &mut SolverStats,
    ) -> [f64; 3] {
        let Self::Loop(cycle) = self else { return [0.0; 3] };
        let distance = yielded.largest - interference;
        let mut of_summit = |law| yielded.summits.respond_all(law, distance, out, stats);
        match segment.source {
            Source::Nothing => return [0.0; 3],
            Source::Unloading => of_summit((cycle.retraction(), cycle.first_contact)),
            Source::Detached(path, regime) => of_summit((self.law(path), regime)),
            Source::Law(path, regime) => {
                self.law(path).evaluate(regime, Lanes::Own, &[interference], out, stats)
            }
        }
        [out.adhesion[0], out.contact[0], out.area[0]]
    }
}

impl Loop {
    /// Interference, m, below which approach and retraction are the same.
    fn lost(&self) -> f64 {
        match (self.approach.capture(None), self.retraction.pieces(None).first()) {
            (Some(_), Some(first)) => first.upper.min(self.release()),
            _ => self.release(),
        }
    }
}

impl Segment {
    /// The segment of a contact that has yielded, an interval of δ, m; at its lower end the force varies like a root.
    fn unloading(within: Range<f64>) -> Self {
        let smoothness = Smoothness::Root { end: End::Lower, place: within.start, order: UNLOADING };
        let Range { start: lower, end: upper } = within;
        Self { source: Source::Unloading, lower, upper, next: [None; 2], smoothness }
    }
}

/// The segments before contact of a summit that is lowered by a `residual` depth, m, along a path and in an interval of δ, m.
fn lowered(own: &Loop, path: Path, within: Range<f64>, residual: f64) -> Vec<Segment> {
    let Range { start: from, end: to } = within;
    let mut segments = pieces(own.law(path), path, 0..own.first_contact);
    segments.retain(|segment| segment.lower < to && segment.upper > from);
    for segment in &mut segments {
        if let Source::Law(path, regime) = segment.source {
            segment.source = Source::Detached(path, regime);
        }
        segment.lower = segment.lower.max(from) + residual;
        segment.upper = segment.upper.min(to) + residual;
        if let Smoothness::Root { place, .. } = &mut segment.smoothness {
            *place += residual;
        }
    }
    if let Some(last) = segments.last_mut() {
        last.upper = to + residual;
    }
    segments
}

/// The segments divided at kinks, m. Only the outermost parts of each keep its root.
fn split(segments: Vec<Segment>, kinks: &[f64]) -> Vec<Segment> {
    let mut parts = Vec::with_capacity(segments.len());
    for mut rest in segments {
        let mut within: Vec<f64> = kinks.to_vec();
        within.retain(|kink| rest.lower < *kink && *kink < rest.upper);
        within.sort_by(f64::total_cmp);
        let at_end = |end: End| match rest.smoothness {
            Smoothness::Root { end: own, .. } if own != end => Smoothness::Smooth,
            own => own,
        };
        let [first, last] = [at_end(End::Lower), at_end(End::Upper)];
        let is_whole = within.is_empty();
        for (i, kink) in within.into_iter().enumerate() {
            let smoothness = if i == 0 { first } else { Smoothness::Smooth };
            parts.push(Segment { upper: kink, smoothness, ..rest });
            rest.lower = kink;
        }
        parts.push(if is_whole { rest } else { Segment { smoothness: last, ..rest } });
    }
    parts
}

/// The segments of a range of regimes of a law, rising and not yet linked, and the one beyond the end of the law.
fn pieces(law: &dyn Law, path: Path, regimes: Range<usize>) -> Vec<Segment> {
    let count = law.regimes().len();
    let end = law.boundaries().get(count - 1).map_or(f64::INFINITY, |end| end.interference);
    let is_last = regimes.end >= count;
    let own =
        (regimes.start..regimes.end.min(count)).flat_map(|regime| law.pieces_of(regime, None)).map(|piece| {
            Segment {
                source: Source::Law(path, piece.regime),
                lower: piece.lower,
                upper: piece.upper,
                next: [None; 2],
                smoothness: piece.smoothness,
            }
        });
    let mut own: Vec<Segment> = own.collect();
    if end.is_finite() && is_last {
        let (lower, upper, next) = (end, f64::INFINITY, [None; 2]);
        own.push(Segment { source: Source::Nothing, lower, upper, next, smoothness: Smoothness::Smooth });
    }
    own
}

/// Links each of rising segments to its neighbours.
fn chain(mut segments: Vec<Segment>) -> Vec<Segment> {
    let count = segments.len();
    for (i, segment) in segments.iter_mut().enumerate() {
        let neighbour = |i: Option<usize>| i.filter(|i| *i < count).map(|i| i as u8);
        segment.next = [neighbour(i.checked_sub(1)), neighbour(Some(i + 1))];
    }
    segments
}

/// The segments before contact and the segments of an asperity that has touched, in one list. The last segment before contact
/// leads to the second group, and the first segment of the second group leads back.
fn joined(before: Vec<Segment>, touched: Vec<Segment>) -> Vec<Segment> {
    let count = before.len();
    let (mut before, mut touched) = (chain(before), chain(touched));
    for segment in &mut touched {
        segment.next = segment.next.map(|next| next.map(|i| i + count as u8));
    }
    let holding = |segments: &[Segment], place: f64, is_above: bool| {
        let of = |segment: &Segment| {
            if is_above { place < segment.upper } else { place <= segment.upper }
        };
        segments.iter().position(of)
    };
    if let (Some(last), true) = (before.last().copied(), !touched.is_empty()) {
        let captured = holding(&touched, last.upper, true).unwrap_or(touched.len() - 1);
        let lost = holding(&before, touched[0].lower, false).unwrap_or(count - 1);
        before[count - 1].next[1] = Some((count + captured) as u8);
        touched[0].next[0] = Some(lost as u8);
    }
    before.append(&mut touched);
    before
}
