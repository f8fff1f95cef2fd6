//! Curves of forces and areas: F = P − F_s, sums of regimes, deviations, z-scores and pull-off.

use super::checked::{Checked, Place, ROUNDING, is_contact, largest, summed};
use crate::asperity::Quantity;
use crate::output::OutputError;
use crate::validation::z_scores;

/// Longest step of the separations, in σ, over which the background is about a line, and the share of the
/// largest value by which it may be off.
const LONGEST_STEP: f64 = 0.5;
const CURVED: f64 = 0.1;
/// Contacts of all replicas from which on means and deviations are near those of the integral.
const POPULATED: f64 = 2000.0;

impl Checked<'_> {
    /// Other ways to write the separations.
    pub fn separations(&mut self) -> Result<(), OutputError> {
        let h = self.coordinate("separation")?;
        let (std, offset) = (self.number("/", "surface_height_std")?, self.number("/", "mean_plane_offset")?);
        let largest = h.iter().fold(offset.abs(), |largest: f64, h| largest.max(h.abs()));
        let of = |f: &dyn Fn(f64) -> f64| h.iter().map(|&h| f(h)).collect::<Vec<f64>>();
        self.repeats("h_star", &of(&|h| h / std), ROUNDING * largest / std, "separation")?;
        self.repeats("asperity_separation", &of(&|h| h - offset), ROUNDING * largest, "separation")?;
        if self.has_coordinate("step") {
            let middles: Vec<f64> = h.windows(2).map(|pair| 0.5 * (pair[0] + pair[1])).collect();
            let found = self.coordinate("step")?;
            // Of a sweep whose points have separations of their own they are indices.
            let are_indices =
                self.place != Place::File && found.iter().enumerate().all(|(i, step)| *step == i as f64);
            let middles = if are_indices { found.clone() } else { middles };
            self.repeats("step", &middles, ROUNDING * largest, "separation")?;
        }
        if self.place == Place::File && self.has_coordinate("replica") && !self.is_partial()? {
            let indices: Vec<f64> = (0..self.replicas).map(|index| index as f64).collect();
            self.repeats("replica", &indices, 0.0, "the number of replicas")?;
        }
        let controls = if self.has_coordinate("control") { self.coordinate("control")? } else { Vec::new() };
        if let Some(i) = controls.iter().position(|control| !control.is_nan() && !h.contains(control)) {
            self.say_at(
                self.reader.coordinate("control"),
                i,
                controls[i],
                "one of the separations is expected",
            );
        }
        Ok(())
    }

    /// The attraction between the mean planes and that of liquid that spreads on a way, N, at a number of separations; 0 where the
    /// file has none.
    pub fn background(&self, way: &str, count: usize) -> Result<Vec<f64>, OutputError> {
        let paths = ["/background/force".to_owned(), format!("/capillary/{way}spread_force")];
        let mut sum = vec![0.0; count];
        for path in paths.iter().filter(|path| self.has(path)) {
            sum.iter_mut().zip(self.values(path)?).for_each(|(sum, own)| *sum += own);
        }
        Ok(sum)
    }

    /// F = P − F_s, less the attraction of the mean planes unless it is one asperity, and regimes add up to what
    /// they are of.
    pub fn sums(&mut self, group: &str, way: &str, of: &str) -> Result<(), OutputError> {
        let path = |name: &str| format!("/{group}/{way}{name}{of}");
        let [adhesion, contact, external] = [
            self.values(&path("adhesion_force"))?,
            self.values(&path("contact_force"))?,
            self.values(&path("external_force"))?,
        ];
        let background = match group {
            "asperity" => vec![0.0; adhesion.len()],
            _ => self.background(way, adhesion.len())?,
        };
        let tolerance = |i: usize| ROUNDING * (adhesion[i].abs() + contact[i].abs() + background[i].abs());
        let difference: Vec<f64> =
            (0..adhesion.len()).map(|i| contact[i] - adhesion[i] - background[i]).collect();
        self.compare(
            &path("external_force"),
            &external,
            &difference,
            tolerance,
            "contact less adhesion force and background",
        );
        let of_asperities: Vec<f64> = external.iter().zip(&background).map(|(all, own)| all + own).collect();
        let s = adhesion.len().max(1);
        if !self.has(&path("regime_count")) {
            return Ok(());
        }
        let regimes = self.reader.texts(self.reader.coordinate("regime"))?;
        let [by_adhesion, by_external] =
            [self.values(&path("regime_adhesion_force"))?, self.values(&path("regime_external_force"))?];
        for (name, total, parts) in
            [("adhesion_force", &adhesion, &by_adhesion), ("external_force", &of_asperities, &by_external)]
        {
            let sum = summed(parts, s, |_| true);
            let size = summed(&parts.iter().map(|part| part.abs()).collect::<Vec<f64>>(), s, |_| true);
            self.compare(
                &path(&format!("regime_{name}")),
                &sum,
                total,
                |i| ROUNDING * (size[i] + background[i].abs()),
                "all regimes together",
            );
        }
        // Before contact the external force is adhesion alone.
        let expected: Vec<f64> = (by_external.iter().zip(&by_adhesion).enumerate())
            .map(
                |(i, (own, adhesion))| {
                    if regimes.get(i / s).is_some_and(|name| is_contact(name)) { *own } else { -adhesion }
                },
            )
            .collect();
        let of_regimes = path("regime_external_force");
        self.compare(
            &of_regimes,
            &by_external,
            &expected,
            |i| ROUNDING * expected[i].abs(),
            "adhesion before contact",
        );
        let counts = self.values(&path("regime_count"))?;
        for (name, forces) in [("regime_adhesion_force", by_adhesion), ("regime_external_force", by_external)]
        {
            if let Some(i) =
                (0..counts.len().min(forces.len())).find(|&i| counts[i] == 0.0 && forces[i] != 0.0)
            {
                self.say_at(&path(name), i, forces[i], "0 is expected where no asperities are");
            }
        }
        Ok(())
    }

    /// The background: its terms add up, its energy is the integral of its force, and its stiffness that of a
    /// secant, as far as straight lines between separations tell.
    pub fn background_terms(&mut self) -> Result<(), OutputError> {
        if !self.has("/background/force") {
            return Ok(());
        }
        let path = |name: &str| format!("/background/{name}");
        let [force, dispersion, electrostatic, stiffness, energy] =
            ["force", "van_der_waals_force", "electrostatic_force", "stiffness", "energy"]
                .map(|name| self.values(&path(name)));
        let (force, dispersion, electrostatic) = (force?, dispersion?, electrostatic?);
        let (stiffness, energy) = (stiffness?, energy?);
        let sum: Vec<f64> = dispersion.iter().zip(&electrostatic).map(|(a, b)| a + b).collect();
        let size = largest(&dispersion).max(largest(&electrostatic));
        self.compare(&path("force"), &force, &sum, |_| ROUNDING * size, "the terms together");
        let (h, std) = (self.coordinate("separation")?, self.number("/", "surface_height_std")?);
        for k in 0..h.len().min(force.len()).saturating_sub(1) {
            let step = h[k + 1] - h[k];
            // On longer ones the background is no line.
            if step > LONGEST_STEP * std {
                continue;
            }
            let mean = |values: &[f64]| 0.5 * (values[k] + values[k + 1]);
            let spread = |values: &[f64]| 0.5 * (values[k] - values[k + 1]).abs();
            let (lost, fall) = (energy[k] - energy[k + 1], force[k] - force[k + 1]);
            let rounding = ROUNDING * (energy[k].abs() + energy[k + 1].abs() + size * std);
            if !((lost - step * mean(&force)).abs() <= step * (spread(&force) + CURVED * size) + rounding) {
                self.say_at(&path("energy"), k, energy[k], "the integral of the force is expected");
                break;
            }
            let most = spread(&stiffness) + CURVED * largest(&stiffness);
            if !((fall - step * mean(&stiffness)).abs() <= step * most + ROUNDING * size) {
                self.say_at(&path("stiffness"), k, stiffness[k], "the slope of the force is expected");
                break;
            }
        }
        Ok(())
    }

    /// Standard errors and deviations.
    pub fn errors(&mut self, way: &str) -> Result<(), OutputError> {
        let (n, groups) = (self.replicas as f64, self.groups() as f64);
        let mut of_forces = Vec::new();
        for quantity in Quantity::ALL {
            let name = format!("/ensemble/{way}{}", quantity.name());
            let path = format!("{name}_standard_error");
            let [mean, std, error] = [
                self.values(&format!("{name}_mean"))?,
                self.values(&format!("{name}_std"))?,
                self.values(&path)?,
            ];
            // Of independent replicas the error follows; of groups it is bounded, as their scatter is part of
            // that of all.
            let largest =
                if self.group == 1 { n.sqrt().recip() } else { ((n - 1.0) / (n * (groups - 1.0))).sqrt() };
            // Where all replicas agree no error is known.
            let known = |(i, std): (usize, &f64)| {
                let agree = error[i].is_nan() && *std <= ROUNDING * mean[i].abs();
                if agree { f64::NAN } else { largest * std }
            };
            let expected: Vec<f64> = std.iter().enumerate().map(known).collect();
            let tolerance =
                |i: usize| ROUNDING * (expected[i] + mean[i].abs() * largest) + 1e-12 * mean[i].abs();
            if self.group == 1 {
                self.compare(&path, &error, &expected, tolerance, "the standard deviation");
            } else if let Some(i) = (0..error.len()).find(|&i| {
                let is_lost = groups > 1.0 && error[i].is_nan() && !expected[i].is_nan();
                is_lost || error[i] > expected[i] + tolerance(i)
            }) {
                self.say_at(&path, i, error[i], &format!("the standard deviation allows {:e}", expected[i]));
            }
            of_forces.push((mean, [std, error.iter().map(|error| error.max(0.0)).collect()]));
        }
        for (i, name) in ["std", "standard_error"].into_iter().enumerate() {
            let of = |quantity: Quantity| of_forces[quantity.index()].1[i].clone();
            let own = |quantity: Quantity| &of_forces[quantity.index()].0;
            let background = self.background(way, own(Quantity::AdhesionForce).len())?;
            let size: Vec<f64> = own(Quantity::AdhesionForce)
                .iter()
                .zip(own(Quantity::ContactForce))
                .zip(background)
                .map(|((a, b), c)| a.abs() + b.abs() + c.abs())
                .collect();
            let all = [of(Quantity::AdhesionForce), of(Quantity::ContactForce), of(Quantity::ExternalForce)];
            self.triangle(&format!("/ensemble/{way}*_force_{name}"), &all, &size);
        }
        Ok(())
    }

    /// Deviations by the integral.
    pub fn deviations(&mut self, way: &str) -> Result<(), OutputError> {
        let std = |name: &str| self.values(&format!("/integral/{way}{name}_force_std"));
        let all = [std("adhesion")?, std("contact")?, std("external")?];
        let mean = |name: &str| self.values(&format!("/integral/{way}{name}_force"));
        // Of asperities alone: the background does not scatter.
        let size: Vec<f64> =
            mean("adhesion")?.iter().zip(&mean("contact")?).map(|(a, b)| a.abs() + b.abs()).collect();
        self.triangle(&format!("/integral/{way}*_force_std"), &all, &size);
        Ok(())
    }

    /// The deviation of a difference is between the difference and the sum of the deviations.
    fn triangle(&mut self, path: &str, [adhesion, contact, external]: &[Vec<f64>; 3], size: &[f64]) {
        let fails = |i: &usize| {
            let (a, p, f, slack) = (
                adhesion[*i],
                contact[*i],
                external[*i],
                1e-6 * (adhesion[*i] + contact[*i]) + 1e-10 * size[*i],
            );
            !(f.is_nan() || f <= a + p + slack && f >= (a - p).abs() - slack)
        };
        let length = adhesion.len().min(contact.len()).min(external.len());
        if let Some(i) = (0..length).find(fails) {
            let [a, p, f] = [adhesion[i], contact[i], external[i]];
            let between = format!("from {:e} to {:e} for the external force", (a - p).abs(), a + p);
            self.say(path, &format!("have {a:e}, {p:e} and {f:e} at {i}, and the first two allow {between}"));
        }
    }

    /// Standard deviation of the mean of one group of replicas: 0 where all agree, which has no standard error.
    pub fn scatter_of_groups(&self, way: &str, name: &str) -> Result<Vec<f64>, OutputError> {
        let groups = self.groups();
        let errors = self.values(&format!("{}_standard_error", self.independent(way, name)))?;
        let scatter =
            |error: &f64| if groups > 1 { (groups as f64).sqrt() * error.max(0.0) } else { f64::NAN };
        Ok(errors.iter().map(scatter).collect())
    }

    /// z-scores.
    pub fn scores(&mut self, way: &str) -> Result<(), OutputError> {
        for name in ["adhesion_force", "external_force"] {
            let mean = self.values(&format!("{}_mean", self.independent(way, name)))?;
            let expected = self.values(&format!("/integral/{way}{name}"))?;
            let std = if self.group == 1 {
                self.values(&format!("/integral/{way}{name}_std"))?
            } else {
                self.scatter_of_groups(way, name)?
            };
            let scores = z_scores(&mean, &expected, &std, self.groups());
            let path = format!("/validation/{way}z_{name}");
            let found = self.values(&path)?;
            self.compare(
                &path,
                &found,
                &scores,
                |i| ROUNDING * (1.0 + scores[i].abs()),
                "means and integral",
            );
        }
        Ok(())
    }

    /// Values that follow from nothing else cannot be far from the integral where many asperities touch.
    pub fn plausible(&mut self, way: &str) -> Result<(), OutputError> {
        let s = self.coordinate("separation")?.len().max(1);
        let regimes = self.reader.texts(self.reader.coordinate("regime"))?;
        let counts = self.values(&format!("/integral/{way}regime_count"))?;
        let touching = summed(&counts, s, |row| regimes.get(row).is_some_and(|name| is_contact(name)));
        let n = self.replicas as f64;
        for quantity in [Quantity::ContactForce, Quantity::ContactArea] {
            let name = quantity.name();
            let path = self.independent(way, name);
            let [mean, std] = ["mean", "std"].map(|of| self.values(&format!("{path}_{of}")));
            let [expected, by_integral] =
                ["", "_std"].map(|of| self.values(&format!("/integral/{way}{name}{of}")));
            let (mean, std, expected, by_integral) = (mean?, std?, expected?, by_integral?);
            let is_far = |i: &usize| {
                let error = by_integral[*i] / n.sqrt() + ROUNDING * expected[*i];
                n * touching[*i] > POPULATED && (mean[*i] - expected[*i]).abs() > 12.0 * error
            };
            let scatters_otherwise = |i: &usize| {
                let ratio = std[*i] / by_integral[*i];
                n >= 40.0
                    && n * touching[*i] > POPULATED
                    && by_integral[*i] > 0.0
                    && !(0.4..=2.5).contains(&ratio)
            };
            // The scheme of sampling changes the scatter within a group, not that of one replica.
            if let Some(i) = (0..s).find(is_far) {
                let integral = format!("/integral/{way}{name} has {:e}", expected[i]);
                self.say_at(&format!("{path}_mean"), i, mean[i], &integral);
            }
            if let Some(i) = (0..s).find(scatters_otherwise) {
                let integral = format!("/integral/{way}{name}_std has {:e}", by_integral[i]);
                self.say_at(&format!("{path}_std"), i, std[i], &integral);
            }
        }
        Ok(())
    }
}
