//! Maugis-Dugdale in contact, nothing before it.
//!
//! # Formula
//! See [`crate::asperity::contact`]; P = K a³/R, so that F = P − F_s is the external load of Maugis.
//!
//! # Validity
//! Elastic, dry spheres of every λ. Sources: Maugis, J. Colloid Interface Sci. 150 (1992) 243; for rough
//! surfaces Adams, Müftü and Mohd Azhar, J. Tribol. 125 (2003) 700, who leave out what acts before contact.

use crate::asperity::block::{BLOCK, Responses};
use crate::asperity::elastic;
use crate::asperity::emd::Emd;
use crate::asperity::error::LawError;
use crate::asperity::formula::Constant;
use crate::asperity::history::Path;
use crate::asperity::lane::{Lane, Lanes};
use crate::asperity::law::{End, Law, Method, Piece, RadiusDependence, Regime, Smoothness};
use crate::asperity::outline::{self, OutlinedSummit};
use crate::asperity::parameters::LawParameters;
use crate::asperity::radius::Place;
use crate::asperity::scale::Scale;
use crate::asperity::stats::SolverStats;
use crate::asperity::table::{Row, Table};
use crate::math::instruction_set::InstructionSet;
use std::ops::Range;
use std::sync::Arc;

/// The law `md`.
///
/// # Errors
/// [`LawError`] for a λ that is not solved.
pub fn md(parameters: &LawParameters) -> Result<Box<dyn Law>, LawError> {
    let contact = MaugisContact::new(parameters, f64::INFINITY)?;
    Ok(Box::new(Table::new([
        Row::below(Regime::Noncontact, contact.begins(0.0), Constant::NOTHING),
        Row::last(Regime::Elastic, contact),
    ])))
}

/// The contact branch.
#[derive(Clone, Debug)]
pub struct MaugisContact {
    emd: Arc<Emd>,
    scale: Scale,
    path: Path,
}

impl MaugisContact {
    /// The branch of a setting, with starting tables up to the interference `end`, m.
    ///
    /// # Errors
    /// [`LawError`] for a λ that is not solved.
    pub fn new(parameters: &LawParameters, end: f64) -> Result<Self, LawError> {
        let mut emd = Emd::new(parameters.scale.lambda, parameters.path)?;
        if let Some(deepest) = parameters.deepest(end) {
            emd = emd.with_contact_table(deepest);
        }
        Ok(Self::of(Arc::new(emd), parameters))
    }

    /// The branch of a solver.
    pub fn of(emd: Arc<Emd>, parameters: &LawParameters) -> Self {
        Self { emd, scale: parameters.scale, path: parameters.path }
    }

    /// Interference at which contact begins on approach or ends on retraction, −δ_A, m.
    pub fn begin(&self) -> f64 {
        self.emd.end() * self.scale.length
    }

    /// The end of the regime before it, m, of any radius: where it begins, plus `offset`, m.
    pub fn begins(&self, offset: f64) -> Place {
        Place::elastic(self.begin() + offset, self.path, self.scale.length, (f64::NEG_INFINITY, offset))
    }
}

impl Law for MaugisContact {
    fn radius_dependence(&self) -> RadiusDependence {
        RadiusDependence::Elastic(self.scale.lambda)
    }

    fn pieces_within(&self, _: usize, lane: Option<&Lane>, within: Range<f64>) -> Vec<Piece> {
        let place = match lane {
            None => self.emd.contact_fold() * self.scale.length,
            Some(lane) => lane.elastic.contact_fold() * (self.scale.length * lane.cube_root),
        };
        Piece::cut(within, [], [Smoothness::Root { end: End::Lower, place, order: 2 }])
    }

    fn kinks_of_summit(&self, _: usize, lane: &Lane, summit: &OutlinedSummit) -> Vec<f64> {
        vec![summit.ends.edge * (self.scale.length * lane.cube_root)]
    }

    fn method(&self, _: usize) -> Method {
        Method::Contact
    }

    fn unstable_work(&self) -> f64 {
        self.emd.unstable_work() * self.scale.energy()
    }

    fn evaluate(&self, _: usize, lanes: Lanes<'_>, at: &[f64], out: &mut Responses, stats: &mut SolverStats) {
        let count = at.len();
        let (mut displacements, mut radius) = ([0.0; BLOCK], [0.0; BLOCK]);
        let (displacements, radius) = (&mut displacements[..count], &mut radius[..count]);
        lanes.displacements(&self.scale, 0.0, at, displacements);
        match lanes {
            Lanes::Own => InstructionSet::current().run(
                #[inline(always)]
                || {
                    self.emd.contact_block(displacements, &mut out.adhesion, radius, stats);
                    lanes.scale_contacts(&self.scale, radius, out);
                },
            ),
            Lanes::Each(each) if each.have_summits() => {
                outline::contacts(|i| each.summit(i), displacements, &mut out.adhesion, radius, stats);
                lanes.scale_contacts(&self.scale, radius, out);
            }
            Lanes::Each(each) => {
                elastic::contact(|i| &each.at(i).elastic, displacements, &mut out.adhesion, radius, stats);
                lanes.scale_contacts(&self.scale, radius, out);
            }
        }
    }
}
