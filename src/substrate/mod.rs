//! The elastic half-space under the asperities: how far the forces of all others lower the foot of each.
//!
//! A force f on a half-space displaces its surface by f/(πE* r) at the distance r (Boussinesq; Johnson,
//! Contact Mechanics, 1985, section 3.2). Here are the sums of that over all asperities of a square, alone or
//! repeated, and places of asperities. What a force does to its own foot is part of the law of the asperity.

mod far;
mod near;
mod sums;

pub use sums::DisplacementSums;

/// What surrounds the square of asperities.
///
/// # Examples
/// ```
/// use stiction::substrate::{Coupling, DisplacementSums};
///
/// // Two forces, half a side apart: alone on a half-space u = f/(πE* r).
/// let mut sums = DisplacementSums::new(Coupling::Patch, &[[0.25, 0.5], [0.75, 0.5]], 1e-13);
/// let mut displacements = [0.0; 2];
/// sums.apply(&[1.0, 3.0], &mut displacements);
/// assert!((displacements[0] - 6.0).abs() < 1e-11 && (displacements[1] - 2.0).abs() < 1e-11);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Coupling {
    /// The square is repeated without end; displacements are relative to the mean plane of the deformed
    /// surface, so that a uniform pressure causes none.
    Periodic,
    /// The square is alone on a half-space; displacements are relative to places far away.
    Patch,
}

impl Coupling {
    /// Both with their names.
    pub const ALL: [(&'static str, Self); 2] = [("periodic", Self::Periodic), ("patch", Self::Patch)];

    /// The square of the distance of two points, in sides; of a repeated square that of their nearest copies.
    pub fn square(self, a: [f64; 2], b: [f64; 2]) -> f64 {
        let apart = |k: usize| {
            let apart: f64 = a[k] - b[k];
            if self == Self::Periodic { apart - apart.round() } else { apart }
        };
        let [x, y] = std::array::from_fn(apart);
        x * x + y * y
    }

    /// The name in scenes and files.
    pub fn name(self) -> &'static str {
        Self::ALL.iter().find(|(_, coupling)| *coupling == self).expect("every coupling is in ALL").0
    }
}
