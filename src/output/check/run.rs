//! The check of a run.

use super::cross_check::CrossCheck;
use super::stored::StoredRun;
use super::{Checked, Content, as_stored, refused};
use crate::error::OutputError;
use crate::output::reader::Reader;
use crate::output::schema::Dimension;
use crate::scene::echo::one_line;
use crate::surface::SamplingScheme;
use crate::validation::Verdict;

pub(super) fn check(reader: &Reader) -> Result<Checked, OutputError> {
    let scheme = scheme(reader)?;
    let (replicas, group): (u64, u64) = (reader.number("/", "replicas")?, scheme.group());
    if replicas == 0 && !reader.has(reader.coordinate("replica")) {
        return Ok(as_stored(Verdict::NotTested, Content::Integral));
    }
    let there = reader.length(Dimension::Replica)? as u64;
    if replicas != there {
        let problem = format!("has replicas = {replicas}, but the dimension `replica` has {there}");
        return Err(refused(reader.path(), &problem));
    }
    if !replicas.is_multiple_of(group) {
        let problem = format!("has replicas = {replicas}, which is no number of {} ones", scheme.name());
        return Err(refused(reader.path(), &problem));
    }
    let run = StoredRun { reader, place: None, replicas, group };
    let (cross_check, ways) = (CrossCheck::new(&run)?, run.ways()?.len());
    let verdict = cross_check.joint.verdict;
    let stored = reader.optional_text("/validation", "verdict")?.unwrap_or_default();
    Ok(Checked {
        content: Content::Run { cross_check: Box::new(cross_check), ways },
        verdict,
        contradictions: contradiction("verdict", &stored, verdict).into_iter().collect(),
    })
}

/// The scheme by which the replicas of a file were drawn.
pub(super) fn scheme(reader: &Reader) -> Result<SamplingScheme, OutputError> {
    let name = reader.optional_text("/", "sampling")?;
    let name = name.ok_or_else(|| refused(reader.path(), "lacks the text `sampling` of /"))?;
    let known = SamplingScheme::ALL.iter().find(|(known, _)| *known == name);
    known.map(|(_, scheme)| *scheme).ok_or_else(|| {
        refused(reader.path(), &format!("has sampling = \"{name}\", which this program does not know"))
    })
}

/// A contradiction, where the verdict of a file is another than the one that was computed again.
pub(super) fn contradiction(name: &str, stored: &str, own: Verdict) -> Option<String> {
    let (stored, own) = (one_line(stored), own.name());
    (stored != own).then(|| format!("/validation/{name} is \"{stored}\", and \"{own}\" follows"))
}
