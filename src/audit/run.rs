//! The result of `stiction run`: its table and verdict, and whether its datasets fit together.

use super::answer::{Audit, Content};
use super::checked::{Checked, refused};
use super::cross_check::{CrossCheck, scheme};
use crate::engine::Ways;
use crate::output::OutputError;
use crate::output::reader::Reader;
use crate::output::schema::Dimension;
use crate::validation::JointTest;

pub(super) fn audit(reader: &Reader) -> Result<Audit, OutputError> {
    let mut checked = Checked::new(reader, replicas(reader)?);
    checked.group = scheme(&checked)?.group();
    let (replicas, group) = (checked.replicas, checked.group);
    if replicas == 0 || !replicas.is_multiple_of(group) {
        let problem =
            format!("has replicas = {replicas}, which is no number of {} ones", scheme(&checked)?.name());
        return Err(refused(reader.path(), &problem));
    }
    let cross_check = CrossCheck::new(&checked)?;
    checked.run(&cross_check.joint)?;
    let ways = checked.ways()?.len();
    let verdict = cross_check.joint.verdict;
    Ok(Audit {
        content: Content::Run { cross_check: Box::new(cross_check), ways },
        findings: checked.findings,
        verdict,
    })
}

/// How many replicas there are.
fn replicas(reader: &Reader) -> Result<u64, OutputError> {
    let replicas: u64 = reader.number("/", "replicas")?;
    let there = reader.length(Dimension::Replica)? as u64;
    if replicas == there {
        return Ok(replicas);
    }
    let problem = format!("has replicas = {replicas}, but the dimension `replica` has {there}");
    Err(refused(reader.path(), &problem))
}

impl Checked<'_> {
    /// All datasets of a run, or of a point of a sweep, with the joint test computed anew.
    pub fn run(&mut self, joint: &JointTest) -> Result<(), OutputError> {
        self.bounds()?;
        let ways = self.course()?;
        self.separations()?;
        self.background_terms()?;
        for way in ways.prefixes() {
            self.sums("ensemble", way, "_mean")?;
            self.sums("integral", way, "")?;
            self.errors(way)?;
            self.quantiles(way)?;
            self.deviations(way)?;
            self.scores(way)?;
            self.coupling(way)?;
            self.plausible(way)?;
        }
        self.avalanches()?;
        self.counts(ways != Ways::One)?;
        self.scalars(ways)?;
        self.targets()?;
        self.curves(ways)?;
        self.snaps()?;
        self.asperity_states()?;
        self.features()?;
        self.independence()?;
        self.bridges()?;
        self.films()?;
        self.joint_test(joint)
    }
}
