//! Audits of results: the cross-check computed anew from the datasets of a file, and whether these fit
//! together.

mod answer;
mod asperities;
mod bounds;
mod capillary;
mod checked;
mod comparison;
mod counts;
mod coupling;
mod cross_check;
mod curves;
mod features;
mod finite_size;
mod forces;
mod independence;
mod quantiles;
mod run;
mod scalars;
mod snaps;
mod states;
mod sweep;

pub use self::answer::{Audit, Content};
pub use self::cross_check::CrossCheck;
use crate::experiment::layouts::{COMPARISON, FINITE_SIZE, LAYOUTS, SWEEP};
use crate::format::replicas as shown;
use crate::output::OutputError;
use crate::output::identity::Identity;
use crate::output::partial::{Kept, Partial};
use crate::output::reader::Reader;
use crate::output::schema::{ASPERITIES, Layout};
use crate::output::shard_file::{ShardFile, is_shard};
use crate::validation::Verdict;
use std::path::Path;

/// Audits a result of any kind, or a shard.
///
/// # Errors
/// [`OutputError::NotAResult`] and [`OutputError::NotAPartial`] for a file that cannot be read as one.
pub fn audit(path: &Path) -> Result<Audit, OutputError> {
    if is_shard(path) {
        return shard(path);
    }
    let reader = Reader::open(path, &LAYOUTS)?;
    let is = |layout: &Layout| reader.layout().format == layout.format;
    match () {
        () if is(&SWEEP) => sweep::audit(&reader),
        () if is(&COMPARISON) => comparison::audit(&reader),
        () if is(&FINITE_SIZE) => finite_size::audit(&reader),
        () if is(&ASPERITIES) => asperities::audit(&reader),
        () => run::audit(&reader),
    }
}

/// Reads all of a shard, which has checksums of everything that is in it.
fn shard(path: &Path) -> Result<Audit, OutputError> {
    let shard = ShardFile::open(path)?;
    let (mut findings, mut replicas, own) = (Vec::new(), 0, &shard.head.identity);
    for piece in &shard.pieces {
        let Kept { partial: Partial { identity, .. }, records } = shard.kept(piece)?;
        // Every point of a sweep has a scene and a seed of its own.
        if (Identity { scene: own.scene.clone(), seed: own.seed, ..identity }) != *own {
            findings.push(format!("point {} is of another run than the shard says", piece.point));
        }
        let mut there = 0;
        records.each(&mut |records| {
            there += records.replicas.len() as u64;
            Ok(true)
        })?;
        if there != piece.replicas.end - piece.replicas.start {
            findings.push(format!(
                "point {} has {there} records of {}",
                piece.point,
                shown(&piece.replicas, own.replicas)
            ));
        }
        replicas += there;
    }
    Ok(Audit { content: Content::Shard(replicas), findings, verdict: Verdict::NotTested })
}
