//! The host of experiments: whoever starts them.

use super::Observer;
use crate::estimate::Estimate;
use std::path::Path;

/// Whoever starts experiments. By default nobody watches, nothing is said, and everything is allowed.
pub(crate) trait Host: Sync {
    /// Somebody who watches one of several runs, by its name.
    fn observer(&self, _run: String) -> Box<dyn Observer> {
        Box::new(())
    }

    /// Receives a notice of what ends nothing.
    fn notice(&self, _text: &str) {}

    /// Refuses what takes more memory than there is, or more disk where its output is to be.
    ///
    /// # Errors
    /// A line that says what it takes, what there is, and what would fit.
    fn require(&self, _estimate: &Estimate, _output: Option<&Path>) -> Result<(), String> {
        Ok(())
    }
}

/// Nobody.
impl Host for () {}
