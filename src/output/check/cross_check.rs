//! The cross-check of a run, or of a point of a sweep, computed again from its datasets.

use super::refused;
use super::stored::StoredRun;
use crate::error::OutputError;
use crate::output::schema::Dimension;
use crate::validation::{Cumulants, JointTest, Probe, z_scores};

/// Mean curves compared with the integral; of a loop, each way behind the one before.
pub struct CrossCheck {
    pub h_star: Vec<f64>,
    /// Mean, expectation and standard deviation of one group of adhesion force and external force.
    pub forces: [[Vec<f64>; 3]; 2],
    pub z: [Vec<f64>; 2],
    pub joint: JointTest,
}

impl CrossCheck {
    /// Computes it from the datasets.
    ///
    /// # Errors
    /// When a dataset is missing or has no numbers where it should.
    pub(super) fn new(run: &StoredRun<'_>) -> Result<Self, OutputError> {
        let ways = run.ways()?;
        let groups = run.groups();
        let curves = |name: &str| -> Result<[Vec<f64>; 3], OutputError> {
            let mean = joined(run, &|way| format!("{}_mean", run.independent(way, name)))?;
            let expected = joined(run, &|way| format!("/integral/{way}{name}"))?;
            let std = if run.group == 1 {
                joined(run, &|way| format!("/integral/{way}{name}_std"))?
            } else {
                let all: Result<Vec<_>, _> = ways.iter().map(|way| run.std_of_groups(way, name)).collect();
                all?.concat()
            };
            Ok([mean, expected, std])
        };
        let h_star = finite(run, run.reader.coordinate("h_star"), usize::MAX)?.repeat(ways.len());
        let forces = [curves("adhesion_force")?, curves("external_force")?];
        let z = [0, 1].map(|i| {
            let [mean, expected, std] = &forces[i];
            z_scores(mean, expected, std, groups)
        });
        let cumulant = |name: &str| -> Result<f64, OutputError> {
            let value = run.number(name)?;
            let problem = || refused(run.reader.path(), &format!("has {name} = {value} in /validation"));
            if value.is_finite() { Ok(value) } else { Err(problem()) }
        };
        let probes = probes(run)?;
        let joint = JointTest::new(
            &probes,
            [0, 1].map(|i| forces[i][0].as_slice()),
            [0, 1].map(|i| forces[i][1].as_slice()),
            Cumulants { kurtosis: cumulant("kurtosis")?, skewness: cumulant("skewness")? },
            run.replicas,
        );
        Ok(Self { h_star, forces, z, joint })
    }
}

/// The values of a dataset of each way, one behind the other.
fn joined(run: &StoredRun<'_>, name: &dyn Fn(&str) -> String) -> Result<Vec<f64>, OutputError> {
    let values: Result<Vec<_>, _> =
        run.ways()?.iter().map(|way| finite(run, &name(way), usize::MAX)).collect();
    Ok(values?.concat())
}

/// The weights of the functionals.
fn probes(run: &StoredRun<'_>) -> Result<Vec<Probe>, OutputError> {
    let (reader, most) = (run.reader, run.reader.length(Dimension::Component)?);
    let (components, separations) = match run.place {
        None => (most, reader.length(Dimension::Separation)?),
        // Other points of a sweep may have more.
        Some(_) => {
            let freedom = run.number("degrees_of_freedom")?;
            ((freedom as usize).min(most), reader.length(Dimension::SeparationIndex)?)
        }
    };
    let weights = |name: &str| -> Result<Vec<Vec<f64>>, OutputError> {
        let mut weights = vec![Vec::new(); components];
        for way in run.ways()? {
            let values = finite(run, &format!("/validation/{way}probe_{name}"), components * separations)?;
            let rows = weights.iter_mut().zip(values.chunks_exact(separations.max(1)));
            rows.for_each(|(weights, row)| weights.extend_from_slice(row));
        }
        Ok(weights)
    };
    let adhesion = weights("adhesion_force")?;
    let external = weights("external_force")?;
    let pairs = adhesion.into_iter().zip(external);
    Ok(pairs.map(|(adhesion_force, external_force)| Probe { adhesion_force, external_force }).collect())
}

/// The first `count` values of a dataset, all of which have to be finite.
fn finite(run: &StoredRun<'_>, name: &str, count: usize) -> Result<Vec<f64>, OutputError> {
    let mut values = run.values(name)?;
    values.truncate(count);
    let Some(place) = values.iter().position(|value| !value.is_finite()) else { return Ok(values) };
    let of_point = run.place.map_or(String::new(), |point| format!(" of the point {point:?}"));
    let problem = format!("has the value {} at {place} of {name}{of_point}", values[place]);
    Err(refused(run.reader.path(), &problem))
}
