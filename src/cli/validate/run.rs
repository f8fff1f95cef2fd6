//! The result of `stiction run`: its table and verdict, and whether its datasets fit together.

use super::super::summary::verdict;
use super::answer::{Answer, heading, refused};
use super::checked::Checked;
use super::cross_check::{CrossCheck, scheme};
use crate::cli::failure::Failure;
use crate::output::reader::Reader;
use crate::output::schema::Dimension;
use crate::validation::JointTest;

/// Rows of the table; more separations are thinned out.
const ROWS: usize = 25;

pub(super) fn validate(reader: &Reader) -> Result<Answer, Failure> {
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
    let text = heading(reader) + &table(&cross_check, checked.ways()?.len());
    Ok(Answer { text, findings: checked.findings, verdict: cross_check.joint.verdict })
}

/// How many replicas there are.
fn replicas(reader: &Reader) -> Result<u64, Failure> {
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
    pub fn run(&mut self, joint: &JointTest) -> Result<(), Failure> {
        self.bounds()?;
        let cycle = self.is_loop()?;
        self.separations()?;
        for way in self.ways()? {
            self.sums("ensemble", way, "_mean")?;
            self.sums("integral", way, "")?;
            self.errors(way)?;
            self.deviations(way)?;
            self.scores(way)?;
            self.plausible(way)?;
        }
        self.counts(cycle)?;
        self.scalars(cycle)?;
        self.targets()?;
        self.curves(cycle)?;
        self.snaps()?;
        self.features()?;
        self.joint_test(joint)
    }
}

/// Separation by separation, and the verdict.
fn table(cross_check: &CrossCheck, ways: usize) -> String {
    let CrossCheck { h_star, forces, z, joint } = cross_check;
    let mut text =
        "        h*   mean F_s (N)   integral (N)       z     mean F (N)   integral (N)       z\n".to_owned();
    let step = h_star.len().div_ceil(ROWS);
    for k in (0..h_star.len()).step_by(step.max(1)) {
        let cells = [0, 1]
            .map(|i| format!("{:>14.6e} {:>14.6e} {:>7}", forces[i][0][k], forces[i][1][k], score(z[i][k])));
        let back = if k < h_star.len() / ways { "" } else { "  on retraction" };
        text += &format!("{:>10.3} {}{back}\n", h_star[k], cells.join(" "));
    }
    let shown = if step > 1 {
        format!("every {step}th of {} separations is shown", h_star.len())
    } else {
        "all separations are shown".to_owned()
    };
    text + &verdict(joint, z, &shown)
}

/// A z-score; a dash where nothing varies.
fn score(z: f64) -> String {
    if z.is_finite() { format!("{z:.2}") } else { "-".to_owned() }
}
