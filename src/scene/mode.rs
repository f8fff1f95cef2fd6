//! The combination of several keys of a sweep, and the keys of `[sweep]`.

use super::keys::Value::{Choice, Switch, Table, Various, Whole};
use super::keys::{Key, key, names};

/// The keys of `[sweep]`.
pub(super) static KEYS: &[Key] = &[
    key("sweep", "{ \"material.work_of_adhesion\" = [\"0.04 J/m^2\", \"0.09 J/m^2\"] }", Table)
        .what("keys with several values")
        .follows("none; one scene"),
    key("sweep.mode", "\"grid\"", Choice(|| names(&Mode::ALL)))
        .what("how several keys are combined")
        .about(
            "`grid`: every value with every other. `zip`: the first with the first, the second with the \
             second.",
        )
        .defaults_to("\"grid\""),
    key("sweep.common_random_numbers", "true", Switch)
        .what("whether all points share their random numbers")
        .about("Differences between points are then known much better than the points.")
        .defaults_to("true"),
    key("sweep.*.from", "", Various("a value of the key")).what("the first value"),
    key("sweep.*.to", "", Various("a value of the key")).what("the last value"),
    key("sweep.*.count", "7", Whole(2, MOST_POINTS as u64)).what("number of values"),
    key("sweep.*.spacing", "\"log\"", Choice(|| names(&SPACINGS)))
        .what("linear or logarithmic")
        .defaults_to("\"linear\""),
];

/// Most points of a sweep.
pub const MOST_POINTS: usize = 10_000;

/// Spacings of the values between two ends; whether by their logarithm.
pub(super) const SPACINGS: [(&str, bool); 2] = [("linear", false), ("log", true)];

/// The combination of several keys.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// Every value of each key with every value of the others.
    Grid,
    /// The first value of each key with the first of the others, the second with the second, and so on.
    Zip,
}

impl Mode {
    /// All of them, by name.
    pub const ALL: [(&'static str, Self); 2] = [("grid", Self::Grid), ("zip", Self::Zip)];

    /// The name in scenes and files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Grid => "grid",
            Self::Zip => "zip",
        }
    }
}
