//! Sums over asperities that differ in their radii, and so in λ: state by state, in blocks of asperities that are in one
//! regime, each lane with the radius of its asperity.

use crate::asperity::SUMMIT_KINKS;
use crate::asperity::{BLOCK, ContactHistory, Family, Loop, Responses, SolverStats, UnloadingLanes};
use crate::asperity::{Lane, Lanes};
use crate::engine::curves::{Curves, RegimeSums};
use crate::engine::job::Job;
use crate::engine::state::Reversal;
use crate::math::instruction_set::InstructionSet;
use std::sync::Arc;

/// Asperities that differ in their radii.
pub struct Asperities {
    pub family: Family,
    /// u, m.
    pub heights: Vec<f64>,
    pub lanes: Arc<[Lane]>,
    /// By the end of a regime, then asperity: the separation d, m, up to which the asperity is beyond the end.
    pub ends: Vec<Vec<f64>>,
    /// The numbers of all.
    all: Vec<u32>,
}

/// Asperities of a loop since they turned.
pub struct Reversed {
    /// The separation h there, and d, m.
    pub from: f64,
    closest: f64,
    /// Whether a second approach follows.
    is_repeated: bool,
    turned: UnloadingLanes,
}

/// Memory for the sums of some asperities after the other.
pub struct LaneSums {
    /// By regime.
    pub regimes: Vec<RegimeSums>,
    /// The cost of solving.
    pub stats: SolverStats,
    lists: Vec<Vec<u32>>,
    /// The regime of each asperity.
    own: Vec<u64>,
    interference: [f64; BLOCK],
    responses: Responses,
}

impl LaneSums {
    /// Memory for a law of `regimes` regimes.
    pub fn new(regimes: usize) -> Self {
        Self {
            regimes: vec![RegimeSums::default(); regimes],
            stats: SolverStats::default(),
            lists: vec![Vec::new(); regimes + 1],
            own: Vec::new(),
            interference: [0.0; BLOCK],
            responses: Responses::default(),
        }
    }
}

impl Asperities {
    /// Asperities of heights and radii, m, whose laws are a family.
    pub fn new(family: &Family, heights: &[f64], radii: &[f64]) -> Self {
        let lanes: Arc<[Lane]> = radii.iter().map(|radius| family.lane(*radius)).collect();
        let mut own = Vec::new();
        let mut ends: Vec<Vec<f64>> = Vec::new();
        for (lane, height) in lanes.iter().zip(heights) {
            family.shared().ends(lane, &mut own);
            ends.resize_with(own.len(), || Vec::with_capacity(lanes.len()));
            ends.iter_mut().zip(&own).for_each(|(ends, end)| ends.push(height - end));
        }
        let all = (0..heights.len() as u32).collect();
        Self { family: family.clone(), heights: heights.to_vec(), lanes, ends, all }
    }

    /// Sums some, or all, at a separation d, m.
    fn sum(&self, which: Option<&[u32]>, d: f64, sums: &mut LaneSums) {
        let LaneSums { regimes, stats, lists, own, interference, responses } = sums;
        lists.iter_mut().for_each(Vec::clear);
        match which {
            Some(which) => {
                for &i in which {
                    let regime: usize = self.ends.iter().map(|ends| usize::from(d <= ends[i as usize])).sum();
                    lists[regime].push(i);
                }
            }
            None => {
                InstructionSet::current().run(
                    #[inline(always)]
                    || {
                        own.clear();
                        own.resize(self.all.len(), 0);
                        for ends in &self.ends {
                            own.iter_mut().zip(ends).for_each(|(own, end)| *own += u64::from(d <= *end));
                        }
                    },
                );
                self.all.iter().zip(own.iter()).for_each(|(i, regime)| lists[*regime as usize].push(*i));
            }
        }
        let law = self.family.shared();
        for (regime, (sum, list)) in regimes.iter_mut().zip(lists).enumerate() {
            *sum = RegimeSums { count: list.len() as f64, ..RegimeSums::default() };
            let touches = self.family.touches(regime);
            stats.unloaded += if touches { 0 } else { list.len() as u64 };
            for which in list.chunks(BLOCK) {
                let n = which.len();
                let interference = &mut interference[..n];
                for (delta, i) in interference.iter_mut().zip(which) {
                    *delta = self.heights[*i as usize] - d;
                }
                let lanes = Lanes::new(&self.lanes, which);
                law.evaluate(regime, lanes, interference, responses, stats);
                sum.add_lanes(responses, n, touches);
            }
        }
    }

    /// The asperities when they turn.
    pub fn turn(&self, job: &Job<'_>, reversal: Reversal<'_>, stats: &mut SolverStats) -> Reversed {
        Reversed::new(job, reversal, (&self.lanes, &self.heights), stats)
    }

    /// The separation d, m, at which the first of them touches on approach; −∞ of none.
    pub fn touchdown(&self, cycle: &Loop) -> f64 {
        let touch = cycle.first_contact() - 1;
        self.ends
            .get(touch)
            .map_or(f64::NEG_INFINITY, |ends| ends.iter().copied().fold(f64::NEG_INFINITY, f64::max))
    }

    /// The separations d, m, at which the force of an asperity is not smooth, falling.
    fn kinks(&self, asperity: usize) -> Vec<f64> {
        let pieces = self.family.shared().pieces(Some(&self.lanes[asperity]));
        let last = pieces.last().map(|piece| piece.upper);
        let ends: Vec<f64> = pieces.iter().map(|piece| piece.lower).chain(last).collect();
        let height = self.heights[asperity];
        ends.into_iter().filter(|end| end.is_finite()).map(|end| height - end).collect()
    }
}

impl Reversed {
    /// Asperities of a loop's own radius, of heights, m, when they turn.
    pub fn alike(job: &Job<'_>, reversal: Reversal<'_>, heights: &[f64], stats: &mut SolverStats) -> Self {
        let lanes: Arc<[Lane]> = vec![reversal.cycle.lane(1.0); heights.len()].into();
        Self::new(job, reversal, (&lanes, heights), stats)
    }

    fn new(
        job: &Job<'_>,
        Reversal { cycle, from }: Reversal<'_>,
        (lanes, heights): (&Arc<[Lane]>, &[f64]),
        stats: &mut SolverStats,
    ) -> Self {
        let closest = job.surface.asperity_separation(from);
        let largest = heights.iter().map(|height| height - closest).collect();
        let turned = UnloadingLanes::new(cycle, lanes, largest, stats);
        Self { from, closest, is_repeated: cycle.again().is_some(), turned }
    }

    /// Whether they turned there.
    pub fn is_of(&self, Reversal { cycle, from }: Reversal<'_>) -> bool {
        self.from == from && self.is_repeated == cycle.again().is_some()
    }

    /// Sums some, or all, at a separation d, m.
    fn sum(&self, cycle: &Loop, which: Option<&[u32]>, d: f64, sums: &mut LaneSums) {
        let (distance, turned) = (d - self.closest, &self.turned);
        let LaneSums { regimes, stats, lists, responses, .. } = sums;
        lists.resize_with(lists.len().max(turned.conditions()), Vec::new);
        lists.iter_mut().for_each(Vec::clear);
        match which {
            Some(which) => which.iter().for_each(|i| lists[turned.condition(*i as usize, distance)].push(*i)),
            None => {
                (0..turned.count() as u32).for_each(|i| lists[turned.condition(i as usize, distance)].push(i))
            }
        }
        regimes.fill(RegimeSums::default());
        for (condition, list) in lists.iter().enumerate().filter(|(_, list)| !list.is_empty()) {
            let regime = turned.regime(condition);
            let Some(sum) = regimes.get_mut(regime) else { continue };
            sum.count += list.len() as f64;
            let touches = cycle.approach().regimes()[regime].is_contact();
            stats.unloaded += if touches { 0 } else { list.len() as u64 };
            for which in list.chunks(BLOCK) {
                turned.evaluate(cycle, condition, (which, distance), responses, stats);
                sum.add_lanes(responses, which.len(), touches);
            }
        }
    }

    /// The separations d, m, falling, at which the force of an asperity is not smooth.
    fn kinks(&self, cycle: &Loop, asperity: usize) -> Vec<f64> {
        let distances = self.turned.kinks(cycle, asperity).into_iter();
        distances.map(|distance| self.closest + distance).collect()
    }

    /// The separations d, m, of the kinks of asperities, all of which have yielded; NaN where an asperity lacks one.
    pub fn kinks_of_yielded(&self) -> impl Iterator<Item = [f64; SUMMIT_KINKS]> + use<'_> {
        (0..self.turned.count())
            .map(|i| self.turned.kinks_of_summit(i).map(|distance| self.closest + distance))
    }

    /// The history of an asperity.
    pub fn history(&self, asperity: usize) -> ContactHistory {
        self.turned.history(asperity)
    }

    /// The separation h, m, at which the last of them loses contact; NaN where none has any.
    pub fn detachment(&self, cycle: &Loop) -> f64 {
        self.turned.detachment(cycle).map_or(f64::NAN, |distance| self.from + distance)
    }
}

/// Asperities on a branch of their path.
#[derive(Clone, Copy)]
pub enum OnBranch<'a> {
    /// The approach.
    Approach(&'a Asperities),
    /// A branch of a loop after a turn.
    Reversed(&'a Loop, &'a Reversed),
}

impl OnBranch<'_> {
    /// Sums some, or all, at a separation d, m.
    pub fn sum(self, which: Option<&[u32]>, d: f64, sums: &mut LaneSums) {
        match self {
            Self::Approach(asperities) => asperities.sum(which, d, sums),
            Self::Reversed(cycle, reversed) => reversed.sum(cycle, which, d, sums),
        }
    }

    /// The external force of some, or all, N, at a separation d, m.
    pub fn external_force(self, which: Option<&[u32]>, d: f64, sums: &mut LaneSums) -> f64 {
        self.sum(which, d, sums);
        RegimeSums::external_force(&sums.regimes)
    }

    /// Sums all at the separations of a job as states of its curves from `first` on.
    pub fn record(self, job: &Job<'_>, first: usize, sums: &mut LaneSums, curves: &mut Curves) {
        for (k, h) in job.separations.iter().enumerate() {
            self.sum(None, job.surface.asperity_separation(*h), sums);
            curves.record(first + k, &sums.regimes);
        }
    }

    /// The separations d, m, falling, at which the force of an asperity is not smooth.
    pub fn kinks(self, asperity: usize) -> Vec<f64> {
        match self {
            Self::Approach(asperities) => asperities.kinks(asperity),
            Self::Reversed(cycle, reversed) => reversed.kinks(cycle, asperity),
        }
    }
}
