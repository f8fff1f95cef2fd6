//! Refits of asperities that differ in their radii.
//!
//! # Formula
//! Of the radius ρ, over that of the law, the forms are fitted to the law of λρ^(1/3) and ω_c ρ^(2/3) in scaled variables.
//! That is done for radii of which each is e^0.1 times the next smaller; between them the scaled forces of both
//! neighbours, at the same scaled displacement, are interpolated over ln ρ. δ_A, ω_c and the units are those of the radius.
//!
//! # Validity
//! A radius by itself would have a fit that differs from this by less than the fits differ from the law. Where
//! the forms cannot be fitted to a radius, the fit of the nearest towards that of the law takes its place.

use super::ORDER;
use super::forms::Coefficients;
use super::refit::{Direct, FITTED};
use crate::asperity::law::{End, Method, Responses, Smoothness};
use crate::asperity::parameters::LawParameters;
use crate::asperity::radius::{Lane, Lanes};
use crate::asperity::scale::Scale;
use crate::asperity::stats::SolverStats;
use crate::asperity::table::{Interaction, PartOfRadii};
use std::cmp::Ordering;
use std::f64::consts::PI;
use std::sync::{Arc, OnceLock};

/// ln ρ from one refit to the next.
const STEP: f64 = 0.1;
/// Refits to either side of that of the law.
const SIDE: usize = 160;

/// Refits to other radii, made when they are asked for.
#[derive(Debug)]
pub struct Refits {
    parameters: LawParameters,
    of_law: Coefficients,
    others: Vec<OnceLock<Coefficients>>,
}

impl Refits {
    /// Refits around that of a setting.
    pub fn new(parameters: &LawParameters, of_law: Coefficients) -> Self {
        let others = (0..=2 * SIDE).map(|_| OnceLock::new()).collect();
        Self { parameters: *parameters, of_law, others }
    }

    /// The coefficients of the refit that is so many steps from that of the law; each starts from the one before.
    fn of(&self, steps: i64) -> &Coefficients {
        let place = (steps + SIDE as i64).clamp(0, 2 * SIDE as i64) as usize;
        let towards = match place.cmp(&SIDE) {
            Ordering::Equal => return &self.of_law,
            Ordering::Less => 1,
            Ordering::Greater => -1,
        };
        if let Some(known) = self.others[place].get() {
            return known;
        }
        let steps = place as i64 - SIDE as i64;
        let similar = self.of(steps + towards);
        self.others[place].get_or_init(|| self.fit(steps, similar).unwrap_or(*similar))
    }

    fn fit(&self, steps: i64, similar: &Coefficients) -> Option<Coefficients> {
        let ratio = libm::exp(STEP * steps as f64);
        let scale = self.parameters.scale.of_ratio(ratio);
        let critical_interference = self.parameters.critical_interference * ratio;
        let parameters = LawParameters { scale, critical_interference, table_range: None, ..self.parameters };
        let coefficients = Direct::new(&parameters, FITTED).ok()?.fit_near(similar)?;
        coefficients.list().iter().all(|value| value.is_finite()).then_some(coefficients)
    }

    /// The neighbours of an asperity, and the share of the larger.
    fn around(&self, lane: &Lane) -> ([&Coefficients; 2], f64) {
        let place = lane.logarithm / STEP;
        let smaller = place.floor();
        ([self.of(smaller as i64), self.of(smaller as i64 + 1)], place - smaller)
    }
}

/// A fitted force.
#[derive(Clone, Copy, Debug)]
pub enum Force {
    /// f_snc, across a lubricant, m.
    Noncontact { thickness: f64 },
    /// f_sel and f_f.
    Contact,
}

/// A fitted part of the law.
pub struct Fitted {
    /// The part of the law.
    pub one: Box<dyn Interaction>,
    pub force: Force,
    pub scale: Scale,
    /// Refits to other radii, if there are any.
    pub refits: Option<Arc<Refits>>,
}

impl Interaction for Fitted {
    fn smoothness(&self, lower: f64, upper: f64) -> (Vec<f64>, Vec<Smoothness>) {
        self.one.smoothness(lower, upper)
    }

    fn method(&self) -> Method {
        self.one.method()
    }

    fn unstable_work(&self) -> f64 {
        self.one.unstable_work()
    }

    fn of_radii(&self) -> Option<&dyn PartOfRadii> {
        self.refits.as_ref().map(|_| self as &dyn PartOfRadii)
    }

    fn evaluate(&self, interference: &[f64], out: &mut Responses, stats: &mut SolverStats) {
        self.one.evaluate(interference, out, stats);
    }
}

impl Fitted {
    fn refits(&self) -> &Refits {
        self.refits.as_deref().expect("a part that follows the radius has refits")
    }
}

impl PartOfRadii for Fitted {
    fn lambda(&self) -> Option<f64> {
        Some(self.scale.lambda)
    }

    fn smoothness_of(&self, lane: &Lane, lower: f64, upper: f64) -> (Vec<f64>, Vec<Smoothness>) {
        if let Force::Noncontact { .. } = self.force {
            return (Vec::new(), vec![Smoothness::Smooth]);
        }
        let length = self.scale.length * lane.cube_root;
        let [smaller, larger] = self.refits().around(lane).0.map(|refit| refit.base_zero() * length);
        let mut roots = vec![smaller, larger, 0.0];
        roots.sort_by(f64::total_cmp);
        roots.dedup();
        let inside = |place: &f64| lower < *place && *place < upper;
        let ends: Vec<f64> = roots.iter().copied().filter(inside).collect();
        let of = |begin: f64| match roots.iter().rfind(|place| **place <= begin) {
            Some(place) => Smoothness::Root { end: End::Lower, place: *place, order: ORDER },
            None => Smoothness::Smooth,
        };
        let pieces = [lower].into_iter().chain(ends.iter().copied()).map(of).collect();
        (ends, pieces)
    }

    fn evaluate_lanes(
        &self,
        lanes: Lanes<'_>,
        interference: &[f64],
        out: &mut Responses,
        _: &mut SolverStats,
    ) {
        let area_unit = PI * self.scale.radius * self.scale.radius;
        for (i, delta) in interference.iter().enumerate() {
            let lane = lanes.at(i);
            let ([smaller, larger], share) = self.refits().around(lane);
            let between = |of: &dyn Fn(&Coefficients) -> f64| {
                let (low, high) = (of(smaller), of(larger));
                low + share * (high - low)
            };
            let (length, force) = (self.scale.length * lane.cube_root, self.scale.force * lane.ratio);
            match self.force {
                Force::Noncontact { thickness } => {
                    let x = (delta + thickness) / length;
                    out.adhesion[i] = force * between(&|refit| refit.noncontact(x));
                    (out.contact[i], out.area[i]) = (0.0, 0.0);
                }
                Force::Contact => {
                    let x = delta / length;
                    let adhesion = between(&|refit| refit.adhesion(x));
                    let load = if x < 0.0 { 0.0 } else { adhesion + between(&|refit| refit.external(x)) };
                    (out.adhesion[i], out.contact[i]) = (force * adhesion, force * load);
                    out.area[i] = area_unit * (lane.ratio * lane.cube_root) * x.max(0.0);
                }
            }
        }
    }
}
