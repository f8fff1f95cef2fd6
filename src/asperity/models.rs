//! The models of a rough surface: their names and the asperity laws behind them. A new law is its file and a line here.

use super::hybrid::Hybrid;
use super::law::Law;
use super::scale::Asperity;
use super::{LawError, Path};

/// Makes a law for an asperity, a history and the range of interferences, m, that it is needed for.
pub type Build = fn(&Asperity, Path, (f64, f64)) -> Result<Box<dyn Law>, LawError>;

/// A model of a rough surface.
#[derive(Clone, Copy, Debug)]
pub struct Model {
    /// Its name in scenes and files.
    pub name: &'static str,
    /// What it is, in a line.
    pub about: &'static str,
    /// Makes its law.
    pub build: Build,
}

/// All models.
pub const MODELS: &[Model] = &[
    Model {
        name: "hybrid",
        about: "extended Maugis-Dugdale up to the critical interference, Kogut-Etsion above",
        build: |asperity, path, reach| Ok(Box::new(Hybrid::new(asperity, path, reach)?)),
    },
    Model {
        name: "emd",
        about: "extended Maugis-Dugdale up to the critical interference, no force above",
        build: |asperity, path, reach| Ok(Box::new(Hybrid::elastic(asperity, path, reach)?)),
    },
];

/// The model of a name.
pub fn model(name: &str) -> Option<Model> {
    MODELS.iter().find(|model| model.name == name).copied()
}
