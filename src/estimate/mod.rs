//! What a run of a scene computes and what it takes, told before it begins: regimes, memory, disk and time.

mod plan;
mod size;
mod time;

pub use plan::{Plan, RegimePlan, beyond};
pub use size::{Choice, Estimate};
pub use time::Cost;
