//! Newton's method for a stable state of coupled asperities at one separation.
//!
//! With the states fixed, asperities beyond the ends of their segments have the force at the end. They then pass
//! into the next segment, and the rest follows ([`super::passing`]). A state is stable where I + G K has no
//! eigenvalue ≤ 0 (the outermost follow from GMRES).

use super::half_space::HalfSpace;
use super::solver::{Solver, largest};

/// Smallest and largest residual of the system of a Newton step; the largest where asperities have just passed.
const RESIDUALS: (f64, f64) = (1e-2, 0.1);
/// The share of the tolerance of loads that the system aims at.
const AIM: f64 = 0.03;
/// Residual of systems that decide on stability.
pub(super) const DECISIVE: f64 = 1e-3;
/// Shares of the tolerance of loads that residuals, and the error of rough sums, may have: neighbours add to both.
const EXACT: f64 = 0.3;
const UNSURE: f64 = 0.1;
/// Share of the bound of the error by rough sums from which on accurate ones are taken: most errors are far smaller.
const KNOWN: f64 = 3e-3;
/// Newton steps from which on systems are solved with sums of full accuracy and to the end: close to a fold rough
/// ones do not tell on which side.
const STUBBORN: usize = 30;
/// Error of loads, and Newton steps, from which on irreversible passages are made and knots are untied.
const CLOSE: (f64, usize) = (1e-3, 3);
/// Newton steps that count as made after a knot has been untied, and most knots of which that is so: the rest
/// of the work does not grow with their number.
const UNTIED: (usize, usize) = (8, 100);
/// Share of the longest Newton step that interferences are still uncertain by.
const UNCERTAIN: f64 = 0.02;
/// Longest Newton step, in lengths over which laws vary: beyond it a state is another one.
const NEAR: f64 = 4.0;
/// Share of a jump beyond which an asperity at rest has left it before a step is taken.
const FAR: f64 = 1.0;

/// What Newton's method found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Search {
    Stable,
    /// There is no stable state nearby.
    Unstable,
    /// Asperities still go to and fro.
    Undecided,
}

impl Solver<'_> {
    /// Newton's method with at most `most` steps, and `again` more after knots.
    pub(super) fn search(&mut self, d: f64, (most, mut again): (usize, usize)) -> Search {
        self.passages.begin(self.heights.len(), false);
        self.pass_all(0.0);
        self.passages.is_moved = false;
        let mut smallest = f64::INFINITY;
        let near = (NEAR * self.asperities.first_length()).max(2.0 * (d - self.separation).abs());
        let (mut step, mut knots, mut has_passed, mut last) = (0, 0, true, f64::INFINITY);
        while step < most && !(self.ends)() {
            step += 1;
            let error = self.error(d);
            if error <= EXACT * self.tolerance {
                match self.outcome(smallest) {
                    Some(outcome) => return outcome,
                    None => continue,
                }
            }
            if std::mem::take(&mut self.passages.is_knot) {
                let is_worth = self.untie();
                knots += 1;
                if is_worth && knots <= UNTIED.1 {
                    let more = step.saturating_sub(UNTIED.0).min(again);
                    (step, again) = (step - more, again - more);
                }
                continue;
            }
            // Passages before were not yet the surface's own.
            if (error <= CLOSE.0 || step > CLOSE.1) && !self.passages.is_close {
                self.passages.come_close();
            }
            let (low, high) = RESIDUALS;
            let low = if has_passed || !self.passages.is_close { high } else { low };
            smallest = if step <= STUBBORN {
                self.system(0.0, (AIM * self.tolerance / error).clamp(low, high))
            } else {
                self.system_by(HalfSpace::displace_finely, 0.0, DECISIVE)
            };
            // The step was one of other states.
            if self.leave_rests(1.0, FAR) {
                continue;
            }
            let is_free = |i: &usize| !self.states.resting.contains_key(&(*i as u32));
            let longest = largest((0..self.heights.len()).filter(is_free).map(|i| self.memory.step[i]));
            if !(longest < near) {
                return Search::Unstable;
            }
            self.passages.longest = self.passages.longest.max(longest);
            self.advance(1.0);
            // Steps that grow no shorter may be an asperity that goes to and fro across the end of its segment.
            let is_shorter = has_passed || longest < last;
            has_passed = self.pass_all(if is_shorter { UNCERTAIN * longest } else { 0.0 });
            last = longest;
        }
        Search::Undecided
    }

    /// The largest error of a load over the largest load, with sums of full accuracy where rough ones would not do.
    fn error(&mut self, d: f64) -> f64 {
        let error = self.evaluate(d);
        let known = (KNOWN * self.unsure).max(EXACT * self.tolerance);
        if !(self.unsure > UNSURE * self.tolerance && error <= known) {
            return error;
        }
        self.half_space.know(&self.external);
        self.displace(d)
    }

    /// The outcome where loads are exact, by the smallest eigenvalue of 1 + G K; none while asperities pass or go back.
    fn outcome(&mut self, mut smallest: f64) -> Option<Search> {
        self.passages.is_close = true;
        if self.pass(0.0) + self.undo() > 0 {
            return None;
        }
        if smallest <= 0.0 && !self.states.resting.is_empty() {
            smallest = self.stability_without_rests();
        }
        Some(match (smallest <= 0.0, self.passages.frozen) {
            (true, _) => Search::Unstable,
            (false, 0) => Search::Stable,
            _ => Search::Undecided,
        })
    }

    /// The smallest eigenvalue of 1 + G K where asperities at rest keep their force: asperities that keep
    /// each other at jumps may have others.
    fn stability_without_rests(&mut self) -> f64 {
        let resting = std::mem::take(&mut self.states.resting);
        resting.keys().for_each(|&i| self.slopes[i as usize] = 0.0);
        self.residual.copy_from_slice(&self.external);
        let smallest = self.system(0.0, DECISIVE);
        resting.iter().for_each(|(&i, rest)| self.slopes[i as usize] = rest.stiffness);
        self.states.resting = resting;
        smallest
    }
}
