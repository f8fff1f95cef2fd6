//! The forms of the published curve fits, in any consistent units.
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

    /// The forms in units of length and force that are multiples `length` and `force` of the present ones.
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
        let [base, a, b, place] = self.noncontact;
        let x = delta - place;
        let inverse = 1.0 / (4.0 * x * x + b * b);
        base + 2.0 / PI * a * b * inverse
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

#[cfg(test)]
mod tests {
    use super::*;

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
