//! Numbers of terms of polynomials, and of surfaces that are multiplied at once.

/// Largest degree of a polynomial.
pub const DEGREE: usize = 15;
/// Terms of the largest polynomial.
pub(super) const TERMS: usize = DEGREE + 1;
/// Replicas that are multiplied at once.
pub const LANES: usize = 8;

/// Asperities of a replica beyond which one at a time is summed: to bin them takes most of the time then, and memory.
pub const MANY: usize = 1 << 20;

/// A number of each surface of a batch.
pub(super) type Lanes = [f64; LANES];
