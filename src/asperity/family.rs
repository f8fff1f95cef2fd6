//! Laws of the asperities of a surface: one law of all, or a law for each radius.

use super::error::LawError;
use super::history::Path;
use super::law::Law;
use super::models::Model;
use super::parameters::LawParameters;
use super::scale::Asperity;
use std::ops::Deref;
use std::sync::Arc;

/// Makes the law of an asperity of a radius, m, with starting tables for interferences in a range, m, where
/// there is one.
type OfRadius = dyn Fn(f64, Option<(f64, f64)>) -> Box<dyn Law> + Send + Sync;

/// The laws of asperities that differ in their radius alone.
#[derive(Clone)]
pub struct Family {
    of_radius: Arc<OfRadius>,
}

impl Family {
    /// The laws that a function makes.
    pub fn from_fn(
        of_radius: impl Fn(f64, Option<(f64, f64)>) -> Box<dyn Law> + Send + Sync + 'static,
    ) -> Self {
        Self { of_radius: Arc::new(of_radius) }
    }

    /// The law of an asperity of a radius, m, with starting tables for interferences in `reach`, m; without,
    /// it takes less to make, and each solve more.
    ///
    /// # Panics
    /// When the radius is not between those that the family was made for.
    pub fn law(&self, radius: f64, reach: Option<(f64, f64)>) -> Box<dyn Law> {
        (self.of_radius)(radius, reach)
    }

    /// The laws of a model for asperities like one, whose radii differ from its radius by factors between
    /// `least` and `most`.
    ///
    /// # Errors
    /// [`LawError`] when one of these two has no law.
    pub fn new(
        model: Model,
        asperity: Asperity,
        path: Path,
        (least, most): (f64, f64),
    ) -> Result<Self, LawError> {
        if model.is_fit() {
            return Err(LawError::OneRadius);
        }
        let of_radius = move |radius: f64, reach: Option<(f64, f64)>| {
            let parameters = LawParameters::new(&Asperity { radius, ..asperity }, path, (0.0, 0.0))?;
            model.law(&LawParameters { reach, ..parameters })
        };
        for factor in [least, most] {
            of_radius(factor * asperity.radius, None)?;
        }
        let law = move |radius, reach| {
            of_radius(radius, reach).expect("laws between two radii that have one have one")
        };
        Ok(Self::from_fn(law))
    }
}

/// The laws of the asperities of a surface, which behave as the law of the typical one.
#[derive(Clone, Copy)]
pub struct Laws<'a> {
    /// The law of the typical asperity; of every asperity where there is no family.
    pub typical: &'a dyn Law,
    /// The laws by radius, where asperities differ in it.
    pub family: Option<&'a Family>,
}

impl<'a> Deref for Laws<'a> {
    type Target = dyn Law + 'a;

    fn deref(&self) -> &Self::Target {
        self.typical
    }
}

impl<'a> From<&'a (dyn Law + 'a)> for Laws<'a> {
    fn from(typical: &'a (dyn Law + 'a)) -> Self {
        Self { typical, family: None }
    }
}

impl<'a, L: Law + 'a> From<&'a L> for Laws<'a> {
    fn from(law: &'a L) -> Self {
        Self { typical: law, family: None }
    }
}

/// The laws of a surface as they are made.
pub struct SurfaceLaws {
    /// The law of the typical asperity.
    pub typical: Box<dyn Law>,
    /// The laws by radius, where asperities differ in it.
    pub family: Option<Family>,
}

impl SurfaceLaws {
    /// The view that sums take.
    pub fn view(&self) -> Laws<'_> {
        Laws { typical: self.typical.as_ref(), family: self.family.as_ref() }
    }
}

impl Deref for SurfaceLaws {
    type Target = dyn Law;

    fn deref(&self) -> &Self::Target {
        self.typical.as_ref()
    }
}
