//! One asperity at one interference.

use super::block::Responses;
use super::law::{Facing, Law, Regime, Scratch};
use super::stats::SolverStats;

/// One asperity at one interference, in the units of its law: SI, or scaled ones.
///
/// # Examples
/// ```
/// use stiction::asperity::{LawParameters, Path, Regime, SolvedAsperity, model};
///
/// // Johnson, Kendall and Roberts's pull-off is 3/2 πRΔγ; πRΔγ is the unit of force.
/// let law = model("jkr").unwrap().law(&LawParameters::scaled(10.0, Path::Retraction)?)?;
/// let solved = (-900..900).map(|k| SolvedAsperity::new(law.as_ref(), 1e-3 * f64::from(k)));
/// let deepest = solved.min_by(|a, b| a.external_force().total_cmp(&b.external_force())).unwrap();
/// assert!((deepest.external_force() + 1.5).abs() < 1e-5);
/// assert_eq!(deepest.regime, Some(Regime::Elastic));
/// # Ok::<(), stiction::asperity::LawError>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct SolvedAsperity {
    /// The regime; none beyond the last regime of the law, where nothing acts.
    pub regime: Option<Regime>,
    /// Adhesion force F_s, attractive forces positive.
    pub adhesion_force: f64,
    /// Contact force P, compressive forces positive.
    pub contact_force: f64,
    /// Contact area.
    pub contact_area: f64,
    /// Cost of the solve.
    pub stats: SolverStats,
}

impl SolvedAsperity {
    /// Solves a law at an interference δ.
    ///
    /// # Examples
    /// ```
    /// use stiction::asperity::{LawParameters, Path, SolvedAsperity, model};
    ///
    /// let law = model("jkr").unwrap().law(&LawParameters::scaled(10.0, Path::Approach)?)?;
    /// let asperity = SolvedAsperity::new(law.as_ref(), 4.0);
    /// assert!(asperity.contact_force > asperity.adhesion_force);
    /// # Ok::<(), stiction::asperity::LawError>(())
    /// ```
    pub fn new(law: &dyn Law, interference: f64) -> Self {
        let mut solved = Self {
            regime: None,
            adhesion_force: 0.0,
            contact_force: 0.0,
            contact_area: 0.0,
            stats: SolverStats::default(),
        };
        let mut stats = SolverStats::default();
        let visit = |regime: usize, _: std::ops::Range<usize>, responses: &Responses| {
            solved.regime = Some(law.regimes()[regime]);
            (solved.adhesion_force, solved.contact_force) = (responses.adhesion[0], responses.contact[0]);
            solved.contact_area = responses.area[0];
        };
        let facing = Facing { law, heights: &[interference], separation: 0.0 };
        facing.for_each_block(&mut Scratch::default(), &mut stats, visit);
        Self { stats, ..solved }
    }

    /// The external force P − F_s, compressive forces positive.
    pub fn external_force(&self) -> f64 {
        self.contact_force - self.adhesion_force
    }

    /// The radius of the contact area.
    pub fn contact_radius(&self) -> f64 {
        (self.contact_area / std::f64::consts::PI).sqrt()
    }
}
