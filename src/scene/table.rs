//! The table of the keys of scenes, of which the rows are next to their readers: the reader takes units, bounds, examples and
//! exclusions from it, and `docs/scene.md` all of it.

use super::background::FORCES;
use super::keys::Key;
use super::lookup::Keys;
use super::{
    capillary, device, ensemble, instability, laws, material, measured, mode, model, parse, population,
    separation, shape, solver, substrate, summits,
};
use std::sync::LazyLock;

/// Every key of a scene by its dotted name, in the order of the reference. `[]` is an element of a list, `sweep.*` a key
/// that is swept.
pub static KEYS: LazyLock<Keys> = LazyLock::new(|| {
    let first: [&[Key]; 11] = [
        parse::ROOT,
        material::KEYS,
        population::KEYS,
        laws::KEYS,
        summits::KEYS,
        measured::KEYS,
        shape::KEYS,
        model::KEYS,
        capillary::KEYS,
        separation::KEYS,
        ensemble::KEYS,
    ];
    let last: [&[Key]; 5] = [instability::KEYS, device::KEYS, solver::KEYS, parse::OUTPUT, mode::KEYS];
    let forces = FORCES.iter().map(|table| table.keys);
    Keys::new(first.into_iter().chain([substrate::KEYS]).chain(forces).chain(last))
});
