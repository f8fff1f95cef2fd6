//! The forms of the published curve fits and their derivatives by the coefficients; any consistent units.
//!
//! # Formula
//! Shi and Polycarpou (2005), eqs. A.1a to A.1c:
//!
//! f_snc = f_sonc + (2A_nc/π) B_nc/(4(δ − δ_onc)² + B_nc²), f_sel = f_soc + (A_c δ + B_c)^P_c, f_f = f_f0 +
//! A_f δ^m_f + B_f δ^n_f.

use std::f64::consts::PI;

/// Names of the coefficients, in the order of Table 3.
pub const NAMES: [&str; 13] =
    ["f_sonc", "A_nc", "B_nc", "delta_onc", "f_soc", "A_c", "B_c", "P_c", "f_f0", "A_f", "B_f", "m_f", "n_f"];

/// The three fitted forces.
pub const FORCES: [&str; 3] = ["f_snc", "f_sel", "f_f"];

/// Coefficients of the three forms.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coefficients {
    /// f_sonc, A_nc, B_nc, δ_onc.
    pub noncontact: [f64; 4],
    /// f_soc, A_c, B_c, P_c.
    pub adhesion: [f64; 4],
    /// f_f0, A_f, B_f, m_f, n_f.
    pub external: [f64; 5],
}

impl Coefficients {
    /// From the order of [`NAMES`].
    pub fn from_list(list: &[f64; 13]) -> Self {
        Self {
            noncontact: std::array::from_fn(|i| list[i]),
            adhesion: std::array::from_fn(|i| list[4 + i]),
            external: std::array::from_fn(|i| list[8 + i]),
        }
    }

    /// In the order of [`NAMES`].
    pub fn list(&self) -> [f64; 13] {
        std::array::from_fn(|i| match i {
            0..4 => self.noncontact[i],
            4..8 => self.adhesion[i - 4],
            _ => self.external[i - 8],
        })
    }

    /// The same forms in units of length and force that are so many of the present ones.
    pub fn in_units(&self, length: f64, force: f64) -> Self {
        let [base, a, b, place] = self.noncontact;
        let [constant, slope, offset, power] = self.adhesion;
        let root = libm::pow(force, -1.0 / power);
        let [f0, af, bf, m, n] = self.external;
        Self {
            noncontact: [base / force, a / (force * length), b / length, place / length],
            adhesion: [constant / force, slope * length * root, offset * root, power],
            external: [
                f0 / force,
                af * libm::pow(length, m) / force,
                bf * libm::pow(length, n) / force,
                m,
                n,
            ],
        }
    }

    /// f_snc at a displacement.
    pub fn noncontact(&self, delta: f64) -> f64 {
        lorentzian(&self.noncontact, delta).0
    }

    /// f_sel at a displacement; the power is 0 where its base is negative, which Table 3 leaves open.
    pub fn adhesion(&self, delta: f64) -> f64 {
        let [constant, slope, offset, power] = self.adhesion;
        constant + libm::pow((slope * delta + offset).max(0.0), power)
    }

    /// f_f at a displacement δ ≥ 0.
    pub fn external(&self, delta: f64) -> f64 {
        let [f0, a, b, m, n] = self.external;
        f0 + a * libm::pow(delta, m) + b * libm::pow(delta, n)
    }

    /// The sum of the magnitudes of the terms of f_sel.
    pub fn adhesion_magnitude(&self, delta: f64) -> f64 {
        let constant = self.adhesion[0];
        constant.abs() + (self.adhesion(delta) - constant).abs()
    }

    /// The sum of the magnitudes of the terms of f_f.
    pub fn external_magnitude(&self, delta: f64) -> f64 {
        let [f0, a, b, m, n] = self.external;
        f0.abs() + (a * libm::pow(delta, m)).abs() + (b * libm::pow(delta, n)).abs()
    }

    /// Displacement at which the base of f_sel is 0.
    pub fn base_zero(&self) -> f64 {
        -self.adhesion[2] / self.adhesion[1]
    }
}

/// f_snc and its derivatives by f_sonc, A_nc, B_nc, δ_onc.
pub fn lorentzian(p: &[f64; 4], delta: f64) -> (f64, [f64; 4]) {
    let [base, a, b, place] = *p;
    let x = delta - place;
    let inverse = 1.0 / (4.0 * x * x + b * b);
    let factor = 2.0 / PI;
    let value = base + factor * a * b * inverse;
    let by_b = factor * a * (inverse - 2.0 * b * b * inverse * inverse);
    (value, [1.0, factor * b * inverse, by_b, factor * a * b * 8.0 * x * inverse * inverse])
}

/// f_sel over the distance x ≥ 0 from the lower end of the fit, and its derivatives by f_soc, ln A_c, ln(base
/// at x = 0), P_c: so the base stays positive on the whole range.
pub fn power(p: &[f64; 4], x: f64) -> (f64, [f64; 4]) {
    let [slope, offset] = [libm::exp(p[1]), libm::exp(p[2])];
    let base = slope * x + offset;
    let value = libm::pow(base, p[3]);
    let by_base = p[3] * value / base;
    (p[0] + value, [1.0, by_base * slope * x, by_base * offset, value * libm::log(base)])
}

/// f_f at δ ≥ 0, and its derivatives by f_f0, A_f, B_f, ln m_f, ln n_f: so the exponents stay positive.
pub fn two_powers(p: &[f64; 5], delta: f64) -> (f64, [f64; 5]) {
    let [m, n] = [libm::exp(p[3]), libm::exp(p[4])];
    let [first, second] = [libm::pow(delta, m), libm::pow(delta, n)];
    let log = if delta > 0.0 { libm::log(delta) } else { 0.0 };
    let value = p[0] + p[1] * first + p[2] * second;
    (value, [1.0, first, second, p[1] * first * log * m, p[2] * second * log * n])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check<const N: usize>(form: impl Fn(&[f64; N], f64) -> (f64, [f64; N]), p: [f64; N], x: f64) {
        for i in 0..N {
            let [mut below, mut above] = [p, p];
            (below[i], above[i]) = (p[i] - 1e-5, p[i] + 1e-5);
            let difference = (form(&above, x).0 - form(&below, x).0) / 2e-5;
            let slope = form(&p, x).1[i];
            assert!((slope - difference).abs() < 1e-7 * (1.0 + slope.abs()), "{i}: {slope} {difference}");
        }
    }

    #[test]
    fn slopes_agree_with_finite_differences() {
        for x in [0.1, 0.7, 2.0] {
            check(lorentzian, [0.1, 0.8, 0.5, 0.3], -x);
            check(power, [0.4, 0.3, -0.6, 0.8], x);
            check(two_powers, [-1.0, 0.9, 0.4, 0.4, -0.5], x);
        }
    }

    #[test]
    fn units_change_the_coefficients_and_not_the_forces() {
        let p = Coefficients {
            noncontact: [0.014, 0.7, 0.22, -0.13],
            adhesion: [1.6, 4.5, 1.17, 0.81],
            external: [-1.2, 3.3, 2.1, 1.49, 0.7],
        };
        let (length, force) = (0.3, 7.0);
        let q = p.in_units(length, force);
        for x in [0.0, 0.4, 3.0] {
            assert!((q.noncontact(-x / length) * force / p.noncontact(-x) - 1.0).abs() < 1e-14);
            assert!((q.adhesion(x / length) * force / p.adhesion(x) - 1.0).abs() < 1e-14);
            assert!((q.external(x / length) * force - p.external(x)).abs() < 1e-13);
        }
        assert_eq!(Coefficients::from_list(&p.list()), p);
    }
}
