//! The integral of the retraction of a loop: at every distance from the closest approach the asperities of a radius obey
//! one law in their interference there.

use super::expectations::Expectations;
use super::height_integral::AtSeparation;
use super::model::{Mixture, TOLERANCE, accuracy};
use crate::asperity::{ByRegime, Law, Loop, Quantity};
use crate::math::piecewise::Cell;
use crate::surface::{RadiusClass, RadiusPanels, Surface};
use rayon::prelude::*;
use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};

/// Parts of a panel of the radius in which kinks of the expectations are sought. `PLACE` is the share of a part to which
/// they are found.
const LOOKED_AT: usize = 16;
/// Relative accuracy asked of every piece of the law of one of several radii: the integral over radii is no
/// better.
const RETRACTION_TOLERANCE: f64 = 1e-6;
const PLACE: f64 = 1e-9;
/// Asperities of a radius at which the density of radii has less than this probability do not count.
const NEGLIGIBLE: f64 = 1e-9;
/// Distance, in σ_s, of the separations between which the external force over radii of a density is
/// interpolated; it is halved a few times where the force is not smooth enough for the accuracy.
const INTERPOLATED: f64 = 0.25;
const HALVINGS: u32 = 2;
const LAST_TERM: f64 = 1e-6;

/// The integral model of a surface that is pulled back along a loop.
///
/// # Examples
/// ```
/// use stiction::asperity::{LawParameters, Loop, Path, Quantity, model};
/// use stiction::integral::{Expectations, RetractionModel};
/// use stiction::surface::Surface;
///
/// let parameters = LawParameters::scaled(10.0, Path::Approach)?;
/// let cycle = Loop::new(&model("md").unwrap(), &parameters)?;
/// let surface = Surface::uniform(1.0, 1.0, 100, 1.0);
/// let pulled = RetractionModel::new(&cycle, &surface, 0.0).answer(&[2.0]).expected;
/// let approach = Expectations::new(cycle.approach(), &surface, &[2.0]).expected;
/// let area = Quantity::ContactArea.index();
/// assert!(pulled[area][0] > approach[area][0], "contacts hold on");
/// # Ok::<(), stiction::asperity::LawError>(())
/// ```
pub struct RetractionModel<'a> {
    cycle: &'a Loop,
    surface: &'a Surface,
    /// d, m, where the surfaces turned.
    closest: f64,
    radii: Radii,
    /// The external force, N, at a separation h, m, from the force of the asperities, N.
    external_force: fn(&Surface, f64, f64) -> f64,
    /// Known interpolants of the external force.
    forces: Forces,
}

/// Interpolants of the external force of the asperities of a model, N, by their halvings and numbers.
#[derive(Clone, Default)]
pub(crate) struct Forces(Arc<Mutex<HashMap<(u32, u64), Cell>>>);

/// The radii of the asperities.
enum Radii {
    /// Given radii, or one.
    Parts(Vec<Part>),
    /// Radii by a density. `meetings` are the distances, m, at which ends of the law meet, at rising places of the variable
    /// of the density. `known` are the loops of radii in panels without a meeting, by the bits of the radii.
    Density { panels: RadiusPanels, meetings: Vec<(f64, Vec<f64>)>, known: HashMap<u64, Arc<Loop>> },
}

/// Asperities of a radius, and their loop where each radius has its own.
struct Part {
    of: RadiusClass,
    cycle: Option<Arc<Loop>>,
}

impl<'a> RetractionModel<'a> {
    /// The model of a surface that turns at a separation h, m.
    pub fn new(cycle: &'a Loop, surface: &'a Surface, closest: f64) -> Self {
        let closest = surface.asperity_separation(closest);
        let radii = Radii::Parts(Vec::new());
        let (external_force, forces) = (Surface::external_force_back as fn(&_, _, _) -> _, Forces::default());
        let mut model = Self { cycle, surface, closest, radii, external_force, forces };
        model.radii = match surface.radius_panels() {
            None => Radii::Parts(model.parts(surface.parts(), &HashMap::new())),
            Some(panels) => {
                let within = |ends: &[f64]| {
                    let (low, width) = (ends[0], (ends[1] - ends[0]) / LOOKED_AT as f64);
                    (0..LOOKED_AT).map(move |i| low + width * i as f64)
                };
                let places = panels.breaks.windows(2).flat_map(within).chain(panels.breaks.last().copied());
                let places: Vec<f64> = places.collect();
                let at = |place: f64| (place, model.of_radius(panels.radius(place)).meetings());
                let meetings = places.into_par_iter().map(at).collect();
                let known = |class: RadiusClass| {
                    (class.radius.to_bits(), Arc::new(model.of_radius(class.radius).tabulated()))
                };
                let known = panels.parts(&[]).into_iter().map(known).collect();
                Radii::Density { panels, meetings, known }
            }
        };
        model
    }

    /// The model of the second approach of a loop, if it has one.
    pub fn again(cycle: &'a Loop, surface: &'a Surface, closest: f64) -> Option<Self> {
        let external_force = Surface::external_force_again;
        cycle.again().map(|again| Self { external_force, ..Self::new(again, surface, closest) })
    }

    /// The model with known interpolants of its external force.
    pub(crate) fn knowing(self, forces: Forces) -> Self {
        Self { forces, ..self }
    }

    /// The known interpolants of its external force.
    pub(crate) fn forces(&self) -> Forces {
        self.forces.clone()
    }

    /// The loop of asperities of a radius, m.
    fn of_radius(&self, radius: f64) -> Loop {
        self.cycle.of(self.cycle.lane(radius / self.surface.asperity_radius))
    }

    /// The loops of asperities, of which some are known.
    fn parts(&self, classes: Vec<RadiusClass>, known: &HashMap<u64, Arc<Loop>>) -> Vec<Part> {
        let new = |radius: f64| Arc::new(self.of_radius(radius));
        let own = |radius: f64| known.get(&radius.to_bits()).cloned().unwrap_or_else(|| new(radius));
        let part = |of: RadiusClass| {
            let cycle = self.surface.is_polydisperse().then(|| own(of.radius));
            Part { of, cycle }
        };
        classes.into_par_iter().map(part).collect()
    }

    /// Places of the variable of the radius at which expectations at a distance, m, are not smooth in it.
    fn kinks(&self, panels: &RadiusPanels, meetings: &[(f64, Vec<f64>)], distance: f64) -> Vec<f64> {
        let mut kinks = Vec::new();
        for pair in meetings.windows(2) {
            let [(low, before), (high, after)] = [&pair[0], &pair[1]];
            for (i, (before, after)) in before.iter().zip(after).enumerate() {
                if !((before - distance) * (after - distance) < 0.0) {
                    continue;
                }
                let (mut low, mut high, width) = (*low, *high, PLACE * (high - low));
                while high - low > width {
                    let middle = 0.5 * (low + high);
                    let here = self.of_radius(panels.radius(middle)).meetings()[i];
                    *(if (here - distance) * (before - distance) > 0.0 { &mut low } else { &mut high }) =
                        middle;
                }
                kinks.push(0.5 * (low + high));
            }
        }
        kinks
    }

    /// The answer at separations h, m, in the regimes of the law on approach.
    pub fn answer(&self, separations: &[f64]) -> Expectations {
        self.of_asperities(separations)
            .beside(|h, force| (self.external_force)(self.surface, h, force), separations)
    }

    /// Expected external force, N, at one separation h, m. Where radii have a density it is interpolated, to about 1e-6.
    pub fn external_force(&self, separation: f64) -> f64 {
        (self.external_force)(self.surface, separation, self.external_force_of_asperities(separation))
    }

    /// Expected external force of the asperities alone, N, without the attraction of the mean planes.
    pub(crate) fn external_force_of_asperities(&self, separation: f64) -> f64 {
        let direct = |h: f64| self.of_asperities(&[h]).expected[Quantity::ExternalForce.index()][0];
        let from = self.closest + self.surface.mean_plane_offset;
        let is_smooth = self.surface.heights.values().is_none() && separation >= from;
        if !(is_smooth && matches!(self.radii, Radii::Density { .. })) {
            return direct(separation);
        }
        for halvings in 0..=HALVINGS {
            let width = INTERPOLATED * self.surface.surface_height_std / f64::from(1_u32 << halvings);
            let number = ((separation - from) / width).floor();
            let cell = self.forces.cell((halvings, number as u64), || {
                Cell::interpolate(&direct, from + number * width, from + (number + 1.0) * width)
            });
            if cell.last_term() <= LAST_TERM {
                return cell.value(separation);
            }
        }
        direct(separation)
    }

    /// The answer for the asperities alone, without the attraction of the mean planes.
    pub(crate) fn of_asperities(&self, separations: &[f64]) -> Expectations {
        let at: Vec<Mixture> = separations.par_iter().map(|h| self.at(*h)).collect();
        let (law, regimes) = (self.cycle.at(0.0), self.cycle.approach().regimes());
        let expectations = Mixture::expectations(&at, self.surface, law.regimes());
        let counted = |table: &ByRegime| {
            let mut sums = vec![vec![0.0; separations.len()]; regimes.len()];
            for (row, &base) in table.iter().zip(law.base()) {
                sums[base].iter_mut().zip(row).for_each(|(sum, value)| *sum += value);
            }
            ByRegime::new(regimes, sums)
        };
        Expectations {
            regime_count: counted(&expectations.regime_count),
            regime_adhesion_force: counted(&expectations.regime_adhesion_force),
            regime_external_force: counted(&expectations.regime_external_force),
            ..expectations
        }
    }

    /// Expectations at a separation h, m.
    fn at(&self, separation: f64) -> Mixture {
        let distance = self.surface.asperity_separation(separation) - self.closest;
        let own;
        let parts = match &self.radii {
            Radii::Parts(parts) => parts,
            Radii::Density { panels, meetings, known } => {
                let mut classes = panels.parts(&self.kinks(panels, meetings, distance));
                classes.retain(|class| class.weight > NEGLIGIBLE);
                own = self.parts(classes, known);
                &own
            }
        };
        let law = self.cycle.at(distance);
        let tolerance = if parts.len() > 1 { RETRACTION_TOLERANCE } else { TOLERANCE };
        let of = |part: &Part, typical| {
            let (law, heights) = (part.cycle.as_deref().unwrap_or(self.cycle).at(distance), &part.of.heights);
            AtSeparation::of(&law, heights, self.closest, typical, accuracy(tolerance, heights, parts.len()))
        };
        Mixture::new(&law, self.surface.heights.mean - self.closest, parts, |part| &part.of, of)
    }
}

impl Forces {
    /// An interpolant, which is made when it is first asked for.
    fn cell(&self, which: (u32, u64), new: impl FnOnce() -> Cell) -> Cell {
        let known = || self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let cell = known().get(&which).copied();
        // Not while the others wait: it takes all threads.
        cell.unwrap_or_else(|| {
            let cell = new();
            known().insert(which, cell);
            cell
        })
    }
}

impl Expectations {
    /// Integrates the retraction of a loop from the smallest of the separations h, m, rising, in the regimes
    /// of the law on approach.
    pub fn retraction(cycle: &Loop, surface: &Surface, separations: &[f64]) -> Self {
        RetractionModel::new(cycle, surface, separations[0]).answer(separations)
    }
}
