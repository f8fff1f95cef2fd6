//! Scenes: from TOML to what the program computes, or to an error that says what to change.

mod canonical;
mod choices;
mod definition;
mod document;
pub mod echo;
mod error;
pub mod files;
mod instability;
mod keys;
mod lookup;
mod material;
mod parse;
mod population;
mod reader;
mod separation;
mod stopping;
pub mod sweep;
mod table;
pub mod units;
mod validity;

pub use canonical::difference;
pub use choices::{MOST_POINTS, Mode};
pub use definition::Scene;
pub use document::Document;
pub use error::{Problem, SceneError};
pub use files::with_inputs;
pub use instability::Instability;
pub use keys::{Absent, Key, Sign, Value};
pub use lookup::nearest;
pub use reader::takes_heights;
pub use sweep::Sweep;
pub use table::KEYS;
pub use validity::{Expected, Reading, Warning, WhatIsRead, warnings, warnings_of_scene};
