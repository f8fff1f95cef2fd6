//! Means of what is read off the curve of a replica, and targets.

use super::checked::{Checked, ROUNDING, names};
use crate::engine::Ways;
use crate::math::moments::Moments;
use crate::output::OutputError;

/// A mean with control variates is no more standard errors of the plain one away from this.
pub(super) const FARTHEST: f64 = 50.0;

impl Checked<'_> {
    /// Means over replicas.
    pub fn scalars(&mut self, ways: Ways) -> Result<(), OutputError> {
        let names = names(ways);
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
                column
                    .get(first..first + group)
                    .map_or(f64::NAN, |own| own.iter().sum::<f64>() / group as f64)
            };
            moments.push(&columns.iter().map(mean).collect::<Vec<f64>>());
        }
        self.compare(&of("mean"), &mean, moments.mean(), |i| ROUNDING * largest[i], "/replicas");
        // Where all replicas agree no error is known.
        let known = |(i, of): (usize, f64)| {
            if error[i].is_nan() && of <= ROUNDING * largest[i] { f64::NAN } else { of }
        };
        let errors: Vec<f64> = moments.standard_error().into_iter().enumerate().map(known).collect();
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
                let expected =
                    format!("the mean {:e} with the error {:e} is expected within", mean[i], error[i]);
                self.say_at(&of(name), 2 * i, ends[2 * i], &expected);
            }
        }
        let ratios: Vec<f64> =
            error.iter().zip(&controlled_error).map(|(all, own)| (all / own).powi(2)).collect();
        // Of what does not vary beside its controls there is no number.
        let found: Vec<f64> = reduction
            .iter()
            .zip(&ratios)
            .map(|(own, all)| if all.is_finite() { *own } else { *all })
            .collect();
        self.compare(&of("variance_reduction"), &found, &ratios, |i| ROUNDING * ratios[i], "standard errors");
        let is_far = |i: &usize| {
            let (plain, own) = (mean[*i], controlled[*i]);
            plain.is_nan() != own.is_nan()
                || (own - plain).abs() > FARTHEST * error[*i] + ROUNDING * largest[*i]
        };
        if let Some(i) = (0..mean.len().min(controlled.len()).min(error.len())).find(is_far) {
            self.say_at(
                &of("controlled_mean"),
                i,
                controlled[i],
                &format!("the plain mean is {:e}", mean[i]),
            );
        }
        let is_worse = |i: &usize| controlled_error[*i] > FARTHEST * error[*i] + ROUNDING * largest[*i];
        if let Some(i) = (0..error.len().min(controlled_error.len())).find(is_worse) {
            let plain = format!("the plain one is {:e}", error[i]);
            self.say_at(&of("controlled_standard_error"), i, controlled_error[i], &plain);
        }
        // Coupled asperities of one height touch at different separations.
        let is_coupled = self.is_coupled();
        if ways != Ways::One
            && !is_coupled
            && self.reader.optional_text("/", "radii")?.is_some_and(|radii| radii.contains("common"))
        {
            let touchdown = self.values("/replicas/touchdown_separation")?;
            let highest = self.values("/replicas/highest_asperity")?;
            let differences: Vec<f64> =
                touchdown.iter().zip(&highest).map(|(h, u)| h - u).filter(|d| !d.is_nan()).collect();
            let (low, high) = differences
                .iter()
                .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), d| (d.min(low), d.max(high)));
            let most = touchdown.iter().fold(0.0, |most: f64, h| most.max(h.abs()));
            if high - low > ROUNDING * most.max(1e-9) {
                self.say(
                    "/replicas/touchdown_separation",
                    "is not as far from /replicas/highest_asperity for all replicas",
                );
            }
        }
        Ok(())
    }

    /// Targets repeat scalars.
    pub fn targets(&mut self) -> Result<(), OutputError> {
        if !self.has_coordinate("target") {
            return Ok(());
        }
        let names = names(Ways::One);
        let (targets, estimates) = (
            self.reader.texts(self.reader.coordinate("target"))?,
            self.reader.texts("/ensemble/target_estimate")?,
        );
        let of = |name: &str| self.values(&format!("/ensemble/{name}"));
        let (mean, error) = (of("target_mean")?, of("target_standard_error")?);
        let (largest, met) = (of("target_largest_standard_error")?, of("target_met")?);
        let column = |of_plain: &str, of_controlled: &str| -> Result<Vec<f64>, OutputError> {
            let (plain, controlled) = (of(of_plain)?, of(of_controlled)?);
            let value = |(target, estimate): (&String, &String)| {
                let scalar = names.iter().position(|name| name == target)?;
                (if estimate == "controlled" { &controlled } else { &plain }).get(scalar).copied()
            };
            Ok(targets.iter().zip(&estimates).map(|pair| value(pair).unwrap_or(f64::NAN)).collect())
        };
        let of_means = column("scalar_mean", "scalar_controlled_mean")?;
        let of_errors = column("scalar_standard_error", "scalar_controlled_standard_error")?;
        self.compare(
            "/ensemble/target_mean",
            &mean,
            &of_means,
            |i| ROUNDING * of_means[i].abs(),
            "its scalar",
        );
        self.compare(
            "/ensemble/target_standard_error",
            &error,
            &of_errors,
            |i| ROUNDING * of_errors[i],
            "its scalar",
        );
        let is_met: Vec<f64> = error
            .iter()
            .zip(largest.iter().zip(&met))
            .map(
                |(error, (largest, met))| {
                    if error.is_nan() { *met } else { f64::from(u8::from(error <= largest)) }
                },
            )
            .collect();
        self.compare("/ensemble/target_met", &met, &is_met, |_| 0.0, "the standard errors");
        Ok(())
    }
}
