//! The cross-check of a run, or of a point of a sweep, computed anew from its datasets.

use super::checked::{Checked, Place, refused};
use crate::output::OutputError;
use crate::output::schema::Dimension;
use crate::surface::SamplingScheme;
use crate::validation::{Cumulants, JointTest, Probe, z_scores};

/// Mean curves beside the integral, of a loop both ways one behind the other.
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
    pub(super) fn new(checked: &Checked<'_>) -> Result<Self, OutputError> {
        let ways = checked.ways()?;
        let groups = checked.groups();
        let curves = |name: &str| -> Result<[Vec<f64>; 3], OutputError> {
            let mean = joined(checked, &|way| format!("{}_mean", checked.independent(way, name)))?;
            let expected = joined(checked, &|way| format!("/integral/{way}{name}"))?;
            let std = if checked.group == 1 {
                joined(checked, &|way| format!("/integral/{way}{name}_std"))?
            } else {
                let all: Result<Vec<_>, _> =
                    ways.iter().map(|way| checked.scatter_of_groups(way, name)).collect();
                all?.concat()
            };
            Ok([mean, expected, std])
        };
        let h_star = finite(checked, checked.reader.coordinate("h_star"), usize::MAX)?.repeat(ways.len());
        let forces = [curves("adhesion_force")?, curves("external_force")?];
        let z = [0, 1].map(|i| {
            let [mean, expected, std] = &forces[i];
            z_scores(mean, expected, std, groups)
        });
        let cumulant = |name: &str| -> Result<f64, OutputError> {
            let value = checked.number("/validation", name)?;
            let problem = || refused(checked.reader.path(), &format!("has {name} = {value} in /validation"));
            if value.is_finite() { Ok(value) } else { Err(problem()) }
        };
        let probes = probes(checked)?;
        let joint = JointTest::new(
            &probes,
            [0, 1].map(|i| forces[i][0].as_slice()),
            [0, 1].map(|i| forces[i][1].as_slice()),
            Cumulants { kurtosis: cumulant("kurtosis")?, skewness: cumulant("skewness")? },
            checked.replicas,
        );
        Ok(Self { h_star, forces, z, joint })
    }
}

impl Checked<'_> {
    /// Compares the joint test of the file with its own.
    pub fn joint_test(&mut self, joint: &JointTest) -> Result<(), OutputError> {
        let JointTest { statistic: own, degrees_of_freedom, p_value, .. } = *joint;
        for (name, own, tolerance) in [
            ("statistic", own, 1e-6 * own.abs()),
            ("degrees_of_freedom", degrees_of_freedom as f64, 0.0),
            ("p_value", p_value, 1e-6),
        ] {
            let found = match (name, self.place) {
                ("degrees_of_freedom", Place::File) => self.reader.number::<u64>("/validation", name)? as f64,
                _ => self.number("/validation", name)?,
            };
            self.compare(
                &format!("/validation/{name}"),
                &[found],
                &[own],
                |_| tolerance,
                "means and integral",
            );
        }
        Ok(())
    }
}

/// How the replicas of a file were drawn.
pub(super) fn scheme(checked: &Checked<'_>) -> Result<SamplingScheme, OutputError> {
    let path = checked.reader.path();
    let name = checked.reader.optional_text("/", "sampling")?;
    let name = name.ok_or_else(|| refused(path, "lacks the text `sampling` of /"))?;
    let known = SamplingScheme::ALL.iter().find(|(known, _)| *known == name);
    known
        .map(|(_, scheme)| *scheme)
        .ok_or_else(|| refused(path, &format!("has sampling = \"{name}\", which this program does not know")))
}

/// The values of a dataset of each way, one behind the other.
fn joined(checked: &Checked<'_>, name: &dyn Fn(&str) -> String) -> Result<Vec<f64>, OutputError> {
    let values: Result<Vec<_>, _> =
        checked.ways()?.iter().map(|way| finite(checked, &name(way), usize::MAX)).collect();
    Ok(values?.concat())
}

/// The weights of the functionals.
fn probes(checked: &Checked<'_>) -> Result<Vec<Probe>, OutputError> {
    let (reader, most) = (checked.reader, checked.reader.length(Dimension::Component)?);
    let (components, separations) = match checked.place {
        Place::File => (most, reader.length(Dimension::Separation)?),
        // Other points of a sweep may have more.
        _ => {
            let freedom = checked.number("/validation", "degrees_of_freedom")?;
            ((freedom as usize).min(most), reader.length(Dimension::SeparationIndex)?)
        }
    };
    let weights = |name: &str| -> Result<Vec<Vec<f64>>, OutputError> {
        let mut weights = vec![Vec::new(); components];
        for way in checked.ways()? {
            let values =
                finite(checked, &format!("/validation/{way}probe_{name}"), components * separations)?;
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

/// At most so many of the values of a dataset, all of which have to be finite.
fn finite(checked: &Checked<'_>, name: &str, count: usize) -> Result<Vec<f64>, OutputError> {
    let mut values: Vec<f64> = match checked.place {
        Place::Point(place) => checked.reader.at_point(name, place)?,
        _ => checked.reader.values(name)?,
    };
    values.truncate(count);
    let Some(place) = values.iter().position(|value| !value.is_finite()) else { return Ok(values) };
    let of_point = match checked.place {
        Place::Point(point) => format!(" of the point {point:?}"),
        _ => String::new(),
    };
    let problem = format!("has the value {} at {place} of {name}{of_point}", values[place]);
    Err(refused(checked.reader.path(), &problem))
}
