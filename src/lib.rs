//! Adhesion of rough surfaces from explicit ensembles of asperities.
pub mod asperity;
pub mod cli;
pub mod engine;
pub mod experiment;
pub mod math;
pub mod output;
pub mod scene;
#[cfg(test)]
mod source;
pub mod statistical;
pub mod surface;
pub mod validation;
