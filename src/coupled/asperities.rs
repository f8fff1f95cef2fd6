//! The asperities of a surface with the state of each, and their forces.

use crate::asperity::memory::{Flowed, Memory, Segment, Source};
use crate::asperity::{BLOCK, Method, Responses, SolverStats};
use std::collections::BTreeMap;

/// Share of the length over which a law varies, over which its slope is taken.
const SLOPE_STEP: f64 = 1e-6;

/// The laws of the asperities of one radius, with the segments of their forces.
pub struct RadiusLaws<'a> {
    memory: Memory<'a>,
    segments: Vec<Segment>,
    /// How many of them are of asperities that have not touched.
    untouched: usize,
    /// The length over which they vary, m.
    pub length: f64,
}

impl<'a> RadiusLaws<'a> {
    /// The laws of a radius, which vary over `length`, m.
    pub(crate) fn new(memory: Memory<'a>, length: f64) -> Self {
        let (segments, untouched) = memory.segments();
        Self { memory, segments, untouched, length }
    }
}

/// Where an asperity is at rest at a jump of its law.
#[derive(Clone, Copy, Debug)]
pub struct Rest {
    /// δ, m.
    pub place: f64,
    /// The segments below and above.
    pub segments: [u8; 2],
    /// Share of the upper one in its forces.
    pub share: f64,
    /// P − F_s at the two ends, N.
    pub ends: [f64; 2],
}

/// What has become of all asperities: it is all that a surface remembers.
#[derive(Clone, Debug, Default)]
pub struct States {
    /// The segment of each.
    pub segments: Vec<u8>,
    /// Those that have flowed.
    pub(crate) flowed: BTreeMap<u32, Flowed>,
    /// Those at rest at a jump.
    pub resting: BTreeMap<u32, Rest>,
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
    /// The number of the laws of each.
    of_each: Vec<u32>,
    /// Asperities by their laws, and where those of each begin, and at last their number.
    by_laws: (Vec<u32>, Vec<usize>),
    order: Vec<u32>,
    out: Responses,
    places: [f64; BLOCK],
    /// The cost.
    pub stats: SolverStats,
}

impl<'a> Asperities<'a> {
    /// Asperities of which each has the laws of a number.
    pub fn new(laws: Vec<RadiusLaws<'a>>, of_each: Vec<u32>) -> Self {
        let mut order = Vec::new();
        let starts = sorted(of_each.iter().map(|&number| number as usize), laws.len(), &mut order);
        let (out, places) = (Responses::default(), [0.0; BLOCK]);
        let (by_laws, stats) = ((order, starts), SolverStats::default());
        Self { laws, of_each, by_laws, order: Vec::new(), out, places, stats }
    }

    /// The number of asperities.
    pub fn count(&self) -> usize {
        self.of_each.len()
    }

    /// The laws of an asperity.
    pub fn laws(&self, i: usize) -> &RadiusLaws<'a> {
        &self.laws[self.of_each[i] as usize]
    }

    /// The states of asperities that have not touched.
    pub fn untouched(&self) -> States {
        States { segments: vec![0; self.count()], ..States::default() }
    }

    /// The states of asperities at interferences, m, each of which has touched where that can be.
    pub fn touched(&mut self, interference: &[f64]) -> States {
        let mut states = self.untouched();
        for (i, &delta) in interference.iter().enumerate() {
            let laws = self.laws(i);
            let holds = |segment: &Segment| delta >= segment.lower && delta < segment.upper;
            let all = laws.segments.iter().enumerate();
            let last = all.filter(|(_, segment)| holds(segment)).map(|(number, _)| number).next_back();
            states.segments[i] = last.unwrap_or(0) as u8;
        }
        states
    }

    /// All segments of an asperity.
    pub(crate) fn segments<'b>(&'b self, states: &'b States, i: usize) -> &'b [Segment] {
        match states.flowed.get(&(i as u32)) {
            Some(flowed) => &flowed.segments,
            None => &self.laws(i).segments,
        }
    }

    /// The segment that an asperity is in.
    pub(crate) fn segment(&self, states: &States, i: usize) -> Segment {
        self.segments(states, i)[states.segments[i] as usize]
    }

    /// Whether a step from one segment to another is one from which there is no way back at the same place.
    pub fn is_hysteretic(&self, states: &States, i: usize, [from, to]: [u8; 2]) -> bool {
        let segments = self.segments(states, i);
        let [low, high] = if segments[from as usize].next[1] == Some(to) { [from, to] } else { [to, from] };
        let (low, high) = (segments[low as usize], segments[high as usize]);
        low.upper != high.lower
    }

    /// The regime of the law that an asperity counts in; none beyond the end of the law.
    pub fn regime(&self, states: &States, i: usize) -> Option<usize> {
        let rest = states.resting.get(&(i as u32));
        let number = rest.map_or(states.segments[i], |rest| rest.segments[usize::from(rest.share >= 0.5)]);
        let flowed = states.flowed.get(&(i as u32));
        match self.segments(states, i)[number as usize].source {
            Source::Law(_, regime) | Source::Lowered(_, regime) => Some(regime),
            Source::Bare | Source::Unloading => flowed.map(|flowed| flowed.regime),
            Source::Nothing => None,
        }
    }

    /// Whether an asperity is one that has touched.
    pub fn has_touched(&self, states: &States, i: usize) -> bool {
        states.flowed.contains_key(&(i as u32)) || states.segments[i] as usize >= self.laws(i).untouched
    }

    /// Has asperities at interferences, m, remember how deep they were, if they have flowed.
    pub fn remember(&mut self, states: &mut States, interference: &[f64]) {
        for (i, &delta) in interference.iter().enumerate() {
            let segment = self.segment(states, i);
            let Source::Law(_, _) = segment.source else { continue };
            let known = states.flowed.get(&(i as u32)).map_or(f64::NEG_INFINITY, |flowed| flowed.largest);
            if delta <= known || states.resting.contains_key(&(i as u32)) {
                continue;
            }
            let laws = &self.laws[self.of_each[i] as usize];
            if let Some(flowed) = laws.memory.flowed(delta, &mut self.stats) {
                // The segment that begins there.
                let number = flowed.segments.iter().position(|segment| segment.lower == delta);
                let number = number.unwrap_or(flowed.segments.len() - 1);
                states.segments[i] = number as u8;
                states.flowed.insert(i as u32, flowed);
            }
        }
    }

    /// The forces of all asperities at interferences, m; beyond the ends of its segment each has those at the
    /// end.
    pub fn respond(&mut self, states: &States, interference: &[f64], forces: &mut Forces) {
        let count = self.count();
        for part in [&mut forces.adhesion, &mut forces.contact, &mut forces.area] {
            part.resize(count, 0.0);
        }
        (0..self.laws.len()).for_each(|number| self.respond_in_blocks(number, states, interference, forces));
        for &i in states.flowed.keys() {
            let i = i as usize;
            put(forces, i, self.one(states, i, states.segments[i], interference[i]));
        }
        for (&i, rest) in &states.resting {
            let i = i as usize;
            let [low, high] = rest.segments.map(|segment| self.one(states, i, segment, rest.place));
            let mixed = std::array::from_fn(|k| low[k] + rest.share * (high[k] - low[k]));
            put(forces, i, mixed);
        }
    }

    /// F_s, N, P, N, and the area, m², of one asperity in a segment of its at an interference, m.
    pub fn one(&mut self, states: &States, i: usize, segment: u8, interference: f64) -> [f64; 3] {
        let laws = &self.laws[self.of_each[i] as usize];
        let flowed = states.flowed.get(&(i as u32));
        let segment = flowed.map_or(&laws.segments, |flowed| &flowed.segments)[segment as usize];
        let delta = within(&segment, interference);
        if let Some(flowed) = flowed {
            return laws.memory.respond(flowed, &segment, delta, &mut self.out, &mut self.stats);
        }
        let Source::Law(path, regime) = segment.source else { return [0.0; 3] };
        laws.memory.law(path).evaluate(regime, &[delta], &mut self.out, &mut self.stats);
        [self.out.adhesion[0], self.out.contact[0], self.out.area[0]]
    }

    /// The forces of the asperities of the laws of a number.
    fn respond_in_blocks(&mut self, laws: usize, states: &States, interference: &[f64], forces: &mut Forces) {
        let Self { by_laws: (all, starts), order, out, places, stats, .. } = self;
        let all = &all[starts[laws]..starts[laws + 1]];
        if let &[i] = all {
            let i = i as usize;
            return put(forces, i, self.one(states, i, states.segments[i], interference[i]));
        }
        let RadiusLaws { memory, segments, .. } = &self.laws[laws];
        let last = segments.len() - 1;
        let own_segments = all.iter().map(|&i| (states.segments[i as usize] as usize).min(last));
        let starts = sorted(own_segments, segments.len(), order);
        order.iter_mut().for_each(|k| *k = all[*k as usize]);
        for (number, segment) in segments.iter().enumerate() {
            let own = &order[starts[number]..starts[number + 1]];
            if own.is_empty() {
                continue;
            }
            let Source::Law(path, regime) = segment.source else {
                own.iter().for_each(|&i| put(forces, i as usize, [0.0; 3]));
                continue;
            };
            let law = memory.law(path);
            if let Method::Constant(adhesion) = law.method(regime) {
                own.iter().for_each(|&i| put(forces, i as usize, [adhesion, 0.0, 0.0]));
                continue;
            }
            for block in own.chunks(BLOCK) {
                for (place, &i) in places.iter_mut().zip(block) {
                    *place = within(segment, interference[i as usize]);
                }
                law.evaluate(regime, &places[..block.len()], out, stats);
                for (k, &i) in block.iter().enumerate() {
                    put(forces, i as usize, [out.adhesion[k], out.contact[k], out.area[k]]);
                }
            }
        }
    }

    /// Slopes of P − F_s of all asperities over their interference, N/m; 0 of those beyond the ends of their
    /// segment. `forces` are those at the interferences, m, and `shifted` is memory.
    pub fn slopes(
        &mut self,
        states: &States,
        interference: &[f64],
        forces: &Forces,
        (places, shifted): (&mut Vec<f64>, &mut Forces),
        slopes: &mut Vec<f64>,
    ) {
        places.clear();
        for (i, &delta) in interference.iter().enumerate() {
            let segment = self.segment(states, i);
            let step = SLOPE_STEP * self.laws(i).length;
            let step = if delta + step < segment.upper { step } else { -step };
            places.push(delta + step);
        }
        self.respond(states, places, shifted);
        slopes.resize(self.count(), 0.0);
        for i in 0..self.count() {
            let segment = self.segment(states, i);
            let is_within = interference[i] >= segment.lower && interference[i] <= segment.upper;
            let change =
                (shifted.contact[i] - forces.contact[i]) - (shifted.adhesion[i] - forces.adhesion[i]);
            slopes[i] = if is_within { change / (places[i] - interference[i]) } else { 0.0 };
        }
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

fn put(forces: &mut Forces, i: usize, [adhesion, contact, area]: [f64; 3]) {
    (forces.adhesion[i], forces.contact[i], forces.area[i]) = (adhesion, contact, area);
}

/// The place in a segment, strictly, that is closest to an interference, m: at an end itself a law may be
/// another.
fn within(segment: &Segment, interference: f64) -> f64 {
    interference.max(segment.lower.next_up()).min(segment.upper.next_down())
}

/// Sorts things by their numbers, which are below `most`, and says where those of each begin, and at last how
/// many there are.
fn sorted(
    numbers: impl ExactSizeIterator<Item = usize> + Clone,
    most: usize,
    order: &mut Vec<u32>,
) -> Vec<usize> {
    let mut starts = vec![0; most + 1];
    numbers.clone().for_each(|number| starts[number + 1] += 1);
    (0..most).for_each(|k| starts[k + 1] += starts[k]);
    order.resize(numbers.len(), 0);
    let mut next = starts.clone();
    for (i, number) in numbers.enumerate() {
        order[next[number]] = i as u32;
        next[number] += 1;
    }
    starts
}
