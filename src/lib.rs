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
//! As short are [`sweep`] for a scene with a table `[sweep]`, [`finite_size()`] for patches of several sizes,
//! [`compare()`] for laws on the same asperities and [`integrate`] for the integral alone; [`builder`] sets
//! an experiment up: threads, progress, an end from outside. Below these, each by itself and without any
//! scene:
//! - [`asperity`]: laws of one asperity, from interference to forces and area, and laws of one's own;
//! - [`surface`]: heights, radii and numbers of asperities, and measured surfaces;
//! - [`integral`]: the integral of a law over the heights of a surface;
//! - [`engine`]: ensembles of replicas, summed asperity by asperity or by moments;
//! - [`validation`]: tests of an ensemble against the integral;
//! - [`output`]: files of results, and how they are read back.
//!
//! The folder `examples` has a program for each. All of it may change before version 1.0. Items that are not
//! on these pages are for the program's own tests and change at any time.
//!
//! # Features
//! All are on by default.
//! - `cli`: the program `stiction`;
//! - `hdf5`: scenes, experiments on them and files of results. Without it laws, surfaces, integrals,
//!   ensembles and their checks are there, and no C compiler is needed;
//! - `static`: libhdf5 and zlib are built from source; without it those of the system are used.

// The command line alone uses some of what experiments have.
#![cfg_attr(not(feature = "cli"), allow(dead_code, unused_imports))]

pub mod asperity;
#[cfg(feature = "hdf5")]
#[doc(hidden)]
pub mod audit;
#[cfg(feature = "cli")]
#[doc(hidden)]
pub mod cli;
pub mod engine;
#[cfg(feature = "hdf5")]
#[doc(hidden)]
pub mod estimate;
#[cfg(feature = "hdf5")]
pub mod experiment;
#[cfg(feature = "hdf5")]
mod format;
pub mod integral;
#[doc(hidden)]
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
pub use experiment::{Error, Observer, RunResult, builder, compare, finite_size, integrate, run, sweep};
#[cfg(feature = "hdf5")]
pub use scene::Scene;
