//! Numbers by regime.

use super::law::Regime;
use std::ops::Deref;

/// Numbers of each regime of a law over states: a row a regime, in the order of the law.
///
/// # Examples
/// ```
/// use stiction::asperity::{ByRegime, Regime};
///
/// let counts = ByRegime::new(&[Regime::Noncontact, Regime::Elastic], vec![vec![39.0], vec![3.0]]);
/// assert_eq!(counts.of(Regime::Elastic), Some(&[3.0][..]));
/// assert_eq!(counts.of(Regime::Plastic), None);
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ByRegime {
    regimes: Vec<Regime>,
    rows: Vec<Vec<f64>>,
}

impl ByRegime {
    /// The rows of the regimes of a law.
    pub fn new(regimes: &[Regime], rows: Vec<Vec<f64>>) -> Self {
        assert_eq!(regimes.len(), rows.len(), "each regime has a row");
        Self { regimes: regimes.to_vec(), rows }
    }

    /// The row of a regime; none where the law does not have it.
    pub fn of(&self, regime: Regime) -> Option<&[f64]> {
        self.rows().find(|(own, _)| *own == regime).map(|(_, row)| row)
    }

    /// The regimes with their rows.
    pub fn rows(&self) -> impl Iterator<Item = (Regime, &[f64])> {
        self.regimes.iter().copied().zip(self.rows.iter().map(Vec::as_slice))
    }
}

impl Deref for ByRegime {
    type Target = [Vec<f64>];

    fn deref(&self) -> &[Vec<f64>] {
        &self.rows
    }
}
