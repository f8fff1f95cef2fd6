//! Sums over the asperities of a surface, by state: the separations, and of a loop the separations of the
//! retraction behind these.

use crate::asperity::{Quantity, Responses};
use crate::coupled::{CLASSES, ENERGY_CLASSES};
use crate::math::instruction_set::InstructionSet;
use crate::math::sums::{Compensated, lane_sum};
use serde::{Deserialize, Serialize};

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

    /// Adds what lanes respond with.
    pub fn add_lanes(&mut self, responses: &Responses, n: usize, touches: bool) {
        InstructionSet::current().run(
            #[inline(always)]
            || {
                self.adhesion.add(lane_sum(&responses.adhesion[..n]));
                // Where nothing touches there is neither load nor area.
                if touches {
                    self.contact.add(lane_sum(&responses.contact[..n]));
                    self.area.add(lane_sum(&responses.area[..n]));
                }
            },
        );
    }
}

/// Curves of one surface over S states and R regimes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Curves {
    /// Sums over all asperities, by [`Quantity::index`](crate::asperity::Quantity::index), each over S.
    pub total: [Vec<f64>; 4],
    /// Asperities in each regime, R × S.
    pub regime_count: Vec<f64>,
    /// Adhesion force of each regime, N, R × S.
    pub regime_adhesion_force: Vec<f64>,
    /// External force of each regime, N, R × S.
    pub regime_external_force: Vec<f64>,
    /// The snaps, in the order of [`Loading::length`](super::Loading::length).
    pub snaps: Vec<f64>,
    /// Further curves, of coupled asperities.
    pub coupled: Option<Box<CoupledCurves>>,
}

/// Curves of a surface with coupled asperities, over S states, in addition to its sums.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CoupledCurves {
    /// Sums over the same asperities without coupling, by [`Quantity::index`](crate::asperity::Quantity::index),
    /// each over S.
    pub independent: [Vec<f64>; 4],
    /// Avalanches on the step to each state.
    pub avalanche_count: Vec<f64>,
    /// Asperities in the largest of them.
    pub largest_avalanche: Vec<f64>,
    /// 1 where no stable state was found, else 0.
    pub unsettled: Vec<f64>,
    /// Largest (a_i + a_j)/r_ij of all pairs.
    pub crowding: Vec<f64>,
    /// Energy that avalanches lost on the step to each state, J.
    pub energy_lost: Vec<f64>,
    /// Avalanches of all steps by their size: of 2^k to 2^(k+1) − 1 asperities.
    pub avalanche_sizes: [u64; CLASSES],
    /// Steps on which energy was lost, by [`energy_class`](crate::coupled::energy_class).
    pub energy_classes: [u64; ENERGY_CLASSES],
}

impl CoupledCurves {
    /// Curves of which only the ones of the same asperities without coupling are known yet.
    pub(super) fn new(independent: &Curves) -> Self {
        let states = independent.total[0].len();
        let [avalanche_count, largest_avalanche, unsettled, crowding, energy_lost] =
            std::array::from_fn(|_| vec![0.0; states]);
        Self {
            independent: independent.total.clone(),
            avalanche_count,
            largest_avalanche,
            unsettled,
            crowding,
            energy_lost,
            avalanche_sizes: [0; CLASSES],
            energy_classes: [0; ENERGY_CLASSES],
        }
    }

    /// 1 where circles of contact overlap, else 0.
    pub(super) fn overlapping(&self) -> Vec<f64> {
        self.crowding.iter().map(|crowding| f64::from(u8::from(*crowding > 1.0))).collect()
    }
}

impl Curves {
    /// Nothing yet, over `s` states and `r` regimes.
    pub(super) fn new(s: usize, r: usize) -> Self {
        Self {
            total: std::array::from_fn(|_| vec![0.0; s]),
            regime_count: vec![0.0; r * s],
            regime_adhesion_force: vec![0.0; r * s],
            regime_external_force: vec![0.0; r * s],
            snaps: Vec::new(),
            coupled: None,
        }
    }

    /// Whether they are over `s` states and `r` regimes.
    pub(super) fn is_like(&self, s: usize, r: usize) -> bool {
        let of_regimes = [&self.regime_count, &self.regime_adhesion_force, &self.regime_external_force];
        self.total.iter().all(|curve| curve.len() == s) && of_regimes.iter().all(|curve| curve.len() == r * s)
    }

    /// Takes the sums of all regimes as those in a state.
    pub(super) fn record(&mut self, state: usize, regimes: &[RegimeSums]) {
        let states = self.total[0].len();
        for (regime, sum) in regimes.iter().enumerate() {
            let place = regime * states + state;
            self.regime_count[place] = sum.count;
            self.regime_adhesion_force[place] = sum.adhesion.value();
            self.regime_external_force[place] = sum.contact.value() - sum.adhesion.value();
        }
        for (curve, value) in self.total.iter_mut().zip(RegimeSums::total(regimes)) {
            curve[state] = value;
        }
    }
}
