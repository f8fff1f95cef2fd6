//! Replicas whose asperities are coupled through the half-space under them.

use super::asperity_states::{AsperityState, AsperityStates, drawn};
use super::curves::{CoupledCurves, Curves, RegimeSums};
use super::job::{Ends, Job, Substrate, Ways};
use super::least_force::{Known, least_force};
use super::replica::{CoupledReplica, Replica};
use super::search::Sought;
use super::state::{Branch, Reversal};
use super::stream::{Purpose, stream};
use super::summed::{Contacts, Summed};
use crate::asperity::hysteresis::{Hysteresis, MaybeOwned};
use crate::asperity::{Quantity, SolverStats, SurfaceLoops};
use crate::coupled::{Asperities, HalfSpace, RadiusLaws, Settled, Snapshot, Solver, distinct, energy_class};
use crate::math::extrema::{Extremum, largest_secant, smallest};
use crate::substrate::Kernel;
use std::f64::consts::PI;

/// Halvings of the distances from the samples next to a pull-off that they miss.
const HALVINGS: i32 = 6;
/// Share of a pull-off up to which samples may miss it.
const MISSED: f64 = 0.01;

/// Halvings of a step to a separation at which no stable state is found.
const SHORTER: u32 = 3;

/// A surface that is moved from separation to separation.
struct CoupledSurface<'a> {
    job: &'a Job<'a>,
    solver: Solver<'a>,
    /// m.
    side: f64,
    /// The outcome at the last separation that was reached, and the energy, J, that the parts of the step to it before its
    /// last lost.
    settled: Settled,
    lost_before: f64,
    /// The unit of energy, J, where that is known.
    energy: Option<f64>,
    regimes: Vec<RegimeSums>,
    highest: f64,
    /// The first contact on approach, and the last on retraction.
    contacts: Contacts,
    /// Where the pull-off is sought on approach and on retraction.
    starts: [Starts; 2],
    /// The states at each separation of the approach, if surfaces turn back at preloads.
    approach: Vec<Snapshot>,
    /// Where the pull-off is sought on the last retraction from a preload.
    turned: Option<Starts>,
    /// Largest error of a pull-off between separations, relative to it.
    tolerance: f64,
    recorded: Option<Recorded<'a>>,
}

/// The states from which the pull-off is sought on a branch.
struct Starts {
    /// The separation h, m, of the pull-off of independent asperities, if the separations miss it; NaN if not.
    missed: f64,
    /// The smallest sample, and the one nearest to what is missed.
    least: [Option<Start>; 2],
}

/// A sample next to which the pull-off is sought.
struct Start {
    /// Its force, N, or its distance from what is missed, m.
    score: f64,
    before: Snapshot,
    /// The state there, once the surface has gone on.
    at: Option<Snapshot>,
}

impl Starts {
    fn new(missed: f64) -> Self {
        Self { missed, least: [None, None] }
    }

    /// What is least of a sample (h, m, and force, N) where the pull-off is looked for.
    fn scores(&self, (h, force): (f64, f64)) -> [f64; 2] {
        [force, (h - self.missed).abs()]
    }

    /// Takes the next sample of the way, with the state before it.
    fn see(&mut self, sample: (f64, f64), before: &Snapshot) {
        let scores = self.scores(sample);
        for (least, score) in self.least.iter_mut().zip(scores) {
            if score < least.as_ref().map_or(f64::INFINITY, |least| least.score) {
                *least = Some(Start { score, before: before.clone(), at: None });
            } else if let Some(Start { at: at @ None, .. }) = least {
                *at = Some(before.clone());
            }
        }
    }
}

/// The asperities of a surface that are recorded one by one.
struct Recorded<'a> {
    /// Indices of the separations.
    at: &'a [usize],
    /// The number of each among those that were drawn.
    order: Vec<u32>,
    states: Box<AsperityStates>,
}

/// A replica without coupling, its index and its curves.
pub(super) struct Independent {
    pub index: u64,
    pub kept: Replica,
    pub curves: Curves,
}

/// A replica with coupling, its curves and the cost of that.
pub(super) struct Coupled {
    pub kept: Replica,
    pub curves: Curves,
    pub stats: SolverStats,
}

impl Independent {
    /// Its record, with the stiffness from lines between the separations, as with coupling: else they could
    /// not be compared.
    fn by_lines(&self, job: &Job<'_>) -> Replica {
        let mut replica = self.kept.clone();
        if let Some(span) = job.protocol.stiffness_span {
            let external = &self.curves.total[Quantity::ExternalForce.index()];
            let s = job.separations.len();
            let pulled = &external[job.ways().pulled() * s..][..s];
            replica.stiffest(&largest_secant(job.separations, pulled, span));
        }
        replica
    }

    /// The separations h, m, of its pull-offs on approach and on retraction where samples miss them; else NaN.
    fn missed(&self, job: &Job<'_>) -> [f64; 2] {
        let last = (self.kept.pull_off_force, self.kept.pull_off_separation);
        let first = self
            .kept
            .cycle
            .as_ref()
            .map_or(last, |cycle| (cycle.approach_pull_off_force, cycle.approach_pull_off_separation));
        let external = self.curves.total[Quantity::ExternalForce.index()].chunks(job.separations.len());
        let ways = external.zip([first, last]).map(|(external, (pull_off, place))| {
            let sampled = -external.iter().copied().fold(f64::INFINITY, f64::min);
            if sampled < (1.0 - MISSED) * pull_off { place } else { f64::NAN }
        });
        let mut missed = [f64::NAN; 2];
        missed[job.ways().first()..].iter_mut().zip(ways).for_each(|(place, way)| *place = way);
        missed
    }
}

/// A job whose asperities are coupled through a half-space. When `ends` is true nothing is solved any more,
/// and what comes back is no result.
#[derive(Clone, Copy)]
pub(super) struct CoupledJob<'a> {
    pub job: &'a Job<'a>,
    pub substrate: &'a Substrate<'a>,
    pub ends: Ends<'a>,
}

impl CoupledJob<'_> {
    /// The record of a replica with its asperities coupled; nothing when that was ended.
    pub fn couple(self, independent: Independent) -> Option<Coupled> {
        let Self { job, substrate, ends } = self;
        let (replica, missed) = (independent.by_lines(job), independent.missed(job));
        let Independent { index, curves: of_independent, .. } = independent;
        let side = match job.surface.heights.depths() {
            Some(depths) => depths.side(),
            None => substrate.places.side(job.surface.nominal_area),
        };
        let mut placed = self.placed(index, side);
        let recorded =
            (index == 0 && !substrate.loads_at.is_empty()).then(|| self.recorded(&mut placed, side));
        let Placed { heights, radii, places, .. } = placed;
        let (different, numbers) = distinct(&radii);
        let laws = different.iter().map(|radius| self.laws_of(*radius)).collect();
        let half_space = self.half_space(places, radii, side);
        let mut solver =
            Solver::new(Asperities::new(laws, numbers), half_space, &heights, substrate.tolerance);
        solver.ends = ends;
        let r = job.laws.regimes().len();
        let mut surface = CoupledSurface {
            job,
            solver,
            side,
            settled: Settled::default(),
            lost_before: 0.0,
            energy: substrate.energy,
            regimes: vec![RegimeSums::default(); r],
            highest: heights.last().copied().unwrap_or(f64::NAN),
            contacts: Contacts { touchdown: f64::NAN, detachment: f64::NAN },
            starts: missed.map(Starts::new),
            approach: Vec::new(),
            turned: None,
            tolerance: substrate.pull_off_tolerance,
            recorded,
        };
        let mut curves = Curves::new(job.states(), r);
        let mut coupled = CoupledCurves::new(&of_independent);
        surface.travel(&mut curves, &mut coupled);
        if job.ways().is_loop() {
            surface.contacts = contacts(job, &curves);
        }
        let mut kept = Replica::new(job, &mut surface, heights.len(), &mut curves);
        let stats = surface.solver.take_stats();
        let asperities = surface.recorded.map(|recorded| recorded.states);
        kept.coupled =
            Some(Box::new(CoupledReplica { asperities, ..CoupledReplica::new(replica, &coupled) }));
        curves.coupled = Some(Box::new(coupled));
        (!ends()).then_some(Coupled { kept, curves, stats })
    }

    /// The asperities of the replica of an index, on a surface of a side, m.
    fn placed(self, index: u64, side: f64) -> Placed {
        let Self { job, substrate, .. } = self;
        let (mut heights, mut radii) = (Vec::new(), Vec::new());
        let under_body = job.draw(index).placed(job.surface, &mut heights, &mut radii);
        let places = match under_body {
            Some(places) => places.into_iter().map(|place| place.map(|x| 0.5 + x / side)).collect(),
            None => {
                let random = &mut stream(job.seed, Purpose::Places, index);
                substrate.places.draw(random, (heights.len(), side), substrate.coupling)
            }
        };
        let mut order: Vec<u32> = (0..heights.len() as u32).collect();
        order.sort_by(|a, b| heights[*a as usize].total_cmp(&heights[*b as usize]));
        let radius = |i: usize| radii.get(i).copied().unwrap_or(job.surface.asperity_radius);
        let numbers = || order.iter().map(|i| *i as usize);
        Placed {
            heights: numbers().map(|i| heights[i]).collect(),
            radii: numbers().map(radius).collect(),
            places: numbers().map(|i| places[i]).collect(),
            order,
        }
    }

    /// The record of asperities one by one, no state yet, which takes their order.
    fn recorded(&self, placed: &mut Placed, side: f64) -> Recorded<'_> {
        let order = std::mem::take(&mut placed.order);
        let states = AsperityStates {
            places: drawn(&placed.places, &order).into_iter().map(|place| place.map(|x| x * side)).collect(),
            heights: drawn(&placed.heights, &order),
            radii: drawn(&placed.radii, &order),
            states: Vec::new(),
        };
        Recorded { at: self.substrate.loads_at, order, states: Box::new(states) }
    }

    /// The half-space under asperities at places, in sides of the surface, m, of radii, m.
    fn half_space(self, places: Vec<[f64; 2]>, radii: Vec<f64>, side: f64) -> HalfSpace {
        let Substrate { coupling, kernel, tolerance, reduced_modulus, .. } = *self.substrate;
        let points = HalfSpace::new(coupling, places, 1.0 / (PI * reduced_modulus * side), tolerance);
        let half_space = match kernel {
            Kernel::Point => points,
            Kernel::Contact => points.with_contacts(side, radii),
        };
        // A second thread for each surface.
        half_space.shared(rayon::current_num_threads() as u64 >= 2 * self.job.replicas)
    }

    /// The laws of the asperities of a radius, m.
    fn laws_of(&self, radius: f64) -> RadiusLaws<'_> {
        let Self { job, substrate, .. } = self;
        let memory = match (substrate.memory, job.laws.family) {
            (Some(SurfaceLoops::All(cycle)), _) => Hysteresis::Loop(MaybeOwned::Shared(cycle)),
            (Some(SurfaceLoops::OfRadius(loop_of)), _) => {
                Hysteresis::Loop(MaybeOwned::Own(Box::new(loop_of(radius))))
            }
            (None, Some(family)) => Hysteresis::None(MaybeOwned::Own(family.law(radius))),
            (None, None) => Hysteresis::None(MaybeOwned::Shared(job.laws.typical)),
        };
        // Of elastic laws, s_δ ~ R^(1/3).
        RadiusLaws::new(memory, substrate.length * libm::cbrt(radius / job.surface.asperity_radius))
    }
}

/// The asperities of a replica with their places, rising in height: sorted heights have their neighbours in
/// the law as neighbours in memory.
struct Placed {
    heights: Vec<f64>,
    radii: Vec<f64>,
    /// In sides of the surface.
    places: Vec<[f64; 2]>,
    /// The number of each among those that were drawn.
    order: Vec<u32>,
}

/// The separations h, m, of the samples of a loop at which the first contact is there on approach, and the last
/// one on retraction; NaN without one.
fn contacts(job: &Job<'_>, curves: &Curves) -> Contacts {
    let (s, states) = (job.separations.len(), job.states());
    let touches = |state: usize| {
        let mut counts = job.laws.regimes().iter().zip(curves.regime_count.chunks_exact(states));
        counts.any(|(regime, count)| regime.is_contact() && count[state] > 0.0)
    };
    let furthest = |first: usize| {
        let found = (0..s).rev().find(|k| touches(first + k));
        found.map_or(f64::NAN, |k| job.separations[k])
    };
    Contacts { touchdown: furthest(0), detachment: furthest(s) }
}

impl CoupledSurface<'_> {
    /// Takes the surface through all states of the job.
    fn travel(&mut self, curves: &mut Curves, coupled: &mut CoupledCurves) {
        let (s, ways) = (self.job.separations.len(), self.job.ways());
        self.solver.begin(self.job.surface.asperity_separation(self.job.separations[s - 1]));
        match ways {
            Ways::Back => {
                for k in (0..s).rev() {
                    self.go(self.job.separations[k]);
                }
            }
            _ => self.pass((0..s).rev().collect(), (0, 0), curves, coupled),
        }
        if ways != Ways::One {
            self.pass((0..s).collect(), (1, ways.pulled() * s), curves, coupled);
        }
        if ways == Ways::Repeated {
            self.pass((0..s).rev().collect(), (2, 2 * s), curves, coupled);
        }
    }

    /// Takes the surface through separations, by their numbers, on a way of a loop, by its number, as states from `first` on.
    fn pass(
        &mut self,
        separations: Vec<usize>,
        (way, first): (usize, usize),
        curves: &mut Curves,
        coupled: &mut CoupledCurves,
    ) {
        let keeps_all = way == 0 && !self.job.protocol.loading.preload.is_empty();
        for k in separations {
            let h = self.job.separations[k];
            let (force, before) = self.go(h);
            self.record(first + k, curves, coupled);
            if let Some(starts) = self.starts.get_mut(way) {
                starts.see((h, force), &before);
            }
            if keeps_all {
                self.approach.push(self.solver.snapshot());
            }
        }
    }

    /// Goes to a separation h, m; the external force there, N, and the state before.
    fn go(&mut self, h: f64) -> (f64, Snapshot) {
        let before = self.solver.snapshot();
        if !(self.solver.ends)() {
            let d = self.job.surface.asperity_separation(h);
            (self.settled, self.lost_before) = self.solver.reach(d, SHORTER);
        }
        (self.job.surface.external_force(h, self.solver.external_force()), before)
    }

    /// Hands the present state over as one of the curves.
    fn record(&mut self, state: usize, curves: &mut Curves, coupled: &mut CoupledCurves) {
        if (self.solver.ends)() {
            return;
        }
        self.regimes.fill(RegimeSums::default());
        let Solver { states, forces, .. } = &self.solver;
        for i in 0..forces.adhesion.len() {
            let Some(regime) = self.solver.asperities().regime(states, i) else { continue };
            let sum = &mut self.regimes[regime];
            sum.count += 1.0;
            sum.adhesion.add(forces.adhesion[i]);
            sum.contact.add(forces.contact[i]);
            sum.area.add(forces.area[i]);
        }
        curves.record(state, &self.regimes);
        if let Some(Recorded { at, order, states }) = &mut self.recorded
            && at.contains(&(state % self.job.separations.len()))
        {
            let is_contact = |regime: usize| self.job.laws.regimes()[regime].is_contact();
            states.states.push(AsperityState::of(&self.solver, state, is_contact, order));
        }
        let avalanches = &self.settled.avalanches;
        coupled.avalanche_count[state] = avalanches.count as f64;
        coupled.largest_avalanche[state] = avalanches.largest as f64;
        let sizes = coupled.avalanche_sizes.iter_mut().zip(avalanches.of_class);
        sizes.for_each(|(sum, count)| *sum += u64::from(count));
        let lost = self.energy.map_or(f64::NAN, |_| self.lost_before + self.solver.energy_lost());
        coupled.energy_lost[state] = lost;
        if let Some(unit) = self.energy.filter(|_| lost.is_finite() && lost != 0.0) {
            coupled.energy_classes[energy_class(lost / unit)] += 1;
        }
        coupled.unsettled[state] = f64::from(u8::from(!self.settled.is_converged));
        coupled.crowding[state] = self.solver.crowding(self.side);
    }

    /// The smallest force on a branch, by its number, from samples over the separations of the job in their order on it.
    fn zoom_on(&mut self, way: usize, samples: &[(f64, f64)]) -> Extremum {
        let seen = Starts::new(self.starts[way].missed);
        let starts = std::mem::replace(&mut self.starts[way], seen);
        self.zoom(samples, starts)
    }

    /// The smallest force of samples, in the order of the way, and between the neighbours of the smallest; where independent
    /// asperities are pulled off between samples, near that place, too.
    fn zoom(&mut self, samples: &[(f64, f64)], starts: Starts) -> Extremum {
        let at = |which: usize| {
            smallest(&samples.iter().map(|sample| starts.scores(*sample)[which]).collect::<Vec<f64>>())
        };
        let (smallest, nearest) = (at(0), at(1));
        let [least, next_to_missed] = starts.least;
        let found = self.zoom_at(samples, smallest, least.expect("it has been through all samples"));
        let ends = [nearest.saturating_sub(1), (nearest + 1).min(samples.len() - 1)];
        let [first, last] = ends.map(|i| samples[i]);
        let is_between = (first.0 - starts.missed) * (last.0 - starts.missed) <= 0.0;
        let Some(Start { before, .. }) = next_to_missed.filter(|_| is_between) else { return found };
        self.solver.restore(&before);
        let halved = |end: (f64, f64), i: i32| starts.missed + (end.0 - starts.missed) * 0.5_f64.powi(i);
        let inwards = (1..=HALVINGS).map(|i| halved(first, i)).chain([starts.missed]);
        let places = inwards.chain((1..=HALVINGS).rev().map(|i| halved(last, i)));
        let (mut closer, mut samples) = (Starts::new(f64::NAN), vec![first]);
        for place in places {
            let (force, before) = self.go(place);
            closer.see((place, force), &before);
            samples.push((place, force));
        }
        samples.push(last);
        let other = self.zoom(&samples, closer);
        if other.value < found.value { other } else { found }
    }

    /// The smallest force between the neighbours of one of samples, in the order of the way, from the states at that sample and
    /// before it.
    fn zoom_at(
        &mut self,
        samples: &[(f64, f64)],
        smallest: usize,
        Start { before, at, .. }: Start,
    ) -> Extremum {
        let known = |&(place, force): &(f64, f64)| Known { place, force, state: None };
        let mut known: Vec<Known<Snapshot>> = samples.iter().map(known).collect();
        if let Some(place) = smallest.checked_sub(1) {
            known[place].state = Some(before);
        }
        known[smallest].state = at.or_else(|| Some(self.solver.snapshot()));
        least_force(known, self.tolerance, |from, places| {
            self.solver.restore(from);
            places
                .iter()
                .map(|place| {
                    let (force, _) = self.go(*place);
                    (force, self.solver.snapshot())
                })
                .collect()
        })
    }
}

impl Summed for CoupledSurface<'_> {
    fn highest(&self) -> f64 {
        self.highest
    }

    fn contacts(&mut self, _: Reversal<'_>) -> Contacts {
        self.contacts
    }

    fn retraction(&mut self, Reversal { from, .. }: Reversal<'_>, separations: &[f64]) -> Vec<f64> {
        // The approach was taken from far away.
        let passed = self.job.separations.iter().filter(|h| **h >= from).count();
        self.solver.restore(&self.approach[passed.max(1) - 1]);
        self.go(from);
        let mut starts = Starts::new(self.starts[1].missed);
        let forces = separations.iter().map(|&h| {
            let (force, before) = self.go(h);
            starts.see((h, force), &before);
            force
        });
        let forces = forces.collect();
        self.turned = Some(starts);
        forces
    }

    fn find(&mut self, sought: Sought, branch: Branch<'_>, samples: &[(f64, f64)]) -> Extremum {
        match (sought, branch.reversal()) {
            (Sought::Stiffness(span), _) => {
                let (places, forces): (Vec<f64>, Vec<f64>) = samples.iter().copied().unzip();
                largest_secant(&places, &forces, span)
            }
            (Sought::PullOff, None) => {
                let inward: Vec<(f64, f64)> = samples.iter().rev().copied().collect();
                self.zoom_on(0, &inward)
            }
            (Sought::PullOff, Some(_)) => match self.turned.take() {
                Some(starts) => self.zoom(samples, starts),
                None => self.zoom_on(1, samples),
            },
        }
    }
}
