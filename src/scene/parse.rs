//! One scene from its document.

use super::background::{ForceSections, Setting};
use super::capillary::{CapillaryTable, capillary, wet};
use super::choices::{DEFAULT_LAW, DEFAULT_LAW_IN_LIQUID, FORMAT, HISTORIES, SUM_TOLERANCES, SUMS};
use super::column::of_file;
use super::definition::{Scene, Sums, enough};
use super::device::restoring_force;
use super::error::{SceneError, Together};
use super::files::{Files, Input};
use super::instability::{InstabilityTable, instability};
use super::material::Material;
use super::measured::measured;
use super::population::{Population, population};
use super::reader::Section;
use super::separation::Tips;
use super::shape::{shape, under_body};
use super::substrate::SubstrateTable;
use super::units::Dimension;
use super::validity::unknown_unloading;
use super::{separation, stopping};
use crate::asperity::scale::{Asperity, Scale, UNIT_RANGE};
use crate::asperity::{LawParameters, Path, PlasticContact, model};
use crate::asperity::{MODELS, Model, PUBLISHED_FITS, Plasticity};
use crate::engine::Stopping;
use crate::liquid::Meniscus;
use crate::surface::{CountLaw, SamplingScheme, Shape, Surface};
use std::sync::Arc;

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
        let flows = model.as_ref().map_or(true, |own| own.law.validity.plasticity != Plasticity::Without);
        let material = section("material").and_then(|material| Material::read(&material, flows));
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
            let tips = Tips { asperity: &asperity, surface, liquid, preload, flow: flow.as_deref() };
            given.clone().unwrap_or_else(|| tips.separations())
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

/// The surroundings of a surface.
pub(super) struct Around {
    pub is_coupled: bool,
    pub has_body: bool,
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

/// The surface with the patches of `[ensemble] heights`, if there are such.
fn with_patches(
    ensemble: &Section<'_>,
    surface: Surface,
    replicas: u64,
    files: &dyn Files,
    inputs: &mut Vec<Input>,
) -> Result<Surface, SceneError> {
    let Some(entry) = ensemble.get("heights") else { return Ok(surface) };
    if surface.heights.depths().is_some() {
        return Err(entry.wrong("is for flat patches; leave it out, or [shape]"));
    }
    if surface.is_polydisperse() || surface.whole || surface.count_law == CountLaw::Poisson {
        return Err(entry.wrong("gives patches of a fixed number of asperities of one radius; leave out `radii`, `asperities` and `count`"));
    }
    let patches = of_file(&entry, Some(&entry.table()?), files, inputs)?;
    let surface = Surface { patches: Some(patches.into()), ..surface };
    enough(&surface, replicas).map_err(|problem| entry.wrong(&problem))?;
    Ok(surface)
}

/// Refuses replicas that are related to each other where a surface does not allow it.
fn related(ensemble: &Section<'_>, sampling: SamplingScheme, surface: &Surface) -> Result<(), SceneError> {
    let Some(entry) = ensemble.get("sampling").filter(|_| sampling.group() > 1) else { return Ok(()) };
    if surface.patches.is_some() {
        return Err(entry.wrong("has no meaning with given `heights`; leave it out"));
    }
    if surface.whole {
        return Err(entry.wrong(
            "has no meaning with sample = \"whole\" in [surface], of which every replica is the same; leave it out",
        ));
    }
    if surface.count_law == CountLaw::Poisson {
        return Err(entry.wrong(
            "relates the asperities of replicas one by one, and with count = \"poisson\" in [surface] they are not as many; \
             it needs \"independent\", or count = \"fixed\"",
        ));
    }
    Ok(())
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

/// Refuses to pull back tops that have flowed under a law of loading alone.
fn loading_alone(root: &Section<'_>, scene: &Scene) -> Result<(), SceneError> {
    let Some((flowing, contact)) = unknown_unloading(scene) else { return Ok(()) };
    let entry = required(root, "model")?.value("history");
    let flowing = if flowing < 10.0 { format!("{flowing:.1e}") } else { format!("{flowing:.0}") };
    Err(entry.wrong(&format!(
        "about {flowing} contacts of the run flow before the surfaces turn back, and the law {} is one of loading alone; write \
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

fn sums(root: &Section<'_>) -> Result<Option<(Sums, f64)>, SceneError> {
    let solver = root.section_or_empty("solver")?;
    let Some(sums) = solver.value("summation").choice("summation", &SUMS)? else {
        return match solver.get("tolerance") {
            None => Ok(None),
            Some(entry) => Err(entry.wrong("direct sums have no tolerance; summation = \"moments\" has one")),
        };
    };
    let entry = solver.value("tolerance");
    let tolerance = entry.number()?;
    if !SUM_TOLERANCES.contains(&tolerance) {
        let (low, high) = (SUM_TOLERANCES.start(), SUM_TOLERANCES.end());
        return Err(entry.wrong(&format!("a tolerance of sums is between {low:e} and {high:e}")));
    }
    Ok(Some((sums, tolerance)))
}

fn critical_approach(section: &Section<'_>, law: &Model) -> Result<Option<f64>, SceneError> {
    let Some(entry) = section.get("critical_approach") else { return Ok(None) };
    if law.name != PUBLISHED_FITS {
        return Err(
            entry.wrong(&format!("the law {} finds its own; only {PUBLISHED_FITS} takes it", law.name))
        );
    }
    entry.measured().map(Some)
}

/// The law with the plastic contact that is chosen for it.
fn plastic_contact(section: &Section<'_>, law: Model) -> Result<Model, SceneError> {
    let contact = section.value("plastic_contact").choice("plastic_contact", &PlasticContact::ALL)?;
    match section.get("plastic_contact").filter(|_| law.contact().is_none()) {
        None => Ok(law.with_contact(contact)),
        Some(entry) => Err(entry.wrong(&format!(
            "the law {} has no contact to choose; law = \"{DEFAULT_LAW}\" takes any of them, and \"capillary\" in a liquid",
            law.name
        ))),
    }
}

/// The table `[model]`: law and history.
struct ModelTable {
    law: Model,
    history: Path,
    cycle: bool,
    critical_approach: Option<f64>,
}

impl ModelTable {
    fn read(section: &Section<'_>, is_wet: bool) -> Result<Self, SceneError> {
        let models: Vec<(&str, Model)> = MODELS.iter().map(|model| (model.name, *model)).collect();
        let history = section.value("history").choice("history", &HISTORIES);
        let law = match section.get("law") {
            None => {
                let name = if is_wet { DEFAULT_LAW_IN_LIQUID } else { DEFAULT_LAW };
                Ok(model(name).expect("it is one of the registry"))
            }
            Some(law) => law.choice("law", &models),
        };
        let law = law.and_then(|law| plastic_contact(section, law));
        let critical_approach = match &law {
            Ok(law) => critical_approach(section, law),
            Err(_) => Ok(None),
        };
        let (law, (history, cycle), critical_approach) = (law, history, critical_approach).together()?;
        Ok(Self { law, history, cycle, critical_approach })
    }
}

/// The table `[ensemble]`: how many replicas there are, and how they are drawn.
struct EnsembleTable {
    replicas: u64,
    stopping: Option<Stopping>,
    sampling: SamplingScheme,
    seed: u64,
    model_range: bool,
}

impl EnsembleTable {
    fn read(section: &Section<'_>) -> Result<Self, SceneError> {
        let sampling = section.value("sampling").choice("sampling", &SamplingScheme::ALL);
        let replicas = stopping::replicas(section, *sampling.as_ref().unwrap_or(&SamplingScheme::default()));
        let (seed, range) = (section.value("seed").whole(), section.value("model_range").boolean());
        let ((replicas, stopping), sampling, seed, model_range) =
            (replicas, sampling, seed, range).together()?;
        Ok(Self { replicas, stopping, sampling, seed, model_range })
    }
}
