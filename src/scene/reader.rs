//! Reading TOML with errors that name the key, its line, what was given and what would do.

use super::echo::{one_line, shortened};
use super::units::{Dimension, QuantityError, parse};
use thiserror::Error;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// Most words of a value that an error repeats.
const SHOWN_WORDS: usize = 60;
/// Longest name, in bytes, that is compared with the known ones.
const LONGEST_NAME: usize = 100;

/// What is wrong with a scene.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error("{}{problem}", line.map(|line| format!("line {line}: ")).unwrap_or_default())]
pub struct SceneError {
    /// Line of the scene, from 1; `None` for what no line shows.
    pub line: Option<usize>,
    /// The problem: key, what was given, what would do.
    pub problem: String,
}

impl SceneError {
    /// A problem that no single line shows.
    pub fn general(problem: impl Into<String>) -> Self {
        Self { line: None, problem: problem.into() }
    }
}

/// Parses the document.
pub(super) fn document(text: &str) -> Result<Spanned<DeTable<'_>>, SceneError> {
    DeTable::parse(text).map_err(|error| SceneError {
        line: error.span().map(|span| line_of(text, span.start)),
        problem: format!("not TOML: {}", one_line(error.message())),
    })
}

fn line_of(text: &str, offset: usize) -> usize {
    1 + text.as_bytes()[..offset.min(text.len())].iter().filter(|&&byte| byte == b'\n').count()
}

/// A table of the scene, with its dotted name.
#[derive(Clone, Copy)]
pub(super) struct Section<'a> {
    text: &'a str,
    name: &'a str,
    table: &'a DeTable<'a>,
}

/// A value with its dotted name.
#[derive(Clone)]
pub(super) struct Entry<'a> {
    text: &'a str,
    pub name: String,
    pub value: &'a Spanned<DeValue<'a>>,
}

impl<'a> Section<'a> {
    /// The root, which may hold `keys` only.
    pub fn root(text: &'a str, table: &'a DeTable<'a>, keys: &[&str]) -> Result<Self, SceneError> {
        Self { text, name: "", table }.restricted(keys)
    }

    /// The table `name`, which may hold `keys` only; an absent one is an error if `required`, else empty.
    pub fn section(&self, name: &'a str, keys: &[&str], required: bool) -> Result<Option<Self>, SceneError> {
        match self.get(name) {
            None if required => {
                Err(SceneError::general(format!("the table [{name}] is missing; its keys: {}", keys.join(", "))))
            }
            None => Ok(None),
            Some(entry) => match entry.value.get_ref() {
                DeValue::Table(table) => Self { text: self.text, name, table }.restricted(keys).map(Some),
                other => Err(entry.wrong(&format!("is {}, a table [{name}] is needed", kind(other)))),
            },
        }
    }

    fn restricted(self, keys: &[&str]) -> Result<Self, SceneError> {
        let unknown = self.table.keys().find(|key| !keys.contains(&key.get_ref().as_ref()));
        match unknown {
            None => Ok(self),
            Some(key) => Err(SceneError {
                line: Some(line_of(self.text, key.span().start)),
                problem: format!(
                    "unknown key `{}`; {}known here: {}",
                    self.dotted(&shortened(key.get_ref())),
                    nearest(key.get_ref(), keys.iter().copied())
                        .map(|known| format!("did you mean `{known}`? "))
                        .unwrap_or_default(),
                    keys.join(", ")
                ),
            }),
        }
    }

    fn dotted(&self, key: &str) -> String {
        if self.name.is_empty() { key.to_owned() } else { format!("{}.{key}", self.name) }
    }

    /// The value of a key, if it is there.
    pub fn get(&self, key: &str) -> Option<Entry<'a>> {
        let value = self.table.get(key)?;
        Some(Entry { text: self.text, name: self.dotted(key), value })
    }

    /// All keys and their values.
    pub fn entries(&self) -> impl Iterator<Item = (&'a str, Entry<'a>)> {
        let owner = *self;
        owner.table.iter().map(move |(key, value)| {
            let key = key.get_ref().as_ref();
            (key, Entry { text: owner.text, name: owner.dotted(&shortened(key)), value })
        })
    }

    /// The value of a key that has to be there.
    pub fn require(&self, key: &str, example: &str) -> Result<Entry<'a>, SceneError> {
        self.get(key).ok_or_else(|| {
            SceneError::general(format!("`{}` is missing; for example {key} = {example}", self.dotted(key)))
        })
    }

    /// A positive quantity that has to be there; SI.
    pub fn positive(&self, key: &str, dimension: Dimension) -> Result<f64, SceneError> {
        self.require(key, dimension.example())?.positive(dimension)
    }
}

impl<'a> Entry<'a> {
    /// An error about this value: `problem` follows the key and what was given.
    pub fn wrong(&self, problem: &str) -> SceneError {
        let span = self.value.span();
        let given = self.text.get(span.clone()).unwrap_or_default();
        let given = given.split_whitespace().take(SHOWN_WORDS).collect::<Vec<_>>().join(" ");
        SceneError {
            line: Some(line_of(self.text, span.start)),
            problem: format!("`{} = {}`: {problem}", self.name, shortened(&given)),
        }
    }

    /// An element of this array.
    pub fn element(&self, index: usize, value: &'a Spanned<DeValue<'a>>) -> Self {
        Self { text: self.text, name: format!("{}[{index}]", self.name), value }
    }

    /// This inline table as a section, which may hold `keys` only.
    pub fn table(&'a self, keys: &[&str]) -> Result<Section<'a>, SceneError> {
        match self.value.get_ref() {
            DeValue::Table(table) => Section { text: self.text, name: &self.name, table }.restricted(keys),
            other => Err(self.wrong(&format!("is {}, a table with {} is needed", kind(other), keys.join(", ")))),
        }
    }

    /// This table as a section without a name, which may hold any keys; `about` tells which make sense.
    pub fn any_table(&self, about: &str) -> Result<Section<'a>, SceneError> {
        match self.value.get_ref() {
            DeValue::Table(table) => Ok(Section { text: self.text, name: "", table }),
            other => Err(self.wrong(&format!("is {}, a table is needed; {about}", kind(other)))),
        }
    }

    /// A finite number.
    pub fn number(&self) -> Result<f64, SceneError> {
        let value = match self.value.get_ref() {
            DeValue::Integer(integer) if integer.radix() == 10 => integer.as_str().parse().ok(),
            DeValue::Integer(integer) => u64::from_str_radix(integer.as_str(), integer.radix()).ok().map(|n| n as f64),
            DeValue::Float(float) => float.as_str().parse::<f64>().ok(),
            _ => None,
        };
        match value {
            Some(value) if f64::is_finite(value) => Ok(value),
            Some(_) => Err(self.wrong("a finite number is needed")),
            None => Err(self.wrong(&format!("is {}, a number is needed", kind(self.value.get_ref())))),
        }
    }

    /// A whole number in `range`.
    pub fn integer(&self, range: std::ops::RangeInclusive<u64>) -> Result<u64, SceneError> {
        let value = match self.value.get_ref() {
            DeValue::Integer(integer) => u64::from_str_radix(integer.as_str(), integer.radix()).ok(),
            _ => None,
        };
        value
            .filter(|value| range.contains(value))
            .ok_or_else(|| self.wrong(&format!("a whole number from {} to {} is needed", range.start(), range.end())))
    }

    /// true or false.
    pub fn boolean(&self) -> Result<bool, SceneError> {
        self.value.get_ref().as_bool().ok_or_else(|| self.wrong("true or false is needed"))
    }

    /// A text.
    pub fn string(&self) -> Result<&'a str, SceneError> {
        self.value
            .get_ref()
            .as_str()
            .ok_or_else(|| self.wrong(&format!("is {}, a text is needed", kind(self.value.get_ref()))))
    }

    /// A name out of a closed list.
    pub fn choice<T: Copy>(&self, what: &str, choices: &[(&str, T)]) -> Result<T, SceneError> {
        let given = self.string()?;
        choices.iter().find(|(name, _)| *name == given).map(|(_, choice)| *choice).ok_or_else(|| {
            let names: Vec<&str> = choices.iter().map(|(name, _)| *name).collect();
            let hint = nearest(given, names.iter().copied()).map(|name| format!(" (did you mean \"{name}\"?)"));
            self.wrong(&format!("unknown {what}{}; known: {}", hint.unwrap_or_default(), names.join(", ")))
        })
    }

    /// A finite quantity; SI.
    pub fn quantity(&self, dimension: Dimension) -> Result<f64, SceneError> {
        let needed = format!("{} is needed, such as {} ({})", dimension.name(), dimension.example(), dimension.units());
        let text = match self.value.get_ref() {
            DeValue::String(text) => text,
            DeValue::Integer(_) | DeValue::Float(_) => {
                return Err(self.wrong(&format!("the unit is missing; {needed}")));
            }
            other => return Err(self.wrong(&format!("is {}; {needed}", kind(other)))),
        };
        match parse(text, dimension) {
            Ok(value) if value.is_finite() => Ok(value),
            Ok(_) => Err(self.wrong(&format!("is not finite; {needed}"))),
            Err(QuantityError::NoNumber) => Err(self.wrong(&format!("does not begin with a number; {needed}"))),
            Err(QuantityError::NoUnit) => Err(self.wrong(&format!("the unit is missing; {needed}"))),
            Err(QuantityError::OtherDimension(other)) => {
                Err(self.wrong(&format!("the unit is that of {}; {needed}", other.name())))
            }
            Err(QuantityError::UnknownUnit(unit)) => {
                Err(self.wrong(&format!("unknown unit `{}`; {needed}", shortened(&unit))))
            }
        }
    }

    /// A positive quantity; SI.
    pub fn positive(&self, dimension: Dimension) -> Result<f64, SceneError> {
        match self.quantity(dimension)? {
            value if value > 0.0 => Ok(value),
            _ => Err(self.wrong("has to be greater than 0")),
        }
    }

    /// A quantity that may be 0, and is then allowed to have no unit; SI.
    pub fn not_negative(&self, dimension: Dimension) -> Result<f64, SceneError> {
        if self.number() == Ok(0.0) {
            return Ok(0.0);
        }
        match self.quantity(dimension)? {
            value if value >= 0.0 => Ok(value),
            _ => Err(self.wrong("must not be negative")),
        }
    }
}

/// What a value is, in messages.
fn kind(value: &DeValue<'_>) -> String {
    match value.type_str() {
        "integer" => "an integer".to_owned(),
        "array" => "an array".to_owned(),
        other => format!("a {other}"),
    }
}

/// The known name that a misspelt one most likely means; none where it is too long to mean any.
pub fn nearest<'n>(given: &str, known: impl Iterator<Item = &'n str>) -> Option<&'n str> {
    if given.len() > LONGEST_NAME {
        return None;
    }
    known
        .map(|name| (strsim::jaro_winkler(given, name), name))
        .filter(|(similarity, _)| *similarity > 0.75)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, name)| name)
}
