//! Errors of liquids and their menisci.

use thiserror::Error;

/// Reasons why there is no liquid, or no meniscus of it.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
pub enum LiquidError {
    /// Liquid water is between the melting point and the critical point.
    #[error("water is a liquid from 273.15 K to below 647.096 K; this is {0} K")]
    Temperature(f64),
    /// A vapour that is saturated or absent has no meniscus of finite curvature.
    #[error("a relative humidity is greater than 0 and less than 1; this is {0}")]
    Humidity(f64),
    /// The contact angles are so large that no liquid condenses.
    #[error(
        "cos(theta1) + cos(theta2) is {0:.4}, but has to be positive: between such surfaces no liquid condenses"
    )]
    NotWetting(f64),
    /// A contact angle is from 0 to π.
    #[error("a contact angle is from 0 to 180 deg; this is {0} rad")]
    Angle(f64),
    /// A quantity that has to be positive and finite.
    #[error("{name} is {value:.4e}, but has to be positive and finite")]
    NotPositive {
        /// Name of the quantity, as in scenes.
        name: &'static str,
        /// The value that was given, SI.
        value: f64,
    },
}
