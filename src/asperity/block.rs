//! Blocks of asperities.

/// Asperities that are evaluated at once.
pub const BLOCK: usize = 256;

/// Responses of a block of asperities, on cache lines of their own: a vector of 512 bits that lies across two
/// lines takes twice as long to load and store, and where memory begins would be luck.
#[derive(Clone, Debug)]
#[repr(align(64))]
pub struct Responses {
    /// Adhesion force F_s, N, attractive counted positive.
    pub adhesion: [f64; BLOCK],
    /// Contact force P, N, compressive counted positive.
    pub contact: [f64; BLOCK],
    /// Contact area, m².
    pub area: [f64; BLOCK],
}

impl Default for Responses {
    fn default() -> Self {
        Self { adhesion: [0.0; BLOCK], contact: [0.0; BLOCK], area: [0.0; BLOCK] }
    }
}
