//! Numbers of both precisions.

use num_traits::{Float, NumAssign};
use std::fmt::Debug;

/// A number of single or double precision.
pub trait Real: Float + NumAssign + Default + Debug + Send + Sync {
    /// The nearest one of a value.
    fn of(value: f64) -> Self;
    /// Its value.
    fn value(self) -> f64;
}

impl Real for f64 {
    #[inline(always)]
    fn of(value: f64) -> Self {
        value
    }

    #[inline(always)]
    fn value(self) -> f64 {
        self
    }
}

impl Real for f32 {
    #[inline(always)]
    fn of(value: f64) -> Self {
        value as Self
    }

    #[inline(always)]
    fn value(self) -> f64 {
        f64::from(self)
    }
}
