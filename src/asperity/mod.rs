//! Laws of one asperity: from its interference to its forces and contact area.
//!
//! A law has a name ([`model`]), or is one's own: a [`Table`] of regimes, intervals of interference, and what
//! acts in each, by formulas ([`ClosedForm`], [`Tabulated`]). [`SolvedAsperity`] is its answer for one
//! asperity. The elastic laws are solved in scaled form, where the adhesion parameter λ and the scaled
//! approach Δ are all there is; [`Scale`] is the one place that knows R, E_r and Δγ.

mod angle;
mod block;
#[doc(hidden)]
pub mod branch;
mod bridge;
mod by_regime;
mod condition;
#[doc(hidden)]
pub mod contact;
#[doc(hidden)]
pub mod curve;
mod cycle;
#[doc(hidden)]
pub mod elastic;
#[doc(hidden)]
pub mod emd;
mod error;
#[doc(hidden)]
pub mod family;
mod far;
mod folds;
#[doc(hidden)]
pub mod formula;
mod history;
pub(crate) mod hysteresis;
mod lane;
mod lanes;
#[doc(hidden)]
pub mod law;
#[doc(hidden)]
pub mod laws;
mod loading;
mod models;
#[doc(hidden)]
pub mod noncontact;
#[doc(hidden)]
pub mod outline;
mod parameters;
#[doc(hidden)]
pub mod quantity;
#[doc(hidden)]
pub mod radius;
mod response_table;
#[doc(hidden)]
pub mod scale;
mod solved;
mod starts;
mod stats;
mod summit;
mod summit_table;
#[doc(hidden)]
pub mod table;
mod unloading_lanes;
mod unloading_law;

#[doc(hidden)]
pub use block::{BLOCK, Responses};
pub use by_regime::ByRegime;
pub use cycle::Loop;
pub use error::LawError;
pub use family::{Family, Laws, SurfaceLaws, SurfaceLoops};
pub use formula::{ClosedForm, Constant, Formula, Tabulated, Zero};
pub use history::{ContactHistory, Path};
#[doc(hidden)]
pub use lane::{Lane, Lanes};
#[doc(hidden)]
pub use law::{Boundary, End, Facing, FitReport, Method, Piece, Scratch, Smoothness};
pub use law::{Law, Regime};
pub use laws::md_plastic::PlasticContact;
pub use laws::{MODELS, model};
#[doc(hidden)]
pub use models::{Adhesion, LARGEST_DMT_LAMBDA, LARGEST_ELASTIC_PSI, PUBLISHED_FITS, Plasticity};
pub use models::{Model, Validity};
#[doc(hidden)]
pub use parameters::InnerState;
pub use parameters::LawParameters;
pub use quantity::Quantity;
pub use scale::{Asperity, Scale};
pub use solved::SolvedAsperity;
pub use stats::SolverStats;
#[doc(hidden)]
pub use summit::SUMMIT_KINKS;
pub use table::{Row, Table};
#[doc(hidden)]
pub use unloading_lanes::UnloadingLanes;
#[doc(hidden)]
pub use unloading_law::UnloadingLaw;
