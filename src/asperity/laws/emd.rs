//! The extended Maugis-Dugdale law of a lubricated elastic asperity.
//!
//! # Formula
//! By the interference δ, with δ_A = −Δ_end s_δ of the history (Shi and Polycarpou 2005, eq. 15):
//!
//! | regime | interval | F_s | P |
//! |---|---|---|---|
//! | noncontact | δ < −(t + δ_A) | extended Maugis-Dugdale at δ + t | 0 |
//! | lubricant | −(t + δ_A) ≤ δ < −δ_A | 2πRΔγ | 0 |
//! | elastic | −δ_A ≤ δ ≤ ω_c | Maugis-Dugdale | K a³/R of Maugis-Dugdale |
//!
//! Beyond ω_c it has no force.
//!
//! # Validity
//! Elastic spheres of all λ in 1e-6..1e6.

use super::md::MaugisContact;
use crate::asperity::block::Responses;
use crate::asperity::elastic;
use crate::asperity::emd::Emd;
use crate::asperity::error::LawError;
use crate::asperity::formula::Constant;
use crate::asperity::history::Path;
use crate::asperity::lane::{Lane, Lanes};
use crate::asperity::law::{End, Law, Method, Piece, RadiusDependence, Regime, Smoothness};
use crate::asperity::outline::{self, OutlinedSummit};
use crate::asperity::parameters::{InnerState, LawParameters};
use crate::asperity::radius::Place;
use crate::asperity::scale::Scale;
use crate::asperity::stats::SolverStats;
use crate::asperity::table::{Row, Table};
use crate::math::instruction_set::InstructionSet;
use std::ops::Range;
use std::sync::Arc;

/// The law `emd`.
///
/// # Errors
/// [`LawError`] for a λ that is not solved.
pub fn emd(parameters: &LawParameters) -> Result<Box<dyn Law>, LawError> {
    Ok(Box::new(Table::new(rows(parameters)?)))
}

/// The three rows of the law.
///
/// # Errors
/// [`LawError`] for a λ that is not solved.
pub fn rows(parameters: &LawParameters) -> Result<[Row; 3], LawError> {
    let ([attraction, lubricant], contact) = rows_before(parameters)?;
    let end = Place::proportional(parameters.critical_interference, 1.0);
    Ok([attraction, lubricant, Row::up_to(Regime::Elastic, end, contact)])
}

/// The two rows before contact, and the elastic contact.
///
/// # Errors
/// [`LawError`] for a λ that is not solved.
pub fn rows_before(parameters: &LawParameters) -> Result<([Row; 2], MaugisContact), LawError> {
    let attraction = Attraction::new(parameters)?;
    let contact = MaugisContact::of(Arc::clone(&attraction.emd), parameters);
    let rows = [
        Row::below(Regime::Noncontact, contact.begins(-parameters.lubricant_thickness), attraction),
        Row::below(Regime::Lubricant, contact.begins(0.0), Constant::lubricant(parameters)),
    ];
    Ok((rows, contact))
}

/// The noncontact branch, across the lubricant.
#[derive(Clone, Debug)]
pub struct Attraction {
    emd: Arc<Emd>,
    scale: Scale,
    path: Path,
    thickness: f64,
    inner_state: InnerState,
}

impl Attraction {
    /// The branch of a setting.
    ///
    /// # Errors
    /// [`LawError`] for a λ that is not solved.
    pub fn new(parameters: &LawParameters) -> Result<Self, LawError> {
        let LawParameters { scale, path, lubricant_thickness: thickness, inner_state, .. } = *parameters;
        let mut emd = Emd::new(scale.lambda, path)?;
        if inner_state == InnerState::Held {
            emd = emd.staying();
        }
        if let (Some((lowest, _)), Some(deepest)) =
            (parameters.table_range, parameters.deepest(parameters.critical_interference))
        {
            emd = emd.with_tables((lowest + thickness) / scale.length, deepest);
        }
        Ok(Self { emd: Arc::new(emd), scale, path, thickness, inner_state })
    }

    /// s_δ of an asperity, m.
    fn length(&self, lane: Option<&Lane>) -> f64 {
        lane.map_or(self.scale.length, |lane| self.scale.length * lane.cube_root)
    }

    fn is_held(&self) -> bool {
        self.inner_state == InnerState::Held
    }
}

impl Law for Attraction {
    fn radius_dependence(&self) -> RadiusDependence {
        RadiusDependence::Elastic(self.scale.lambda)
    }

    fn pieces_within(&self, _: usize, lane: Option<&Lane>, within: Range<f64>) -> Vec<Piece> {
        let (split, behind) = match lane.map(|lane| &lane.elastic) {
            None => (self.emd.noncontact_fold(), self.emd.fold_behind()),
            Some(elastic) => match elastic.inner_fold().filter(|_| self.is_held()) {
                None => (elastic.noncontact_fold(self.path), None),
                held => (held, elastic.noncontact_fold(self.path)),
            },
        };
        let place = |displacement: f64| displacement * self.length(lane) - self.thickness;
        let second = lane.and_then(|lane| lane.elastic.second_fold(self.path)).filter(|_| behind.is_none());
        pieces([split, second].map(|end| end.map(place)), behind.map(place), within)
    }

    fn kinks_of_summit(&self, _: usize, lane: &Lane, summit: &OutlinedSummit) -> Vec<f64> {
        let elastic = &lane.elastic;
        let held = summit.ends.inner.filter(|_| self.is_held()).map(|fold| fold.displacement);
        let jumps = [held, elastic.noncontact_fold(self.path), elastic.second_fold(self.path)];
        let place = |displacement: f64| displacement * self.length(Some(lane)) - self.thickness;
        jumps.into_iter().chain(summit.ends.edges_before).map(|kink| kink.map_or(f64::NAN, place)).collect()
    }

    fn capture(&self, lane: Option<&Lane>) -> Option<f64> {
        let fold = match lane.map(|lane| &lane.elastic) {
            None => self.emd.capture(),
            Some(elastic) => elastic.inner_fold().and(elastic.innermost_fold()),
        };
        let displacement = fold.filter(|_| self.inner_state != InnerState::Ignored)?;
        Some(displacement * self.length(lane) - self.thickness)
    }

    fn unstable_work(&self) -> f64 {
        match self.inner_state {
            InnerState::Ignored => 0.0,
            _ => self.emd.unstable_work_before() * self.scale.energy(),
        }
    }

    fn method(&self, _: usize) -> Method {
        Method::Noncontact { far: self.emd.far().map(|far| far * self.scale.length - self.thickness) }
    }

    fn evaluate(&self, _: usize, lanes: Lanes<'_>, at: &[f64], out: &mut Responses, stats: &mut SolverStats) {
        let count = at.len();
        let Responses { adhesion, contact, area } = out;
        area[..count].fill(0.0);
        // Where there is no load, its memory has the displacements.
        let displacements = &mut contact[..count];
        lanes.displacements(&self.scale, self.thickness, at, displacements);
        match lanes {
            Lanes::Own => InstructionSet::current().run(
                #[inline(always)]
                || {
                    self.emd.noncontact_block(displacements, adhesion, stats);
                    adhesion[..count].iter_mut().for_each(|adhesion| *adhesion *= self.scale.force);
                },
            ),
            Lanes::Each(each) if each.have_summits() => {
                let displacements = (&*displacements, self.is_held());
                outline::attractions(|i| each.summit(i), displacements, adhesion, stats);
                for (i, adhesion) in adhesion[..count].iter_mut().enumerate() {
                    *adhesion *= self.scale.force * each.at(i).ratio;
                }
            }
            Lanes::Each(each) => {
                let per_spacing = 1.0 / self.scale.equilibrium_spacing();
                let gap = |i: usize| 1.0 - (at[i] + self.thickness) * per_spacing;
                let displacements = (&*displacements, self.is_held());
                elastic::noncontact(|i| &each.at(i).elastic, gap, displacements, adhesion, stats);
                for (i, adhesion) in adhesion[..count].iter_mut().enumerate() {
                    *adhesion *= self.scale.force * each.at(i).ratio;
                }
            }
        }
        contact[..count].fill(0.0);
    }
}

/// The pieces of the attraction within an interval, m. It jumps from one branch to another at folds, the `split`s; if it jumps to the
/// outer branch, the fold of that is `behind`.
fn pieces(split: [Option<f64>; 2], behind: Option<f64>, within: Range<f64>) -> Vec<Piece> {
    let root = |end, place| Smoothness::Root { end, place, order: 2 };
    let splits = split.into_iter().flatten().filter(|place| within.start < *place && *place < within.end);
    let mut ends: Vec<f64> = splits.collect();
    ends.sort_by(f64::total_cmp);
    let mut smoothness: Vec<Smoothness> = ends.iter().map(|place| root(End::Upper, *place)).collect();
    smoothness.push(Smoothness::Smooth);
    if let (Some(behind), [place]) = (behind, ends.as_slice()) {
        smoothness = vec![root(End::Upper, behind), root(End::Lower, *place)];
    }
    Piece::cut(within, ends, smoothness)
}
