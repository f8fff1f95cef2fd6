//! The table `[sweep]` of a scene: the keys that are swept and their values.

use super::echo::shortened;
use super::error::{SceneError, Together, all};
use super::keys::{Key, Value};
use super::lookup::nearest;
use super::mode::{MOST_POINTS, Mode, SPACINGS};
use super::reader::{Entry, Section};
use super::table::KEYS;
use super::units::{Dimension, rounded};
use std::sync::LazyLock;
use toml::de::DeValue;
use toml_edit::{Item, value};

/// Most keys of a sweep.
pub const MOST_KEYS: usize = 6;

/// A key of a scene that can be swept.
#[derive(Debug, PartialEq, Eq)]
pub struct Sweepable {
    /// The dotted name.
    pub name: &'static str,
    /// The dimension; none for a number.
    pub dimension: Option<Dimension>,
    /// The names that its numbers stand for, from 0; empty for most.
    pub names: Vec<&'static str>,
    /// The meaning, in words.
    pub long_name: &'static str,
}

/// All keys that can be swept: the numbers of a scene, but for those that every point has to have alike.
pub static SWEEPABLE: LazyLock<Vec<Sweepable>> = LazyLock::new(|| {
    let swept = KEYS.iter().copied().filter(|key| key.is_swept);
    let sweepable = |key: &Key| {
        let dimension = match key.value {
            Value::Quantity(dimension, _) | Value::OneOrMore(dimension, ..) => Some(dimension),
            _ => None,
        };
        let names = match key.value {
            Value::Choice(names) => names(),
            _ => Vec::new(),
        };
        Sweepable { name: key.name, dimension, names, long_name: key.what }
    };
    swept.map(sweepable).collect()
});

/// Keys that are not swept, by how their names begin, and what would do.
const REFUSED: &[(&str, &str)] = &[
    ("ensemble.replicas", "all points have the same replicas: give them in [ensemble]"),
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
    ("capillary.", "is no number: give it in [capillary]"),
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

    /// A value, SI, as it is written in the scene of a point; it reads back as the same double.
    pub(super) fn item(&self, number: f64) -> Item {
        match self.dimension {
            _ if !self.names.is_empty() => value(self.names[number as usize]),
            Some(dimension) => value(format!("{number:e} {}", dimension.si())),
            None => value(number),
        }
    }

    /// A value, SI, in messages and tables.
    pub fn shown(&self, number: f64) -> String {
        if let Some(name) = self.names.get(number as usize) {
            return (*name).to_owned();
        }
        self.dimension.map_or_else(|| rounded(number), |dimension| dimension.shown(number))
    }

    /// The meaning of its numbers, in words.
    pub fn meaning(&self) -> String {
        let names = self.names.iter().enumerate().map(|(i, name)| format!("{i} {name}"));
        let names = names.collect::<Vec<String>>().join(", ");
        if names.is_empty() { self.long_name.to_owned() } else { format!("{}: {names}", self.long_name) }
    }

    /// Reads a value, SI.
    fn read(&self, entry: &Entry<'_>) -> Result<f64, SceneError> {
        if !self.names.is_empty() {
            let numbers: Vec<(&str, usize)> = self.names.iter().copied().zip(0..).collect();
            return entry.choice(self.name, &numbers).map(|number| number as f64);
        }
        match self.dimension {
            None => entry.number(),
            Some(_) if entry.number() == Ok(0.0) => Ok(0.0),
            Some(dimension) => entry.quantity(dimension),
        }
    }
}

/// A key and its values.
///
/// # Examples
/// ```
/// use stiction::scene::{Axis, Document, Mode};
///
/// let sweep = Document::from_toml_file("configs/sweep_lubricant.toml")?.sweep.unwrap();
/// let axis: &Axis = &sweep.axes[0];
/// assert_eq!(axis.key.name, "surface.lubricant_thickness");
/// assert!(sweep.mode == Mode::Zip || sweep.count() >= axis.values.len());
/// # Ok::<(), stiction::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Axis {
    /// The key.
    pub key: &'static Sweepable,
    /// The values, SI.
    pub values: Vec<f64>,
}

/// The table \[sweep\].
pub(super) struct SweepTable {
    pub mode: Mode,
    pub common_random_numbers: bool,
    pub axes: Vec<Axis>,
}

impl SweepTable {
    /// Reads the table.
    pub fn read(sweep: &Entry<'_>) -> Result<Self, SceneError> {
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
        Ok(Self { mode, common_random_numbers, axes })
    }
}

/// The table \[sweep\] while it is read.
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
            return self.collect(&entry.any_table("its keys are the keys of the scene's table")?, name);
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
    let mut sections: Vec<&str> =
        SWEEPABLE.iter().filter_map(|key| Some(key.name.split_once('.')?.0)).collect();
    sections.dedup();
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
    if !key.names.is_empty() {
        return Err(entry.wrong(&format!("a list is needed, of {}", key.names.join(", "))));
    }
    let table = entry.table()?;
    let end = |name: &str| table.require(name).and_then(|end| key.read(&end));
    let spacing = table.value("spacing").choice("spacing", &SPACINGS);
    let (from, to, count, logarithmic) = (end("from"), end("to"), length(entry), spacing).together()?;
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
