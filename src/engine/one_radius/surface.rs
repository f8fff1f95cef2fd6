//! A surface of asperities of one radius: its curves and what is sought of them.

use super::approach::{Approach, ByMoments, Sorted};
use super::force_table::ForceTable;
use super::retraction::Retraction;
use super::sums::Sums;
use crate::asperity::SolverStats;
use crate::engine::curves::Curves;
use crate::engine::job::Job;
use crate::engine::kinks::{Kinks, widest_spacing};
use crate::engine::moments::{LANES, MANY, MomentSums};
use crate::engine::search::Sought;
use crate::engine::state::{Branch, Reversal};
use crate::engine::summed::{Contacts, Summed};
use crate::math::extrema::Extremum;

/// What surfaces of a job are solved by, one after the other, or several at once by moments.
pub struct Solver {
    kinks: Kinks,
    table: ForceTable,
    sums: Sums,
    moments: Option<MomentSums>,
}

impl Solver {
    /// Memory for the surfaces of a job.
    pub fn new(job: &Job<'_>) -> Self {
        let (kinks, regimes) = (Kinks::new(job), job.laws.regimes().len());
        Self {
            table: ForceTable::of(job, &kinks.approach),
            kinks,
            sums: Sums::new(regimes),
            moments: job.moments.map(|matrix| MomentSums::new(matrix, regimes)),
        }
    }

    /// The number of surfaces of a job that are summed at once.
    pub fn at_once(job: &Job<'_>) -> usize {
        if job.moments.is_some() && job.surface.asperity_count <= MANY { LANES } else { 1 }
    }

    /// The cost of the surfaces since the last call.
    pub fn take_stats(&mut self) -> SolverStats {
        self.sums.take_stats()
    }

    /// Sums surfaces over all states of a job. It sorts their heights unless it sums by moments: rising heights make the
    /// regimes contiguous, and neighbours in a slice neighbours in the law.
    pub fn sum(&mut self, job: &Job<'_>, heights: &mut [Vec<f64>], curves: &mut [Curves]) {
        if let (Some(matrix), Some(moments)) = (job.moments, &mut self.moments) {
            moments.take(matrix, heights);
            moments.fill(matrix, job.laws.typical, curves, &mut self.sums.stats);
        }
        for (lane, (heights, curves)) in heights.iter_mut().zip(curves).enumerate() {
            if self.moments.as_ref().is_none_or(|moments| moments.surface(lane).is_none()) {
                heights.sort_unstable_by(f64::total_cmp);
                self.sums.record(job, heights, curves);
            }
        }
    }
}

/// A surface with all its asperities.
pub struct OfOneRadius<'a> {
    job: &'a Job<'a>,
    /// Heights, m, rising unless they are summed by moments.
    heights: &'a [f64],
    /// The highest of the heights, m; NaN of none.
    highest: f64,
    solver: &'a mut Solver,
    /// The number of the surface among the ones that were summed at once.
    lane: usize,
}

impl<'a> OfOneRadius<'a> {
    /// A surface that was summed as one of several.
    pub fn new(job: &'a Job<'a>, heights: &'a [f64], solver: &'a mut Solver, lane: usize) -> Self {
        let highest = heights.iter().copied().reduce(f64::max).unwrap_or(f64::NAN);
        Self { job, heights, highest, solver, lane }
    }
}

impl Summed for OfOneRadius<'_> {
    fn highest(&self) -> f64 {
        self.highest
    }

    /// The higher an asperity, the sooner it touches and the longer it keeps contact.
    fn contacts(&mut self, Reversal { cycle, from }: Reversal<'_>) -> Contacts {
        let Self { job: Job { surface, .. }, highest, .. } = self;
        let detachment = cycle.detachment(*highest - surface.asperity_separation(from));
        Contacts {
            touchdown: *highest - cycle.touch() + surface.mean_plane_offset,
            detachment: detachment.map_or(f64::NAN, |distance| from + distance),
        }
    }

    fn retraction(&mut self, reversal: Reversal<'_>, separations: &[f64]) -> Vec<f64> {
        let Self { job, heights, solver, .. } = self;
        let branch = Branch::Retraction(reversal);
        separations.iter().map(|h| solver.sums.external_force(job, heights, branch, *h)).collect()
    }

    fn find(&mut self, sought: Sought, branch: Branch<'_>, samples: &[(f64, f64)]) -> Extremum {
        let Self { job, heights, highest, lane, .. } = *self;
        let Solver { kinks, table, sums, moments } = &mut *self.solver;
        let spacing = widest_spacing(job);
        if let Some(reversal) = branch.reversal() {
            let mut curve = Retraction::new(job, reversal, heights, &kinks.retraction, sums);
            return sought.find(&mut curve, samples, spacing);
        }
        let moments = job.moments.zip(moments.as_mut());
        match moments.filter(|(_, moments)| moments.surface(lane).is_some()) {
            Some((matrix, moments)) => {
                let heights = ByMoments { job, matrix, moments, lane, sums };
                sought.find(&mut Approach { job, highest, kinks, table, heights }, samples, spacing)
            }
            None => {
                let heights = Sorted { job, heights, sums };
                sought.find(&mut Approach { job, highest, kinks, table, heights }, samples, spacing)
            }
        }
    }
}
