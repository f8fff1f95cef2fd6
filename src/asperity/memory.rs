//! One asperity that remembers: the paths its force can follow when its interference need not be monotone.
//!
//! # Formula
//! The force is a chain of segments in the interference δ, each one smooth function, with the segment that
//! follows beyond either end:
//!
//! | state | segments | left upwards | left downwards |
//! |---|---|---|---|
//! | has not touched | pieces of the law on approach | at the capture, into contact | |
//! | has touched | pieces of the law on retraction, and above ω_c those on approach | | at the end of what retraction does not share with approach, to "has not touched" |
//! | has flowed to ω_max | its top lowered by ω_res: pieces before contact; contact; above ω_max the law on approach | at the capture, counted from the lowered top | at the end of contact, likewise |
//!
//! Laws of which the unloading is not known retrace their approach in every state.
//!
//! Source of the unloading: [`super::unloading`].

use super::block::Responses;
use super::history::Path;
use super::lane::Lanes;
use super::law::{End, Law, Smoothness};
use super::stats::SolverStats;
use super::top::Tops;
use super::unloading::Loop;
use std::ops::{Deref, Range};

/// The root of δ in which the load of unloading is taken as smooth. The load grows as about the power 3/2 of δ, which no root
/// makes a polynomial; in the fourth root the rest is too smooth to matter.
const UNLOADING: i32 = 4;

/// The function of a segment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Source {
    /// A regime of the law along a path, at δ.
    Law(Path, usize),
    /// A regime of the law along a path before contact, of the lowered top.
    Lowered(Path, usize),
    /// A contact that has flowed, below ω_max.
    Unloading,
    /// Beyond the end of the law nothing acts.
    Nothing,
}

/// A segment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Segment {
    /// Source of the force.
    pub source: Source,
    /// Lower end δ, m.
    pub lower: f64,
    /// Upper end δ, m.
    pub upper: f64,
    /// The segment that follows below, and above.
    pub next: [Option<u8>; 2],
    /// Smoothness of the force.
    pub smoothness: Smoothness,
}

/// Something that is another's, or one's own.
pub(crate) enum Held<'a, T: ?Sized> {
    /// Another's.
    Shared(&'a T),
    /// One's own.
    Own(Box<T>),
}

impl<T: ?Sized> Deref for Held<'_, T> {
    type Target = T;

    fn deref(&self) -> &T {
        match self {
            Self::Shared(shared) => shared,
            Self::Own(own) => own,
        }
    }
}

/// The laws of an asperity of one radius.
pub(crate) enum Memory<'a> {
    /// A law of which asperities retrace their approach.
    None(Held<'a, dyn Law + 'a>),
    /// A loop.
    Loop(Held<'a, Loop>),
}

/// An asperity that has flowed.
#[derive(Clone, Debug)]
pub(crate) struct Flowed {
    /// ω_max, m.
    pub largest: f64,
    /// Its top, alone.
    tops: Tops,
    /// The regime of the law on approach at ω_max.
    pub regime: usize,
    /// Segments of its force.
    pub segments: Vec<Segment>,
    /// The number of them, the first ones, out of contact.
    pub untouched: usize,
}

impl Memory<'_> {
    /// The law along a path.
    pub fn law(&self, path: Path) -> &dyn Law {
        match (self, path) {
            (Self::None(law), _) => &**law,
            (Self::Loop(cycle), path) => cycle.law(path),
        }
    }

    /// ∫(P − F_s) dδ, J, along the unstable part of its force curve, from where contact begins to where it ends, of
    /// an asperity that has not flowed.
    pub fn unstable_work(&self) -> f64 {
        match self {
            Self::None(_) => 0.0,
            Self::Loop(cycle) => cycle.retraction().unstable_work(),
        }
    }

    /// The interference from which the asperity flows, m; ∞ where it does not, or where what follows is not known.
    pub fn onset(&self) -> f64 {
        match self {
            Self::Loop(cycle) => cycle.onset(),
            Self::None(_) => f64::INFINITY,
        }
    }

    /// The segments of an asperity that has not flowed, with the number of the first ones, before it has
    /// touched.
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
        let top = cycle.critical();
        let elastic = if cycle.flows() { cycle.first_plastic } else { usize::MAX };
        let mut touched = pieces(cycle.retraction(), Path::Retraction, 0..elastic);
        let lost = cycle.lost();
        let is_end = |segment: &Segment| segment.source == Source::Nothing;
        touched.retain(|segment| segment.upper > lost && (segment.lower < top || is_end(segment)));
        if let Some(first) = touched.first_mut() {
            first.lower = first.lower.max(lost);
        }
        if cycle.flows() {
            touched.extend(approach.into_iter().filter(|segment| segment.lower >= top));
        }
        let count = untouched.len();
        (joined(untouched, touched), count)
    }

    /// The state of an asperity that has flowed to ω_max, m; none where that is not known, or below ω_c.
    pub fn flowed(&self, largest: f64) -> Option<Flowed> {
        let Self::Loop(cycle) = self else { return None };
        if !cycle.has_flowed(largest) {
            return None;
        }
        let top = cycle.top_of(largest);
        let residual = largest - top.recovery;
        // A top that has let go is an asperity of the law, of the radius of its apex.
        let own = cycle.of(top.lane());
        let kinks = top.kinks.map(|kink| kink + residual);
        let lost_contact = lowered(&own, Path::Approach, f64::NEG_INFINITY..own.capture, residual);
        let mut contact = lowered(&own, Path::Retraction, own.lost()..own.release(), residual);
        contact.push(Segment::unloading(own.release() + residual..largest));
        let [lost_contact, mut contact] = [lost_contact, contact].map(|segments| split(segments, &kinks));
        let mut tops = Tops::default();
        tops.push(top);
        let mut virgin = pieces(cycle.approach(), Path::Approach, cycle.first_plastic..usize::MAX);
        virgin.retain(|segment| segment.upper > largest);
        virgin.iter_mut().for_each(|segment| segment.lower = segment.lower.max(largest));
        contact.append(&mut virgin);
        let regime = cycle.approach().boundaries().partition_point(|end| !end.is_above(largest));
        Some(Flowed {
            largest,
            tops,
            regime,
            untouched: lost_contact.len(),
            segments: joined(lost_contact, contact),
        })
    }

    /// F_s, N, P, N, and the area, m², of an asperity that has flowed, in one of its segments at δ, m, which
    /// is within it.
    pub fn respond(
        &self,
        flowed: &Flowed,
        segment: &Segment,
        interference: f64,
        out: &mut Responses,
        stats: &mut SolverStats,
    ) -> [f64; 3] {
        let Self::Loop(cycle) = self else { return [0.0; 3] };
        let distance = flowed.largest - interference;
        let mut of_top = |law| flowed.tops.respond_all(law, distance, out, stats);
        match segment.source {
            Source::Nothing => return [0.0; 3],
            Source::Unloading => of_top((cycle.retraction(), cycle.first_contact)),
            Source::Lowered(path, regime) => of_top((self.law(path), regime)),
            Source::Law(path, regime) => {
                self.law(path).evaluate(regime, Lanes::Own, &[interference], out, stats)
            }
        }
        [out.adhesion[0], out.contact[0], out.area[0]]
    }
}

impl Loop {
    /// Interference, m, below which retraction is what approach is.
    fn lost(&self) -> f64 {
        match (self.approach.capture(None), self.retraction.pieces(None).first()) {
            (Some(_), Some(first)) => first.upper.min(self.release()),
            _ => self.release(),
        }
    }
}

impl Segment {
    /// A contact that has flowed, in an interval of δ, m, at whose lower end it varies like a root.
    fn unloading(within: Range<f64>) -> Self {
        let smoothness = Smoothness::Root { end: End::Lower, place: within.start, order: UNLOADING };
        let Range { start: lower, end: upper } = within;
        Self { source: Source::Unloading, lower, upper, next: [None; 2], smoothness }
    }
}

/// The pieces before contact of the law of a loop along a path, in an interval of δ, m, of a top that is lowered by
/// `residual`, m.
fn lowered(own: &Loop, path: Path, within: Range<f64>, residual: f64) -> Vec<Segment> {
    let Range { start: from, end: to } = within;
    let mut segments = pieces(own.law(path), path, 0..own.first_contact);
    segments.retain(|segment| segment.lower < to && segment.upper > from);
    for segment in &mut segments {
        if let Source::Law(path, regime) = segment.source {
            segment.source = Source::Lowered(path, regime);
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

/// Segments that end at kinks, m, within them; they vary like roots at their outer ends alone.
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

/// The pieces of a law in a range of its regimes, rising, not yet chained, and what is beyond its end.
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

/// Segments before contact and of what has touched in one list: the last of those before leads into the
/// others, and the first of these back.
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
