//! One replica: one surface, its curves and what is kept of them.

use super::Job;
use super::compressed::{self, LANES};
use super::curves::Curves;
use super::cycle::{Cycle, pull_off_back, snaps};
use super::pull_off::{Jump, jumps};
use super::sampling::{Draws, TRACT, is_divided};
use super::scattered::Scattered;
use super::sums::{RegimeSums, State, Sums};
use super::tracts::Tracts;
use super::whole::Whole;
use crate::asperity::{Quantity, Work};
use crate::math::extrema::{Extremum, steepest_rise};
use crate::math::words::Words;
use std::ops::Range;

/// What is kept of every replica.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Replica {
    /// Number of asperities.
    pub asperity_count: u64,
    /// Highest asperity above the asperity mean plane, m.
    pub highest_asperity: f64,
    /// −min F along its own curve, between the separations too, N.
    pub pull_off_force: f64,
    /// Separation h of the pull-off, m.
    pub pull_off_separation: f64,
    /// Largest dF/dh along its own curve, N/m, at the resolution of the separations.
    pub peak_stiffness: f64,
    /// Separation h of the peak stiffness, m.
    pub peak_stiffness_separation: f64,
    /// Whether the smallest force is at the first or last separation, so that the curve may fall further beyond.
    pub pull_off_at_edge: bool,
    /// What is kept of it as a loop, if it is one; all above is then of the way back.
    pub cycle: Option<Box<Cycle>>,
}

impl Replica {
    fn pull_off(&mut self, smallest: &Extremum) {
        (self.pull_off_force, self.pull_off_separation) = (-smallest.value, smallest.place);
        self.pull_off_at_edge = smallest.at_edge;
    }

    fn stiffest(&mut self, steepest: &Extremum) {
        (self.peak_stiffness, self.peak_stiffness_separation) = (steepest.value, steepest.place);
    }
}

impl Words for Replica {
    fn each_word(&mut self, visit: &mut dyn FnMut(&mut u64)) {
        visit(&mut self.asperity_count);
        self.highest_asperity.each_word(visit);
        self.pull_off_force.each_word(visit);
        self.pull_off_separation.each_word(visit);
        self.peak_stiffness.each_word(visit);
        self.peak_stiffness_separation.each_word(visit);
        let mut at_edge = u64::from(self.pull_off_at_edge);
        visit(&mut at_edge);
        self.pull_off_at_edge = at_edge != 0;
        self.cycle.iter_mut().for_each(|cycle| cycle.each_word(visit));
    }
}

/// A surface of which more is asked when its curves are known.
pub(super) trait Summed {
    /// The highest asperity, m; NaN of none.
    fn highest(&self) -> f64;

    /// The pull-off on its way over the separations of the job, from its external force there, N.
    fn pull_off(&mut self, external_force: &[f64]) -> Extremum;

    /// External forces, N, at separations h, m, rising, on the way back from the separation `from`, m.
    fn back(&mut self, from: f64, separations: &[f64]) -> Vec<f64>;
}

/// Memory that batches reuse one after the other.
pub struct Workspace {
    /// Asperities of a tract, and whether surfaces are summed tract by tract.
    tract: usize,
    is_divided: bool,
    heights: Vec<Vec<f64>>,
    /// Of the surface that is summed, where asperities differ in their radii.
    radii: Vec<f64>,
    scattered: Option<Scattered>,
    jumps: Vec<Jump>,
    sums: Sums,
    compressed: Option<compressed::Sums>,
    /// The curves of the surfaces that were summed last.
    pub curves: Vec<Curves>,
}

impl Workspace {
    /// Memory for replicas of a job.
    pub fn new(job: &Job<'_>) -> Self {
        Self::with_tracts(job, TRACT)
    }

    /// Memory for replicas of a job whose surfaces are drawn, and summed, in tracts of `tract` asperities where they have more.
    pub fn with_tracts(job: &Job<'_>, tract: usize) -> Self {
        let r = job.law.regimes().len();
        let is_divided = is_divided(job.surface, tract);
        let compression = job.compression.filter(|_| !is_divided);
        let at_once = if compression.is_some() { LANES } else { 1 };
        Self {
            tract,
            is_divided,
            heights: vec![Vec::new(); at_once],
            radii: Vec::new(),
            scattered: job.law.family().filter(|_| !is_divided).map(|_| Scattered::new(job)),
            jumps: jumps(job.law),
            sums: Sums::new(r),
            compressed: compression.map(|compression| compressed::Sums::new(compression, r)),
            curves: vec![Curves::new(job.states(), r); at_once],
        }
    }

    /// What the surfaces since the last call have cost.
    pub fn take_work(&mut self) -> Work {
        std::mem::take(&mut self.sums.work)
    }

    /// Draws replicas, sums them over all separations, and visits each with what is kept of it and its curves.
    pub fn replicas(&mut self, job: &Job<'_>, replicas: Range<u64>, visit: impl FnMut(Replica, &Curves)) {
        self.replicas_until(job, replicas, &|| false, visit);
    }

    /// The same, until `ends` is true, which surfaces that are summed tract by tract look at before each: then the replica at hand is not
    /// visited, nor any further one. Whether all were visited.
    pub fn replicas_until(
        &mut self,
        job: &Job<'_>,
        replicas: Range<u64>,
        ends: &(dyn Fn() -> bool + Sync),
        mut visit: impl FnMut(Replica, &Curves),
    ) -> bool {
        if self.is_divided {
            return replicas.into_iter().all(|index| {
                let kept = self.divided(job, index, ends);
                kept.map(|kept| visit(kept, &self.curves[0])).is_some()
            });
        }
        let mut first = replicas.start;
        while first < replicas.end {
            let at_once = (replicas.end - first).min(self.heights.len() as u64);
            for (heights, index) in self.heights.iter_mut().zip(first..first + at_once) {
                Draws::of(job, index, self.tract).all(heights, &mut self.radii);
            }
            self.sum(job, at_once as usize);
            for lane in 0..at_once as usize {
                visit(self.keep(job, lane), &self.curves[lane]);
            }
            first += at_once;
        }
        true
    }

    /// What is kept of a surface that is summed tract by tract; nothing when that was ended.
    fn divided(&mut self, job: &Job<'_>, index: u64, ends: &(dyn Fn() -> bool + Sync)) -> Option<Replica> {
        let draws = Draws::of(job, index, self.tract);
        let mut surface = Tracts::new(job, draws, &self.jumps, ends);
        surface.sum(&mut self.curves[0]);
        let kept = keep(job, &mut surface, draws.count, &mut self.curves[0]);
        self.sums.work.merge(&surface.work);
        (!ends()).then_some(kept)
    }

    /// Sums the first `count` surfaces, whose heights it sorts: rising heights make the regimes contiguous, and neighbours in a slice
    /// neighbours in the law.
    fn sum(&mut self, job: &Job<'_>, count: usize) {
        if let (Some(compression), Some(compressed)) = (job.compression, &mut self.compressed) {
            compressed.take(compression, &self.heights[..count]);
            compressed.fill(compression, job.law, &mut self.curves[..count], &mut self.sums.work);
        }
        if let (Some(family), Some(scattered)) = (job.law.family(), &mut self.scattered) {
            let Sums { scratch, work, .. } = &mut self.sums;
            scattered.surface(family, (&self.heights[0], &self.radii), scratch, work, &mut self.curves[0]);
            return;
        }
        let states = State::all(job);
        for (lane, heights) in self.heights[..count].iter_mut().enumerate() {
            if self.compressed.as_ref().is_some_and(|compressed| compressed.surface(lane).is_some()) {
                continue;
            }
            heights.sort_unstable_by(f64::total_cmp);
            for (k, state) in states.iter().enumerate() {
                self.sums.surface(job, heights, *state);
                RegimeSums::record(&self.sums.regimes, k, &mut self.curves[lane]);
            }
        }
    }

    /// What is kept of a surface that has been summed.
    fn keep(&mut self, job: &Job<'_>, lane: usize) -> Replica {
        let heights = self.heights[lane].as_slice();
        let compressed = job.compression.zip(self.compressed.as_mut());
        let mut surface = Whole {
            job,
            heights,
            radii: &self.radii,
            jumps: &self.jumps,
            highest: heights.iter().copied().reduce(f64::max).unwrap_or(f64::NAN),
            sums: &mut self.sums,
            compressed: compressed
                .filter(|(_, sums)| sums.surface(lane).is_some())
                .map(|(compression, sums)| (compression, sums, lane)),
        };
        keep(job, &mut surface, heights.len(), &mut self.curves[lane])
    }
}

/// What is kept of a surface of `count` asperities whose curves are known; its snaps are left in these.
fn keep(job: &Job<'_>, surface: &mut dyn Summed, count: usize, curves: &mut Curves) -> Replica {
    let external = &curves.total[Quantity::ExternalForce.index()];
    let (external, back) = external.split_at(job.separations.len());
    let pull_off = surface.pull_off(external);
    let highest_asperity = surface.highest();
    let mut kept = Replica { asperity_count: count as u64, highest_asperity, ..Replica::default() };
    let mut last = (external, pull_off);
    if let Some(cycle) = job.protocol.cycle {
        kept.cycle = Some(Box::new(Cycle::new(job, cycle, highest_asperity, [external, back], &pull_off)));
        let samples: Vec<(f64, f64)> = job.separations.iter().copied().zip(back.iter().copied()).collect();
        last = (back, pull_off_back(surface, job.separations[0], &samples));
    }
    kept.pull_off(&last.1);
    kept.stiffest(&steepest_rise(job.separations, last.0));
    if !job.protocol.holding.stiffness.is_empty() {
        curves.snaps = snaps(job, surface, external, last);
    }
    kept
}
