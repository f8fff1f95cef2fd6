//! Van der Waals forces between the mean planes: `[van_der_waals]`.

use super::{ForceTable, GivenForce, Setting};
use crate::asperity::Model;
use crate::asperity::scale::Asperity;
use crate::background::{Cap, CapRetardation, Caps, Dispersion, MeanPlaneForce, VanDerWaals};
use crate::scene::error::{SceneError, Together};
use crate::scene::keys::Sign::Positive;
use crate::scene::keys::Value::{Number, Quantity, Switch, Table};
use crate::scene::keys::key;
use crate::scene::reader::{Entry, Section};
use crate::scene::units::Dimension as Of;
use crate::surface::{RadiusClass, Surface};
use std::ops::Bound::{Excluded, Included};
use std::sync::Arc;

pub(super) const TABLE: ForceTable = ForceTable {
    name: "van_der_waals",
    meaning: "van der Waals attraction between the mean planes",
    keys: &[
        key("van_der_waals", "{ hamaker_constant = \"1e-19 J\", retarded = true }", Table)
            .what("van der Waals forces between the mean planes")
            .about(
                "Per nominal area, across the gaps of the rough surface that no asperity owns; an empty table takes \
                 the constant of the asperities.",
            )
            .follows("none; asperities attract alone"),
        key("van_der_waals.hamaker_constant", "\"1e-19 J\"", Quantity(Of::Energy, Positive))
            .what("Hamaker constant")
            .about("A of the two bodies across the medium between them.")
            .follows("16πΔγZ₀², as in the Lennard-Jones attraction of the asperities")
            .swept(),
        key("van_der_waals.retarded", "true", Switch)
            .what("whether the forces are retarded")
            .about("By Gregory (1981): from A/6πz³ close by to the retarded law, which falls as 1/z⁴.")
            .defaults_to("false"),
        key("van_der_waals.retardation_wavelength", "\"100 nm\"", Quantity(Of::Length, Positive))
            .what("wavelength of the retardation")
            .about("Needs `retarded = true`.")
            .defaults_to("\"100 nm\"")
            .swept(),
        key("van_der_waals.smallest_gap", "\"0.2 nm\"", Quantity(Of::Length, Positive))
            .what("gap from which on the background acts")
            .about("Smaller gaps belong to the asperities.")
            .follows("the range Z₀/1.03 of the Dugdale stress, plus `lubricant_thickness` under laws with a lubricant")
            .swept(),
        key("van_der_waals.cap_share", "0.75", Number(Excluded(0.0), Included(1.0)))
            .what("share of the area that asperities own")
            .about(
                "For laws with endless attraction, such as `hybrid`: an asperity acts on a cap of the radius ρ with \
                 ηπρ² = `cap_share`, and the background on the rest.",
            )
            .defaults_to("0.75")
            .swept(),
    ],
    read: |section| van_der_waals(section).map(|table| Arc::new(table) as Arc<dyn GivenForce>),
};

/// The table `[van_der_waals]`.
#[derive(Clone, Copy, Debug)]
struct VanDerWaalsTable {
    /// Hamaker constant, J; that of the Lennard-Jones attraction of the asperities without one.
    hamaker_constant: Option<f64>,
    /// Wavelength of the retardation, m; not retarded without one.
    wavelength: Option<f64>,
    /// Gap below which asperities act, m; the range of their Dugdale stress without one.
    smallest_gap: Option<f64>,
    /// Share of the area in caps of asperities, of laws whose attraction has no end. With the default the sum over
    /// asperities and background is within a tenth of Derjaguin's approximation for the whole of a Gaussian surface.
    cap_share: f64,
}

fn van_der_waals(section: &Section<'_>) -> Result<VanDerWaalsTable, SceneError> {
    let retarded = section.value("retarded").boolean();
    let wavelength = match section.get("retardation_wavelength").filter(|_| retarded == Ok(false)) {
        None => section.value("retardation_wavelength").measured(),
        Some(entry) => Err(entry.wrong("needs retarded = true; without retardation there is no wavelength")),
    };
    let cap_share = section.value("cap_share").bounded();
    let readings = (
        section.optional("hamaker_constant", Entry::measured),
        (retarded.clone(), wavelength).together(),
        section.optional("smallest_gap", Entry::measured),
        cap_share,
    );
    let (hamaker_constant, (retarded, wavelength), smallest_gap, cap_share) = readings.together()?;
    let wavelength = retarded.then_some(wavelength);
    Ok(VanDerWaalsTable { hamaker_constant, wavelength, smallest_gap, cap_share })
}

/// The film between the surfaces under a law, m.
fn film(model: &Model, asperity: &Asperity) -> f64 {
    if model.validity.dry { 0.0 } else { asperity.lubricant_thickness }
}

impl GivenForce for VanDerWaalsTable {
    fn check(&self, section: &Section<'_>, setting: &Setting<'_>) -> Result<(), SceneError> {
        let film = film(setting.model, setting.asperity);
        let is_filled = self.smallest_gap.is_some_and(|gap| gap < film);
        if let Some(entry) = section.get("smallest_gap").filter(|_| is_filled) {
            return Err(entry.wrong(
                "is less than lubricant_thickness: the film fills such gaps; leave it out, or give a larger one",
            ));
        }
        match section.get("cap_share").filter(|_| !setting.model.has_endless_attraction()) {
            None => Ok(()),
            Some(entry) => Err(entry.wrong(&format!(
                "is for laws whose attraction has no end; asperities of {} own the gaps below smallest_gap",
                setting.model.name
            ))),
        }
    }

    fn force(&self, setting: &Setting<'_>) -> Arc<dyn MeanPlaneForce> {
        Arc::new(self.of(setting.model, setting.asperity, setting.surface))
    }
}

impl VanDerWaalsTable {
    fn of(&self, model: &Model, asperity: &Asperity, surface: &Surface) -> Dispersion {
        let &Asperity { work_of_adhesion, equilibrium_spacing, .. } = asperity;
        let lennard_jones = VanDerWaals::lennard_jones(work_of_adhesion, equilibrium_spacing);
        let film = film(model, asperity);
        let contact_distance = equilibrium_spacing - film;
        let (range, planes) = (
            asperity.attraction_range(),
            VanDerWaals::new(self.hamaker_constant.unwrap_or(lennard_jones), self.wavelength),
        );
        let retardation =
            planes.retardation().map(|rate| CapRetardation { rate, from: equilibrium_spacing + range });
        let class =
            |RadiusClass { weight, radius, heights, .. }| Cap { radius, weight, heights: Arc::new(heights) };
        let caps = || Caps {
            share: self.cap_share,
            density: surface.asperity_count as f64 / surface.nominal_area,
            work_of_adhesion,
            equilibrium_spacing,
            contact_distance,
            mean_plane_offset: surface.mean_plane_offset,
            classes: surface.parts().into_iter().map(class).collect(),
            retardation,
        };
        Dispersion {
            planes,
            smallest_gap: self.smallest_gap.unwrap_or(film + range),
            contact_distance,
            caps: model.has_endless_attraction().then(caps),
        }
    }
}
