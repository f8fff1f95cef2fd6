//! Surfaces whose asperities are coupled through the elastic half-space under them.

mod asperities;
mod avalanches;
mod contacts;
mod energy;
mod fall;
mod half_space;
mod knots;
mod passages;
mod passing;
mod search;
mod settle;
mod solver;
mod sums;
mod systems;
#[cfg(test)]
mod tests;
mod tilt;

pub use asperities::{Asperities, Forces, RadiusLaws, States, distinct};
pub use avalanches::{Avalanches, CLASSES};
pub use energy::{ENERGY_CLASSES, energy_class, least_energy};
pub use half_space::HalfSpace;
pub use settle::Settled;
pub use solver::{Snapshot, Solver};
