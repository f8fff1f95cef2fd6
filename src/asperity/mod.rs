//! Laws of one asperity: from its interference to its forces and contact area.
//!
//! The elastic laws are solved in scaled form, where the adhesion parameter λ and the scaled approach Δ are all there is
//! ([`emd`] and below); [`scale`] is the one place that knows R, E_r and Δγ. A law of a rough surface's asperity
//! ([`laws`]) is a [`table`] of regimes, intervals of interference, and what acts in each, and shows itself to the sums through [`Law`].

pub mod branch;
pub mod contact;
pub mod emd;
pub mod family;
pub mod flattened;
pub mod law;
pub mod laws;
pub mod models;
pub mod noncontact;
pub mod quantity;
pub mod scale;
mod setting;
pub mod table;
pub mod unloading;

pub use family::{Family, Typical};
pub use law::{
    BLOCK, Boundary, End, FitReport, Law, Piece, Regime, Responses, Scratch, Smoothness, for_each_block,
    for_each_block_of, regime_ranges,
};
pub use quantity::Quantity;
pub use setting::Setting;
pub use unloading::{Loop, UnloadedRadius};

use thiserror::Error;

/// The history that selects the branch where two are stable.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Path {
    /// From far away towards each other: contact begins at first touch.
    Approach,
    /// From deep contact apart: contact lasts to the end of its stable branch.
    Retraction,
}

impl Path {
    /// Both histories with their names.
    pub const ALL: [(&'static str, Self); 2] = [("approach", Self::Approach), ("retraction", Self::Retraction)];

    /// Its name in scenes and files.
    pub fn name(self) -> &'static str {
        Self::ALL.iter().find(|(_, path)| *path == self).expect("every path is in ALL").0
    }
}

/// What solving cost.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Work {
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
    pub compressed: u64,
    /// Evaluations of the equations.
    pub evaluations: u64,
    /// Solves that took the safeguarded path.
    pub safeguarded: u64,
    /// Largest |Δ(x) − Δ| before the last Newton step, relative to the terms of Δ.
    pub largest_residual: f64,
}

impl Work {
    /// Adds the work of another part.
    pub fn merge(&mut self, other: &Self) {
        self.contact_solves += other.contact_solves;
        self.noncontact_solves += other.noncontact_solves;
        self.constant += other.constant;
        self.closed_form += other.closed_form;
        self.far += other.far;
        self.unloaded += other.unloaded;
        self.compressed += other.compressed;
        self.evaluations += other.evaluations;
        self.safeguarded += other.safeguarded;
        self.largest_residual = self.largest_residual.max(other.largest_residual);
    }
}

/// Why a law cannot be made.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
pub enum LawError {
    /// λ outside the range that is solved.
    #[error("the adhesion parameter lambda is {0:e}, outside 1e-6..1e6")]
    Lambda(f64),
    /// A unit of the scaled variables outside the range whose powers are numbers.
    #[error(
        "the unit of {name} that follows from asperity_radius, work_of_adhesion and reduced_modulus is {value:e} in SI, outside \
         1e-60..1e60"
    )]
    Unit {
        /// What it is the unit of.
        name: &'static str,
        /// Its value, SI.
        value: f64,
    },
    /// A length that is too small or too large beside the unit of the approach.
    #[error("{name} is {value:e}, outside 1e-60..1e60 times the unit of the approach")]
    Length {
        /// Name of the quantity, as in scenes.
        name: &'static str,
        /// What was given or follows, SI.
        value: f64,
    },
    /// ω_c is infinite, but the law has an elastic-plastic scale even in its elastic regime.
    #[error("no critical interference is given, which the law {0} needs")]
    Elastic(&'static str),
    /// The asperity is none of the three whose curve fits are published.
    #[error(
        "Table 3 has curve fits for three asperities only (R, work of adhesion: 1.66 um, 0.01 J/m^2; 3.33 um, 0.09 J/m^2; \
         6.38 um, 0.30 J/m^2; E_r 85.29 GPa, Z_0 0.2 nm), and this is none of them; fit:refit fits any"
    )]
    NotInTable3,
    /// The law is fitted to one asperity, and there are asperities of many radii.
    #[error("it is a fit to one asperity, and asperities differ in their radii")]
    OneRadius,
    /// The law is fitted to one asperity, and tops that have flowed have radii of their own.
    #[error("it is a fit to one radius, so unloaded_radius has to be \"kept\"")]
    NotFlattened,
    /// The published forms cannot be fitted to the direct law.
    #[error("the published forms cannot be fitted to the law of this asperity")]
    NoFit,
    /// A quantity that has to be positive and finite.
    #[error("{name} is {value:e}, but has to be positive and finite")]
    NotPositive {
        /// Name of the quantity, as in scenes.
        name: &'static str,
        /// What was given, SI.
        value: f64,
    },
}
