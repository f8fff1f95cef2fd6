//! The asperity of case II of the published Table 2, for unit tests.

use crate::asperity::scale::Asperity;

/// The asperity with the inferred ν and t.
pub const CASE_II: Asperity = Asperity {
    radius: 3.33e-6,
    reduced_modulus: 85.29e9,
    work_of_adhesion: 0.09,
    equilibrium_spacing: 0.2e-9,
    hardness: 2.5e9,
    poisson_ratio: 0.196,
    lubricant_thickness: 0.5e-9,
};
