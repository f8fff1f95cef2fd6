//! statistical
