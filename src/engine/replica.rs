//! One replica: one surface, its curves and what is kept of them.

use super::asperity_states::AsperityStates;
use super::coupled::{CoupledJob, Independent};
use super::curves::{CoupledCurves, Curves};
use super::cycle::{Cycle, snaps};
use super::force_table::ForceTable;
use super::held::{HeldSurface, OfLane};
use super::job::{Ends, Job, Ways};
use super::kinks::Kinks;
use super::moments::{LANES, MANY, MomentSums};
use super::polydisperse::{Asperities, LaneSums, PulledBack};
use super::summed::Summed;
use super::sums::{RegimeSums, State, Sums};
use crate::asperity::{Quantity, SolverStats};
use crate::coupled::{CLASSES, ENERGY_CLASSES};
use crate::math::extrema::Extremum;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// The record of every replica.
///
/// # Examples
/// ```
/// use stiction::asperity::{LawParameters, Path, model};
/// use stiction::engine::{Job, Replica};
/// use stiction::surface::Surface;
///
/// # let law = model("md").unwrap().law(&LawParameters::scaled(0.5, Path::Approach)?)?;
/// # let surface = Surface::uniform(1.0, 1.0, 100, 1.0);
/// # let separations: Vec<f64> = (0..40).map(|k| 0.1 * f64::from(k)).collect();
/// let ensemble = Job::new(law.as_ref(), &surface, &separations, 64, 1).ensemble();
/// let Replica { asperity_count, pull_off_force, pull_off_at_edge, .. } = ensemble.replicas[0];
/// assert_eq!(asperity_count, 100);
/// assert!(pull_off_force > 0.0 && !pull_off_at_edge);
/// # Ok::<(), stiction::asperity::LawError>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Replica {
    /// Number of asperities.
    pub asperity_count: u64,
    /// Highest asperity above the asperity mean plane, m.
    pub highest_asperity: f64,
    /// −min F along its own curve, between the separations too, N.
    pub pull_off_force: f64,
    /// Separation h of the pull-off, m.
    pub pull_off_separation: f64,
    /// Largest secant stiffness of its own curve over the span of the job, N/m; NaN if the job has none.
    pub peak_secant_stiffness: f64,
    /// Separation h in the middle of the span there, m.
    pub peak_secant_stiffness_separation: f64,
    /// Whether the smallest force is at the first or last separation, so that the curve may fall further
    /// beyond.
    pub pull_off_at_edge: bool,
    /// The record of it as a loop, if it is one; all above is then of the retraction.
    pub cycle: Option<Box<Cycle>>,
    /// Further numbers, of coupled asperities.
    pub coupled: Option<Box<CoupledReplica>>,
}

/// The record of a replica with coupled asperities, in addition to every replica's.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct CoupledReplica {
    /// The record of the same asperities without coupling.
    pub independent: Replica,
    /// States in which no stable one was found.
    pub unsettled: u64,
    /// Asperities in the largest avalanche.
    pub largest_avalanche: u64,
    /// Largest (a_i + a_j)/r_ij of all pairs in all states, contact radii over distance.
    pub largest_crowding: f64,
    /// States in which circles of contact overlap.
    pub overlapping: u64,
    /// Avalanches by their size: of 2^k to 2^(k+1) − 1 asperities.
    pub avalanche_sizes: [u64; CLASSES],
    /// Energy that avalanches lost in all states, J.
    pub energy_lost: f64,
    /// States in which energy was lost, by [`energy_class`](crate::coupled::energy_class).
    pub energy_classes: [u64; ENERGY_CLASSES],
    /// The asperities one by one, of the first replica where that is asked for.
    pub asperities: Option<Box<AsperityStates>>,
}

impl CoupledReplica {
    /// The record by curves with coupling, without asperities one by one.
    pub(super) fn new(independent: Replica, coupled: &CoupledCurves) -> Self {
        let total = |values: &[f64]| values.iter().sum::<f64>() as u64;
        let largest = |values: &[f64]| values.iter().copied().fold(0.0, f64::max);
        Self {
            independent,
            unsettled: total(&coupled.unsettled),
            largest_avalanche: largest(&coupled.largest_avalanche) as u64,
            largest_crowding: largest(&coupled.crowding),
            overlapping: total(&coupled.overlapping()),
            avalanche_sizes: coupled.avalanche_sizes,
            energy_lost: coupled.energy_lost.iter().sum(),
            energy_classes: coupled.energy_classes,
            asperities: None,
        }
    }
}

impl Replica {
    fn pull_off(&mut self, smallest: &Extremum) {
        (self.pull_off_force, self.pull_off_separation) = (-smallest.value, smallest.place);
        self.pull_off_at_edge = smallest.at_edge;
    }

    pub(super) fn stiffest(&mut self, secant: &Extremum) {
        (self.peak_secant_stiffness, self.peak_secant_stiffness_separation) = (secant.value, secant.place);
    }
}

/// Memory that batches reuse one after the other.
pub struct Workspace {
    heights: Vec<Vec<f64>>,
    /// The radii of the surface that is summed, where asperities differ in their radii.
    radii: Vec<f64>,
    /// The asperities of that, and memory for their sums.
    asperities: Option<Asperities>,
    pulled: Option<PulledBack>,
    lane_sums: LaneSums,
    kinks: Kinks,
    table: ForceTable,
    sums: Sums,
    moments: Option<MomentSums>,
    /// The curves of the surfaces that were summed last.
    pub curves: Vec<Curves>,
}

impl Workspace {
    /// Memory for replicas of a job.
    pub fn new(job: &Job<'_>) -> Self {
        let r = job.laws.regimes().len();
        let at_once = if job.moments.is_some() && job.surface.asperity_count <= MANY { LANES } else { 1 };
        let kinks = Kinks::new(job);
        Self {
            heights: vec![Vec::new(); at_once],
            radii: Vec::new(),
            asperities: None,
            pulled: None,
            lane_sums: LaneSums::new(r),
            table: ForceTable::of(job, &kinks),
            kinks,
            sums: Sums::new(r),
            moments: job.moments.map(|matrix| MomentSums::new(matrix, r)),
            curves: vec![Curves::new(job.states(), r); at_once],
        }
    }

    /// The cost of the surfaces since the last call.
    pub fn take_stats(&mut self) -> SolverStats {
        std::mem::take(&mut self.sums.stats)
    }

    /// Draws replicas, sums them over all separations, and visits each with what is kept of it and its
    /// curves.
    pub fn replicas(&mut self, job: &Job<'_>, replicas: Range<u64>, visit: impl FnMut(Replica, &Curves)) {
        self.replicas_until(job, replicas, &|| false, visit);
    }

    /// Draws and visits replicas until `ends` is true, which is looked at before each sum, and for coupled ones before each
    /// separation: then the replica at hand is not visited, nor any further one.
    /// Whether all were visited.
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
        // Each takes seconds, so the replicas of a batch are computed side by side.
        let of = CoupledJob { job, substrate, ends };
        let coupled: Vec<_> = independent.into_par_iter().map(|replica| coupled(of, replica)).collect();
        for coupled in coupled {
            let Some((kept, curves, stats)) = coupled else { return false };
            self.sums.stats.merge(&stats);
            visit(kept, &curves);
        }
        all
    }

    /// Draws replicas, sums them as independent ones, and visits each with its index, what is kept of it and its curves,
    /// until `ends` is true, which is looked at before each sum. Whether all were visited.
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
            self.sum(job, at_once as usize);
            for lane in 0..at_once as usize {
                let kept = self.keep(job, lane);
                visit(first + lane as u64, kept, &self.curves[lane]);
            }
            first += at_once;
        }
        true
    }

    /// Sums the first `count` surfaces, whose heights it sorts: rising heights make the regimes contiguous,
    /// and neighbours in a slice neighbours in the law.
    fn sum(&mut self, job: &Job<'_>, count: usize) {
        if let (Some(matrix), Some(moments)) = (job.moments, &mut self.moments) {
            moments.take(matrix, &self.heights[..count]);
            moments.fill(matrix, job.laws.typical, &mut self.curves[..count], &mut self.sums.stats);
        }
        if let Some(family) = job.laws.family {
            let asperities = Asperities::new(family, &self.heights[0], &self.radii);
            let (stats, curves) = (&mut self.sums.stats, &mut self.curves[0]);
            let (s, ways) = (job.separations.len(), job.ways());
            if ways != Ways::Back {
                asperities.record(job, &mut self.lane_sums, stats, curves);
            }
            self.pulled = job.protocol.cycle.map(|cycle| {
                let pulled = asperities.turn(job, cycle, job.separations[0], stats);
                pulled.record((job, cycle), ways.pulled() * s, &mut self.lane_sums, stats, curves);
                if let Some(again) = cycle.again() {
                    let closer = asperities.turn(job, again, job.separations[0], stats);
                    closer.record((job, again), 2 * s, &mut self.lane_sums, stats, curves);
                }
                pulled
            });
            self.asperities = Some(asperities);
            return;
        }
        let states = State::all(job);
        for (lane, heights) in self.heights[..count].iter_mut().enumerate() {
            if self.moments.as_ref().is_some_and(|moments| moments.surface(lane).is_some()) {
                continue;
            }
            heights.sort_unstable_by(f64::total_cmp);
            self.sums.forget();
            for (k, state) in states.iter().enumerate() {
                self.sums.surface(job, heights, *state);
                RegimeSums::record(&self.sums.regimes, k, &mut self.curves[lane]);
            }
        }
    }

    /// The record of a surface that has been summed.
    fn keep(&mut self, job: &Job<'_>, lane: usize) -> Replica {
        let heights = self.heights[lane].as_slice();
        let moments = job.moments.zip(self.moments.as_mut());
        let mut surface =
            HeldSurface {
                job,
                heights,
                asperities: self.asperities.as_ref().map(|asperities| (asperities, &mut self.lane_sums)),
                pulled: &mut self.pulled,
                kinks: &self.kinks,
                table: &mut self.table,
                places: None,
                places_back: None,
                highest: heights.iter().copied().reduce(f64::max).unwrap_or(f64::NAN),
                sums: &mut self.sums,
                moments: moments
                    .filter(|(_, sums)| sums.surface(lane).is_some())
                    .map(|(matrix, sums)| OfLane { matrix, sums, lane }),
            };
        keep(job, &mut surface, heights.len(), &mut self.curves[lane])
    }
}

/// A replica with its curves, its asperities coupled, and the cost of that; nothing when that was ended.
fn coupled(of: CoupledJob<'_>, independent: Independent) -> Option<(Replica, Curves, SolverStats)> {
    let (mut stats, count) = (SolverStats::default(), independent.kept.asperity_count as usize);
    let keep = |surface: &mut dyn Summed, curves: &mut Curves| keep(of.job, surface, count, curves);
    let (kept, curves) = of.couple(independent, &mut stats, keep);
    (!(of.ends)()).then_some((kept, curves, stats))
}

/// The record of a surface of `count` asperities whose curves are known; its snaps are left in these, and the
/// attraction of the mean planes in the external force.
fn keep(job: &Job<'_>, surface: &mut dyn Summed, count: usize, curves: &mut Curves) -> Replica {
    for (force, state) in curves.total[Quantity::ExternalForce.index()].iter_mut().zip(State::all(job)) {
        *force = state.external_force(job.surface, *force);
    }
    let (s, external) = (job.separations.len(), &curves.total[Quantity::ExternalForce.index()]);
    let (first, pulled) = (&external[..s], &external[job.ways().pulled() * s..][..s]);
    let highest_asperity = surface.highest();
    let mut kept = Replica { asperity_count: count as u64, highest_asperity, ..Replica::default() };
    if let Some(cycle) = job.protocol.cycle.filter(|_| job.ways().is_loop()) {
        let (pull_off, contacts) = (surface.pull_off(first), surface.contacts(cycle));
        kept.cycle = Some(Box::new(Cycle::new(job, highest_asperity, contacts, curves, &pull_off)));
    }
    let from = job.protocol.cycle.map(|_| job.separations[0]);
    let pull_off = match from {
        Some(from) => surface.retraction_pull_off(from, &job.samples(pulled)),
        None => surface.pull_off(pulled),
    };
    kept.pull_off(&pull_off);
    let unknown = Extremum { place: f64::NAN, value: f64::NAN, at_edge: false };
    let stiffest = |span| surface.stiffest(from, &job.samples(pulled), span);
    kept.stiffest(&job.protocol.stiffness_span.map_or(unknown, stiffest));
    if job.protocol.loading.length() > 0 {
        curves.snaps = snaps(job, surface, first, (pulled, pull_off));
    }
    kept
}
