//! Summits that are ellipsoids, in laws that are for spheres: a Hertz contact of principal curvatures κ₁ ≥ κ₂.

/// Half-widths over each other, b/a, between which a ratio of curvatures is looked for: up to 10³⁰⁰ apart.
const NARROWEST: f64 = 1e-160;
/// Means of arithmetic and geometric means until they agree to rounding.
const STEPS: usize = 16;

/// Radius of the sphere that has the Hertz force of an ellipsoid on a plane at every interference, m, by the
/// ellipsoid's principal curvatures κ₁ ≥ κ₂ > 0, 1/m.
///
/// # Formula
/// P = (4/3) E* √R δ^(3/2) with R = 2 M² S/κ₂ (Johnson 1985, Contact Mechanics, section 4.2), where M is the
/// arithmetic-geometric mean of 1 and the ratio k = b/a of the half-widths of the contact, π/(2M) = K(e) with e² = 1 −
/// k², and S = (K − E)/(e² K); k follows from κ₁/κ₂ = (1 − S)/(k² S).
///
/// # Examples
/// ```
/// use stiction::surface::map::hertz_radius;
///
/// assert!((hertz_radius([2e6, 2e6]) * 2e6 - 1.0).abs() < 1e-14);
/// // Curvatures that are 4 apart: nearer to the geometric mean of the radii than to 1/mean curvature.
/// let radius = hertz_radius([4e6, 1e6]);
/// assert!((radius / 0.5e-6 - 1.0).abs() < 0.1 && (radius / 0.4e-6 - 1.0).abs() > 0.3);
/// ```
pub fn hertz_radius([sharp, blunt]: [f64; 2]) -> f64 {
    let ratio = (sharp / blunt).max(1.0);
    // By bisection of ln k: the ratio falls as k rises, and lies between k^−1 and k^−2.
    let (mut low, mut high) = ((1.0 / ratio).max(NARROWEST), 1.0_f64);
    for _ in 0..200 {
        let k = (low * high).sqrt();
        if !(low < k && k < high) {
            break;
        }
        if ratio_of(k) > ratio {
            low = k;
        } else {
            high = k;
        }
    }
    let (mean, share) = elliptic((low * high).sqrt());
    2.0 * mean * mean * share / blunt
}

/// κ₁/κ₂ of a contact whose half-widths are so far apart.
fn ratio_of(k: f64) -> f64 {
    let (_, share) = elliptic(k);
    (1.0 - share) / (k * k * share)
}

/// The arithmetic-geometric mean of 1 and k, and (K − E)/(e² K), of which nothing is lost where k is close to
/// 1: 1/2 + Σ 2^(n−1) c_n²/e² with c₁ = e²/(2(1 + k)), c_(n+1) = c_n²/(4 a_(n+1)) (Abramowitz and Stegun 17.6).
fn elliptic(k: f64) -> (f64, f64) {
    let e2 = (1.0 - k) * (1.0 + k);
    let (mut a, mut b) = (0.5 * (1.0 + k), k.sqrt());
    // c_n/e.
    let mut c = e2.sqrt() / (2.0 * (1.0 + k));
    let (mut share, mut weight) = (0.5 + c * c, 1.0);
    for _ in 0..STEPS {
        let next = 0.5 * (a + b);
        (b, c) = ((a * b).sqrt(), c * c * e2.sqrt() / (4.0 * next));
        a = next;
        weight *= 2.0;
        share += weight * c * c;
    }
    (a, share)
}

/// Hertz force at a given interference of two spheres over that of an ellipsoid whose principal curvatures
/// have this ratio: of a sphere of R = 1/mean curvature, 2/(κ₁ + κ₂), and of R = 1/√(κ₁κ₂). Both are at most
/// 1, and the second is the larger one.
///
/// # Examples
/// ```
/// use stiction::surface::map::forces_of_spheres;
///
/// let [of_mean, of_geometric] = forces_of_spheres(2.0);
/// assert!((of_mean - 0.9614).abs() < 1e-4 && (of_geometric - 0.9901).abs() < 1e-4);
/// ```
pub fn forces_of_spheres(ratio: f64) -> [f64; 2] {
    let exact = hertz_radius([ratio, 1.0]);
    [2.0 / (1.0 + ratio), 1.0 / ratio.sqrt()].map(|radius| (radius / exact).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// K and E by the trapezium rule over a period, which converges geometrically for smooth integrands.
    fn integrals(e2: f64) -> (f64, f64) {
        let n = 4000;
        let root = |i: usize| {
            let sin = (std::f64::consts::PI * (i as f64 + 0.5) / n as f64).sin();
            (1.0 - e2 * sin * sin).sqrt()
        };
        let step = std::f64::consts::FRAC_PI_2 / n as f64;
        let k: f64 = (0..n).map(|i| 1.0 / root(i)).sum();
        let e: f64 = (0..n).map(root).sum();
        (k * step, e * step)
    }

    /// Johnson's equations as they are printed (4.28, 4.24, 4.26), from half-widths to curvatures and force,
    /// with integrals by quadrature: curvatures A = κ₂/2 and B = κ₁/2, pressure p₀ at the middle, P = 2πabp₀/3.
    #[test]
    fn the_force_is_that_of_johnsons_equations() {
        let (a, modulus, interference) = (3e-9_f64, 4e10, 2e-10);
        for k in [0.02, 0.1, 0.3, 0.55, 0.8, 0.95, 0.999] {
            let (b, e2) = (k * a, 1.0 - k * k);
            let (first, second) = integrals(e2);
            let pressure = interference * modulus / (b * first);
            let scale = pressure / modulus * b / (e2 * a * a);
            let (blunt, sharp) =
                (2.0 * scale * (first - second), 2.0 * scale * (a * a / (b * b) * second - first));
            let force = 2.0 / 3.0 * std::f64::consts::PI * a * b * pressure;
            let radius = hertz_radius([sharp, blunt]);
            let of_sphere = 4.0 / 3.0 * modulus * radius.sqrt() * interference.powf(1.5);
            // The equations lose digits where k is close to 1.
            let tolerance = 1e-12 + 1e-15 / (e2 * e2);
            assert!((of_sphere / force - 1.0).abs() < tolerance, "{k}: {:e}", of_sphere / force - 1.0);
        }
    }

    /// A sphere is one; of curvatures 1 ± ε the radius is 1 + 2ε²/3, by the series of K and E, where the
    /// geometric mean of the radii is 1 + ε²/2, and 1/mean curvature is 1.
    #[test]
    fn spheres_and_what_is_close_to_them() {
        assert!((hertz_radius([5.0, 5.0]) * 5.0 - 1.0).abs() < 1e-15);
        for difference in [1e-6, 1e-3, 3e-3] {
            let radius = hertz_radius([1.0 + difference, 1.0 - difference]);
            let bend = (radius - 1.0) / (difference * difference);
            assert!(difference < 1e-5 || (bend - 2.0 / 3.0).abs() < 1e-4, "{difference}: {bend}");
            assert!((radius - 1.0).abs() < 2.0 * difference * difference + 1e-14);
        }
        assert!(hertz_radius([1e250, 1.0]).is_finite());
    }
}
