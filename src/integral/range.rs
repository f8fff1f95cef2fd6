//! The range of separations that follows from the summits of a surface.

use crate::asperity::scale::{Asperity, Scale};
use crate::asperity::{Facing, Law, LawParameters, Path, Scratch, SolverStats, model};
use crate::math::interpolation::linear;
use crate::surface::{Heights, Surface};
use std::f64::consts::PI;

/// Largest radius of a contact over that of its asperity.
pub(crate) const LARGEST_CONTACT: f64 = 0.3;
/// Heights that are called the highest asperities, in σ_s.
pub(crate) const HIGHEST: f64 = 3.0;
/// Largest fraction of the nominal area in contact.
pub(crate) const LARGEST_SHARE: f64 = 0.1;
/// Equilibrium spacings from a summit where it pulls with 1 % of its largest pull: (Z₀/(Z₀ + gap))² there.
const REACH: f64 = 9.0;
/// Interference, in units of approach and equilibrium spacings, that a summit passes after its pull-off.
const PAST: f64 = 4.0;
/// The probability that a replica has a summit that touches at the furthest of them.
const TOUCHING: f64 = 1e-3;
/// Ends of the range are whole multiples of 1 over this in h*, so that a few digits give their bits.
const STEPS_OF_ENDS: f64 = 10.0;
/// Steps of the ends over which the force has to fall from the nearest separation on, so that the pull-off lies within.
const STEPS_TO_PULL_OFF: f64 = 6.0;
/// Heights that stand for the law of heights, at equal probabilities.
const HEIGHTS: u32 = 2000;
/// Mean load of the closest separation over the largest preload, less its standard deviations.
const MARGIN_OF_LOADS: f64 = 1.5;
/// Standard deviations by which the load of a patch may be below the mean.
const DEVIATIONS_OF_LOADS: f64 = 3.0;

/// Halvings of the deepest contact that a law is solved at, and steps of each, for loads between them.
const HALVINGS: i32 = 20;
const STEPS_OF_HALVING: i32 = 4;

/// The summits of a surface whose separations follow from them.
pub(crate) struct Summits<'a> {
    pub asperity: &'a Asperity,
    pub surface: &'a Surface,
    /// The range of a liquid, m.
    pub liquid: f64,
    /// The largest preload, N; 0 without any.
    pub preload: f64,
    /// The plastic contact of `md_plastic`, where there is a preload to reach.
    pub flow: Option<&'a dyn Law>,
}

/// A sum over the summits of a patch, and the standard deviations, of summits at random, that the mean is above it.
struct Wanted {
    sum: f64,
    deviations: f64,
}

impl Summits<'_> {
    /// The nearest and the furthest separation, m: from where a tenth of the nominal area touches, closer where soft summits are
    /// pulled off only there, or from where the largest preload is reached, to where the tallest summit of a thousand replicas
    /// pulls no longer.
    pub fn range(&self) -> (f64, f64) {
        let (surface, sigma) = (self.surface, self.surface.surface_height_std);
        let normal = Heights::gaussian(1.0);
        let heights = surface.heights.strata(HEIGHTS);
        let tallest = -normal.gaussian_quantile(TOUCHING / surface.asperity_count as f64);
        let furthest = surface.heights.of_normal(tallest)
            + self.asperity.lubricant_thickness
            + self.liquid
            + REACH * self.asperity.equilibrium_spacing;
        let touching = Wanted { sum: LARGEST_SHARE * surface.loaded_area(), deviations: 0.0 };
        let touching =
            self.closest(&heights, furthest, touching, &|depth| PI * surface.asperity_radius * depth);
        // The highest summits keep contacts that are small against their radius, also in a patch without tall ones.
        let shortest = normal.gaussian_quantile(libm::pow(TOUCHING, 1.0 / surface.asperity_count as f64));
        let highest = surface.heights.of_normal(shortest.min(HIGHEST));
        let small = highest - LARGEST_CONTACT * LARGEST_CONTACT * surface.asperity_radius;
        let h = |steps: f64| steps / STEPS_OF_ENDS * sigma;
        let end = |d: f64| (d + surface.mean_plane_offset) / sigma * STEPS_OF_ENDS;
        let from = match self.preload > 0.0 {
            true => {
                let of_law = self.loads(heights[heights.len() - 1] - heights[0] + surface.asperity_radius);
                let wanted = Wanted { sum: MARGIN_OF_LOADS * self.preload, deviations: DEVIATIONS_OF_LOADS };
                end(self.closest(&heights, furthest, wanted, &|depth| self.load(depth, &of_law))).floor()
            }
            // Patches without tall summits come nearer than the mean.
            false if surface.heights.depths().is_some() => end(highest - self.pulled()).floor(),
            false => {
                let law = self.elastic();
                let force = |steps: f64| {
                    let separation = surface.asperity_separation(h(steps));
                    law.as_deref().map_or(0.0, |law| force(Facing { law, heights: &heights, separation }))
                };
                let least = end(small).ceil();
                let mut from = end(touching).floor().max(least);
                // Soft summits are pulled off where more of them touch.
                while from > least && force(from) < force(from + STEPS_TO_PULL_OFF) {
                    from -= 1.0;
                }
                from
            }
        };
        (h(from), h(end(furthest).ceil()))
    }

    /// Maugis's law of these summits, if they are within its reach: soft ones do not yield before their pull-off.
    fn elastic(&self) -> Option<Box<dyn Law>> {
        let parameters = LawParameters::new(self.asperity, Path::Approach, (0.0, 0.0)).ok()?;
        model("md")?.law(&LawParameters { table_range: None, ..parameters }).ok()
    }

    /// An interference, m, that a summit passes after its pull-off.
    fn pulled(&self) -> f64 {
        let length = Scale::new(self.asperity).map_or(0.0, |scale| scale.length);
        PAST * (length + self.asperity.equilibrium_spacing)
    }

    /// The separation d, m, at which summits of `heights`, m, that overlap by a depth have enough of what a depth gives.
    fn closest(&self, heights: &[f64], furthest: f64, wanted: Wanted, of: &dyn Fn(f64) -> f64) -> f64 {
        let share = self.surface.asperity_count as f64 / heights.len() as f64;
        let lacks = |d: f64| {
            let depths = heights.iter().map(|height| height - d).filter(|depth| *depth > 0.0);
            let [sum, squares] = depths.map(of).fold([0.0; 2], |[a, b], own| [a + own, b + own * own]);
            share * sum - wanted.deviations * (share * squares).sqrt() < wanted.sum
        };
        // A depth of all the radius is beyond every law.
        let (mut near, mut far) = (heights[0] - self.surface.asperity_radius, furthest);
        while far - near > 1e-3 * self.surface.heights.std && near < 0.5 * (near + far) {
            let middle = 0.5 * (near + far);
            if lacks(middle) { far = middle } else { near = middle }
        }
        near
    }

    /// The least load, N, of a contact of a depth, m: Hertz's or that of its hardness, less its adhesion, or that of
    /// a plastic contact, of which flatter summits pull more.
    fn load(&self, depth: f64, [depths, loads]: &[Vec<f64>; 2]) -> f64 {
        let Asperity { reduced_modulus, hardness, radius, work_of_adhesion, .. } = *self.asperity;
        let elastic = 4.0 / 3.0 * reduced_modulus * radius.sqrt() * depth * depth.sqrt();
        let least = elastic.min(PI * radius * depth * hardness) - 2.0 * PI * radius * work_of_adhesion;
        if depths.is_empty() { least } else { least.min(linear(depths, loads, depth)) }
    }

    /// Depths, m, rising to the deepest contact, and the loads, N, of the plastic contact there less 2πR₁Δγ of its summit, of
    /// the radius of curvature R₁ = 4E*a³/(3P).
    fn loads(&self, deepest: f64) -> [Vec<f64>; 2] {
        let Some(law) = self.flow else { return Default::default() };
        let steps = (0..=HALVINGS * STEPS_OF_HALVING).rev();
        let depths: Vec<f64> =
            steps.map(|k| deepest * libm::exp2(-f64::from(k) / f64::from(STEPS_OF_HALVING))).collect();
        let mut loads = vec![0.0; depths.len()];
        let facing = Facing { law, heights: &depths, separation: 0.0 };
        let Asperity { reduced_modulus, work_of_adhesion, .. } = *self.asperity;
        facing.for_each_block(&mut Scratch::default(), &mut SolverStats::default(), |_, block, responses| {
            for (load, (pressed, area)) in
                loads[block].iter_mut().zip(responses.contact.iter().zip(responses.area))
            {
                let own = (area / PI).sqrt();
                let radius = 4.0 * reduced_modulus * own * own * own / (3.0 * pressed);
                *load = pressed - 2.0 * PI * radius * work_of_adhesion;
            }
        });
        [depths, loads]
    }
}

/// The force, N, on summits, pressure positive.
fn force(summits: Facing<'_>) -> f64 {
    let mut force = 0.0;
    summits.for_each_block(&mut Scratch::default(), &mut SolverStats::default(), |_, block, own| {
        let forces = own.contact.iter().zip(&own.adhesion).take(block.len());
        force += forces.map(|(pressed, pulled)| pressed - pulled).sum::<f64>();
    });
    force
}
