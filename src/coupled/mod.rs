//! Surfaces whose asperities are coupled through the elastic half-space under them.

mod asperities;
mod avalanches;
mod contacts;
mod half_space;
mod passages;
mod solver;
#[cfg(test)]
mod tests;

pub use asperities::{Asperities, Forces, RadiusLaws, States, distinct};
pub use avalanches::{Avalanches, CLASSES};
pub use half_space::HalfSpace;
pub use solver::{Settled, Snapshot, Solver};
