//! The record of a surface that is brought close and pulled back.

use super::curves::Curves;
use super::job::{Job, Ways};
use super::summed::Contacts;
use crate::asperity::Quantity;
use crate::math::extrema::Extremum;
use crate::math::sums::SUM_ROUNDING;
use serde::{Deserialize, Serialize};

/// The record of a replica whose retraction is another than its approach.
///
/// # Examples
/// ```
/// use stiction::asperity::{LawParameters, Loop, Path, model};
/// use stiction::engine::{Cycle, Job, Protocol};
/// use stiction::surface::Surface;
///
/// // Hertz's contact has no hysteresis, so nothing is lost.
/// let parameters = LawParameters::scaled(1.0, Path::Approach)?;
/// let cycle = Loop::new(&model("hertz").unwrap(), &parameters)?;
/// let surface = Surface::uniform(1.0, 1.0, 100, 1.0);
/// let protocol = Protocol { cycle: Some(&cycle), ..Protocol::default() };
/// let job = Job { protocol, ..Job::new(cycle.approach(), &surface, &[0.0, 1.0, 2.0], 8, 1) };
/// let lost = |cycle: &Cycle| cycle.dissipated_energy;
/// assert!(job.ensemble().replicas.iter().all(|replica| lost(replica.cycle.as_ref().unwrap()) == 0.0));
/// # Ok::<(), stiction::asperity::LawError>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Cycle {
    /// −min F on approach, between the separations too, N.
    pub approach_pull_off_force: f64,
    /// Separation h there, m.
    pub approach_pull_off_separation: f64,
    /// ∫F dh of the approach less that of the retraction, J, with F in straight lines between the
    /// separations; 0 where it is below its rounding.
    pub dissipated_energy: f64,
    /// Dissipated energy of each further cycle to the same depth, J; none where there is one cycle.
    pub repeated_dissipated_energy: Option<f64>,
    /// Separation h at which the first asperity touches on approach, m, wherever the separations are;
    /// NaN of no asperities.
    pub touchdown_separation: f64,
    /// Separation h at which the last contact is lost on retraction, m; NaN if there was none.
    pub detachment_separation: f64,
}

impl Cycle {
    /// The record of a surface: its highest asperity, m, NaN of none, its first and last contact, its curves over the states
    /// of the job, and the pull-off on approach.
    pub(super) fn new(
        job: &Job<'_>,
        highest: f64,
        contacts: Contacts,
        curves: &Curves,
        pull_off: &Extremum,
    ) -> Self {
        let s = job.separations.len();
        let quantities = [Quantity::AdhesionForce, Quantity::ContactForce];
        let way =
            |way: usize| quantities.map(|quantity| &curves.total[quantity.index()][way * s..(way + 1) * s]);
        let lost = |inward| dissipated(job.separations, [way(inward), way(1)], SUM_ROUNDING, highest);
        Self {
            approach_pull_off_force: -pull_off.value,
            approach_pull_off_separation: pull_off.place,
            dissipated_energy: lost(0),
            repeated_dissipated_energy: (job.ways() == Ways::Repeated).then(|| lost(2)),
            touchdown_separation: contacts.touchdown,
            detachment_separation: contacts.detachment,
        }
    }
}

/// ∫F dh of the approach less that of the retraction, J, by the trapezoidal rule, from F_s and P of both, N,
/// over rising separations, m; 0 where it is below its rounding. `error` is that of F_s and P, relative;
/// `highest`, m, is the highest asperity.
///
/// The interference of an asperity takes at most 8 roundings of lengths within |h| + |u| on either way, and
/// moves the forces along their curves by as much.
pub fn dissipated(separations: &[f64], ways: [[&[f64]; 2]; 2], error: f64, highest: f64) -> f64 {
    let [approach, retraction] = ways;
    let difference = |k: usize| (approach[1][k] - approach[0][k]) - (retraction[1][k] - retraction[0][k]);
    let magnitude = |k: usize| approach[0][k] + approach[1][k] + retraction[0][k] + retraction[1][k];
    let (first, last) = (separations[0], separations[separations.len() - 1]);
    let offset = 4.0 * f64::EPSILON * (first.abs().max(last.abs()) + highest.abs());
    let (mut energy, mut rounding) = (0.0, 0.0);
    for k in 0..separations.len() - 1 {
        let half = 0.5 * (separations[k + 1] - separations[k]);
        energy += half * (difference(k) + difference(k + 1));
        rounding += error * half * (magnitude(k) + magnitude(k + 1));
        let moves = |force: &[f64]| (force[k + 1] - force[k]).abs();
        rounding += offset * ways.iter().flatten().map(|force| moves(force)).sum::<f64>();
    }
    if energy.abs() <= rounding { 0.0 } else { energy }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// F_s = 1 N and P = 3 N over 2 nm on either way: 16e-9 J in all, of which SUM_ROUNDING is 7e-23 J. The
    /// places are off by up to 2e-23 m, which takes nothing where no force changes.
    #[test]
    fn what_is_below_its_rounding_is_nothing() {
        let (separations, adhesion, contact) = ([0.0, 1e-9, 2e-9], [1.0; 3], [3.0; 3]);
        let lost = |loss: f64| {
            let less = [3.0, 3.0 - loss, 3.0];
            dissipated(&separations, [[&adhesion, &contact], [&adhesion, &less]], SUM_ROUNDING, 1e-9)
        };
        for loss in [2e-13, 0.5, -2e-13] {
            assert!((lost(loss) / (loss * 1e-9) - 1.0).abs() < 1e-2, "{loss}: {:e}", lost(loss));
        }
        for loss in [0.0, 4e-14, -4e-14] {
            assert_eq!(lost(loss), 0.0, "{loss}");
        }
    }

    /// F of the approach less that of the retraction is 6, 2, 0 and −1 N at 0, 1, 3 and 7 nm: trapezoids of 4, 2 and
    /// −2 N nm, each alone, and 4e-9 J in all.
    #[test]
    fn every_interval_dissipates_its_trapezoid() {
        let (separations, none) = ([0.0, 1e-9, 3e-9, 7e-9], [0.0; 4]);
        let (approach, retraction) = ([6.0, 3.0, 1.0, 0.0], [0.0, 1.0, 1.0, 1.0]);
        let lost = |from: usize, to: usize| {
            let way = |contact| [&none[from..to], contact];
            let ways = [way(&approach[from..to]), way(&retraction[from..to])];
            dissipated(&separations[from..to], ways, SUM_ROUNDING, 1e-9)
        };
        for (from, to, energy) in [(0, 2, 4e-9), (1, 3, 2e-9), (2, 4, -2e-9), (0, 4, 4e-9)] {
            assert!((lost(from, to) / energy - 1.0).abs() < 1e-14, "{from} {to}: {:e}", lost(from, to));
        }
    }
}
