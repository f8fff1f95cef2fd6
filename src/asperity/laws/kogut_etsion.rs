//! Elastic-plastic contact by the fits of Kogut and Etsion to finite elements.
//!
//! # Formula
//! With x = ω/ω_c, ε = Z₀ and P_c = (2/3)πkHRω_c, which is the Hertz load at ω_c:
//!
//! | x | P/P_c | contact area/πRω_c | F_s/2πRΔγ |
//! |---|---|---|---|
//! | 0..1 | x^1.5 | x | 0.98 x^0.298 (ε/ω_c)^−0.29 |
//! | 1..6 | 1.03 x^1.425 | 0.93 x^1.136 | 0.79 x^0.356 (ε/ω_c)^−0.321 |
//! | 6..110 | 1.40 x^1.263 | 0.94 x^1.146 | 1.19 x^0.093 (ε/ω_c)^−0.332 |
//! | above | 3x/k | 2x | 0 |
//!
//! Before contact the law `ke` takes the attraction of [`super::idmt`].
//!
//! # Validity
//! Published fits for low λ; they jump at the joints (P by +3.0 % at x = 1 and +1.7 % at 6), begin without
//! adhesion at x = 0 where the attraction ends with 2πRΔγ, and are reproduced with their jumps. Sources:
//! Kogut and Etsion, J. Appl. Mech. 69 (2002) 657 (loads, areas); J. Colloid Interface Sci. 261 (2003) 372
//! (adhesion).

use super::idmt;
use crate::asperity::error::LawError;
use crate::asperity::formula::{ClosedForm, Formula, Tabulated, Zero};
use crate::asperity::law::{Law, Regime};
use crate::asperity::parameters::LawParameters;
use crate::asperity::radius::{Place, Similarity};
use crate::asperity::table::{Row, Table};
use std::f64::consts::PI;

/// x at the upper ends of the two elastic-plastic regimes.
pub const ENDS: [f64; 2] = [6.0, 110.0];
/// Factors and exponents of P/P_c in these.
const FIRST_LOAD: (f64, f64) = (1.03, 1.425);
const SECOND_LOAD: (f64, f64) = (1.40, 1.263);
/// The force x^0.298 is no power series in any root of δ; in the tenth what is left is too smooth to matter.
const ELASTIC_ORDER: i32 = 10;
/// Loads and areas are those at ω_c, which are proportional to R² as ω_c is to R, times functions of δ/ω_c.
pub const OF_CRITICAL: Similarity = Similarity::new(1.0, 2.0);
/// Relative accuracy of tabulated powers: a few roundings, as in a library's power and a product.
const TABLE_TOLERANCE: f64 = 2e-15;

/// The law `ke`.
///
/// # Errors
/// [`LawError::Elastic`] without a critical interference.
pub fn ke(parameters: &LawParameters) -> Result<Box<dyn Law>, LawError> {
    parameters.plastic("ke")?;
    let before = Row::below(Regime::Noncontact, 0.0, idmt::attraction(parameters, 0.0));
    Ok(Box::new(Table::new([before].into_iter().chain(contact_rows(parameters)))))
}

/// The contact without adhesion whose loads pass from one fit to the next where both are equal, with the areas of the same fits.
///
/// # Errors
/// As [`ke`].
pub fn meeting_fits(parameters: &LawParameters) -> Result<Box<dyn Law>, LawError> {
    parameters.plastic("ke")?;
    let critical = Critical::new(parameters);
    let last = 3.0 / parameters.pressure_factor;
    let ends = [[FIRST_LOAD, SECOND_LOAD], [SECOND_LOAD, (last, 1.0)]]
        .map(|[(factor, power), (next, of_next)]| libm::pow(next / factor, 1.0 / (power - of_next)));
    let before = Row::below(Regime::Noncontact, 0.0, ClosedForm::new(Zero, Zero, Zero));
    let rows = [before, critical.elastic(Zero, 2)].into_iter();
    Ok(Box::new(Table::new(rows.chain(critical.plastic(ends, Zero, Zero, Zero)))))
}

/// The four rows of contact.
pub fn contact_rows(parameters: &LawParameters) -> impl Iterator<Item = Row> + use<> {
    let critical = Critical::new(parameters);
    let pull = critical.pull(0.98, -0.29, 0.298, (0.0, 1.0));
    let elastic = critical.elastic(pull, ELASTIC_ORDER);
    [elastic].into_iter().chain(plastic_rows(parameters))
}

/// The three rows above ω_c.
pub fn plastic_rows(parameters: &LawParameters) -> [Row; 3] {
    let critical = Critical::new(parameters);
    let first = critical.pull(0.79, -0.321, 0.356, (1.0, ENDS[0]));
    let second = critical.pull(1.19, -0.332, 0.093, (ENDS[0], ENDS[1]));
    critical.plastic(ENDS, first, second, Zero)
}

/// The contact of an asperity in units of that at ω_c.
pub struct Critical<'a> {
    parameters: &'a LawParameters,
    /// 1/ω_c, 1/m.
    per_length: f64,
    /// P_c, N.
    pub load: f64,
    /// πRω_c, m².
    pub disc: f64,
}

impl<'a> Critical<'a> {
    /// The units of a setting.
    pub fn new(parameters: &'a LawParameters) -> Self {
        let scaled = parameters.critical_interference / parameters.scale.length;
        Self {
            parameters,
            per_length: 1.0 / parameters.critical_interference,
            load: parameters.scale.force * scaled * scaled.sqrt(),
            disc: PI * parameters.scale.radius * parameters.scale.radius * scaled,
        }
    }

    /// 2πRΔγ · factor (ε/ω_c)^spacing x^exponent in a regime of x; ω_c ∝ R.
    fn pull(&self, factor: f64, spacing: f64, exponent: f64, x: (f64, f64)) -> impl Formula + use<> {
        let ratio = self.parameters.scale.equilibrium_spacing() / self.parameters.critical_interference;
        let factor = 2.0 * self.parameters.scale.force * libm::pow(ratio, spacing) * factor;
        self.power(factor, exponent, x).following(Similarity::new(1.0, 1.0 - spacing))
    }

    /// factor · x^exponent in a regime of x.
    fn power(&self, factor: f64, exponent: f64, x: (f64, f64)) -> impl Formula + use<> {
        self.tabulated(move |x: f64| factor * libm::pow(x, exponent), TABLE_TOLERANCE, x)
    }

    /// A function of x that is tabulated to a relative tolerance in a regime of x.
    pub fn tabulated<F: Fn(f64) -> f64 + Clone + Send + Sync + 'static>(
        &self,
        function: F,
        tolerance: f64,
        (begin, end): (f64, f64),
    ) -> impl Formula + use<F> {
        let deepest =
            self.parameters.table_range.map(|(_, deepest)| deepest / self.parameters.critical_interference);
        let end = deepest.map_or(begin, |deepest| end.min(deepest));
        Tabulated::new(1.0, self.per_length, function, tolerance, (begin, end))
    }

    /// factor · x.
    pub fn multiple(&self, factor: f64) -> impl Formula + use<> {
        let per_length = self.per_length;
        (move |delta: f64| factor * (delta * per_length)).following(OF_CRITICAL)
    }

    /// The row up to ω_c, with its adhesion, which is smooth in (δ/ω_c)^(1/order).
    pub fn elastic(&self, adhesion: impl Formula, order: i32) -> Row {
        let load = self.power(self.load, 1.5, (0.0, 1.0)).following(OF_CRITICAL);
        let contact = ClosedForm::new(adhesion, load, self.multiple(self.disc)).with_root(0.0, order);
        Row::up_to(Regime::Elastic, Place::proportional(self.parameters.critical_interference, 1.0), contact)
    }

    /// The rows above ω_c, each with its adhesion; the first two end at an x.
    pub fn plastic(
        &self,
        ends: [f64; 2],
        first: impl Formula,
        second: impl Formula,
        last: impl Formula,
    ) -> [Row; 3] {
        let (critical, x) = (self.parameters.critical_interference, [(1.0, ends[0]), (ends[0], ends[1])]);
        let power = |factor, exponent, x| self.power(factor, exponent, x).following(OF_CRITICAL);
        let loads = (
            power(self.load * FIRST_LOAD.0, FIRST_LOAD.1, x[0]),
            power(self.load * SECOND_LOAD.0, SECOND_LOAD.1, x[1]),
        );
        let areas = (power(self.disc * 0.93, 1.136, x[0]), power(self.disc * 0.94, 1.146, x[1]));
        let plastic = (
            self.multiple(self.load * (3.0 / self.parameters.pressure_factor)),
            self.multiple(self.disc * 2.0),
        );
        [
            Row::up_to(
                Regime::Elastoplastic1,
                Place::proportional(ends[0] * critical, 1.0),
                ClosedForm::new(first, loads.0, areas.0),
            ),
            Row::up_to(
                Regime::Elastoplastic2,
                Place::proportional(ends[1] * critical, 1.0),
                ClosedForm::new(second, loads.1, areas.1),
            ),
            Row::last(Regime::Plastic, ClosedForm::new(last, plastic.0, plastic.1)),
        ]
    }
}
