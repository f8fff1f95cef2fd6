//! Estimate of a run before it begins: what it computes, memory, disk and time.

mod plan;
mod size;
mod time;

pub use plan::{Plan, RegimePlan, beyond};
pub use size::{Choice, Estimate};
pub use time::Cost;
