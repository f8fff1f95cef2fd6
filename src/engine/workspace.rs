//! Replicas drawn, summed and recorded one after the other.

use super::coupled::{Coupled, CoupledJob, Independent};
use super::curves::Curves;
use super::job::{Ends, Job};
use super::one_radius::{self, OfOneRadius};
use super::radii::{self, OfRadii};
use super::replica::Replica;
use crate::asperity::SolverStats;
use rayon::prelude::*;
use std::ops::Range;

/// Memory that batches reuse one after the other.
pub struct Workspace {
    heights: Vec<Vec<f64>>,
    /// The radii of the surface that is summed, where asperities differ in their radii.
    radii: Vec<f64>,
    solver: Solver,
    /// The cost of coupling.
    stats: SolverStats,
    /// The curves of the surfaces that were summed last.
    pub curves: Vec<Curves>,
}

/// What surfaces are solved by.
enum Solver {
    OneRadius(Box<one_radius::Solver>),
    Radii(Box<radii::Solver>),
}

impl Workspace {
    /// Memory for replicas of a job.
    pub fn new(job: &Job<'_>) -> Self {
        let (at_once, solver) = match job.laws.family {
            Some(family) => (1, Solver::Radii(Box::new(radii::Solver::new(job, family)))),
            None => {
                (one_radius::Solver::at_once(job), Solver::OneRadius(Box::new(one_radius::Solver::new(job))))
            }
        };
        Self {
            heights: vec![Vec::new(); at_once],
            radii: Vec::new(),
            solver,
            stats: SolverStats::default(),
            curves: vec![Curves::new(job.states(), job.laws.regimes().len()); at_once],
        }
    }

    /// The cost of the surfaces since the last call.
    pub fn take_stats(&mut self) -> SolverStats {
        let mut stats = match &mut self.solver {
            Solver::OneRadius(solver) => solver.take_stats(),
            Solver::Radii(solver) => solver.take_stats(),
        };
        stats.merge(&std::mem::take(&mut self.stats));
        stats
    }

    /// Draws replicas, sums them over all separations, and visits each with its record and its curves.
    pub fn replicas(&mut self, job: &Job<'_>, replicas: Range<u64>, visit: impl FnMut(Replica, &Curves)) {
        self.replicas_until(job, replicas, &|| false, visit);
    }

    /// Draws and visits replicas until `ends` is true, and whether all were visited. It is asked before each sum, and before
    /// each separation of coupled ones. The replica that it ends is not visited.
    pub fn replicas_until(
        &mut self,
        job: &Job<'_>,
        replicas: Range<u64>,
        ends: Ends<'_>,
        mut visit: impl FnMut(Replica, &Curves),
    ) -> bool {
        let Some(substrate) = &job.protocol.substrate else {
            return self.independent(job, replicas, ends, |_, kept, curves| visit(kept, curves));
        };
        let mut independent = Vec::new();
        let all = self.independent(job, replicas, ends, |index, kept, curves| {
            independent.push(Independent { index, kept, curves: curves.clone() })
        });
        // Each takes seconds, so the replicas of a batch are computed in parallel.
        let of = CoupledJob { job, substrate, ends };
        let coupled: Vec<_> = independent.into_par_iter().map(|replica| of.couple(replica)).collect();
        for coupled in coupled {
            let Some(Coupled { kept, curves, stats }) = coupled else { return false };
            self.stats.merge(&stats);
            visit(kept, &curves);
        }
        all
    }

    /// Draws replicas, sums them as independent ones, and visits each with its index, its record and its curves until `ends`
    /// is true, which is asked before each sum. Whether all were visited.
    fn independent(
        &mut self,
        job: &Job<'_>,
        replicas: Range<u64>,
        ends: Ends<'_>,
        mut visit: impl FnMut(u64, Replica, &Curves),
    ) -> bool {
        let mut first = replicas.start;
        while first < replicas.end {
            if ends() {
                return false;
            }
            let at_once = (replicas.end - first).min(self.heights.len() as u64);
            for (heights, index) in self.heights.iter_mut().zip(first..first + at_once) {
                job.draw(index).of(job.surface, heights, &mut self.radii);
            }
            self.record(job, at_once as usize, |lane, kept, curves| visit(first + lane as u64, kept, curves));
            first += at_once;
        }
        true
    }

    /// Sums the first `count` surfaces, and visits each with its number, its record and its curves.
    fn record(&mut self, job: &Job<'_>, count: usize, mut visit: impl FnMut(usize, Replica, &Curves)) {
        let (heights, curves) = (&mut self.heights[..count], &mut self.curves[..count]);
        match &mut self.solver {
            Solver::OneRadius(solver) => {
                solver.sum(job, heights, curves);
                for (lane, (heights, curves)) in heights.iter().zip(curves).enumerate() {
                    let mut surface = OfOneRadius::new(job, heights, solver, lane);
                    visit(lane, Replica::new(job, &mut surface, heights.len(), curves), curves);
                }
            }
            Solver::Radii(solver) => {
                for (lane, (heights, curves)) in heights.iter().zip(curves).enumerate() {
                    let mut surface = OfRadii::summed(job, solver, (heights, &self.radii), curves);
                    visit(lane, Replica::new(job, &mut surface, heights.len(), curves), curves);
                }
            }
        }
    }
}
