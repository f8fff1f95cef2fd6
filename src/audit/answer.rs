//! Findings of an audit.

use super::cross_check::CrossCheck;
use crate::validation::{JointTest, Verdict};

/// An audit of a file.
pub struct Audit {
    pub content: Content,
    /// Findings of what does not fit together, a line each.
    pub findings: Vec<String>,
    /// The verdict of ensemble against integral.
    pub verdict: Verdict,
}

/// The content of a file, with the cross-checks that were computed anew.
pub enum Content {
    /// One scene, which has curves of so many ways.
    Run { cross_check: Box<CrossCheck>, ways: usize },
    /// Points along keys: their places, and the tests of those that are there.
    Sweep { keys: String, points: Vec<(Vec<usize>, Option<JointTest>)> },
    /// Laws on the same asperities, with the p-value of each.
    Comparison { laws: Vec<String>, p_values: Vec<f64> },
    /// Patches of several sizes, with the p-value of each.
    FiniteSize { p_values: Vec<f64> },
    /// So many asperities of a measured surface.
    Asperities(usize),
    /// So many replicas of a run.
    Shard(u64),
}
