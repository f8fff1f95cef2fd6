//! Folds of the branches of the Maugis-Dugdale equations, by the adhesion parameter λ, from tables: finding a
//! fold takes hundreds of evaluations, and every radius has folds of its own.

use super::contact::Contact;
use super::noncontact::Noncontact;
use super::scale::LAMBDA_RANGE;
use crate::math::piecewise::Piecewise;
use std::f64::consts::FRAC_PI_2;
use std::sync::LazyLock;

/// Relative accuracy of the tables. At a fold Δ has no slope, so that the error of Δ is of the order of the square of this.
const TOLERANCE: f64 = 1e-12;
/// The first λ at which the branch before contact folds is between these.
const FIRST_OUTER: (f64, f64) = (0.888, 0.889);
/// The first λ at which the contact branch folds is between these.
const FIRST_CONTACT: (f64, f64) = (0.937, 0.938);

/// A function of one variable.
type Map = fn(f64) -> f64;

/// Folds over the logarithm of λ/λ_first, or over its root where the fold begins like one.
struct Folds {
    first: f64,
    table: Piecewise,
}

impl Folds {
    /// The folds that a function finds from a λ between two on. The two maps lead from ln(λ/λ_first) to the variable of the table,
    /// and back.
    fn new(
        find: fn(f64) -> Option<f64>,
        (mut without, mut with): (f64, f64),
        (variable, logarithm): (Map, Map),
        last: f64,
    ) -> Self {
        while 0.5 * (without + with) > without && 0.5 * (without + with) < with {
            let middle = 0.5 * (without + with);
            *(if find(middle).is_some() { &mut with } else { &mut without }) = middle;
        }
        let at = |v: f64| find(with * libm::exp(logarithm(v))).unwrap_or(f64::NAN);
        let end = variable(libm::log(last / with));
        Self { first: with, table: Piecewise::new(at, |_, fold| TOLERANCE * fold, 0.0, end) }
    }

    /// The fold at λ, if there is one, in the variable v of λ/λ_first.
    fn at(&self, lambda: f64, variable: Map) -> Option<f64> {
        if lambda < self.first {
            return None;
        }
        let mut fold = [f64::NAN];
        self.table.values(&[variable(libm::log(lambda / self.first))], &mut fold);
        Some(fold[0])
    }
}

fn same(v: f64) -> f64 {
    v
}

fn square(v: f64) -> f64 {
    v * v
}

static OUTER: LazyLock<Folds> =
    LazyLock::new(|| Folds::new(Noncontact::outer_fold_of, FIRST_OUTER, (f64::sqrt, square), LAMBDA_RANGE.1));

static INNER: LazyLock<Folds> = LazyLock::new(|| {
    Folds::new(Noncontact::inner_fold_of, FIRST_OUTER, (f64::sqrt, square), FIRST_CONTACT.1)
});

static CONTACT: LazyLock<Folds> = LazyLock::new(|| {
    let find = |lambda: f64| Some(Contact::new(lambda).end()).filter(|end| *end < FRAC_PI_2);
    Folds::new(find, FIRST_CONTACT, (same, same), LAMBDA_RANGE.1)
});

/// The least λ at which the branch before contact folds.
pub fn first_outer() -> f64 {
    OUTER.first
}

/// The least λ at which the contact branch folds.
pub fn first_contact() -> f64 {
    CONTACT.first
}

/// ε at the outer fold of the branch before contact, if there is one, as [`Noncontact::outer_fold_of`] finds it.
pub fn outer_fold(lambda: f64) -> Option<f64> {
    if lambda < FIRST_OUTER.0 {
        return None;
    }
    let fold = OUTER.at(lambda, f64::sqrt)?;
    if fold.is_nan() { Noncontact::outer_fold_of(lambda) } else { Some(fold) }
}

/// ε at the inner fold of the branch before contact where contact leads to it: where there is one, and the contact branch has
/// no fold. Of larger λ contact is lost before, by a jump.
pub fn inner_fold(lambda: f64) -> Option<f64> {
    if lambda < FIRST_OUTER.0 || lambda >= first_contact() {
        return None;
    }
    let fold = INNER.at(lambda, f64::sqrt)?;
    if fold.is_nan() { Noncontact::inner_fold_of(lambda) } else { Some(fold) }
}

/// θ at the end of the stable contact branch: π/2, or the fold, as [`Contact::new`] finds it.
pub fn contact_end(lambda: f64) -> f64 {
    if lambda < FIRST_CONTACT.0 {
        return FRAC_PI_2;
    }
    match CONTACT.at(lambda, same) {
        None => FRAC_PI_2,
        Some(fold) if fold.is_nan() => Contact::new(lambda).end(),
        Some(fold) => fold,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_have_what_is_found() {
        for i in 0..440 {
            let lambda = libm::exp(if i < 40 {
                -0.12 + 0.0015 * f64::from(i)
            } else {
                -0.2 + 0.035 * f64::from(i - 40)
            });
            assert_eq!(outer_fold(lambda).is_some(), Noncontact::outer_fold_of(lambda).is_some(), "{lambda}");
            if let (Some(table), Some(found)) = (outer_fold(lambda), Noncontact::outer_fold_of(lambda)) {
                assert!((table / found - 1.0).abs() < 1e-10, "{lambda}: {table} {found}");
            }
            let found = Noncontact::inner_fold_of(lambda).filter(|_| Contact::new(lambda).end() >= FRAC_PI_2);
            assert_eq!(inner_fold(lambda).is_some(), found.is_some(), "{lambda}");
            if let (Some(table), Some(found)) = (inner_fold(lambda), found) {
                assert!((table / found - 1.0).abs() < 1e-10, "{lambda}: {table} {found}");
            }
            let (table, found) = (contact_end(lambda), Contact::new(lambda).end());
            assert!((table / found - 1.0).abs() < 1e-11, "{lambda}: {table} {found}");
        }
    }
}
