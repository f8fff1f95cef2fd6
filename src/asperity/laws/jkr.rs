//! Johnson-Kendall-Roberts: adhesion within the contact only.
//!
//! # Formula
//! F̂ = A³ − A√(6A), Δ = A² − (2/3)√(6A), so P = A³ and F̂_s = A√(6A). The stable branch ends at A =
//! 6^(−1/3), where dΔ/dA = 0, with F̂ = −5/6. Solved in x = A^(−1/2): Δ = x⁻⁴ − (2√6/3)x⁻¹.
//!
//! On the unstable branch, from A = 0 to its end, ∫F̂ dΔ = (2/5)A⁵ − (2√6/3)A^(7/2) + A² = (2/5) 6^(−2/3).
//!
//! On approach nothing acts before Δ = 0; there contact begins with A³ = 8/3. On retraction it lasts to the
//! end of the branch.
//!
//! # Validity
//! Elastic spheres of high λ; the limit of Maugis-Dugdale as λ → ∞. Sources: Johnson, Kendall and Roberts,
//! Proc. R. Soc. Lond. A 324 (1971) 301; for rough surfaces Fuller and Tabor, Proc. R. Soc. Lond. A 345
//! (1975) 327.

use crate::asperity::block::{BLOCK, Responses};
use crate::asperity::branch::Branch;
use crate::asperity::curve::{Anchor, BranchCurve, CurvePoint};
use crate::asperity::error::LawError;
use crate::asperity::formula::Constant;
use crate::asperity::history::Path;
use crate::asperity::lane::{Lane, Lanes};
use crate::asperity::law::{End, Law, Method, Piece, RadiusDependence, Regime, Smoothness};
use crate::asperity::parameters::LawParameters;
use crate::asperity::radius::{Place, Similarity};
use crate::asperity::scale::Scale;
use crate::asperity::stats::SolverStats;
use crate::asperity::table::{Row, Table};
use std::ops::Range;

/// The law `jkr`.
///
/// # Errors
/// None for a checked setting.
pub fn jkr(parameters: &LawParameters) -> Result<Box<dyn Law>, LawError> {
    let contact = JkrContact::new(parameters);
    let begin = match parameters.path {
        Path::Approach => 0.0,
        Path::Retraction => contact.end(),
    };
    Ok(Box::new(Table::new([
        Row::below(Regime::Noncontact, Place::proportional(begin, LENGTH), Constant::NOTHING),
        Row::last(Regime::Elastic, contact),
    ])))
}

/// Δ(x), F̂_s(x), A(x) for x = A^(−1/2).
#[derive(Clone, Copy, Debug)]
struct JkrCurve;

/// Exponent of the radius in the unit of length.
const LENGTH: f64 = 1.0 / 3.0;
/// √6.
const ROOT_6: f64 = 2.449_489_742_783_178;

impl JkrCurve {
    /// x at the end of the stable branch, 6^(1/6).
    fn end(self) -> f64 {
        libm::cbrt(ROOT_6)
    }
}

impl BranchCurve for JkrCurve {
    #[inline(always)]
    fn terms(&self, x: f64) -> [f64; 4] {
        [1.0 / x, 0.0, 0.0, 0.0]
    }

    #[inline(always)]
    fn state(&self, _: f64, [y, ..]: [f64; 4]) -> CurvePoint {
        let square = y * y;
        let pull = 2.0 / 3.0 * ROOT_6 * y;
        CurvePoint {
            displacement: square * square - pull,
            slope: square * (2.0 / 3.0 * ROOT_6 - 4.0 * square * y),
            magnitude: square * square + pull,
            adhesion: ROOT_6 * square * y,
            adhesion_slope: -3.0 * ROOT_6 * square * square,
            radius: square,
            radius_slope: -2.0 * square * y,
        }
    }

    fn bracket(&self, displacement: f64) -> (f64, f64) {
        let mut low = self.end();
        while self.at(low).displacement < displacement && low > f64::MIN_POSITIVE {
            low *= 0.5;
        }
        (low, self.end())
    }
}

/// The contact branch.
#[derive(Clone, Debug)]
pub struct JkrContact {
    branch: Branch<JkrCurve>,
    scale: Scale,
}

impl JkrContact {
    fn new(parameters: &LawParameters) -> Self {
        let end = JkrCurve.end();
        let mut branch = Branch::new(
            JkrCurve,
            Anchor { displacement: JkrCurve.at(end).displacement, parameter: end, fold: true },
        );
        if let Some(deepest) =
            parameters.deepest(f64::INFINITY).filter(|deepest| *deepest > branch.anchor().displacement)
        {
            branch = branch.with_table(deepest);
        }
        Self { branch, scale: parameters.scale }
    }

    /// Interference at the end of the stable branch, m.
    fn end(&self) -> f64 {
        self.branch.anchor().displacement * self.scale.length
    }
}

impl Law for JkrContact {
    fn radius_dependence(&self) -> RadiusDependence {
        RadiusDependence::Formulas
    }

    fn pieces_within(&self, _: usize, lane: Option<&Lane>, within: Range<f64>) -> Vec<Piece> {
        let own = self.end();
        let place = lane.map_or(own, |lane| Similarity::new(LENGTH, 0.0).interference(own, lane));
        Piece::cut(within, [], [Smoothness::Root { end: End::Lower, place, order: 2 }])
    }

    fn method(&self, _: usize) -> Method {
        Method::Contact
    }

    fn unstable_work(&self) -> f64 {
        let end = libm::cbrt(1.0 / 6.0);
        0.4 * end * end * self.scale.energy()
    }

    fn evaluate(&self, _: usize, lanes: Lanes<'_>, at: &[f64], out: &mut Responses, stats: &mut SolverStats) {
        let (lowest, count) = (self.branch.anchor().displacement, at.len());
        let (mut displacements, mut radius) = ([0.0; BLOCK], [0.0; BLOCK]);
        let (displacements, radius) = (&mut displacements[..count], &mut radius[..count]);
        lanes.displacements(&self.scale, 0.0, at, displacements);
        displacements.iter_mut().for_each(|displacement| *displacement = displacement.max(lowest));
        self.branch.solve_block(displacements, &mut out.adhesion, radius, stats);
        lanes.scale_contacts(&self.scale, radius, out);
    }
}
