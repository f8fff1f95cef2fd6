//! The choice between direct sums and sums by moments, and the error that the latter turn out to have.

use super::curves::Curves;
use super::job::Job;
use super::moments::{MANY, MomentMatrix, SMALL, Unfit, largest_error};
use super::replica::Replica;
use super::workspace::Workspace;
use crate::asperity::Quantity;
use crate::math::extrema::maximum;
use crate::surface::Surface;
use rayon::prelude::*;

/// Replicas that are summed both ways before the run, spread over it.
pub const PILOTS: u64 = 4;

/// The way in which the surfaces of a job are summed.
#[derive(Debug, Default)]
pub struct Summation {
    /// Matrix of sums by moments; none where sums are direct.
    pub matrix: Option<MomentMatrix>,
    /// The tolerance that compressed sums were asked for with.
    pub tolerance: Option<f64>,
    /// The largest error of compressed sums on the pilot replicas; NaN when none were made.
    pub achieved_error: f64,
    /// Reason why sums are direct although compressed ones were asked for.
    pub refusal: Option<Unfit>,
}

impl Summation {
    /// Sums asperity by asperity.
    pub fn direct() -> Self {
        Self { achieved_error: f64::NAN, ..Self::default() }
    }

    /// Sums by moments to `tolerance` if that can be done, which is tried on a few replicas of the job, in
    /// parallel; else direct ones. The error is by [`largest_error`] and of the pull-off force. Of large
    /// surfaces the first asperities are tried: errors are relative to the sum over all asperities, so errors
    /// of more are no larger.
    pub fn by_moments(job: &Job<'_>, tolerance: f64) -> Self {
        let direct = Self { tolerance: Some(tolerance), ..Self::direct() };
        if job.protocol.cycle.is_some() {
            return Self { refusal: Some(Unfit::Loop), ..direct };
        }
        let matrix = match MomentMatrix::new(job.laws.typical, job.surface, job.separations, tolerance) {
            Ok(matrix) => matrix,
            Err(refusal) => return Self { refusal: Some(refusal), ..direct },
        };
        let pilots = PILOTS.min(job.replicas);
        let surface = Surface {
            asperity_count: job.surface.asperity_count.min(MANY),
            // It is the same in both ways.
            background: None,
            spread: Default::default(),
            ..job.surface.clone()
        };
        let tried = Job { surface: &surface, ..*job };
        let ways = [Job { moments: Some(&matrix), ..tried }, Job { moments: None, ..tried }];
        let error =
            |workspaces: &mut [Workspace; 2], i| pilot_error(&ways, workspaces, i * (job.replicas / pilots));
        let errors: Vec<f64> =
            (0..pilots).into_par_iter().map_init(|| ways.each_ref().map(Workspace::new), error).collect();
        let achieved_error = errors.into_iter().fold(0.0, f64::max);
        if achieved_error <= tolerance {
            Self { matrix: Some(matrix), achieved_error, ..direct }
        } else {
            Self { refusal: Some(Unfit::NotMet(achieved_error)), achieved_error, ..direct }
        }
    }

    /// The error of the sums of the job by moments; NaN for direct ones.
    pub fn sum_error(&self) -> f64 {
        if self.matrix.is_some() { self.achieved_error } else { f64::NAN }
    }

    /// The name in files.
    pub fn name(&self) -> &'static str {
        if self.matrix.is_some() { "moments" } else { "direct" }
    }
}

/// The error of compressed against direct sums of one replica of the same job, each in its own memory;
/// infinite where it is not a number.
fn pilot_error(ways: &[Job<'_>; 2], workspaces: &mut [Workspace; 2], index: u64) -> f64 {
    let mut summed = ways.iter().zip(workspaces).map(|(job, workspace)| {
        let mut result: Option<(Replica, Curves)> = None;
        workspace.replicas(job, index..index + 1, |replica, curves| result = Some((replica, curves.clone())));
        result.expect("one replica was asked for")
    });
    let mut next = || summed.next().expect("there are two ways");
    let ((replica, curves), (truth, direct)) = (next(), next());
    let largest =
        direct.total[Quantity::AdhesionForce.index()].iter().copied().fold(f64::MIN_POSITIVE, f64::max);
    let scale = truth.pull_off_force.abs().max(SMALL * largest);
    let pull_off_error = (replica.pull_off_force - truth.pull_off_force).abs() / scale;
    let error = maximum(largest_error(&curves, &direct), pull_off_error);
    if error.is_nan() { f64::INFINITY } else { error }
}
