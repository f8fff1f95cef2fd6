//! Adhesion of rough surfaces from explicit ensembles of asperities.
//!
//! A scene says what surfaces there are, by which law their asperities attract each other, and how many
//! patches of them are drawn:
//!
//! ```no_run
//! let scene = stiction::Scene::from_toml_file("configs/case_ii.toml")?;
//! let result = stiction::run(&scene)?;
//! println!("{:.3e} N", result.pull_off().mean);
//! result.write("case_ii.h5")?;
//! # Ok::<(), stiction::Error>(())
//! ```
//!
//! [`builder`] sets a run up: threads, progress, an end from outside. Below it, each by itself and without
//! any scene:
//! - [`asperity`]: laws of one asperity, from interference to forces and area;
//! - [`surface`]: heights, radii and numbers of asperities, and measured surfaces;
//! - [`integral`]: the integral of a law over a surface;
//! - [`engine`]: ensembles of replicas, summed asperity by asperity or by moments;
//! - [`validation`]: tests of one against the other;
//! - [`output`]: files of results, and how they are read back.
//!
//! The folder `examples` has programs that begin there. All of it may change before version 1.0.

pub mod asperity;
#[cfg(feature = "cli")]
pub mod cli;
pub mod engine;
#[cfg(feature = "hdf5")]
pub mod estimate;
#[cfg(feature = "hdf5")]
pub mod experiment;
#[cfg(feature = "hdf5")]
mod format;
pub mod integral;
pub mod math;
#[cfg(feature = "hdf5")]
pub mod output;
#[cfg(feature = "hdf5")]
pub mod scene;
#[cfg(test)]
mod source;
pub mod surface;
pub mod validation;

#[cfg(feature = "hdf5")]
pub use experiment::{Error, Observer, RunResult, builder, compare, integrate, run};
#[cfg(feature = "hdf5")]
pub use scene::Scene;
