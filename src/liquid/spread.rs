//! Liquid that spreads between bridges which merge.
//!
//! # Formula
//! A surface is summed bridge by bridge. Where liquid covers the share f of the nominal area, the expected
//! sum over the bridges gives way to [`super::Filling`] with a weight from 0 to 1 over ln f, 6x⁵ − 15x⁴ +
//! 10x³ between the ends of [`COVERS`]. This adds a pressure between the mean planes, of all replicas
//! alike; differences of replicas are left to bridges.

use crate::math::interpolation::lagrange;
use std::fmt;
use std::ops::Deref;
use std::sync::{Arc, LazyLock};

/// Covered shares up to which bridges are by themselves, and from which the liquid fills the gaps.
pub const COVERS: (f64, f64) = (0.03, 0.1);

/// The weight of the liquid that fills gaps where a share of the nominal area is covered.
pub fn weight(covered: f64) -> f64 {
    let (low, high) = COVERS;
    let x = if covered > low { (libm::log(covered / low) / libm::log(high / low)).min(1.0) } else { 0.0 };
    x * x * x * (10.0 + x * (6.0 * x - 15.0))
}

/// The pressure by which liquid that spreads pulls harder than its bridges, over separations.
#[derive(Clone, Debug, PartialEq)]
pub struct Spread {
    /// Separations h, m, rising.
    pub separations: Vec<f64>,
    /// Pressures there, Pa, attraction counted positive; 0 beyond the last.
    pub pressures: Vec<f64>,
}

impl Spread {
    /// The pressure at a separation h, m, Pa; below the first that at the first.
    pub fn pressure(&self, separation: f64) -> f64 {
        let [first, .., last] = self.separations[..] else { return self.pressures[0] };
        if separation > last {
            return 0.0;
        }
        lagrange::<6>(&self.separations, &self.pressures, separation.max(first))
    }
}

/// The pressures on all ways of a surface, from the moment on when they are asked for.
type Ways = LazyLock<Vec<Spread>, Box<dyn FnOnce() -> Vec<Spread> + Send + Sync>>;

/// The pressures on all ways of a surface, which are computed when they are first asked for: to read a scene takes no integral.
#[derive(Clone, Default)]
pub struct Spreads(Option<Arc<Ways>>);

impl Spreads {
    /// Pressures that are made by `make`.
    pub fn new(make: impl FnOnce() -> Vec<Spread> + Send + Sync + 'static) -> Self {
        Self(Some(Arc::new(LazyLock::new(Box::new(make)))))
    }
}

impl Deref for Spreads {
    type Target = [Spread];

    fn deref(&self) -> &[Spread] {
        self.0.as_ref().map_or(&[], |ways| ways.as_slice())
    }
}

impl PartialEq for Spreads {
    fn eq(&self, other: &Self) -> bool {
        **self == **other
    }
}

impl fmt::Debug for Spreads {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(if self.0.is_some() { "liquid that spreads" } else { "none" })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bridges_apart_are_left_alone() {
        assert_eq!([0.0, 0.01, 0.03, 0.1, 0.5, 1.0].map(weight), [0.0, 0.0, 0.0, 1.0, 1.0, 1.0]);
        let rising: Vec<f64> = (0..100).map(|i| weight(0.03 + 0.0007 * f64::from(i))).collect();
        assert!(rising.windows(2).all(|pair| pair[0] < pair[1]));
    }

    #[test]
    fn a_table_ends_where_nothing_is_covered() {
        let separations: Vec<f64> = (0..20).map(f64::from).collect();
        let pressures = separations.iter().map(|h| (19.0 - h) * h * h).collect();
        let spread = Spread { separations, pressures };
        assert!((spread.pressure(3.5) - 15.5 * 3.5 * 3.5).abs() < 1e-12);
        assert_eq!((spread.pressure(-1.0), spread.pressure(19.1)), (0.0, 0.0));
        assert_eq!(Spread { separations: vec![1.0], pressures: vec![2.0] }.pressure(1.0), 2.0);
    }
}
