//! Sums over the asperities of a surface, by state: the separations, and of a loop the separations of the
//! retraction behind these.

/// Curves of one surface over S states and R regimes.
#[derive(Clone, Debug, PartialEq)]
pub struct Curves {
    /// Sums over all asperities, by [`Quantity::index`](crate::asperity::Quantity::index), each over S.
    pub total: [Vec<f64>; 4],
    /// Asperities in each regime, R × S.
    pub regime_count: Vec<f64>,
    /// Adhesion force of each regime, N, R × S.
    pub regime_adhesion_force: Vec<f64>,
    /// External force of each regime, N, R × S.
    pub regime_external_force: Vec<f64>,
    /// The snaps, in the order of [`Loading::length`](super::Loading::length).
    pub snaps: Vec<f64>,
}

impl Curves {
    /// Nothing yet, over `s` states and `r` regimes.
    pub(super) fn new(s: usize, r: usize) -> Self {
        Self {
            total: std::array::from_fn(|_| vec![0.0; s]),
            regime_count: vec![0.0; r * s],
            regime_adhesion_force: vec![0.0; r * s],
            regime_external_force: vec![0.0; r * s],
            snaps: Vec::new(),
        }
    }
}
