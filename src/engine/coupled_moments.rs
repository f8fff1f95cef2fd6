//! Moments of the effects of coupling on an ensemble: its curves against the curves of the same asperities
//! without.

use super::curves::{CoupledCurves, Curves};
use super::groups::OpenGroup;
use super::job::Job;
use super::replica::Replica;
use super::scalars::scalars;
use crate::math::moments::Moments;
use serde::{Deserialize, Serialize};

/// Moments over replicas of ensembles with coupled asperities.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CoupledMoments {
    /// Curves of the same asperities without coupling, by [`Quantity::index`](crate::asperity::Quantity::index),
    /// each over the states.
    pub independent: [Moments; 4],
    /// Avalanches on the step to each state.
    pub avalanche_count: Moments,
    /// Asperities in the largest of them.
    pub largest_avalanche: Moments,
    /// Energy that they lost, J.
    pub energy_lost: Moments,
    /// Largest (a_i + a_j)/r_ij of all pairs.
    pub crowding: Moments,
    /// Replicas without a stable state, as shares.
    pub unsettled: Moments,
    /// Replicas in which circles of contact overlap, as shares.
    pub overlapping: Moments,
    /// Moments of the means of groups.
    pub groups: CoupledGroups,
}

/// Moments of the means of groups of replicas.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CoupledGroups {
    /// Curves without coupling.
    pub independent: [Moments; 4],
    /// Curves with coupling less those without.
    pub difference: [Moments; 4],
    /// Scalars without coupling, and with less without, of which NaN are none.
    pub scalars: [Moments; 2],
    #[serde(skip)]
    open: OpenGroup,
}

impl CoupledMoments {
    /// No replicas yet.
    pub fn new(job: &Job<'_>) -> Self {
        let s = job.states();
        let all = || std::array::from_fn(|_| Moments::new(s));
        let count = scalars(job.ways()).count();
        Self {
            independent: all(),
            avalanche_count: Moments::new(s),
            largest_avalanche: Moments::new(s),
            energy_lost: Moments::new(s),
            crowding: Moments::new(s),
            unsettled: Moments::new(s),
            overlapping: Moments::new(s),
            groups: CoupledGroups {
                independent: all(),
                difference: all(),
                scalars: std::array::from_fn(|_| Moments::new(count)),
                open: OpenGroup::default(),
            },
        }
    }

    /// Adds the next replica.
    pub fn push(&mut self, job: &Job<'_>, replica: &Replica, curves: &Curves, coupled: &CoupledCurves) {
        for (moments, curve) in self.independent.iter_mut().zip(&coupled.independent) {
            moments.push(curve);
        }
        self.avalanche_count.push(&coupled.avalanche_count);
        self.largest_avalanche.push(&coupled.largest_avalanche);
        self.energy_lost.push(&coupled.energy_lost);
        self.crowding.push(&coupled.crowding);
        self.unsettled.push(&coupled.unsettled);
        self.overlapping.push(&coupled.overlapping());
        self.groups.push(job, replica, curves, coupled);
    }

    /// All moments.
    fn all(&self) -> impl Iterator<Item = &Moments> {
        let groups = &self.groups;
        let lists = [&self.independent[..], &groups.independent, &groups.difference, &groups.scalars];
        let single = [
            &self.avalanche_count,
            &self.largest_avalanche,
            &self.energy_lost,
            &self.crowding,
            &self.unsettled,
            &self.overlapping,
        ];
        lists.into_iter().flatten().chain(single)
    }

    fn all_mut(&mut self) -> impl Iterator<Item = &mut Moments> {
        let groups = &mut self.groups;
        let lists =
            [&mut self.independent[..], &mut groups.independent, &mut groups.difference, &mut groups.scalars];
        let Self {
            avalanche_count, largest_avalanche, energy_lost, crowding, unsettled, overlapping, ..
        } = self;
        let single = [avalanche_count, largest_avalanche, energy_lost, crowding, unsettled, overlapping];
        lists.into_iter().flatten().chain(single)
    }

    /// Adds the replicas of other batches.
    pub fn merge(&mut self, other: &Self) {
        self.all_mut().zip(other.all()).for_each(|(mine, theirs)| mine.merge(theirs));
    }

    /// Whether both are of the same numbers of states and scalars.
    pub fn is_like(&self, other: &Self) -> bool {
        self.all().zip(other.all()).all(|(own, other)| own.is_like(other))
    }
}

impl CoupledGroups {
    fn push(&mut self, job: &Job<'_>, replica: &Replica, curves: &Curves, coupled: &CoupledCurves) {
        let (s, ways) = (job.states(), job.ways());
        let independent = coupled.independent.iter().flatten().copied();
        let difference = curves.total.iter().flatten().zip(coupled.independent.iter().flatten());
        let without = &replica.coupled.as_ref().expect("it is coupled").independent;
        let of_scalars = scalars(ways).map(|scalar| (scalar.of)(without));
        let changes = scalars(ways).map(|scalar| (scalar.of)(replica) - (scalar.of)(without));
        let values = independent.chain(difference.map(|(with, without)| with - without));
        let values = values.chain(of_scalars).chain(changes);
        let count = scalars(ways).count();
        let Some(means) = self.open.push(job, values) else { return };
        let (curves, scalars) = means.split_at(8 * s);
        let moments = self.independent.iter_mut().chain(&mut self.difference);
        moments.zip(curves.chunks_exact(s)).for_each(|(moments, curve)| moments.push(curve));
        let moments = self.scalars.iter_mut();
        moments.zip(scalars.chunks_exact(count)).for_each(|(moments, values)| moments.push(values));
    }
}
