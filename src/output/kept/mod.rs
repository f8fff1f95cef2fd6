//! What is kept of an interrupted or divided experiment: a file of results in the layout of the whole, which says what is missing.
//!
//! `lock` has all rules about an output, and `claim` keeps other processes away from it; `identity` says which run a file is of;
//! `partial` reads and writes the files, and `state` the bytes that they hold in addition. `keeper` writes one while a run goes,
//! and a `shard_set` is the shards that make up a run.

mod claim;
mod identity;
mod keeper;
mod lock;
mod partial;
mod shard_set;
mod state;

pub use identity::Identity;
pub(super) use keeper::{Keeper, advised};
pub(super) use lock::made_anew;
pub(crate) use lock::{Kept, OverwritePolicy};
pub use lock::{OutputLock, PARTIAL, beside};
pub(super) use partial::{KeptRun, is_result_of, scene_file, state_in, write_restart};
pub(crate) use partial::{PartialFile, Piece};
pub(super) use shard_set::Place;
pub(crate) use shard_set::ShardSet;
pub(super) use state::Restart;
pub use state::{Head, RESTART, State, decode};
