//! A surface that is moved to a separation, to the next stable state.
//!
//! Where Newton's method finds no stable state, the surface as a whole has become unstable, and falls ([`super::fall`]).

use super::avalanches::{Avalanches, avalanches};
use super::search::Search;
use super::solver::{Snapshot, Solver, Step};

/// Newton steps after which a surface without stable state is let fall, and after which, and as many after knots, it is tried in a
/// shorter step.
const HOPELESS: usize = 50;
const TRIED: usize = 30;

/// The outcome at a separation that was reached.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Settled {
    /// Whether the state is stable, to the tolerance.
    pub is_converged: bool,
    /// Avalanches: passages that no other set off, with all that they set off.
    pub avalanches: Avalanches,
}

impl Solver<'_> {
    /// Puts all asperities at the separation d, m, of their mean plane, as if independent; none has touched before.
    pub fn begin(&mut self, d: f64) {
        for (delta, z) in self.interference.iter_mut().zip(self.heights) {
            *delta = z - d;
        }
        self.stretches.fill(1.0);
        self.asperities.stretch(&self.stretches);
        self.states = self.asperities.none_touched();
        (self.separation, self.is_stable) = (d, false);
        self.forget();
        self.passages.begin(self.heights.len(), true);
        self.pass_all(0.0);
    }

    /// Goes to the separation d, m, from the present state.
    pub fn settle(&mut self, d: f64) -> Settled {
        self.settle_by(d, &[Search::Unstable, Search::Undecided], (HOPELESS, usize::MAX))
    }

    /// Goes to the separation d, m, but falls only if there is no stable state nearby: where asperities go to and fro,
    /// a fall takes far longer than shorter steps, which may help.
    pub fn try_to_settle(&mut self, d: f64) -> Settled {
        self.settle_by(d, &[Search::Unstable], (TRIED, TRIED))
    }

    /// Goes to the separation d, m, from the present state. The step is extrapolated from the stable state before, if there is one.
    /// If it leads to no stable state nearby, it is taken from the present state alone, and the surface may fall, which takes far
    /// longer. Then two steps of half the length are tried, which may be halved again. The energy, J, that the steps before the
    /// last one lost.
    pub fn reach(&mut self, d: f64, halvings: u32) -> (Settled, f64) {
        if halvings == 0 || !self.is_stable {
            return (self.settle(d), 0.0);
        }
        let (before, is_extrapolated) = (self.snapshot(), self.path.is_some());
        let falls_after: &[Search] = if is_extrapolated { &[] } else { &[Search::Unstable] };
        let mut settled = self.settle_by(d, falls_after, (TRIED, TRIED));
        if !settled.is_converged && is_extrapolated && !(self.ends)() {
            self.restore(&before);
            settled = self.try_to_settle(d);
        }
        if settled.is_converged || (self.ends)() {
            return (settled, 0.0);
        }
        self.restore(&before);
        let (half, lost) = self.reach(0.5 * (self.separation + d), halvings - 1);
        let lost = lost + self.energy_lost();
        let (rest, further) = self.reach(d, halvings - 1);
        (Settled { avalanches: half.avalanches.and(rest.avalanches), ..rest }, lost + further)
    }

    /// Goes to a separation, and falls after some outcomes of a search of a number of steps.
    fn settle_by(&mut self, d: f64, falls_after: &[Search], steps: (usize, usize)) -> Settled {
        let (before, from) = (self.snapshot(), self.separation);
        self.passages.step();
        self.extrapolate(d);
        let found = self.search(d, steps);
        let is_near = found == Search::Stable;
        let is_converged = is_near || falls_after.contains(&found) && self.fall_from(&before, d);
        if is_near {
            self.path = Some(before.clone());
        }
        (self.separation, self.is_stable) = (d, is_converged);
        self.asperities.remember(&mut self.states, &self.interference);
        let changed = |i: u32| self.states.segments[i as usize] != before.states.segments[i as usize];
        let distance = |a: u32, b: u32| self.half_space.square(a as usize, b as usize);
        let avalanches = avalanches(&self.passages.events, changed, distance);
        let has_left = !is_near || self.has_leapt(d - from);
        self.step = (before.is_stable && is_converged).then_some(Step { before, has_left });
        Settled { is_converged, avalanches }
    }

    /// Moves interferences to where they are expected at d, m, by those at the present separation and before.
    fn extrapolate(&mut self, d: f64) {
        let from = self.separation;
        match &self.path {
            Some(Snapshot { separation, interference: one, .. }) if *separation != from => {
                let share = (d - from) / (from - separation);
                self.interference
                    .iter_mut()
                    .zip(one)
                    .for_each(|(delta, one)| *delta += share * (*delta - one));
            }
            _ => self.interference.iter_mut().for_each(|delta| *delta -= d - from),
        }
        // Jumps are short: few asperities stay at theirs, those that have been there for two separations.
        let mut resting = std::mem::take(&mut self.states.resting);
        resting.retain(|i, rest| {
            let before =
                self.path.as_ref().and_then(|path| Some((path.separation, path.states.resting.get(i)?)));
            if let Some((first, one)) = before.filter(|(_, one)| one.segments == rest.segments) {
                rest.share += (d - from) / (from - first) * (rest.share - one.share);
                if (0.0..=1.0).contains(&rest.share) {
                    return true;
                }
            }
            self.states.segments[*i as usize] = rest.segments[usize::from(d < from)];
            self.interference[*i as usize] = self.asperities.place(*i as usize, rest.place) - (d - from);
            false
        });
        self.states.resting = resting;
        self.place_rests();
    }
}
