//! One scene from its document.

use super::background::{ForceSections, Setting};
use super::capillary::{CapillaryTable, capillary, wet};
use super::definition::Scene;
use super::device::restoring_force;
use super::ensemble::{EnsembleTable, related, with_patches};
use super::error::{SceneError, Together};
use super::files::Files;
use super::instability::{InstabilityTable, instability};
use super::keys::Listed::Never;
use super::keys::Value::{Switch, Table, Text, Whole};
use super::keys::{Key, key};
use super::material::Material;
use super::measured::measured;
use super::model::{DEFAULT_LAW, ModelTable};
use super::population::{Around, Population, population};
use super::reader::Section;
use super::separation;
use super::shape::{shape, under_body};
use super::solver::{Sums, sums};
use super::substrate::SubstrateTable;
use super::units::Dimension;
use super::validity::unknown_unloading;
use crate::asperity::Plasticity;
use crate::asperity::scale::{Asperity, Scale, UNIT_RANGE};
use crate::asperity::{LawParameters, Path};
use crate::integral::Summits;
use crate::liquid::Meniscus;
use crate::surface::{Shape, Surface};
use std::sync::Arc;

/// The scene format that is read.
const FORMAT: u64 = 1;

/// The keys in no table.
pub(super) static ROOT: &[Key] = &[
    key("format", "1", Whole(FORMAT, FORMAT)).what("version of the scene format").defaults_to("1"),
    key("title", "\"Case II\"", Text)
        .what("name of the scene, for people")
        .about("It changes no result.")
        .defaults_to("\"\"")
        .listed(Never),
];

/// The keys of `[output]`.
pub(super) static OUTPUT: &[Key] = &[
    key("output", "{ curves = true }", Table).what("what is kept").follows("no curves of replicas"),
    key("output.curves", "true", Switch)
        .what("whether the curves of every replica are kept")
        .about("Means, standard deviations and the numbers of every replica are kept in any case.")
        .defaults_to("false"),
];

/// Reads a scene that is no sweep, and the values of files that it names.
pub(super) fn read(text: &str, root: &Section<'_>, files: &Arc<dyn Files>) -> Result<Scene, SceneError> {
    Readings::read(root, files.as_ref())?.scene(text, root, files)
}

/// The tables of a scene, each as far as it can be judged by itself.
struct Readings<'a> {
    title: String,
    material: Material,
    population: Population,
    lubricant_thickness: f64,
    model: ModelTable,
    separation: Section<'a>,
    instability: InstabilityTable,
    ensemble: Section<'a>,
    draws: EnsembleTable,
    sums: Option<(Sums, f64)>,
    curves: bool,
    substrate: Option<SubstrateTable<'a>>,
    forces: ForceSections<'a>,
    liquid: Option<CapillaryTable>,
    restoring_force: Option<f64>,
    shape: Option<Arc<dyn Shape>>,
}

impl<'a> Readings<'a> {
    /// Reads all tables, with the errors of all of them together.
    fn read(root: &Section<'a>, files: &dyn Files) -> Result<Self, SceneError> {
        let section = |name: &'static str| required(root, name);
        let substrate = SubstrateTable::read(root);
        let around = Around {
            is_coupled: substrate.as_ref().is_ok_and(Option::is_some),
            has_body: root.get("shape").is_some(),
        };
        let is_wet = root.get("capillary").is_some();
        let model = root.section_or_empty("model").and_then(|model| ModelTable::read(&model, is_wet));
        let yields = model.as_ref().map_or(true, |own| own.law.validity.plasticity != Plasticity::Without);
        let material = section("material").and_then(|material| Material::read(&material, yields));
        let population = section("surface")
            .and_then(|surface| read_surface(&surface, material.as_ref().ok(), files, &around));
        // What a separation is depends on the surface, whether it is one does not.
        let separation = root.section_or_empty("separation").and_then(|h| {
            let span = h.optional("stiffness_span", |span| span.measured());
            (separation::given(&h, 1.0), span).together().map(|_| h)
        });
        let cycle = model.as_ref().is_ok_and(|model| model.cycle);
        let instability = match &model {
            Ok(_) => instability(root, cycle),
            Err(_) => Ok(InstabilityTable::default()),
        };
        let ensemble = root
            .section_or_empty("ensemble")
            .and_then(|ensemble| EnsembleTable::read(&ensemble).map(|draws| (ensemble, draws)));
        let readings =
            (root.known(), heading(root), material, population, model, separation, instability, ensemble);
        let (solver, output, forces) = (sums(root), curves(root), ForceSections::read(root));
        let device = (restoring_force(root), shape(root)).together();
        let readings = (readings.together(), solver, output, substrate, forces, capillary(root), device);
        let (readings, sums, curves, substrate, forces, liquid, device) = readings.together()?;
        let (restoring_force, shape) = device;
        let ((), title, material, population, model, separation, instability, (ensemble, draws)) = readings;
        let (population, lubricant_thickness) = population;
        Ok(Self {
            title,
            material,
            population,
            lubricant_thickness,
            model,
            separation,
            instability,
            ensemble,
            draws,
            sums,
            curves,
            substrate,
            forces,
            liquid,
            restoring_force,
            shape,
        })
    }

    /// The scene that they are of, where they suit each other.
    // One line a table or a field of the scene: long, but flat.
    fn scene(self, text: &str, root: &Section<'a>, files: &Arc<dyn Files>) -> Result<Scene, SceneError> {
        let Self { title, material, population, model, separation, instability, .. } = self;
        let Population { surface, places, mut inputs } = population;
        let radius = self
            .shape
            .as_ref()
            .map_or(surface.asperity_radius, |shape| shape.touching(surface.asperity_radius));
        let asperity = material.asperity(radius, self.lubricant_thickness)?;
        let ModelTable { law, history, cycle, critical_approach } = model;
        let meniscus = self.liquid.as_ref().map(|liquid| liquid.meniscus);
        let law = wet(root, law, meniscus)?;
        let of_law = LawParameters::new(&asperity, Path::Approach, (0.0, 0.0)).expect("it was judged before");
        law.admits(&of_law).map_err(|error| {
            SceneError::general(format!("{error}; that is of the bridges: check [capillary]"))
        })?;
        let given = separation::given(&separation, surface.surface_height_std)?;
        let (liquid, preload) = (law.meniscus().map_or(0.0, Meniscus::range), instability.largest_preload());
        let flow = law.contact().filter(|_| given.is_none() && preload > 0.0).and_then(|contact| {
            let own = crate::asperity::model(contact.name())?;
            own.law(&LawParameters { table_range: None, ..of_law }).ok()
        });
        let separations = |surface: &Surface| {
            let summits = Summits { asperity: &asperity, surface, liquid, preload, flow: flow.as_deref() };
            given.clone().unwrap_or_else(|| separation::following(&summits))
        };
        let (surface, separations) = match &self.shape {
            Some(shape) => {
                let distance = match &self.substrate {
                    Some(table) => table.distance(&surface)?,
                    None => 0.0,
                };
                under_body(&surface, shape, &asperity, (distance, liquid), separations)?
            }
            None => {
                let separations = separations(&surface);
                (surface, separations)
            }
        };
        let range = (separations[0], separations[separations.len() - 1]);
        let forces =
            self.forces.suited(&Setting { model: &law, asperity: &asperity, surface: &surface, range })?;
        let substrate =
            self.substrate.map(|table| table.under(&surface, places, &separations)).transpose()?;
        let cycles = separation::cycles(&separation, cycle)?;
        let stiffness_span =
            separation::stiffness_span(&separation, &separations, asperity.equilibrium_spacing)?;
        reached(&asperity, &surface, range)?;
        let EnsembleTable { replicas, stopping, sampling, seed, model_range } = self.draws;
        let surface = with_patches(&self.ensemble, surface, replicas, files.as_ref(), &mut inputs)?;
        related(&self.ensemble, sampling, &surface)?;
        let scene = Scene {
            text: text.to_owned(),
            title,
            instability: instability.of(asperity.reduced_modulus, surface.loaded_area()),
            asperity,
            surface,
            model: law,
            draining_film: self.liquid.and_then(|liquid| liquid.draining_film),
            films: Vec::new(),
            history,
            cycle,
            cycles,
            restoring_force: self.restoring_force,
            substrate,
            forces,
            critical_approach,
            separations,
            stiffness_span,
            inputs,
            files: Arc::clone(files),
            replicas,
            stopping,
            sampling,
            seed,
            model_range,
            sums: self.sums,
            curves: self.curves,
        };
        resolved(&scene).map_err(|problem| {
            match separation.get("h").or_else(|| separation.get("h_star")) {
                Some(entry) => entry.wrong(&problem),
                None => SceneError::general(problem),
            }
        })?;
        loading_alone(root, &scene)?;
        scene.with_surroundings().map_err(|error| {
            SceneError::general(format!("{error}; that is of films as thin as they drain: check [capillary]"))
        })
    }
}

/// The table `[surface]`: its asperities, and the thickness of the lubricant, m.
fn read_surface(
    surface: &Section<'_>,
    material: Option<&Material>,
    files: &dyn Files,
    around: &Around,
) -> Result<(Population, f64), SceneError> {
    let lubricant = surface.value("lubricant_thickness").measured();
    // A radius that is given is judged before the surface that follows from it.
    if let (Some(material), Some(Ok(radius))) =
        (material, surface.get("asperity_radius").map(|entry| entry.measured()))
    {
        material.asperity(radius, 0.0)?;
    }
    let population = match surface.get("asperities") {
        Some(entry) => measured(surface, &entry, files, around),
        None => population(surface, files, around.has_body),
    };
    (population, lubricant).together()
}

/// Refuses lengths beyond those to which laws are computed, among separations h from the nearest to the furthest, m, and
/// heights.
fn reached(asperity: &Asperity, surface: &Surface, range: (f64, f64)) -> Result<(), SceneError> {
    let scale = Scale::new(asperity).map_err(|error| SceneError::general(error.to_string()))?;
    let most = UNIT_RANGE.1 * scale.length;
    let d = [range.0, range.1].map(|h| surface.asperity_separation(h).abs());
    let furthest = d[0].max(d[1]).max(surface.heights.std);
    if furthest <= most {
        return Ok(());
    }
    let [furthest, most] = [furthest, most].map(|length| Dimension::Length.shown(length));
    Err(SceneError::general(format!(
        "[separation] and [surface] reach {furthest}, but laws are computed to {most}; check the units of h, \
         mean_plane_offset, surface_height_std, asperity_height_std and asperity_density"
    )))
}

/// Refuses separations that rounding makes equal where the asperities are.
fn resolved(scene: &Scene) -> Result<(), String> {
    let surface = &scene.surface;
    let d = |h: f64| surface.asperity_separation(h);
    if scene.separations.windows(2).all(|pair| d(pair[0]) < d(pair[1])) {
        return Ok(());
    }
    Err(format!(
        "against a mean_plane_offset of {} these separations are lost in rounding: check their units",
        Dimension::Length.shown(surface.mean_plane_offset)
    ))
}

/// Refuses to unload contacts that have yielded under a law of loading alone.
fn loading_alone(root: &Section<'_>, scene: &Scene) -> Result<(), SceneError> {
    let Some((flowing, contact)) = unknown_unloading(scene) else { return Ok(()) };
    let entry = required(root, "model")?.value("history");
    let flowing = if flowing < 10.0 { format!("{flowing:.1e}") } else { format!("{flowing:.0}") };
    Err(entry.wrong(&format!(
        "about {flowing} contacts of the run yield before the surfaces turn back, and the law {} is one of loading alone; write \
         model.law = \"{DEFAULT_LAW}\" and model.plastic_contact = \"{}\", or history = \"approach\"",
        scene.model.name,
        contact.name()
    )))
}

fn required<'a>(root: &Section<'a>, name: &'a str) -> Result<Section<'a>, SceneError> {
    Ok(root.section(name, true)?.expect("a required section is there or an error"))
}

/// Refuses another format; the title, empty without one.
fn heading(root: &Section<'_>) -> Result<String, SceneError> {
    let format = root.value("format");
    let format = format.integer(0..=u64::MAX).and_then(|number| match number {
        FORMAT => Ok(()),
        _ => Err(format.wrong(&format!("this program reads scenes of format {FORMAT}"))),
    });
    let title = root.value("title");
    (format, title.string()).together().map(|((), title)| title.to_owned())
}

fn curves(root: &Section<'_>) -> Result<bool, SceneError> {
    root.section("output", false)?.map_or(Ok(false), |output| output.value("curves").boolean())
}
