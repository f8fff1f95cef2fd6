//! The states that the surfaces of a job are summed in: separations on the branches of their path.

use super::job::{Job, Ways};
use crate::asperity::Loop;
use crate::surface::Surface;

/// A turn of the surfaces of a loop.
#[derive(Clone, Copy)]
pub(super) struct Reversal<'a> {
    /// The loop whose law acts from there on.
    pub cycle: &'a Loop,
    /// The separation h there, m.
    pub from: f64,
}

/// A branch of the path of a surface.
#[derive(Clone, Copy)]
pub(super) enum Branch<'a> {
    /// The path of the job's own law.
    Approach,
    /// The retraction of a loop.
    Retraction(Reversal<'a>),
    /// The second approach of a loop.
    Reapproach(Reversal<'a>),
}

impl<'a> Branch<'a> {
    /// The branches of a job's surfaces, in the order of its curves.
    pub fn all(job: &Job<'a>) -> Vec<Self> {
        let from = job.separations[0];
        let approach = (job.ways() != Ways::Back).then_some(Self::Approach);
        let cycle = job.protocol.cycle;
        let retraction = cycle.map(|cycle| Self::Retraction(Reversal { cycle, from }));
        let again = cycle.and_then(Loop::again).filter(|_| job.ways() == Ways::Repeated);
        let reapproach = again.map(|cycle| Self::Reapproach(Reversal { cycle, from }));
        approach.into_iter().chain(retraction).chain(reapproach).collect()
    }

    /// The turn at which the branch begins; none of the first.
    pub fn reversal(self) -> Option<Reversal<'a>> {
        match self {
            Self::Approach => None,
            Self::Retraction(reversal) | Self::Reapproach(reversal) => Some(reversal),
        }
    }

    /// The external force, N, of a surface at a separation h, m, whose asperities have another, N.
    pub fn external_force(self, surface: &Surface, separation: f64, of_asperities: f64) -> f64 {
        match self {
            Self::Approach => surface.external_force(separation, of_asperities),
            Self::Retraction(_) => surface.external_force_back(separation, of_asperities),
            Self::Reapproach(_) => surface.external_force_again(separation, of_asperities),
        }
    }
}
