//! Forces between the mean planes of a scene's surfaces, a file each: its keys, how they are read, and the force that
//! they make. A new force is its file and a line of [`FORCES`].

mod electrostatic;
mod van_der_waals;

use super::error::{SceneError, all};
use super::keys::Key;
use super::reader::Section;
use super::warning::Warning;
use crate::asperity::Model;
use crate::asperity::scale::Asperity;
use crate::background::{Background, MeanPlaneForce};
use crate::surface::Surface;
use std::fmt::Debug;
use std::sync::Arc;

/// All forces, in the order of the reference.
pub(crate) static FORCES: &[ForceTable] = &[
    // A line each.
    van_der_waals::TABLE,
    electrostatic::TABLE,
];

/// The table of a force.
pub(crate) struct ForceTable {
    /// The name of the table, and in files of results.
    pub name: &'static str,
    /// The force, in words.
    pub meaning: &'static str,
    /// Its keys, of which the first is the table itself.
    pub keys: &'static [Key],
    read: fn(&Section<'_>) -> Result<Arc<dyn GivenForce>, SceneError>,
}

/// A force as a scene gives it.
pub(crate) trait GivenForce: Debug + Send + Sync {
    /// Refuses what does not suit the asperities and their surface.
    ///
    /// # Errors
    /// [`SceneError`] about a key of the table.
    fn check(&self, _section: &Section<'_>, _setting: &Setting<'_>) -> Result<(), SceneError> {
        Ok(())
    }

    /// The force between surfaces.
    fn force(&self, setting: &Setting<'_>) -> Arc<dyn MeanPlaneForce>;

    /// Warnings about it at the closest separation h, m.
    fn warnings(&self, _nearest: f64) -> Vec<Warning> {
        Vec::new()
    }
}

/// The asperities and their surface that a force is for.
pub(crate) struct Setting<'a> {
    /// The law of the asperities.
    pub model: &'a Model,
    /// The typical asperity.
    pub asperity: &'a Asperity,
    /// The surface.
    pub surface: &'a Surface,
    /// Separations h, m, from the nearest to the furthest.
    pub range: (f64, f64),
}

/// The forces of a scene by their names.
#[derive(Clone, Debug, Default)]
pub struct GivenForces(pub(crate) Vec<(&'static str, Arc<dyn GivenForce>)>);

/// The tables of forces that a scene has, as they are written.
pub(super) struct ForceSections<'a>(Vec<ForceSection<'a>>);

/// The table of a force that a scene has, and the force that it gives.
struct ForceSection<'a> {
    table: &'static ForceTable,
    section: Section<'a>,
    given: Arc<dyn GivenForce>,
}

impl<'a> ForceSections<'a> {
    /// Reads the tables that are there.
    pub fn read(root: &Section<'a>) -> Result<Self, SceneError> {
        let tables = all(FORCES.iter().map(|table| {
            let section = root.section(table.name, false)?;
            let read = |section| (table.read)(&section).map(|given| ForceSection { table, section, given });
            section.map(read).transpose()
        }))?;
        Ok(Self(tables.into_iter().flatten().collect()))
    }

    /// The forces for asperities and a surface.
    pub fn suited(self, setting: &Setting<'_>) -> Result<GivenForces, SceneError> {
        let checked = |ForceSection { table, section, given }: ForceSection<'_>| {
            given.check(&section, setting).map(|()| (table.name, given))
        };
        all(self.0.into_iter().map(checked)).map(GivenForces)
    }
}

impl Setting<'_> {
    /// The background that forces make; none of none.
    pub fn background(&self, forces: &GivenForces) -> Option<Arc<Background>> {
        let flat = Setting { surface: &self.surface.plane(), ..*self };
        let over_body = |force| self.surface.force_over_body(force, self.range.0);
        let made = forces.0.iter().map(|(name, given)| (*name, over_body(given.force(&flat)))).collect();
        let background = Background::new(made, self.surface.surface_height_std, self.range);
        (!forces.0.is_empty()).then(|| Arc::new(background))
    }
}
