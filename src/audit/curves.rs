//! Checks of what follows from the curves of the replicas.

use super::checked::{Checked, Place, ROUNDING, names};
use crate::engine::{BATCH, Ways};
use crate::math::control_variates::controlled_means;
use crate::math::extrema::largest_secant;
use crate::math::moments::{CentralMoments, Moments};
use crate::output::OutputError;

/// A secant of straight lines between the separations is above the largest of the curve by this share at
/// most.
pub(super) const LINES: f64 = 0.1;
/// Rows of curves that are read at a time.
const ROWS: usize = 256;
/// Most values of the curves of a point of a sweep that are read.
pub(super) const MOST_AT_POINT: usize = 1 << 23;
/// Parts that the groups are put into, batch by batch, each with the coefficients of the others.
const PARTS: usize = 16;

impl Checked<'_> {
    /// Checks what follows from the curves of the replicas, where the file has them.
    pub fn curves(&mut self, ways: Ways) -> Result<(), OutputError> {
        if !self.has("/replicas/external_force") {
            return Ok(());
        }
        let separations = self.coordinate("separation")?;
        let s = separations.len().max(1);
        if self.place != Place::File && self.replicas as usize * s > MOST_AT_POINT {
            return Ok(());
        }
        let paths: Vec<String> = ways
            .prefixes()
            .flat_map(|way| ["external_force", "adhesion_force"].map(|name| format!("/replicas/{way}{name}")))
            .collect();
        let mut moments: Vec<[Moments; 2]> =
            paths.iter().map(|_| [Moments::new(s), Moments::new(s)]).collect();
        let group = self.group as usize;
        let controls: Vec<f64> =
            self.coordinate("control")?.into_iter().filter(|control| !control.is_nan()).collect();
        let controls: Vec<usize> =
            controls.iter().filter_map(|control| separations.iter().position(|h| h == control)).collect();
        let names = names(ways);
        let columns = names
            .iter()
            .map(|name| self.values(&format!("/replicas/{name}")))
            .collect::<Result<Vec<_>, _>>()?;
        let mut parts: Vec<CentralMoments> =
            (0..PARTS).map(|_| CentralMoments::new(controls.len() + names.len())).collect();
        let span = self.number("/", "stiffness_span").ok();
        let backgrounds =
            ways.prefixes().map(|way| self.background(way, s)).collect::<Result<Vec<_>, _>>()?;
        let mut wrong: Vec<(&str, usize)> = Vec::new();
        let rows = (ROWS / group).max(1) * group;
        // Those of a point are read at once.
        let of_point = match self.place {
            Place::File => None,
            _ => Some(paths.iter().map(|path| self.values(path)).collect::<Result<Vec<_>, _>>()?),
        };
        for first in (0..self.replicas as usize).step_by(rows) {
            let end = (first + rows).min(self.replicas as usize);
            let mut chunk = Vec::new();
            for path in &paths {
                chunk.push(match &of_point {
                    None => self.reader.rows::<f64>(path, first..end)?,
                    Some(curves) => curves[chunk.len()][first * s..end * s].to_vec(),
                });
            }
            for (path, values) in paths.iter().zip(&chunk) {
                if let Some(i) = values.iter().position(|value| !value.is_finite()) {
                    self.say(path, &format!("has {:e} at {} of replica {}", values[i], i % s, first + i / s));
                    return Ok(());
                }
            }
            for ((pair, forces), background) in
                paths.chunks_exact(2).zip(chunk.chunks_exact(2)).zip(&backgrounds)
            {
                let contact = |i: &usize| {
                    let (external, adhesion, background) = (forces[0][*i], forces[1][*i], background[*i % s]);
                    let size = external.abs() + adhesion.abs() + background.abs();
                    external + adhesion + background < -ROUNDING * size
                };
                if let Some(i) = (0..forces[0].len()).find(contact) {
                    self.say(
                        &pair[1],
                        &format!("leaves a negative contact force at {} of replica {}", i % s, first + i / s),
                    );
                    return Ok(());
                }
            }
            for ([all, of_groups], values) in moments.iter_mut().zip(&chunk) {
                values.chunks_exact(s).for_each(|row| all.push(row));
                for rows in values.chunks_exact(group * s) {
                    let mean = |k: usize| (0..group).map(|row| rows[row * s + k]).sum::<f64>() / group as f64;
                    of_groups.push(&(0..s).map(mean).collect::<Vec<f64>>());
                }
            }
            let cycle = ways != Ways::One;
            let pulled = if cycle { &chunk[2] } else { &chunk[0] };
            for replica in first..end {
                let row =
                    |values: &Vec<f64>| values[(replica - first) * s..(replica - first + 1) * s].to_vec();
                let of = |name: &str| {
                    names.iter().position(|known| *known == name).map_or(f64::NAN, |i| columns[i][replica])
                };
                let (curve, there) = (row(pulled), row(&chunk[0]));
                let lowest = |curve: &[f64]| curve.iter().copied().fold(f64::INFINITY, f64::min);
                let size = curve.iter().chain(&there).fold(0.0, |size: f64, force| size.max(force.abs()));
                let mut check = |name: &'static str, does: bool| {
                    if !does && !wrong.iter().any(|(known, _)| *known == name) {
                        wrong.push((name, replica));
                    }
                };
                check("pull_off_force", of("pull_off_force") >= -lowest(&curve) - ROUNDING * size);
                if let Some(span) = span.filter(|span| s > 1 && *span <= separations[s - 1] - separations[0])
                {
                    let secant = largest_secant(&separations, &curve, span).value;
                    let does =
                        of("peak_secant_stiffness") >= secant - LINES * secant.abs() - ROUNDING * size / span;
                    check("peak_secant_stiffness", does);
                }
                if cycle {
                    check(
                        "approach_pull_off_force",
                        of("approach_pull_off_force") >= -lowest(&there) - ROUNDING * size,
                    );
                    let energies = ["dissipated_energy", "repeated_dissipated_energy"];
                    let inward = [Some(there), (ways == Ways::Repeated).then(|| row(&chunk[4]))];
                    for (name, inward) in energies.into_iter().zip(inward) {
                        let Some(inward) = inward else { continue };
                        let difference = |k: usize| inward[k] - curve[k];
                        let strip = |k: usize| {
                            0.5 * (separations[k + 1] - separations[k]) * (difference(k) + difference(k + 1))
                        };
                        // By the trapezoidal rule.
                        let area: f64 = (0..s - 1).map(strip).sum();
                        let tolerance = 1e-7 * size * (separations[s - 1] - separations[0]);
                        check(name, (of(name) - area).abs() <= tolerance);
                    }
                }
            }
            for group_first in (first..end).step_by(group) {
                let mean = |of: &dyn Fn(usize) -> f64| {
                    (group_first..group_first + group).map(of).sum::<f64>() / group as f64
                };
                let control = |&place: &usize| mean(&|replica| pulled[(replica - first) * s + place]);
                let scalar = |column: &Vec<f64>| mean(&|replica| column[replica]);
                let values: Vec<f64> =
                    controls.iter().map(control).chain(columns.iter().map(scalar)).collect();
                parts[group_first / BATCH as usize % PARTS].push(&values);
            }
        }
        for (name, replica) in wrong {
            self.say(&format!("/replicas/{name}"), &format!("does not fit the curve of replica {replica}"));
        }
        for (path, [all, of_groups]) in paths.iter().zip(&moments) {
            let name = path.replacen("/replicas/", "/ensemble/", 1);
            let size: Vec<f64> = all
                .mean()
                .iter()
                .zip(all.std())
                .map(|(mean, std)| mean.abs() + if std.is_nan() { 0.0 } else { std })
                .collect();
            for (of, expected) in [
                ("mean", all.mean().to_vec()),
                ("std", all.std()),
                ("standard_error", of_groups.standard_error()),
            ] {
                let path = format!("{name}_{of}");
                let found = self.values(&path)?;
                self.compare(&path, &found, &expected, |i| ROUNDING * size[i], "the curves of the replicas");
            }
        }
        // Of a part of a run the batches are not those of the parts. Controls of coupled surfaces are forces without
        // coupling, which are not kept.
        if !self.is_partial()? && !self.is_coupled() {
            let way = if ways == Ways::One { "" } else { "retraction_" };
            let expected = self.values(&format!("/integral/{way}external_force"))?;
            let expected: Vec<f64> = controls.iter().map(|&place| expected[place]).collect();
            let means = controlled_means(&parts, &expected);
            let plain: Vec<f64> = means.iter().map(|mean| mean.standard_error.max(0.0)).collect();
            for (name, expected) in [
                ("controlled_mean", means.iter().map(|mean| mean.controlled_mean).collect::<Vec<f64>>()),
                (
                    "controlled_standard_error",
                    means.iter().map(|mean| mean.controlled_standard_error).collect(),
                ),
            ] {
                let path = format!("/ensemble/scalar_{name}");
                let found = self.values(&path)?;
                let tolerance = |i: usize| 1e-4 * plain[i] + 1e-12 * expected[i].abs();
                self.compare(&path, &found, &expected, tolerance, "the curves of the replicas");
            }
        }
        Ok(())
    }
}
