//! A surface that has become unstable falls.
//!
//! # Formula
//! u' = G f − u, from the last stable state to the next, by linearly implicit steps (pseudo-transient continuation;
//! Kelley and Keyes, SIAM J. Numer. Anal. 35 (1998) 508).

use super::search::{DECISIVE, Search};
use super::solver::{Snapshot, Solver, largest_magnitude};

/// Most Newton steps after a fall.
const STEPS: usize = 60;
/// Longest step, in lengths over which laws vary.
const LONGEST: f64 = 0.3;
/// Most steps.
const FALL_STEPS: usize = 400;
/// The first step in time.
const FIRST: f64 = 0.5;
/// Steps without progress after which a fall has ended, in one attempt after the other: asperities at jumps keep on going
/// to and fro.
const IDLE: [usize; 3] = [6, 12, 24];
/// Change of the force in a step, over the sum of loads, of a surface that does not fall.
const STILL: f64 = 1e-3;

impl Solver<'_> {
    /// Falls from a stable state to the separation d, m; whether it came to another one.
    pub(super) fn fall_from(&mut self, before: &Snapshot, d: f64) -> bool {
        self.go_back(before);
        self.interference.iter_mut().for_each(|delta| *delta -= d - before.separation);
        self.passages.step();
        let is_converged = IDLE.into_iter().any(|idle| {
            self.fall(d, idle);
            self.search(d, (STEPS, usize::MAX)) == Search::Stable
        });
        self.forget();
        is_converged
    }

    /// Lets the surface fall at the separation d, m, until it has nearly come to rest: no progress in
    /// `most_idle` steps.
    fn fall(&mut self, d: f64, most_idle: usize) {
        let length = (0..self.heights.len()).map(|i| self.asperities.length(i)).fold(f64::MAX, f64::min);
        let (mut time, mut last, mut idle) = (FIRST, f64::NAN, 0);
        for _ in 0..FALL_STEPS {
            if (self.ends)() {
                return;
            }
            self.passages.begin(self.heights.len(), true);
            self.pass(0.0);
            self.passages.is_moved = false;
            // Asperities that would come to rest at a jump go to and fro.
            self.states.resting.clear();
            self.evaluate(d);
            let force = self.external_force();
            let is_still = (force - last).abs() <= STILL * self.external.iter().map(|f| f.abs()).sum::<f64>();
            idle = if is_still && !self.passages.have_lasting() { idle + 1 } else { 0 };
            last = force;
            let rate = loop {
                let rate = self.system(1.0 / time, DECISIVE);
                if !(rate < 0.0) || -2.0 * rate * time < 1.0 {
                    break rate;
                }
                time = -0.4 / rate;
            };
            if idle >= most_idle && rate > 0.0 {
                return;
            }
            let longest = largest_magnitude(&self.memory.step);
            let share = (LONGEST * length / longest).min(1.0);
            self.advance(share);
            if share == 1.0 {
                time *= 2.0;
            }
        }
    }
}
