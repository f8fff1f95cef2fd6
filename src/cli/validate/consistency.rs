//! Whether the datasets of a run fit together: each is what it has to be by itself, and what follows from others does.

use super::super::Failure;
use super::bounds::{Bound, Kind, Nan, bound_of};
use crate::asperity::{Quantity, Regime};
use crate::engine::{BATCH, LOOP_SCALARS, SCALARS};
use crate::math::control_variates::controlled_means;
use crate::math::extrema::largest_secant;
use crate::math::moments::{CentralMoments, Moments};
use crate::math::proportion::wilson_interval;
use crate::output::reader::Reader;
use crate::output::schema::{Dimension, RUN};
use crate::validation::{JointTest, z_scores};

/// Findings that are told; more are counted.
pub(super) const TOLD: usize = 20;
/// What rounding may be off by, relative to what was summed.
const ROUNDING: f64 = 1e-9;
/// Rows of curves that are read at a time.
const ROWS: usize = 256;
/// Most values of the curves of a point of a sweep that are read.
const MOST_AT_POINT: usize = 1 << 23;
/// Parts that the groups are put into, batch by batch, each with the coefficients of the others.
const PARTS: usize = 16;
/// Contacts of all replicas from which on means and deviations are near those of the integral.
const POPULATED: f64 = 2000.0;
/// Asperities from which on the highest of a replica is above their mean plane.
const MANY: f64 = 100.0;
/// A mean with control variates is no more standard errors of the plain one away from this.
const FARTHEST: f64 = 50.0;

/// A run, or a point of a sweep, in a file.
pub(super) struct Checked<'a> {
    pub reader: &'a Reader,
    /// The index of the point along each dimension.
    pub place: Option<&'a [usize]>,
    /// Replicas of a group.
    pub group: u64,
    pub replicas: u64,
    /// The joint test, computed anew.
    pub joint: &'a JointTest,
    pub findings: Vec<String>,
}

impl Checked<'_> {
    /// What does not fit together.
    pub fn findings(mut self) -> Result<Vec<String>, Failure> {
        self.bounds()?;
        let cycle = self.reader.optional_text("/", "path")?.is_some_and(|path| path == "loop");
        self.separations()?;
        for way in if cycle { &["", "retraction_"][..] } else { &[""] } {
            self.sums("ensemble", way, "_mean")?;
            self.sums("statistical", way, "")?;
            self.errors(way)?;
            self.scores(way)?;
            self.plausible(way)?;
        }
        self.counts(cycle)?;
        self.scalars(cycle)?;
        self.targets()?;
        self.curves(cycle)?;
        self.snaps()?;
        self.pull_off(cycle)?;
        self.joint_test()?;
        Ok(self.findings)
    }

    fn has(&self, path: &str) -> bool {
        self.reader.has(path)
    }

    fn values(&self, path: &str) -> Result<Vec<f64>, Failure> {
        let mut values = self.reader.numbers(path, self.place)?;
        // In sweeps the replicas of a partial point are fewer.
        if self.place.is_some() && path.starts_with("/replicas/") {
            let rows = self.reader.length(Dimension::Replica)?.max(1);
            values.truncate(values.len() / rows * self.replicas as usize);
        }
        Ok(values)
    }

    /// An attribute of a run, which a sweep has over its points.
    fn number(&self, group: &str, name: &str) -> Result<f64, Failure> {
        let path = format!("{}/{name}", group.trim_end_matches('/'));
        match self.place {
            None => Ok(self.reader.number(group, name)?),
            Some(_) => Ok(self.reader.numbers(&path, self.place)?[0]),
        }
    }

    fn groups(&self) -> u64 {
        self.replicas / self.group
    }

    fn say(&mut self, path: &str, problem: &str) {
        self.findings.push(format!("{path} {problem}"));
    }

    /// Compares a dataset with what follows from others, each value within its tolerance.
    fn compare(&mut self, path: &str, found: &[f64], expected: &[f64], tolerance: impl Fn(usize) -> f64, from: &str) {
        if found.len() != expected.len() {
            return self.say(path, &format!("has {} values, and {} follow from {from}", found.len(), expected.len()));
        }
        let agree = |i: usize| {
            let (found, expected) = (found[i], expected[i]);
            found == expected || found.is_nan() && expected.is_nan() || (found - expected).abs() <= tolerance(i)
        };
        if let Some(i) = (0..found.len()).find(|&i| !agree(i)) {
            self.say(path, &format!("has {:e} at {i}, and {:e} follows from {from}", found[i], expected[i]));
        }
    }

    /// Each dataset by itself.
    fn bounds(&mut self) -> Result<(), Failure> {
        let ends = self.values("/separation")?;
        let (first, last) = (ends.first().copied(), ends.last().copied());
        let Some(ends) = first.zip(last) else { return Ok(()) };
        for variable in RUN.variables {
            let path = variable.path;
            let of_curves =
                path.ends_with("_force") && variable.dimensions.len() == 2 && path.starts_with("/replicas/");
            let shared =
                self.place.is_some() && variable.scales().is_some_and(|dimension| dimension.of_points() == dimension);
            let Some(bound) = bound_of(path).filter(|bound| bound.kind != Kind::Text) else { continue };
            // Curves are looked at row by row, and what all points share with the file of all.
            if of_curves || shared || !self.has(path) {
                continue;
            }
            let values = self.values(path)?;
            if let Some(problem) = self.broken(bound, &values, ends) {
                self.say(path, &problem);
            }
        }
        Ok(())
    }

    fn broken(&self, bound: &Bound, values: &[f64], ends: (f64, f64)) -> Option<String> {
        let largest = values.iter().fold(0.0, |largest: f64, value| largest.max(value.abs()));
        let slack = ROUNDING * largest;
        let is_absent = |value: f64| {
            value.is_nan()
                && match bound.nan {
                    Nan::Never => false,
                    Nan::OneGroup => self.groups() < 2,
                    Nan::Absent => true,
                    Nan::Padded => self.place.is_some() || self.groups() < 2,
                }
        };
        let does = |i: usize| {
            let value = values[i];
            (value.is_finite() || bound.kind == Kind::Ratio && value == f64::INFINITY)
                && match bound.kind {
                    Kind::Text | Kind::Finite => true,
                    Kind::Ratio => value >= 0.0,
                    Kind::Index => value == i as f64,
                    Kind::Rising => i == 0 || value > values[i - 1],
                    Kind::NotNegative => value >= -slack,
                    Kind::Share => (0.0..=1.0).contains(&value),
                    Kind::Flag => value == 0.0 || value == 1.0,
                    Kind::Within => (ends.0..=ends.1).contains(&value),
                }
        };
        let place = (0..values.len()).find(|&i| !(is_absent(values[i]) || does(i)))?;
        Some(format!("has {:e} at {place}, which cannot be", values[place]))
    }

    /// Other ways to write the separations.
    fn separations(&mut self) -> Result<(), Failure> {
        let h = self.values("/separation")?;
        let (std, offset) = (self.number("/", "surface_height_std")?, self.number("/", "mean_plane_offset")?);
        let largest = h.iter().fold(offset.abs(), |largest: f64, h| largest.max(h.abs()));
        let of = |f: &dyn Fn(f64) -> f64| h.iter().map(|&h| f(h)).collect::<Vec<f64>>();
        let found = self.values("/h_star")?;
        self.compare("/h_star", &found, &of(&|h| h / std), |_| ROUNDING * largest / std, "/separation");
        let found = self.values("/asperity_separation")?;
        self.compare("/asperity_separation", &found, &of(&|h| h - offset), |_| ROUNDING * largest, "/separation");
        if self.has("/step") && self.place.is_none() {
            let middles: Vec<f64> = h.windows(2).map(|pair| 0.5 * (pair[0] + pair[1])).collect();
            let found = self.values("/step")?;
            self.compare("/step", &found, &middles, |_| ROUNDING * largest, "/separation");
        }
        if self.place.is_none() && !self.reader.has_attribute("/", "partial")? {
            let indices: Vec<f64> = (0..self.replicas).map(|index| index as f64).collect();
            let found = self.values("/replica")?;
            self.compare("/replica", &found, &indices, |_| 0.0, "the number of replicas");
        }
        let controls = self.values("/control")?;
        if let Some(other) = controls.iter().find(|control| !control.is_nan() && !h.contains(control)) {
            self.say("/control", &format!("has {other:e}, which is no separation"));
        }
        Ok(())
    }

    /// F = P − F_s, and regimes add up to what they are of.
    fn sums(&mut self, group: &str, way: &str, of: &str) -> Result<(), Failure> {
        let path = |name: &str| format!("/{group}/{way}{name}{of}");
        let [adhesion, contact, external] = [
            self.values(&path("adhesion_force"))?,
            self.values(&path("contact_force"))?,
            self.values(&path("external_force"))?,
        ];
        let tolerance = |i: usize| ROUNDING * (adhesion[i].abs() + contact[i].abs());
        let difference: Vec<f64> =
            contact.iter().zip(&adhesion).map(|(contact, adhesion)| contact - adhesion).collect();
        self.compare(&path("external_force"), &external, &difference, tolerance, "contact less adhesion force");
        let s = adhesion.len().max(1);
        let regimes = self.reader.texts("/regime")?;
        let [by_adhesion, by_external] =
            [self.values(&path("regime_adhesion_force"))?, self.values(&path("regime_external_force"))?];
        for (name, total, parts) in
            [("adhesion_force", &adhesion, &by_adhesion), ("external_force", &external, &by_external)]
        {
            let sum = summed(parts, s, |_| true);
            let size = summed(&parts.iter().map(|part| part.abs()).collect::<Vec<f64>>(), s, |_| true);
            self.compare(&path(&format!("regime_{name}")), &sum, total, |i| ROUNDING * size[i], "all regimes together");
        }
        // Before contact the external force is adhesion alone.
        for (row, regime) in regimes.iter().enumerate().filter(|(_, name)| !is_contact(name)) {
            let rows = row * s..(row + 1) * s;
            let (Some(found), Some(own)) = (by_external.get(rows.clone()), by_adhesion.get(rows)) else { continue };
            let expected: Vec<f64> = own.iter().map(|force| -force).collect();
            let tolerance = |i: usize| ROUNDING * own[i].abs();
            self.compare(&path("regime_external_force"), found, &expected, tolerance, &format!("adhesion of {regime}"));
        }
        let counts = self.values(&path("regime_count"))?;
        for (name, forces) in [("regime_adhesion_force", by_adhesion), ("regime_external_force", by_external)] {
            if let Some(i) = (0..counts.len().min(forces.len())).find(|&i| counts[i] == 0.0 && forces[i] != 0.0) {
                self.say(&path(name), &format!("has a force at {i}, where no asperities are"));
            }
        }
        Ok(())
    }

    /// Standard errors and deviations.
    fn errors(&mut self, way: &str) -> Result<(), Failure> {
        let (n, groups) = (self.replicas as f64, self.groups() as f64);
        let mut of_forces = Vec::new();
        for quantity in Quantity::ALL {
            let name = format!("/ensemble/{way}{}", quantity.name());
            let path = format!("{name}_standard_error");
            let [mean, std, error] =
                [self.values(&format!("{name}_mean"))?, self.values(&format!("{name}_std"))?, self.values(&path)?];
            // Of independent replicas the error follows; of groups it is bounded, as their scatter is part of that of all.
            let largest = if self.group == 1 { n.sqrt().recip() } else { ((n - 1.0) / (n * (groups - 1.0))).sqrt() };
            let expected: Vec<f64> = std.iter().map(|std| largest * std).collect();
            let tolerance = |i: usize| ROUNDING * (expected[i] + mean[i].abs() * largest) + 1e-12 * mean[i].abs();
            if self.group == 1 {
                self.compare(&path, &error, &expected, tolerance, "the standard deviation");
            } else if let Some(i) = (0..error.len()).find(|&i| error[i] > expected[i] + tolerance(i)) {
                self.say(&path, &format!("has {:e} at {i}, more than the standard deviation allows", error[i]));
            }
            of_forces.push((mean, [std, error]));
        }
        for (i, name) in ["std", "standard_error"].into_iter().enumerate() {
            let of = |quantity: Quantity| of_forces[quantity.index()].1[i].clone();
            let own = |quantity: Quantity| &of_forces[quantity.index()].0;
            let size: Vec<f64> = own(Quantity::AdhesionForce)
                .iter()
                .zip(own(Quantity::ContactForce))
                .map(|(a, b)| a.abs() + b.abs())
                .collect();
            let all = [of(Quantity::AdhesionForce), of(Quantity::ContactForce), of(Quantity::ExternalForce)];
            self.triangle(&format!("/ensemble/{way}*_force_{name}"), &all, &size);
        }
        let std = |name: &str| self.values(&format!("/statistical/{way}{name}_force_std"));
        let all = [std("adhesion")?, std("contact")?, std("external")?];
        let mean = |name: &str| self.values(&format!("/statistical/{way}{name}_force"));
        let size: Vec<f64> = mean("adhesion")?.iter().zip(&mean("contact")?).map(|(a, b)| a.abs() + b.abs()).collect();
        self.triangle(&format!("/statistical/{way}*_force_std"), &all, &size);
        Ok(())
    }

    /// The deviation of a difference is between the difference and the sum of the deviations.
    fn triangle(&mut self, path: &str, [adhesion, contact, external]: &[Vec<f64>; 3], size: &[f64]) {
        let fails = |i: &usize| {
            let (a, p, f, slack) =
                (adhesion[*i], contact[*i], external[*i], 1e-6 * (adhesion[*i] + contact[*i]) + 1e-10 * size[*i]);
            !(f.is_nan() || f <= a + p + slack && f >= (a - p).abs() - slack)
        };
        let length = adhesion.len().min(contact.len()).min(external.len());
        if let Some(i) = (0..length).find(fails) {
            self.say(path, &format!("has no deviations at {i} that those of a difference can be"));
        }
    }

    /// z-scores.
    fn scores(&mut self, way: &str) -> Result<(), Failure> {
        for name in ["adhesion_force", "external_force"] {
            let mean = self.values(&format!("/ensemble/{way}{name}_mean"))?;
            let expected = self.values(&format!("/statistical/{way}{name}"))?;
            let std = if self.group == 1 {
                self.values(&format!("/statistical/{way}{name}_std"))?
            } else {
                let root = (self.groups() as f64).sqrt();
                let errors = self.values(&format!("/ensemble/{way}{name}_standard_error"))?;
                errors.iter().map(|error| root * error).collect()
            };
            let scores = z_scores(&mean, &expected, &std, self.groups());
            let path = format!("/validation/{way}z_{name}");
            let found = self.values(&path)?;
            self.compare(&path, &found, &scores, |i| ROUNDING * (1.0 + scores[i].abs()), "means and integral");
        }
        Ok(())
    }

    /// What follows from nothing else cannot be far from the integral where many asperities touch.
    fn plausible(&mut self, way: &str) -> Result<(), Failure> {
        let s = self.values("/separation")?.len().max(1);
        let regimes = self.reader.texts("/regime")?;
        let counts = self.values(&format!("/statistical/{way}regime_count"))?;
        let touching = summed(&counts, s, |row| regimes.get(row).is_some_and(|name| is_contact(name)));
        let n = self.replicas as f64;
        for quantity in [Quantity::ContactForce, Quantity::ContactArea] {
            let name = quantity.name();
            let [mean, std] = ["mean", "std"].map(|of| self.values(&format!("/ensemble/{way}{name}_{of}")));
            let [expected, by_integral] = ["", "_std"].map(|of| self.values(&format!("/statistical/{way}{name}{of}")));
            let (mean, std, expected, by_integral) = (mean?, std?, expected?, by_integral?);
            let is_far = |i: &usize| {
                let error = by_integral[*i] / n.sqrt() + ROUNDING * expected[*i];
                n * touching[*i] > POPULATED && (mean[*i] - expected[*i]).abs() > 12.0 * error
            };
            let scatters_otherwise = |i: &usize| {
                let ratio = std[*i] / by_integral[*i];
                n >= 40.0 && n * touching[*i] > POPULATED && by_integral[*i] > 0.0 && !(0.4..=2.5).contains(&ratio)
            };
            // The scheme of sampling changes the scatter within a group, not that of one replica.
            if let Some(i) = (0..s).find(is_far) {
                self.say(
                    &format!("/ensemble/{way}{name}_mean"),
                    &format!("is far from /statistical/{way}{name} at {i}"),
                );
            }
            if let Some(i) = (0..s).find(scatters_otherwise) {
                let integral = format!("/statistical/{way}{name}_std");
                self.say(&format!("/ensemble/{way}{name}_std"), &format!("is far from {integral} at {i}"));
            }
        }
        Ok(())
    }

    /// Asperities: of all regimes together, and those that come into contact and lose it.
    fn counts(&mut self, cycle: bool) -> Result<(), Failure> {
        let s = self.values("/separation")?.len().max(1);
        let own = self.values("/replicas/asperity_count")?;
        let mean = own.iter().sum::<f64>() / own.len().max(1) as f64;
        if self.reader.optional_text("/", "count")?.is_some_and(|count| count == "fixed")
            && own.windows(2).any(|pair| pair[0] != pair[1])
        {
            self.say("/replicas/asperity_count", "differs, and the number is fixed");
        }
        let regimes = self.reader.texts("/regime")?;
        for way in if cycle { &["", "retraction_"][..] } else { &[""] } {
            let expected = self.values(&format!("/statistical/{way}regime_count"))?;
            let expected = summed(&expected, s, |_| true);
            let all = expected.iter().copied().fold(0.0, f64::max);
            let path = format!("/ensemble/{way}regime_count_mean");
            let counts = self.values(&path)?;
            let sum = summed(&counts, s, |_| true);
            // The law `emd` may end before the first asperity: what is beyond its last regime is in none.
            let scatter = 1e-6 + 12.0 / (mean * own.len() as f64).sqrt();
            let ends = all < mean * (1.0 - scatter) && self.reader.optional_text("/", "law")?.as_deref() == Some("emd");
            let complete = |i: &usize| !ends && self.replicas as f64 * (all - expected[*i]) < 1e-6 * all.max(1.0);
            let wrong =
                (0..s).find(|i| sum[*i] > mean * (1.0 + ROUNDING) || complete(i) && sum[*i] < mean * (1.0 - 1e-6));
            if let Some(i) = wrong {
                self.say(&path, &format!("has {:e} asperities at {i}, and the replicas have {mean:e}", sum[i]));
            }
            if !ends && (all - mean).abs() > scatter * mean {
                self.say(
                    &format!("/statistical/{way}regime_count"),
                    &format!("has {all:e} asperities, and the replicas {mean:e}"),
                );
            }
        }
        self.highest(&own, &regimes, s)?;
        if !cycle {
            return Ok(());
        }
        for (name, way) in [("jump_in_count", ""), ("jump_off_count", "retraction_")] {
            for (group, of) in [("ensemble", "_mean"), ("statistical", "")] {
                let counts = self.values(&format!("/{group}/{way}regime_count{of}"))?;
                let apart = summed(&counts, s, |row| regimes.get(row).is_some_and(|name| !is_contact(name)));
                let changes: Vec<f64> = apart.windows(2).map(|pair| pair[1] - pair[0]).collect();
                let path = format!("/{group}/{name}{of}");
                let found = self.values(&path)?;
                self.compare(&path, &found, &changes, |_| ROUNDING * mean, "the counts of the regimes");
            }
        }
        Ok(())
    }

    /// The highest asperities: one that is above the other surface touches it.
    fn highest(&mut self, asperities: &[f64], regimes: &[String], s: usize) -> Result<(), Failure> {
        const PATH: &str = "/replicas/highest_asperity";
        let highest = self.values(PATH)?;
        let is_wrong = |i: &usize| {
            let (count, highest) = (asperities[*i], highest[*i]);
            count > 0.0 && !highest.is_finite() || count >= MANY && highest <= 0.0
        };
        if let Some(i) = (0..highest.len().min(asperities.len())).find(is_wrong) {
            self.say(PATH, &format!("has {:e} at {i}, of {} asperities", highest[i], asperities[i]));
        }
        let counts = self.values("/ensemble/regime_count_mean")?;
        let touching = summed(&counts, s, |row| regimes.get(row).is_some_and(|name| is_contact(name)));
        let all = summed(&counts, s, |_| true);
        let mean = asperities.iter().sum::<f64>() / asperities.len().max(1) as f64;
        for (k, d) in self.values("/asperity_separation")?.into_iter().enumerate() {
            let above = highest.iter().filter(|highest| **highest > d).count() as f64;
            // A law may end before.
            if all[k] >= mean * (1.0 - ROUNDING) && above > self.replicas as f64 * touching[k] * (1.0 + ROUNDING) + 0.5
            {
                self.say(PATH, &format!("is above the other surface in {above} replicas at {k}, more than touch"));
                break;
            }
        }
        Ok(())
    }

    /// Means over replicas.
    fn scalars(&mut self, cycle: bool) -> Result<(), Failure> {
        let names = names(cycle);
        let of = |name: &str| format!("/ensemble/scalar_{name}");
        let [mean, error, controlled, controlled_error, reduction] =
            ["mean", "standard_error", "controlled_mean", "controlled_standard_error", "variance_reduction"]
                .map(|name| self.values(&of(name)));
        let (mean, error, controlled) = (mean?, error?, controlled?);
        let (controlled_error, reduction) = (controlled_error?, reduction?);
        let mut moments = Moments::new(names.len());
        let mut columns = Vec::new();
        for name in &names {
            columns.push(self.values(&format!("/replicas/{name}"))?);
        }
        let largest: Vec<f64> = columns
            .iter()
            .map(|column| column.iter().fold(0.0, |largest: f64, value| largest.max(value.abs())))
            .collect();
        let group = self.group as usize;
        for first in (0..self.replicas as usize).step_by(group) {
            let mean = |column: &Vec<f64>| {
                column.get(first..first + group).map_or(f64::NAN, |own| own.iter().sum::<f64>() / group as f64)
            };
            moments.push(&columns.iter().map(mean).collect::<Vec<f64>>());
        }
        self.compare(&of("mean"), &mean, moments.mean(), |i| ROUNDING * largest[i], "/replicas");
        let errors = moments.standard_error();
        self.compare(
            &of("standard_error"),
            &error,
            &errors,
            |i| ROUNDING * (errors[i] + 1e-3 * largest[i]),
            "/replicas",
        );
        for (name, mean, error) in
            [("interval", &mean, &error), ("controlled_interval", &controlled, &controlled_error)]
        {
            if !self.has(&of(name)) {
                continue;
            }
            let (ends, few) = (self.values(&of(name))?, self.groups() < 20);
            let is_off = |(i, ends): (usize, &[f64])| {
                let (width, slack) = (ends[1] - ends[0], ROUNDING * largest[i]);
                let is_near = (ends[0] - width - slack..=ends[1] + width + slack).contains(&mean[i]);
                let is_known = !ends[0].is_nan() || !few && error[i] > 0.0;
                is_known && !(is_near && width >= -slack && (few || width <= FARTHEST * error[i] + slack))
            };
            if let Some(i) = ends.chunks_exact(2).enumerate().position(is_off) {
                self.say(&of(name), &format!("is none of the mean at {i}"));
            }
        }
        let ratios: Vec<f64> = error.iter().zip(&controlled_error).map(|(all, own)| (all / own).powi(2)).collect();
        // Of what does not vary beside its controls there is no number.
        let found: Vec<f64> =
            reduction.iter().zip(&ratios).map(|(own, all)| if all.is_finite() { *own } else { *all }).collect();
        self.compare(&of("variance_reduction"), &found, &ratios, |i| ROUNDING * ratios[i], "standard errors");
        let is_far = |i: &usize| {
            let (plain, own) = (mean[*i], controlled[*i]);
            plain.is_nan() != own.is_nan() || (own - plain).abs() > FARTHEST * error[*i] + ROUNDING * largest[*i]
        };
        if let Some(i) = (0..mean.len().min(controlled.len()).min(error.len())).find(is_far) {
            self.say(&of("controlled_mean"), &format!("is far from the plain mean at {i}"));
        }
        let is_worse = |i: &usize| controlled_error[*i] > FARTHEST * error[*i] + ROUNDING * largest[*i];
        if let Some(i) = (0..error.len().min(controlled_error.len())).find(is_worse) {
            self.say(&of("controlled_standard_error"), &format!("is far above the plain one at {i}"));
        }
        if cycle && self.reader.optional_text("/", "radii")?.is_some_and(|radii| radii.contains("common")) {
            let touchdown = self.values("/replicas/touchdown_separation")?;
            let highest = self.values("/replicas/highest_asperity")?;
            let differences: Vec<f64> =
                touchdown.iter().zip(&highest).map(|(h, u)| h - u).filter(|d| !d.is_nan()).collect();
            let (low, high) =
                differences.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), d| (d.min(low), d.max(high)));
            if high - low > ROUNDING * largest.last().copied().unwrap_or_default().max(1e-9) {
                self.say(
                    "/replicas/touchdown_separation",
                    "is not as far from /replicas/highest_asperity for all replicas",
                );
            }
        }
        Ok(())
    }

    /// Targets repeat scalars.
    fn targets(&mut self) -> Result<(), Failure> {
        if self.place.is_some() || !self.has("/target") {
            return Ok(());
        }
        let names = names(false);
        let (targets, estimates) = (self.reader.texts("/target")?, self.reader.texts("/ensemble/target_estimate")?);
        let of = |name: &str| self.values(&format!("/ensemble/{name}"));
        let (mean, error) = (of("target_mean")?, of("target_standard_error")?);
        let (largest, met) = (of("target_largest_standard_error")?, of("target_met")?);
        let column = |of_plain: &str, of_controlled: &str| -> Result<Vec<f64>, Failure> {
            let (plain, controlled) = (of(of_plain)?, of(of_controlled)?);
            let value = |(target, estimate): (&String, &String)| {
                let scalar = names.iter().position(|name| name == target)?;
                (if estimate == "controlled" { &controlled } else { &plain }).get(scalar).copied()
            };
            Ok(targets.iter().zip(&estimates).map(|pair| value(pair).unwrap_or(f64::NAN)).collect())
        };
        let of_means = column("scalar_mean", "scalar_controlled_mean")?;
        let of_errors = column("scalar_standard_error", "scalar_controlled_standard_error")?;
        self.compare("/ensemble/target_mean", &mean, &of_means, |i| ROUNDING * of_means[i].abs(), "its scalar");
        self.compare("/ensemble/target_standard_error", &error, &of_errors, |i| ROUNDING * of_errors[i], "its scalar");
        let is_met: Vec<f64> =
            error.iter().zip(&largest).map(|(error, largest)| f64::from(u8::from(error <= largest))).collect();
        self.compare("/ensemble/target_met", &met, &is_met, |_| 0.0, "the standard errors");
        Ok(())
    }

    /// What follows from the curves of the replicas, where the file has them.
    fn curves(&mut self, cycle: bool) -> Result<(), Failure> {
        if !self.has("/replicas/external_force") {
            return Ok(());
        }
        let separations = self.values("/separation")?;
        let s = separations.len().max(1);
        if self.place.is_some() && self.replicas as usize * s > MOST_AT_POINT {
            return Ok(());
        }
        let ways: &[&str] = if cycle { &["", "retraction_"] } else { &[""] };
        let paths: Vec<String> = ways
            .iter()
            .flat_map(|way| ["external_force", "adhesion_force"].map(|name| format!("/replicas/{way}{name}")))
            .collect();
        let mut moments: Vec<[Moments; 2]> = paths.iter().map(|_| [Moments::new(s), Moments::new(s)]).collect();
        let group = self.group as usize;
        let controls: Vec<f64> = self.values("/control")?.into_iter().filter(|control| !control.is_nan()).collect();
        let controls: Vec<usize> =
            controls.iter().filter_map(|control| separations.iter().position(|h| h == control)).collect();
        let names = names(cycle);
        let columns =
            names.iter().map(|name| self.values(&format!("/replicas/{name}"))).collect::<Result<Vec<_>, _>>()?;
        let mut parts: Vec<CentralMoments> =
            (0..PARTS).map(|_| CentralMoments::new(controls.len() + names.len())).collect();
        let span = if self.place.is_none() { self.number("/", "stiffness_span").ok() } else { None };
        let mut wrong: Vec<(&str, usize)> = Vec::new();
        let rows = (ROWS / group).max(1) * group;
        for first in (0..self.replicas as usize).step_by(rows) {
            let end = (first + rows).min(self.replicas as usize);
            let mut chunk = Vec::new();
            for path in &paths {
                chunk.push(match self.place {
                    None => self.reader.rows::<f64>(path, first..end)?,
                    Some(_) => self.values(path)?[first * s..end * s].to_vec(),
                });
            }
            for (path, values) in paths.iter().zip(&chunk) {
                if let Some(i) = values.iter().position(|value| !value.is_finite()) {
                    self.say(path, &format!("has {:e} at {} of replica {}", values[i], i % s, first + i / s));
                    return Ok(());
                }
            }
            for (pair, forces) in paths.chunks_exact(2).zip(chunk.chunks_exact(2)) {
                let contact = |i: &usize| {
                    let (external, adhesion) = (forces[0][*i], forces[1][*i]);
                    external + adhesion < -ROUNDING * (external.abs() + adhesion.abs())
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
            let pulled = if cycle { &chunk[2] } else { &chunk[0] };
            for replica in first..end {
                let row = |values: &Vec<f64>| values[(replica - first) * s..(replica - first + 1) * s].to_vec();
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
                if let Some(span) = span.filter(|span| s > 1 && *span <= separations[s - 1] - separations[0]) {
                    let secant = largest_secant(&separations, &curve, span);
                    let close = |a: f64, b: f64| (a - b).abs() <= ROUNDING * (b.abs() + size / span);
                    check("peak_secant_stiffness", close(of("peak_secant_stiffness"), secant.value));
                }
                if cycle {
                    check(
                        "approach_pull_off_force",
                        of("approach_pull_off_force") >= -lowest(&there) - ROUNDING * size,
                    );
                    let difference = |k: usize| there[k] - curve[k];
                    let strip =
                        |k: usize| 0.5 * (separations[k + 1] - separations[k]) * (difference(k) + difference(k + 1));
                    // By the trapezoidal rule.
                    let area: f64 = (0..s - 1).map(strip).sum();
                    let tolerance = 1e-7 * size * (separations[s - 1] - separations[0]);
                    check("dissipated_energy", (of("dissipated_energy") - area).abs() <= tolerance);
                }
            }
            for group_first in (first..end).step_by(group) {
                let mean =
                    |of: &dyn Fn(usize) -> f64| (group_first..group_first + group).map(of).sum::<f64>() / group as f64;
                let control = |&place: &usize| mean(&|replica| pulled[(replica - first) * s + place]);
                let scalar = |column: &Vec<f64>| mean(&|replica| column[replica]);
                let values: Vec<f64> = controls.iter().map(control).chain(columns.iter().map(scalar)).collect();
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
            for (of, expected) in
                [("mean", all.mean().to_vec()), ("std", all.std()), ("standard_error", of_groups.standard_error())]
            {
                let path = format!("{name}_{of}");
                let found = self.values(&path)?;
                self.compare(&path, &found, &expected, |i| ROUNDING * size[i], "the curves of the replicas");
            }
        }
        // Of a part of a run the batches are not those of the parts.
        if !self.reader.has_attribute("/", "partial")? {
            let way = if cycle { "retraction_" } else { "" };
            let expected = self.values(&format!("/statistical/{way}external_force"))?;
            let expected: Vec<f64> = controls.iter().map(|&place| expected[place]).collect();
            let means = controlled_means(&parts, &expected);
            let plain: Vec<f64> = means.iter().map(|mean| mean.standard_error).collect();
            for (name, expected) in [
                ("controlled_mean", means.iter().map(|mean| mean.controlled_mean).collect::<Vec<f64>>()),
                ("controlled_standard_error", means.iter().map(|mean| mean.controlled_standard_error).collect()),
            ] {
                let path = format!("/ensemble/scalar_{name}");
                let found = self.values(&path)?;
                let tolerance = |i: usize| 1e-4 * plain[i] + 1e-12 * expected[i].abs();
                self.compare(&path, &found, &expected, tolerance, "the curves of the replicas");
            }
        }
        Ok(())
    }

    /// How often surfaces snap.
    fn snaps(&mut self) -> Result<(), Failure> {
        for name in ["in", "off"] {
            if !self.has(&format!("/replicas/snap_{name}")) {
                continue;
            }
            let snap = self.values(&format!("/replicas/snap_{name}"))?;
            let distance = self.values(&format!("/replicas/snap_{name}_distance"))?;
            let places = snap.len() / (self.replicas as usize).max(1);
            let column = |place: usize| snap.iter().zip(&distance).skip(place).step_by(places.max(1));
            let count = |does: &dyn Fn(f64, f64) -> bool| -> Vec<f64> {
                (0..places)
                    .map(|place| column(place).filter(|(snap, distance)| does(**snap, **distance)).count() as f64)
                    .collect()
            };
            let (taken, snaps) = (count(&|snap, _| !snap.is_nan()), count(&|snap, _| snap == 1.0));
            let interval = |i: usize| wilson_interval(snaps[i] as u64, taken[i] as u64);
            let of = |f: &dyn Fn(usize) -> f64| (0..places).map(f).collect::<Vec<f64>>();
            let mut expected = vec![
                (format!("snap_{name}_count"), snaps.clone()),
                (format!("snap_{name}_probability"), of(&|i| snaps[i] / taken[i])),
                (format!("snap_{name}_probability_low"), of(&|i| interval(i).0)),
                (format!("snap_{name}_probability_high"), of(&|i| interval(i).1)),
            ];
            if name == "off" {
                expected.push(("fly_off_count".to_owned(), count(&|snap, distance| snap == 1.0 && distance.is_nan())));
            }
            for (path, expected) in expected {
                let path = format!("/instability/{path}");
                let found = self.values(&path)?;
                self.compare(&path, &found, &expected, |_| 1e-12, "/replicas");
            }
        }
        if self.has("/replicas/turned_pull_off_force") {
            let forces = self.values("/replicas/turned_pull_off_force")?;
            let turns = (forces.len() / (self.replicas as usize).max(1)).max(1);
            let mut expected: [Vec<f64>; 3] = Default::default();
            for turn in 0..turns {
                let mut moments = Moments::new(1);
                let own = forces.iter().skip(turn).step_by(turns).filter(|force| !force.is_nan());
                own.for_each(|force| moments.push(&[*force]));
                let mean = if moments.count() == 0 { f64::NAN } else { moments.mean()[0] };
                let values = [moments.count() as f64, mean, moments.std()[0]];
                expected.iter_mut().zip(values).for_each(|(expected, value)| expected.push(value));
            }
            let size: Vec<f64> = expected[1].iter().map(|mean| if mean.is_nan() { 0.0 } else { mean.abs() }).collect();
            for (name, expected) in
                ["turned_count", "turned_pull_off_force_mean", "turned_pull_off_force_std"].iter().zip(&expected)
            {
                let path = format!("/instability/{name}");
                let found = self.values(&path)?;
                self.compare(&path, &found, expected, |i| ROUNDING * size[i], "/replicas");
            }
        }
        Ok(())
    }

    /// The pull-off of the mean curve and of the integral.
    fn pull_off(&mut self, cycle: bool) -> Result<(), Failure> {
        let way = if cycle { "retraction_" } else { "" };
        let h = self.values("/separation")?;
        for (group, path) in [
            ("/ensemble", format!("/ensemble/{way}external_force_mean")),
            ("/statistical", format!("/statistical/{way}external_force")),
        ] {
            let curve = self.values(&path)?;
            let size = curve.iter().fold(0.0, |size: f64, force| size.max(force.abs()));
            let (force, place) = (self.number(group, "pull_off_force")?, self.number(group, "pull_off_separation")?);
            let lowest = curve.iter().copied().fold(f64::INFINITY, f64::min);
            let at = curve.iter().position(|force| *force == lowest).unwrap_or_default();
            let near = &curve[at.saturating_sub(2)..(at + 3).min(curve.len())];
            let range = near.iter().copied().fold(f64::NEG_INFINITY, f64::max) - lowest;
            if !(force >= -lowest - 1e-6 * size && force <= -lowest + 2.0 * range + 1e-6 * size) {
                self.say(&format!("{group} pull_off_force"), &format!("is {force:e}, and the curve has {:e}", -lowest));
            }
            if !(h.first().is_some_and(|first| place >= *first) && h.last().is_some_and(|last| place <= *last)) {
                self.say(&format!("{group} pull_off_separation"), &format!("is {place:e}, beyond the separations"));
            }
        }
        self.at_pull_off(way, &h)
    }

    /// What is told at the pull-off of the integral is near what is told at the separations beside it; where nothing pulls, it is told at the
    /// smallest separation.
    fn at_pull_off(&mut self, way: &str, h: &[f64]) -> Result<(), Failure> {
        if !self.has("/statistical/pull_off_contact_area") {
            return Ok(());
        }
        let pulls = self.number("/statistical", "pull_off_force")? > 0.0;
        let place = if pulls { self.number("/statistical", "pull_off_separation")? } else { h[0] };
        let next = h.iter().position(|h| *h >= place).unwrap_or(h.len());
        let near = next.saturating_sub(1)..(next + 1).min(h.len());
        for (name, of) in [
            ("regime_count", "regime_count"),
            ("regime_adhesion_force", "adhesion_force"),
            ("contact_area", "contact_area"),
        ] {
            let path = format!("/statistical/pull_off_{name}");
            let sum = self.values(&path)?.iter().sum::<f64>();
            let curve = summed(&self.values(&format!("/statistical/{way}{of}"))?, h.len().max(1), |_| true);
            let largest = curve[near.clone()].iter().copied().fold(0.0, f64::max);
            if !(sum <= 2.0 * largest) {
                self.say(&path, &format!("comes to {sum:e}, and beside the pull-off there is {largest:e}"));
            }
        }
        self.adhesion_at_pull_off(way, h.len())
    }

    /// The adhesion of an asperity at pull-off is no more than it is at some separation, regime by regime.
    fn adhesion_at_pull_off(&mut self, way: &str, s: usize) -> Result<(), Failure> {
        const PATH: &str = "/statistical/pull_off_regime_adhesion_force";
        let [counts, forces] =
            ["count", "adhesion_force"].map(|name| self.values(&format!("/statistical/pull_off_regime_{name}")));
        let [all_counts, all_forces] =
            ["count", "adhesion_force"].map(|name| self.values(&format!("/statistical/{way}regime_{name}")));
        let (counts, forces, all_counts, all_forces) = (counts?, forces?, all_counts?, all_forces?);
        let of_one = |force: f64, count: f64| if count > 0.0 { force / count } else { 0.0 };
        let is_more = |regime: &usize| {
            let rows = regime * s..((regime + 1) * s).min(all_counts.len());
            let largest = rows.map(|i| of_one(all_forces[i], all_counts[i])).fold(0.0, f64::max);
            of_one(forces[*regime], counts[*regime]) > 1.5 * largest
        };
        if let Some(regime) = (0..counts.len().min(forces.len())).find(is_more) {
            self.say(
                PATH,
                &format!("has {:e} in regime {regime}, more than its asperities have anywhere", forces[regime]),
            );
        }
        Ok(())
    }

    /// What the file says of the joint test.
    fn joint_test(&mut self) -> Result<(), Failure> {
        let (statistic, p) = (self.number("/validation", "statistic")?, self.number("/validation", "p_value")?);
        let JointTest { statistic: own, p_value, .. } = *self.joint;
        self.compare("/validation statistic", &[statistic], &[own], |_| 1e-6 * own.abs(), "means and integral");
        self.compare("/validation p_value", &[p], &[p_value], |_| 1e-6, "means and integral");
        Ok(())
    }
}

/// The names of the scalars of `/replicas`.
fn names(cycle: bool) -> Vec<&'static str> {
    SCALARS.iter().chain(LOOP_SCALARS.iter().filter(|_| cycle)).map(|scalar| scalar.name).collect()
}

fn is_contact(name: &str) -> bool {
    Regime::ALL.iter().any(|regime| regime.name() == name && regime.is_contact())
}

/// The sums over some rows of so many columns.
fn summed(values: &[f64], columns: usize, of: impl Fn(usize) -> bool) -> Vec<f64> {
    let mut sums = vec![0.0; columns];
    for (_, row) in values.chunks_exact(columns).enumerate().filter(|(row, _)| of(*row)) {
        sums.iter_mut().zip(row).for_each(|(sum, value)| *sum += value);
    }
    sums
}
