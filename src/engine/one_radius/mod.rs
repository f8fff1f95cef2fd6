//! Surfaces of asperities of one radius, which have one law: asperity by asperity, or by moments of their heights.

mod approach;
mod force_table;
mod retraction;
mod sums;
mod surface;

pub(super) use surface::{OfOneRadius, Solver};
