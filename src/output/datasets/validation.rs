//! The check of the ensemble against the integral.

use super::{Dataset, History, Results};
use crate::error::OutputError;
use crate::experiment::coupling::deviations;
use crate::output::schema::Dimension::{Component, Separation};
use crate::output::schema::{forces, scores};
use crate::output::writer::Writer;
use crate::validation::{Cumulants, SIGNIFICANCE};

const GROUP: &str = "/validation";

pub(super) fn datasets() -> Vec<Dataset> {
    History::all().flat_map(of_history).collect()
}

fn of_history(history: History) -> Vec<Dataset> {
    let on = history.direction().1;
    let path = |name: &str| history.path(GROUP, name);
    let tested = format!("whether the joint test looks at the {{}}{on} here (1) or not (0)");
    let weights = format!("weights of the {{}}{on} in each functional of the joint test");
    let mut all = Vec::new();
    for (i, variable) in scores(&[], history.direction()).into_iter().enumerate() {
        all.push(Dataset::of(variable, move |results: &Results| {
            Some(results.z[i][history.states(results)?].to_vec())
        }));
    }
    let of_each = forces(&path("tested_"), "", &[Separation], "1", &tested);
    for (i, variable) in of_each.into_iter().enumerate() {
        all.push(Dataset::of(variable, move |results: &Results| {
            let tested = &results.basis.tested[i][history.states(results)?];
            Some(tested.iter().map(|tested| u8::from(*tested)).collect::<Vec<u8>>())
        }));
    }
    let of_each = forces(&path("probe_"), "", &[Component, Separation], "N-1", &weights);
    for (i, variable) in of_each.into_iter().enumerate() {
        all.push(Dataset::of(variable, move |results: &Results| {
            let states = history.states(results)?;
            let probes = results.basis.probes.iter();
            let weights = probes.map(|own| if i == 0 { &own.adhesion_force } else { &own.external_force });
            Some(weights.flat_map(|weights| weights[states.clone()].to_vec()).collect::<Vec<f64>>())
        }));
    }
    all.extend(of_mean_field(history));
    all
}

/// The curve with coupling against its mean field.
fn of_mean_field(history: History) -> [Dataset; 5] {
    let own = |name: &str,
               units: &'static str,
               words: &str,
               of: fn(&Results, History) -> Option<Vec<f64>>| {
        let path = history.path(GROUP, &format!("mean_field_{name}"));
        Dataset::new(path, &[Separation], units, history.meaning(words), move |results| of(results, history))
    };
    [
        own(
            "separation",
            "m",
            "separation x that coupled asperities have by mean field{}: h + F/k_s of a patch, h of a repeated square",
            |results, history| Some(results.mean_fields.get(history.place)?.separations.clone()),
        ),
        own(
            "external_force",
            "N",
            "external force by mean field{}: the integral's at the separation x; of several solutions \
             the one reached from the start of the motion",
            |results, history| Some(results.mean_fields.get(history.place)?.force.clone()),
        ),
        own(
            "difference",
            "N",
            "mean external force with coupling{} less that by mean field",
            |results, history| of_deviation(results, history, 0),
        ),
        own("standard_error", "N", "standard error of that difference{}", |results, history| {
            of_deviation(results, history, 1)
        }),
        own("z", "1", "that difference{} in standard errors", |results, history| {
            of_deviation(results, history, 2)
        }),
    ]
}

fn of_deviation(results: &Results, history: History, place: usize) -> Option<Vec<f64>> {
    let field = results.mean_fields.get(history.place)?;
    let [difference, error, z] = deviations(results, field, history.states(results)?);
    [difference, error, z].into_iter().nth(place)
}

pub(super) fn attributes(writer: &Writer<'_>, results: &Results) -> Result<(), OutputError> {
    let joint = &results.joint;
    let Cumulants { kurtosis, skewness } = results.basis.cumulants;
    writer.text(GROUP, "test", "chi-squared")?;
    writer.number(GROUP, "statistic", joint.statistic)?;
    writer.number(GROUP, "degrees_of_freedom", joint.degrees_of_freedom)?;
    writer.number(GROUP, "kurtosis", kurtosis)?;
    writer.number(GROUP, "skewness", skewness)?;
    writer.number(GROUP, "p_value", joint.p_value)?;
    writer.number(GROUP, "significance", SIGNIFICANCE)?;
    writer.text(GROUP, "verdict", joint.verdict.name())
}
