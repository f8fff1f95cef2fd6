//! The answer of the integral model.

use crate::asperity::{ByRegime, SolverStats};

/// The model's answer over S separations and R regimes.
///
/// # Examples
/// ```
/// use stiction::asperity::{LawParameters, Path, Quantity, model};
/// use stiction::integral::Expectations;
/// use stiction::surface::Surface;
///
/// let law = model("md").unwrap().law(&LawParameters::scaled(0.5, Path::Approach)?)?;
/// let surface = Surface::uniform(1.0, 1.0, 100, 1.0);
/// let integral = Expectations::new(law.as_ref(), &surface, &[0.0, 1.0, 2.0]);
/// assert!(integral.expected[Quantity::AdhesionForce.index()][0] > 0.0);
/// assert!(integral.quadrature_error < 1e-9);
/// # Ok::<(), stiction::asperity::LawError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Expectations {
    /// Expectations, by [`crate::asperity::Quantity::index`], each over S; N or m².
    pub expected: [Vec<f64>; 4],
    /// Standard deviations of one replica, likewise.
    pub std: [Vec<f64>; 4],
    /// Mean square of the external force of one asperity over S, N².
    pub mean_square_force: Vec<f64>,
    /// Expected number of asperities in each regime: R × S.
    pub regime_count: ByRegime,
    /// Expected adhesion force of each regime, N: R × S.
    pub regime_adhesion_force: ByRegime,
    /// Expected external force of each regime, N: R × S.
    pub regime_external_force: ByRegime,
    /// Largest bound of the relative error over separations of adhesion force, contact force and area of any
    /// regime; NaN where one of them is not a number.
    pub quadrature_error: f64,
    /// The cost of solving.
    pub stats: SolverStats,
}
