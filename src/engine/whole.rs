//! Surfaces whose heights are all held at once.

use super::Job;
use super::compressed::{self, Compression};
use super::pull_off::{Heights, Jump, pull_off};
use super::replica::Summed;
use super::scattered;
use super::sums::{State, Sums};
use crate::asperity::Work;
use crate::math::extrema::Extremum;

/// A surface that has been summed.
pub(super) struct Whole<'a> {
    pub job: &'a Job<'a>,
    /// Heights, m, rising unless sums are compressed or radii differ.
    pub heights: &'a [f64],
    /// m, where they differ.
    pub radii: &'a [f64],
    /// Of the law.
    pub jumps: &'a [Jump],
    /// The highest of the heights, m; NaN of none.
    pub highest: f64,
    pub sums: &'a mut Sums,
    /// The lane of the surface, if it was summed by moments.
    pub compressed: Option<(&'a Compression, &'a mut compressed::Sums, usize)>,
}

impl Summed for Whole<'_> {
    fn highest(&self) -> f64 {
        self.highest
    }

    fn pull_off(&mut self, external: &[f64]) -> Extremum {
        let Self { job, heights, highest, .. } = *self;
        let Sums { scratch, work, .. } = &mut *self.sums;
        if let Some(family) = job.law.family() {
            let asperities = (heights, self.radii);
            return scattered::pull_off(job, external, |places| {
                scattered::external_forces(job, family, asperities, scratch, work, places)
            });
        }
        match &mut self.compressed {
            Some((compression, sums, lane)) => {
                let mut surface = Compressed { job, compression, sums, lane: *lane, highest, work };
                pull_off(job, self.jumps, &mut surface, external)
            }
            None => pull_off(job, self.jumps, &mut Sorted { job, heights, sums: self.sums }, external),
        }
    }

    fn back(&mut self, from: f64, separations: &[f64]) -> Vec<f64> {
        let force = |&to: &f64| self.sums.external_force(self.job, self.heights, State::Back { from, to });
        separations.iter().map(force).collect()
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
    fn job(&self) -> &Job<'_> {
        self.job
    }

    fn between(&self, low: f64, high: f64) -> (Vec<f64>, usize) {
        let [low, high] = [low, high].map(|limit| self.heights.partition_point(|u| *u < limit));
        (self.heights[low..high].to_vec(), self.heights.len() - high)
    }

    fn highest(&self) -> f64 {
        self.heights.last().copied().unwrap_or(f64::NEG_INFINITY)
    }

    fn external_force(&mut self, separation: f64) -> f64 {
        self.sums.external_force(self.job, self.heights, State::There(separation))
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
    fn job(&self) -> &Job<'_> {
        self.job
    }

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
