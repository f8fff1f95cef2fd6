//! The external force of a surface over the separation on the path of its job's law.

use super::force_table::ForceTable;
use super::sums::Sums;
use crate::engine::job::Job;
use crate::engine::kinks::{Kink, Kinks, rounding};
use crate::engine::moments::{MomentMatrix, MomentSums};
use crate::engine::search::{Curve, NODES, Passing, Stray};
use crate::engine::state::Branch;

/// Heights of a surface.
pub trait Heights {
    /// The heights in `low..high`, m, rising.
    fn between(&self, low: f64, high: f64) -> Vec<f64>;

    /// The number of heights in `low..high`, m, at least.
    fn count(&self, low: f64, high: f64) -> usize;

    /// External force of all, N, at a separation h, m, solved.
    fn external_force(&mut self, separation: f64) -> f64;

    /// Memory to sum a few of them.
    fn sums(&mut self) -> &mut Sums;
}

/// The external force of a surface on the path of its job's law.
pub struct Approach<'a, T> {
    pub job: &'a Job<'a>,
    /// The highest of the heights, m.
    pub highest: f64,
    pub kinks: &'a Kinks,
    pub table: &'a mut ForceTable,
    pub heights: T,
}

impl<T: Heights> Curve for Approach<'_, T> {
    type Asperity = f64;

    fn exact(&mut self, separations: &[f64]) -> Vec<f64> {
        separations.iter().map(|&h| self.heights.external_force(h)).collect()
    }

    fn kinked(&mut self, low: f64, high: f64) -> Vec<f64> {
        let [low, high] = [low, high].map(|h| self.job.surface.asperity_separation(h));
        let mut found = Vec::new();
        let mut reached = f64::NEG_INFINITY;
        for Kink { interference, .. } in &self.kinks.approach {
            let (begin, end) = ((low + interference).max(reached), high + interference);
            if begin < end {
                found.append(&mut self.heights.between(begin, end));
                reached = end;
            }
        }
        found
    }

    fn passings(&mut self, heights: &[f64], low: f64, high: f64, passings: &mut Vec<Passing>) {
        let offset = self.job.surface.mean_plane_offset;
        for (kink, of) in self.kinks.approach.iter().enumerate().rev() {
            let kink = kink as u32;
            let place = |height: f64| height - of.interference + offset;
            let first = heights.partition_point(|height| place(*height) < low);
            let passing = |(asperity, height): (u32, &f64)| Passing {
                place: place(*height),
                step: -of.jump,
                kink,
                asperity,
            };
            let all = (first as u32..).zip(&heights[first..]).map(passing);
            passings.extend(all.take_while(|passing| passing.place <= high));
        }
    }

    fn stray(&self, kink: u32) -> &Stray {
        &self.kinks.approach[kink as usize].stray
    }

    fn rounding(&self) -> f64 {
        rounding(self.job, self.highest)
    }

    fn add(&mut self, heights: &[f64], separations: &[f64], sums: &mut [f64]) {
        for (separation, sum) in separations.iter().zip(sums) {
            let d = self.job.surface.asperity_separation(*separation);
            *sum += self.table.sum(self.job.laws.typical, heights, d, self.heights.sums());
        }
    }

    fn strays(&self, heights: &[f64], third: f64, sums: &mut [f64; NODES]) -> bool {
        self.kinks.strays.add(heights, self.job.surface.asperity_separation(third), sums);
        true
    }

    fn falls(&mut self, low: f64, high: f64, mut visit: impl FnMut(f64, usize)) {
        let [low, high] = [low, high].map(|h| self.job.surface.asperity_separation(h));
        for kink in self.kinks.approach.iter().filter(|kink| kink.fall > 0.0) {
            visit(kink.fall, self.heights.count(low + kink.interference, high + kink.interference));
        }
    }
}

/// A surface that is summed asperity by asperity.
pub struct Sorted<'a> {
    pub job: &'a Job<'a>,
    /// Rising, m.
    pub heights: &'a [f64],
    pub sums: &'a mut Sums,
}

impl Heights for Sorted<'_> {
    fn between(&self, low: f64, high: f64) -> Vec<f64> {
        let [low, high] = [low, high].map(|limit| self.heights.partition_point(|u| *u < limit));
        self.heights[low..high].to_vec()
    }

    fn count(&self, low: f64, high: f64) -> usize {
        let [low, high] = [low, high].map(|limit| self.heights.partition_point(|u| *u < limit));
        high - low
    }

    fn external_force(&mut self, separation: f64) -> f64 {
        self.sums.external_force(self.job, self.heights, Branch::Approach, separation)
    }

    fn sums(&mut self) -> &mut Sums {
        self.sums
    }
}

/// A surface that is summed by moments.
pub struct ByMoments<'a> {
    pub job: &'a Job<'a>,
    pub matrix: &'a MomentMatrix,
    pub moments: &'a mut MomentSums,
    /// The lane of the surface.
    pub lane: usize,
    pub sums: &'a mut Sums,
}

impl Heights for ByMoments<'_> {
    fn between(&self, low: f64, high: f64) -> Vec<f64> {
        let binned = self.moments.surface(self.lane);
        binned.map(|binned| binned.between(self.matrix, low, high)).unwrap_or_default()
    }

    fn count(&self, low: f64, high: f64) -> usize {
        self.moments.surface(self.lane).map_or(0, |binned| binned.count(self.matrix, low, high))
    }

    fn external_force(&mut self, separation: f64) -> f64 {
        let d = self.job.surface.asperity_separation(separation);
        let Self { job, matrix, moments, lane, sums } = self;
        let force = moments.external_force(matrix, job.laws.typical, *lane, d, &mut sums.stats);
        self.job.surface.external_force(separation, force)
    }

    fn sums(&mut self) -> &mut Sums {
        self.sums
    }
}
