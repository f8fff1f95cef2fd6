//! Numerical tools that know no physics: roots, quadrature, polynomials, sums and moments.

pub mod chebyshev;
pub mod chunks;
pub mod clenshaw_curtis;
pub mod control_variates;
pub mod counting_sort;
pub mod error_function;
pub mod exponential;
pub mod extrema;
pub mod fft;
pub mod gauss;
pub mod gmres;
pub mod instruction_set;
pub mod interpolation;
pub mod interval;
pub mod linalg;
pub mod lu;
pub mod moments;
pub mod piecewise;
pub mod polynomials;
pub mod power;
pub mod proportion;
pub mod quadrature;
pub mod quantile;
pub mod real;
pub mod roots;
pub mod sums;
