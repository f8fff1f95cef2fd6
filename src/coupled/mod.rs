//! Surfaces whose asperities are coupled through the elastic half-space under them.

mod asperities;
mod avalanches;
mod solver;
#[cfg(test)]
mod tests;

pub use asperities::{Asperities, Forces, RadiusLaws, States, distinct};
pub use solver::{Settled, Snapshot, Solver, Substrate};
