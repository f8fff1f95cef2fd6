//! Liquid that spreads between the bridges of a scene's asperities.
//!
//! # Formula
//! On each way over the separations, with the expected pull E of the asperities, their pull without the
//! tension of the liquid, E₀, and the share f of the nominal area that is covered, A_n p is added to the pull
//! of every replica,
//!
//! p = w(f) [p_f − (E − E₀)/A_n],
//!
//! with the tension p_f of [`crate::liquid::Filling`], at least 0. f is the share that bridges cover; where the faces have touched
//! or bridges are reversible there is liquid in all gaps that hold some, and f is the larger of that share and the share Φ(−v)
//! of these gaps: liquid that fills the gaps lasts where single bridges break. m₂ belongs to the Gaussian
//! surface with the asperities of the scene, m₂ = m₄/(6π√3η), m₄ = (3√π/8R)² ([`crate::surface::Spectrum`]).

use super::Scene;
use crate::asperity::Model;
use crate::asperity::{LawError, LawParameters, Path, Quantity, Regime};
use crate::integral::{Expectations, RetractionModel};
use crate::liquid::{Bridges, Filling, Meniscus, Spread, Spreads, Volume, weight};
use crate::surface::{Radii, Spectrum, Surface};
use std::f64::consts::PI;

/// Steps of the table over standard deviations of the heights, and by how much of the distance from where it varies on their
/// scale they grow.
const STEP: f64 = 0.1;
const GROWTH: f64 = 0.5;
/// Standard deviations of the heights within which asperities are wet.
const REACH: f64 = 10.0;

/// Asperities of a surface in one state, by their bridges.
#[derive(Clone, Copy, Debug, Default)]
pub struct Wet {
    /// Asperities that touch.
    pub contacts: f64,
    /// Asperities that only a bridge joins to the other face.
    pub bridges: f64,
    /// F_s of these, N.
    pub pull: f64,
    /// Contact area, m².
    pub area: f64,
}

impl Wet {
    /// Sums the regimes of a surface, by their names, of which `of` says number and F_s, N.
    pub fn new(regimes: &[&str], area: f64, of: impl Fn(usize) -> (f64, f64)) -> Self {
        let mut wet = Self { area, ..Self::default() };
        for (i, name) in regimes.iter().enumerate() {
            let (count, pull) = of(i);
            match Regime::named(name) {
                Some(Regime::Bridge) => (wet.bridges, wet.pull) = (count, pull),
                Some(regime) if regime.is_contact() => wet.contacts += count,
                _ => {}
            }
        }
        wet
    }

    /// Asperities with liquid around them.
    pub fn count(&self) -> f64 {
        self.contacts + self.bridges
    }

    /// Σπx² of the wetted circles, m²: around a contact of radius a the liquid reaches to x² = a² + 2Rh₀, and a bridge has the
    /// force p_c πx².
    fn wetted_area(&self, meniscus: &Meniscus, radius: f64) -> f64 {
        self.area + self.contacts * 2.0 * PI * radius * meniscus.range() + self.pull / meniscus.pressure()
    }

    /// The share of the nominal area that circles of this area cover at random places.
    pub fn covered(&self, meniscus: &Meniscus, surface: &Surface) -> f64 {
        -libm::expm1(-self.wetted_area(meniscus, surface.asperity_radius) / surface.nominal_area)
    }
}

impl Scene {
    /// The liquid that fills gaps between the faces of the scene, if its law has one.
    pub fn filling(&self) -> Option<Filling> {
        let meniscus = self.model.meniscus()?;
        let surface = self.surface.plane();
        let density = surface.asperity_count as f64 / surface.nominal_area;
        let (std, radius) = (surface.surface_height_std, surface.asperity_radius);
        let spectrum = match surface.radii {
            Radii::Nayak(spectrum) => spectrum,
            _ => Spectrum::of_asperities(std, radius, density),
        };
        let share = meniscus.share_beyond(self.asperity.attraction_range());
        Some(Filling::new(meniscus, share, std, spectrum.m2))
    }

    /// The expectations of the asperities of the scene under a law over separations, m: on approach, and on the ways after it.
    pub(super) fn expectations_on_ways(
        &self,
        model: Model,
        separations: &[f64],
    ) -> Result<Vec<Expectations>, LawError> {
        let scene = Self { model, ..self.clone() };
        let law = scene.law()?;
        let mut ways = vec![Expectations::new(law.view(), &scene.surface, separations)];
        if let Some(cycle) = scene.loop_law()? {
            ways.push(Expectations::retraction(&cycle, &scene.surface, separations));
            let again = RetractionModel::again(&cycle, &scene.surface, separations[0]);
            ways.extend(again.map(|model| model.answer(separations)));
        }
        Ok(ways)
    }

    /// The scene with liquid that spreads where bridges merge. Bridges that keep their liquid are left as they are.
    ///
    /// # Errors
    /// [`LawError`] where a law cannot be made.
    pub(super) fn with_spread(mut self) -> Result<Self, LawError> {
        self.surface.spread = Spreads::default();
        let Some((filling, meniscus)) = self.filling().zip(self.model.meniscus().copied()) else {
            return Ok(self);
        };
        if meniscus.volume == Volume::Constant {
            return Ok(self);
        }
        self.model.immersed().admits(&LawParameters::new(&self.asperity, Path::Approach, (0.0, 0.0))?)?;
        let scene = self.clone();
        self.surface.spread = Spreads::new(move || scene.spreads(&filling, &meniscus).unwrap_or_default());
        Ok(self)
    }

    /// The liquid that spreads on approach and on the ways after it; nothing where it does on none.
    fn spreads(&self, filling: &Filling, meniscus: &Meniscus) -> Result<Vec<Spread>, LawError> {
        let separations = self.spread_separations(meniscus);
        let surface = self.surface.plane();
        let tip = surface.asperity_radius;
        let flat = Surface { background: None, spread: Spreads::default(), ..surface.into_owned() };
        let alone = Self { surface: flat, ..self.clone() };
        let wet = alone.expectations_on_ways(self.model, &separations)?;
        let immersed = alone.expectations_on_ways(self.model.immersed(), &separations)?;
        let law = self.law()?;
        let regimes: Vec<&str> = law.view().regimes().iter().map(|regime| regime.name()).collect();
        let (area, force) = (Quantity::ContactArea.index(), Quantity::ExternalForce.index());
        let covered = |wet: &Expectations, k: usize| {
            let of = |regime: usize| (wet.regime_count[regime][k], wet.regime_adhesion_force[regime][k]);
            Wet::new(&regimes, wet.expected[area][k], of).covered(meniscus, &alone.surface)
        };
        // On the way back there is liquid where a body was near enough, or bridges form by themselves.
        let is_wet = |k: &usize| weight(covered(&wet[0], *k)) > 0.0;
        let reached =
            (0..separations.len()).rev().find(is_wet).map_or(0.0, |k| separations[k] - separations[0]);
        let spread = wet.iter().zip(&immersed).enumerate().map(|(way, (wet, immersed))| {
            let is_reversible = meniscus.bridges == Bridges::Reversible;
            let is_held = way > 0 || is_reversible;
            let deepest = if way > 0 && !is_reversible { reached } else { f64::INFINITY };
            let of_filling = |k: usize, h: f64| {
                let filled = if is_held { filling.share(h) } else { 0.0 };
                weight(covered(wet, k).max(filled))
            };
            let of_liquid = |(k, h): (usize, &f64)| of_filling(k, *h) * filling.tension(*h).max(0.0);
            let of_bridges = |(k, h): (usize, &f64)| {
                let pull = immersed.expected[force][k] - wet.expected[force][k];
                of_filling(k, *h) * pull / self.surface.nominal_area
            };
            let over = |tip: f64, of: &dyn Fn((usize, &f64)) -> f64| -> Vec<f64> {
                let pressures = separations.iter().enumerate().map(of).collect();
                if self.surface.heights.depths().is_none() {
                    return pressures;
                }
                let flat = Spread { separations: separations.clone(), pressures };
                let over = |h: &f64| self.surface.over_body(tip, deepest, |h| flat.pressure(h), *h);
                separations.iter().map(over).collect()
            };
            let (of_liquid, of_bridges) = (over(0.0, &of_liquid), over(tip, &of_bridges));
            let pressures = of_liquid.into_iter().zip(of_bridges).map(|(liquid, bridges)| liquid - bridges);
            Spread { separations: separations.clone(), pressures: pressures.collect() }
        });
        let spread: Vec<Spread> = spread.collect();
        let is_none = spread.iter().all(|way| way.pressures.iter().all(|pressure| *pressure == 0.0));
        Ok(if is_none { Vec::new() } else { spread })
    }

    /// Separations h, m, from the first of the scene to its last or to where no asperity is wet: by [`STEP`] standard
    /// deviations of the heights where asperities begin to touch or bridges to break, and further apart away from there.
    fn spread_separations(&self, meniscus: &Meniscus) -> Vec<f64> {
        let (mean, std) = self.surface.plane().heights.moments();
        let touch = self.surface.mean_plane_offset + mean;
        let (width, wet) = (REACH * std, touch + meniscus.range());
        let last = self.separations[self.separations.len() - 1];
        let furthest = if self.surface.heights.depths().is_some() { f64::INFINITY } else { last };
        let (first, last) = (self.separations[0], furthest.min(wet + width));
        let (mut all, mut next) = (vec![first], first);
        loop {
            let away = ((next - touch).abs().min((next - wet).abs()) - width).max(0.0);
            next += STEP * (std + GROWTH * away);
            if !(next < last) {
                break;
            }
            all.push(next);
        }
        all.extend((last > first).then_some(last));
        all
    }
}
