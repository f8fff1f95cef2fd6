//! `stiction validate`: the cross-check of a finished run, computed anew from its datasets, and whether these fit together.

mod bounds;
mod consistency;

use super::format::row;
use super::summary::verdict;
use super::sweep::together;
use super::{Failure, print};
use crate::output::reader::Reader;
use crate::output::schema::{Dimension, RUN, SWEEP};
use crate::scene::echo::one_line;
use crate::scene::sweep::MOST_POINTS;
use crate::surface::SamplingScheme;
use crate::validation::{Cumulants, JointTest, Probe, Verdict, overall, z_scores};
use consistency::{Checked, TOLD};
use std::path::Path;

/// Rows of the table; more separations are thinned out.
const ROWS: usize = 25;

pub(super) fn validate(path: &Path) -> Result<(), Failure> {
    let reader = Reader::open(path, &[&RUN, &SWEEP])?;
    if reader.layout().of_points.is_some() {
        return validate_sweep(&reader, path);
    }
    let scheme = scheme(&reader, path)?;
    let groups = groups(&reader, scheme, path)?;
    let h_star = finite(&reader, "/h_star", path)?;
    let ways = ways(&reader)?;
    let h_star = h_star.repeat(ways.len());
    let curves = |name: &str| -> Result<[Vec<f64>; 3], Failure> {
        Ok([
            joined(&reader, ways, &|way| format!("/ensemble/{way}{name}_mean"), path)?,
            joined(&reader, ways, &|way| format!("/statistical/{way}{name}"), path)?,
            match scheme {
                SamplingScheme::Independent => {
                    joined(&reader, ways, &|way| format!("/statistical/{way}{name}_std"), path)?
                }
                _ => {
                    let mut errors: Vec<f64> = Vec::new();
                    for way in ways {
                        errors.extend(reader.values::<f64>(&format!("/ensemble/{way}{name}_standard_error"))?);
                    }
                    errors.iter().map(|error| (groups as f64).sqrt() * error).collect()
                }
            },
        ])
    };
    let forces = [curves("adhesion_force")?, curves("external_force")?];
    let z = [0, 1].map(|i| {
        let [mean, expected, std] = &forces[i];
        z_scores(mean, expected, std, groups)
    });
    let probes = probes(&reader, ways, path)?;
    let joint = JointTest::new(
        &probes,
        [0, 1].map(|i| forces[i][0].as_slice()),
        [0, 1].map(|i| forces[i][1].as_slice()),
        Cumulants { kurtosis: cumulant(&reader, "kurtosis", path)?, skewness: cumulant(&reader, "skewness", path)? },
        groups * scheme.group(),
    );
    let mut text = format!("{}\n", one_line(&path.display().to_string()));
    text += "        h*   mean F_s (N)   integral (N)       z     mean F (N)   integral (N)       z\n";
    let step = h_star.len().div_ceil(ROWS);
    for k in (0..h_star.len()).step_by(step.max(1)) {
        let cells =
            [0, 1].map(|i| format!("{:>14.6e} {:>14.6e} {:>7}", forces[i][0][k], forces[i][1][k], score(z[i][k])));
        let back = if k < h_star.len() / ways.len() { "" } else { "  on the way back" };
        text += &format!("{:>10.3} {}{back}\n", h_star[k], cells.join(" "));
    }
    let shown = if step > 1 {
        format!("every {step}th of {} separations is shown", h_star.len())
    } else {
        "all separations are shown".to_owned()
    };
    text += &verdict(&joint, &z, &shown);
    let (group, replicas) = (scheme.group(), groups * scheme.group());
    let checked = Checked { reader: &reader, place: None, group, replicas, joint: &joint, findings: Vec::new() };
    concluded(text, checked.findings()?, joint.verdict)
}

/// Prints what was found, and what comes of it.
fn concluded(text: String, findings: Vec<String>, verdict: Verdict) -> Result<(), Failure> {
    let more = findings.len().saturating_sub(TOLD);
    let told = findings.iter().take(TOLD).enumerate();
    let mut rows: String = told.map(|(i, finding)| row(if i == 0 { "contradictions" } else { "" }, finding)).collect();
    if more > 0 {
        rows += &row("", &format!("and {more} more"));
    }
    if findings.is_empty() {
        rows = row("datasets", "fit together");
    }
    print(&(text + &rows))?;
    match (findings.len(), verdict) {
        (0, Verdict::Disagree) => Err(Failure::Disagree),
        (0, _) => Ok(()),
        (1, _) => Err(Failure::Contradicts("a dataset contradicts others or cannot be".to_owned())),
        (count, _) => Err(Failure::Contradicts(format!("{count} datasets contradict others or cannot be"))),
    }
}

/// The cross-check of every point of a sweep, a line each, and of all of them together.
fn validate_sweep(reader: &Reader, path: &Path) -> Result<(), Failure> {
    let scheme = scheme(reader, path)?;
    let shape = reader.point_shape()?;
    let count = shape.iter().try_fold(1_usize, |count, length| count.checked_mul(*length));
    let Some(count) = count.filter(|count| (1..=MOST_POINTS).contains(count)) else {
        return Err(refused(path, &format!("has points of the shape {shape:?}; up to {MOST_POINTS} are read")));
    };
    let mut text = format!("{}\n", one_line(&path.display().to_string()));
    let keys = reader.optional_text("/", "sweep_keys")?.unwrap_or_default();
    text += &format!("{:>6}  {:<28}{:>10}{:>8}{:>10}  {}\n", "point", "indices", "chi2", "k", "p", "verdict");
    let (mut p_values, mut findings) = (Vec::with_capacity(count), Vec::new());
    for point in 0..count {
        let place = place(point, &shape);
        let joint = joint_at(reader, &place, scheme, path)?;
        let Some(joint) = joint else {
            text += &format!("{:>6}  of which no replicas are there\n", point + 1);
            p_values.push(f64::NAN);
            continue;
        };
        let indices: Vec<String> = place.iter().map(usize::to_string).collect();
        let components = joint.degrees_of_freedom;
        let (p, verdict) = (joint.p_value, joint.verdict.name());
        let [statistic, p] = [format!("{:.1}", joint.statistic), format!("{p:.4}")];
        text +=
            &format!("{:>6}  {:<28}{statistic:>10}{components:>8}{p:>10}  {verdict}\n", point + 1, indices.join(", "));
        p_values.push(joint.p_value);
        let replicas = reader.at_point::<u64>("/replica_count", &place)?[0];
        let group = scheme.group();
        let checked = Checked { reader, place: Some(&place), group, replicas, joint: &joint, findings: Vec::new() };
        findings.extend(checked.findings()?.into_iter().map(|finding| format!("point {}: {finding}", point + 1)));
    }
    text += &format!("indices along {}\n", one_line(&keys));
    text += &together(&p_values);
    concluded(text, findings, overall(&p_values))
}

/// The index of a point along each dimension of a shape.
fn place(point: usize, shape: &[usize]) -> Vec<usize> {
    let mut rest = point;
    let mut place: Vec<usize> = shape.iter().rev().map(|length| (rest % length, rest /= length).0).collect();
    place.reverse();
    place
}

/// The joint test at a point, computed anew; none where a sweep is not complete and has no replicas.
fn joint_at(
    reader: &Reader,
    place: &[usize],
    scheme: SamplingScheme,
    path: &Path,
) -> Result<Option<JointTest>, Failure> {
    let finite = |name: &str, count: usize| -> Result<Vec<f64>, Failure> {
        let mut values: Vec<f64> = reader.at_point(name, place)?;
        values.truncate(count);
        match values.iter().position(|value| !value.is_finite()) {
            Some(i) => Err(refused(path, &format!("has the value {} in {name} at the point {place:?}", values[i]))),
            None => Ok(values),
        }
    };
    let replicas: u64 = reader.at_point("/replica_count", place)?[0];
    if replicas == 0 && reader.has_attribute("/", "partial")? {
        return Ok(None);
    }
    if replicas == 0 || !replicas.is_multiple_of(scheme.group()) {
        return Err(refused(path, &format!("has {replicas} replicas at a point, no number of {} ones", scheme.name())));
    }
    let freedom: Vec<u64> = reader.at_point("/validation/degrees_of_freedom", place)?;
    let (separations, most) = (reader.length(Dimension::SeparationIndex)?, reader.length(Dimension::Component)?);
    let components = freedom.first().map_or(0, |components| *components as usize).min(most);
    let curves = |of: &str| -> Result<[Vec<f64>; 2], Failure> {
        Ok([
            finite(&of.replace('*', "adhesion_force"), separations)?,
            finite(&of.replace('*', "external_force"), separations)?,
        ])
    };
    let [adhesion_mean, external_mean] = curves("/ensemble/*_mean")?;
    let [adhesion, external] = curves("/statistical/*")?;
    let weights = |name: &str| finite(name, components * separations);
    let (of_adhesion, of_external) =
        (weights("/validation/probe_adhesion_force")?, weights("/validation/probe_external_force")?);
    let rows = of_adhesion.chunks_exact(separations.max(1)).zip(of_external.chunks_exact(separations.max(1)));
    let probes: Vec<Probe> = rows
        .map(|(adhesion, external)| Probe { adhesion_force: adhesion.to_vec(), external_force: external.to_vec() })
        .collect();
    let means = [&adhesion_mean[..], &external_mean];
    let cumulant = |name: &str| Ok::<f64, Failure>(finite(name, 1)?[0]);
    let cumulants =
        Cumulants { kurtosis: cumulant("/validation/kurtosis")?, skewness: cumulant("/validation/skewness")? };
    Ok(Some(JointTest::new(&probes, means, [&adhesion, &external], cumulants, replicas)))
}

/// A z-score; a dash where nothing varies.
fn score(z: f64) -> String {
    if z.is_finite() { format!("{z:.2}") } else { "-".to_owned() }
}

/// How the replicas were drawn.
fn scheme(reader: &Reader, path: &Path) -> Result<SamplingScheme, Failure> {
    let name = reader.optional_text("/", "sampling")?;
    let name = name.ok_or_else(|| refused(path, "lacks the text `sampling` of /"))?;
    let known = SamplingScheme::ALL.iter().find(|(known, _)| *known == name);
    known.map(|(_, scheme)| *scheme).ok_or_else(|| {
        Failure::Usage(format!("{} has sampling = \"{name}\", which this program does not know", path.display()))
    })
}

/// Groups of replicas that are independent of each other.
fn groups(reader: &Reader, scheme: SamplingScheme, path: &Path) -> Result<u64, Failure> {
    let replicas: u64 = reader.number("/", "replicas")?;
    let there = reader.length(Dimension::Replica)? as u64;
    if replicas != there {
        return Err(refused(path, &format!("has replicas = {replicas}, but the dimension `replica` has {there}")));
    }
    if replicas == 0 || !replicas.is_multiple_of(scheme.group()) {
        return Err(refused(path, &format!("has replicas = {replicas}, which is no number of {} ones", scheme.name())));
    }
    Ok(replicas / scheme.group())
}

/// What the names of the datasets of each way begin with.
fn ways(reader: &Reader) -> Result<&'static [&'static str], Failure> {
    let cycle = reader.optional_text("/", "path")?.is_some_and(|path| path == "loop");
    Ok(if cycle { &["", "retraction_"] } else { &[""] })
}

/// The values of a dataset of each way, one behind the other.
fn joined(reader: &Reader, ways: &[&str], name: &dyn Fn(&str) -> String, path: &Path) -> Result<Vec<f64>, Failure> {
    let values: Result<Vec<_>, _> = ways.iter().map(|way| finite(reader, &name(way), path)).collect();
    Ok(values?.concat())
}

/// The weights of the functionals.
fn probes(reader: &Reader, ways: &[&str], path: &Path) -> Result<Vec<Probe>, Failure> {
    let separations = reader.length(Dimension::Separation)?;
    let components = reader.length(Dimension::Component)?;
    let weights = |name: &str| -> Result<Vec<Vec<f64>>, Failure> {
        let mut weights = vec![Vec::new(); components];
        for way in ways {
            let values = finite(reader, &format!("/validation/{way}probe_{name}"), path)?;
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

/// A cumulant of the scores, which has to be finite.
fn cumulant(reader: &Reader, name: &str, path: &Path) -> Result<f64, Failure> {
    let value: f64 = reader.number("/validation", name)?;
    if value.is_finite() { Ok(value) } else { Err(refused(path, &format!("has {name} = {value} in /validation"))) }
}

/// The values of a dataset, all of which have to be finite.
fn finite(reader: &Reader, name: &str, path: &Path) -> Result<Vec<f64>, Failure> {
    let values: Vec<f64> = reader.values(name)?;
    match values.iter().position(|value| !value.is_finite()) {
        Some(place) => Err(refused(path, &format!("has the value {} at {place} of {name}", values[place]))),
        None => Ok(values),
    }
}

fn refused(path: &Path, problem: &str) -> Failure {
    Failure::Usage(format!("{}: {problem}", path.display()))
}
