//! Asperities that have passed, and the ones around them, come to balance before the next step of all.
//!
//! # Formula
//! After a step of Newton's method asperities have the loads f⁰ = f + K Δδ at δ⁰ = δ + Δδ. What a passage changes is felt by its
//! neighbours first: around each that has passed δ = δ⁰ − G (f(δ) − f⁰) is solved, passages included, while all others keep
//! f⁰. So a step of all need not be made for each passage: nonlinear elimination (Lanzkron, Rose and Wilkes,
//! SIAM J. Sci. Comput. 17 (1996) 538).

use super::solver::{Solver, largest};

/// Most asperities that give way to one that has passed.
const AROUND: usize = 32;
/// Most steps.
const STEPS: usize = 10;
/// Share of the largest load up to which loads are balanced.
const BALANCED: f64 = 1e-6;

impl Solver<'_> {
    /// Keeps loads and interferences, as a step of all has changed them: they are balanced.
    pub(super) fn take_balance(&mut self) {
        let Self { interference, external, memory, .. } = self;
        memory.balanced.clone_from(external);
        memory.feet.clone_from(interference);
    }

    /// Brings asperities that have passed since to balance with their neighbours.
    pub(super) fn relax(&mut self) {
        let mut seeds = std::mem::take(&mut self.passages.recent);
        seeds.sort_unstable();
        seeds.dedup();
        let least = BALANCED * largest(self.external.iter().copied());
        let mut done: Vec<u32> = Vec::new();
        for seed in seeds {
            if done.binary_search(&seed).is_err() {
                let near = self.relax_around(seed as usize, least);
                done.extend(near);
                done.sort_unstable();
            }
        }
        self.passages.recent.clear();
    }

    /// Brings one asperity to balance with its neighbours; which these are.
    fn relax_around(&mut self, seed: usize, least: f64) -> Vec<u32> {
        let around = self.unshifted().giving_way(&self.half_space, &[seed], AROUND);
        let near: Vec<usize> = std::iter::once(seed).chain(around).collect();
        let which: Vec<u32> = near.iter().map(|i| *i as u32).collect();
        for _ in 0..STEPS {
            self.respond(&which);
            self.unbalance(&near);
            let has_passed = self.pass_among(&near);
            if has_passed {
                continue;
            }
            if largest(near.iter().map(|i| self.slopes[*i] * self.residual[*i])) <= least {
                break;
            }
            let Some((steps, _)) = self.local(&near, &[]) else { break };
            for (i, step) in near.iter().zip(steps) {
                match self.states.resting.get_mut(&(*i as u32)) {
                    Some(rest) => rest.share += rest.stiffness * step / (rest.ends[1] - rest.ends[0]),
                    None => self.interference[*i] += step,
                }
            }
            self.leave_rests(0.0, 0.0);
        }
        which
    }

    /// Residuals, m, of some asperities while all others keep the loads that they have been balanced with.
    fn unbalance(&mut self, near: &[usize]) {
        let Self { half_space, interference, external, residual, memory, .. } = self;
        for &i in near {
            let by = |j: &usize| half_space.influence(i, *j) * (external[*j] - memory.balanced[*j]);
            residual[i] = interference[i] - memory.feet[i] + near.iter().map(by).sum::<f64>();
        }
    }
}
