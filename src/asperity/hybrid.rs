//! The elastic-plastic hybrid law of a lubricated asperity, and the elastic law that is its part up to ω_c.
//!
//! # Formula
//! By the interference δ, with δ_A = −Δ_end s_δ of the history (Shi and Polycarpou 2005, eqs. 15 to 23):
//!
//! | regime | interval | F_s | P |
//! |---|---|---|---|
//! | noncontact | δ < −(t + δ_A) | EMD at δ + t | 0 |
//! | lubricant | −(t + δ_A) ≤ δ < −δ_A | 2πΔγR | 0 |
//! | elastic | −δ_A ≤ δ ≤ ω_c | Maugis-Dugdale | K a³/R of Maugis-Dugdale |
//! | elastoplastic1 | ω_c < δ ≤ 6ω_c | Kogut-Etsion | Kogut-Etsion |
//! | elastoplastic2 | 6ω_c < δ ≤ 110ω_c | Kogut-Etsion | Kogut-Etsion |
//! | plastic | δ > 110ω_c | 0 | 2πRδH |
//!
//! The elastic law is the first three rows; beyond ω_c it has no force.
//!
//! # Validity
//! All λ in 1e-6..1e6; independent asperities. The joints at ω_c, 6ω_c and 110ω_c are jumps of the published fits.

use super::emd::Emd;
use super::kogut_etsion::{FIRST_END, KogutEtsion, SECOND_END};
use super::law::{Boundary, Law, Piece, Regime, Responses, Smoothness};
use super::scale::{Asperity, Scale};
use super::{LawError, Path, Work};
use std::f64::consts::PI;

const REGIMES: [Regime; 6] = [
    Regime::Noncontact,
    Regime::Lubricant,
    Regime::Elastic,
    Regime::Elastoplastic1,
    Regime::Elastoplastic2,
    Regime::Plastic,
];

/// The hybrid law, or its elastic part, for one asperity geometry and history.
#[derive(Clone, Debug)]
pub struct Hybrid {
    emd: Emd,
    plastic: KogutEtsion,
    scale: Scale,
    thickness: f64,
    boundaries: Vec<Boundary>,
    regimes: &'static [Regime],
}

impl Hybrid {
    /// The whole table. `reach` is the range of interferences, m, that starting tables are made for; others are solved
    /// too, slower.
    ///
    /// # Errors
    /// [`LawError`] for a λ that is not solved, or quantities that are not positive and finite.
    pub fn new(asperity: &Asperity, path: Path, reach: (f64, f64)) -> Result<Self, LawError> {
        Self::table(asperity, path, reach, &REGIMES)
    }

    /// The first three rows of the table: the elastic law, without force beyond ω_c.
    ///
    /// # Errors
    /// As [`Hybrid::new`].
    pub fn elastic(asperity: &Asperity, path: Path, reach: (f64, f64)) -> Result<Self, LawError> {
        Self::table(asperity, path, reach, &REGIMES[..3])
    }

    fn table(asperity: &Asperity, path: Path, reach: (f64, f64), regimes: &'static [Regime]) -> Result<Self, LawError> {
        let thickness = asperity.lubricant_thickness;
        if !(thickness >= 0.0 && thickness.is_finite()) {
            return Err(LawError::NotPositive { name: "lubricant_thickness", value: thickness });
        }
        let scale = Scale::new(asperity)?;
        let plastic = KogutEtsion::new(asperity)?;
        let critical = asperity.critical_interference();
        let emd = Emd::new(scale.lambda, path)?
            .with_tables((reach.0 + thickness) / scale.length, reach.1.min(critical) / scale.length);
        let touch = emd.end() * scale.length;
        let below = |interference| Boundary { interference, belongs_below: true };
        let above = |interference| Boundary { interference, belongs_below: false };
        let mut boundaries = vec![
            above(touch - thickness),
            above(touch),
            below(critical),
            below(FIRST_END * critical),
            below(SECOND_END * critical),
        ];
        boundaries.truncate(regimes.len());
        Ok(Self { emd, plastic, scale, thickness, boundaries, regimes })
    }

    /// The solver of its elastic part.
    pub fn emd(&self) -> &Emd {
        &self.emd
    }

    fn noncontact(&self, interference: &[f64], out: &mut Responses, work: &mut Work) {
        let inverse = 1.0 / self.scale.length;
        let mut near = [0, 0];
        for (i, &delta) in interference.iter().enumerate() {
            let solution = self.emd.noncontact((delta + self.thickness) * inverse, &mut near, work);
            out.adhesion[i] = self.scale.force * solution.adhesion;
        }
        out.contact[..interference.len()].fill(0.0);
        out.area[..interference.len()].fill(0.0);
        work.noncontact_solves += interference.len() as u64;
    }

    fn elastic_contact(&self, interference: &[f64], out: &mut Responses, work: &mut Work) {
        let inverse = 1.0 / self.scale.length;
        let area_unit = PI * self.scale.radius * self.scale.radius;
        let mut near = 0;
        for (i, &delta) in interference.iter().enumerate() {
            let solution = self.emd.contact(delta * inverse, &mut near, work);
            let square = solution.radius * solution.radius;
            out.adhesion[i] = self.scale.force * solution.adhesion;
            out.contact[i] = self.scale.force * square * solution.radius;
            out.area[i] = area_unit * square;
        }
        work.contact_solves += interference.len() as u64;
    }
}

impl Law for Hybrid {
    fn regimes(&self) -> &[Regime] {
        self.regimes
    }

    fn boundaries(&self) -> &[Boundary] {
        &self.boundaries
    }

    fn pieces(&self) -> Vec<Piece> {
        let mut pieces = Vec::new();
        let mut push = |regime: usize, lower: f64, upper: f64, smoothness: Smoothness| {
            if lower < upper {
                pieces.push(Piece { regime, lower, upper, smoothness });
            }
        };
        let ends: Vec<f64> = self.boundaries.iter().map(|boundary| boundary.interference).collect();
        let mut lower = f64::NEG_INFINITY;
        if let Some(fold) = self.emd.noncontact_fold() {
            let place = fold * self.scale.length - self.thickness;
            push(0, lower, place, Smoothness::SquareRoot { place });
            lower = place;
        }
        push(0, lower, ends[0], Smoothness::Smooth);
        push(1, ends[0], ends[1], Smoothness::Smooth);
        push(2, ends[1], ends[2], Smoothness::SquareRoot { place: self.emd.contact_fold() * self.scale.length });
        for regime in 3..self.regimes.len() {
            push(regime, ends[regime - 1], ends.get(regime).copied().unwrap_or(f64::INFINITY), Smoothness::Smooth);
        }
        pieces
    }

    fn evaluate(&self, regime: usize, interference: &[f64], out: &mut Responses, work: &mut Work) {
        match self.regimes[regime] {
            Regime::Noncontact => self.noncontact(interference, out, work),
            Regime::Lubricant => {
                out.adhesion[..interference.len()].fill(2.0 * self.scale.force);
                out.contact[..interference.len()].fill(0.0);
                out.area[..interference.len()].fill(0.0);
                work.constant += interference.len() as u64;
            }
            Regime::Elastic => self.elastic_contact(interference, out, work),
            Regime::Elastoplastic1 | Regime::Elastoplastic2 | Regime::Plastic => {
                self.plastic.evaluate(regime - 3, interference, out);
                work.closed_form += interference.len() as u64;
            }
        }
    }
}
