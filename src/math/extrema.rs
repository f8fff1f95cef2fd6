//! extrema
