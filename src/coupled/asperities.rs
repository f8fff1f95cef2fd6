//! The asperities of a surface with the state of each, and their forces.

use crate::asperity::hysteresis::{Hysteresis, Segment, Source, Yielded};
use crate::asperity::{BLOCK, Lanes, Method, Path, Responses, SolverStats};
use crate::math::counting_sort::counting_sort;
use std::cell::OnceCell;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Share of the length over which a law varies, over which its slope is taken.
pub(super) const SLOPE_STEP: f64 = 1e-6;

/// The laws of the asperities of one radius, with the segments of their forces.
pub struct RadiusLaws<'a> {
    memory: Hysteresis<'a>,
    segments: Vec<Segment>,
    /// The number of segments of asperities that have not touched.
    untouched: usize,
    /// The work along the unstable part, J, where it was needed.
    unstable_work: OnceCell<f64>,
    /// The length over which the laws vary, m.
    pub length: f64,
}

impl<'a> RadiusLaws<'a> {
    /// The laws of a radius, which vary over `length`, m.
    pub(crate) fn new(memory: Hysteresis<'a>, length: f64) -> Self {
        let (segments, untouched) = memory.segments();
        Self { memory, segments, untouched, unstable_work: OnceCell::new(), length }
    }
}

/// The state of an asperity that is at rest at a jump of its law.
#[derive(Clone, Copy, Debug)]
pub struct Rest {
    /// δ of its law, m.
    pub place: f64,
    /// The segments below and above.
    pub segments: [u8; 2],
    /// Share of the upper one in its forces.
    pub share: f64,
    /// P − F_s at the two ends, N.
    pub ends: [f64; 2],
    /// The stiffness that it has in systems, N/m: the others yield to it.
    pub stiffness: f64,
}

/// The states of all asperities: all that a surface remembers.
#[derive(Clone, Debug, Default)]
pub struct States {
    /// The segment of each.
    pub segments: Vec<u8>,
    /// ω_max of each, m; −∞ where it has not yielded. None where no asperity can yield.
    largest: Vec<f64>,
    /// Asperities that have yielded and come back from ω_max; likewise.
    unloaded: Vec<Option<Arc<Yielded>>>,
    /// Asperities at rest at a jump.
    pub resting: BTreeMap<u32, Rest>,
}

impl States {
    /// ω_max of an asperity, m; −∞ where it has not yielded.
    fn largest_of(&self, i: usize) -> f64 {
        self.largest.get(i).copied().unwrap_or(f64::NEG_INFINITY)
    }

    /// The path of an asperity that has yielded and come back from ω_max.
    pub(super) fn unloaded_of(&self, i: usize) -> Option<&Arc<Yielded>> {
        self.unloaded.get(i)?.as_ref()
    }

    /// Takes the path of an asperity from other states, unless it has one.
    pub(super) fn take_path(&mut self, i: usize, of: &Self) {
        if let (None, Some(flowed)) = (self.unloaded_of(i), of.unloaded_of(i)) {
            self.unloaded[i] = Some(flowed.clone());
        }
    }
}

/// Forces of all asperities.
#[derive(Clone, Debug, Default)]
pub struct Forces {
    /// F_s of each, N.
    pub adhesion: Vec<f64>,
    /// P of each, N.
    pub contact: Vec<f64>,
    /// Contact area of each, m².
    pub area: Vec<f64>,
}

/// The asperities of a surface, each with the laws of its radius.
pub struct Asperities<'a> {
    laws: Vec<RadiusLaws<'a>>,
    /// Index among all of the first segment of each of the laws, and at last the number of segments.
    first: Vec<usize>,
    /// The number of the laws of each.
    of_each: Vec<u32>,
    /// t = ∛(R_eff/R) of each; none where the substrate is flat under all.
    stretches: Vec<f64>,
    order: Vec<u32>,
    out: Responses,
    places: [f64; BLOCK],
    /// The cost.
    pub stats: SolverStats,
}

impl<'a> Asperities<'a> {
    /// Asperities of which each has the laws of a number.
    pub fn new(laws: Vec<RadiusLaws<'a>>, of_each: Vec<u32>) -> Self {
        let mut first = vec![0];
        laws.iter().for_each(|laws| first.push(first[first.len() - 1] + laws.segments.len()));
        let (out, places) = (Responses::default(), [0.0; BLOCK]);
        let (stretches, order) = (Vec::new(), Vec::new());
        Self { laws, first, of_each, stretches, order, out, places, stats: SolverStats::default() }
    }

    /// Takes ∛(R_eff/R) of each asperity: a bent substrate under it has its law at another radius.
    pub fn stretch(&mut self, stretches: &[f64]) {
        self.stretches.clear();
        self.stretches.extend_from_slice(stretches);
    }

    /// ∛(R_eff/R) of an asperity.
    pub fn stretch_of(&self, i: usize) -> f64 {
        stretch_of(&self.stretches, i)
    }

    /// The interference, m, of an asperity at one of its law, m.
    pub fn place(&self, i: usize, of_law: f64) -> f64 {
        of_law * self.stretch_of(i)
    }

    /// The interference of its law, m, of an asperity at one, m.
    pub fn of_law(&self, i: usize, interference: f64) -> f64 {
        interference / self.stretch_of(i)
    }

    /// The number of the laws of an asperity.
    fn number(&self, i: usize) -> usize {
        self.of_each[i] as usize
    }

    /// The length over which the law of an asperity varies, m.
    pub fn length(&self, i: usize) -> f64 {
        self.laws[self.number(i)].length
    }

    /// That length of the first asperity, m, infinite where there is none.
    pub fn first_length(&self) -> f64 {
        if self.of_each.is_empty() { f64::INFINITY } else { self.length(0) }
    }

    /// The states of asperities that have not touched.
    pub fn none_touched(&self) -> States {
        let count = self.of_each.len();
        let can_yield = self.laws.iter().any(|laws| laws.memory.onset() < f64::INFINITY);
        let remembered = if can_yield { count } else { 0 };
        let (largest, unloaded) = (vec![f64::NEG_INFINITY; remembered], vec![None; remembered]);
        States { segments: vec![0; count], largest, unloaded, resting: BTreeMap::new() }
    }

    /// All segments of an asperity.
    pub(super) fn segments<'b>(&'b self, states: &'b States, i: usize) -> &'b [Segment] {
        match states.unloaded_of(i) {
            Some(flowed) => &flowed.segments,
            None => &self.laws[self.number(i)].segments,
        }
    }

    /// The number of segments, the first ones, that an asperity has before it has touched.
    pub(super) fn untouched(&self, states: &States, i: usize) -> usize {
        match states.unloaded_of(i) {
            Some(flowed) => flowed.untouched,
            None => self.laws[self.number(i)].untouched,
        }
    }

    /// ∫(P − F_s) dδ, J, along the unstable part of the force curve of an asperity, from where contact begins to where
    /// it ends; of one that has yielded in proportion to the force there.
    pub(super) fn unstable_work(&mut self, states: &States, i: usize) -> f64 {
        let RadiusLaws { memory, unstable_work, segments, untouched, .. } = &self.laws[self.number(i)];
        let work = *unstable_work.get_or_init(|| memory.unstable_work());
        let (Some(flowed), Some(last)) = (states.unloaded_of(i), segments.get(*untouched)) else {
            return work;
        };
        let Source::Law(path, regime) = last.source else { return work };
        memory.law(path).evaluate(
            regime,
            Lanes::Own,
            &[within(last, last.lower)],
            &mut self.out,
            &mut self.stats,
        );
        let elastic = self.out.contact[0] - self.out.adhesion[0];
        let first = flowed.untouched as u8;
        work * self.load(states, i, first, flowed.segments[first as usize].lower) / elastic
    }

    /// The segment that an asperity is in, between interferences.
    pub(crate) fn segment(&self, states: &States, i: usize) -> Segment {
        let (own, stretch) = (self.segment_of_law(states, i), self.stretch_of(i));
        Segment { lower: own.lower * stretch, upper: own.upper * stretch, ..own }
    }

    /// The segment that an asperity is in, between interferences of its law; one that has yielded leaves the
    /// law on approach at ω_max.
    pub(crate) fn segment_of_law(&self, states: &States, i: usize) -> Segment {
        let segment = self.segments(states, i)[states.segments[i] as usize];
        match states.unloaded_of(i) {
            Some(_) => segment,
            None => Segment { lower: segment.lower.max(states.largest_of(i)), ..segment },
        }
    }

    /// The segment that follows where an asperity leaves its own, upwards or not; of one that comes back from
    /// ω_max it is the first of its own.
    pub(crate) fn next(&mut self, states: &mut States, i: usize, upwards: bool) -> Option<u8> {
        let (own, largest) = (self.segment_of_law(states, i), states.largest_of(i));
        if upwards || states.unloaded_of(i).is_some() || own.lower > largest {
            return own.next[usize::from(upwards)];
        }
        let number = self.number(i);
        let Some(flowed) = self.laws[number].memory.yielded(largest) else {
            return own.next[0];
        };
        let above = flowed.segments.iter().position(|segment| segment.source == own.source);
        states.segments[i] = above.unwrap_or(flowed.segments.len() - 1) as u8;
        states.unloaded[i] = Some(Arc::new(flowed));
        self.segment(states, i).next[0]
    }

    /// Whether a step from one segment to another is irreversible: the step back is at another place.
    pub fn is_hysteretic(&self, states: &States, i: usize, [from, to]: [u8; 2]) -> bool {
        let segments = self.segments(states, i);
        let [low, high] = if segments[from as usize].next[1] == Some(to) { [from, to] } else { [to, from] };
        let (low, high) = (segments[low as usize], segments[high as usize]);
        low.upper != high.lower
    }

    /// Whether an asperity has the jump of a rest.
    pub(super) fn is_jump(&self, states: &States, i: usize, rest: &Rest) -> bool {
        let own = self.segments(states, i);
        let [low, high] = rest.segments.map(|number| own.get(number as usize));
        low.zip(high).is_some_and(|(low, high)| low.upper == rest.place || high.lower == rest.place)
    }

    /// The distance, m, by which an asperity goes back from where contact begins to where it ends.
    pub(super) fn width_of_hysteresis(&self, states: &States, i: usize) -> f64 {
        let (segments, untouched) = (self.segments(states, i), self.untouched(states, i));
        self.place(i, segments[untouched - 1].upper - segments[untouched].lower)
    }

    /// The regime of the law that an asperity counts in; none beyond the end of the law. At rest at the jump into contact
    /// it is in contact, in part; at others it counts where the larger share of its force is.
    pub fn regime(&self, states: &States, i: usize) -> Option<usize> {
        let of = |number: u8| match self.segments(states, i)[number as usize].source {
            Source::Law(path, regime) | Source::Detached(path, regime) => Some((Some(path), regime)),
            Source::Unloading => states.unloaded_of(i).map(|flowed| (None, flowed.regime)),
            Source::Nothing => None,
        };
        let is_contact = |number: u8| {
            of(number).is_some_and(|(path, regime)| {
                path.is_none_or(|path| {
                    self.laws[self.number(i)].memory.law(path).regimes()[regime].is_contact()
                })
            })
        };
        let number = match states.resting.get(&(i as u32)) {
            Some(Rest { segments: [_, upper], share, .. }) if *share >= 0.5 || is_contact(*upper) => *upper,
            Some(Rest { segments: [lower, _], .. }) => *lower,
            None => states.segments[i],
        };
        of(number).map(|(_, regime)| regime)
    }

    /// Whether an asperity is one that has touched.
    pub fn has_touched(&self, states: &States, i: usize) -> bool {
        let untouched = self.laws[self.number(i)].untouched;
        states.unloaded_of(i).is_some() || states.segments[i] as usize >= untouched
    }

    /// Makes asperities at interferences, m, remember their depth, if they flow.
    pub fn remember(&self, states: &mut States, interference: &[f64]) {
        for (i, &delta) in interference.iter().enumerate() {
            let (laws, delta) = (&self.laws[self.number(i)], self.of_law(i, delta));
            if !(delta > states.largest_of(i).max(laws.memory.onset())) {
                continue;
            }
            let segment = self.segment_of_law(states, i);
            let is_virgin = matches!(segment.source, Source::Law(Path::Approach, _)) && delta < segment.upper;
            if !is_virgin || states.resting.contains_key(&(i as u32)) {
                continue;
            }
            states.largest[i] = delta;
            if states.unloaded[i].take().is_some() {
                let virgin = laws.segments.iter().rposition(|own| own.source == segment.source);
                states.segments[i] = virgin.expect("it is one of the law on approach") as u8;
            }
        }
    }

    /// The forces at interferences, m, of the asperities `which`; beyond the ends of its segment each has the
    /// forces at the end.
    pub fn respond(&mut self, states: &States, which: &[u32], interference: &[f64], forces: &mut Forces) {
        for part in [&mut forces.adhesion, &mut forces.contact, &mut forces.area] {
            part.resize(self.of_each.len(), 0.0);
        }
        let mut order = std::mem::take(&mut self.order);
        let alone = self.first[self.laws.len()];
        let group = |i: u32| match states.unloaded_of(i as usize) {
            Some(_) => alone,
            None => self.first[self.of_each[i as usize] as usize] + states.segments[i as usize] as usize,
        };
        let starts = counting_sort(which.iter().copied(), alone + 1, group, &mut order);
        for laws in 0..self.laws.len() {
            for number in 0..self.laws[laws].segments.len() {
                let group = self.first[laws] + number;
                let own = &order[starts[group]..starts[group + 1]];
                if !own.is_empty() {
                    self.respond_in_blocks((laws, number), own, interference, forces);
                }
            }
        }
        for &i in &order[starts[alone]..] {
            let i = i as usize;
            let of_law = self.of_law(i, interference[i]);
            put(forces, i, self.one(states, i, states.segments[i], of_law));
        }
        self.order = order;
        for (&i, rest) in &states.resting {
            let i = i as usize;
            let [low, high] = rest.segments.map(|segment| self.one(states, i, segment, rest.place));
            let mixed = std::array::from_fn(|k| low[k] + rest.share * (high[k] - low[k]));
            put(forces, i, mixed);
        }
    }

    /// F_s, N, P, N, and the area, m², of one asperity in a segment of its at an interference of its law, m.
    pub fn one(&mut self, states: &States, i: usize, segment: u8, interference: f64) -> [f64; 3] {
        stretched(self.stretch_of(i), self.one_of_law(states, i, segment, interference))
    }

    /// P − F_s, N, of an asperity in a segment at an interference of its law, m.
    pub(super) fn load(&mut self, states: &States, i: usize, segment: u8, interference: f64) -> f64 {
        let [adhesion, contact, _] = self.one(states, i, segment, interference);
        contact - adhesion
    }

    fn one_of_law(&mut self, states: &States, i: usize, segment: u8, interference: f64) -> [f64; 3] {
        let laws = &self.laws[self.number(i)];
        let flowed = states.unloaded_of(i);
        let segment = flowed.map_or(&laws.segments, |flowed| &flowed.segments)[segment as usize];
        let delta = within(&segment, interference);
        if let Some(flowed) = flowed {
            return laws.memory.respond(flowed, &segment, delta, &mut self.out, &mut self.stats);
        }
        let Source::Law(path, regime) = segment.source else { return [0.0; 3] };
        laws.memory.law(path).evaluate(regime, Lanes::Own, &[delta], &mut self.out, &mut self.stats);
        [self.out.adhesion[0], self.out.contact[0], self.out.area[0]]
    }

    /// The forces of asperities that are all in the same segment of the same laws.
    fn respond_in_blocks(
        &mut self,
        (number, segment): (usize, usize),
        which: &[u32],
        interference: &[f64],
        forces: &mut Forces,
    ) {
        let Self { laws, out, places, stats, stretches, .. } = self;
        let RadiusLaws { memory, segments, .. } = &laws[number];
        let segment = &segments[segment];
        let Source::Law(path, regime) = segment.source else {
            which.iter().for_each(|&i| put(forces, i as usize, [0.0; 3]));
            return;
        };
        let law = memory.law(path);
        if let Method::Constant(adhesion) = law.method(regime) {
            let stretch = |i: u32| stretch_of(stretches, i as usize);
            let adhesion = |i: u32| stretched(stretch(i), [adhesion, 0.0, 0.0]);
            which.iter().for_each(|&i| put(forces, i as usize, adhesion(i)));
            return;
        }
        for block in which.chunks(BLOCK) {
            for (place, &i) in places.iter_mut().zip(block) {
                *place = within(segment, interference[i as usize] / stretch_of(stretches, i as usize));
            }
            law.evaluate(regime, Lanes::Own, &places[..block.len()], out, stats);
            for (k, &i) in block.iter().enumerate() {
                let found = [out.adhesion[k], out.contact[k], out.area[k]];
                put(forces, i as usize, stretched(stretch_of(stretches, i as usize), found));
            }
        }
    }

    /// A place next to the interference, m, of an asperity in its segment, between which a slope is taken.
    pub fn beside(&self, states: &States, i: usize, interference: f64) -> f64 {
        let step = SLOPE_STEP * self.length(i);
        interference + if interference + step < self.segment(states, i).upper { step } else { -step }
    }
}

/// The distinct ones of radii, rising, and the number of each among them.
pub fn distinct(radii: &[f64]) -> (Vec<f64>, Vec<u32>) {
    let mut different = radii.to_vec();
    different.sort_unstable_by(f64::total_cmp);
    different.dedup();
    let number = |radius: &f64| different.partition_point(|other| other < radius) as u32;
    let numbers = radii.iter().map(number).collect();
    (different, numbers)
}

fn stretch_of(stretches: &[f64], i: usize) -> f64 {
    stretches.get(i).copied().unwrap_or(1.0)
}

/// F_s, P and the area at R_eff by those at R: with t = ∛(R_eff/R), t³ F(δ/t) and t⁴ A(δ/t).
fn stretched(stretch: f64, [adhesion, contact, area]: [f64; 3]) -> [f64; 3] {
    let of_force = stretch * stretch * stretch;
    [of_force * adhesion, of_force * contact, of_force * stretch * area]
}

fn put(forces: &mut Forces, i: usize, [adhesion, contact, area]: [f64; 3]) {
    (forces.adhesion[i], forces.contact[i], forces.area[i]) = (adhesion, contact, area);
}

/// The place in a segment, strictly, that is closest to an interference, m: at an end itself a law may be
/// another.
fn within(segment: &Segment, interference: f64) -> f64 {
    interference.max(segment.lower.next_up()).min(segment.upper.next_down())
}
