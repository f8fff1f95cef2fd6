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
//! Published fits for low λ; they jump at the joints (P by +3.0 % at x = 1 and +1.7 % at 6), begin without adhesion at x = 0 where
//! the attraction ends with 2πRΔγ, and are reproduced with their jumps. Sources: Kogut and Etsion, J. Appl. Mech. 69 (2002) 657
//! (loads, areas); J. Colloid Interface Sci. 261 (2003) 372 (adhesion).

use super::idmt::LennardJones;
use crate::asperity::table::{Part, Row, Table};
use crate::asperity::{BLOCK, End, Law, LawError, Regime, Responses, Setting, Smoothness, Work};
use crate::math::instruction_set::InstructionSet;
use crate::math::piecewise::Piecewise;
use std::f64::consts::PI;

/// x at the upper end of the first elastic-plastic regime.
pub const FIRST_END: f64 = 6.0;
/// x at the upper end of the second elastic-plastic regime.
pub const SECOND_END: f64 = 110.0;
/// The force x^0.298 is no power series in any root of δ; in the tenth what is left is too smooth to matter.
const ELASTIC_ORDER: i32 = 10;

/// The law `ke`.
///
/// # Errors
/// [`LawError::Elastic`] without a critical interference.
pub fn ke(setting: &Setting) -> Result<Box<dyn Law>, LawError> {
    setting.plastic("ke")?;
    let before = Row::below(Regime::Noncontact, 0.0, LennardJones::dry(setting));
    Ok(Box::new(Table::new([before].into_iter().chain(contact_rows(setting)))))
}

/// The four rows of contact.
pub fn contact_rows(setting: &Setting) -> impl Iterator<Item = Row> {
    let elastic = Row::up_to(Regime::Elastic, setting.critical_interference, Powers::elastic(setting));
    [elastic].into_iter().chain(plastic_rows(setting))
}

/// The three rows above ω_c.
pub fn plastic_rows(setting: &Setting) -> [Row; 3] {
    let critical = setting.critical_interference;
    let [first, second, plastic] = Powers::above_critical(setting);
    [
        Row::up_to(Regime::Elastoplastic1, FIRST_END * critical, first),
        Row::up_to(Regime::Elastoplastic2, SECOND_END * critical, second),
        Row::last(Regime::Plastic, plastic),
    ]
}

/// Forces and area of a regime as powers of x.
#[derive(Clone, Debug)]
pub struct Powers {
    inverse_critical: f64,
    adhesion: Power,
    contact: Power,
    area: Power,
    elastic: bool,
}

impl Powers {
    /// The regime up to ω_c.
    pub fn elastic(setting: &Setting) -> Self {
        Self { elastic: true, ..Self::new(setting, (0.0, 1.0), (0.98, 0.298, -0.29), (1.0, 1.5), (1.0, 1.0)) }
    }

    /// The three regimes above ω_c.
    pub fn above_critical(setting: &Setting) -> [Self; 3] {
        let factor = 3.0 / setting.pressure_factor;
        [
            Self::new(setting, (1.0, FIRST_END), (0.79, 0.356, -0.321), (1.03, 1.425), (0.93, 1.136)),
            Self::new(setting, (FIRST_END, SECOND_END), (1.19, 0.093, -0.332), (1.40, 1.263), (0.94, 1.146)),
            Self::new(setting, (SECOND_END, f64::INFINITY), (0.0, 0.0, 0.0), (factor, 1.0), (2.0, 1.0)),
        ]
    }

    /// The same loads and areas without adhesion.
    pub fn without_adhesion(self) -> Self {
        Self { adhesion: Power::new(0.0, 0.0, (0.0, 0.0)), ..self }
    }

    /// `x` is the regime's interval; adhesion has a factor, an exponent and the exponent of ε/ω_c, the others factor and exponent.
    fn new(setting: &Setting, x: (f64, f64), adhesion: (f64, f64, f64), contact: (f64, f64), area: (f64, f64)) -> Self {
        let critical = setting.critical_interference;
        let scaled = critical / setting.scale.length;
        let load = setting.scale.force * scaled * scaled.sqrt();
        let disc = PI * setting.scale.radius * setting.scale.radius * scaled;
        let ratio = setting.scale.equilibrium_spacing() / critical;
        let pull = 2.0 * setting.scale.force * libm::pow(ratio, adhesion.2);
        let reach = (x.0, setting.reach.map_or(x.0, |(_, deepest)| x.1.min(deepest / critical)));
        Self {
            inverse_critical: 1.0 / critical,
            adhesion: Power::new(pull * adhesion.0, adhesion.1, reach),
            contact: Power::new(load * contact.0, contact.1, reach),
            area: Power::new(disc * area.0, area.1, reach),
            elastic: false,
        }
    }
}

/// Factor · x^exponent.
#[derive(Clone, Debug)]
struct Power {
    factor: f64,
    exponent: f64,
    /// The whole, for exponents that take more than a product.
    table: Piecewise,
}

/// Relative accuracy of tabulated powers: a few roundings, as those of a library's power and of a product.
const TABLE_TOLERANCE: f64 = 2e-15;

impl Power {
    /// With a table for x in the interval `reach`.
    fn new(factor: f64, exponent: f64, reach: (f64, f64)) -> Self {
        let mut power = Self { factor, exponent, table: Piecewise::default() };
        if exponent != 0.0 && exponent != 1.0 {
            power.table = Piecewise::new(|x| power.value(x), |_, value| TABLE_TOLERANCE * value, reach.0, reach.1);
        }
        power
    }

    fn value(&self, x: f64) -> f64 {
        self.factor * libm::pow(x, self.exponent)
    }

    /// The values at places x > 0.
    #[inline(always)]
    fn values(&self, places: &[f64], out: &mut [f64]) {
        if self.exponent == 0.0 {
            out.fill(self.factor);
        } else if self.exponent == 1.0 {
            out.iter_mut().zip(places).for_each(|(value, x)| *value = self.factor * x);
        } else {
            self.table.values(places, out);
            if out.iter().fold(false, |any, value| any | value.is_nan()) {
                let missing = out.iter_mut().zip(places).filter(|(value, _)| value.is_nan());
                missing.for_each(|(value, x)| *value = self.value(*x));
            }
        }
    }
}

impl Part for Powers {
    fn smoothness(&self, lower: f64, _: f64) -> (Vec<f64>, Vec<Smoothness>) {
        let smoothness = if self.elastic {
            Smoothness::Root { end: End::Lower, place: lower, order: ELASTIC_ORDER }
        } else {
            Smoothness::Smooth
        };
        (Vec::new(), vec![smoothness])
    }

    fn cost(&self) -> f64 {
        if self.contact.exponent == 1.0 { 1.0 } else { 4.0 }
    }

    fn evaluate(&self, interference: &[f64], out: &mut Responses, work: &mut Work) {
        let count = interference.len();
        let mut places = [0.0; BLOCK];
        let places = &mut places[..count];
        InstructionSet::current().run(
            #[inline(always)]
            || {
                places.iter_mut().zip(interference).for_each(|(x, delta)| *x = delta * self.inverse_critical);
                self.adhesion.values(places, &mut out.adhesion[..count]);
                self.contact.values(places, &mut out.contact[..count]);
                self.area.values(places, &mut out.area[..count]);
            },
        );
        work.closed_form += count as u64;
    }
}
