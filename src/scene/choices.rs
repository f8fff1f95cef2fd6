//! Closed lists and ranges of the values that keys of scenes take.

use super::definition::Sums;
use crate::asperity::Path;
use crate::substrate::{Coupling, Kernel};
use crate::surface::Places;
use std::ops::{Bound, RangeInclusive};

/// The scene format that is read.
pub(super) const FORMAT: u64 = 1;

/// Tolerances of sums by moments that make sense: below, the rounding of a solve is larger; above, nothing
/// gets faster.
pub(super) const SUM_TOLERANCES: RangeInclusive<f64> = 1e-13..=1e-3;

/// Ways of summing.
pub(super) const SUMS: [(&str, Option<Sums>); 3] =
    [("auto", Some(Sums::Auto)), ("direct", None), ("moments", Some(Sums::Moments))];

/// Histories: their paths, of a loop that of its first way, and whether the surfaces are pulled back.
pub(super) const HISTORIES: [(&str, (Path, bool)); 3] = [
    (Path::ALL[0].0, (Path::ALL[0].1, false)),
    (Path::ALL[1].0, (Path::ALL[1].1, false)),
    (LOOP, (Path::Approach, true)),
];
/// Name of the history of approach and retraction.
pub(super) const LOOP: &str = "loop";
/// The law of scenes that name none, and of those with a liquid.
pub(super) const DEFAULT_LAW: &str = "md_plastic";
pub(super) const DEFAULT_LAW_IN_LIQUID: &str = "capillary";

/// Poisson ratios of stable solids.
pub(super) const POISSON_RATIOS: (Bound<f64>, Bound<f64>) = (Bound::Excluded(-1.0), Bound::Included(0.5));

/// Laws of summits.
pub(super) const SUMMIT_LAWS: [(&str, ()); 1] = [("nayak", ())];
/// Samples of measured asperities in replicas; whether of all of them.
pub(super) const SAMPLES: [(&str, bool); 2] = [("bootstrap", false), ("whole", true)];

/// Whether measured asperities have the geometric mean of their principal radii.
pub(super) const MEASURED_RADII: [(&str, bool); 2] = [("mean_curvature", false), ("equivalent", true)];
/// Name of the stiffness of the half-space under a patch.
pub(super) const PATCH: &str = "patch";
/// Surroundings of a surface of coupled asperities; none where they are independent.
pub(super) const COUPLINGS: [(&str, Option<Coupling>); 3] =
    [("none", None), ("periodic", Some(Coupling::Periodic)), ("patch", Some(Coupling::Patch))];
/// Models of the action of coupled contacts on each other.
pub(super) const KERNELS: [(&str, Kernel); 2] = Kernel::ALL;
/// Positions of coupled asperities; the least distance of random ones follows from the surface.
pub(super) const POSITIONS: [(&str, Places); 4] = [
    ("hard_core", Places::HardCore(f64::NAN)),
    ("uniform", Places::Uniform),
    ("square", Places::Square),
    ("hexagonal", Places::Hexagonal),
];
/// Tolerances of the loads of coupled asperities: below, rounding is larger; above, jumps are mistaken.
pub(super) const TOLERANCES_OF_LOADS: RangeInclusive<f64> = 1e-12..=1e-4;
/// Coefficients of variation that laws of radii have.
pub(super) const VARIATIONS: RangeInclusive<f64> = 0.001..=1.0;

/// Most separations of a scene; far more than a curve needs.
pub(super) const MOST_SEPARATIONS: u64 = 10_000;
/// Most cycles of a loop: this number is as good as any.
pub(super) const MOST_CYCLES: u64 = 1_000_000_000;

/// Numbers of replicas that can be asked for.
pub(super) const REPLICAS: RangeInclusive<u64> = 1..=1_000_000_000_000;
/// Relative standard errors that make sense: below, rounding is larger; above, nothing is known.
pub(super) const RELATIVE: RangeInclusive<f64> = 1e-9..=0.5;

/// Most points of a sweep.
pub const MOST_POINTS: usize = 10_000;

/// Spacings of the values between two ends; whether by their logarithm.
pub(super) const SPACINGS: [(&str, bool); 2] = [("linear", false), ("log", true)];

/// The combination of several keys.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// Every value of each key with every value of the others.
    Grid,
    /// The first value of each key with the first of the others, the second with the second, and so on.
    Zip,
}

impl Mode {
    /// All of them, by name.
    pub const ALL: [(&'static str, Self); 2] = [("grid", Self::Grid), ("zip", Self::Zip)];

    /// The name in scenes and files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Grid => "grid",
            Self::Zip => "zip",
        }
    }
}
