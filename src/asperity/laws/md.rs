//! Maugis-Dugdale in contact, nothing before it.
//!
//! # Formula
//! See [`crate::asperity::contact`]; P = K a³/R, so that F = P − F_s is the external load of Maugis.
//!
//! # Validity
//! Elastic, dry spheres of every λ. Sources: Maugis, J. Colloid Interface Sci. 150 (1992) 243; for rough
//! surfaces Adams, Müftü and Mohd Azhar, J. Tribol. 125 (2003) 700, who leave out what acts before contact.

use crate::asperity::elastic;
use crate::asperity::emd::Emd;
use crate::asperity::error::LawError;
use crate::asperity::formula::Constant;
use crate::asperity::history::Path;
use crate::asperity::law::Method;
use crate::asperity::law::{BLOCK, End, Law, Regime, Responses, Smoothness};
use crate::asperity::parameters::LawParameters;
use crate::asperity::radius::{Lane, Lanes, Place};
use crate::asperity::scale::Scale;
use crate::asperity::stats::SolverStats;
use crate::asperity::table::{Interaction, PartOfRadii, Row, Table};
use crate::math::instruction_set::InstructionSet;
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

impl Interaction for MaugisContact {
    fn smoothness(&self, _: f64, _: f64) -> (Vec<f64>, Vec<Smoothness>) {
        (
            Vec::new(),
            vec![Smoothness::Root {
                end: End::Lower,
                place: self.emd.contact_fold() * self.scale.length,
                order: 2,
            }],
        )
    }

    fn method(&self) -> Method {
        Method::Contact
    }

    fn of_radii(&self) -> Option<&dyn PartOfRadii> {
        Some(self)
    }

    fn unstable_work(&self) -> f64 {
        self.emd.unstable_work() * self.scale.energy()
    }

    fn evaluate(&self, interference: &[f64], out: &mut Responses, stats: &mut SolverStats) {
        let inverse = 1.0 / self.scale.length;
        let count = interference.len();
        let (mut displacements, mut radius) = ([0.0; BLOCK], [0.0; BLOCK]);
        InstructionSet::current().run(
            #[inline(always)]
            || {
                for (displacement, &delta) in displacements.iter_mut().zip(interference) {
                    *displacement = delta * inverse;
                }
                self.emd.contact_block(&mut displacements[..count], &mut out.adhesion, &mut radius, stats);
                out.scale_contacts(&self.scale, &radius[..count]);
            },
        );
    }
}

impl PartOfRadii for MaugisContact {
    fn lambda(&self) -> Option<f64> {
        Some(self.scale.lambda)
    }

    fn smoothness_of(&self, lane: &Lane, _: f64, _: f64) -> (Vec<f64>, Vec<Smoothness>) {
        let place = lane.elastic.contact_fold() * (self.scale.length * lane.cube_root);
        (Vec::new(), vec![Smoothness::Root { end: End::Lower, place, order: 2 }])
    }

    fn evaluate_lanes(
        &self,
        lanes: Lanes<'_>,
        interference: &[f64],
        out: &mut Responses,
        stats: &mut SolverStats,
    ) {
        let count = interference.len();
        let inverse = 1.0 / self.scale.length;
        let Responses { adhesion, contact: displacements, area: radius } = &mut *out;
        let displacements = &mut displacements[..count];
        for (i, (displacement, delta)) in displacements.iter_mut().zip(interference).enumerate() {
            *displacement = delta * (inverse * lanes.at(i).per_cube_root);
        }
        elastic::contact(|i| &lanes.at(i).elastic, displacements, adhesion, radius, stats);
        lanes.scale_contacts(&self.scale, count, out);
    }
}
