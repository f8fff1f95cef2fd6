//! The elastic half-space under the asperities: how far the forces of all others lower the foot of each.
//!
//! A force f on a half-space displaces its surface by f/(πE* r) at the distance r (Boussinesq; Johnson,
//! Contact Mechanics, 1985, section 3.2). Here are the sums of that over all asperities of a square, alone or
//! repeated, of its slopes, and of its curvature, which falls with 1/r³. What a force does to its own foot is part of the law of the asperity.

mod far;
mod influence;
mod near;
mod sums;

pub use influence::Influence;
pub use sums::DisplacementSums;

/// The model of the action of contacts on each other.
///
/// # Examples
/// ```
/// use stiction::substrate::Kernel;
///
/// let scene = stiction::Scene::from_toml_file("configs/coupled.toml")?;
/// assert_eq!(scene.substrate.unwrap().kernel, Kernel::Point);
/// # Ok::<(), stiction::Error>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Kernel {
    /// Points: the force of a contact alone, and the displacement of its foot.
    #[default]
    Point,
    /// Contacts of finite size: the second moment of the pressure too, and the curvature and the tilt of the
    /// substrate below.
    Contact,
}

impl Kernel {
    /// Both with their names.
    pub const ALL: [(&'static str, Self); 2] = [("point", Self::Point), ("contact", Self::Contact)];

    /// The name in scenes and files.
    pub fn name(self) -> &'static str {
        Self::ALL.iter().find(|(_, kernel)| *kernel == self).expect("every kernel is in ALL").0
    }
}

/// The surroundings of the square of asperities.
///
/// # Examples
/// ```
/// use stiction::substrate::{Coupling, DisplacementSums, Influence};
///
/// // Two forces, half a side apart: alone on a half-space u = f/(πE* r).
/// let mut sums = DisplacementSums::<f64>::new(Coupling::Patch, Influence::Displacement, &[[0.25, 0.5], [0.75, 0.5]], 1e-13);
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
        let [x, y] = [0, 1].map(|k| nearest(a[k] - b[k], self.half()));
        x * x + y * y
    }

    /// Half the side of a repeated square; infinite of one alone.
    fn half(self) -> f64 {
        if self == Self::Periodic { 0.5 } else { f64::INFINITY }
    }

    /// The name in scenes and files.
    pub fn name(self) -> &'static str {
        Self::ALL.iter().find(|(_, coupling)| *coupling == self).expect("every coupling is in ALL").0
    }
}

/// A coordinate of the way to the nearest copy, of squares of twice `half` a side, without a branch.
#[inline(always)]
fn nearest(apart: f64, half: f64) -> f64 {
    let over = if apart > half { 1.0 } else { 0.0 };
    let under = if apart < -half { 1.0 } else { 0.0 };
    apart - over + under
}
