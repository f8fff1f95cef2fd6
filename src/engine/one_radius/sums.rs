//! Direct sums over the asperities of a surface of one radius.

use crate::asperity::{Facing, Law, Loop, Method, Scratch, SolverStats};
use crate::engine::curves::{Curves, RegimeSums};
use crate::engine::job::Job;
use crate::engine::radii::asperities::{LaneSums, OnBranch, Reversed};
use crate::engine::state::{Branch, Reversal};

/// Asperities of a surface that have yielded, from which number on a table of their responses at a distance saves time.
const MANY: usize = 1000;

/// Sums over the asperities of one surface in one state.
pub struct Sums {
    pub regimes: Vec<RegimeSums>,
    scratch: Scratch,
    pub stats: SolverStats,
    /// The asperities that have yielded, each with its own outline, since they turned last.
    yielded: Option<Reversed>,
    lane_sums: LaneSums,
}

impl Sums {
    /// Memory for a law of `regimes` regimes.
    pub fn new(regimes: usize) -> Self {
        Self {
            regimes: vec![RegimeSums::default(); regimes],
            scratch: Scratch::default(),
            stats: SolverStats::default(),
            yielded: None,
            lane_sums: LaneSums::new(regimes),
        }
    }

    /// Sums a surface, `heights` (m) rising, in all states of a job.
    pub fn record(&mut self, job: &Job<'_>, heights: &[f64], curves: &mut Curves) {
        // It was of another surface.
        self.yielded = None;
        for (i, branch) in Branch::all(job).into_iter().enumerate() {
            for (k, h) in job.separations.iter().enumerate() {
                self.surface(job, heights, branch, *h);
                curves.record(i * job.separations.len() + k, &self.regimes);
            }
        }
    }

    /// Sums a surface of a job, `heights` (m) rising, on a branch at a separation h, m.
    fn surface(&mut self, job: &Job<'_>, heights: &[f64], branch: Branch<'_>, h: f64) {
        let d = job.surface.asperity_separation(h);
        let Some(reversal) = branch.reversal() else {
            return self.over(job.laws.typical, None, heights, d);
        };
        let Reversal { cycle, from } = reversal;
        let closest = job.surface.asperity_separation(from);
        if !cycle.yields() {
            let law = cycle.at(d - closest);
            return self.over(&law, Some(law.base()), heights, closest);
        }
        let first = heights.partition_point(|u| !cycle.has_yielded(u - closest));
        let is_own = |separations: &[f64]| separations.binary_search_by(|own| own.total_cmp(&h)).is_ok();
        // Many that have yielded are read from a table, which all surfaces of the job share at this distance; of few
        // the outline of each is found once.
        if heights.len() - first >= MANY && from == job.separations[0] && is_own(job.separations) {
            let law = cycle.tabulated_at(d - closest);
            return self.over(&law, Some(law.base()), heights, closest);
        }
        self.elastic(cycle, &heights[..first], (closest, d));
        if self.turn(job, reversal, &heights[first..]).is_some() {
            self.add_yielded(cycle, None, d);
        }
    }

    /// Sums asperities that have not yielded, heights in m, pulled back from d to d, m.
    fn elastic(&mut self, cycle: &Loop, heights: &[f64], (closest, d): (f64, f64)) {
        let law = cycle.elastic_at(d - closest);
        self.over(&law, Some(law.base()), heights, closest);
    }

    /// Turns the asperities of a surface that have yielded, heights in m, unless they turned there last; none where there
    /// are none.
    pub fn turn(&mut self, job: &Job<'_>, reversal: Reversal<'_>, heights: &[f64]) -> Option<&Reversed> {
        if heights.is_empty() {
            return None;
        }
        if self.yielded.as_ref().is_none_or(|yielded| !yielded.is_of(reversal)) {
            self.yielded = Some(Reversed::alike(job, reversal, heights, &mut self.stats));
        }
        self.yielded.as_ref()
    }

    /// Adds some of the asperities that have yielded and were turned last, or all, at d, m.
    fn add_yielded(&mut self, cycle: &Loop, which: Option<&[u32]>, d: f64) {
        if let Some(yielded) = &self.yielded {
            OnBranch::Reversed(cycle, yielded).sum(which, d, &mut self.lane_sums);
            self.regimes.iter_mut().zip(&self.lane_sums.regimes).for_each(|(sum, other)| sum.merge(other));
        }
    }

    /// The external force, N, of a few asperities that are pulled back from d to d, m: these that have not yielded by their
    /// heights, m, rising, the others by their numbers among what was turned last.
    pub fn few(
        &mut self,
        cycle: &Loop,
        (heights, yielded): (&[f64], &[u32]),
        (closest, d): (f64, f64),
    ) -> f64 {
        if heights.is_empty() {
            self.regimes.fill(RegimeSums::default());
        } else if cycle.yields() {
            self.elastic(cycle, heights, (closest, d));
        } else {
            let law = cycle.at(d - closest);
            self.over(&law, Some(law.base()), heights, closest);
        }
        if !yielded.is_empty() {
            self.add_yielded(cycle, Some(yielded), d);
        }
        RegimeSums::external_force(&self.regimes)
    }

    /// The external force, N, of a surface, `heights` (m) rising, on a branch at a separation h, m.
    pub fn external_force(&mut self, job: &Job<'_>, heights: &[f64], branch: Branch<'_>, h: f64) -> f64 {
        self.surface(job, heights, branch, h);
        branch.external_force(job.surface, h, RegimeSums::external_force(&self.regimes))
    }

    /// The cost of solving since the last call.
    pub fn take_stats(&mut self) -> SolverStats {
        let mut stats = std::mem::take(&mut self.stats);
        stats.merge(&std::mem::take(&mut self.lane_sums.stats));
        stats
    }

    /// Sums a law over heights (m), rising, at the separation d, m; `base` says for each of its regimes among
    /// which it counts, if not as itself.
    pub fn over(&mut self, law: &dyn Law, base: Option<&[usize]>, heights: &[f64], d: f64) {
        self.regimes.fill(RegimeSums::default());
        let Self { regimes, scratch, stats, .. } = self;
        let facing = Facing { law, heights, separation: d };
        for (regime, range) in facing.regime_ranges() {
            let sum = &mut regimes[base.map_or(regime, |base| base[regime])];
            let count = range.len() as f64;
            sum.count += count;
            if let Method::Constant(force) = law.method(regime) {
                sum.adhesion.add(count * force);
                stats.constant += range.len() as u64;
                continue;
            }
            let touches = law.regimes()[regime].is_contact();
            stats.unloaded += if touches { 0 } else { range.len() as u64 };
            facing.for_each_block_of((regime, range), scratch, stats, |range, responses| {
                sum.add_lanes(responses, range.len(), touches);
            });
        }
    }
}
