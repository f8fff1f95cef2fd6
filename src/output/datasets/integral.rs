//! Expectations by the integral.

use super::ensemble::{changes, features, jumps};
use super::{Dataset, History, Results, path};
use crate::asperity::{ByRegime, Quantity};
use crate::error::OutputError;
use crate::integral::Expectations;
use crate::math::extrema::maximum;
use crate::output::schema::Dimension::{self, Regime, Separation};
use crate::output::schema::{OF_INTEGRAL, quantities, regimes};
use crate::output::writer::Writer;

const GROUP: &str = "/integral";

/// A table of curves of each regime.
type Table = fn(&Expectations) -> &ByRegime;

pub(super) fn datasets() -> Vec<Dataset> {
    let mut all: Vec<Dataset> = History::all().flat_map(of_history).collect();
    all.extend([
        at_pull_off("regime_count", &[Regime], "1", "asperities in each regime", |at| {
            at.regime_count.concat()
        }),
        at_pull_off("regime_adhesion_force", &[Regime], "N", "adhesion force of each regime", |at| {
            at.regime_adhesion_force.concat()
        }),
        at_pull_off("contact_area", &[], "m2", "contact area", |at| {
            at.expected[Quantity::ContactArea.index()].clone()
        }),
    ]);
    all.extend(jumps(GROUP, OF_INTEGRAL[0], |results, way| {
        let counts = &results.integrals().nth(way)?.regime_count;
        Some(changes(counts, 0..results.scene.separations.len()))
    }));
    all
}

fn of_history(history: History) -> Vec<Dataset> {
    let variables = quantities(GROUP, &[Separation], history.direction(), &OF_INTEGRAL);
    let each = Quantity::ALL.into_iter().flat_map(|quantity| [(quantity, false), (quantity, true)]);
    let dataset = |(variable, (quantity, is_std)): (_, (Quantity, bool))| {
        Dataset::of(variable, move |results: &Results| {
            let Expectations { expected, std, .. } = history.integral(results)?;
            Some(if is_std { std } else { expected }[quantity.index()].clone())
        })
    };
    let tables: [Table; 3] =
        [|own| &own.regime_count, |own| &own.regime_adhesion_force, |own| &own.regime_external_force];
    let of_regimes = regimes(GROUP, &[], history.direction(), OF_INTEGRAL[0]).into_iter().zip(tables);
    let of_regime = |(variable, table): (_, Table)| {
        Dataset::of(variable, move |results: &Results| Some(table(history.integral(results)?).concat()))
    };
    variables.into_iter().zip(each).map(dataset).chain(of_regimes.map(of_regime)).collect()
}

fn at_pull_off(
    name: &str,
    dimensions: &[Dimension],
    units: &'static str,
    words: &str,
    of: fn(&Expectations) -> Vec<f64>,
) -> Dataset {
    let meaning =
        format!("{words} at pull-off of the integral, or at the smallest separation where nothing pulls");
    Dataset::new(path(GROUP, &format!("pull_off_{name}")), dimensions, units, meaning, move |results| {
        Some(of(&results.at_pull_off))
    })
}

pub(super) fn attributes(writer: &Writer<'_>, results: &Results) -> Result<(), OutputError> {
    let error = results.integrals().fold(0.0, |error, own| maximum(own.quadrature_error, error));
    writer.number(GROUP, "quadrature_error", error)?;
    features(writer, GROUP, results.pulled().1)
}
