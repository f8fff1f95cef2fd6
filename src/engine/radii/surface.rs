//! A surface of asperities that differ in their radii: its curves and what is sought of them.

use super::asperities::{Asperities, LaneSums, OnBranch, Reversed};
use super::curve::{ForceCurve, Places};
use crate::asperity::{Family, SolverStats};
use crate::engine::curves::Curves;
use crate::engine::job::Job;
use crate::engine::kinks::{Kinks, widest_spacing};
use crate::engine::search::Sought;
use crate::engine::state::{Branch, Reversal};
use crate::engine::summed::{Contacts, Summed};
use crate::math::extrema::Extremum;
use std::cell::OnceCell;

/// What surfaces of a job with radii are solved by, one after the other.
pub struct Solver {
    family: Family,
    kinks: Kinks,
    sums: LaneSums,
}

impl Solver {
    /// Memory for the surfaces of a job whose laws are a family.
    pub fn new(job: &Job<'_>, family: &Family) -> Self {
        let (family, kinks) = (family.clone(), Kinks::new(job));
        Self { family, kinks, sums: LaneSums::new(job.laws.regimes().len()) }
    }

    /// The cost of the surfaces since the last call.
    pub fn take_stats(&mut self) -> SolverStats {
        std::mem::take(&mut self.sums.stats)
    }
}

/// Asperities since they turned, and their kinks where they have been asked for.
struct Released {
    asperities: Reversed,
    places: OnceCell<Places>,
}

/// A surface with all its asperities.
pub struct OfRadii<'a> {
    job: &'a Job<'a>,
    solver: &'a mut Solver,
    asperities: Asperities,
    /// Their kinks on approach, where they have been asked for.
    places: OnceCell<Places>,
    /// The asperities since they turned last.
    released: Option<Released>,
}

impl<'a> OfRadii<'a> {
    /// A surface of asperities of heights and radii, m, summed in all states of the job.
    pub fn summed(
        job: &'a Job<'a>,
        solver: &'a mut Solver,
        (heights, radii): (&[f64], &[f64]),
        curves: &mut Curves,
    ) -> Self {
        let asperities = Asperities::new(&solver.family, heights, radii);
        let (sums, mut released) = (&mut solver.sums, None);
        for (i, branch) in Branch::all(job).into_iter().enumerate() {
            let first = i * job.separations.len();
            match branch.reversal() {
                None => OnBranch::Approach(&asperities).record(job, first, sums, curves),
                Some(reversal) => {
                    let reversed = asperities.turn(job, reversal, &mut sums.stats);
                    OnBranch::Reversed(reversal.cycle, &reversed).record(job, first, sums, curves);
                    // What is sought is on the retraction, which comes first.
                    released.get_or_insert(Released { asperities: reversed, places: OnceCell::new() });
                }
            }
        }
        Self { job, solver, asperities, places: OnceCell::new(), released }
    }

    /// Turns the asperities if they have not turned there last.
    fn turn(&mut self, reversal: Reversal<'_>) -> &Released {
        let Self { job, solver, asperities, released, .. } = self;
        let known = released.take().filter(|released| released.asperities.is_of(reversal));
        released.insert(known.unwrap_or_else(|| Released {
            asperities: asperities.turn(job, reversal, &mut solver.sums.stats),
            places: OnceCell::new(),
        }))
    }
}

impl Summed for OfRadii<'_> {
    fn highest(&self) -> f64 {
        self.asperities.heights.iter().copied().reduce(f64::max).unwrap_or(f64::NAN)
    }

    fn contacts(&mut self, reversal: Reversal<'_>) -> Contacts {
        let detachment = self.turn(reversal).asperities.detachment(reversal.cycle);
        let touchdown = self.asperities.touchdown(reversal.cycle);
        let touchdown = if touchdown.is_finite() { touchdown } else { f64::NAN };
        Contacts { touchdown: touchdown + self.job.surface.mean_plane_offset, detachment }
    }

    fn retraction(&mut self, reversal: Reversal<'_>, separations: &[f64]) -> Vec<f64> {
        self.turn(reversal);
        let Self { job: Job { surface, .. }, solver, released, .. } = self;
        let Some(Released { asperities, .. }) = released else { unreachable!("they have turned") };
        let force = |to: &f64| {
            let d = surface.asperity_separation(*to);
            let branch = OnBranch::Reversed(reversal.cycle, asperities);
            surface.external_force_back(*to, branch.external_force(None, d, &mut solver.sums))
        };
        separations.iter().map(force).collect()
    }

    fn find(&mut self, sought: Sought, branch: Branch<'_>, samples: &[(f64, f64)]) -> Extremum {
        if let Some(reversal) = branch.reversal() {
            self.turn(reversal);
        }
        let Self { job, solver: Solver { kinks, sums, .. }, asperities, places, released } = self;
        let (branch, places) = match (branch.reversal(), released) {
            (Some(Reversal { cycle, .. }), Some(Released { asperities, places })) => {
                (OnBranch::Reversed(cycle, asperities), &*places)
            }
            _ => (OnBranch::Approach(asperities), &*places),
        };
        let places = places.get_or_init(|| Places::new(job, asperities.heights.len(), branch));
        let mut curve = ForceCurve::new(job, (kinks, places), (asperities, branch), sums);
        sought.find(&mut curve, samples, widest_spacing(job))
    }
}
