//! Counts of what was evaluated and solved.

use serde::{Deserialize, Serialize};

/// The cost of solving, in counts.
///
/// # Examples
/// ```
/// use stiction::asperity::{LawParameters, Path, SolvedAsperity, SolverStats, model};
///
/// let law = model("md").unwrap().law(&LawParameters::scaled(1.0, Path::Approach)?)?;
/// let SolverStats { contact_solves, noncontact_solves, .. } = SolvedAsperity::new(law.as_ref(), 2.0).stats;
/// assert_eq!((contact_solves, noncontact_solves), (1, 0));
/// # Ok::<(), stiction::asperity::LawError>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SolverStats {
    /// Solves of the contact equations.
    pub contact_solves: u64,
    /// Solves of the noncontact equations.
    pub noncontact_solves: u64,
    /// Asperities that needed no solve: constant force in the lubricant.
    pub constant: u64,
    /// Asperities that needed no solve: closed form in the elastic-plastic and plastic regimes.
    pub closed_form: u64,
    /// Asperities that needed no solve: a series far from contact.
    pub far: u64,
    /// Asperities whose load and area were not summed, because nothing touches.
    pub unloaded: u64,
    /// Separations of surfaces that were summed by moments.
    pub by_moments: u64,
    /// Evaluations of the equations.
    pub evaluations: u64,
    /// Solves that took the safeguarded path.
    pub safeguarded: u64,
    /// Largest |Δ(x) − Δ| before the last Newton step, relative to the terms of Δ.
    pub largest_residual: f64,
}

impl SolverStats {
    /// Adds the work of another part.
    pub fn merge(&mut self, other: &Self) {
        self.contact_solves += other.contact_solves;
        self.noncontact_solves += other.noncontact_solves;
        self.constant += other.constant;
        self.closed_form += other.closed_form;
        self.far += other.far;
        self.unloaded += other.unloaded;
        self.by_moments += other.by_moments;
        self.evaluations += other.evaluations;
        self.safeguarded += other.safeguarded;
        self.largest_residual = self.largest_residual.max(other.largest_residual);
    }
}
