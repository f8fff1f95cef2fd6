//! The asperities of a coupled surface one by one, in some of its states.

use crate::coupled::Solver;
use serde::{Deserialize, Serialize};

/// The asperities of a replica, in the order in which they were drawn or measured, and some of its states.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct AsperityStates {
    /// x and y of each, m.
    pub places: Vec<[f64; 2]>,
    /// Heights of the asperities above their mean plane, m.
    pub heights: Vec<f64>,
    /// Radii of the asperities, m.
    pub radii: Vec<f64>,
    /// The states that are asked for.
    pub states: Vec<AsperityState>,
}

/// All asperities in one state.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct AsperityState {
    /// The index of the state.
    pub state: u64,
    /// δ of each, m.
    pub interference: Vec<f64>,
    /// F_s of each, N.
    pub adhesion: Vec<f64>,
    /// P of each, N.
    pub contact: Vec<f64>,
    /// Contact area of each, m².
    pub area: Vec<f64>,
    /// Whether each is in contact, has touched, and is at rest at a jump of its law.
    pub flags: [Vec<u8>; 3],
}

impl AsperityState {
    /// The present state of a surface of which `is_contact` says by number which regimes are of contact;
    /// `order` is the number of each of its asperities among those that were drawn.
    pub fn of(solver: &Solver<'_>, state: usize, is_contact: impl Fn(usize) -> bool, order: &[u32]) -> Self {
        let (all, forces) = (solver.asperities(), &solver.forces);
        let touches = |i: usize| all.regime(&solver.states, i).is_some_and(&is_contact);
        let flags: [&dyn Fn(usize) -> bool; 3] = [&touches, &|i| touches(i) || solver.has_touched(i), &|i| {
            solver.states.resting.contains_key(&(i as u32))
        }];
        let each = |flag: &dyn Fn(usize) -> bool| -> Vec<u8> {
            (0..order.len()).map(|i| u8::from(flag(i))).collect()
        };
        Self {
            state: state as u64,
            interference: drawn(&solver.interference, order),
            adhesion: drawn(&forces.adhesion, order),
            contact: drawn(&forces.contact, order),
            area: drawn(&forces.area, order),
            flags: flags.map(|flag| drawn(&each(flag), order)),
        }
    }
}

/// Values in the order in which their asperities were drawn.
pub(super) fn drawn<T: Copy + Default>(values: &[T], order: &[u32]) -> Vec<T> {
    let mut all = vec![T::default(); values.len()];
    values.iter().zip(order).for_each(|(value, i)| all[*i as usize] = *value);
    all
}
