//! `stiction validate`: the cross-check of a result, computed anew from its datasets, and whether these fit
//! together.

mod answer;
mod asperities;
mod bounds;
mod checked;
mod comparison;
mod counts;
mod cross_check;
mod curves;
mod features;
mod finite_size;
mod forces;
mod run;
mod scalars;
mod snaps;
mod sweep;

use self::answer::Answer;
use super::failure::Failure;
use super::rows::row;
use super::terminal::print;
use crate::format::replicas as shown;
use crate::output::identity::Identity;
use crate::output::partial::{Kept, Partial};
use crate::output::reader::Reader;
use crate::output::schema::{ASPERITIES, COMPARISON, FINITE_SIZE, Layout, SWEEP};
use crate::output::shard_file::{ShardFile, is_shard};
use crate::scene::echo::one_line;
use crate::validation::Verdict;
use std::path::Path;

/// Findings that are told; more are counted.
const TOLD: usize = 20;

pub(super) fn validate(path: &Path) -> Result<(), Failure> {
    if is_shard(path) {
        return concluded(shard(path)?);
    }
    let reader = Reader::open(path, &Layout::ALL)?;
    let is = |layout: &Layout| reader.layout().format == layout.format;
    let answer = match () {
        () if is(&SWEEP) => sweep::validate(&reader),
        () if is(&COMPARISON) => comparison::validate(&reader),
        () if is(&FINITE_SIZE) => finite_size::validate(&reader),
        () if is(&ASPERITIES) => asperities::validate(&reader),
        () => run::validate(&reader),
    };
    concluded(answer?)
}

/// Reads all of a shard, which has checksums of everything that is in it.
fn shard(path: &Path) -> Result<Answer, Failure> {
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
    let text = format!("{}\na shard of {replicas} replicas\n", one_line(&path.display().to_string()));
    Ok(Answer { text, findings, verdict: Verdict::NotTested })
}

/// Prints what was found, and what comes of it.
fn concluded(Answer { text, findings, verdict }: Answer) -> Result<(), Failure> {
    let more = findings.len().saturating_sub(TOLD);
    let told = findings.iter().take(TOLD).enumerate();
    let mut rows: String =
        told.map(|(i, finding)| row(if i == 0 { "contradictions" } else { "" }, finding)).collect();
    if more > 0 {
        rows += &row("", &format!("and {more} more"));
    }
    if findings.is_empty() {
        rows = row("datasets", "fit together");
    }
    print(&(text + &rows))?;
    match (findings.len(), verdict) {
        (0, Verdict::Disagree) => Err(Failure::Disagree),
        (0, _) => Ok(()),
        (1, _) => Err(Failure::Contradicts("a dataset contradicts others or cannot be".to_owned())),
        (count, _) => Err(Failure::Contradicts(format!("{count} datasets contradict others or cannot be"))),
    }
}
