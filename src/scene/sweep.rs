//! Sweeps: a scene with lists of values for some of its keys, and the ordinary scene of every point.
//!
//! ```toml
//! [sweep]
//! mode = "grid"                      # every value with every other; or "zip": the first with the first, and so on
//! common_random_numbers = true
//! "material.work_of_adhesion" = { from = "0.04 J/m^2", to = "0.3 J/m^2", count = 7, spacing = "log" }
//! "surface.lubricant_thickness" = ["0 nm", "0.5 nm", "1 nm"]
//! ```

use super::axes::{Axis, SweepTable};
use super::definition::Scene;
use super::error::{SceneError, all};
use super::files::Files;
use super::mode::Mode;
use super::parse::read;
use super::reader::{Entry, Section, document};
use super::settings::{COUPLING, place, uncouple};
use super::table::KEYS;
use crate::asperity::{Model, PUBLISHED_FITS, model};
use std::sync::Arc;
use toml_edit::{DocumentMut, Item};

/// Tables and keys of `[model]` that only some laws take. Of a sweep over laws they are left out at points of others.
const OF_SOME_LAWS: [OfSomeLaws; 3] = [
    OfSomeLaws { table: "", key: LIQUID, takes: Model::is_wet },
    OfSomeLaws { table: "model", key: "critical_approach", takes: |law| law.name == PUBLISHED_FITS },
    OfSomeLaws { table: "model", key: "plastic_contact", takes: |law| law.contact().is_some() },
];
const LIQUID: &str = "capillary";

/// A key of a table (empty: of the scene) and the laws that take it.
struct OfSomeLaws {
    table: &'static str,
    key: &'static str,
    takes: fn(&Model) -> bool,
}

/// A sweep: points in the order of the keys, the last of which runs fastest.
#[derive(Clone, Debug)]
pub struct Sweep {
    /// The combination of the keys.
    pub mode: Mode,
    /// Whether all points have the same random numbers.
    pub common_random_numbers: bool,
    /// The keys, at least one.
    pub axes: Vec<Axis>,
    /// The text of the scene.
    text: String,
    /// The scene without its sweep.
    template: DocumentMut,
    /// Source of the files that the scene names.
    files: Arc<dyn Files>,
}

impl Sweep {
    /// Reads the table \[sweep\] of a scene.
    pub(super) fn read(text: &str, sweep: &Entry<'_>, files: Arc<dyn Files>) -> Result<Self, SceneError> {
        let SweepTable { mode, common_random_numbers, axes } = SweepTable::read(sweep)?;
        let template = template(text)?;
        all(axes.iter().map(|axis| refuse_pair(&template, axis.key.name)))?;
        Ok(Self { mode, common_random_numbers, axes, text: text.to_owned(), template, files })
    }

    /// The text of the scene with its sweep.
    pub fn source(&self) -> &str {
        &self.text
    }

    /// The number of points, at least 1.
    pub fn count(&self) -> usize {
        self.shape().iter().product()
    }

    /// The lengths of the dimensions: one for each key of a grid, one for all keys of a zip.
    pub fn shape(&self) -> Vec<usize> {
        match self.mode {
            Mode::Grid => self.axes.iter().map(|axis| axis.values.len()).collect(),
            Mode::Zip => vec![self.axes[0].values.len()],
        }
    }

    /// The index of a point along each dimension.
    pub fn place(&self, point: usize) -> Vec<usize> {
        let mut rest = point;
        let mut place: Vec<usize> =
            self.shape().iter().rev().map(|length| (rest % length, rest /= length).0).collect();
        place.reverse();
        place
    }

    /// The value of each key at a point, SI.
    pub fn values(&self, point: usize) -> Vec<f64> {
        let place = self.place(point);
        let index = |axis: usize| if self.mode == Mode::Zip { place[0] } else { place[axis] };
        self.axes.iter().enumerate().map(|(i, axis)| axis.values[index(i)]).collect()
    }

    /// A point in words: its number, and the value of each key.
    pub fn name(&self, point: usize) -> String {
        format!("point {} of {} ({})", point + 1, self.count(), self.assignments(point))
    }

    /// The value of each key at a point, in words.
    pub fn assignments(&self, point: usize) -> String {
        let values = self.values(point);
        let pairs = self
            .axes
            .iter()
            .zip(values)
            .map(|(axis, v)| format!("{} = {}", axis.key.name, axis.key.shown(v)));
        pairs.collect::<Vec<String>>().join(", ")
    }

    /// The text of the scene of a point, an ordinary scene.
    ///
    /// # Errors
    /// [`SceneError`] when the scene has no place for the keys.
    pub fn text(&self, point: usize) -> Result<String, SceneError> {
        let mut scene = self.template.clone();
        for (axis, number) in self.axes.iter().zip(self.values(point)) {
            put(&mut scene, axis.key.name, axis.key.item(number))?;
        }
        if self.axes.iter().any(|axis| axis.key.name == COUPLING) {
            uncouple(&mut scene);
        }
        let Some(law) = self.law(point) else { return Ok(scene.to_string()) };
        for OfSomeLaws { table, key, .. } in OF_SOME_LAWS.iter().filter(|of| !(of.takes)(&law)) {
            let table = if table.is_empty() { Some(scene.as_item_mut()) } else { scene.get_mut(table) };
            table.and_then(Item::as_table_like_mut).and_then(|table| table.remove(key));
        }
        Ok(scene.to_string())
    }

    /// The law of a point of a sweep over laws.
    fn law(&self, point: usize) -> Option<Model> {
        let values = self.values(point);
        let of_law = self.axes.iter().zip(values).find(|(axis, _)| axis.key.name == "model.law");
        of_law.and_then(|(axis, value)| model(&axis.key.shown(value)))
    }

    /// Whether the liquid of the scene is left out at a point, as its law knows none.
    pub fn is_left_dry(&self, point: usize) -> bool {
        self.template.contains_key(LIQUID) && self.law(point).is_some_and(|law| !law.is_wet())
    }

    /// The scene of a point.
    ///
    /// # Errors
    /// [`SceneError`] of that scene, with the point named, and the line where it is one of the sweep's own
    /// text.
    pub fn scene(&self, point: usize) -> Result<Scene, SceneError> {
        let mut scene = self.alone(point)?;
        if !self.common_random_numbers {
            scene.seed = self.seed(scene.seed, point);
        }
        Ok(scene)
    }

    /// The scene of a point with the seed of the sweep.
    ///
    /// # Errors
    /// As [`Sweep::scene`].
    pub fn alone(&self, point: usize) -> Result<Scene, SceneError> {
        let text = self.text(point)?;
        let document = document(&text)
            .and_then(|document| read(&text, &Section::root(&text, document.get_ref(), &KEYS), &self.files));
        // A sweep over plastic contacts is their range.
        let are_swept = self.axes.iter().any(|axis| axis.key.name == "model.plastic_contact");
        let document = document.map(|scene| Scene { model_range: scene.model_range && !are_swept, ..scene });
        document.map_err(|mut error| {
            let point = self.name(point).replace(" (", " (`").replace(')', "`)");
            for problem in &mut error.problems {
                problem.line = problem.line.and_then(|line| self.own_line(text.lines().nth(line - 1)?));
                problem.text = format!("at {point}: {}", problem.text);
            }
            error
        })
    }

    /// The seed of a point: with common random numbers that of the sweep, else output `point` of the
    /// generator SplitMix64 (Steele, Lea and Flood 2014, OOPSLA 453) that begins at the seed of the sweep,
    /// without its lowest bit.
    pub fn seed(&self, seed: u64, point: usize) -> u64 {
        if self.common_random_numbers { seed } else { split_mix(seed, point as u64) >> 1 }
    }

    /// The line of the sweep's text, from 1, that equals a line of a point.
    fn own_line(&self, line: &str) -> Option<usize> {
        self.text.lines().position(|own| own == line).map(|index| index + 1)
    }
}

/// Output `index` of SplitMix64 begun at `state`.
fn split_mix(state: u64, index: u64) -> u64 {
    let mut z = state.wrapping_add(0x9E37_79B9_7F4A_7C15_u64.wrapping_mul(index.wrapping_add(1)));
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ (z >> 31)
}

/// A scene without its sweep.
fn template(text: &str) -> Result<DocumentMut, SceneError> {
    let mut template: DocumentMut =
        text.parse().map_err(|_| SceneError::general("[sweep]: the scene cannot be taken apart as TOML"))?;
    template.remove("sweep");
    Ok(template)
}

/// Refuses a key of which the scene has two values, where a point has one.
fn refuse_pair(template: &DocumentMut, name: &str) -> Result<(), SceneError> {
    let Some((table, key)) = name.split_once('.') else { return Ok(()) };
    let value = template.get(table).and_then(|table| table.get(key));
    if !value.is_some_and(Item::is_array) {
        return Ok(());
    }
    let advice = match table {
        "material" => {
            "give reduced_modulus there, without youngs_modulus, and hardness and poisson_ratio of the softer body"
        }
        "surface" => "give one value there, of both surfaces together",
        _ => return Ok(()),
    };
    Err(SceneError::general(format!(
        "`sweep.{name}`: [{table}] has two values of it, and a point of a sweep has one: {advice}"
    )))
}

/// Puts a value in the place of a key, whatever it was.
fn put(scene: &mut DocumentMut, name: &str, value: Item) -> Result<(), SceneError> {
    let path: Vec<&str> = name.split('.').collect();
    place(scene, &path, value)
        .map_err(|table| SceneError::general(format!("`{table}`: a table [{table}] is needed")))
}

#[cfg(test)]
mod tests {
    use super::super::axes::{SWEEPABLE, Sweepable};
    use super::super::background::FORCES;
    use super::super::units::Dimension;
    use super::*;
    use crate::scene::files::NoFiles;
    use crate::surface::{HEIGHT_LAWS, NamedLaw};

    /// The first outputs of the published generator begun at 1234567 (Vigna, splitmix64.c; Rosetta Code,
    /// "Pseudo-random numbers/Splitmix64").
    #[test]
    fn seeds_are_those_of_splitmix64() {
        let expected = [
            6457827717110365317,
            3203168211198807973,
            9817491932198370423,
            4593380528125082431,
            16408922859458223821,
        ];
        for (i, output) in expected.into_iter().enumerate() {
            assert_eq!(split_mix(1234567, i as u64), output);
        }
    }

    /// A scene that has a key, or as much as it needs to take one.
    fn scene_with(key: &Sweepable) -> String {
        let of_law = match key.name.rsplit_once('.') {
            Some(("surface.heights", parameter)) => {
                let has = |law: &&NamedLaw| law.parameters.iter().any(|own| own.key == parameter);
                let NamedLaw { name, parameters, .. } = HEIGHT_LAWS.iter().find(has).unwrap();
                let example = |key: &str| KEYS.example(&format!("surface.heights.{key}")).unwrap();
                let values = parameters.iter().map(|own| format!(", {} = {}", own.key, example(own.key)));
                format!("heights = {{ law = \"{name}\"{} }}\n", values.collect::<String>())
            }
            Some(("surface.radii", _)) => {
                "radii = { law = \"gamma\", coefficient_of_variation = 0.5 }\n".to_owned()
            }
            _ => String::new(),
        };
        let scene = include_str!("../../configs/paper/case_iii_delta_a.toml")
            .replace("count = 181", "count = 5")
            .replace("[ensemble]", "[solver]\nsummation = \"moments\"\n\n[ensemble]")
            .replace("[surface]\n", &format!("[surface]\n{of_law}"));
        let own = key.name.split_once('.').unwrap_or_default().0;
        let force = FORCES.iter().find(|table| table.name == own);
        // A table of a force is as its example, which stands before all others.
        let force = force.map_or(String::new(), |table| format!("{own} = {}\n", table.keys[0].example));
        let table = if own == "substrate" { "[substrate]\ncoupling = \"patch\"\n" } else { "" };
        let liquid = match key.name {
            "capillary.surface_tension" | "capillary.molar_volume" => {
                "surface_tension = \"30 mN/m\"\nmolar_volume = \"30 cm^3/mol\"\n"
            }
            _ => "",
        };
        let equilibrium = match key.name {
            "capillary.film_thickness" | "capillary.hamaker_constant" => {
                "film_thickness = \"1 nm\"\nhamaker_constant = \"1e-19 J\"\nfilm_faces = 1"
            }
            _ => "relative_humidity = 0.5",
        };
        let liquid = format!("[capillary]\n{equilibrium}\ncontact_angles = [0, 0]\n{liquid}");
        if let Some(own) = key.name.strip_prefix("shape.") {
            let keys = match own {
                "flat_radius" | "edge_radius" => {
                    "body = \"punch\"\nflat_radius = \"1 um\"\nedge_radius = \"1 um\""
                }
                "side" | "angle" => "body = \"tilted\"\nside = \"1 um\"\nangle = \"1 deg\"",
                _ => "body = \"cylinder\"\nradius = \"1 um\"\nlength = \"1 um\"",
            };
            return format!("{}\n[shape]\n{keys}\n", scene.replace("nominal_area =", "# nominal_area ="));
        }
        // Fits are of one dry law, and of loops whose summits keep their radius.
        let (law, history, liquid) = match key.name {
            "model.law" => ("hybrid", "approach", ""),
            "model.plastic_contact" => ("md_plastic", "approach", ""),
            name if name.starts_with("capillary.") => ("capillary", "approach", liquid.as_str()),
            _ => return format!("{force}{scene}\n{table}"),
        };
        let scene = scene
            .replace("critical_approach =", "# critical_approach =")
            .replace("fit:paper", law)
            .replace("history = \"approach\"", &format!("history = \"{history}\""));
        format!("{scene}\n{liquid}")
    }

    /// A number that would do for most keys of its dimension.
    fn number_for(key: &Sweepable) -> f64 {
        match key.dimension {
            // Neither the law nor the choices of the scene.
            None if key.name == "model.law" => 2.0,
            None if !key.names.is_empty() => 1.0,
            None if key.name == "surface.heights.shape" => 2.0,
            None if key.name.starts_with("surface.heights") || key.name.starts_with("surface.radii") => 0.25,
            None if key.name.starts_with("solver") || key.name.starts_with("substrate") => 1e-5,
            None if key.name == "electrostatic.relative_permittivity" => 7.0,
            None => 0.3,
            Some(Dimension::Length) if key.name == "surface.asperity_radius" => 7e-6,
            Some(Dimension::Length) if key.name.starts_with("shape") => 7e-6,
            Some(Dimension::Angle) if key.name.starts_with("shape") => 0.02,
            Some(Dimension::Length) => 0.7e-9,
            Some(Dimension::Area) => 1.25e-10,
            Some(Dimension::ArealDensity) => 1.25e13,
            Some(Dimension::Pressure) => 1.25e9,
            Some(Dimension::SurfaceEnergy) => 0.125,
            Some(Dimension::Force | Dimension::Stiffness | Dimension::Angle) => 1.25,
            Some(Dimension::Energy) => 1.25e-19,
            Some(Dimension::Voltage) => 12.5,
            Some(Dimension::Temperature) => 300.0,
            Some(Dimension::MolarVolume) => 1.25e-5,
        }
    }

    /// Every key of the table is one that scenes know, and is put where scenes read it.
    #[test]
    fn every_key_that_can_be_swept_is_one_of_scenes() {
        keys_are_of_scenes(|name| !FILMS.contains(&name));
    }

    /// Keys of films, which are solved whenever a scene is read.
    const FILMS: [&str; 2] = ["capillary.film_thickness", "capillary.hamaker_constant"];

    #[test]
    #[ignore = "slow: ten seconds"]
    fn keys_of_films_that_can_be_swept_are_of_scenes() {
        keys_are_of_scenes(|name| FILMS.contains(&name));
    }

    fn keys_are_of_scenes(of: fn(&str) -> bool) {
        for key in SWEEPABLE.iter().filter(|key| of(key.name)) {
            let scene = scene_with(key);
            let base = Scene::parse(&scene).unwrap();
            let sweep = Sweep {
                mode: Mode::Grid,
                common_random_numbers: true,
                axes: vec![Axis { key, values: vec![number_for(key)] }],
                text: scene.clone(),
                template: template(&scene).unwrap(),
                files: Arc::new(NoFiles),
            };
            let swept = sweep.scene(0).unwrap();
            let numbers = |scene: &Scene| {
                format!(
                    "{:?} {:?} {:?} {:?} {:?} {} {:?} {:?} {:?}",
                    scene.asperity,
                    scene.surface,
                    scene.critical_approach,
                    scene.sums,
                    scene.substrate,
                    scene.model.name,
                    scene.model.meniscus(),
                    scene.model.contact(),
                    scene.restoring_force
                )
            };
            assert_ne!(numbers(&swept), numbers(&base), "{}", key.name);
        }
    }

    #[test]
    fn values_read_back_as_the_same_doubles() {
        let key = Sweepable::named("material.work_of_adhesion").unwrap();
        for number in [0.1, 1.0 / 3.0, 1.2345678901234567e-300, f64::MIN_POSITIVE, 0.0, 12345678.9] {
            let text = key.item(number).as_str().unwrap().to_owned();
            assert_eq!(
                super::super::units::parse(&text, Dimension::SurfaceEnergy).map(f64::to_bits),
                Ok(number.to_bits())
            );
        }
    }
}
