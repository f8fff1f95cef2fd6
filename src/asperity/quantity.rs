//! The quantities that are summed over the asperities of a surface.

/// A quantity of a surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// Adhesion force F_s, N, attractive counted positive.
    AdhesionForce,
    /// Contact force P, N, compressive counted positive.
    ContactForce,
    /// External force F = P − F_s, N.
    ExternalForce,
    /// Contact area, m².
    ContactArea,
}

impl Quantity {
    /// All of them, in the order of every table.
    pub const ALL: [Self; 4] =
        [Self::AdhesionForce, Self::ContactForce, Self::ExternalForce, Self::ContactArea];

    /// The name in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::AdhesionForce => "adhesion_force",
            Self::ContactForce => "contact_force",
            Self::ExternalForce => "external_force",
            Self::ContactArea => "contact_area",
        }
    }

    /// The place in [`Quantity::ALL`].
    pub fn index(self) -> usize {
        self as usize
    }

    /// The quantities of one response, in the order of [`Quantity::ALL`].
    #[inline(always)]
    pub fn of_response(adhesion: f64, contact: f64, area: f64) -> [f64; 4] {
        [adhesion, contact, contact - adhesion, area]
    }
}
