//! Sweeps: a scene with lists of values for some of its keys, and the ordinary scene of every point.
//!
//! ```toml
//! [sweep]
//! mode = "grid"                      # every value with every other; or "zip": the first with the first, and so on
//! common_random_numbers = true
//! "material.work_of_adhesion" = { from = "0.04 J/m^2", to = "0.3 J/m^2", count = 7, spacing = "log" }
//! "surface.lubricant_thickness" = ["0 nm", "0.5 nm", "1 nm"]
//! ```

use super::choices::{MOST_POINTS, Mode, SPACINGS};
use super::definition::Scene;
use super::echo::shortened;
use super::error::{SceneError, Together, all};
use super::files::Files;
use super::keys::{Key, Value};
use super::lookup::nearest;
use super::parse::read;
use super::reader::{Entry, Section, document};
use super::table::KEYS;
use super::units::{Dimension, rounded};
use std::sync::{Arc, LazyLock};
use toml::de::DeValue;
use toml_edit::{DocumentMut, Item, TableLike, value};

/// Most keys of a sweep.
pub const MOST_KEYS: usize = 6;
/// A key of a scene that can be swept.
#[derive(Debug, PartialEq, Eq)]
pub struct Sweepable {
    /// Its dotted name.
    pub name: &'static str,
    /// What it measures; none for a number.
    pub dimension: Option<Dimension>,
    /// What it is, in words.
    pub long_name: &'static str,
}

/// All keys that can be swept: the numbers of a scene, but for those that every point has to have alike.
pub static SWEEPABLE: LazyLock<Vec<Sweepable>> = LazyLock::new(|| {
    let swept = KEYS.iter().filter(|key| key.is_swept);
    let sweepable = |key: &Key| {
        let dimension = match key.value {
            Value::Quantity(dimension, _) => Some(dimension),
            _ => None,
        };
        Sweepable { name: key.name, dimension, long_name: key.what }
    };
    swept.map(sweepable).collect()
});

/// Keys that are not swept, by how their names begin, and what would do.
const REFUSED: &[(&str, &str)] = &[
    ("ensemble.replicas", "all points have the same replicas: give them in [ensemble], or with --replicas"),
    (
        "ensemble.seed",
        "all points have the same seed; common_random_numbers = false gives each one of its own",
    ),
    ("ensemble.", "all points are sampled alike: give it in [ensemble]"),
    (
        "separation",
        "all points have the same separations: give them in [separation]; h_star follows surface_height_std",
    ),
    ("output", "all points are kept alike: give it in [output]"),
    ("model.law", "a law is no number; `stiction compare` compares laws"),
    ("model.history", "a history is no number: give it in [model]"),
    ("solver.summation", "is no number: give it in [solver]"),
    ("format", "is that of the whole file"),
    ("title", "is that of the whole file"),
];

impl Sweepable {
    /// The key of a dotted name.
    pub fn named(name: &str) -> Option<&'static Self> {
        SWEEPABLE.iter().find(|key| key.name == name)
    }

    /// A value, SI, as it stands in the scene of a point; it reads back as the same double.
    fn item(&self, number: f64) -> Item {
        match self.dimension {
            Some(dimension) => value(format!("{number:e} {}", dimension.si())),
            None => value(number),
        }
    }

    /// A value, SI, in messages and tables.
    pub fn shown(&self, number: f64) -> String {
        self.dimension.map_or_else(|| rounded(number), |dimension| dimension.shown(number))
    }

    /// Reads a value, SI.
    fn read(&self, entry: &Entry<'_>) -> Result<f64, SceneError> {
        match self.dimension {
            None => entry.number(),
            Some(_) if entry.number() == Ok(0.0) => Ok(0.0),
            Some(dimension) => entry.quantity(dimension),
        }
    }
}

/// A key and its values.
#[derive(Clone, Debug)]
pub struct Axis {
    /// The key.
    pub key: &'static Sweepable,
    /// Its values, SI.
    pub values: Vec<f64>,
}

/// A sweep: points in the order of the keys, the last of which runs fastest.
#[derive(Clone, Debug)]
pub struct Sweep {
    /// How the keys are combined.
    pub mode: Mode,
    /// Whether all points have the same random numbers.
    pub common_random_numbers: bool,
    /// The keys, at least one.
    pub axes: Vec<Axis>,
    /// The text of the scene.
    text: String,
    /// The scene without its sweep.
    template: DocumentMut,
    /// Where the scene finds the files that it names.
    files: Arc<dyn Files>,
}

impl Sweep {
    /// Reads the table \[sweep\] of a scene.
    pub(super) fn read(text: &str, sweep: &Entry<'_>, files: Arc<dyn Files>) -> Result<Self, SceneError> {
        let mut options = Options { mode: Mode::Grid, common_random_numbers: true, swept: Vec::new() };
        options.collect(&sweep.any_table("its keys are dotted names of the scene")?, "")?;
        let Options { mode, common_random_numbers, mut swept } = options;
        // In the order of the text.
        swept.sort_by_key(|(_, entry)| entry.value.span().start);
        if swept.is_empty() {
            let example = "\"material.work_of_adhesion\" = [\"0.04 J/m^2\", \"0.3 J/m^2\"]";
            return Err(sweep.wrong(&format!("names no key; for example {example}")));
        }
        if swept.len() > MOST_KEYS {
            return Err(sweep.wrong(&format!("names {} keys; at most {MOST_KEYS} can be swept", swept.len())));
        }
        let lengths = all(swept.iter().map(|(_, entry)| length(entry)))?;
        check_lengths(mode, &swept, &lengths)?;
        let axes = swept.iter().map(|(key, entry)| {
            let values = values(key, entry)?;
            if mode == Mode::Grid {
                refuse_repeated(key, entry, &values)?;
            }
            Ok(Axis { key, values })
        });
        let axes = all(axes)?;
        Ok(Self {
            mode,
            common_random_numbers,
            axes,
            text: text.to_owned(),
            template: template(text)?,
            files,
        })
    }

    /// The sweep of one key of a scene that has none, with texts put in the place of some of its keys.
    ///
    /// # Errors
    /// [`SceneError`] when the text is no TOML.
    ///
    /// # Panics
    /// When the key cannot be swept, or has no values.
    pub fn along(
        text: &str,
        name: &str,
        values: Vec<f64>,
        texts: &[(&str, &str)],
        files: Arc<dyn Files>,
    ) -> Result<Self, SceneError> {
        let key = Sweepable::named(name).expect("a key that can be swept");
        assert!(!values.is_empty(), "a sweep has points");
        let mut template = template(text)?;
        for (name, text) in texts {
            put(&mut template, name, value(*text))?;
        }
        let axes = vec![Axis { key, values }];
        Ok(Self {
            mode: Mode::Grid,
            common_random_numbers: true,
            axes,
            text: text.to_owned(),
            template,
            files,
        })
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
        Ok(scene.to_string())
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
            .and_then(|document| read(&text, &Section::root(&text, document.get_ref()), self.files.as_ref()));
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

    /// The line of the sweep's text that is the same as one of a point's, from 1.
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

/// What the table \[sweep\] says.
struct Options<'a> {
    mode: Mode,
    common_random_numbers: bool,
    swept: Vec<(&'static Sweepable, Entry<'a>)>,
}

impl<'a> Options<'a> {
    /// Takes the keys of a table, whose own dotted name within \[sweep\] is `prefix`.
    fn collect(&mut self, table: &Section<'a>, prefix: &str) -> Result<(), SceneError> {
        all(table.entries().map(|(key, mut entry)| {
            let name = if prefix.is_empty() { key.to_owned() } else { format!("{prefix}.{key}") };
            entry.name = format!("sweep.{}", shortened(&name));
            match name.as_str() {
                "mode" => self.mode = entry.choice("mode", &Mode::ALL)?,
                "common_random_numbers" => self.common_random_numbers = entry.boolean()?,
                _ => self.swept_key(&name, entry)?,
            }
            Ok(())
        }))
        .map(drop)
    }

    fn swept_key(&mut self, name: &str, entry: Entry<'a>) -> Result<(), SceneError> {
        if let Some(key) = Sweepable::named(name) {
            if self.swept.iter().any(|(known, _)| *known == key) {
                return Err(entry.wrong("the key is swept twice: keep one of them"));
            }
            self.swept.push((key, entry));
            return Ok(());
        }
        let begins = format!("{name}.");
        let mut names = SWEEPABLE.iter().map(|key| key.name).chain(REFUSED.iter().map(|(name, _)| *name));
        if names.any(|known| known.starts_with(&begins)) {
            return self.collect(&entry.any_table("its keys are those of the scene's table")?, name);
        }
        if let Some((_, problem)) = REFUSED.iter().find(|(known, _)| name.starts_with(known)) {
            return Err(entry.wrong(problem));
        }
        let meant = nearest(name, SWEEPABLE.iter().map(|key| key.name));
        let meant = meant.map(|known| format!("did you mean `{known}`? ")).unwrap_or_default();
        Err(entry.wrong(&format!("no key that can be swept; {meant}{}", known())))
    }
}

/// The keys that can be swept, in messages.
fn known() -> String {
    let mut text = "known are the numbers of".to_owned();
    let sections = ["material", "surface", "model", "solver"];
    for (i, section) in sections.iter().enumerate() {
        text += &format!("{} [{section}]", if i == 0 { "" } else { "," });
    }
    text
}

/// The number of values that an entry of \[sweep\] says.
fn length(entry: &Entry<'_>) -> Result<usize, SceneError> {
    match entry.value.get_ref() {
        DeValue::Array(array) if (1..=MOST_POINTS).contains(&array.len()) => Ok(array.len()),
        DeValue::Array(array) => {
            Err(entry.wrong(&format!("has {} values; 1 to {MOST_POINTS} are needed", array.len())))
        }
        DeValue::Table(_) => {
            let table = entry.table()?;
            let count = table.require("count").and_then(|count| count.whole());
            (table.known(), count).together().map(|((), count)| count as usize)
        }
        _ => Err(entry.wrong("a list, or a table { from, to, count, spacing }, is needed")),
    }
}

fn check_lengths(mode: Mode, swept: &[(&Sweepable, Entry<'_>)], lengths: &[usize]) -> Result<(), SceneError> {
    let (_, last) = &swept[swept.len() - 1];
    if mode == Mode::Grid {
        let points = lengths.iter().try_fold(1_usize, |product, length| product.checked_mul(*length));
        return match points {
            Some(points) if points <= MOST_POINTS => Ok(()),
            _ => {
                let lengths: Vec<String> = lengths.iter().map(usize::to_string).collect();
                let grid = lengths.join(" x ");
                Err(last.wrong(&format!("the grid has {grid} points; at most {MOST_POINTS} are computed")))
            }
        };
    }
    match lengths.iter().position(|length| *length != lengths[0]) {
        None => Ok(()),
        Some(other) => Err(swept[other].1.wrong(&format!(
            "has {} values, but `{}` has {}; mode = \"zip\" needs as many of each",
            lengths[other], swept[0].0.name, lengths[0]
        ))),
    }
}

/// The values of an entry, SI.
fn values(key: &Sweepable, entry: &Entry<'_>) -> Result<Vec<f64>, SceneError> {
    if let DeValue::Array(array) = entry.value.get_ref() {
        return array.iter().enumerate().map(|(i, element)| key.read(&entry.element(i, element))).collect();
    }
    let table = entry.table()?;
    let end = |name: &str| table.require(name).and_then(|end| key.read(&end));
    let spacing = table.optional("spacing", |entry| entry.choice("spacing", &SPACINGS));
    let (from, to, count, spacing) = (end("from"), end("to"), length(entry), spacing).together()?;
    let logarithmic = spacing.unwrap_or(false);
    if logarithmic && !(from > 0.0 && to > 0.0) {
        return Err(entry.wrong("spacing = \"log\" needs ends that are greater than 0"));
    }
    let share = |i: usize| i as f64 / (count - 1) as f64;
    let inner = |i: usize| match logarithmic {
        true => from * libm::pow(to / from, share(i)),
        false => from + (to - from) * share(i),
    };
    let values: Vec<f64> = (0..count).map(|i| if i + 1 == count { to } else { inner(i) }).collect();
    if !values.iter().all(|value| value.is_finite()) {
        return Err(entry.wrong("the values between its ends are no numbers: check its units"));
    }
    Ok(values)
}

/// Refuses values that are there twice: the dimension of a key is found by its values.
fn refuse_repeated(key: &Sweepable, entry: &Entry<'_>, values: &[f64]) -> Result<(), SceneError> {
    let mut sorted = values.to_vec();
    sorted.sort_unstable_by(f64::total_cmp);
    match sorted.windows(2).find(|pair| pair[0] == pair[1]) {
        None => Ok(()),
        Some(pair) => Err(entry.wrong(&format!("has the value {} twice", key.shown(pair[0])))),
    }
}

/// A scene without its sweep.
fn template(text: &str) -> Result<DocumentMut, SceneError> {
    let mut template: DocumentMut =
        text.parse().map_err(|_| SceneError::general("[sweep]: the scene cannot be taken apart as TOML"))?;
    template.remove("sweep");
    Ok(template)
}

/// Puts a value in the place of a key, whatever it was.
fn put(scene: &mut DocumentMut, name: &str, value: Item) -> Result<(), SceneError> {
    let (tables, key) = name.rsplit_once('.').unwrap_or(("", name));
    let mut table: &mut dyn TableLike = scene.as_table_mut();
    for name in tables.split('.').filter(|name| !name.is_empty()) {
        let within = table.entry(name).or_insert_with(toml_edit::table).as_table_like_mut();
        table = within.ok_or_else(|| SceneError::general(format!("`{name}`: a table [{name}] is needed")))?;
    }
    match table.get_mut(key) {
        Some(item) => *item = value,
        None => _ = table.insert(key, value),
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::files::NoFiles;

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

    /// Every key of the table is one that scenes know, and is put where scenes read it.
    #[test]
    fn every_key_that_can_be_swept_is_one_of_scenes() {
        let scene = include_str!("../../configs/paper/case_iii_delta_a.toml");
        let scene = scene.replace("[ensemble]", "[solver]\nsummation = \"moments\"\n\n[ensemble]");
        for key in SWEEPABLE.iter() {
            let of_law = match key.name {
                "surface.heights.shape" => "heights = { law = \"weibull\", shape = 2.0 }\n",
                "surface.heights.lower" | "surface.heights.upper" => {
                    "heights = { law = \"truncated\", lower = -2.0, upper = 2.0 }\n"
                }
                "surface.radii.coefficient_of_variation" => {
                    "radii = { law = \"gamma\", coefficient_of_variation = 0.5 }\n"
                }
                _ => "",
            };
            let scene = scene.replace("[surface]\n", &format!("[surface]\n{of_law}"));
            let base = Scene::parse(&scene).unwrap();
            // Such as would do for most of them.
            let number = match key.dimension {
                None if key.name == "surface.heights.shape" => 1.5,
                None if !of_law.is_empty() => 0.25,
                None => 1e-5,
                Some(Dimension::Length) if key.name == "surface.asperity_radius" => 7e-6,
                Some(Dimension::Length) => 0.7e-9,
                Some(Dimension::Area) => 1.25e-10,
                Some(Dimension::ArealDensity) => 1.25e13,
                Some(Dimension::Pressure) => 1.25e9,
                Some(Dimension::SurfaceEnergy) => 0.125,
                Some(Dimension::Force | Dimension::Stiffness) => 1.25,
            };
            let swept = Sweep::along(&scene, key.name, vec![number], &[], Arc::new(NoFiles))
                .unwrap()
                .scene(0)
                .unwrap();
            let numbers = |scene: &Scene| {
                format!(
                    "{:?} {:?} {:?} {:?}",
                    scene.asperity, scene.surface, scene.critical_approach, scene.sum_tolerance
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
