//! Experiments on scenes, in the order in which they go: a scene is prepared, its ensemble is summed, and results follow
//! from both.

pub(crate) mod capillary;
pub(crate) mod coupling;
mod curves;
pub(crate) mod ensemble;
pub(crate) mod integral;
pub(crate) mod model_range;
mod observer;
mod prepared;
pub(crate) mod pull_offs;
pub(crate) mod results;
mod run;

pub(crate) mod snaps;
mod workers;

pub(crate) use curves::{CURVE_CHUNK, Curves, HELD};
pub use integral::{Integral, PathIntegral};
pub use observer::Observer;
pub(crate) use observer::Phases;
pub(crate) use prepared::{Functionals, PreparedRun, SceneLaws};
pub use results::Results;
pub use run::{Builder, builder, integrate, run};
pub(crate) use workers::{Workers, most_threads, thread_pool};
