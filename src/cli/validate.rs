//! `stiction validate`: the cross-check of a finished run, computed anew from its datasets.

use super::summary::verdict;
use super::{Failure, print};
use crate::engine::Probe;
use crate::output::reader::Reader;
use crate::output::schema::{Dimension, RUN};
use crate::surface::SamplingScheme;
use crate::validation::{JointTest, Verdict, z_scores};
use std::path::Path;

/// Rows of the table; more separations are thinned out.
const ROWS: usize = 25;

pub(super) fn validate(path: &Path) -> Result<(), Failure> {
    let reader = Reader::open(path, &[&RUN])?;
    let replicas: u64 = reader.number("/", "replicas")?;
    let scheme = scheme(&reader, path)?;
    let groups = replicas / scheme.group();
    let h_star: Vec<f64> = reader.values("/h_star")?;
    let curves = |name: &str| -> Result<[Vec<f64>; 3], Failure> {
        Ok([
            reader.values(&format!("/ensemble/{name}_mean"))?,
            reader.values(&format!("/statistical/{name}"))?,
            match scheme {
                SamplingScheme::Independent => reader.values(&format!("/statistical/{name}_std"))?,
                _ => {
                    let error: Vec<f64> = reader.values(&format!("/ensemble/{name}_standard_error"))?;
                    error.iter().map(|error| (groups as f64).sqrt() * error).collect()
                }
            },
        ])
    };
    let forces = [curves("adhesion_force")?, curves("external_force")?];
    let z = [0, 1].map(|i| {
        let [mean, expected, std] = &forces[i];
        z_scores(mean, expected, std, groups)
    });
    let joint = JointTest::new(
        &probes(&reader)?,
        [0, 1].map(|i| forces[i][0].as_slice()),
        [0, 1].map(|i| forces[i][1].as_slice()),
        &reader.values::<f64>("/validation/score_covariance")?,
        groups,
    );
    let mut text = format!("{}\n", path.display());
    text += "        h*   mean F_s (N)   integral (N)       z     mean F (N)   integral (N)       z\n";
    let step = h_star.len().div_ceil(ROWS);
    for k in (0..h_star.len()).step_by(step.max(1)) {
        let cells =
            [0, 1].map(|i| format!("{:>14.6e} {:>14.6e} {:>7}", forces[i][0][k], forces[i][1][k], score(z[i][k])));
        text += &format!("{:>10.3} {}\n", h_star[k], cells.join(" "));
    }
    let shown = if step > 1 {
        format!("every {step}th of {} separations is shown", h_star.len())
    } else {
        "all separations are shown".to_owned()
    };
    text += &verdict(&joint, &z, &shown);
    print(&text)?;
    if joint.verdict == Verdict::Disagree { Err(Failure::Disagree) } else { Ok(()) }
}

/// A z-score; a dash where nothing varies.
fn score(z: f64) -> String {
    if z.is_finite() { format!("{z:.2}") } else { "-".to_owned() }
}

/// How the replicas were drawn; files of format version 1.0 do not say, and knew one way only.
fn scheme(reader: &Reader, path: &Path) -> Result<SamplingScheme, Failure> {
    let Some(name) = reader.optional_text("/", "sampling")? else { return Ok(SamplingScheme::Independent) };
    let known = SamplingScheme::ALL.iter().find(|(known, _)| *known == name);
    known.map(|(_, scheme)| *scheme).ok_or_else(|| {
        Failure::Usage(format!("{} has sampling = \"{name}\", which this program does not know", path.display()))
    })
}

fn probes(reader: &Reader) -> Result<Vec<Probe>, Failure> {
    let separations = reader.length(Dimension::Separation)?;
    let weights = |name: &str| -> Result<Vec<Vec<f64>>, Failure> {
        let values: Vec<f64> = reader.values(name)?;
        Ok(values.chunks_exact(separations.max(1)).map(<[f64]>::to_vec).collect())
    };
    let adhesion = weights("/validation/probe_adhesion_force")?;
    let external = weights("/validation/probe_external_force")?;
    let pairs = adhesion.into_iter().zip(external);
    Ok(pairs.map(|(adhesion_force, external_force)| Probe { adhesion_force, external_force }).collect())
}
