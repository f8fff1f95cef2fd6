//! Knots: asperities that drive each other to and fro over jumps of their laws.
//!
//! # Formula
//! While all others are displaced as by their slopes, the members of a knot have δ_k = c_k − Σ_l Y_kl f_l. Each is in one of
//! the segments of its law that the jumps part, where f_k = f(δ_k), or at rest at one of the jumps: then δ_k is known,
//! and f_k is between the forces of the two sides. Each choice for all is a system of n equations; the state is a choice
//! whose solution is where it is chosen to be: of several the one with the fewest at rest, first of all where
//! one could remember to be to a side.

use super::asperities::{Rest, SLOPE_STEP};
use super::solver::Solver;
use super::systems::{CLOSEST, System};
use crate::math::lu::Lu;

/// Most choices that are tried: members that drive least are left out.
const MOST: usize = 2500;
/// Most neighbours of a knot that are displaced with it.
const NEIGHBOURS: usize = 150;
/// Knots of one asperity after which all others are displaced with it, and after which no more steps are worth it.
const AGAIN: (u8, u8) = (2, 5);
/// Relative residual of systems of all.
const SYSTEM: f64 = 1e-2;
/// Least yielding of one at rest, over its yielding to others: it is the unit of its force in systems.
const LEAST: f64 = 1e-3;
/// Steps of Newton's method for a choice, and the last of them at most, over the distance that forces drive.
const STEPS: usize = 12;
const STILL: f64 = 1e-6;

/// A state that a member of a knot can be in.
#[derive(Clone, Copy, Debug)]
pub enum Choice {
    /// A place in a segment.
    In {
        /// Number of the segment.
        segment: u8,
        /// δ, m, between which it can be there.
        ends: [f64; 2],
        /// δ, m, between which it must be, unless it remembers.
        jumps: [f64; 2],
    },
    /// Rest at a jump.
    At {
        /// δ, m.
        place: f64,
        /// f below and above, N.
        forces: [f64; 2],
        /// Whether the two sides end elsewhere: the asperity remembers.
        is_hysteretic: bool,
    },
}

/// A state of the members of a knot.
#[derive(Clone, Debug)]
pub struct Untied {
    /// The number of the choice of each.
    pub choices: Vec<usize>,
    /// δ, m.
    pub places: Vec<f64>,
    /// f, N.
    pub forces: Vec<f64>,
    /// The distance by which each is lowered, m/N, when it pushes and the other ones are displaced.
    pub yielding: Vec<f64>,
}

/// A state of the members of a knot, if there is one, by the choices of each, c, m, and Y, m/N (row by row);
/// `law` gives f, N, and df/dδ, N/m, of a member in a segment at δ, m.
pub fn untied(
    choices: &[Vec<Choice>],
    (still, yielding): (&[f64], &[f64]),
    mut law: impl FnMut(usize, u8, f64) -> [f64; 2],
) -> Option<Untied> {
    let mut best: Option<([usize; 3], Untied)> = None;
    let mut numbers = vec![0; choices.len()];
    loop {
        let chosen: Vec<Choice> = numbers.iter().zip(choices).map(|(number, own)| own[*number]).collect();
        // A law with a root has two solutions: from either end of a segment one is found.
        for side in 0..2 {
            let found = stand(&chosen, side, (still, yielding), &mut law);
            if let Some((cost, untied)) = found.and_then(|untied| Some((cost(&chosen, &untied)?, untied)))
                && best.as_ref().is_none_or(|(least, _)| cost < *least)
            {
                best = Some((cost, Untied { choices: numbers.clone(), ..untied }));
            }
        }
        let Some(next) = numbers.iter().zip(choices).position(|(number, own)| number + 1 < own.len()) else {
            return best.map(|(_, untied)| untied);
        };
        numbers[..next].fill(0);
        numbers[next] += 1;
    }
}

/// The state in which members are where they are chosen to be, or beyond their ends, by Newton's method from
/// one side of segments.
// One step of the method: rows, solution and end all take its equations.
fn stand(
    chosen: &[Choice],
    side: usize,
    (still, yielding): (&[f64], &[f64]),
    law: &mut impl FnMut(usize, u8, f64) -> [f64; 2],
) -> Option<Untied> {
    let count = chosen.len();
    let begin = |choice: &Choice| match *choice {
        Choice::In { jumps, .. } if jumps[side].is_finite() => jumps[side],
        Choice::In { jumps, .. } => jumps[1 - side],
        Choice::At { place, .. } => place,
    };
    let mut places: Vec<f64> = chosen.iter().map(begin).collect();
    for _ in 0..STEPS {
        // f + K Y f = f(δ) + K (c − δ) at the last δ, or Y f = c − δ of one at rest.
        let (mut factors, mut right) = (Vec::with_capacity(count), Vec::with_capacity(count));
        for (k, choice) in chosen.iter().enumerate() {
            let (own, factor, equals) = match *choice {
                Choice::At { place, .. } => {
                    let scale = 1.0 / largest(&yielding[k * count..][..count]);
                    (0.0, scale, scale * (still[k] - place))
                }
                Choice::In { segment, .. } => {
                    let [force, slope] = law(k, segment, places[k]);
                    (1.0, slope, force + slope * (still[k] - places[k]))
                }
            };
            factors.push([own, factor]);
            right.push(equals);
        }
        let response = |k: usize, l: usize| yielding[k * count + l];
        let diagonal = |k: usize, l: usize, own: f64| if k == l { own } else { 0.0 };
        let of_forces = |k, l| response(k, l) * factors[k][1] + diagonal(k, l, factors[k][0]);
        let forces = Lu::new(count, of_forces).solved(right)?;
        let drives = |k: usize| (0..count).map(|l| response(k, l) * forces[l]).sum();
        let driven: Vec<f64> = (0..count).map(drives).collect();
        let moved = (0..count).fold(0.0, |most: f64, k| most.max((still[k] - driven[k] - places[k]).abs()));
        places = still.iter().zip(&driven).map(|(still, driven)| still - driven).collect();
        if moved <= STILL * largest(&driven) {
            // 1 + Y K, where those at rest have no slope.
            let of_others = |k, l| response(k, l) * (factors[l][0] * factors[l][1]) + diagonal(k, l, 1.0);
            let others = Lu::new(count, of_others);
            let own = |k: usize| Some(others.solved((0..count).map(|l| response(l, k)).collect())?[k]);
            let yielding = (0..count).map(own).collect::<Option<_>>()?;
            return Some(Untied { choices: Vec::new(), places, forces, yielding });
        }
    }
    None
}

/// The numbers of members that are at rest where they remember, that are where they can be only if they
/// remember, and that are at rest elsewhere; none where one cannot be.
fn cost(chosen: &[Choice], untied: &Untied) -> Option<[usize; 3]> {
    let mut cost = [0; 3];
    for (choice, (place, force)) in chosen.iter().zip(untied.places.iter().zip(&untied.forces)) {
        let is_between = |ends: &[f64; 2]| *place >= ends[0] && *place < ends[1];
        match choice {
            Choice::In { jumps, .. } if is_between(jumps) => (),
            Choice::In { ends, .. } if is_between(ends) => cost[1] += 1,
            Choice::At { forces, is_hysteretic, .. } if (0.0..=1.0).contains(&share(forces, *force)) => {
                cost[if *is_hysteretic { 0 } else { 2 }] += 1;
            }
            _ => return None,
        }
    }
    Some(cost)
}

/// The largest of some numbers, without their signs.
fn largest(of: &[f64]) -> f64 {
    of.iter().fold(0.0, |most, x| most.max(x.abs()))
}

/// Share of the upper of two forces in one between, N.
fn share(forces: &[f64; 2], force: f64) -> f64 {
    (force - forces[0]) / (forces[1] - forces[0])
}

/// An asperity in a knot, with the jumps that it goes over.
type Member = (u32, Vec<Rest>);

impl Solver<'_> {
    /// Moves asperities that drive each other over jumps to places from which none of them would pass, if
    /// there are any: forces, slopes and residuals belong to the present state. Near neighbours are displaced, and
    /// the others follow in the next step, unless that has not helped. Says whether more steps are worth it.
    pub(super) fn untie(&mut self) -> bool {
        let (driven, mut is_worth) = (self.driven(), false);
        let mut moved = vec![false; self.heights.len()];
        for first in driven.iter().map(|(i, _)| *i as usize) {
            if self.passages.goes_to_and_fro(first) {
                let (members, choices) = self.knot(first, &driven);
                let before = self.passages.knots_of(first);
                let is_local = before < AGAIN.0;
                let near = self.around(&members, is_local);
                // What has moved has no residual now; if need be its turn comes again.
                if !near.iter().any(|i| moved[*i]) {
                    near.iter().for_each(|i| moved[*i] = true);
                    is_worth |= before < AGAIN.1;
                    self.untie_one(first, &near, is_local, &members, &choices);
                }
            }
        }
        is_worth
    }

    /// Unties one knot, with the asperities that are displaced.
    fn untie_one(
        &mut self,
        first: usize,
        near: &[usize],
        is_local: bool,
        members: &[Member],
        choices: &[Vec<Choice>],
    ) {
        let of: Vec<usize> = members.iter().map(|(i, _)| *i as usize).collect();
        let count = of.len();
        for &i in &of {
            self.states.resting.remove(&(i as u32));
            (self.slopes[i], self.taken.places[i]) = (0.0, f64::NAN);
        }
        let responses = if is_local { self.local(near, &of) } else { Some(self.global(near, &of)) };
        let Some((steps, responses)) = responses else { return self.passages.untied(first) };
        let loads: Vec<f64> = of.iter().map(|i| self.external[*i]).collect();
        let at = |k: usize| {
            let by_loads = loads.iter().zip(&responses).map(|(load, response)| response[k] * load);
            self.interference[of[k]] + steps[k] - by_loads.sum::<f64>()
        };
        let still: Vec<f64> = (0..count).map(at).collect();
        let yielding: Vec<f64> = (0..count).flat_map(|k| responses.iter().map(move |by| -by[k])).collect();
        let law = |k: usize, segment: u8, delta: f64| self.load_and_slope(of[k], segment, delta);
        let Some(untied) = untied(choices, (&still, &yielding), law) else {
            // The next knot has its turn.
            return self.passages.untied(first);
        };
        let changes: Vec<f64> = untied.forces.iter().zip(&loads).map(|(force, load)| force - load).collect();
        for (k, (i, step)) in near.iter().zip(steps).enumerate() {
            let step =
                step + changes.iter().zip(&responses).map(|(by, lowered)| lowered[k] * by).sum::<f64>();
            match self.states.resting.get_mut(&(*i as u32)) {
                Some(rest) => rest.share += rest.stiffness * step / (rest.ends[1] - rest.ends[0]),
                None => self.interference[*i] += step,
            }
        }
        self.put(members, choices, &untied, &yielding);
    }

    /// Puts the members of a knot where they have been untied, by the displacements that their forces cause.
    fn put(&mut self, members: &[Member], choices: &[Vec<Choice>], untied: &Untied, yielding: &[f64]) {
        let count = members.len();
        for (k, (i, rests)) in members.iter().enumerate() {
            let segment = match choices[k][untied.choices[k]] {
                Choice::In { segment, .. } => segment,
                Choice::At { forces, .. } => {
                    let rest = rests.iter().find(|rest| rest.ends == forces).expect("choices are of rests");
                    let share = share(&forces, untied.forces[k]);
                    // By itself it may not yield at all.
                    let by_others = largest(&yielding[k * count..][..count]);
                    let own = untied.yielding[k].abs().max(LEAST * by_others).copysign(untied.yielding[k]);
                    self.states.resting.insert(*i, Rest { share, stiffness: 1.0 / own, ..*rest });
                    rest.segments[usize::from(share >= 0.5)]
                }
            };
            self.states.segments[*i as usize] = segment;
            self.interference[*i as usize] = untied.places[k];
            self.passages.untied(*i as usize);
        }
    }

    /// The members of a knot, and the asperities near them that are displaced most by their forces, or all others.
    pub(super) fn around(&self, members: &[Member], is_local: bool) -> Vec<usize> {
        let of: Vec<usize> = members.iter().map(|(i, _)| *i as usize).collect();
        if !is_local {
            let others = (0..self.heights.len()).filter(|i| !of.contains(i)).collect::<Vec<_>>();
            return of.into_iter().chain(others).collect();
        }
        let near = self.unshifted().giving_way(&self.half_space, &of, NEIGHBOURS);
        of.into_iter().chain(near).collect()
    }

    /// The system of the present state.
    fn unshifted(&self) -> System<'_> {
        System { slopes: &self.slopes, resting: &self.states.resting, shift: 0.0 }
    }

    /// Steps of Newton's method, m, of the asperities `near` while all others stay, and their responses to
    /// each of some of them, m/N.
    pub(super) fn local(&self, near: &[usize], of: &[usize]) -> Option<(Vec<f64>, Vec<Vec<f64>>)> {
        let system = self.unshifted();
        let matrix = system.transposed(&self.half_space, near);
        let steps = matrix.solved(near.iter().map(|i| -self.residual[*i]).collect())?;
        let influence = |j: usize| near.iter().map(move |i| -self.half_space.influence(*i, j)).collect();
        let responses = of.iter().map(|j| matrix.solved(influence(*j))).collect::<Option<_>>()?;
        Some((steps, responses))
    }

    /// The distance by which the foot of an asperity is lowered when it pushes, m/N: `yielding`, where others give way to
    /// the first order, with the closest ones to all orders.
    pub(super) fn yielding_closely(&self, i: usize, yielding: f64) -> f64 {
        let (half_space, system) = (&self.half_space, self.unshifted());
        let near = system.giving_way(half_space, &[i], CLOSEST);
        if near.is_empty() {
            return yielding;
        }
        let influence: Vec<f64> = near.iter().map(|j| half_space.influence(i, *j)).collect();
        let Some(lowered) = system.transposed(half_space, &near).solved(influence.clone()) else {
            return yielding;
        };
        let terms = near.iter().zip(influence.iter().zip(&lowered));
        let further: f64 = terms.map(|(j, (own, lowered))| self.slopes[*j] * own * (own - lowered)).sum();
        yielding + further
    }

    /// Steps and responses by a system of all.
    pub(super) fn global(&mut self, near: &[usize], of: &[usize]) -> (Vec<f64>, Vec<Vec<f64>>) {
        let column = |step: &[f64]| near.iter().map(|i| step[*i]).collect();
        self.system(0.0, SYSTEM);
        let steps = column(&self.memory.step);
        let mut unit = vec![0.0; self.heights.len()];
        let response = |i: &usize| {
            unit[*i] = 1.0;
            self.half_space.displace_roughly(&unit, &mut self.residual);
            unit[*i] = 0.0;
            self.system(0.0, SYSTEM);
            column(&self.memory.step)
        };
        (steps, of.iter().map(response).collect())
    }

    /// The asperities that went to and fro, those first that did so most often, with the jumps that are still theirs.
    fn driven(&self) -> Vec<Member> {
        let Self { states, passages, .. } = self;
        let mut driven = passages.driven();
        for (i, rests) in &mut driven {
            // One that has yielded since has other segments.
            rests.retain(|rest| self.asperities.is_jump(states, *i as usize, rest));
        }
        driven.retain(|(_, rests)| !rests.is_empty());
        driven
    }

    /// One of those that went to and fro, with those that did so too or are at rest and drive it most, and where each can
    /// be.
    fn knot(&self, first: usize, driven: &[Member]) -> (Vec<Member>, Vec<Vec<Choice>>) {
        let Self { states, half_space, passages, .. } = self;
        let mut members = driven.to_vec();
        for (i, rest) in &states.resting {
            match members.iter_mut().find(|(j, _)| i == j) {
                Some((_, rests)) if rests.iter().any(|other| other.segments == rest.segments) => (),
                Some((_, rests)) => rests.push(*rest),
                None => members.push((*i, vec![*rest])),
            }
        }
        let size =
            |rests: &[Rest]| rests.iter().map(|rest| (rest.ends[1] - rest.ends[0]).abs()).fold(0.0, f64::max);
        let drives = |(i, rests): &Member| match *i as usize == first {
            true => f64::INFINITY,
            false => half_space.influence(first, *i as usize).abs() * size(rests),
        };
        // Members of knots before where there is room.
        let is_former = |(i, _): &Member| !passages.is_driven(*i) && !states.resting.contains_key(i);
        members.sort_by(|a, b| is_former(a).cmp(&is_former(b)).then(drives(b).total_cmp(&drives(a))));
        let mut choices: Vec<Vec<Choice>> = Vec::new();
        let mut tried = 1;
        for (i, rests) in &members {
            let own = self.choices(*i as usize, rests);
            tried *= own.len();
            if tried > MOST {
                break;
            }
            choices.push(own);
        }
        members.truncate(choices.len());
        (members, choices)
    }

    /// The choices of an asperity that goes over some jumps.
    fn choices(&self, i: usize, rests: &[Rest]) -> Vec<Choice> {
        let Self { asperities, states, .. } = self;
        let mut numbers: Vec<u8> = rests.iter().flat_map(|rest| rest.segments).collect();
        numbers.sort_unstable();
        numbers.dedup();
        let place = |rest: &Rest| asperities.place(i, rest.place);
        let segment = |number: u8| {
            let own = asperities.segments(states, i)[number as usize];
            let ends = [own.lower, own.upper].map(|end| asperities.place(i, end));
            let jump = |side: usize| rests.iter().find(|rest| rest.segments[1 - side] == number).map(place);
            let jumps = std::array::from_fn(|side| jump(side).unwrap_or(ends[side]));
            Choice::In { segment: number, ends, jumps }
        };
        let at = |rest: &Rest| {
            let is_hysteretic = asperities.is_hysteretic(states, i, rest.segments);
            Choice::At { place: place(rest), forces: rest.ends, is_hysteretic }
        };
        numbers.into_iter().map(segment).chain(rests.iter().map(at)).collect()
    }

    /// P − F_s, N, of an asperity in a segment at δ, m, and its slope, N/m: 0 beyond its ends.
    fn load_and_slope(&mut self, i: usize, segment: u8, delta: f64) -> [f64; 2] {
        let Self { asperities, states, .. } = self;
        let step = SLOPE_STEP * asperities.length(i);
        let own = asperities.segments(states, i)[segment as usize];
        let [lower, upper] = [own.lower, own.upper].map(|end| asperities.place(i, end));
        let [place, beside] = match delta.clamp(lower, upper) {
            place if place + step < upper => [place, place + step],
            place => [place, place - step],
        };
        let [force, next] =
            [place, beside].map(|place| asperities.load(states, i, segment, asperities.of_law(i, place)));
        [force, if place == delta { (next - force) / (beside - place) } else { 0.0 }]
    }
}
