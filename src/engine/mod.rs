//! Explicit ensembles: replicas of a surface, summed asperity by asperity and reduced in a fixed order.
//!
//! Each replica has its own random stream (seed, replica), and under a [`SamplingScheme`](crate::surface::SamplingScheme) shares draws with
//! its group. Replicas are grouped into batches of a fixed size; batches are computed in any order by any
//! number of threads and merged in the order of their index in a fixed tree, so every result depends on the
//! scene and the seed alone. What is kept per replica is a handful of numbers; heights and curves are dropped
//! with their batch.
//!
//! A [`Job`] says what is computed, an [`Ensemble`] is the result, and a [`Rule`] says whether that is large
//! enough. All of it may change with any version.

mod asperity_states;
mod batch;
#[cfg(test)]
mod case_ii;
mod coupled;
mod coupled_moments;
mod curves;
mod cycle;
mod groups;
#[doc(hidden)]
pub mod instability;
mod job;
mod kinks;
mod least_force;
#[doc(hidden)]
pub mod moments;
mod one_radius;
mod piece;
mod radii;
mod reduce;
mod reduction_tree;
mod replica;
mod sampling;
mod scalars;
mod search;
mod shard;
mod snaps;
mod state;
mod stopping;
mod stray_table;
#[doc(hidden)]
pub mod stream;
mod summation;
mod summed;
mod workspace;

pub use crate::math::moments::Moments;
#[doc(hidden)]
pub use asperity_states::{AsperityState, AsperityStates};
pub use batch::Ensemble;
#[doc(hidden)]
pub use batch::{BATCH, Batch, FIRST_CURVES, QUANTILES, batches_of, curves_of, replicas_of};
#[doc(hidden)]
pub use coupled_moments::CoupledMoments;
#[doc(hidden)]
pub use curves::Curves;
pub use cycle::Cycle;
#[doc(hidden)]
pub use cycle::dissipated;
#[doc(hidden)]
pub use groups::Groups;
#[doc(hidden)]
pub use instability::Loading;
pub use job::{Job, Protocol};
#[doc(hidden)]
pub use job::{Substrate, Ways};
pub use moments::{MomentMatrix, Unfit};
#[doc(hidden)]
pub use piece::{Piece, Pieces};
#[doc(hidden)]
pub use reduce::{Bounds, Outcome, run, run_from};
#[doc(hidden)]
pub use reduction_tree::ReductionTree;
#[doc(hidden)]
pub use replica::CoupledReplica;
pub use replica::Replica;
#[doc(hidden)]
pub use sampling::Draw;
pub use scalars::{LOOP_SCALARS, SCALARS, Scalar};
#[doc(hidden)]
pub use scalars::{REPEATED_SCALARS, scalars};
#[doc(hidden)]
pub use shard::Shard;
pub use stopping::{Attained, Estimator, Limit, Rule, Stopping, Target};
#[doc(hidden)]
pub use summation::{PILOTS, Summation};
#[doc(hidden)]
pub use workspace::Workspace;
