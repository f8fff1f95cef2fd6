//! Experiments on scenes: the integral, the ensemble, its cross-check, and what is found out, kept and
//! written.

pub(crate) mod checkpoint;
pub(crate) mod compare;
mod error;
pub(crate) mod integral;
mod observer;
pub(crate) mod prepared;
pub(crate) mod record;
pub(crate) mod results;
pub(crate) mod run;
pub(crate) mod sampling;
pub(crate) mod scene_file;
pub(crate) mod snaps;

pub use compare::{ComparedLaw, Comparison, Mean};
pub use error::Error;
pub use integral::{Integral, PathIntegral};
pub use observer::Observer;
pub(crate) use observer::Phases;
pub use run::{Builder, RunResult, builder, compare, integrate, run};
