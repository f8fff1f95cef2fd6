//! Surfaces of asperities that differ in their radii, each with a law of its own.

pub mod asperities;
mod curve;
mod pairs;
mod surface;

pub(super) use surface::{OfRadii, Solver};
