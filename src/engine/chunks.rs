//! Surfaces of more asperities than are held at once: drawn and summed chunk by chunk, in parallel, and drawn
//! again for what is asked later.
//!
//! Every chunk has random streams of its own, so each is the same in whatever order they are drawn; what they
//! give is added up in their order. So memory does not grow with the number of asperities, and results do not
//! depend on the number of threads.

use super::Job;
use super::cells::{Cells, Redrawn, pull_off};
use super::curves::Curves;
use super::force_table::ForceTable;
use super::held::HeldSurface;
use super::kinks::Kinks;
use super::moments::{Between, ChunkMoments, MomentMatrix, MomentSums, Totals};
use super::parts::{deepest_of_parts, stiffest_of_parts};
use super::polydisperse::{Asperities, LaneSums, PulledBack};
use super::sampling::Draws;
use super::summed::{Summed, of_highest};
use super::sums::{RegimeSums, State, Sums};
use crate::asperity::{Family, Loop, SolverStats};
use crate::math::extrema::{Extremum, maximum, minimum};
use crate::math::instruction_set::InstructionSet;
use crate::math::sums::Compensated;
use rayon::prelude::*;
use std::cell::Cell;

/// A surface of at most so many chunks is held for the search of its pull-off: 32 MB.
pub const HELD: usize = 4;
/// Chunks for each thread whose sums may wait to be added.
pub const AHEAD: usize = 8;

/// Whether what is under way has to end.
pub(super) type Ends<'a> = &'a (dyn Fn() -> bool + Sync);

/// A surface that is summed chunk by chunk.
pub(super) struct Chunks<'a> {
    job: &'a Job<'a>,
    draws: Draws<'a>,
    /// The kinks of the law.
    kinks: &'a Kinks,
    table: &'a mut ForceTable,
    ends: Ends<'a>,
    /// All heights, m, rising, once they have been asked for, if they are few enough.
    heights: Vec<f64>,
    /// The highest asperity of the chunks that have been summed, m; NaN of none.
    highest: f64,
    /// The cost so far.
    pub stats: SolverStats,
    /// Moments of the whole surface, where it is summed by them.
    moments: Option<Moments<'a>>,
}

struct Moments<'a> {
    matrix: &'a MomentMatrix,
    totals: Totals,
    sums: MomentSums,
}

/// Memory of a thread for one chunk after the other.
struct Memory {
    heights: Vec<f64>,
    radii: Vec<f64>,
    sums: Sums,
    moments: Option<MomentSums>,
}

thread_local! {
    static MEMORY: Cell<Option<Memory>> = const { Cell::new(None) };
}

impl Memory {
    /// The memory of this thread, for a job.
    fn of(job: &Job<'_>) -> Self {
        let regimes = job.laws.regimes().len();
        let fits = |memory: &Self| {
            let moments = job.moments.zip(memory.moments.as_ref());
            let fits = moments.is_none_or(|(matrix, sums)| sums.fits(matrix, regimes));
            fits && memory.sums.regimes.len() == regimes && job.moments.is_some() == memory.moments.is_some()
        };
        MEMORY.take().filter(fits).unwrap_or_else(|| Self {
            heights: Vec::new(),
            radii: Vec::new(),
            sums: Sums::new(regimes),
            moments: job.moments.map(|matrix| MomentSums::new(matrix, regimes)),
        })
    }

    /// Sums of the chunk that was drawn, by state and regime.
    fn sum(&mut self, job: &Job<'_>, states: &[State]) -> Vec<RegimeSums> {
        let Self { heights, radii, sums, .. } = self;
        match job.laws.family {
            Some(family) => sum_polydisperse(job, family, (heights, radii), sums, states),
            None => {
                heights.sort_unstable_by(f64::total_cmp);
                sum_heights(job, heights, sums, states)
            }
        }
    }

    /// The chunk that was drawn in moments, and sums of those of its asperities that are in no bin, by state
    /// and regime; nothing when all are.
    fn part(&mut self, job: &Job<'_>, matrix: &MomentMatrix) -> (ChunkMoments, Vec<RegimeSums>) {
        let Self { heights, sums, moments, .. } = self;
        let moments = moments.as_mut().expect("memory of a matrix has its sums");
        let mut part = ChunkMoments::new(moments, matrix, job.laws.typical, heights, &mut sums.stats);
        if part.beyond.is_empty() {
            return (part, Vec::new());
        }
        part.beyond.sort_unstable_by(f64::total_cmp);
        let beyond = sum_heights(job, &part.beyond, sums, &State::all(job));
        (part, beyond)
    }

    /// The forces that asperities of the chunk that was drawn add to the external force between separations
    /// beside their moments, N.
    fn rest(&mut self, job: &Job<'_>, matrix: &MomentMatrix, between: &Between) -> Vec<f64> {
        let Self { heights, sums, moments, .. } = self;
        let moments = moments.as_mut().expect("memory of a matrix has its sums");
        between.rest(moments, matrix, job.laws.typical, heights, &mut sums.stats)
    }
}

/// The largest of heights, m; −∞ of none.
fn largest(heights: &[f64]) -> f64 {
    InstructionSet::current().run(
        #[inline(always)]
        || {
            let mut largest = [f64::NEG_INFINITY; 8];
            for chunk in heights.chunks(8) {
                for (largest, u) in largest.iter_mut().zip(chunk) {
                    *largest = if *u > *largest { *u } else { *largest };
                }
            }
            largest.into_iter().fold(f64::NEG_INFINITY, f64::max)
        },
    )
}

/// Sums of heights, m, rising, by state and regime.
fn sum_heights(job: &Job<'_>, heights: &[f64], sums: &mut Sums, states: &[State]) -> Vec<RegimeSums> {
    sums.forget();
    let sum = |state: &State| {
        sums.surface(job, heights, *state);
        sums.regimes.clone()
    };
    states.iter().flat_map(sum).collect()
}

/// Sums of asperities that differ in their radii, by state and regime.
fn sum_polydisperse(
    job: &Job<'_>,
    family: &Family,
    (heights, radii): (&[f64], &[f64]),
    sums: &mut Sums,
    states: &[State],
) -> Vec<RegimeSums> {
    let asperities = Asperities::new(family, heights, radii);
    let mut lane_sums = LaneSums::new(sums.regimes.len());
    let mut pulled: Option<PulledBack> = None;
    let sum = |state: &State| {
        let d = |h: f64| job.surface.asperity_separation(h);
        match state.turned(job) {
            Some((cycle, from, to)) => {
                if pulled.as_ref().is_none_or(|pulled| !pulled.is_of(cycle, from)) {
                    pulled = Some(asperities.turn(job, cycle, from, &mut sums.stats));
                }
                if let Some(pulled) = &pulled {
                    pulled.sum(cycle, None, d(to), &mut lane_sums, &mut sums.stats);
                }
            }
            None => asperities.sum(None, d(state.separation()), &mut lane_sums, &mut sums.stats),
        }
        lane_sums.regimes.clone()
    };
    states.iter().flat_map(sum).collect()
}

impl<'a> Chunks<'a> {
    /// The surface of the replica `draws` of a job, of which nothing is known yet. When `ends` is true what
    /// is under way stops at the next chunk, and whatever comes of it is to be thrown away.
    pub fn new(
        job: &'a Job<'a>,
        draws: Draws<'a>,
        (kinks, table): (&'a Kinks, &'a mut ForceTable),
        ends: Ends<'a>,
    ) -> Self {
        let (heights, highest) = (Vec::new(), f64::NAN);
        Self {
            job,
            draws,
            kinks,
            table,
            ends,
            heights,
            highest,
            stats: SolverStats::default(),
            moments: None,
        }
    }

    /// Sums the surface at all separations into its curves.
    pub fn sum(&mut self, curves: &mut Curves) {
        match self.job.moments {
            Some(matrix) => self.sum_moments(matrix, curves),
            None => {
                let sums = self.states(&State::all(self.job));
                for (k, sums) in sums.chunks_exact(self.job.laws.regimes().len()).enumerate() {
                    RegimeSums::record(sums, k, curves);
                }
            }
        }
    }

    /// Draws all chunks, in parallel, has something made of each, and hands that over in their order.
    fn each<T: Send>(&mut self, of: impl Fn(&mut Memory) -> T + Sync, mut take: impl FnMut(T)) {
        let Self { job, ref draws, ends, .. } = *self;
        let is_first = self.highest.is_nan();
        let one = |chunk: usize| {
            if ends() {
                return None;
            }
            let mut memory = Memory::of(job);
            draws.chunk(chunk, &mut memory.heights, &mut memory.radii);
            let highest = if is_first { largest(&memory.heights) } else { f64::NAN };
            let made = (of(&mut memory), highest, std::mem::take(&mut memory.sums.stats));
            MEMORY.set(Some(memory));
            Some(made)
        };
        let ahead = AHEAD * rayon::current_num_threads();
        for first in (0..draws.chunks()).step_by(ahead) {
            let chunks = first..draws.chunks().min(first + ahead);
            let made: Vec<_> = chunks.into_par_iter().map(one).collect();
            for (made, highest, stats) in made.into_iter().flatten() {
                self.highest = self.highest.max(highest);
                self.stats.merge(&stats);
                take(made);
            }
        }
    }

    /// The answer of the surface with all its heights held, if it is small enough.
    fn held(&mut self, answer: impl FnOnce(&mut HeldSurface<'_>) -> Extremum) -> Option<Extremum> {
        if self.draws.chunks() > HELD || self.job.laws.family.is_some() || (self.ends)() {
            return None;
        }
        if self.heights.is_empty() {
            self.draws.all(&mut self.heights, &mut Vec::new());
            self.heights.sort_unstable_by(f64::total_cmp);
        }
        let job = Job { moments: None, ..*self.job };
        let mut sums = Sums::new(job.laws.regimes().len());
        let mut whole = HeldSurface {
            job: &job,
            heights: &self.heights,
            asperities: None,
            pulled: &mut None,
            kinks: self.kinks,
            table: self.table,
            places: None,
            places_back: None,
            flattened: None,
            highest: self.highest,
            sums: &mut sums,
            moments: None,
        };
        let found = answer(&mut whole);
        self.stats.merge(&sums.stats);
        Some(found)
    }

    /// Sums by state and regime.
    fn states(&mut self, states: &[State]) -> Vec<RegimeSums> {
        let job = self.job;
        let mut sums = vec![RegimeSums::default(); states.len() * job.laws.regimes().len()];
        self.each(|memory| memory.sum(job, states), |part| merge(&mut sums, &part));
        sums
    }

    /// External forces, N, by state.
    fn external_forces_of(&mut self, states: &[State]) -> Vec<f64> {
        let regimes = self.job.laws.regimes().len();
        let (sums, surface) = (self.states(states), self.job.surface);
        let forces = sums.chunks_exact(regimes).map(RegimeSums::external_force);
        forces.zip(states).map(|(force, state)| state.external_force(surface, force)).collect()
    }

    /// Sums the surface by moments.
    fn sum_moments(&mut self, matrix: &'a MomentMatrix, curves: &mut Curves) {
        let (job, regimes) = (self.job, self.job.laws.regimes().len());
        let mut totals = Totals::new(matrix, regimes);
        let mut beyond = vec![RegimeSums::default(); job.states() * regimes];
        self.each(
            |memory| memory.part(job, matrix),
            |(part, others)| {
                totals.add(&part);
                merge(&mut beyond, &others);
            },
        );
        let mut sums = MomentSums::new(matrix, regimes);
        totals.fill(&mut sums, matrix, job.laws.typical, curves, &mut self.stats);
        for (k, beyond) in beyond.chunks_exact(regimes).enumerate() {
            RegimeSums::add(beyond, k, curves);
        }
        self.moments = Some(Moments { matrix, totals, sums });
    }

    /// External forces, N, at separations h, m, from moments and from what has to be solved all the same.
    fn external_forces_by(&mut self, mut moments: Moments<'a>, separations: &[f64]) -> Vec<f64> {
        let job = self.job;
        let Moments { matrix, totals, sums } = &mut moments;
        let d = separations.iter().map(|&h| job.surface.asperity_separation(h)).collect();
        let between = Between::new(totals, sums, matrix, job.laws.typical, d, &mut self.stats);
        let mut forces = vec![Compensated::default(); separations.len()];
        self.each(
            |memory| memory.rest(job, matrix, &between),
            |part| forces.iter_mut().zip(part).for_each(|(force, part)| force.add(part)),
        );
        let forces = forces.iter().zip(&between.smooth).map(|(rest, smooth)| smooth + rest.value());
        let forces = separations.iter().zip(forces).map(|(&h, force)| job.surface.external_force(h, force));
        let forces = forces.collect();
        self.moments = Some(moments);
        forces
    }
}

/// Adds sums of other asperities, where there are any.
fn merge(sums: &mut [RegimeSums], others: &[RegimeSums]) {
    sums.iter_mut().zip(others).for_each(|(sum, other)| sum.merge(other));
}

impl Redrawn for Chunks<'_> {
    fn count(&self, low: f64, high: f64) -> f64 {
        self.draws.count as f64 * self.job.surface.heights.probability(low, high)
    }

    fn highest(&self) -> f64 {
        maximum(self.highest, f64::NEG_INFINITY)
    }

    fn external_forces(&mut self, separations: &[f64]) -> Vec<f64> {
        if separations.is_empty() {
            return Vec::new();
        }
        match self.moments.take() {
            Some(moments) => self.external_forces_by(moments, separations),
            None => {
                let states: Vec<State> = separations.iter().map(|&h| State::Approach(h)).collect();
                self.external_forces_of(&states)
            }
        }
    }

    fn count_in(&mut self, cells: &Cells<'_>) {
        self.each(|memory| cells.count(&memory.heights), |()| {});
    }
}

impl Summed for Chunks<'_> {
    fn highest(&self) -> f64 {
        self.highest
    }

    fn contacts(&mut self, cycle: &Loop) -> (f64, f64) {
        let job = self.job;
        let Some(family) = job.laws.family else { return of_highest(job, cycle, self.highest) };
        let of = |memory: &mut Memory| {
            let Memory { heights, radii, sums, .. } = memory;
            let asperities = Asperities::new(family, heights, radii);
            let pulled = asperities.turn(job, cycle, job.separations[0], &mut sums.stats);
            (asperities.touchdown(cycle), pulled.detachment(cycle))
        };
        let (mut touchdown, mut detachment) = (f64::NAN, f64::NAN);
        self.each(of, |(touched, detached)| {
            (touchdown, detachment) = (touchdown.max(touched), detachment.max(detached));
        });
        (touchdown + job.surface.mean_plane_offset, detachment)
    }

    fn pull_off(&mut self, external_force: &[f64]) -> Extremum {
        let job = self.job;
        if let Some(found) = self.held(|whole| whole.pull_off(external_force)) {
            return found;
        }
        if job.laws.family.is_none() {
            return pull_off(job, &self.kinks.approach, self, external_force);
        }
        let sampled = minimum(job.separations, external_force);
        if sampled.at_edge {
            return sampled;
        }
        deepest_of_parts(&job.samples(external_force), |places| self.external_forces(places))
    }

    fn retraction(&mut self, from: f64, separations: &[f64]) -> Vec<f64> {
        let states: Vec<State> = separations.iter().map(|&to| State::Retraction { from, to }).collect();
        self.external_forces_of(&states)
    }

    fn stiffest(&mut self, from: Option<f64>, samples: &[(f64, f64)], span: f64) -> Extremum {
        let state = |&to: &f64| from.map_or(State::Approach(to), |from| State::Retraction { from, to });
        let found = self.held(|whole| whole.stiffest(from, samples, span));
        found.unwrap_or_else(|| {
            stiffest_of_parts(samples, span, |places| {
                self.external_forces_of(&places.iter().map(state).collect::<Vec<State>>())
            })
        })
    }

    fn retraction_pull_off(&mut self, from: f64, samples: &[(f64, f64)]) -> Extremum {
        let found = self.held(|whole| whole.retraction_pull_off(from, samples));
        found.unwrap_or_else(|| deepest_of_parts(samples, |places| self.retraction(from, places)))
    }
}
