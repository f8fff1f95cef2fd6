//! The record of one replica.

use super::asperity_states::AsperityStates;
use super::curves::{CoupledCurves, Curves};
use super::cycle::Cycle;
use super::job::Job;
use super::search::Sought;
use super::snaps::snaps;
use super::state::{Branch, Reversal};
use super::summed::Summed;
use crate::asperity::Quantity;
use crate::coupled::{CLASSES, ENERGY_CLASSES};
use crate::math::extrema::Extremum;
use serde::{Deserialize, Serialize};

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
    /// Whether the smallest force is at the first or last separation, or within a step of them, where a law that jumps may have it,
    /// so that the curve may fall further beyond.
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

/// Whether a place is in the first or the last step of separations.
fn is_in_end_step(place: f64, separations: &[f64]) -> bool {
    matches!(separations, [_, second, .., before, _] if place < *second || place > *before)
}

impl Replica {
    /// The record of a surface of `count` asperities whose curves are known; its snaps are left in these, and the
    /// attraction of the mean planes in the external force.
    pub(super) fn new(job: &Job<'_>, surface: &mut dyn Summed, count: usize, curves: &mut Curves) -> Self {
        let (s, external) = (job.separations.len(), &mut curves.total[Quantity::ExternalForce.index()]);
        for (branch, forces) in Branch::all(job).into_iter().zip(external.chunks_exact_mut(s)) {
            for (h, force) in job.separations.iter().zip(forces) {
                *force = branch.external_force(job.surface, *h, *force);
            }
        }
        let external = &curves.total[Quantity::ExternalForce.index()];
        let (first, pulled) = (&external[..s], &external[job.ways().pulled() * s..][..s]);
        let highest_asperity = surface.highest();
        let reversal = job.protocol.cycle.map(|cycle| Reversal { cycle, from: job.separations[0] });
        let mut kept = Self { asperity_count: count as u64, highest_asperity, ..Self::default() };
        if let Some(reversal) = reversal.filter(|_| job.ways().is_loop()) {
            let pull_off = surface.find(Sought::PullOff, Branch::Approach, &job.samples(first));
            let contacts = surface.contacts(reversal);
            kept.cycle = Some(Box::new(Cycle::new(job, highest_asperity, contacts, curves, &pull_off)));
        }
        let (branch, samples) = (reversal.map_or(Branch::Approach, Branch::Retraction), job.samples(pulled));
        let pull_off = surface.find(Sought::PullOff, branch, &samples);
        (kept.pull_off_force, kept.pull_off_separation) = (-pull_off.value, pull_off.place);
        kept.pull_off_at_edge = pull_off.at_edge || is_in_end_step(pull_off.place, job.separations);
        let unknown = Extremum { place: f64::NAN, value: f64::NAN, at_edge: false };
        let stiffest = |span| surface.find(Sought::Stiffness(span), branch, &samples);
        kept.stiffest(&job.protocol.stiffness_span.map_or(unknown, stiffest));
        if job.protocol.loading.length() > 0 {
            curves.snaps = snaps(job, surface, first, (pulled, pull_off));
        }
        kept
    }

    pub(super) fn stiffest(&mut self, secant: &Extremum) {
        (self.peak_secant_stiffness, self.peak_secant_stiffness_separation) = (secant.value, secant.place);
    }
}
