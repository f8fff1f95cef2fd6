//! The numbers of a replica whose means over replicas have no closed form.

use super::replica::Replica;

/// A number that is read off a replica's own curve.
#[derive(Clone, Copy, Debug)]
pub struct Scalar {
    /// Its name.
    pub name: &'static str,
    /// Its units, SI.
    pub units: &'static str,
    /// Its value.
    pub of: fn(&Replica) -> f64,
}

/// All of them.
pub const SCALARS: [Scalar; 4] = [
    Scalar { name: "pull_off_force", units: "N", of: |replica| replica.pull_off_force },
    Scalar { name: "pull_off_separation", units: "m", of: |replica| replica.pull_off_separation },
    Scalar { name: "peak_stiffness", units: "N m-1", of: |replica| replica.peak_stiffness },
    Scalar { name: "peak_stiffness_separation", units: "m", of: |replica| replica.peak_stiffness_separation },
];
