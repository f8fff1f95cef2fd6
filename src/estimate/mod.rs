//! Estimate of a run before it begins: what it computes, memory and disk.

mod plan;
mod size;

pub use plan::{Plan, RegimePlan, beyond};
pub use size::{Choice, Estimate};
