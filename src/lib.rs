//! Adhesion of rough surfaces from explicit ensembles of asperities.
//!
//! A scene says what surfaces there are, by which law their asperities attract each other, and how many
//! patches of them are drawn:
//!
//! ```
//! # let folder = tempfile::tempdir().unwrap();
//! # let output = folder.path().join("quick.h5");
//! let scene = stiction::Scene::from_toml_file("configs/quick.toml")?;
//! let results = stiction::run(&scene)?;
//! println!("{:.3e} N", results.pull_off().mean);
//! results.write(&output)?;
//! # Ok::<(), stiction::Error>(())
//! ```
//!
//! # What there is
//! Functions on this page compute a scene: [`run`] as above, [`sweep`] one with a table `[sweep]`, and [`integrate`]
//! the integral alone. [`builder`] sets an experiment up: threads, progress, an end from outside.
//!
//! An experiment goes one way, and so do the modules, each of which knows only what stands before it:
//! a [`scene`] is read and prepared (its laws, its integral), its ensemble is summed, [`Results`] follow from both, [`output`]
//! writes and reads them, and the program says them in words. No module but `output` and the program knows HDF5.
//!
//! Parts that know no scene can be used alone:
//! - [`asperity`]: laws of one asperity, from interference to forces and area, and laws of one's own;
//! - [`surface`]: heights, radii and numbers of asperities, and measured surfaces;
//! - [`background`]: van der Waals and electrostatic attraction of the mean planes;
//! - [`integral`]: the integral of a law over the heights of a surface;
//! - [`engine`]: ensembles of replicas, summed asperity by asperity or by moments;
//! - [`validation`]: tests of an ensemble against the integral.
//!
//! Every type is in an example, on its own page or on that of a type that it belongs to. The folder
//! `examples` has whole programs.
//!
//! # What may change
//! Before version 1.0 anything may, and the changelog says what. What is least likely to are the functions of
//! this page, [`Scene`] and the types that they return, [`surface`], and of [`asperity`] what makes a law.
//! What follows the needs of the program, and may change with any version, is [`engine`] and [`validation`],
//! and how a law shows itself to the sums. Files of results have versions of their own ([`output::Layout`]).
//! Items that are not on these pages are for the program and its tests, and change at any time.
//!
//! # Features
//! All are on by default.
//! - `cli`: the program `stiction`;
//! - `lab`: the calls of the page that computes in a browser, a part of `cli`;
//! - `hdf5`: files of results, and values of scenes in HDF5 files. Without it no C compiler is needed;
//! - `static`: libhdf5 and zlib are built from source; without it those of the system are used.

// The command line alone uses some of what experiments have.
#![cfg_attr(not(feature = "cli"), allow(dead_code, unused_imports))]

pub mod asperity;
pub mod background;
#[cfg(feature = "cli")]
#[doc(hidden)]
pub mod cli;
#[doc(hidden)]
pub mod coupled;
pub mod engine;
mod error;
#[doc(hidden)]
pub mod estimate;
#[doc(hidden)]
pub mod experiment;
mod format;
#[doc(hidden)]
pub mod input;
pub mod integral;
#[cfg(feature = "lab")]
#[doc(hidden)]
pub mod lab;
pub mod liquid;
#[doc(hidden)]
pub mod math;
#[cfg(feature = "hdf5")]
pub mod output;
pub mod scene;
pub mod substrate;
mod summary;
pub mod surface;
pub mod validation;

pub use error::{Error, OutputError};
#[doc(inline)]
pub use experiment::{Builder, Integral, Observer, PathIntegral, Results, builder, integrate, run};
#[doc(inline)]
pub use math::{
    control_variates::ControlledMean,
    extrema::{Extremum, Features},
};
#[cfg(feature = "hdf5")]
#[doc(inline)]
pub use output::layouts;
#[cfg(feature = "hdf5")]
#[doc(inline)]
pub use output::sweep::{PointPullOff, SweepPoint, sweep};
#[doc(inline)]
pub use scene::Scene;
