//! A sweep: each of its points as a run, a line each, what all points share, and their differences.

use super::answer::{Audit, Content};
use super::checked::{Checked, Place, ROUNDING, refused};
use super::cross_check::{CrossCheck, scheme};
use crate::engine::SCALARS;
use crate::experiment::stacked::Compared;
use crate::output::OutputError;
use crate::output::reader::Reader;
use crate::output::schema::Dimension;
use crate::scene::MOST_POINTS;
use crate::scene::echo::one_line;
use crate::surface::SamplingScheme;
use crate::validation::{Difference, overall};

/// The file of a sweep.
struct SweptFile<'a> {
    reader: &'a Reader,
    scheme: SamplingScheme,
    /// Replicas of a point that is whole; none where targets end each by itself.
    replicas: Option<u64>,
    common: bool,
}

pub(super) fn audit(reader: &Reader) -> Result<Audit, OutputError> {
    let shape = reader.point_shape()?;
    let count = shape.iter().try_fold(1_usize, |count, length| count.checked_mul(*length));
    let Some(count) = count.filter(|count| (1..=MOST_POINTS).contains(count)) else {
        let problem = format!("has points of the shape {shape:?}; up to {MOST_POINTS} are read");
        return Err(refused(reader.path(), &problem));
    };
    let mut file = Checked::new(reader, 0);
    let points = SweptFile {
        reader,
        scheme: scheme(&file)?,
        replicas: match reader.has_attribute("/", "max_replicas")? {
            true => None,
            false => Some(reader.number("/", "replicas")?),
        },
        common: reader.number::<u8>("/", "common_random_numbers")? == 1,
    };
    file.bounds()?;
    let replicas: Vec<f64> = (0..reader.length(Dimension::Replica)?).map(|index| index as f64).collect();
    file.repeats("replica", &replicas, 0.0, "their number")?;
    file.axes()?;
    let mut findings = std::mem::take(&mut file.findings);
    let (mut audited, mut first) = (Vec::with_capacity(count), None);
    for point in 0..count {
        let place = place(point, &shape);
        let joint = points.point(&place, &mut first)?.map(|(cross_check, own)| {
            findings.extend(own.into_iter().map(|finding| format!("point {}: {finding}", point + 1)));
            cross_check.joint
        });
        audited.push((place, joint));
    }
    let p_values: Vec<f64> =
        audited.iter().map(|(_, joint)| joint.as_ref().map_or(f64::NAN, |joint| joint.p_value)).collect();
    let told = reader.optional_text("/validation", "overall_verdict")?.unwrap_or_default();
    if told != overall(&p_values).name() {
        let own = overall(&p_values).name();
        findings
            .push(format!("/validation/overall_verdict is \"{}\", and \"{own}\" follows", one_line(&told)));
    }
    let keys = reader.optional_text("/", "sweep_keys")?.unwrap_or_default();
    Ok(Audit { content: Content::Sweep { keys, points: audited }, findings, verdict: overall(&p_values) })
}

/// The index of a point along each dimension of a shape.
fn place(point: usize, shape: &[usize]) -> Vec<usize> {
    let mut rest = point;
    let mut place: Vec<usize> = shape.iter().rev().map(|length| (rest % length, rest /= length).0).collect();
    place.reverse();
    place
}

impl SweptFile<'_> {
    /// The cross-check of a point and what does not fit together there; none where a sweep is not complete
    /// and the point has no replicas. What is compared of the first point is kept.
    fn point(
        &self,
        place: &[usize],
        first: &mut Option<Option<Compared>>,
    ) -> Result<Option<(CrossCheck, Vec<String>)>, OutputError> {
        let reader = self.reader;
        let replicas: u64 = reader.at_point("/replica_count", place)?[0];
        let group = self.scheme.group();
        let mut checked = Checked { place: Place::Point(place), group, ..Checked::new(reader, replicas) };
        if replicas == 0 && checked.is_partial()? {
            first.get_or_insert(None);
            return Ok(None);
        }
        if replicas == 0
            || !replicas.is_multiple_of(group)
            || replicas > reader.length(Dimension::Replica)? as u64
        {
            let problem =
                format!("has {replicas} replicas at a point, no number of {} ones", self.scheme.name());
            return Err(refused(reader.path(), &problem));
        }
        let cross_check = CrossCheck::new(&checked)?;
        checked.run(&cross_check.joint)?;
        let compared = Compared::new(
            &|path| checked.values(path),
            checked.number("/", "stiffness_span")?,
            checked.is_loop()?,
        )?;
        let is_whole =
            |compared: &Compared| self.replicas.is_none_or(|replicas| compared.replicas() == replicas);
        let compared = Some(compared).filter(is_whole);
        let differences = match (first.as_ref(), &compared) {
            (None, Some(own)) => own.differences(own, group as usize, self.common),
            (Some(Some(first)), Some(own)) => own.differences(first, group as usize, self.common),
            _ => [Difference::UNKNOWN; 4],
        };
        checked.of_sweep(&differences, &cross_check)?;
        first.get_or_insert(compared);
        Ok(Some((cross_check, checked.findings)))
    }
}

impl Checked<'_> {
    /// The values of what is swept, in the root and in every other group.
    fn axes(&mut self) -> Result<(), OutputError> {
        let axes = self.reader.axes("")?;
        for group in self.reader.groups() {
            for ((name, values), (_, copy)) in axes.iter().zip(self.reader.axes(&format!("/{group}"))?) {
                let path = format!("/{group}/{}", one_line(name));
                self.compare(&path, &copy, values, |_| 0.0, &format!("/{}", one_line(name)));
            }
        }
        // The points of a zip differ in one of their keys at least.
        let is_zip = self.reader.optional_text("/", "sweep_mode")?.as_deref() == Some("zip");
        for (name, values) in axes {
            let is_wrong = |i: usize| !values[i].is_finite() || (!is_zip && values[..i].contains(&values[i]));
            if let Some(i) = (0..values.len()).find(|&i| is_wrong(i)) {
                let name = one_line(&name);
                self.say(
                    &format!("/{name}"),
                    &format!("has {:e} at {i}, and another number is expected", values[i]),
                );
            }
        }
        Ok(())
    }

    /// Checks the datasets that only a point of a sweep has.
    fn of_sweep(
        &mut self,
        differences: &[Difference; 4],
        cross_check: &CrossCheck,
    ) -> Result<(), OutputError> {
        // ψ = √(σ/ω_c); files before version 4.5 have that of the surface alone.
        let critical = self.number("/", "critical_interference")?;
        for (kind, psi) in [("surface", "/plasticity_index"), ("asperity", "/asperity_plasticity_index")] {
            let name = format!("{kind}_height_std");
            let expected = (self.number("/", &name)? / critical).sqrt();
            if self.has(psi) {
                self.follows(psi, &[expected], ROUNDING, &format!("/{name} and ω_c"))?;
            }
        }
        let name = cross_check.joint.verdict.name();
        let told = self.text("/validation/verdict")?;
        if told != name {
            self.say("/validation/verdict", &format!("is \"{}\", and \"{name}\" follows", one_line(&told)));
        }
        for (scalar, difference) in SCALARS.iter().zip(differences) {
            let path = |of: &str| format!("/differences/{}_{of}", scalar.name);
            let size = difference.mean.abs() + difference.standard_error.max(0.0);
            let slack = if size.is_nan() { 0.0 } else { ROUNDING * size };
            for (of, expected) in [
                ("mean", difference.mean),
                ("standard_error", difference.standard_error),
                ("variance_ratio", difference.variance_ratio),
            ] {
                let found = self.values(&path(of))?;
                let slack = if of == "variance_ratio" { 1e-6 * expected.abs() } else { slack };
                self.compare(&path(of), &found, &[expected], |_| slack, "/replicas");
            }
        }
        Ok(())
    }
}
