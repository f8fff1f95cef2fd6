//! The elastic contact of a summit whose outline is not a paraboloid, and its attraction before contact.
//!
//! # Formula
//! Lengths are in the units of the sphere of the apex, whose radius is ρ. The outline is
//!
//! f(r) = r²/2 + βr⁴ for r ≤ a₀, and f(a₀) + q(r² − a₀²)/2 beyond, q = ρ/R.
//!
//! A contact of the radius a = c cos θ, whose adhesive zone ends at c, has (Maugis 1992, by superposition)
//!
//! (λ/2)[c²A(θ) + 2βc⁴Q(θ) − πE(c)] + (4λ²/3) c B(θ) = 1,
//!
//! Δ = a² + (8/3)βa⁴ − (4λ/3) c sin θ, F̂_s = λc²(sin θ cos θ + θ), P̂ = a³ + (16/5)βa⁵,
//!
//! with A = sin θ cos θ − θ cos 2θ, B = θ sin θ + cos θ − 1, Q = θ(1 − (8/3)cos⁴θ) + sin θ cos θ (2cos²θ + 3)/3, and E(c) by
//! which the outline up to a₀, continued, is above that beyond. The left side rises with θ at every c, so that c is the
//! parameter of the states. By reciprocity ∂Δ/∂θ is the derivative of the left side by θ over −λθ. So along the
//! states dΔ/dc = ∂Δ/∂c + (∂/∂c)/λθ of the left side, and the stable states end where that is 0, or where a is.
//!
//! Before contact, with the stress μ and the work W of [`super::noncontact`] at the gap ε, and f(c) in the place of c²/2,
//! 2μf(c) + 2b̂μ²c = W, F̂_s = (π/2)μc², Δ = −[ζε + (4/3)μc].
//!
//! # Validity
//! Every λ for which the summit of its radius ρ is solved, β ≥ 0. Source: Maugis, J. Colloid Interface Sci. 150 (1992) 243, and
//! Sneddon, Int. J. Eng. Sci. 3 (1965) 47, for the outline.

use super::angle::{AngleTerms, angle_terms, quartic_term};
use super::block::BLOCK;
use super::curve::BranchCurve;
use super::noncontact::Noncontact;
use super::stats::SolverStats;
use crate::math::instruction_set::InstructionSet;
use crate::math::roots::{Sample, false_position, safe_newton};
use std::f64::consts::{FRAC_PI_2, PI};

/// Largest last Newton step, relative to the length over which the equations bend. What it leaves is of the order of its
/// square.
const LAST_STEP: f64 = 2e-9;
/// Largest last step of the angle, relative to its distance to 0 and to π/2.
const LAST_TURN: f64 = 1e-8;
/// Roundings of the sum of the magnitudes of terms below which a residual is noise.
const NOISE: f64 = 4.0 * f64::EPSILON;
/// Relative load beyond that of the apex which is rounding.
const ROUNDING: f64 = 4.0 * f64::EPSILON;
/// Newton steps of a block, at most, before the one along which outputs are corrected.
const STEPS: usize = 3;
/// Newton steps of a block before contact, likewise.
const STEPS_BEFORE: usize = 4;
/// States between the end of contact and the edge of the outline, and between that and the deepest, from which solves start.
const NODES: [usize; 2] = [6, 3];
/// States from which solves start, all of them.
const ALL_NODES: usize = NODES[0] + NODES[1] + 1;
/// λ below which the branch before contact does not fold.
const FIRST_FOLD: f64 = 0.88;
/// Number of gaps at which the slope of the branch before contact is computed, the least ε, and the ratio of two gaps. In 3000 random
/// summits all folds were between 0.05 and 2.5.
const LOOKS: usize = 56;
const LOOKED_AT: (f64, f64) = (0.02, 1.1);
/// Places on both sides of one, as its multiples.
const BESIDE: [f64; 2] = [1.0 - 1e-9, 1.0 + 1e-9];
/// Relative accuracy of a fold. Δ has no slope there.
const FOLD: f64 = 1e-10;
/// Relative Newton step after which the solve of a pressed zone ends, and its steps at most. From the start it takes five.
const LAST_ZONE_STEP: f64 = 1e-8;
const MOST_STEPS: usize = 60;
/// b̂ of [`super::noncontact`].
const B: f64 = 4.0 * (PI - 2.0) / (3.0 * PI);

/// The outline of a summit, in the units of the sphere of its apex.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Outline {
    /// λ of the apex.
    pub lambda: f64,
    /// β.
    pub quartic: f64,
    /// a₀.
    pub edge: f64,
    /// q.
    pub outside: f64,
}

/// A plastic contact on loading, in the units of any sphere. Its radius is the radius a₀ of the outline that remains.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pressed {
    /// λ in these units; 0 without adhesion.
    pub lambda: f64,
    /// Contact radius.
    pub radius: f64,
    /// Load without adhesion.
    pub load: f64,
    /// Radius ρ of the apex, and R of the paraboloid beyond, over that of the units.
    pub apex: f64,
    /// R over the radius of the units.
    pub sphere: f64,
}

impl Pressed {
    /// βa₀² of the outline, 0 where the paraboloid of ρ alone bears the load.
    fn quartic(&self) -> f64 {
        let Self { radius, load, apex, .. } = *self;
        let beyond = load / (radius * radius * radius) - 1.0 / apex;
        if beyond > ROUNDING / apex { 0.3125 * beyond } else { 0.0 }
    }

    /// a²/ρ + (8/3)βa⁴, the displacement without adhesion from the apex.
    pub fn indentation(&self) -> f64 {
        self.radius * self.radius * (1.0 / self.apex + 8.0 / 3.0 * self.quartic())
    }

    /// tan θ of the adhesive zone, searched for from `start`, or from its limits where that is not positive.
    pub fn zone(&self, start: f64) -> f64 {
        let Self { lambda, radius, apex, sphere, .. } = *self;
        if lambda == 0.0 {
            return 0.0;
        }
        let quartic = self.quartic();
        let profile = 0.5 * lambda * (radius * radius);
        let (of_square, of_fourth) = (profile / apex, 2.0 * profile * quartic);
        let beyond = 0.5 * PI * profile * (1.0 / apex - 1.0 / sphere);
        let beyond_fourth = PI * profile * quartic;
        let stress = 4.0 / 3.0 * lambda * lambda * radius;
        let mut tangent = start;
        if !(tangent > 0.0) {
            let limits = [libm::cbrt(0.75 / (of_square + 8.0 / 3.0 * of_fourth)), (2.0 / stress).sqrt()];
            let steep = (-1.0 / beyond).sqrt();
            tangent = limits[0].min(limits[1]);
            tangent = if steep < tangent { steep } else { tangent };
        }
        for _ in 0..MOST_STEPS {
            // Brackets are powers of τ at either end, so that steps are taken of logarithms.
            let angle = libm::atan(tangent);
            let AngleTerms { quadratic, linear, .. } = angle_terms(angle);
            let (square, cube) = (tangent * tangent, angle * angle * angle);
            let (whole, secant) = (1.0 + square, (1.0 + square).sqrt());
            let gap = cube * whole * (of_square * quadratic + of_fourth * whole * quartic_term(angle))
                - square * (beyond + beyond_fourth * (2.0 + square))
                + stress * linear * (angle * angle) * secant;
            let per_whole = tangent / whole;
            let slope = 2.0 * of_square * tangent * (per_whole + angle)
                + of_fourth * (square * (8.0 / 3.0 / whole + 4.0) + 4.0 * tangent * whole * angle)
                - 2.0 * tangent * (beyond + 2.0 * beyond_fourth * whole)
                + stress * (angle + per_whole - tangent / secant);
            // With a steep edge the gap first closes, then opens.
            let step = libm::log(gap) * gap / (tangent * slope);
            let step = if gap > 0.0 && slope > 0.0 { step.clamp(-2.0, 2.0) } else { -1.0 };
            tangent *= libm::exp(-step);
            if !(step.abs() > LAST_ZONE_STEP) {
                break;
            }
        }
        tangent
    }

    /// F̂_s of a zone.
    pub fn adhesion(&self, zone: f64) -> f64 {
        self.lambda * self.radius * self.radius * (zone + libm::atan(zone) * (1.0 + zone * zone))
    }

    /// The displacement by which adhesion draws the surfaces nearer.
    pub fn drawn(&self, zone: f64) -> f64 {
        4.0 / 3.0 * self.lambda * self.radius * zone
    }

    /// The outline that remains, in the units of the sphere of its apex.
    pub fn outline(&self) -> Outline {
        let Self { lambda, radius, apex, sphere, .. } = *self;
        let root = libm::cbrt(apex);
        let edge = radius / (root * root);
        Outline {
            lambda: lambda * root,
            quartic: self.quartic() * apex / (edge * edge),
            edge,
            outside: apex / sphere,
        }
    }
}

/// The edge of the adhesive zone less a₀, and the angle of a state.
#[derive(Clone, Copy, Debug, Default)]
struct Place {
    beyond: f64,
    angle: f64,
}

/// The equations of a contact and their derivatives at a place.
#[derive(Clone, Copy, Debug, Default)]
struct Known {
    /// The left side less 1, and its derivatives by θ and c.
    excess: f64,
    by_angle: f64,
    by_edge: f64,
    /// Δ, dΔ/dc along the states, and the sum of the magnitudes of its terms.
    displacement: f64,
    slope: f64,
    magnitude: f64,
    /// F̂_s, its derivatives by c and by θ.
    adhesion: f64,
    adhesion_by_edge: f64,
    adhesion_by_angle: f64,
    /// a, and its derivatives.
    radius: f64,
    cos: f64,
    radius_by_angle: f64,
}

/// The scaled response of a contact.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Response {
    /// F̂_s.
    pub adhesion: f64,
    /// a.
    pub radius: f64,
}

impl Known {
    /// The response a step of c and θ away.
    #[inline(always)]
    fn corrected(&self, [edge, angle]: [f64; 2]) -> Response {
        Response {
            adhesion: self.adhesion + self.adhesion_by_edge * edge + self.adhesion_by_angle * angle,
            radius: self.radius + self.cos * edge + self.radius_by_angle * angle,
        }
    }
}

/// A Newton step of both equations before contact, dΔ/dε along the states, and C − a₀.
#[derive(Clone, Copy, Debug)]
struct Balance {
    step: [f64; 2],
    slope: f64,
    beyond: f64,
}

/// The state at a gap before contact.
#[derive(Clone, Copy, Debug)]
struct Apart {
    displacement: f64,
    slope: f64,
    adhesion: f64,
    adhesion_slope: f64,
}

impl Outline {
    /// f(c) of an edge of the zone.
    fn height(&self, edge: f64) -> f64 {
        let within = edge.min(self.edge);
        let square = within * within;
        square * (0.5 + self.quartic * square) + 0.5 * self.outside * (edge * edge - square)
    }

    /// f'(c).
    fn rise(&self, edge: f64) -> f64 {
        if edge <= self.edge { edge + 4.0 * self.quartic * edge * edge * edge } else { self.outside * edge }
    }

    /// Δ of a contact of the radius a without adhesion.
    #[inline(always)]
    pub fn indentation(&self, radius: f64) -> f64 {
        let square = radius * radius;
        square * (1.0 + 8.0 / 3.0 * self.quartic * square)
    }

    /// a of a contact of the displacement Δ > 0 without adhesion.
    pub fn radius_at(&self, displacement: f64) -> f64 {
        let root = (1.0 + 32.0 / 3.0 * self.quartic * displacement).sqrt();
        (2.0 * displacement / (1.0 + root)).sqrt()
    }

    /// P̂ of a contact of the radius a.
    #[inline(always)]
    pub fn load(&self, radius: f64) -> f64 {
        let square = radius * radius;
        square * radius * (1.0 + 3.2 * self.quartic * square)
    }

    /// The equations at a place; `outer` is 1 where the zone ends beyond a₀, and else 0.
    #[inline(always)]
    fn at(&self, place: Place, outer: f64) -> Known {
        let Self { lambda, quartic, edge, outside } = *self;
        let Place { beyond, angle } = place;
        let AngleTerms { sin, cos, quadratic, linear } = angle_terms(angle);
        let c = edge + beyond;
        let square = c * c;
        let cube = angle * angle * angle;
        let (of_square, of_fourth) = (quadratic * cube, quartic_term(angle) * cube);
        let of_stress = linear * (angle * angle);
        let above = outer * beyond * (c + edge) * (0.5 * (1.0 - outside) + quartic * (square + edge * edge));
        let above_slope = outer * c * ((1.0 - outside) + 4.0 * quartic * square);
        let fourth = 2.0 * quartic * square;
        let k = 4.0 / 3.0 * lambda;
        let profile = square * (of_square + fourth * of_fourth);
        let stress = lambda * k * c * of_stress;
        let radius = c * cos;
        let bend = sin * (2.0 * square + 16.0 / 3.0 * fourth * square * (cos * cos)) + k * c;
        let by_angle = lambda * angle * cos * bend;
        let by_edge =
            lambda * (c * (of_square + 2.0 * fourth * of_fourth) - 0.5 * PI * above_slope + k * of_stress);
        let indentation = self.indentation(radius);
        let pull = k * c * sin;
        let indentation_slope = radius * (2.0 + 32.0 / 3.0 * quartic * (radius * radius));
        let zone = sin * cos + angle;
        Known {
            excess: 0.5 * lambda * (profile - PI * above) + stress - 1.0,
            by_angle,
            by_edge,
            displacement: indentation - pull,
            slope: indentation_slope * cos - k * sin + by_edge / (lambda * angle),
            magnitude: indentation + pull,
            adhesion: lambda * square * zone,
            adhesion_by_edge: 2.0 * lambda * c * zone,
            adhesion_by_angle: 2.0 * lambda * square * (cos * cos),
            radius,
            cos,
            radius_by_angle: -c * sin,
        }
    }

    /// 1 if the distance `beyond` a₀ of the end of the zone is positive, and else 0.
    fn side(beyond: f64) -> f64 {
        if beyond > 0.0 { 1.0 } else { 0.0 }
    }

    /// The least θ of a contact whose zone ends `beyond` a₀: its radius is a₀ there.
    fn least_angle(&self, beyond: f64) -> f64 {
        if beyond <= 0.0 {
            return 0.0;
        }
        libm::atan((beyond * (2.0 * self.edge + beyond)).sqrt() / self.edge)
    }

    /// The state whose zone ends `beyond` a₀, searched for from an angle.
    fn state(&self, beyond: f64, outer: f64, start: f64) -> (Place, Known) {
        let mut angle = start;
        // Newton's method first, as most starts are near.
        for _ in 0..8 {
            let known = self.at(Place { beyond, angle }, outer);
            let step = -known.excess / known.by_angle;
            let room = angle.min(FRAC_PI_2 - angle);
            if step.abs() <= 1e-6 * room {
                let place = Place { beyond, angle: angle + step };
                return (place, self.at(place, outer));
            }
            angle += step;
            if !(angle > 0.0 && angle < FRAC_PI_2) {
                break;
            }
        }
        let falling = |angle: f64| {
            let known = self.at(Place { beyond, angle }, outer);
            Sample { value: -known.excess, slope: -known.by_angle }
        };
        let low = 0.999 * self.least_angle(beyond);
        let close = |_: f64, sample: Sample| sample.value.abs() <= 2.0 * f64::EPSILON;
        let place = Place { beyond, angle: safe_newton(falling, low, FRAC_PI_2, start, close).x };
        (place, self.at(place, outer))
    }

    /// Where the zone of first touch ends: λ(π/2)f(c) + (4λ²/3)(π/2 − 1)c = 1.
    fn first_touch(&self) -> f64 {
        let (height, linear) =
            (FRAC_PI_2 * self.lambda, 4.0 / 3.0 * self.lambda * self.lambda * (FRAC_PI_2 - 1.0));
        // The zone of the sphere of the apex ends further out if the outline is steeper.
        let mut high = 2.0 / (linear + (linear * linear + 2.0 * height).sqrt());
        let excess = |c: f64| height * self.height(c) + linear * c - 1.0;
        while excess(high) < 0.0 {
            high *= 2.0;
        }
        let falling = |c: f64| Sample { value: -excess(c), slope: -(height * self.rise(c) + linear) };
        let close = |_: f64, sample: Sample| sample.value.abs() <= f64::EPSILON;
        let c = safe_newton(falling, 0.0, high, high, close).x;
        c - excess(c) / (height * self.rise(c) + linear)
    }

    /// The state at a gap ε > 0 before contact.
    #[inline(always)]
    fn apart(&self, gap: f64) -> Apart {
        let Self { lambda, quartic, edge, outside } = *self;
        let whole = Noncontact::whole(lambda);
        let [stress, stress_slope, work, work_slope] = whole.terms(gap);
        let root = stress.sqrt();
        let g = B * stress * root;
        let g_slope = 1.5 * B * root * stress_slope;
        let lower = edge * edge * (0.5 * (outside - 1.0) - quartic * (edge * edge));
        let own = work + 2.0 * stress * lower;
        let outer = own / (g + (g * g + outside * own).sqrt());
        let inner = work / (g + (g * g + work).sqrt());
        let per_stress = 2.0 * quartic / stress;
        // The left side is convex beyond its root, so that Newton steps come from above.
        let mut y = inner.min((work / per_stress).sqrt().sqrt());
        for _ in 0..6 {
            let square = y * y;
            let excess = square + 2.0 * g * y + per_stress * (square * square) - work;
            y -= excess / (2.0 * y + 2.0 * g + 4.0 * per_stress * (square * y));
        }
        let is_outer = outer >= root * edge;
        let fourth = per_stress * (y * y) * (y * y);
        let outer_slope = (work_slope + 2.0 * stress_slope * lower - 2.0 * g_slope * outer)
            / (2.0 * outside * outer + 2.0 * g);
        let inner_slope = (work_slope - 2.0 * g_slope * y + fourth * stress_slope / stress)
            / (2.0 * y + 2.0 * g + 4.0 * fourth / y);
        let (y, y_slope) = if is_outer { (outer, outer_slope) } else { (y, inner_slope) };
        let pull = 4.0 / 3.0 * root * y;
        let pull_slope = 4.0 / 3.0 * (root * y_slope + stress_slope * y / (2.0 * root));
        let spacing = whole.spacing();
        Apart {
            displacement: -(spacing * gap + pull),
            slope: -(spacing + pull_slope),
            adhesion: FRAC_PI_2 * y * y,
            adhesion_slope: PI * y * y_slope,
        }
    }

    /// Approximate gap and √μ c before contact, from the gap of a rigid summit and the least possible gap.
    #[inline(always)]
    fn first_balance(&self, gap: f64, low: f64) -> (f64, f64) {
        let Self { lambda, quartic, edge, outside } = *self;
        let [stress, _, work, _] = Noncontact::whole(lambda).terms(gap);
        let root = stress.sqrt();
        let g = B * stress * root;
        let lower = edge * edge * (0.5 * (outside - 1.0) - quartic * (edge * edge));
        let own = work + 2.0 * stress * lower;
        let outer = own / (g + (g * g + outside * own).sqrt());
        let inner = work / (g + (g * g + work).sqrt());
        let limit = (0.5 * work * stress / quartic).sqrt().sqrt();
        let y = if outer >= root * edge { outer } else { inner.min(limit).min(root * edge) };
        let nearer = gap - 4.0 / 3.0 * root * y / Noncontact::whole(lambda).spacing();
        (if nearer > 0.7 * gap + 0.3 * low { nearer } else { gap }, y)
    }

    /// Both equations before contact at ε and y = √μ c.
    #[inline(always)]
    fn balance(&self, gap: f64, y: f64, displacement: f64) -> Balance {
        let Self { lambda, quartic, edge, outside } = *self;
        let whole = Noncontact::whole(lambda);
        let [stress, stress_slope, work, work_slope] = whole.terms(gap);
        let root = stress.sqrt();
        let (g, g_slope) = (B * stress * root, 1.5 * B * root * stress_slope);
        let per_stress = 1.0 / stress;
        let beyond = y * (root * per_stress) - edge;
        let (square, is_outer) = (y * y, beyond > 0.0);
        let lower = edge * edge * (0.5 * (outside - 1.0) - quartic * (edge * edge));
        let lower = if is_outer { 2.0 * lower } else { 0.0 };
        let curved = if is_outer { outside } else { 1.0 };
        let steep = if is_outer { 0.0 } else { 2.0 * quartic * per_stress };
        let (fourth, fourth_slope) = (steep * (square * square), 4.0 * steep * (square * y));
        // y² + 2Gy + (2β/μ)y⁴ = W, or that of the paraboloid beyond.
        let excess = curved * square + 2.0 * g * y + fourth - work - stress * lower;
        let by_pull = 2.0 * curved * y + 2.0 * g + fourth_slope;
        let by_gap =
            2.0 * g_slope * y - fourth * stress_slope * per_stress - work_slope - stress_slope * lower;
        let spacing = whole.spacing();
        let off = displacement + spacing * gap + 4.0 / 3.0 * root * y;
        let pull_by_gap = spacing + 2.0 / 3.0 * y * stress_slope * (root * per_stress);
        let per_pull = 1.0 / by_pull;
        let pull_by_pull = 4.0 / 3.0 * root;
        let slope = -pull_by_gap + pull_by_pull * by_gap * per_pull;
        let gap_step = (off - pull_by_pull * excess * per_pull) / slope;
        Balance { step: [gap_step, -(excess + by_gap * gap_step) * per_pull], slope, beyond }
    }

    /// ε of a rigid summit at Δ, the widest gap.
    fn rigid(&self, displacement: f64) -> f64 {
        -displacement / Noncontact::whole(self.lambda).spacing()
    }

    /// ε at Δ between two gaps, of which the first has the larger Δ.
    fn gap_between(&self, displacement: f64, (low, high): (f64, f64), start: f64) -> f64 {
        let falling = |gap: f64| {
            let state = self.apart(gap);
            Sample { value: state.displacement - displacement, slope: state.slope }
        };
        let close = |_: f64, sample: Sample| sample.value.abs() <= f64::EPSILON * displacement.abs();
        safe_newton(falling, low, high, start, close).x
    }
}

/// A fold of the branch before contact: ε, and Δ.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Fold {
    /// ε.
    pub gap: f64,
    /// Δ.
    pub displacement: f64,
}

/// The ends and kinks of the branches of a summit, by Δ.
#[derive(Clone, Copy, Debug, Default)]
pub struct Ends {
    /// Δ at first touch, the end of the branch before contact.
    pub first_touch: f64,
    /// Δ at the end of the stable contact branch.
    pub contact: f64,
    /// Whether contact leads to the innermost state before it without a jump.
    is_led_to: bool,
    /// Δ at which the zone ends at a₀; −∞ if there is no such contact.
    pub edge: f64,
    /// Δ at the deepest.
    pub deepest: f64,
    /// The folds to which the outermost state before contact lasts, as Δ rises: at most two.
    pub outer: [Option<Fold>; 2],
    /// The fold to which an asperity that comes out of contact stays on the innermost state.
    pub inner: Option<Fold>,
    /// Δ at which the zone ends at a₀ before contact.
    pub edges_before: [Option<f64>; 2],
}

/// States from which solves of contacts start.
#[derive(Clone, Copy, Debug, Default)]
struct Starts {
    /// √(Δ − Δ_end), rising; unused ones repeat the last.
    roots: [f64; ALL_NODES],
    /// c − a₀, θ, and their derivatives by that root.
    places: [[f64; 4]; ALL_NODES],
}

/// A summit of a known outline, with the ends of its branches and starting points of solves.
#[derive(Clone, Copy, Debug, Default)]
pub struct OutlinedSummit {
    /// The outline.
    pub outline: Outline,
    /// The ends of its states.
    pub ends: Ends,
    starts: Starts,
    /// The places of the end of contact and of the deepest.
    end: Place,
    last: Place,
}

impl OutlinedSummit {
    /// The summit of an outline whose contact of the radius a₀ has the zone of tan θ = `zone`.
    pub fn new(outline: Outline, zone: f64) -> Self {
        let mut summit = Self { outline, ..Self::default() };
        let secant = (1.0 + zone * zone).sqrt();
        summit.last =
            Place { beyond: outline.edge * (zone * zone / (1.0 + secant)), angle: libm::atan(zone) };
        let touch = outline.first_touch();
        summit.ends.first_touch = -4.0 / 3.0 * outline.lambda * touch;
        summit.ends.deepest = outline.at(summit.last, Outline::side(summit.last.beyond)).displacement;
        summit.find_end(touch - outline.edge);
        summit.find_starts();
        summit.find_before();
        summit
    }

    /// Visits its numbers, in an order that depends on its kind alone. The error of a number is relative to the number and to the
    /// unit that is visited with it; starting points of solves have no unit.
    pub(super) fn each(&mut self, mut visit: impl FnMut(&mut f64, Option<f64>)) {
        let Self { outline, ends, starts, end, last } = self;
        let unit = Some(1.0);
        visit(&mut outline.quartic, Some(1.0 / (outline.edge * outline.edge)));
        visit(&mut outline.edge, Some(0.0));
        visit(&mut ends.first_touch, unit);
        visit(&mut ends.contact, unit);
        visit(&mut ends.deepest, unit);
        if ends.edge.is_finite() {
            visit(&mut ends.edge, unit);
        }
        for fold in ends.outer.iter_mut().chain([&mut ends.inner]).flatten() {
            // ε is the starting point of single solves.
            visit(&mut fold.gap, None);
            visit(&mut fold.displacement, unit);
        }
        ends.edges_before.iter_mut().flatten().for_each(|place| visit(place, unit));
        for place in [end, last] {
            visit(&mut place.beyond, unit);
            visit(&mut place.angle, unit);
        }
        starts.roots.iter_mut().for_each(|root| visit(root, None));
        starts.places.iter_mut().flatten().for_each(|value| visit(value, None));
    }

    /// Which optional numbers it has, as bits.
    pub(super) fn kind(&self) -> u64 {
        let Ends { edge, outer, inner, edges_before, is_led_to, .. } = &self.ends;
        let has = [
            edge.is_finite(),
            outer[0].is_some(),
            outer[1].is_some(),
            inner.is_some(),
            edges_before[0].is_some(),
            edges_before[1].is_some(),
            *is_led_to,
            self.end.beyond > 0.0,
            self.end.beyond < 0.0,
            self.ends.contact < self.ends.deepest,
        ];
        has.iter().fold(0, |bits, has| 2 * bits + u64::from(*has))
    }

    /// Finds the end of the stable branch in contact, from the deepest state on.
    fn find_end(&mut self, touch: f64) {
        let Self { outline, last, .. } = *self;
        let first = Place { beyond: touch, angle: FRAC_PI_2 };
        let slope = |place: Place, outer: f64| outline.at(place, outer).slope;
        self.ends.edge = f64::NEG_INFINITY;
        let begin = if touch > 0.0 { first } else { outline.state(0.0, 1.0, last.angle).0 };
        // Beyond the edge of the outline.
        if slope(last, 1.0) <= 0.0 || last.beyond <= begin.beyond {
            (self.end, self.ends.contact) = (last, self.ends.deepest);
            return;
        }
        if slope(begin, 1.0) < 0.0 {
            self.end = self.fold((begin, last), 1.0);
        } else if touch > 0.0 {
            self.end = first;
        } else {
            self.ends.edge = outline.at(begin, 0.0).displacement;
            self.end = begin;
            // And within it.
            if slope(begin, 0.0) > 0.0 {
                self.end = if slope(first, 0.0) < 0.0 { self.fold((first, begin), 0.0) } else { first };
            }
        }
        self.ends.is_led_to = self.end.angle == FRAC_PI_2;
        let outer = Outline::side(self.end.beyond);
        self.ends.contact = outline.at(self.end, outer).displacement;
        if self.ends.is_led_to {
            self.ends.contact = self.ends.first_touch;
        }
    }

    /// The fold between two places, of which the first is unstable.
    fn fold(&self, (low, high): (Place, Place), outer: f64) -> Place {
        let outline = &self.outline;
        let slope = |place: Place| (place.beyond, outline.at(place, outer).slope);
        let mut place = high;
        let at = |beyond: f64| {
            let known;
            (place, known) = outline.state(beyond, outer, place.angle);
            known.slope / known.magnitude
        };
        let per_edge = FOLD / (outline.edge + high.beyond);
        false_position(at, slope(low), slope(high), |_, slope| slope.abs() <= per_edge);
        place
    }

    /// Finds states from which solves start.
    fn find_starts(&mut self) {
        let Self { outline, end, last, .. } = *self;
        let mut count = 0;
        let mut angle = last.angle;
        let runs = if self.ends.edge == f64::NEG_INFINITY || end.beyond >= 0.0 {
            [(last.beyond, end.beyond, 1.0, NODES[0]), (end.beyond, end.beyond, 1.0, 0)]
        } else {
            [(last.beyond, 0.0, 1.0, NODES[1]), (0.0, end.beyond, 0.0, NODES[0])]
        };
        let mut nodes = [(0.0, [0.0; 4]); ALL_NODES];
        let has_slope = self.ends.is_led_to;
        for (run, (from, to, outer, parts)) in runs.into_iter().enumerate() {
            for part in 0..parts {
                if run == 0 && part == 0 {
                    nodes[count] = self.node(last, &outline.at(last, outer));
                } else {
                    let share = part as f64 / parts as f64;
                    // Δ begins like a square at a fold, and else in proportion.
                    let share = if has_slope { share * (2.0 - share) } else { share };
                    let beyond = from + (to - from) * share;
                    let (place, known) = outline.state(beyond, outer, angle);
                    angle = place.angle;
                    nodes[count] = self.node(place, &known);
                }
                count += 1;
            }
        }
        nodes[count] = self.last_node(end);
        count += 1;
        for i in 0..ALL_NODES {
            let (root, place) = nodes[count - 1 - i.min(count - 1)];
            (self.starts.roots[i], self.starts.places[i]) = (root, place);
        }
    }

    /// A state as a start.
    fn node(&self, place: Place, known: &Known) -> (f64, [f64; 4]) {
        let root = (known.displacement - self.ends.contact).max(0.0).sqrt();
        let per_root = 2.0 * root / known.slope;
        let turn = -known.by_edge / known.by_angle * per_root;
        (root, [place.beyond, place.angle, per_root, turn])
    }

    /// The end of contact as a start: a fold, or where the radius vanishes like a root.
    fn last_node(&self, place: Place) -> (f64, [f64; 4]) {
        let Self { outline, .. } = *self;
        let outer = Outline::side(place.beyond);
        let known = outline.at(place, outer);
        if self.ends.is_led_to {
            let c = outline.edge + place.beyond;
            let bend = outline.lambda * FRAC_PI_2 * c * (2.0 * c + 4.0 / 3.0 * outline.lambda);
            let turn = (2.0 * known.by_edge / (known.slope * bend)).max(0.0).sqrt();
            return (0.0, [place.beyond, place.angle, 0.0, -turn]);
        }
        // The slope by c rises from 0: its rate is that of a short step.
        let step = 1e-4 * (self.last.beyond - place.beyond).max(f64::MIN_POSITIVE);
        let (_, next) = outline.state(place.beyond + step, outer, place.angle);
        let per_root = (2.0 * step / next.slope).max(0.0).sqrt();
        let kinked = known.slope > 1e-6 * known.magnitude / (outline.edge + place.beyond);
        let per_root = if kinked { 0.0 } else { per_root };
        (0.0, [place.beyond, place.angle, per_root, -known.by_edge / known.by_angle * per_root])
    }

    /// Finds the folds before contact, and where the zone ends at a₀ there.
    fn find_before(&mut self) {
        let outline = self.outline;
        let edges = self.edge_gaps();
        let touch = self.ends.first_touch.max(self.ends.contact);
        let place = |gap: f64| outline.apart(gap).displacement;
        self.ends.edges_before = edges.map(|gap| gap.map(place).filter(|place| *place < touch));
        if outline.lambda < FIRST_FOLD {
            return;
        }
        // Both sides of where the slope jumps, too.
        let mut gaps = [LOOKED_AT.0; LOOKS + 4];
        for i in 1..LOOKS {
            gaps[i] = gaps[i - 1] * LOOKED_AT.1;
        }
        let beside = |gap: Option<f64>| gap.map_or([LOOKED_AT.0; 2], |gap| BESIDE.map(|beside| gap * beside));
        gaps[LOOKS..].copy_from_slice(edges.map(beside).as_flattened());
        gaps.sort_unstable_by(f64::total_cmp);
        let mut slopes = [0.0; LOOKS + 4];
        InstructionSet::current().run(
            #[inline(always)]
            || slopes.iter_mut().zip(&gaps).for_each(|(slope, gap)| *slope = outline.apart(*gap).slope),
        );
        let mut highest = f64::NEG_INFINITY;
        let mut found = [None; 2];
        for i in (1..gaps.len()).rev() {
            let ends = [(gaps[i - 1], slopes[i - 1]), (gaps[i], slopes[i])];
            let [inner, outer] = ends.map(|(_, slope)| slope > 0.0);
            if inner && !outer && found[1].is_none() {
                let fold = self.fold_before(ends);
                if fold.displacement > highest {
                    let place = usize::from(found[0].is_some());
                    (found[place], highest) = (Some(fold), fold.displacement);
                }
            }
            if !inner && outer && self.ends.is_led_to {
                self.ends.inner = Some(self.fold_before(ends));
            }
        }
        self.ends.outer = found;
    }

    /// A fold between two gaps with their slopes.
    fn fold_before(&self, [low, high]: [(f64, f64); 2]) -> Fold {
        let least = FOLD * Noncontact::whole(self.outline.lambda).spacing();
        let slope = |gap: f64| self.outline.apart(gap).slope;
        let gap = false_position(slope, low, high, |_, slope| slope.abs() <= least);
        Fold { gap, displacement: self.outline.apart(gap).displacement }
    }

    /// ε at which the zone ends at a₀ before contact, the wider first.
    fn edge_gaps(&self) -> [Option<f64>; 2] {
        let outline = &self.outline;
        let height = outline.height(outline.edge);
        let whole = Noncontact::whole(outline.lambda);
        let within = |gap: f64| {
            let [stress, _, work, _] = whole.terms(gap);
            2.0 * stress * (height + B * stress * outline.edge) - work
        };
        // The stress over the work is largest a little beyond its own maximum.
        let most = 0.3;
        if within(most) <= 0.0 {
            return [None; 2];
        }
        let mut far = 1.0;
        while within(far) > 0.0 {
            far *= 2.0;
        }
        let place = |low: f64, high: f64| {
            let ends = [low, high].map(|gap| (gap, within(gap)));
            false_position(within, ends[0], ends[1], |_, value| value.abs() <= NOISE)
        };
        [Some(place(most, far)), Some(place(0.0, most))]
    }

    /// The response in contact at Δ, which is limited to the ends of the branch.
    pub fn contact(&self, displacement: f64, stats: &mut SolverStats) -> Response {
        let (outline, ends) = (&self.outline, &self.ends);
        stats.safeguarded += 1;
        if displacement >= ends.deepest {
            return outline.at(self.last, Outline::side(self.last.beyond)).corrected([0.0; 2]);
        }
        if displacement <= ends.contact {
            return outline.at(self.end, Outline::side(self.end.beyond)).corrected([0.0; 2]);
        }
        let outer = if displacement > ends.edge { 1.0 } else { 0.0 };
        let (mut low, mut high) = (self.end.beyond, self.last.beyond);
        (low, high) =
            if outer > 0.0 { (if ends.edge > ends.contact { 0.0 } else { low }, high) } else { (low, 0.0) };
        let Place { mut beyond, mut angle } = self.start(displacement);
        for _ in 0..100 {
            beyond = if beyond >= low && beyond <= high { beyond } else { 0.5 * (low + high) };
            let (place, known) = outline.state(beyond, outer, angle);
            stats.evaluations += 1;
            angle = place.angle;
            let [edge, turn] = step(&known, place, outline, displacement);
            *(if edge > 0.0 { &mut low } else { &mut high }) = beyond;
            let (c, room) = (outline.edge + beyond, angle.min(FRAC_PI_2 - angle));
            let is_small = edge.abs() <= LAST_STEP * c && turn.abs() <= LAST_TURN * room;
            if is_small || edge.abs() <= f64::EPSILON * c || !(low < high) {
                let off = (displacement - known.displacement).abs() / known.magnitude;
                stats.largest_residual = stats.largest_residual.max(off);
                return known.corrected(if is_small { [edge, turn] } else { [0.0; 2] });
            }
            beyond += edge;
        }
        outline.state(beyond, outer, angle).1.corrected([0.0; 2])
    }

    /// Where a solve for Δ starts.
    #[inline(always)]
    fn start(&self, displacement: f64) -> Place {
        let Starts { roots, places } = &self.starts;
        let root = (displacement - self.ends.contact).max(0.0).sqrt();
        let above: usize = roots[1..ALL_NODES - 1].iter().map(|own| usize::from(root > *own)).sum();
        let (width, [from, to]) = (roots[above + 1] - roots[above], [places[above], places[above + 1]]);
        let t = (root - roots[above]) / width;
        let t = if t > 0.0 { t.min(1.0) } else { 0.0 };
        let (rest, both) = (1.0 - t, t * (1.0 - t));
        let value = |i: usize| {
            let (a, b, da, db) = (from[i], to[i], from[i + 2] * width, to[i + 2] * width);
            let straight = b - a;
            rest * a + t * b + both * (rest * (da - straight) - t * (db - straight))
        };
        Place { beyond: value(0), angle: value(1) }
    }

    /// F̂_s before contact at Δ: of the outermost state, or with `stays` of the innermost state of an asperity that comes out of
    /// contact.
    pub fn attraction(&self, displacement: f64, stays: bool, stats: &mut SolverStats) -> f64 {
        let (outline, ends) = (&self.outline, &self.ends);
        stats.safeguarded += 1;
        let displacement = displacement.min(ends.first_touch);
        let rigid = outline.rigid(displacement);
        let held = ends.inner.filter(|inner| stays && displacement >= inner.displacement);
        let within = match (held, ends.outer) {
            (Some(inner), _) => (0.0, inner.gap),
            (_, [Some(first), _]) if displacement <= first.displacement => (first.gap, f64::INFINITY),
            (_, [Some(first), Some(second)]) if displacement <= second.displacement => {
                (second.gap, first.gap)
            }
            (_, [_, Some(second)]) => (0.0, second.gap),
            (_, [Some(first), None]) => (0.0, first.gap),
            _ => (0.0, f64::INFINITY),
        };
        let (low, high) = (within.0, within.1.min(rigid * (1.0 + NOISE)));
        let gap = outline.gap_between(displacement, (low, high), high);
        let state = outline.apart(gap);
        let step = (displacement - state.displacement) / state.slope;
        let small = step.abs() <= LAST_STEP * gap;
        state.adhesion + if small { state.adhesion_slope * step } else { 0.0 }
    }

    /// The interval of ε in which the outermost state at Δ is.
    #[inline(always)]
    fn outermost(&self, displacement: f64) -> (f64, f64) {
        match self.ends.outer {
            [None, _] => (0.0, f64::INFINITY),
            [Some(first), _] if displacement <= first.displacement => (first.gap, f64::INFINITY),
            [Some(first), _] => (0.0, first.gap),
        }
    }
}

/// F̂_s and a of summits in contact at displacements Δ, at most [`BLOCK`], which are limited to the ends of their branches.
pub fn contacts<'a>(
    of: impl Fn(usize) -> &'a OutlinedSummit,
    displacements: &[f64],
    adhesion: &mut [f64],
    radius: &mut [f64],
    stats: &mut SolverStats,
) {
    let mut lanes = Lanes::default();
    for (first, part) in displacements.chunks(TOGETHER).enumerate().map(|(i, part)| (i * TOGETHER, part)) {
        let good = InstructionSet::current().run(
            #[inline(always)]
            || lanes.contacts(|i| of(first + i), part),
        );
        stats.evaluations += (STEPS as u64 + 1) * part.len() as u64;
        for (i, displacement) in part.iter().enumerate() {
            let own = if good[i] {
                Response { adhesion: lanes.adhesion[i], radius: lanes.radius[i] }
            } else {
                of(first + i).contact(*displacement, stats)
            };
            (adhesion[first + i], radius[first + i]) = (own.adhesion, own.radius);
        }
    }
}

/// F̂_s of summits before contact at displacements Δ, at most [`BLOCK`], as [`OutlinedSummit::attraction`] has it.
pub fn attractions<'a>(
    of: impl Fn(usize) -> &'a OutlinedSummit,
    (displacements, stays): (&[f64], bool),
    adhesion: &mut [f64],
    stats: &mut SolverStats,
) {
    let mut lanes = Lanes::default();
    for (first, part) in displacements.chunks(TOGETHER).enumerate().map(|(i, part)| (i * TOGETHER, part)) {
        let good = InstructionSet::current().run(
            #[inline(always)]
            || lanes.attractions(|i| of(first + i), part, stays),
        );
        stats.evaluations += (STEPS_BEFORE as u64 + 1) * part.len() as u64;
        for (i, displacement) in part.iter().enumerate() {
            adhesion[first + i] = if good[i] {
                lanes.adhesion[i]
            } else {
                of(first + i).attraction(*displacement, stays, stats)
            };
        }
    }
}

/// Number of summits that are solved together.
const TOGETHER: usize = 32;
/// Lanes of the widest vectors.
const VECTOR: usize = 8;
const _: () = assert!(BLOCK.is_multiple_of(TOGETHER));

/// Summits of a part of a block, each quantity in a row.
#[repr(align(64))]
struct Lanes {
    lambda: [f64; TOGETHER],
    quartic: [f64; TOGETHER],
    edge: [f64; TOGETHER],
    outside: [f64; TOGETHER],
    displacements: [f64; TOGETHER],
    outer: [f64; TOGETHER],
    beyond: [f64; TOGETHER],
    angles: [f64; TOGETHER],
    low: [f64; TOGETHER],
    adhesion: [f64; TOGETHER],
    radius: [f64; TOGETHER],
    good: [bool; TOGETHER],
}

impl Default for Lanes {
    fn default() -> Self {
        let (ones, zeros) = ([1.0; TOGETHER], [0.0; TOGETHER]);
        Self {
            lambda: ones,
            quartic: zeros,
            edge: ones,
            outside: ones,
            displacements: zeros,
            outer: zeros,
            beyond: ones,
            angles: ones,
            low: zeros,
            adhesion: zeros,
            radius: zeros,
            good: [false; TOGETHER],
        }
    }
}

impl Lanes {
    /// Sets the outline of a lane.
    #[inline(always)]
    fn set(&mut self, i: usize, outline: &Outline) {
        let Outline { lambda, quartic, edge, outside } = *outline;
        (self.lambda[i], self.quartic[i], self.edge[i], self.outside[i]) = (lambda, quartic, edge, outside);
    }

    /// Repeats the last of `count` lanes up to whole vectors, and returns their number of lanes.
    #[inline(always)]
    fn pad(&mut self, count: usize) -> usize {
        // With a known limit the loops over lanes have no checks and use whole vectors.
        let (last, whole) = (count - 1, (count.div_ceil(VECTOR) * VECTOR).min(TOGETHER));
        for i in count..whole {
            self.lambda[i] = self.lambda[last];
            self.quartic[i] = self.quartic[last];
            self.edge[i] = self.edge[last];
            self.outside[i] = self.outside[last];
            self.displacements[i] = self.displacements[last];
            self.outer[i] = self.outer[last];
            self.beyond[i] = self.beyond[last];
            self.angles[i] = self.angles[last];
            self.low[i] = self.low[last];
        }
        whole
    }

    /// The outline of a lane.
    #[inline(always)]
    fn outline(&self, i: usize) -> Outline {
        Outline {
            lambda: self.lambda[i],
            quartic: self.quartic[i],
            edge: self.edge[i],
            outside: self.outside[i],
        }
    }

    /// Newton steps, and one along which the outputs are corrected; returns which lanes have converged.
    #[inline(always)]
    fn contacts<'a>(
        &mut self,
        of: impl Fn(usize) -> &'a OutlinedSummit,
        displacements: &[f64],
    ) -> [bool; TOGETHER] {
        for (i, displacement) in displacements.iter().enumerate() {
            let summit = of(i);
            self.set(i, &summit.outline);
            self.displacements[i] = displacement.max(summit.ends.contact).min(summit.ends.deepest);
            self.outer[i] = if self.displacements[i] > summit.ends.edge { 1.0 } else { 0.0 };
            Place { beyond: self.beyond[i], angle: self.angles[i] } = summit.start(self.displacements[i]);
        }
        let count = self.pad(displacements.len());
        for pass in 0..=STEPS {
            let mut are_good = true;
            for i in 0..count {
                let (outline, outer) = (self.outline(i), self.outer[i]);
                let place = Place { beyond: self.beyond[i], angle: self.angles[i] };
                let known = outline.at(place, outer);
                let [edge, angle] = step(&known, place, &outline, self.displacements[i]);
                let room = place.angle.min(FRAC_PI_2 - place.angle);
                let small = (edge.abs() <= LAST_STEP * (outline.edge + place.beyond))
                    & (angle.abs() <= LAST_TURN * room);
                let is_on_side = (place.beyond > 0.0) == (outer > 0.0);
                self.good[i] = small & is_on_side & (known.slope > 0.0) & (room > 0.0);
                are_good &= self.good[i];
                Response { adhesion: self.adhesion[i], radius: self.radius[i] } =
                    known.corrected([edge, angle]);
                self.beyond[i] += edge;
                // The contact radius vanishes at π/2.
                self.angles[i] = (place.angle + angle).min(FRAC_PI_2);
            }
            if are_good || pass == STEPS {
                break;
            }
        }
        self.good
    }

    /// Newton steps before contact, and one along which the outputs are corrected; returns which lanes have converged.
    #[inline(always)]
    fn attractions<'a>(
        &mut self,
        of: impl Fn(usize) -> &'a OutlinedSummit,
        displacements: &[f64],
        stays: bool,
    ) -> [bool; TOGETHER] {
        let mut can_be = [true; TOGETHER];
        for (i, displacement) in displacements.iter().enumerate() {
            let summit = of(i);
            self.set(i, &summit.outline);
            self.displacements[i] = *displacement;
            let high;
            (self.low[i], high) = summit.outermost(*displacement);
            self.beyond[i] = summit.outline.rigid(*displacement);
            can_be[i] = (high == f64::INFINITY)
                & !(stays & summit.ends.inner.is_some_and(|inner| *displacement >= inner.displacement));
        }
        let count = self.pad(displacements.len());
        for i in 0..count {
            (self.beyond[i], self.angles[i]) = self.outline(i).first_balance(self.beyond[i], self.low[i]);
        }
        for pass in 0..=STEPS_BEFORE {
            let mut are_good = true;
            for i in 0..count {
                let (gap, y, low) = (self.beyond[i], self.angles[i], self.low[i]);
                let Balance { step, slope, beyond } = self.outline(i).balance(gap, y, self.displacements[i]);
                let small =
                    (step[0].abs() <= LAST_STEP * (gap - low).min(gap)) & (step[1].abs() <= LAST_STEP * y);
                let is_on_side = beyond.abs() > 4.0 * LAST_STEP * self.edge[i];
                self.good[i] = small & is_on_side & (slope < 0.0);
                are_good &= self.good[i];
                self.adhesion[i] = FRAC_PI_2 * y * (y + 2.0 * step[1]);
                let next = gap + step[0];
                let kept = next > low;
                self.beyond[i] = if kept { next } else { 0.5 * (low + gap) };
                let pull = y + if kept { step[1] } else { 0.0 };
                self.angles[i] = if pull > 0.0 { pull } else { 0.5 * y };
            }
            if are_good || pass == STEPS_BEFORE {
                break;
            }
        }
        self.good.iter_mut().zip(can_be).for_each(|(good, can_be)| *good &= can_be);
        self.good
    }
}

/// The Newton step of both equations.
#[inline(always)]
fn step(known: &Known, place: Place, outline: &Outline, displacement: f64) -> [f64; 2] {
    let off = displacement - known.displacement - known.excess / (outline.lambda * place.angle);
    let edge = off / known.slope;
    [edge, -(known.excess + known.by_edge * edge) / known.by_angle]
}
