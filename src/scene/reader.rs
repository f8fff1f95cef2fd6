//! Reading TOML with errors that name the key, its line, what was given and what would do.

use super::echo::{one_line, shortened};
use super::error::{SceneError, all};
use super::keys::{Key, Sign, Value};
use super::lookup::{Keys, former_value, nearest};
use super::units::{Dimension, QuantityError, parse, percentage, whole};
use std::ops::{Bound, RangeBounds};
use std::sync::LazyLock;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// Most words of a value that an error repeats.
const SHOWN_WORDS: usize = 60;

/// A table without keys.
static EMPTY: LazyLock<DeTable<'static>> = LazyLock::new(DeTable::default);

/// Parses the document.
pub(super) fn document(text: &str) -> Result<Spanned<DeTable<'_>>, SceneError> {
    DeTable::parse(text).map_err(|error| {
        let line = error.span().map(|span| line_of(text, span.start));
        let given =
            line.and_then(|line| text.lines().nth(line - 1)?.split('#').next()).unwrap_or_default().trim();
        if given.split_once('=').is_some_and(|(_, value)| has_decimal_comma(value)) {
            let given = shortened(given);
            return SceneError::at(
                line,
                format!("not TOML: `{given}` has a decimal comma; a point is needed"),
            );
        }
        // As in a path of Windows.
        let is_of_escape = ["escape", "unicode"].iter().any(|word| error.message().contains(word));
        if is_of_escape && given.contains('\\') {
            return SceneError::at(line, format!("not TOML: `{}`: {BACKSLASH}", shortened(given)));
        }
        SceneError::at(line, format!("not TOML: {}", one_line(error.message())))
    })
}

/// The reason why a path of Windows is none, and what would do.
const BACKSLASH: &str = "within \"double quotes\" a backslash begins another character; write / for it, or 'single quotes' around the path";

/// Whether a text begins with a number that has a decimal comma.
fn has_decimal_comma(text: &str) -> bool {
    parse(text, Dimension::Length) == Err(QuantityError::DecimalComma)
}

fn line_of(text: &str, offset: usize) -> usize {
    1 + text.as_bytes()[..offset.min(text.len())].iter().filter(|&&byte| byte == b'\n').count()
}

/// A table of the scene, with its dotted name.
#[derive(Clone, Copy)]
pub(crate) struct Section<'a> {
    text: &'a str,
    name: &'a str,
    table: &'a DeTable<'a>,
    keys: &'a Keys,
}

/// A value with its dotted name.
#[derive(Clone)]
pub(crate) struct Entry<'a> {
    text: &'a str,
    pub name: String,
    pub value: &'a Spanned<DeValue<'a>>,
    keys: &'a Keys,
}

impl<'a> Section<'a> {
    /// The root of a scene of such keys.
    pub fn root(text: &'a str, table: &'a DeTable<'a>, keys: &'a Keys) -> Self {
        Self { text, name: "", table, keys }
    }

    /// The table `name`; an absent one is an error if `required`.
    pub fn section(&self, name: &'a str, required: bool) -> Result<Option<Self>, SceneError> {
        match self.get(name) {
            None if required => {
                let keys = self.keys.of_table(name).collect::<Vec<&str>>().join(", ");
                let problem = format!("the table [{name}] is missing; its keys: {keys}");
                Err(SceneError::for_want_of(None, problem, name.to_owned()))
            }
            None => Ok(None),
            Some(entry) => match entry.value.get_ref() {
                DeValue::Table(table) => Ok(Some(Self { name, table, ..*self })),
                other => Err(entry.wrong(&format!("is {}, a table [{name}] is needed", kind(other)))),
            },
        }
    }

    /// The table `name`, or one without keys where it is absent.
    pub fn section_or_empty(&self, name: &'a str) -> Result<Self, SceneError> {
        let empty = Self { name, table: &EMPTY, ..*self };
        self.section(name, false).map(|section| section.unwrap_or(empty))
    }

    /// Refuses keys that scenes do not know, here and in all tables within but `[sweep]`, which has its own.
    pub fn known(&self) -> Result<(), SceneError> {
        let known = self.keys.of_table(self.name);
        all(self.table.iter().map(|(key, value)| {
            let name = key.get_ref().as_ref();
            if !known.clone().any(|known| known == name) {
                return Err(self.unknown(key, known.clone()));
            }
            if self.name.is_empty() && name == "sweep" {
                return Ok(());
            }
            let within = self.dotted(name);
            let tables: Vec<&DeTable<'_>> = match value.get_ref() {
                DeValue::Table(table) => vec![table],
                DeValue::Array(array) => {
                    array.iter().filter_map(|element| element.get_ref().as_table()).collect()
                }
                _ => Vec::new(),
            };
            // What is no table of scenes is refused where it is read.
            let tables = tables.into_iter().filter(|_| self.keys.of_table(&within).next().is_some());
            all(tables.map(|table| Section { name: &within, table, ..*self }.known())).map(drop)
        }))
        .map(drop)
    }

    fn unknown(
        &self,
        key: &Spanned<std::borrow::Cow<'_, str>>,
        known: impl Iterator<Item = &'static str> + Clone,
    ) -> SceneError {
        let given = key.get_ref();
        let line = Some(line_of(self.text, key.span().start));
        if let Some(new) = self.keys.renamed(self.name, given) {
            let (old, key) = (self.dotted(given), new.name.rsplit('.').next().unwrap_or(new.name));
            let problem = format!("`{old}` is now `{}`; for example {key} = {}", new.name, new.example);
            return SceneError::for_want_of(line, problem, new.name.to_owned());
        }
        let own = |name: &str| {
            name.strip_prefix(self.name).and_then(|key| key.strip_prefix('.')).map(str::to_owned)
        };
        let meant = self.keys.meant(given).map(|(name, note)| (name.to_owned(), note));
        let meant = meant.or_else(|| nearest(given, known.clone()).map(|name| (self.dotted(name), "")));
        let hint = meant.as_ref().map(|(name, note)| {
            format!("did you mean `{}`{note}? ", own(name).unwrap_or_else(|| name.clone()))
        });
        let (name, known) = (self.dotted(&shortened(given)), known.collect::<Vec<&str>>().join(", "));
        let problem = format!("unknown key `{name}`; {}known here: {known}", hint.unwrap_or_default());
        match meant {
            Some((meant, _)) => SceneError::for_want_of(line, problem, meant),
            None => SceneError::at(line, problem),
        }
    }

    fn dotted(&self, key: &str) -> String {
        if self.name.is_empty() { key.to_owned() } else { format!("{}.{key}", self.name) }
    }

    /// The value of a key, if it is there.
    pub fn get(&self, key: &str) -> Option<Entry<'a>> {
        let value = self.table.get(key)?;
        Some(Entry { text: self.text, name: self.dotted(key), value, keys: self.keys })
    }

    /// The value of a key that has a default, or that default, by the table of keys.
    pub fn value(&self, key: &str) -> Entry<'a> {
        self.get(key).unwrap_or_else(|| {
            let name = self.dotted(key);
            let (text, value) = self.keys.default(&name).expect("a key without a default is read otherwise");
            Entry { text, name, value, keys: self.keys }
        })
    }

    /// All keys and their values.
    pub fn entries(&self) -> impl Iterator<Item = (&'a str, Entry<'a>)> {
        let owner = *self;
        owner.table.iter().map(move |(key, value)| {
            let key = key.get_ref().as_ref();
            (key, Entry { text: owner.text, name: owner.dotted(&shortened(key)), value, keys: owner.keys })
        })
    }

    /// The value of a key that has to be there.
    pub fn require(&self, key: &str) -> Result<Entry<'a>, SceneError> {
        self.get(key).ok_or_else(|| {
            let name = self.dotted(key);
            let example = self
                .keys
                .example(&name)
                .map(|example| format!("; for example {key} = {example}"))
                .unwrap_or_default();
            SceneError::for_want_of(None, format!("`{name}` is missing{example}"), name)
        })
    }

    /// The quantity of a key that has to be there; SI.
    pub fn measured(&self, key: &str) -> Result<f64, SceneError> {
        self.require(key)?.measured()
    }

    /// Refuses keys that must not be given with a key of this table, where that is given, by the table of keys.
    pub fn excluded(&self, key: &str, problem: &str) -> Result<(), SceneError> {
        if self.get(key).is_none() {
            return Ok(());
        }
        let excluded = self.keys.find(&self.dotted(key)).map_or(&[][..], |key| key.excluded);
        let keys = excluded.iter().filter_map(|name| name.strip_prefix(self.name)?.strip_prefix('.'));
        let others = keys.filter_map(|key| self.get(key));
        all(others.map(|other| Err::<(), _>(other.wrong(problem)))).map(drop)
    }

    /// The example of a key of this table.
    pub fn example(&self, key: &str) -> &'static str {
        self.keys.example(&self.dotted(key)).unwrap_or_default()
    }

    /// Reads a key by `read`, if it is there.
    pub fn optional<T>(
        &self,
        key: &str,
        read: impl FnOnce(&Entry<'a>) -> Result<T, SceneError>,
    ) -> Result<Option<T>, SceneError> {
        self.get(key).map(|entry| read(&entry)).transpose()
    }
}

impl<'a> Entry<'a> {
    /// An error about this value: `problem` follows the key and what was given.
    pub fn wrong(&self, problem: &str) -> SceneError {
        let span = self.value.span();
        let given = self.text.get(span.clone()).unwrap_or_default();
        let given = given.split_whitespace().take(SHOWN_WORDS).collect::<Vec<_>>().join(" ");
        let line = Some(line_of(self.text, span.start));
        SceneError::at(line, format!("`{} = {}`: {problem}", self.name, shortened(&given)))
    }

    /// An element of this array.
    pub fn element(&self, index: usize, value: &'a Spanned<DeValue<'a>>) -> Self {
        Self { name: format!("{}[{index}]", self.name), value, ..*self }
    }

    /// This inline table as a section.
    pub fn table(&'a self) -> Result<Section<'a>, SceneError> {
        match self.value.get_ref() {
            DeValue::Table(table) => {
                Ok(Section { text: self.text, name: &self.name, table, keys: self.keys })
            }
            other => {
                let keys = self.keys.of_table(&self.name).collect::<Vec<&str>>().join(", ");
                Err(self.wrong(&format!("is {}, a table with {keys} is needed", kind(other))))
            }
        }
    }

    /// This table as a section without a name, which may have any keys; `about` says which make sense.
    pub fn any_table(&self, about: &str) -> Result<Section<'a>, SceneError> {
        match self.value.get_ref() {
            DeValue::Table(table) => Ok(Section { text: self.text, name: "", table, keys: self.keys }),
            other => Err(self.wrong(&format!("is {}, a table is needed; {about}", kind(other)))),
        }
    }

    /// A value, or a list of two, one for each body or surface, by `read`.
    pub fn one_or_two(
        &self,
        read: impl Fn(&Self) -> Result<f64, SceneError>,
    ) -> Result<Vec<f64>, SceneError> {
        match self.value.get_ref() {
            DeValue::Array(array) if array.len() == 2 => {
                all(array.iter().enumerate().map(|(i, element)| read(&self.element(i, element))))
            }
            DeValue::Array(_) => Err(self.wrong("one value, or a list of two, one for each body, is needed")),
            _ => read(self).map(|value| vec![value]),
        }
    }

    /// A finite number.
    pub fn number(&self) -> Result<f64, SceneError> {
        let value = match self.value.get_ref() {
            DeValue::Integer(integer) if integer.radix() == 10 => integer.as_str().parse().ok(),
            DeValue::Integer(integer) => {
                u64::from_str_radix(integer.as_str(), integer.radix()).ok().map(|n| n as f64)
            }
            DeValue::Float(float) => float.as_str().parse::<f64>().ok(),
            DeValue::String(text) => percentage(text),
            _ => None,
        };
        match value {
            Some(value) if f64::is_finite(value) => Ok(value),
            Some(_) => Err(self.wrong("a finite number is needed")),
            None if self.value.get_ref().as_str().is_some_and(has_decimal_comma) => {
                Err(self.wrong("has a decimal comma; a point is needed, and no quotation marks"))
            }
            None => Err(self.wrong(&format!("is {}, a number is needed", kind(self.value.get_ref())))),
        }
    }

    /// The number that the table of keys has for this one, or for the elements of a list in its place, within its bounds.
    pub fn bounded(&self) -> Result<f64, SceneError> {
        let row = |name: &str| match self.keys.find(name)? {
            Key { value: Value::Number(low, high), out_of_bounds, .. } => Some((*low, *high, *out_of_bounds)),
            _ => None,
        };
        let of_element = || row(&format!("{}[]", self.name));
        let row = row(&self.name).or_else(of_element);
        let (low, high, message) = row.expect("a number is read where the table has one");
        let number = self.number()?;
        if (low, high).contains(&number) {
            return Ok(number);
        }
        if !message.is_empty() {
            return Err(self.wrong(&message.replace("{}", &number.to_string())));
        }
        let bound = |bound: Bound<f64>, [included, excluded]: [&str; 2]| match bound {
            Bound::Included(limit) => Some(format!("{included} {limit}")),
            Bound::Excluded(limit) => Some(format!("{excluded} {limit}")),
            Bound::Unbounded => None,
        };
        let bounds = [bound(low, ["at least", "greater than"]), bound(high, ["at most", "less than"])];
        let words: Vec<String> = bounds.into_iter().flatten().collect();
        Err(self.wrong(&format!("has to be {}", words.join(" and "))))
    }

    /// A whole number in `range`.
    pub fn integer(&self, range: std::ops::RangeInclusive<u64>) -> Result<u64, SceneError> {
        let value = match self.value.get_ref() {
            DeValue::Integer(integer) => u64::from_str_radix(integer.as_str(), integer.radix()).ok(),
            DeValue::Float(float) => whole(float.as_str()),
            _ => None,
        };
        value.filter(|value| range.contains(value)).ok_or_else(|| {
            self.wrong(&format!("a whole number from {} to {} is needed", range.start(), range.end()))
        })
    }

    /// The example of a key by its dotted name.
    pub fn example_of(&self, name: &str) -> &'static str {
        self.keys.example(name).unwrap_or_default()
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

    /// The path of a file.
    pub fn path(&self) -> Result<&'a str, SceneError> {
        let path = self.string()?;
        let is_path = !path.contains(char::is_control);
        if is_path { Ok(path) } else { Err(self.wrong(&format!("is no path: {BACKSLASH}"))) }
    }

    /// A name out of a closed list.
    pub fn choice<T: Clone>(&self, what: &str, choices: &[(&str, T)]) -> Result<T, SceneError> {
        let given = self.string()?;
        choices.iter().find(|(name, _)| *name == given).map(|(_, choice)| choice.clone()).ok_or_else(|| {
            let names: Vec<&str> = choices.iter().map(|(name, _)| *name).collect();
            let hint = match former_value(given) {
                Some(fate) => Some(format!(", which {fate}")),
                None => {
                    nearest(given, names.iter().copied()).map(|name| format!(" (did you mean \"{name}\"?)"))
                }
            };
            self.wrong(&format!("unknown {what}{}; known: {}", hint.unwrap_or_default(), names.join(", ")))
        })
    }

    /// A finite quantity; SI.
    pub fn quantity(&self, dimension: Dimension) -> Result<f64, SceneError> {
        let such =
            self.keys.example(&self.name).map(|example| format!(", such as {example}")).unwrap_or_default();
        let such = match self.keys.find(&self.name).map(|key| &key.value) {
            Some(Value::OneOrMore(_, _, names)) => {
                names.iter().fold(such, |such, name| format!("{such} or \"{name}\""))
            }
            _ => such,
        };
        let needed = format!("{} is needed{such} ({})", dimension.name(), dimension.units());
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
            Err(QuantityError::NoNumber) => {
                Err(self.wrong(&format!("does not begin with a number; {needed}")))
            }
            Err(QuantityError::DecimalComma) => Err(self.wrong(&format!(
                "has a decimal comma; a point is needed, and nothing between thousands: {needed}"
            ))),
            Err(QuantityError::NoUnit) => Err(self.wrong(&format!("the unit is missing; {needed}"))),
            Err(QuantityError::OtherDimension(other)) => {
                Err(self.wrong(&format!("the unit is that of {}; {needed}", other.name())))
            }
            Err(QuantityError::UnknownUnit(unit)) => {
                let meant =
                    dimension.meant(&unit, text).map(|meant| format!(" ({meant})")).unwrap_or_default();
                Err(self.wrong(&format!("unknown unit `{}`{meant}; {needed}", shortened(&unit))))
            }
        }
    }

    /// The quantity that the table of keys has for this one; SI.
    pub fn measured(&self) -> Result<f64, SceneError> {
        let value = self.keys.find(&self.name).map(|key| &key.value);
        let Some(&(Value::Quantity(dimension, sign) | Value::OneOrMore(dimension, sign, _))) = value else {
            unreachable!("`{}` is read as a quantity", self.name)
        };
        match sign {
            Sign::Any => self.quantity(dimension),
            Sign::NotNegative => self.not_negative(dimension),
            Sign::Positive => self.positive(dimension),
        }
    }

    /// The whole number that the table of keys has for this one.
    pub fn whole(&self) -> Result<u64, SceneError> {
        match self.keys.find(&self.name).map(|key| &key.value) {
            Some(&Value::Whole(least, most)) => self.integer(least..=most),
            _ => unreachable!("`{}` is read as a whole number", self.name),
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
    fn not_negative(&self, dimension: Dimension) -> Result<f64, SceneError> {
        if self.number() == Ok(0.0) {
            return Ok(0.0);
        }
        match self.quantity(dimension)? {
            value if value >= 0.0 => Ok(value),
            _ => Err(self.wrong("must not be negative")),
        }
    }
}

/// The kind of a value, in messages.
fn kind(value: &DeValue<'_>) -> String {
    match value.type_str() {
        "integer" => "an integer".to_owned(),
        "array" => "an array".to_owned(),
        other => format!("a {other}"),
    }
}
