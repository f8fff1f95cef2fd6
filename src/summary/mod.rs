//! What is stated of scenes and results, in the words of the program.

pub(crate) mod coupling;
pub(crate) mod describe;
pub(crate) mod independence;
pub(crate) mod instability;
pub(crate) mod integral;
pub(crate) mod rows;
pub(crate) mod run;
