//! Scenes: from TOML to what the program computes, or to an error that says what to change.
//!
//! A file is read by [`Scene::from_toml_file`], or where it may be a sweep by [`Document::from_toml_file`].

mod axes;
mod background;
mod canonical;
mod capillary;
mod column;
mod definition;
mod device;
mod document;
#[doc(hidden)]
pub mod echo;
mod ensemble;
mod error;
#[doc(hidden)]
pub mod files;
mod instability;
pub(crate) mod keys;
mod laws;
mod lookup;
mod material;
mod measured;
mod mode;
mod model;
mod parse;
mod population;
mod ranges;
mod reader;
mod separation;
#[doc(hidden)]
pub mod settings;
mod shape;
mod solver;
mod substrate;
mod summits;
#[doc(hidden)]
pub mod sweep;
mod table;
mod taken;
#[doc(hidden)]
pub mod units;
mod validity;
mod warning;

pub use axes::Axis;
#[doc(hidden)]
pub use axes::{MOST_KEYS, SWEEPABLE, Sweepable};
pub(crate) use background::FORCES;
#[doc(hidden)]
pub use canonical::difference;
#[doc(hidden)]
pub use definition::Scene;
pub use document::Document;
pub use error::{Problem, SceneError};
#[doc(hidden)]
pub use files::{Input, NoFiles, differing, listed};
pub use instability::Instability;
#[doc(hidden)]
pub use keys::{Absent, Key, Sign, Value};
#[doc(hidden)]
pub(crate) use lookup::former_value;
pub use lookup::{nearest, repeated};
#[doc(hidden)]
pub use mode::MOST_POINTS;
pub use mode::Mode;
#[doc(hidden)]
pub use solver::Sums;
pub use substrate::Substrate;
pub use sweep::Sweep;
#[doc(hidden)]
pub use table::KEYS;
pub(crate) use taken::{FROM_ASPERITIES, sources_of_heights, taken};
pub(crate) use validity::{share_of_yielded, yields};
#[doc(hidden)]
pub use validity::{warnings, warnings_of_scene};
#[doc(hidden)]
pub use warning::{Expected, Reading, Warning, WhatIsRead, findings};
