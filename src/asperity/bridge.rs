//! A bridge of liquid around a sphere on a flat, under the constant tension of the liquid, before contact and in it.
//!
//! # Formula
//! The tension σ₀ acts within the wetted circle of radius c and outside of the contact, a = c cos φ. At its edge the liquid
//! ends: there the gap is h₀ − κ/c. The term with κ = J r_K² is that of the meniscus around the circle, whose line has the
//! energy σ₀κ per length; without it this is Dugdale's zone. With β = 4σ₀/(πE*) the gap at the edge of a contact, its
//! interference and its force are, by Maugis:
//!
//! h₀ − κ/c = c²(sin φ cos φ − φ cos 2φ)/(πR) + βc(φ sin φ + cos φ − 1), δ = a²/R − (π/2)βc sin φ,
//! F_s = 2σ₀c²(φ + sin φ cos φ).
//!
//! Before contact φ = π/2, and the distance of the undeformed sphere from the flat and the gap in the middle are
//!
//! D = h₀ − κ/c − c²/2R + βc, g = D − (π/2)βc, F_s = πσ₀c².
//!
//! D(c) is largest at the spinodal, c³ − βRc² − κR = 0. The energy U(c) at a given D, 0 without a bridge, is 0 where it
//! is stationary at c³ − (4/3)βRc² − 4κR = 0. With β = 0 the largest D is h₀ − (3/2)κ^(2/3)R^(−1/3), and the other
//! h₀ − (3/4)(4κ)^(2/3)R^(−1/3). To first order in κ the force of a rigid sphere is 2πRσ₀(h₀ − D − κ/√(2R(h₀ − D))); all
//! orders are kept, as F_s = dU/dD and the spinodal need.
//!
//! # Constant volume
//! V = πc²D + πc⁴/4R − (4π/3)(β/σ₀)σc³ of a bridge under a tension σ. Of a bridge that keeps V the tension is that of a
//! meniscus as high as the gap at the edge, σ = γs(1 − ε)/g, g = D + c²/2R − (β/σ₀)σc, with the share ε = κ/(ch₀) that the
//! curvature around its circle takes where it begins to keep it. Around a rigid sphere and without κ this is F_s = 2πRγs(1 −
//! D/H), H² = D² + V/πR (Rabinovich, Esayanur and Moudgil, Langmuir 21 (2005) 10992). It breaks at R(1 + θ/2)(v^(1/3) +
//! v^(2/3)/20), v = V/R³: the fit of Willett et al., Langmuir 16 (2000) 9396, to equal spheres, of twice the radius by Derjaguin's
//! approximation. Solutions of the Young-Laplace equation are within 0.5 % for θ = 0 and 5 % below for 30° (v = 10⁻⁵).
//!
//! # Validity
//! r_K ≪ c ≪ R. Against the Young-Laplace equation (`scripts/reference_capillary.py`) F_s of rigid spheres is too small by
//! at most 4(κ/ch₀)² of it at D = 0, c = √(2Rh₀), and by 10(κ/ch₀)² near the spinodal. Sources: Maugis and Gauthier-Manuel, J. Adhes. Sci. Technol. 8 (1994) 1311, for
//! the tension around a sphere; Maugis, J. Colloid Interface Sci. 150 (1992) 243; Kim, McMeeking and Johnson, J. Mech. Phys.
//! Solids 46 (1998) 243, for that before contact. The energy follows from dU/dc = 2πσ₀c (gap at c − h₀ + κ/c) at a given
//! D, since what the sphere yields elastically is stationary.

use crate::math::roots::{Sample, golden_maximum, safe_newton};
use std::f64::consts::{FRAC_PI_2, PI};

/// A bridge around a sphere.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bridge {
    /// R, m.
    pub radius: f64,
    /// h₀, m.
    pub range: f64,
    /// σ₀, Pa.
    pub stress: f64,
    /// β.
    pub compliance: f64,
    /// κ, m².
    pub curvature: f64,
}

/// A state of a bridge.
#[derive(Clone, Copy, Debug)]
pub(super) struct Edge {
    /// c, m.
    pub circle: f64,
    /// D, m.
    pub distance: f64,
}

/// A state of a contact within a bridge.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Wetted {
    /// φ.
    pub angle: f64,
    /// c, m.
    pub circle: f64,
    /// a, m.
    pub contact: f64,
    /// δ, m.
    pub interference: f64,
    /// dδ/dφ and da/dφ, m.
    slope: f64,
    narrowing: f64,
}

/// The end of the contacts within a bridge that are stable.
#[derive(Clone, Copy, Debug)]
pub(super) struct Last {
    /// φ; π/2 where the contact shrinks to a point.
    angle: f64,
    /// δ, m.
    pub interference: f64,
}

/// Angles φ from which on the end of stable contacts is looked for, and the tolerance of its logarithm.
const SMALLEST_ANGLE: f64 = 1e-6;
const ANGLE_TOLERANCE: f64 = 1e-10;
/// Relative Newton step after which the search for a known contact ends.
const LAST_STEP: f64 = 1e-8;
/// 0.75π/(π/2)³.
const POINT: f64 = 0.607_927_101_854_026_7;

impl Bridge {
    /// The bridge around a sphere of `ratio` times the radius.
    #[inline(always)]
    pub fn of_ratio(self, ratio: f64) -> Self {
        Self { radius: self.radius * ratio, ..self }
    }

    /// F_s, N, and the gap in the middle, m, at a distance D of the undeformed sphere, m, on the stable branch.
    #[inline(always)]
    pub fn pull(&self, distance: f64) -> (f64, f64) {
        let circle = self.circle(distance);
        (PI * self.stress * circle * circle, distance - FRAC_PI_2 * self.compliance * circle)
    }

    /// The state at a distance D of the undeformed sphere, m, on the stable branch.
    pub fn at_distance(&self, distance: f64) -> Edge {
        Edge { circle: self.circle(distance), distance }
    }

    /// c of that, m.
    #[inline(always)]
    fn circle(&self, distance: f64) -> f64 {
        self.edge(0.5 / self.radius, -self.compliance, self.range - distance)
    }

    /// The larger c, m, with A c² + B c + κ/c = `reach`, A = `square` and B = `linear`; where there is none, the c at which
    /// the left side is nearest to it.
    #[inline(always)]
    fn edge(&self, square: f64, linear: f64, reach: f64) -> f64 {
        let root = |factor: f64| (linear * linear + factor * square * reach).max(0.0).sqrt() - linear;
        let nearest = root(3.0) / (3.0 * square);
        // Without κ c is larger. Newton's method comes down from there: the cubic is convex.
        let mut c = root(4.0) / (2.0 * square);
        loop {
            let value = ((square * c + linear) * c - reach) * c + self.curvature;
            let next = c - value / ((3.0 * square * c + 2.0 * linear) * c - reach);
            if !(next < c) {
                return c;
            }
            if !(next > nearest) {
                return nearest;
            }
            c = next;
        }
    }

    /// The state whose gap in the middle is `gap`, m, at most the range.
    pub fn at_gap(&self, gap: f64) -> Edge {
        let linear = (FRAC_PI_2 - 1.0) * self.compliance;
        let circle = self.edge(0.5 / self.radius, linear, (self.range - gap).max(0.0));
        Edge { circle, distance: gap + FRAC_PI_2 * self.compliance * circle }
    }

    /// The contact of an angle φ.
    fn of_angle(&self, angle: f64) -> Wetted {
        let (sin, cos) = libm::sincos(angle);
        let [squares, half] = [cos * cos - sin * sin, FRAC_PI_2 * self.compliance];
        let square = (sin * cos - angle * squares) / (PI * self.radius);
        let linear = self.compliance * (angle * sin + cos - 1.0);
        let circle = self.edge(square, linear, self.range);
        let [square_slope, linear_slope] =
            [4.0 * angle * sin * cos / (PI * self.radius), self.compliance * angle * cos];
        let opening = 2.0 * square * circle + linear - self.curvature / (circle * circle);
        let circle_slope = -(square_slope * circle + linear_slope) * circle / opening;
        let (contact, narrowing) = (circle * cos, circle_slope * cos - circle * sin);
        Wetted {
            angle,
            circle,
            contact,
            interference: contact * contact / self.radius - half * circle * sin,
            slope: 2.0 * contact * narrowing / self.radius - half * (circle_slope * sin + contact),
            narrowing,
        }
    }

    /// The end of stable contacts: a point, where a bridge without contact is stable there, and a fold otherwise.
    pub fn last_contact(&self) -> Last {
        let touch = self.at_gap(0.0);
        if touch.circle > self.spinodal().circle {
            return Last { angle: FRAC_PI_2, interference: -touch.distance };
        }
        let open = |logarithm: f64| -self.of_angle(libm::exp(logarithm)).interference;
        let [low, high] = [SMALLEST_ANGLE, FRAC_PI_2].map(libm::log);
        let angle = libm::exp(golden_maximum(open, low, high, ANGLE_TOLERANCE / (high - low)));
        Last { angle, interference: self.of_angle(angle).interference }
    }

    /// The stable contact at an interference, m, not below that of the last one; its angle is near `start`, if that is known.
    pub fn contact(&self, interference: f64, last: &Last, start: Option<f64>) -> Wetted {
        let mut state = Wetted::default();
        let mut missing = |angle: f64| {
            state = self.of_angle(angle);
            Sample { value: state.interference - interference, slope: state.slope }
        };
        let (low, start) = match start {
            Some(start) => (0.5 * start, start.min(last.angle * (1.0 - f64::EPSILON))),
            None => {
                // Around a rigid sphere the gap at the edge is that of a Hertz contact far into contact, and the contact a
                // point where it ends.
                let reach = 0.75 * PI / ((interference - last.interference).max(0.0) / self.range + POINT);
                let start = libm::cbrt(reach) * last.angle / FRAC_PI_2;
                let mut low = 0.5 * start;
                while missing(low).value < 0.0 {
                    low *= 0.5;
                }
                (low, start)
            }
        };
        let size = interference.abs() + self.compliance * self.range;
        let enough = |angle: f64, sample: Sample| {
            sample.value.abs() <= 4.0 * f64::EPSILON * size || angle <= SMALLEST_ANGLE
        };
        safe_newton(missing, low, last.angle, start, enough);
        Wetted { interference, ..state }
    }

    /// The state within which the surfaces are as near as without the bridge at an interference, m: a contact of the radius
    /// √(R `inner`), or the gap −`inner` in the middle. Its angle is searched for from `start`, if that is above 0.
    pub fn around(&self, inner: f64, start: f64) -> Wetted {
        if !(inner > 0.0) {
            let Edge { circle, distance } = self.at_gap(-inner);
            return Wetted { angle: FRAC_PI_2, circle, interference: -distance, ..Wetted::default() };
        }
        let wanted = (self.radius * inner).sqrt();
        let mut state = Wetted::default();
        let missing = |angle: f64| {
            state = self.of_angle(angle);
            Sample { value: state.contact - wanted, slope: state.narrowing }
        };
        // The contact around a rigid sphere.
        let start = if start > 0.0 { start } else { libm::cbrt(0.75 * PI / (inner / self.range + POINT)) };
        let enough = |angle: f64, sample: Sample| {
            sample.value.abs() <= LAST_STEP * angle * sample.slope.abs() || angle <= SMALLEST_ANGLE
        };
        safe_newton(missing, 0.0, FRAC_PI_2, start, enough);
        // The error that is left is of the order of the square of the last step.
        state = self.of_angle(state.angle - (state.contact - wanted) / state.narrowing);
        let half = FRAC_PI_2 * self.compliance;
        Wetted { interference: inner - half * state.circle * libm::sin(state.angle), ..state }
    }

    /// F_s of a contact, N.
    pub fn pull_around(&self, state: &Wetted) -> f64 {
        let (sin, cos) = libm::sincos(state.angle);
        2.0 * self.stress * state.circle * state.circle * (state.angle + sin * cos)
    }

    /// The spinodal, at which the bridge breaks, D at least 0.
    pub fn rupture(&self) -> Edge {
        let Edge { circle, distance } = self.spinodal();
        Edge { circle, distance: distance.max(0.0) }
    }

    /// The state of the largest D.
    pub fn spinodal(&self) -> Edge {
        self.stationary(1.0, 1.0)
    }

    /// The state whose energy is that of no bridge, D at least 0.
    pub fn equilibrium(&self) -> Edge {
        let Edge { circle, distance } = self.stationary(4.0 / 3.0, 4.0);
        Edge { circle, distance: distance.max(0.0) }
    }

    /// The state at the positive root of c³ − `elastic` βRc² − `curved` κR = 0.
    fn stationary(&self, elastic: f64, curved: f64) -> Edge {
        let (square, constant) =
            (elastic * self.compliance * self.radius, curved * self.curvature * self.radius);
        // From above Newton's method comes down to it: the cubic is convex there.
        let mut circle = square + libm::cbrt(constant);
        loop {
            let value = circle * circle * (circle - square) - constant;
            let next = circle - value / (circle * (3.0 * circle - 2.0 * square));
            if !(next < circle) {
                break;
            }
            circle = next;
        }
        let distance = self.range - self.curvature / circle - 0.5 * circle * circle / self.radius
            + self.compliance * circle;
        Edge { circle, distance }
    }
}

/// A bridge that keeps its liquid while the surfaces are separated.
#[derive(Clone, Copy, Debug)]
pub(super) struct Closed {
    bridge: Bridge,
    /// V, m³.
    volume: f64,
    /// c at the beginning, m, which is its largest.
    largest: f64,
    /// γs(1 − ε), J/m².
    energy: f64,
}

impl Closed {
    /// The bridge that has the liquid of another in a state.
    pub fn new(bridge: Bridge, Edge { circle, distance }: Edge) -> Self {
        let tension = bridge.stress;
        let energy = tension * (bridge.range - bridge.curvature / circle);
        let mut closed = Self { bridge, volume: 0.0, largest: circle, energy };
        closed.volume = closed.content(circle, distance, (tension, 0.0)).value;
        closed
    }

    /// V and dV/dc at c and D under a tension and its slope.
    fn content(&self, c: f64, distance: f64, (tension, slope): (f64, f64)) -> Sample {
        let Bridge { radius, compliance, stress, .. } = self.bridge;
        let elastic = 4.0 * PI / 3.0 * compliance / stress;
        Sample {
            value: PI * c * c * (distance + 0.25 * c * c / radius) - elastic * tension * c.powi(3),
            slope: PI * c * (2.0 * distance + c * c / radius) - elastic * c * c * (slope * c + 3.0 * tension),
        }
    }

    /// σ and dσ/dc at c and D. Where the surfaces are too soft for any, that at which they are just stable.
    fn tension(&self, c: f64, distance: f64) -> (f64, f64) {
        let Bridge { radius, compliance, stress, .. } = self.bridge;
        let soft = 2.0 * compliance / stress * self.energy;
        let open = distance + 0.5 * c * c / radius;
        let root = (open * open - 2.0 * soft * c).max(0.0).sqrt();
        let height = 0.5 * (open + root);
        let rise = c / radius;
        let turn = if root > 0.0 { (open * rise - soft) / root } else { 0.0 };
        (self.energy / height, -self.energy / (height * height) * 0.5 * (rise + turn))
    }

    /// F_s, N, and the gap in the middle, m, at a distance D of the undeformed sphere, m.
    pub fn pull(&self, distance: f64) -> (f64, f64) {
        let Bridge { radius, compliance, stress, .. } = self.bridge;
        let free = (distance * distance + self.volume / (PI * radius)).sqrt();
        let start = (2.0 * radius * (free - distance)).sqrt();
        let missing = |c: f64| {
            let Sample { value, slope } = self.content(c, distance, self.tension(c, distance));
            Sample { value: self.volume - value, slope: -slope }
        };
        let enough = |_: f64, sample: Sample| sample.value.abs() <= 4.0 * f64::EPSILON * self.volume;
        let circle = safe_newton(missing, 0.0, 2.0 * self.largest, start, enough).x;
        let (tension, _) = self.tension(circle, distance);
        (PI * tension * circle * circle, distance - 0.5 * PI * compliance / stress * tension * circle)
    }

    /// D at which it breaks, m, at a contact angle, rad.
    pub fn rupture(&self, contact_angle: f64) -> f64 {
        let radius = self.bridge.radius;
        let root = libm::cbrt(self.volume) / radius;
        radius * (1.0 + 0.5 * contact_angle) * root * (1.0 + 0.05 * root)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::liquid::{Liquid, Meniscus};

    /// Water at 25 °C around a sphere of 1 μm of a stiffness E*, Pa.
    fn bridge(modulus: f64) -> Bridge {
        let tension = Liquid::water(298.15).unwrap().surface_tension;
        let liquid = Liquid::new(tension, 0.01801528 / 997.047, 298.15).unwrap();
        let meniscus = Meniscus::new(liquid, 0.5, [PI / 6.0; 2]).unwrap();
        Bridge {
            radius: 1e-6,
            range: meniscus.range(),
            stress: meniscus.pressure(),
            compliance: 4.0 * meniscus.pressure() / (PI * modulus),
            curvature: meniscus.turn() * meniscus.kelvin_radius.powi(2),
        }
    }

    /// Ten digits of the closed forms of a rigid sphere by 50-digit arithmetic.
    #[test]
    fn rigid_spheres_have_the_closed_forms() {
        let rigid = bridge(1e30);
        let close = |found: f64, expected: f64| assert!((found / expected - 1.0).abs() < 1e-9, "{found:e}");
        let straight = Bridge { curvature: 0.0, ..rigid };
        close(straight.pull(0.0).0, 7.832588405e-7);
        close(straight.pull(0.5e-9).0, 4.845012508e-7);
        // The share that the meniscus around the circle takes, to first order; the second is of its square.
        for (distance, expected) in [(0.0, 7.733648693e-7), (0.5e-9, 4.719213897e-7)] {
            let first = 1.0 - expected / straight.pull(distance).0;
            let all = 1.0 - rigid.pull(distance).0 / straight.pull(distance).0;
            assert!(all > first && all - first < first * first, "{distance:e}: {first} {all}");
        }
        close(rigid.rupture().distance, 1.176490507e-9);
        close(rigid.equilibrium().distance, 1.141565007e-9);
    }

    /// The Young-Laplace equation by shooting, θ = 0: D_rup/r_K = 1.79775 at R/r_K = 1000, 1.56836 at 100.
    /// The first order in √(r_K/R) is off by no more than the next.
    #[test]
    fn rupture_is_near_that_of_young_and_laplace() {
        for (ratio, exact) in [(1000.0, 1.79775), (100.0, 1.56836)] {
            let (radius, range, curvature) = (ratio, 2.0, 0.5 * PI);
            let bridge = Bridge { radius, range, stress: 1.0, compliance: 0.0, curvature };
            let found = bridge.rupture().distance;
            assert!((found - exact).abs() < 0.6 / ratio, "{found} {exact}");
        }
    }

    /// dD/dc vanishes at the spinodal, and ∫ (gap − h₀ + κ/c) c dc from 0 at the equilibrium, by their definitions.
    #[test]
    fn ends_are_stationary_states() {
        for modulus in [1e30, 70e9, 1e9, 1e8] {
            let bridge = bridge(modulus);
            let Bridge { radius, range, compliance, curvature, .. } = bridge;
            let distance = |c: f64| range - curvature / c - 0.5 * c * c / radius + compliance * c;
            let Edge { circle, distance: largest } = bridge.rupture();
            for beside in [0.99, 1.01] {
                assert!(distance(beside * circle) < largest, "{modulus:e}");
            }
            let Edge { circle, distance: at } = bridge.equilibrium();
            let steps = 20_000;
            let density = |y: f64| (at + 0.5 * y * y / radius - compliance * y - range) * y + curvature;
            let width = circle / f64::from(steps);
            let sum: f64 = (0..steps).map(|i| density((f64::from(i) + 0.5) * width) * width).sum();
            assert!(sum.abs() < 1e-6 * range * circle * circle, "{modulus:e}: {sum:e}");
            assert!(at <= largest);
        }
    }

    /// Ten digits of the closed form of a rigid sphere that keeps its liquid from D = 0; and whatever the stiffness, nothing
    /// jumps where it begins to keep it.
    #[test]
    fn a_bridge_keeps_its_liquid() {
        let straight = Bridge { curvature: 0.0, ..bridge(1e30) };
        let closed = Closed::new(straight, straight.at_gap(0.0));
        assert!((closed.volume / 5.398369385e-24 - 1.0).abs() < 1e-9);
        assert!((closed.pull(0.5e-9).0 / 5.041178160e-7 - 1.0).abs() < 1e-9);
        for modulus in [1e30, 70e9, 5e9] {
            let bridge = bridge(modulus);
            let begin = bridge.at_gap(0.05e-9);
            let closed = Closed::new(bridge, begin);
            let (pull, gap) = closed.pull(begin.distance);
            assert!((pull / bridge.pull(begin.distance).0 - 1.0).abs() < 1e-9, "{modulus:e}");
            assert!((gap - 0.05e-9).abs() < 1e-18, "{modulus:e}");
            let further = begin.distance + 0.05e-9;
            let (less, _) = closed.pull(further);
            assert!(less < pull && less > bridge.pull(further).0, "{modulus:e}");
        }
    }

    /// Largest distances of bridges of v = 10⁻⁵ and 10⁻⁴ on a sphere and a flat that solve the Young-Laplace equation, by
    /// shooting elsewhere.
    #[test]
    fn closed_bridges_break_near_young_and_laplace() {
        for (volume, degrees, exact, allowed) in
            [(1e-5, 0.0, 0.021612, 5e-3), (1e-4, 0.0, 0.046462, 5e-3), (1e-5, 30.0, 0.026123, 5e-2)]
        {
            let sphere = Bridge { radius: 1.0, range: 1.0, stress: 1.0, compliance: 0.0, curvature: 1.0 };
            let closed = Closed { bridge: sphere, volume, largest: 1.0, energy: 1.0 };
            let found = closed.rupture(f64::to_radians(degrees));
            assert!((found / exact - 1.0).abs() < allowed, "{volume:e}, {degrees}: {found}");
        }
    }

    /// States that are searched for by their gap in the middle have this gap.
    #[test]
    fn states_are_found_by_their_gap() {
        for modulus in [1e30, 70e9, 1e9] {
            let bridge = bridge(modulus);
            for gap in [0.0, 0.1e-9, 0.7e-9] {
                let Edge { circle, distance } = bridge.at_gap(gap);
                if circle > bridge.compliance * bridge.radius {
                    assert!((bridge.pull(distance).1 - gap).abs() < 1e-15 * bridge.range.max(gap) * 1e3);
                }
                assert!(
                    (0.5 * circle * circle / 1e-6 - bridge.compliance * circle
                        + bridge.curvature / circle
                        + distance
                        - bridge.range)
                        .abs()
                        < 1e-21
                );
            }
        }
    }
}
