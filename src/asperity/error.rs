//! Errors of making a law.

use thiserror::Error;

/// Reasons why a law cannot be made.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
pub enum LawError {
    /// λ outside the range that is solved.
    #[error("the adhesion parameter lambda is {0:.4e}, outside 1e-6..1e6")]
    Lambda(f64),
    /// A unit of the scaled variables outside the range whose powers are numbers.
    #[error(
        "the unit of {name} that follows from asperity_radius, work_of_adhesion and reduced_modulus is {value:.4e} in SI, outside \
         1e-60..1e60"
    )]
    Unit {
        /// The quantity that it is the unit of.
        name: &'static str,
        /// The value, SI.
        value: f64,
    },
    /// A length that is too small or too large relative to the unit of the approach.
    #[error("{name} is {value:.4e}, outside 1e-60..1e60 times the unit of the approach")]
    Length {
        /// Name of the quantity, as in scenes.
        name: &'static str,
        /// The value that was given or follows, SI.
        value: f64,
    },
    /// ω_c is infinite, but the law has an elastic-plastic scale even in its elastic regime.
    #[error("no critical interference is given, which the law {0} needs")]
    Elastic(&'static str),
    /// H/E* is not known, on which the form of the law depends.
    #[error("no hardness over reduced modulus is given, on which the form of the law {0} depends")]
    Hardness(&'static str),
    /// The law is for asperities around which a liquid condenses, and no liquid is given.
    #[error("no liquid is given, which the law {0} needs: [capillary] in a scene")]
    NoLiquid(&'static str),
    /// The asperity is none of the three whose curve fits are published.
    #[error(
        "Table 3 has curve fits for three asperities only (R, work of adhesion: 1.66 um, 0.01 J/m^2; 3.33 um, 0.09 J/m^2; \
         6.38 um, 0.30 J/m^2; E* 85.29 GPa, Z_0 0.2 nm), and this is none of them; hybrid solves any"
    )]
    NotInTable3,
    /// The law is fitted to one asperity, and there are asperities of many radii.
    #[error("it is a fit to one asperity, and asperities differ in their radii")]
    OneRadius,
    /// The range of the published fits is so large that no number holds their forces.
    #[error("the published fits give forces of this asperity that are no numbers")]
    NoFit,
    /// A quantity that has to be positive and finite.
    #[error("{name} is {value:.4e}, but has to be positive and finite")]
    NotPositive {
        /// Name of the quantity, as in scenes.
        name: &'static str,
        /// The value that was given, SI.
        value: f64,
    },
}
