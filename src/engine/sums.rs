//! Direct sums over the asperities of a surface of one radius.

use super::Job;
use super::curves::Curves;
use super::polydisperse::{LaneSums, PulledBack};
use super::scalars::Ways;
use crate::asperity::{Facing, Law, Loop, Method, Quantity, Scratch, SolverStats};
use crate::math::instruction_set::InstructionSet;
use crate::math::sums::{Compensated, lane_sum};
use crate::surface::Surface;

/// Tops of a surface from which on a table of their responses at a distance is worth its making, even for one surface.
const MANY_TOPS: usize = 1000;

/// A state that a surface is summed in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum State {
    /// A separation h, m, on the way of the job's law.
    Approach(f64),
    /// The separation `to` on retraction from the separation `from`, m.
    Retraction {
        /// h, m.
        from: f64,
        /// h, m.
        to: f64,
    },
    /// The separation `to` on the second approach after a retraction from `from`, m.
    Again {
        /// h, m.
        from: f64,
        /// h, m.
        to: f64,
    },
}

impl State {
    /// The states that the surfaces of a job are summed in, in the order of its curves.
    pub fn all(job: &Job<'_>) -> Vec<Self> {
        let (from, ways) = (job.separations[0], job.ways());
        let approach = job.separations.iter().map(|&h| Self::Approach(h)).filter(|_| ways != Ways::Back);
        let back = |of: fn(f64, f64) -> Self| job.separations.iter().map(move |&to| of(from, to));
        let retraction = back(|from, to| Self::Retraction { from, to }).filter(|_| ways != Ways::One);
        let again = back(|from, to| Self::Again { from, to }).filter(|_| ways == Ways::Repeated);
        approach.chain(retraction).chain(again).collect()
    }

    /// The external force, N, of a surface whose asperities have another in this state, N.
    pub fn external_force(self, surface: &Surface, of_asperities: f64) -> f64 {
        match self {
            Self::Approach(h) => surface.external_force(h, of_asperities),
            Self::Retraction { to, .. } => surface.external_force_back(to, of_asperities),
            Self::Again { to, .. } => surface.external_force_again(to, of_asperities),
        }
    }

    /// The loop whose law acts, and the separations h, m, where the surfaces have turned and where they are, once they have.
    pub fn turned<'a>(self, job: &Job<'a>) -> Option<(&'a Loop, f64, f64)> {
        let cycle = job.protocol.cycle?;
        match self {
            Self::Approach(_) => None,
            Self::Retraction { from, to } => Some((cycle, from, to)),
            Self::Again { from, to } => Some((cycle.again()?, from, to)),
        }
    }

    /// The separation h, m.
    pub fn separation(self) -> f64 {
        match self {
            Self::Approach(h) | Self::Retraction { to: h, .. } | Self::Again { to: h, .. } => h,
        }
    }
}

/// Sums over the asperities of one surface in one state.
pub(super) struct Sums {
    pub regimes: Vec<RegimeSums>,
    pub scratch: Scratch,
    pub stats: SolverStats,
    /// The asperities that have flowed, where their tops have radii of their own, since they turned last.
    flowed: Option<PulledBack>,
    lane_sums: LaneSums,
}

/// Sums over the asperities of a surface in one regime.
#[derive(Clone, Copy, Default)]
pub(super) struct RegimeSums {
    pub count: f64,
    pub adhesion: Compensated,
    pub contact: Compensated,
    pub area: Compensated,
}

impl RegimeSums {
    /// The quantities of all regimes together, by [`Quantity::index`].
    pub fn total(regimes: &[Self]) -> [f64; 4] {
        let total = |part: fn(&Self) -> f64| {
            let mut sum = Compensated::default();
            regimes.iter().for_each(|regime| sum.add(part(regime)));
            sum.value()
        };
        Quantity::of_response(
            total(|r| r.adhesion.value()),
            total(|r| r.contact.value()),
            total(|r| r.area.value()),
        )
    }

    /// The external force of the asperities of all regimes together, N.
    pub fn external_force(regimes: &[Self]) -> f64 {
        Self::total(regimes)[Quantity::ExternalForce.index()]
    }

    /// Adds the sums of other asperities.
    pub fn merge(&mut self, other: &Self) {
        self.count += other.count;
        self.adhesion.merge(&other.adhesion);
        self.contact.merge(&other.contact);
        self.area.merge(&other.area);
    }

    /// Hands the sums of all regimes over as point `k` of the curves.
    pub fn record(regimes: &[Self], k: usize, curves: &mut Curves) {
        let separations = curves.total[0].len();
        for (regime, sum) in regimes.iter().enumerate() {
            let place = regime * separations + k;
            curves.regime_count[place] = sum.count;
            curves.regime_adhesion_force[place] = sum.adhesion.value();
            curves.regime_external_force[place] = sum.contact.value() - sum.adhesion.value();
        }
        for (curve, value) in curves.total.iter_mut().zip(Self::total(regimes)) {
            curve[k] = value;
        }
    }
}

impl Sums {
    /// Memory for a law of `regimes` regimes.
    pub fn new(regimes: usize) -> Self {
        Self {
            regimes: vec![RegimeSums::default(); regimes],
            scratch: Scratch::default(),
            stats: SolverStats::default(),
            flowed: None,
            lane_sums: LaneSums::new(regimes),
        }
    }

    /// Forgets the surface that was summed last, before another is.
    pub fn forget(&mut self) {
        self.flowed = None;
    }

    /// Sums a surface of a job, `heights` (m) rising, in a state.
    pub fn surface(&mut self, job: &Job<'_>, heights: &[f64], state: State) {
        let d = |h: f64| job.surface.asperity_separation(h);
        match state.turned(job) {
            Some((cycle, from, to)) if cycle.yields() => {
                self.flattened((job, cycle), heights, (from, d(from)), (to, d(to)));
            }
            Some((cycle, from, to)) => {
                let law = cycle.at(d(to) - d(from));
                self.over(&law, Some(law.base()), heights, d(from));
            }
            None => self.over(job.laws.typical, None, heights, d(state.separation())),
        }
    }

    /// Sums a surface that is pulled back from h and d, m, to h and d, m, where tops that have flowed have outlines of their own.
    /// Of many tops there are tables at distances at which all surfaces of the job are; else what is left of each is found once.
    fn flattened(
        &mut self,
        (job, cycle): (&Job<'_>, &Loop),
        heights: &[f64],
        (from, closest): (f64, f64),
        (to, d): (f64, f64),
    ) {
        let first = heights.partition_point(|u| !cycle.has_yielded(u - closest));
        let is_common =
            from == job.separations[0] && job.separations.binary_search_by(|own| own.total_cmp(&to)).is_ok();
        if is_common && heights.len() - first >= MANY_TOPS {
            let law = cycle.tabulated_at(d - closest);
            return self.over(&law, Some(law.base()), heights, closest);
        }
        self.elastic(cycle, &heights[..first], (closest, d));
        if self.turn((job, cycle), &heights[first..], from).is_some() {
            self.add_flowed(cycle, None, d);
        }
    }

    /// Sums asperities that have not flowed, heights in m, pulled back from d to d, m.
    fn elastic(&mut self, cycle: &Loop, heights: &[f64], (closest, d): (f64, f64)) {
        let law = cycle.elastic_at(d - closest);
        self.over(&law, Some(law.base()), heights, closest);
    }

    /// Turns the asperities of a surface that have flowed, heights in m, at a separation h, m, if that was not done last; none
    /// where there are none.
    pub fn turn(
        &mut self,
        (job, cycle): (&Job<'_>, &Loop),
        heights: &[f64],
        from: f64,
    ) -> Option<&PulledBack> {
        if heights.is_empty() {
            return None;
        }
        if self.flowed.as_ref().is_none_or(|flowed| !flowed.is_of(cycle, from)) {
            self.flowed = Some(PulledBack::alike((job, cycle), heights, from, &mut self.stats));
        }
        self.flowed.as_ref()
    }

    /// Adds some of the asperities that have flowed and were turned last, or all, at d, m.
    fn add_flowed(&mut self, cycle: &Loop, which: Option<&[u32]>, d: f64) {
        if let Some(flowed) = &self.flowed {
            flowed.sum(cycle, which, d, &mut self.lane_sums, &mut self.stats);
            self.regimes.iter_mut().zip(&self.lane_sums.regimes).for_each(|(sum, other)| sum.merge(other));
        }
    }

    /// The external force, N, of a few asperities that are pulled back from d to d, m: these that have not flowed by their
    /// heights, m, rising, the others by their numbers among what was turned last.
    pub fn few(&mut self, cycle: &Loop, (heights, tops): (&[f64], &[u32]), (closest, d): (f64, f64)) -> f64 {
        if heights.is_empty() {
            self.regimes.fill(RegimeSums::default());
        } else if cycle.yields() {
            self.elastic(cycle, heights, (closest, d));
        } else {
            let law = cycle.at(d - closest);
            self.over(&law, Some(law.base()), heights, closest);
        }
        if !tops.is_empty() {
            self.add_flowed(cycle, Some(tops), d);
        }
        RegimeSums::external_force(&self.regimes)
    }

    /// The external force, N, of a surface in a state, likewise.
    pub fn external_force(&mut self, job: &Job<'_>, heights: &[f64], state: State) -> f64 {
        self.surface(job, heights, state);
        state.external_force(job.surface, RegimeSums::external_force(&self.regimes))
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
                let n = range.len();
                InstructionSet::current().run(
                    #[inline(always)]
                    || {
                        sum.adhesion.add(lane_sum(&responses.adhesion[..n]));
                        // Where nothing touches there is neither load nor area.
                        if touches {
                            sum.contact.add(lane_sum(&responses.contact[..n]));
                            sum.area.add(lane_sum(&responses.area[..n]));
                        }
                    },
                );
            });
        }
    }
}
