//! Films that drain: what is in the bridges is missing from the films between them.
//!
//! # Formula
//! n(t₀ − t) A_n = ΣV over the asperities with a bridge at a separation, V = πR((h₀ − nt)² − (D − nt)²), with the range h₀ and the
//! bridges that there are for t. V rises with t, so one t solves it. ΣV is its expectation. It is that around rigid spheres;
//! which asperities have bridges is that of elastic ones.

use super::{Expectations, Interface};
use crate::asperity::{LawError, Quantity};
use crate::math::extrema::smallest;
use crate::math::interpolation::lagrange;

/// Thicknesses that are integrated over; between them there are polynomials.
const NODES: usize = 17;
/// Halvings of an interval of thicknesses, to its rounding.
const HALVINGS: usize = 60;

/// The films on the surfaces on one branch over the separations.
#[doc(hidden)]
#[derive(Clone, Debug, PartialEq)]
pub struct Films {
    /// Thickness t, m.
    pub thickness: Vec<f64>,
    /// The expected external force with films as thick, N.
    pub external_force: Vec<f64>,
}

/// The fraction of a film that is negligible.
const ROUNDING: f64 = 1e-13;

/// Expectations with one thickness on one branch over the separations.
struct Expected {
    /// Volume ΣV, m³.
    volume: Vec<f64>,
    /// External force, N.
    external_force: Vec<f64>,
}

impl Interface {
    /// The films on the surfaces on approach and on the branches after it, if there are any; their `initial` thickness, m, if they
    /// drain into bridges.
    fn films(&self, initial: Option<f64>) -> Result<Vec<Films>, LawError> {
        let Some(film) = self.model.meniscus().and_then(|meniscus| meniscus.film) else {
            return Ok(Vec::new());
        };
        let Some(initial) = initial else {
            let thickness = vec![film.thickness; self.separations.len()];
            let of =
                |one: Expected| Films { thickness: thickness.clone(), external_force: one.external_force };
            return Ok(self.with_film(film.thickness)?.expected()?.into_iter().map(of).collect());
        };
        let supply =
            |thickness: f64| f64::from(film.faces) * (initial - thickness) * self.surface.nominal_area;
        let thickest = self.with_film(initial)?.expected()?;
        let most =
            thickest.iter().flat_map(|one| &one.volume).fold(0.0, |most: f64, volume| most.max(*volume));
        // V falls as t² at least: no film is thinner than the root of 1 − x = q x².
        let q = most / supply(0.0);
        let least = initial * if q > 0.0 { 2.0 / (1.0 + (1.0 + 4.0 * q).sqrt()) } else { 1.0 };
        let part = |i: usize| least + (initial - least) * i as f64 / (NODES - 1) as f64;
        let thicknesses: Vec<f64> = (0..NODES).map(part).collect();
        let thinner = thicknesses[..NODES - 1].iter().map(|thickness| self.with_film(*thickness)?.expected());
        let nodes = thinner.chain([Ok(thickest)]).collect::<Result<Vec<Vec<Expected>>, LawError>>()?;
        let drained = |way: usize| {
            let at = |of: &dyn Fn(&Expected) -> f64, thickness: f64| {
                let values: Vec<f64> = nodes.iter().map(|ways| of(&ways[way])).collect();
                if least < initial { lagrange::<6>(&thicknesses, &values, thickness) } else { values[0] }
            };
            let thickness_at = |k: usize| {
                // Over the thickness ΣV is as steep as the tail of the heights, and its logarithm is not.
                let none = ROUNDING * supply(0.0);
                let volume = |t: f64| libm::exp(at(&|one| libm::log(one.volume[k] + none), t)) - none;
                let (mut low, mut high) = (least, initial);
                for _ in 0..HALVINGS {
                    let middle = 0.5 * (low + high);
                    (low, high) =
                        if supply(middle) > volume(middle) { (middle, high) } else { (low, middle) };
                }
                0.5 * (low + high)
            };
            let thickness: Vec<f64> = (0..self.separations.len()).map(thickness_at).collect();
            let force = |(k, t): (usize, &f64)| at(&|one| one.external_force[k], *t);
            Films { external_force: thickness.iter().enumerate().map(force).collect(), thickness }
        };
        Ok((0..nodes[0].len()).map(drained).collect())
    }

    /// The surfaces with their liquid: films, in the law drained as far as where the surfaces are pulled off, on average, and liquid
    /// that spreads. `draining` is the thickness of films before they drain, m, if they do.
    ///
    /// # Errors
    /// [`LawError`] where a law cannot be made.
    pub fn with_liquid(self, draining: Option<f64>) -> Result<(Self, Vec<Films>), LawError> {
        let films = self.films(draining)?;
        let pulled = films.get(1).or(films.first());
        let Some(Films { thickness, external_force }) = pulled else {
            return Ok((self.with_spread()?, films));
        };
        let deepest = smallest(external_force);
        Ok((self.with_film(thickness[deepest])?, films))
    }

    /// The surfaces with films of another thickness, m, and with the liquid that then spreads.
    fn with_film(&self, thickness: f64) -> Result<Self, LawError> {
        let meniscus = self.model.meniscus().expect("films are of a liquid").at_thickness(thickness);
        Self { model: self.model.with_liquid(meniscus), ..self.clone() }.with_spread()
    }

    /// Expectations of the surfaces as they are, on approach and on the branches after it.
    fn expected(&self) -> Result<Vec<Expected>, LawError> {
        let contents = self.expectations(self.model.content(), &self.separations)?;
        let forces = self.expectations(self.model, &self.separations)?;
        let of = |(content, force): (Expectations, Expectations)| {
            let [volume, external_force] =
                [(content, Quantity::AdhesionForce), (force, Quantity::ExternalForce)]
                    .map(|(mut all, quantity)| std::mem::take(&mut all.expected[quantity.index()]));
            Expected { volume, external_force }
        };
        Ok(contents.into_iter().zip(forces).map(of).collect())
    }
}
