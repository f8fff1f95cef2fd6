//! Whether asperities may be taken as independent: each figure follows from others of the file, and the
//! verdict from the figures.

use super::checked::{Checked, Place, ROUNDING, largest};
use crate::experiment::independence::FIGURES;
use crate::integral::Independence;
use crate::output::OutputError;
use crate::output::schema::VERDICT;
use crate::scene::echo::one_line;

const GROUP: &str = "/independence";

impl Checked<'_> {
    /// The figures of a run, a point or a law.
    pub fn independence(&mut self) -> Result<(), OutputError> {
        let std = self.number("/", "surface_height_std")?;
        for own in self.judged(|_| Ok(std))? {
            let area = self.number("/", "nominal_area")?;
            self.figure("patch_side", &[area.sqrt()], "/nominal_area")?;
            match self.has("/integral/pull_off_contact_area") {
                true => {
                    let share = self.values("/integral/pull_off_contact_area")?[0] / area;
                    self.figure("contact_share", &[share], "/integral/pull_off_contact_area")?;
                }
                false => self.contact(&own, area)?,
            }
            self.forces(&own)?;
        }
        Ok(())
    }

    /// The figures of patches of several sizes: shifts and attraction over k_s grow like their sides.
    pub fn independence_of_sizes(&mut self, areas: &[f64]) -> Result<(), OutputError> {
        let shifts = |own: &Self| own.values(&format!("{GROUP}/shift"));
        let all =
            self.judged(|own| Ok(shifts(own)?[0] / own.values(&format!("{GROUP}/relative_shift"))?[0]))?;
        let Some(first) = all.first() else { return Ok(()) };
        let sides: Vec<f64> = areas.iter().map(|area| area.sqrt()).collect();
        self.figure("patch_side", &sides, "/nominal_area")?;
        let grown = |power: i32, value: f64| -> Vec<f64> {
            sides.iter().map(|side| (side / first.patch_side).powi(power) * value).collect()
        };
        self.figure("substrate_stiffness", &grown(1, first.substrate_stiffness), "the first size")?;
        let (counts, force) = (self.values("/asperity_count")?, "/integral_pull_off_per_asperity");
        let pull_off = self.values(force)?[0];
        let shifts = all.iter().zip(&counts).map(|(own, count)| -count * pull_off / own.substrate_stiffness);
        self.figure("shift", &shifts.collect::<Vec<f64>>(), force)?;
        self.figure("contact_share", &grown(0, first.contact_share), "the first size")?;
        self.figure("closest_shift", &grown(1, first.closest_shift), "the first size")?;
        self.figure("attractive_stiffness", &grown(2, first.attractive_stiffness), "the first size")?;
        let from = |own: &Independence| match own.independent_from {
            from if from.is_nan() => f64::INFINITY,
            from => from,
        };
        if let Some(i) = (1..all.len()).find(|&i| from(&all[i]) < from(&all[i - 1])) {
            let path = format!("{GROUP}/independent_from");
            self.say_at(&path, i, from(&all[i]), "no less than for the smaller patch before is expected");
        }
        Ok(())
    }

    /// What is judged, whose figures follow from each other and the verdicts from them; nothing in files
    /// before version 3.1. σ, m, is where `std` finds it.
    fn judged(
        &mut self,
        std: impl Fn(&Self) -> Result<f64, OutputError>,
    ) -> Result<Vec<Independence>, OutputError> {
        if !self.has(&format!("{GROUP}/patch_side")) {
            return Ok(Vec::new());
        }
        let column = |name: &str| self.values(&format!("{GROUP}/{name}"));
        let (sides, stiffnesses, shifts) =
            (column("patch_side")?, column("substrate_stiffness")?, column("shift")?);
        let (attractive, fluctuations) = (column("attractive_stiffness")?, column("fluctuation")?);
        let (shares, closest) = (column("contact_share")?, column("closest_shift")?);
        let (from, surface_height_std) = (column("independent_from")?, std(self)?);
        let own = |i: usize| Independence {
            surface_height_std,
            patch_side: sides[i],
            substrate_stiffness: stiffnesses[i],
            shift: shifts[i],
            attractive_stiffness: attractive[i],
            fluctuation: fluctuations[i],
            contact_share: shares[i],
            closest_shift: closest[i],
            independent_from: from[i],
        };
        let all: Vec<Independence> = (0..sides.len()).map(own).collect();
        for (name, of) in FIGURES {
            self.figure(name, &all.iter().map(of).collect::<Vec<f64>>(), "the figures beside it")?;
        }
        let told = match self.place {
            Place::File if self.reader.has_attribute(GROUP, "verdict")? => {
                vec![self.reader.optional_text(GROUP, "verdict")?.unwrap_or_default()]
            }
            Place::File => self.reader.texts(VERDICT)?,
            Place::Law(law) => self.reader.texts(VERDICT)?.into_iter().skip(law).take(1).collect(),
            Place::Point(_) => vec![self.text(VERDICT)?],
        };
        for (own, told) in all.iter().map(|own| own.verdict().name()).zip(told) {
            if told != own {
                self.say(VERDICT, &format!("is \"{}\", and \"{own}\" follows", one_line(&told)));
            }
        }
        Ok(all)
    }

    /// The share in contact is no more than twice that at a separation beside the pull-off, and no less than
    /// half of it.
    fn contact(&mut self, own: &Independence, nominal_area: f64) -> Result<(), OutputError> {
        let (h, areas) = (self.coordinate("separation")?, self.values("/integral/contact_area")?);
        let pulls = self.number("/integral", "pull_off_force")? > 0.0;
        let place = if pulls { self.number("/integral", "pull_off_separation")? } else { h[0] };
        let next = h.partition_point(|h| *h < place);
        let near = &areas[next.saturating_sub(1)..(next + 1).min(areas.len())];
        let (most, least) = near.iter().fold((0.0, f64::INFINITY), |(most, least): (f64, f64), area| {
            (most.max(area / nominal_area), least.min(area / nominal_area))
        });
        if !(own.contact_share <= 2.0 * most && own.contact_share >= 0.5 * least) {
            let path = format!("{GROUP}/contact_share");
            self.say_at(&path, 0, own.contact_share, &format!("beside the pull-off {most:e} is"));
        }
        Ok(())
    }

    /// What follows from the curve of the integral.
    fn forces(&mut self, own: &Independence) -> Result<(), OutputError> {
        let way = if self.is_loop()? { "retraction_" } else { "" };
        let path = format!("/integral/{way}external_force");
        let (h, curve, stiffness) =
            (self.coordinate("separation")?, self.values(&path)?, own.substrate_stiffness);
        let pull_off = self.number("/integral", "pull_off_force")?;
        let force = if pull_off > 0.0 { -pull_off } else { curve[0] };
        self.figure("shift", &[force / stiffness], "/integral/pull_off_force")?;
        self.figure("closest_shift", &[curve[0] / stiffness], &path)?;
        if self.jumps()? == Some(false) {
            let (steepest, place) = (
                self.number("/integral", "peak_stiffness")?.max(0.0),
                self.number("/integral", "peak_stiffness_separation")?,
            );
            // At an edge it is that of the end, and the peak that of the step beside it.
            let is_inside = h.len() > 2 && h[1] < place && place < h[h.len() - 2];
            if is_inside || own.attractive_stiffness < steepest {
                self.figure("attractive_stiffness", &[steepest], "/integral/peak_stiffness")?;
            }
        }
        let limit = Independence::LIMITS[0].good * own.surface_height_std * stiffness;
        let is_beyond = |force: f64| force.abs() > limit + ROUNDING * largest(&curve);
        let from = own.independent_from;
        // Behind it all are within, and just before it one is not, unless it is the first.
        let behind = (0..h.len()).filter(|&k| h[k] >= from).any(|k| is_beyond(curve[k]));
        let last = (0..h.len()).rfind(|&k| from.is_nan() || h[k] < from);
        let before = last.is_some_and(|k| curve[k].abs() < limit - ROUNDING * largest(&curve));
        if behind || before {
            let place = format!("{GROUP}/independent_from");
            self.say_at(&place, 0, from, &format!("the shift passes its limit elsewhere in {path}"));
        }
        Ok(())
    }

    /// Compares a figure with what follows from others.
    fn figure(&mut self, name: &str, expected: &[f64], from: &str) -> Result<(), OutputError> {
        self.follows(&format!("{GROUP}/{name}"), expected, ROUNDING, from)
    }
}
