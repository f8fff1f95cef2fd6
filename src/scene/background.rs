//! Forces between the mean planes of a scene's surfaces: `[van_der_waals]` and `[electrostatic]`.

use super::choices::{CAP_SHARE, CAP_SHARES, RETARDATION_WAVELENGTH};
use super::error::{SceneError, Together, all};
use super::reader::{Entry, Section};
use crate::asperity::models::Model;
use crate::asperity::scale::Asperity;
use crate::background::{
    Background, Cap, CapRetardation, Caps, Dispersion, Electrostatic, Terms, VanDerWaals,
};
use crate::surface::{RadiusClass, Surface};
use std::ops::RangeBounds;
use std::sync::Arc;
use toml::de::DeValue;

/// Most dielectrics between two electrodes.
const MOST_LAYERS: usize = 20;

/// The tables of a scene on the forces between its mean planes.
///
/// # Examples
/// ```
/// use stiction::scene::BackgroundTables;
///
/// let scene = stiction::Scene::from_toml_file("configs/slider.toml")?;
/// let BackgroundTables { van_der_waals, electrostatic } = scene.background.unwrap();
/// assert!(van_der_waals.is_some() && electrostatic.is_some());
/// # Ok::<(), stiction::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BackgroundTables {
    /// `[van_der_waals]`.
    pub van_der_waals: Option<VanDerWaalsTable>,
    /// `[electrostatic]`.
    pub electrostatic: Option<Electrostatic>,
}

/// The table `[van_der_waals]`.
///
/// # Examples
/// ```
/// use stiction::scene::VanDerWaalsTable;
///
/// let scene = stiction::Scene::from_toml_file("configs/slider.toml")?;
/// let VanDerWaalsTable { wavelength, .. } = scene.background.unwrap().van_der_waals.unwrap();
/// assert_eq!(wavelength, Some(100e-9), "retarded");
/// # Ok::<(), stiction::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VanDerWaalsTable {
    /// Hamaker constant, J; that of the Lennard-Jones attraction of the asperities without one.
    pub hamaker_constant: Option<f64>,
    /// Wavelength of the retardation, m; not retarded without one.
    pub wavelength: Option<f64>,
    /// Gap below which asperities act, m; the range of their Dugdale stress without one.
    pub smallest_gap: Option<f64>,
    /// Share of the area in caps of asperities, of laws whose attraction has no end.
    pub cap_share: f64,
}

/// The tables as they stand.
pub(super) struct BackgroundSections<'a> {
    van_der_waals: Option<(Section<'a>, VanDerWaalsTable)>,
    electrostatic: Option<(Section<'a>, Electrostatic)>,
}

impl<'a> BackgroundSections<'a> {
    /// Reads the tables, if they are there.
    pub fn read(root: &Section<'a>) -> Result<Self, SceneError> {
        let read = |name: &'a str| root.section(name, false);
        let van_der_waals = read("van_der_waals").and_then(|section| {
            section.map(|section| van_der_waals(&section).map(|table| (section, table))).transpose()
        });
        let electrostatic = read("electrostatic").and_then(|section| {
            section.map(|section| electrostatic(&section).map(|table| (section, table))).transpose()
        });
        let (van_der_waals, electrostatic) = (van_der_waals, electrostatic).together()?;
        Ok(Self { van_der_waals, electrostatic })
    }

    /// The tables of surfaces at separations, m, whose asperities obey a law; none where there are none.
    pub fn of(
        self,
        model: &Model,
        asperity: &Asperity,
        surface: &Surface,
        nearest: f64,
    ) -> Result<Option<BackgroundTables>, SceneError> {
        if let Some((section, table)) = &self.van_der_waals {
            let film = film(model, asperity);
            if let Some(entry) =
                section.get("smallest_gap").filter(|_| table.smallest_gap.is_some_and(|gap| gap < film))
            {
                return Err(entry.wrong(
                    "is less than lubricant_thickness: the film fills such gaps; leave it out, or give a larger one",
                ));
            }
            if let Some(entry) = section.get("cap_share").filter(|_| !model.has_endless_attraction()) {
                return Err(entry.wrong(&format!(
                    "is for laws whose attraction has no end; asperities of {} own the gaps below smallest_gap",
                    model.name
                )));
            }
        }
        if let Some((section, table)) = &self.electrostatic {
            let least = Electrostatic::NEAREST_BARE * surface.surface_height_std;
            if table.dielectric == 0.0 && table.voltage != 0.0 && !(nearest > least) {
                return Err(section.require("voltage")?.wrong(&format!(
                    "bare electrodes touch as soon as a gap closes, and then there is no voltage; give \
                     dielectric_thickness and relative_permittivity, or a recess, or separations of more than h* = {}",
                    Electrostatic::NEAREST_BARE
                )));
            }
        }
        let van_der_waals = self.van_der_waals.map(|(_, table)| table);
        let electrostatic = self.electrostatic.map(|(_, table)| table);
        let is_any = van_der_waals.is_some() || electrostatic.is_some();
        Ok(is_any.then_some(BackgroundTables { van_der_waals, electrostatic }))
    }
}

fn van_der_waals(section: &Section<'_>) -> Result<VanDerWaalsTable, SceneError> {
    let retarded = section.optional("retarded", Entry::boolean);
    let wavelength = section.optional("retardation_wavelength", |entry| match &retarded {
        Ok(Some(true)) | Err(_) => entry.measured(),
        Ok(_) => Err(entry.wrong("needs retarded = true; without retardation there is no wavelength")),
    });
    let cap_share = section.optional("cap_share", |entry| {
        let share = entry.number()?;
        match CAP_SHARES.contains(&share) {
            true => Ok(share),
            false => Err(entry.wrong("a share of the nominal area is greater than 0 and at most 1")),
        }
    });
    let readings = (
        section.optional("hamaker_constant", Entry::measured),
        (retarded.clone(), wavelength).together(),
        section.optional("smallest_gap", Entry::measured),
        cap_share,
    );
    let (hamaker_constant, (retarded, wavelength), smallest_gap, cap_share) = readings.together()?;
    let wavelength = retarded.unwrap_or(false).then(|| wavelength.unwrap_or(RETARDATION_WAVELENGTH));
    let cap_share = cap_share.unwrap_or(CAP_SHARE);
    Ok(VanDerWaalsTable { hamaker_constant, wavelength, smallest_gap, cap_share })
}

fn electrostatic(section: &Section<'_>) -> Result<Electrostatic, SceneError> {
    let dielectric = layers(section);
    let readings = (
        section.measured("voltage"),
        section.optional("contact_potential", Entry::measured),
        section.optional("recess", Entry::measured),
        dielectric,
    );
    let (voltage, contact_potential, recess, dielectric) = readings.together()?;
    Ok(Electrostatic {
        voltage: voltage + contact_potential.unwrap_or(0.0),
        dielectric: dielectric + recess.unwrap_or(0.0),
    })
}

/// Σt/ε_r of the dielectrics, m.
fn layers(section: &Section<'_>) -> Result<f64, SceneError> {
    let thicknesses = section.optional("dielectric_thickness", |entry| layer(entry, &Entry::measured));
    let permittivities = section.optional("relative_permittivity", |entry| {
        layer(entry, &|entry: &Entry<'_>| match entry.number()? {
            permittivity if permittivity >= 1.0 => Ok(permittivity),
            _ => Err(entry.wrong("a relative permittivity is at least 1")),
        })
    });
    let (thicknesses, permittivities) = (thicknesses, permittivities).together()?;
    match (&thicknesses, &permittivities) {
        (None, None) => Ok(0.0),
        (Some(_), None) => Err(section.require("relative_permittivity").err().expect("it is not there")),
        (None, Some(_)) => Err(section.require("dielectric_thickness").err().expect("it is not there")),
        (Some(thicknesses), Some(permittivities)) if thicknesses.len() != permittivities.len() => {
            let entry = section.require("relative_permittivity")?;
            Err(entry.wrong(&format!(
                "has {} values, and dielectric_thickness {}; one for each dielectric is needed",
                permittivities.len(),
                thicknesses.len()
            )))
        }
        (Some(thicknesses), Some(permittivities)) => {
            Ok(thicknesses.iter().zip(permittivities).map(|(thickness, of)| thickness / of).sum())
        }
    }
}

/// A value, or one of each dielectric.
fn layer<'a>(
    entry: &Entry<'a>,
    read: &dyn Fn(&Entry<'a>) -> Result<f64, SceneError>,
) -> Result<Vec<f64>, SceneError> {
    let DeValue::Array(array) = entry.value.get_ref() else { return Ok(vec![read(entry)?]) };
    if !(1..=MOST_LAYERS).contains(&array.len()) {
        return Err(entry.wrong(&format!("has {} values; 1 to {MOST_LAYERS} are needed", array.len())));
    }
    all(array.iter().enumerate().map(|(i, element)| read(&entry.element(i, element))))
}

/// The film between the faces under a law, m.
fn film(model: &Model, asperity: &Asperity) -> f64 {
    if model.validity.dry { 0.0 } else { asperity.lubricant_thickness }
}

impl BackgroundTables {
    /// The background of a surface whose asperities obey a law, fast between two separations, m.
    pub(super) fn of(
        &self,
        model: &Model,
        asperity: &Asperity,
        surface: &Surface,
        range: (f64, f64),
    ) -> Arc<Background> {
        let dispersion = self.van_der_waals.map(|table| table.of(model, asperity, surface));
        let terms = Terms { dispersion, electrostatic: self.electrostatic };
        Arc::new(Background::new(terms, surface.surface_height_std, range))
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
