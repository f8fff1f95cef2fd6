//! One replica: one surface, its curves and what is kept of them.

use super::Job;
use super::compressed::{self, Compression, LANES};
use super::curves::Curves;
use super::cycle::{Cycle, WayBack, snaps};
use super::pull_off::{Heights, Jump, jumps, pull_off};
use super::sampling::draw;
use super::scattered::{self, Scattered};
use crate::asperity::{Law, Quantity, Scratch, Work, for_each_block_of, regime_ranges};
use crate::math::extrema::{Extremum, steepest_rise};
use crate::math::instruction_set::InstructionSet;
use crate::math::sums::{Compensated, lane_sum};
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

/// Memory that batches reuse one after the other.
pub struct Workspace {
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
        let r = job.law.regimes().len();
        let at_once = if job.compression.is_some() { LANES } else { 1 };
        Self {
            heights: vec![vec![0.0; job.surface.asperity_count]; at_once],
            radii: Vec::new(),
            scattered: job.law.family().map(|_| Scattered::new(job)),
            jumps: jumps(job.law),
            sums: Sums { regimes: vec![RegimeSums::default(); r], scratch: Scratch::default(), work: Work::default() },
            compressed: job.compression.map(|compression| compressed::Sums::new(compression, r)),
            curves: vec![Curves::new(job.states(), r); at_once],
        }
    }

    /// What the surfaces since the last call have cost.
    pub fn take_work(&mut self) -> Work {
        std::mem::take(&mut self.sums.work)
    }

    /// Draws replicas, sums them over all separations, and visits each with what is kept of it and its curves.
    pub fn replicas(&mut self, job: &Job<'_>, replicas: Range<u64>, mut visit: impl FnMut(Replica, &Curves)) {
        let mut first = replicas.start;
        while first < replicas.end {
            let at_once = (replicas.end - first).min(self.heights.len() as u64);
            for (heights, index) in self.heights.iter_mut().zip(first..first + at_once) {
                draw(job.surface, job.seed, job.scheme, index, heights, &mut self.radii);
            }
            self.sum(job, at_once as usize);
            for lane in 0..at_once as usize {
                visit(self.keep(job, lane), &self.curves[lane]);
            }
            first += at_once;
        }
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
        for (lane, heights) in self.heights[..count].iter_mut().enumerate() {
            if self.compressed.as_ref().is_some_and(|compressed| compressed.surface(lane).is_some()) {
                continue;
            }
            heights.sort_unstable_by(f64::total_cmp);
            for k in 0..job.separations.len() {
                self.sums.surface(job, heights, job.separations[k]);
                RegimeSums::record(&self.sums.regimes, k, &mut self.curves[lane]);
            }
            let Some(cycle) = job.protocol.cycle else { continue };
            let back = WayBack::new(job, cycle, heights, job.separations[0]);
            for (k, &separation) in job.separations.iter().enumerate() {
                back.sum(&mut self.sums, separation);
                RegimeSums::record(&self.sums.regimes, job.separations.len() + k, &mut self.curves[lane]);
            }
        }
    }

    /// What is kept of a surface that has been summed.
    fn keep(&mut self, job: &Job<'_>, lane: usize) -> Replica {
        let (highest, pull_off) = (self.highest(lane), self.pull_off(job, lane));
        let heights = &self.heights[lane];
        let external = &self.curves[lane].total[Quantity::ExternalForce.index()];
        let (external, back) = external.split_at(job.separations.len());
        let mut kept =
            Replica { asperity_count: heights.len() as u64, highest_asperity: highest, ..Replica::default() };
        let mut last = (external, pull_off);
        if let Some(cycle) = job.protocol.cycle {
            kept.cycle = Some(Box::new(Cycle::new(job, cycle, heights, [external, back], &pull_off)));
            let way = WayBack::new(job, cycle, heights, job.separations[0]);
            let samples: Vec<(f64, f64)> = job.separations.iter().copied().zip(back.iter().copied()).collect();
            last = (back, way.pull_off(&mut self.sums, &samples));
        }
        kept.pull_off(&last.1);
        kept.stiffest(&steepest_rise(job.separations, last.0));
        if !job.protocol.holding.stiffness.is_empty() {
            self.curves[lane].snaps = snaps(job, heights, &mut self.sums, external, last);
        }
        kept
    }

    /// The highest asperity of a surface, m; NaN of none.
    fn highest(&self, lane: usize) -> f64 {
        self.heights[lane].iter().copied().reduce(f64::max).unwrap_or(f64::NAN)
    }

    /// The pull-off of a surface on its way over the separations.
    fn pull_off(&mut self, job: &Job<'_>, lane: usize) -> Extremum {
        let highest = self.highest(lane);
        let heights = &self.heights[lane];
        let external = &self.curves[lane].total[Quantity::ExternalForce.index()][..job.separations.len()];
        let Sums { scratch, work, .. } = &mut self.sums;
        if let Some(family) = job.law.family() {
            return scattered::pull_off(job, family, (heights, &self.radii), scratch, work, external);
        }
        match (job.compression, &mut self.compressed) {
            (Some(compression), Some(sums)) if sums.surface(lane).is_some() => {
                pull_off(job, &self.jumps, &mut Compressed { job, compression, sums, lane, highest, work }, external)
            }
            _ => pull_off(job, &self.jumps, &mut Sorted { job, heights, sums: &mut self.sums }, external),
        }
    }
}

/// A surface that is summed asperity by asperity.
struct Sorted<'a> {
    job: &'a Job<'a>,
    /// Rising, m.
    heights: &'a [f64],
    sums: &'a mut Sums,
}

impl Heights for Sorted<'_> {
    fn between(&self, low: f64, high: f64) -> (Vec<f64>, usize) {
        let [low, high] = [low, high].map(|limit| self.heights.partition_point(|u| *u < limit));
        (self.heights[low..high].to_vec(), self.heights.len() - high)
    }

    fn highest(&self) -> f64 {
        self.heights.last().copied().unwrap_or(f64::NEG_INFINITY)
    }

    fn external_force(&mut self, separation: f64) -> f64 {
        self.sums.surface(self.job, self.heights, separation);
        RegimeSums::total(&self.sums.regimes)[Quantity::ExternalForce.index()]
    }
}

/// A surface that is summed by moments.
struct Compressed<'a> {
    job: &'a Job<'a>,
    compression: &'a Compression,
    sums: &'a mut compressed::Sums,
    lane: usize,
    /// m.
    highest: f64,
    work: &'a mut Work,
}

impl Heights for Compressed<'_> {
    fn between(&self, low: f64, high: f64) -> (Vec<f64>, usize) {
        let binned = self.sums.surface(self.lane);
        binned.map(|binned| binned.between(self.compression, low, high)).unwrap_or_default()
    }

    fn highest(&self) -> f64 {
        self.highest
    }

    fn external_force(&mut self, separation: f64) -> f64 {
        let d = self.job.surface.asperity_separation(separation);
        self.sums.external_force(self.compression, self.job.law, self.lane, d, self.work)
    }
}

/// Sums over the asperities of one surface in one state.
pub(super) struct Sums {
    pub regimes: Vec<RegimeSums>,
    scratch: Scratch,
    work: Work,
}

/// Sums over the asperities of a surface in one regime.
#[derive(Clone, Copy, Default)]
pub(super) struct RegimeSums {
    pub count: f64,
    pub adhesion: Compensated,
    pub contact: Compensated,
    pub area: Compensated,
}

impl RegimeSums {
    /// The quantities of all regimes together, by [`Quantity::index`].
    pub fn total(regimes: &[Self]) -> [f64; 4] {
        let total = |part: fn(&Self) -> f64| {
            let mut sum = Compensated::default();
            regimes.iter().for_each(|regime| sum.add(part(regime)));
            sum.value()
        };
        Quantity::of_response(total(|r| r.adhesion.value()), total(|r| r.contact.value()), total(|r| r.area.value()))
    }

    /// Hands the sums of all regimes over as point `k` of the curves.
    pub fn record(regimes: &[Self], k: usize, curves: &mut Curves) {
        let separations = curves.total[0].len();
        for (regime, sum) in regimes.iter().enumerate() {
            let place = regime * separations + k;
            curves.regime_count[place] = sum.count;
            curves.regime_adhesion_force[place] = sum.adhesion.value();
            curves.regime_external_force[place] = sum.contact.value() - sum.adhesion.value();
        }
        for (curve, value) in curves.total.iter_mut().zip(Self::total(regimes)) {
            curve[k] = value;
        }
    }
}

impl Sums {
    /// Sums a surface: `heights` (m) rising, at the separation h, m.
    fn surface(&mut self, job: &Job<'_>, heights: &[f64], separation: f64) {
        self.over(job.law, None, heights, job.surface.asperity_separation(separation));
    }

    /// Sums a law over heights (m), rising, at the separation d, m; `base` says for each of its regimes among which it counts, if not as
    /// itself.
    pub fn over(&mut self, law: &dyn Law, base: Option<&[usize]>, heights: &[f64], d: f64) {
        self.regimes.fill(RegimeSums::default());
        let Self { regimes, scratch, work } = self;
        for (regime, range) in regime_ranges(law, heights, d) {
            let sum = &mut regimes[base.map_or(regime, |base| base[regime])];
            let count = range.len() as f64;
            sum.count += count;
            if let Some(force) = law.constant(regime) {
                sum.adhesion.add(count * force);
                work.constant += range.len() as u64;
                continue;
            }
            let touches = law.regimes()[regime].is_contact();
            work.unloaded += if touches { 0 } else { range.len() as u64 };
            for_each_block_of(law, (regime, range), heights, d, scratch, work, |range, responses| {
                let n = range.len();
                InstructionSet::current().run(
                    #[inline(always)]
                    || {
                        sum.adhesion.add(lane_sum(&responses.adhesion[..n]));
                        // Where nothing touches there is neither load nor area.
                        if touches {
                            sum.contact.add(lane_sum(&responses.contact[..n]));
                            sum.area.add(lane_sum(&responses.area[..n]));
                        }
                    },
                );
            });
        }
    }
}
