//! Scenes: from TOML to what the program computes, or to an error that says what to change.

mod canonical;
pub mod echo;
pub mod files;
mod instability;
mod keys;
mod material;
mod population;
mod reader;
mod separation;
mod stopping;
pub mod sweep;
mod table;
pub mod units;
mod validity;

pub use canonical::difference;
pub use instability::Instability;
pub use keys::{Absent, KEYS, Key, Sign, Value};
pub use reader::{Problem, SceneError, nearest, takes_heights};
pub use sweep::Sweep;
pub use validity::{Expected, Reading, Warning, WhatIsRead, warnings, warnings_of_scene};

use crate::asperity::models::{MODELS, Model, PUBLISHED_FITS};
use crate::asperity::scale::{Asperity, Scale, UNIT_RANGE};
use crate::asperity::{Family, Law, LawError, LawParameters, Loop, Path, Typical, UnloadedRadius};
use crate::engine::Stopping;
use crate::integral::reach;
use crate::surface::{RADIUS_RANGE, SamplingScheme, Surface};
use files::{Files, Input, NoFiles};
use material::Material;
use population::{Population, population};
use reader::{Section, Together, document};
use std::sync::Arc;

/// The scene format that is read.
pub const FORMAT: u64 = 1;

/// Tolerances of compressed sums that make sense: below, the rounding of a solve is larger; above, nothing
/// gets faster.
const SUM_TOLERANCES: std::ops::RangeInclusive<f64> = 1e-13..=1e-3;
/// The tolerance of compressed sums unless a scene gives one.
const SUM_TOLERANCE: f64 = 1e-9;

/// Ways of summing; whether compressed.
const SUMS: [(&str, bool); 2] = [("direct", false), ("compressed", true)];

/// Histories: their paths, of a loop that of its first way, and whether the surfaces are pulled back.
const HISTORIES: [(&str, (Path, bool)); 3] = [
    (Path::ALL[0].0, (Path::ALL[0].1, false)),
    (Path::ALL[1].0, (Path::ALL[1].1, false)),
    (LOOP, (Path::Approach, true)),
];
/// Name of the path that leads there and back.
const LOOP: &str = "loop";
/// A validated scene, SI.
#[derive(Clone, Debug)]
pub struct Scene {
    /// The TOML text, with a comment for each file that it has taken values from.
    pub text: String,
    /// Its title, may be empty.
    pub title: String,
    /// One asperity.
    pub asperity: Asperity,
    /// The rough surface.
    pub surface: Surface,
    /// The model.
    pub model: Model,
    /// The history; of a loop the way there.
    pub path: Path,
    /// Whether the surfaces are pulled back, each asperity by its own history.
    pub cycle: bool,
    /// The radius of tops that have flowed on the way back.
    pub unloaded_radius: UnloadedRadius,
    /// What holds the surfaces.
    pub instability: Instability,
    /// δ_A, m, that is set instead of following from the history; of the published fits only.
    pub critical_approach: Option<f64>,
    /// Separations h, m, rising.
    pub separations: Vec<f64>,
    /// Span of separation, m, of the peak secant stiffness of replicas.
    pub stiffness_span: f64,
    /// The files that it has taken values from.
    pub inputs: Vec<Input>,
    /// Number of replicas, whole groups of the sampling scheme; with targets the most there may be.
    pub replicas: u64,
    /// What ends the run before.
    pub stopping: Option<Stopping>,
    /// How they are drawn relative to each other.
    pub sampling: SamplingScheme,
    /// Seed of the random streams.
    pub seed: u64,
    /// Tolerance of compressed sums; asperities are summed directly without one.
    pub sum_tolerance: Option<f64>,
    /// Whether every replica's curves are kept.
    pub curves: bool,
}

impl Scene {
    /// Reads a scene that takes nothing out of files; of a sweep that of its first point.
    ///
    /// # Errors
    /// [`SceneError`] with the line, the key, what was given and what would do.
    pub fn parse(text: &str) -> Result<Self, SceneError> {
        let document = document(text)?;
        let root = Section::root(text, document.get_ref());
        match root.get("sweep") {
            Some(sweep) => Sweep::read(text, &sweep, Arc::new(NoFiles)).and_then(|sweep| sweep.scene(0)),
            None => Self::read(text, &root, &NoFiles),
        }
        .map_err(SceneError::shortened)
    }

    /// Reads a scene that is no sweep, and what it takes out of files.
    fn read(text: &str, root: &Section<'_>, files: &dyn Files) -> Result<Self, SceneError> {
        let section = |name: &'static str| required(root, name);
        let material = section("material").and_then(|material| Material::read(&material));
        let population = section("surface").and_then(|surface| {
            let lubricant = surface.optional("lubricant_thickness", |entry| entry.measured());
            // A radius that is given is judged before the surface that follows from it.
            if let (Ok(material), Some(Ok(radius))) =
                (&material, surface.get("asperity_radius").map(|entry| entry.measured()))
            {
                material.asperity(radius, 0.0)?;
            }
            (population(&surface, files), lubricant).together()
        });
        let model = section("model").and_then(|model| Way::read(&model));
        // What a separation is depends on the surface, whether it is one does not.
        let separation = section("separation").and_then(|h| {
            let span = h.optional("stiffness_span", |span| span.measured());
            (separation::separations(&h, 1.0), span).together().map(|_| h)
        });
        let cycle = model.as_ref().is_ok_and(|model| model.cycle);
        let instability = match &model {
            Ok(_) => instability::instability(root, cycle),
            Err(_) => Ok(Instability::default()),
        };
        let ensemble =
            section("ensemble").and_then(|ensemble| Draws::read(&ensemble).map(|draws| (ensemble, draws)));
        let readings =
            (root.known(), heading(root), material, population, model, separation, instability, ensemble);
        let (solver, output) = (sum_tolerance(root), curves(root));
        let (readings, sum_tolerance, curves) = (readings.together(), solver, output).together()?;
        let ((), title, material, (population, lubricant), model, separation, instability, (ensemble, draws)) =
            readings;
        let Population { surface, inputs } = population;
        let asperity = material.asperity(surface.asperity_radius, lubricant.unwrap_or(0.0))?;
        let Way { law, path, cycle, unloaded_radius, critical_approach } = model;
        if let Some(entry) =
            required(root, "model")?.get("path").filter(|_| cycle && surface.is_polydisperse())
        {
            return Err(entry.wrong(
                "a loop is for asperities of one radius; those of several are computed on \"approach\" or \"retraction\"",
            ));
        }
        let separations = separation::separations(&separation, surface.surface_height_std)?;
        let stiffness_span =
            separation::stiffness_span(&separation, &separations, asperity.equilibrium_spacing)?;
        let most = UNIT_RANGE.1
            * Scale::new(&asperity).map_err(|error| SceneError::general(error.to_string()))?.length;
        let d = [separations[0], separations[separations.len() - 1]]
            .map(|h| surface.asperity_separation(h).abs());
        let furthest = d[0].max(d[1]).max(surface.heights.std);
        if !(furthest <= most) {
            return Err(SceneError::general(format!(
                "[separation] and [surface] reach {furthest:e} m, but laws are computed to {most:e} m; check the units of h, \
                 mean_plane_offset, surface_height_std, asperity_height_std and asperity_density"
            )));
        }
        let Draws { replicas, stopping, sampling, seed } = draws;
        if let Some(entry) = ensemble.get("sampling").filter(|_| sampling.group() > 1 && !surface.is_plain())
        {
            return Err(entry.wrong(
                "is for surfaces of one radius with Gaussian heights and a fixed number of asperities; others need \"independent\"",
            ));
        }
        let scene = Self {
            text: with_inputs(text, &inputs),
            title,
            asperity,
            surface,
            model: law,
            path,
            cycle,
            unloaded_radius,
            instability,
            critical_approach,
            separations,
            stiffness_span,
            inputs,
            replicas,
            stopping,
            sampling,
            seed,
            sum_tolerance,
            curves,
        };
        scene.resolves_separations().map_err(|problem| {
            match separation.get("h").or_else(|| separation.get("h_star")) {
                Some(entry) => entry.wrong(&problem),
                None => SceneError::general(problem),
            }
        })?;
        Ok(scene)
    }

    /// Refuses separations that cannot be told apart where the asperities are.
    fn resolves_separations(&self) -> Result<(), String> {
        let asperity_separations =
            self.separations.windows(2).map(|pair| [0, 1].map(|i| self.surface.asperity_separation(pair[i])));
        if asperity_separations.into_iter().all(|[nearer, further]| nearer < further) {
            return Ok(());
        }
        let offset = self.surface.mean_plane_offset;
        Err(format!(
            "beside a mean_plane_offset of {offset:e} m these separations are lost in rounding: check their units"
        ))
    }

    /// The fewest replicas that a run of it ends with.
    pub fn fewest_replicas(&self) -> u64 {
        self.stopping.as_ref().map_or(self.replicas, |stopping| stopping.min_replicas)
    }

    /// The range of interferences, m, that the heights of any replica reach.
    pub fn reach(&self) -> (f64, f64) {
        reach(&self.surface.heights, &self.surface, &self.separations)
    }

    /// The adhesion parameter and the units of the scaled variables.
    pub fn scale(&self) -> Scale {
        Scale::new(&self.asperity).expect("a scene is validated when it is read")
    }

    /// The name of its path.
    pub fn path_name(&self) -> &'static str {
        if self.cycle { LOOP } else { self.path.name() }
    }

    /// States that a surface is summed in: the separations, of a loop twice.
    pub fn states(&self) -> usize {
        self.separations.len() * if self.cycle { 2 } else { 1 }
    }

    /// The loop of an asperity of the scene, if the surfaces are pulled back.
    ///
    /// # Errors
    /// As [`Scene::law_of`].
    pub fn loop_law(&self) -> Result<Option<Loop>, LawError> {
        self.cycle.then(|| self.loop_law_of(self.unloaded_radius)).transpose()
    }

    /// The loop of an asperity of the scene whose top has one or the other radius once it has flowed.
    ///
    /// # Errors
    /// As [`Loop::new`].
    pub fn loop_law_of(&self, radius: UnloadedRadius) -> Result<Loop, LawError> {
        Loop::new(&self.model, &self.parameters()?, radius)
    }

    /// The asperity law of the scene.
    ///
    /// # Errors
    /// As [`Scene::law_of`].
    pub fn law(&self) -> Result<Box<dyn Law>, LawError> {
        self.law_of(&self.model)
    }

    /// Another law for the asperities of the scene.
    ///
    /// # Errors
    /// [`LawError`] when the law cannot be made for them.
    pub fn law_of(&self, model: &Model) -> Result<Box<dyn Law>, LawError> {
        let law = model.law(&self.parameters()?)?;
        if !self.surface.is_polydisperse() {
            return Ok(law);
        }
        let family = Family::new(*model, self.asperity, self.path, RADIUS_RANGE)?;
        Ok(Box::new(Typical::new(law, family)))
    }

    fn parameters(&self) -> Result<LawParameters, LawError> {
        let parameters = LawParameters::new(&self.asperity, self.path, self.reach())?;
        Ok(LawParameters { critical_approach: self.critical_approach, ..parameters })
    }
}

/// What a file of a scene says: one scene, or a sweep of them.
#[derive(Clone, Debug)]
pub struct Document {
    /// The scene; of a sweep that of its first point.
    pub scene: Scene,
    /// The sweep.
    pub sweep: Option<Sweep>,
}

impl Document {
    /// Reads a scene or a sweep, all of whose points have to be scenes, and what they take out of files.
    ///
    /// # Errors
    /// [`SceneError`] with the line, the key, what was given and what would do, and the point where it is one
    /// of a sweep.
    pub fn parse(text: &str, files: Arc<dyn Files>) -> Result<Self, SceneError> {
        let document = document(text)?;
        let root = Section::root(text, document.get_ref());
        let read = match root.get("sweep") {
            None => Scene::read(text, &root, files.as_ref()).map(|scene| Self { scene, sweep: None }),
            Some(sweep) => Sweep::read(text, &sweep, files).and_then(Self::swept),
        };
        read.map_err(SceneError::shortened)
    }

    /// A sweep and the scene of its first point.
    fn swept(sweep: Sweep) -> Result<Self, SceneError> {
        let scene = sweep.scene(0)?;
        if scene.stopping.is_some() {
            let problem = "`ensemble.target`: all points of a sweep have the same replicas, so that their differences are those of the \
                           same surfaces; give replicas in its place";
            return Err(SceneError::general(problem));
        }
        (1..sweep.count()).try_for_each(|point| sweep.scene(point).map(drop))?;
        Ok(Self { scene, sweep: Some(sweep) })
    }
}

/// A scene's text, and behind it what each of its files gave: the same text is then the same scene.
pub fn with_inputs(text: &str, inputs: &[Input]) -> String {
    let mut text = text.to_owned();
    for input in inputs {
        let line = format!("# {}\n", echo::one_line(&input.line()));
        if !text.contains(&line) {
            let end = if text.is_empty() || text.ends_with('\n') { "" } else { "\n" };
            text += &format!("{end}{line}");
        }
    }
    text
}

fn required<'a>(root: &Section<'a>, name: &'a str) -> Result<Section<'a>, SceneError> {
    Ok(root.section(name, true)?.expect("a required section is there or an error"))
}

/// Refuses another format; the title, empty without one.
fn heading(root: &Section<'_>) -> Result<String, SceneError> {
    let format = root.require("format").and_then(|format| match format.integer(0..=u64::MAX)? {
        FORMAT => Ok(()),
        _ => Err(format.wrong(&format!("this program reads scenes of format {FORMAT}"))),
    });
    let title = root.optional("title", |title| title.string().map(str::to_owned));
    (format, title).together().map(|((), title)| title.unwrap_or_default())
}

fn curves(root: &Section<'_>) -> Result<bool, SceneError> {
    let output = root.section("output", false)?;
    output.and_then(|output| output.get("curves")).map_or(Ok(false), |entry| entry.boolean())
}

fn sum_tolerance(root: &Section<'_>) -> Result<Option<f64>, SceneError> {
    let Some(solver) = root.section("solver", false)? else { return Ok(None) };
    let compressed = solver.get("sum").map_or(Ok(false), |entry| entry.choice("sum", &SUMS))?;
    let Some(entry) = solver.get("tolerance") else { return Ok(compressed.then_some(SUM_TOLERANCE)) };
    if !compressed {
        return Err(entry.wrong("direct sums have no tolerance; sum = \"compressed\" has one"));
    }
    let tolerance = entry.number()?;
    if !SUM_TOLERANCES.contains(&tolerance) {
        let (low, high) = (SUM_TOLERANCES.start(), SUM_TOLERANCES.end());
        return Err(entry.wrong(&format!("a tolerance of sums is between {low:e} and {high:e}")));
    }
    Ok(Some(tolerance))
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

/// The radius of tops that have flowed; only a loop asks for it.
fn unloaded_radius(section: &Section<'_>, cycle: bool) -> Result<UnloadedRadius, SceneError> {
    let Some(entry) = section.get("unloaded_radius") else { return Ok(UnloadedRadius::default()) };
    if !cycle {
        return Err(
            entry.wrong("it is for surfaces that are pulled back after they were pressed: path = \"loop\"")
        );
    }
    entry.choice("unloaded_radius", &UnloadedRadius::ALL)
}

/// The law of a scene and its history.
struct Way {
    law: Model,
    path: Path,
    cycle: bool,
    unloaded_radius: UnloadedRadius,
    critical_approach: Option<f64>,
}

impl Way {
    fn read(section: &Section<'_>) -> Result<Self, SceneError> {
        let models: Vec<(&str, Model)> = MODELS.iter().map(|model| (model.name, *model)).collect();
        let law = section.require("law").and_then(|law| law.choice("law", &models));
        let path = section.optional("path", |entry| entry.choice("path", &HISTORIES));
        let critical_approach = match &law {
            Ok(law) => critical_approach(section, law),
            Err(_) => Ok(None),
        };
        let unloaded_radius = match &path {
            Ok(path) => unloaded_radius(section, path.is_some_and(|(_, cycle)| cycle)),
            Err(_) => Ok(UnloadedRadius::default()),
        };
        let readings = (law, path, unloaded_radius, critical_approach);
        let (law, path, unloaded_radius, critical_approach) = readings.together()?;
        let (path, cycle) = path.unwrap_or((Path::Approach, false));
        Ok(Self { law, path, cycle, unloaded_radius, critical_approach })
    }
}

/// How many replicas there are, and how they are drawn.
struct Draws {
    replicas: u64,
    stopping: Option<Stopping>,
    sampling: SamplingScheme,
    seed: u64,
}

impl Draws {
    fn read(section: &Section<'_>) -> Result<Self, SceneError> {
        let sampling = section.optional("sampling", |entry| entry.choice("sampling", &SamplingScheme::ALL));
        let sampling = sampling.map(Option::unwrap_or_default);
        let replicas = stopping::replicas(section, *sampling.as_ref().unwrap_or(&SamplingScheme::default()));
        let seed = section.optional("seed", |entry| entry.whole());
        let ((replicas, stopping), sampling, seed) = (replicas, sampling, seed).together()?;
        Ok(Self { replicas, stopping, sampling, seed: seed.unwrap_or(1) })
    }
}
