//! The unloading of an elastic-plastic contact as it is published, without adhesion, and the elastic contact that it is compared with.
//!
//! # Formula
//! With x = ω_max/ω_c and the residual interference ω_res (Etsion, Kligerman and Kadin 2005)
//!
//! ω_res/ω_max = (1 − x^−0.28)(1 − x^−0.69), P/P_max = r^(1.5 x^−0.0331), A/A_max = r^(x^−0.12),
//! r = (δ − ω_res)/(ω_max − ω_res),
//!
//! with P_max and A_max of the law on approach at ω_max. At x = 1 that is Hertz's contact. An asperity
//! springs back by its recovery, ω_max − ω_res = ω_c (x^0.72 + x^0.31 − x^0.03).

use super::block::{BLOCK, Responses};
use crate::math::instruction_set::InstructionSet;
use crate::math::piecewise::Piecewise;
use crate::math::roots::{Sample, safe_newton};
use std::sync::Arc;

/// Exponents of x in the recovery over ω_c, and their signs.
const RECOVERY: [(f64, f64); 3] = [(0.72, 1.0), (0.31, 1.0), (0.03, -1.0)];
/// Exponent of the load over r at x = 1, and that of x in it.
const LOAD: (f64, f64) = (1.5, -0.0331);
/// Exponent of x in the exponent of the area over r.
const AREA: f64 = -0.12;
/// Relative accuracy of tables: a few roundings, as in a library's exponentials.
const TABLE_TOLERANCE: f64 = 2e-15;

/// The unloading of contacts of one critical interference.
#[derive(Clone)]
pub(super) struct PlasticUnloading {
    /// ω_c, m.
    critical: f64,
    tables: Arc<Tables>,
}

/// Recovery over ω_c and the exponents of r in load and area, over x.
struct Tables {
    recovery: OfDepth,
    load_exponent: OfDepth,
    area_exponent: OfDepth,
}

impl PlasticUnloading {
    /// The unloading from interferences that are expected up to `deepest`, m.
    pub fn new(critical: f64, deepest: Option<f64>) -> Self {
        let deepest = deepest.map_or(1.0, |deepest| deepest / critical);
        let tables = Tables {
            recovery: OfDepth::new(scaled_recovery, deepest),
            load_exponent: OfDepth::new(|x| LOAD.0 * power(x, LOAD.1), deepest),
            area_exponent: OfDepth::new(|x| power(x, AREA), deepest),
        };
        Self { critical, tables: Arc::new(tables) }
    }

    /// The unloading of contacts of `ratio` times the radius, to which ω_c is proportional.
    pub fn of_radius(&self, ratio: f64) -> Self {
        Self { critical: ratio * self.critical, tables: Arc::clone(&self.tables) }
    }

    /// The recovery, m, from an interference ω_max, m, above ω_c.
    pub fn recovery(&self, largest: f64) -> f64 {
        self.critical * scaled_recovery(largest / self.critical)
    }

    /// The recoveries, m, of interferences ω_max, m, above ω_c, at most [`BLOCK`], from the table.
    pub fn recoveries(&self, largest: &[f64], out: &mut [f64]) {
        self.depths(largest, |places| self.tables.recovery.values(places, out));
        out.iter_mut().for_each(|recovery| *recovery *= self.critical);
    }

    /// The slope of the recovery over ω_max.
    pub fn slope(&self, largest: f64) -> f64 {
        let x = largest / self.critical;
        RECOVERY.iter().map(|(exponent, sign)| sign * exponent * power(x, exponent - 1.0)).sum()
    }

    /// The ω_max, m, of a recovery, m; below ω_c continued with its slope there, which is 1.
    pub fn recovered_from(&self, recovery: f64) -> f64 {
        let wanted = recovery / self.critical;
        if !(wanted > 1.0) || wanted.is_infinite() {
            return recovery;
        }
        // All terms but the first are not negative in sum.
        let highest = libm::pow(wanted, 1.0 / RECOVERY[0].0) * (1.0 + 1e-12);
        let f = |x: f64| {
            let log = libm::log(x);
            let powers = RECOVERY.map(|(exponent, sign)| sign * libm::exp(exponent * log));
            let slope: f64 = powers.iter().zip(RECOVERY).map(|(power, (exponent, _))| exponent * power).sum();
            Sample { value: wanted - powers.iter().sum::<f64>(), slope: -slope / x }
        };
        let close = |_: f64, sample: Sample| sample.value.abs() <= 2.0 * f64::EPSILON * wanted;
        self.critical * safe_newton(f, 1.0, highest, wanted, close).x
    }

    /// Makes of the loads and areas at interferences ω_max, m, those at a distance, m, of each from there.
    pub fn unload(&self, largest: &[f64], distance: impl Fn(usize) -> f64, out: &mut Responses) {
        let ([mut recovery, mut load, mut area], count) = ([[0.0; BLOCK]; 3], largest.len());
        self.depths(largest, |places| {
            self.tables.recovery.values(places, &mut recovery[..count]);
            self.tables.load_exponent.values(places, &mut load[..count]);
            self.tables.area_exponent.values(places, &mut area[..count]);
        });
        for i in 0..count {
            let recovery = self.critical * recovery[i];
            let ratio = libm::log(((recovery - distance(i)) / recovery).max(0.0));
            out.contact[i] *= libm::exp(load[i] * ratio);
            out.area[i] *= libm::exp(area[i] * ratio);
        }
    }

    /// The shares ω_res/ω_max of interferences ω_max, m, above ω_c, and in the place of `distances` from there, m, the
    /// interferences, m, at which an elastic contact is as far on its way from ω_c; beyond the recovery what is left of the
    /// distance, negative.
    pub fn elastic_places(&self, largest: &[f64], shares: &mut [f64], distances: &mut [f64]) {
        self.recoveries(largest, shares);
        for ((share, place), largest) in shares.iter_mut().zip(distances).zip(largest) {
            let (recovery, own) = (*share, *share - *place);
            *share = 1.0 - recovery / largest;
            *place = if own > 0.0 { own * self.critical / recovery } else { own };
        }
    }

    /// Hands over x of interferences ω_max, m.
    fn depths(&self, largest: &[f64], mut visit: impl FnMut(&[f64])) {
        let mut places = [0.0; BLOCK];
        let places = &mut places[..largest.len()];
        places.iter_mut().zip(largest).for_each(|(x, largest)| *x = largest / self.critical);
        visit(places);
    }
}

/// x^exponent.
fn power(x: f64, exponent: f64) -> f64 {
    libm::exp(exponent * libm::log(x))
}

/// (ω_max − ω_res)/ω_c at x.
fn scaled_recovery(x: f64) -> f64 {
    let log = libm::log(x);
    RECOVERY.iter().map(|(exponent, sign)| sign * libm::exp(exponent * log)).sum()
}

/// A function of x with a table from 1 to the deepest interference that is expected.
struct OfDepth {
    exact: fn(f64) -> f64,
    table: Piecewise,
}

impl OfDepth {
    /// The table of a function.
    fn new(exact: fn(f64) -> f64, deepest: f64) -> Self {
        Self { exact, table: Piecewise::new(exact, |_, value| TABLE_TOLERANCE * value, 1.0, deepest) }
    }

    /// The values at places x.
    fn values(&self, places: &[f64], out: &mut [f64]) {
        InstructionSet::current().run(
            #[inline(always)]
            || self.table.values(places, out),
        );
        let missing = out.iter_mut().zip(places).filter(|(value, _)| value.is_nan());
        missing.for_each(|(value, x)| *value = (self.exact)(*x));
    }
}
