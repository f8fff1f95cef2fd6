//! Experiments on scenes: the integral, the ensemble, its cross-check, and what is found out, kept and
//! written.

mod background;
pub(crate) mod capillary;
pub(crate) mod coupling;
pub(crate) mod datasets;
mod error;
pub(crate) mod files;
mod host;
pub(crate) mod independence;
pub(crate) mod integral;
mod keeper;
pub mod layouts;
pub(crate) mod merge;
pub(crate) mod model_range;
mod observer;
pub(crate) mod partial;
pub(crate) mod points;
pub(crate) mod prepared;
pub(crate) mod result_file;
pub(crate) mod results;
pub(crate) mod run;
pub(crate) mod sampling;
pub(crate) mod scene_file;
pub(crate) mod shard_set;
pub(crate) mod snaps;
mod stack;
pub(crate) mod stacked;

pub use error::Error;
pub use files::sweep;
pub(crate) use host::Host;
pub use integral::{Integral, PathIntegral};
pub use observer::Observer;
pub(crate) use observer::Phases;
pub use run::{Builder, RunResult, builder, integrate, run};
pub use stacked::SweepPoint;
