//! Pull-off and stiffest point of curves, and what is told at pull-off.

use super::checked::{Checked, Place, ROUNDING, largest, summed};
use crate::experiment::integral::RESOLVING;
use crate::math::extrema::{MOST_ADDED, smallest};
use crate::output::OutputError;
use crate::scene::takes_heights;

/// Rounding of a slope over a hundredth of the space between separations, in forces over such a space.
const SLOPE_ROUNDING: f64 = 1e-11;
/// A slope of a smooth curve in a step is between these shares of the one that is the largest beside it.
const SLOPES: (f64, f64) = (0.5, 2.9);

impl Checked<'_> {
    /// Pull-off and stiffest point of the mean curve and of the integral.
    pub fn features(&mut self) -> Result<(), OutputError> {
        let way = if self.is_loop()? { "retraction_" } else { "" };
        let h = self.coordinate("separation")?;
        if h.len() < 2 {
            return Ok(());
        }
        let of_mean = ("/ensemble", format!("/ensemble/{way}external_force_mean"));
        let of_integral = ("/integral", format!("/integral/{way}external_force"));
        for (group, path) in [of_mean, of_integral] {
            // A comparison tells of the integral alone.
            if group == "/ensemble" && matches!(self.place, Place::Law(_)) {
                continue;
            }
            let curve = self.values(&path)?;
            self.deepest(group, &h, &curve)?;
            self.stiffest(group, &h, &curve)?;
        }
        if self.has("/integral/pull_off_contact_area") { self.at_pull_off(way, &h) } else { Ok(()) }
    }

    /// Whether heights are given ones, over which the integral jumps; none where the file does not say.
    pub fn jumps(&self) -> Result<Option<bool>, OutputError> {
        Ok(takes_heights(&self.reader.optional_text("/", "scene")?.unwrap_or_default()))
    }

    /// Whether the separations are those at which extrema are looked for: others were added between wider
    /// ones.
    fn is_resolved(&self, h: &[f64]) -> Result<bool, OutputError> {
        let std = self.number("/", "surface_height_std")?;
        let widest = (RESOLVING * std).max((h[h.len() - 1] - h[0]) / MOST_ADDED) * (1.0 + ROUNDING);
        Ok(self.jumps()? == Some(true) || h.windows(2).all(|pair| pair[1] - pair[0] <= widest))
    }

    /// The pull-off is as deep as the deepest sample of the curve, or a little deeper beside it.
    fn deepest(&mut self, group: &str, h: &[f64], curve: &[f64]) -> Result<(), OutputError> {
        let (force, place) =
            (self.number(group, "pull_off_force")?, self.number(group, "pull_off_separation")?);
        let (last, size) = (h.len() - 1, largest(curve));
        let at = smallest(&curve[..=last]);
        let near = &curve[at.saturating_sub(2)..(at + 3).min(h.len())];
        let range = near.iter().copied().fold(f64::NEG_INFINITY, f64::max) - curve[at];
        let path = |name: &str| format!("{group}/pull_off_{name}");
        if !(force >= -curve[at] - 1e-6 * size && force <= -curve[at] + 2.0 * range + 1e-6 * size) {
            self.say_at(&path("force"), 0, force, &format!("the curve has {:e}", -curve[at]));
        }
        let (first, last) = match self.is_resolved(h)? {
            true => (h[at.saturating_sub(1)], h[(at + 1).min(last)]),
            false => (h[0], h[last]),
        };
        if !(first <= place && place <= last) {
            self.say_at(
                &path("separation"),
                0,
                place,
                &format!("the curve is deepest from {first:e} to {last:e}"),
            );
        }
        Ok(())
    }

    /// The largest slope is that of the steepest step, or one beside it.
    fn stiffest(&mut self, group: &str, h: &[f64], curve: &[f64]) -> Result<(), OutputError> {
        let (value, place) =
            (self.number(group, "peak_stiffness")?, self.number(group, "peak_stiffness_separation")?);
        let path = |name: &str| format!("{group}/peak_stiffness{name}");
        let slopes: Vec<f64> =
            h.windows(2).zip(curve.windows(2)).map(|(h, f)| (f[1] - f[0]) / (h[1] - h[0])).collect();
        let at = (1..slopes.len()).fold(0, |best, k| if slopes[k] > slopes[best] { k } else { best });
        let narrowest = h.windows(2).fold(f64::INFINITY, |least: f64, pair| least.min(pair[1] - pair[0]));
        let rounding = SLOPE_ROUNDING * largest(curve) / narrowest;
        if largest(&slopes) <= rounding {
            // The force is constant.
            if !(value.abs() <= rounding) {
                self.say_at(&path(""), 0, value, "the curve has no slope");
            }
            return Ok(());
        }
        let slack = 1e-6 * largest(&slopes) + rounding;
        let resolved = self.is_resolved(h)?;
        let is_edge = resolved && (at == 0 || at + 1 == slopes.len());
        let slope = slopes[at];
        let (low, high) = match (is_edge, slope > 0.0) {
            (true, _) => (slope, slope),
            (false, true) => (SLOPES.0 * slope, SLOPES.1 * slope),
            (false, false) => (2.0 * slope, -slope),
        };
        if resolved
            && (is_edge || self.jumps()? == Some(false))
            && !(low - slack <= value && value <= high + slack)
        {
            self.say_at(&path(""), 0, value, &format!("the steepest step of the curve has {slope:e}"));
        }
        let (first, last) = match resolved {
            true => (h[at.saturating_sub(1)], h[(at + 2).min(h.len() - 1)]),
            false => (h[0], h[h.len() - 1]),
        };
        if !(first <= place && place <= last) {
            self.say_at(
                &path("_separation"),
                0,
                place,
                &format!("the curve is steepest from {first:e} to {last:e}"),
            );
        }
        Ok(())
    }

    /// Values at the pull-off of the integral are near those at the separations beside it; where
    /// nothing pulls, it is told at the smallest separation.
    fn at_pull_off(&mut self, way: &str, h: &[f64]) -> Result<(), OutputError> {
        if !self.has("/integral/pull_off_contact_area") {
            return Ok(());
        }
        let pulls = self.number("/integral", "pull_off_force")? > 0.0;
        let place = if pulls { self.number("/integral", "pull_off_separation")? } else { h[0] };
        let next = h.iter().position(|h| *h >= place).unwrap_or(h.len());
        let near = next.saturating_sub(1)..(next + 1).min(h.len());
        for (name, of) in [
            ("regime_count", "regime_count"),
            ("regime_adhesion_force", "adhesion_force"),
            ("contact_area", "contact_area"),
        ] {
            let path = format!("/integral/pull_off_{name}");
            let sum = self.values(&path)?.iter().sum::<f64>();
            let curve = summed(&self.values(&format!("/integral/{way}{of}"))?, h.len().max(1), |_| true);
            let largest = curve[near.clone()].iter().copied().fold(0.0, f64::max);
            if !(sum <= 2.0 * largest) {
                self.say(&path, &format!("comes to {sum:e}, and beside the pull-off there is {largest:e}"));
            }
        }
        self.adhesion_at_pull_off(way, h.len())
    }

    /// The adhesion of an asperity at pull-off is no more than it is at some separation, regime by regime.
    fn adhesion_at_pull_off(&mut self, way: &str, s: usize) -> Result<(), OutputError> {
        const PATH: &str = "/integral/pull_off_regime_adhesion_force";
        let [counts, forces] =
            ["count", "adhesion_force"].map(|name| self.values(&format!("/integral/pull_off_regime_{name}")));
        let [all_counts, all_forces] =
            ["count", "adhesion_force"].map(|name| self.values(&format!("/integral/{way}regime_{name}")));
        let (counts, forces, all_counts, all_forces) = (counts?, forces?, all_counts?, all_forces?);
        let of_one = |force: f64, count: f64| if count > 0.0 { force / count } else { 0.0 };
        let is_more = |regime: &usize| {
            let rows = regime * s..((regime + 1) * s).min(all_counts.len());
            let largest = rows.map(|i| of_one(all_forces[i], all_counts[i])).fold(0.0, f64::max);
            of_one(forces[*regime], counts[*regime]) > 1.5 * largest
        };
        if let Some(regime) = (0..counts.len().min(forces.len())).find(is_more) {
            self.say_at(PATH, regime, forces[regime], "its asperities have less at every separation");
        }
        Ok(())
    }
}
