//! Laws of one asperity: from its interference to its forces and contact area.
//!
//! The elastic laws are solved in scaled form, where the adhesion parameter λ and the scaled approach Δ are
//! all there is ([`emd`] and below); [`scale`] is the one place that knows R, E_r and Δγ. A law of a rough
//! surface's asperity ([`laws`]) is a [`table`] of regimes, intervals of interference, and what acts in each,
//! and shows itself to the sums through [`Law`].

mod angle;
pub mod branch;
pub mod contact;
pub mod curve;
pub mod emd;
mod error;
pub mod family;
pub mod flattened;
pub mod formula;
mod history;
mod lanes;
pub mod law;
pub mod laws;
pub mod models;
pub mod noncontact;
mod parameters;
mod plastic_unloading;
pub mod quantity;
mod retraction;
pub mod scale;
mod solved;
mod stats;
pub mod table;
pub mod unloading;

pub use error::LawError;
pub use family::{Family, Laws, SurfaceLaws};
pub use history::Path;
pub use law::{
    BLOCK, Boundary, End, FitReport, Flattened, Law, Method, Piece, Regime, Responses, Scratch, Smoothness,
    for_each_block, for_each_block_of, regime_ranges,
};
pub use parameters::LawParameters;
pub use quantity::Quantity;
pub use retraction::Retraction;
pub use solved::SolvedAsperity;
pub use stats::SolverStats;
pub use unloading::{Loop, UnloadedRadius};
