//! Errors of a scene; problems in several places are reported together.

use thiserror::Error;

/// Most problems of a scene that are reported.
const MOST_PROBLEMS: usize = 20;

/// One thing that is wrong with a scene.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error("{}{text}", line.map(|line| format!("line {line}: ")).unwrap_or_default())]
pub struct Problem {
    /// Line of the scene, from 1; `None` for what no line shows.
    pub line: Option<usize>,
    /// The problem: key, what was given, what would do.
    pub text: String,
    /// The dotted name of a key that is missing, or was most likely meant by an unknown one.
    key: Option<String>,
}

/// Errors of a scene: at least one problem, a line each, in the order of the lines; what no line
/// shows comes last.
///
/// # Examples
/// ```
/// use stiction::Scene;
/// use stiction::scene::{Problem, SceneError};
///
/// let text = std::fs::read_to_string("configs/quick.toml").unwrap();
/// let refused: SceneError = Scene::parse(&text.replace("hardness", "hardnes")).unwrap_err();
/// let Problem { line, text, .. } = &refused.problems[0];
/// assert_eq!(*line, Some(7));
/// assert!(text.contains("hardness"), "{text}");
/// ```
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error("{}", problems.iter().map(ToString::to_string).collect::<Vec<String>>().join("\n"))]
pub struct SceneError {
    /// The problems.
    pub problems: Vec<Problem>,
}

impl SceneError {
    /// A problem that no single line shows.
    pub fn general(problem: impl Into<String>) -> Self {
        Self { problems: vec![Problem { line: None, text: problem.into(), key: None }] }
    }

    /// A problem of a line.
    pub(super) fn at(line: Option<usize>, text: String) -> Self {
        Self { problems: vec![Problem { line, text, key: None }] }
    }

    /// A problem that another key than the one that is there would mend.
    pub(super) fn for_want_of(line: Option<usize>, text: String, key: String) -> Self {
        Self { problems: vec![Problem { line, text, key: Some(key) }] }
    }

    /// Several problems, each reported once.
    fn several(mut problems: Vec<Problem>) -> Self {
        problems.sort_by_key(|problem| problem.line.unwrap_or(usize::MAX));
        let mut seen = std::collections::BTreeSet::new();
        problems.retain(|problem| seen.insert(problem.to_string()));
        Self { problems }
    }

    /// The problems that are reported; a key that is missing where a misspelt one is given is no problem of
    /// its own.
    pub(super) fn shortened(mut self) -> Self {
        let is_misspelt = |key: &Option<String>| {
            key.is_some() && self.problems.iter().any(|problem| problem.line.is_some() && problem.key == *key)
        };
        let is_specific = |problem: &&Problem| problem.line.is_some() || !is_misspelt(&problem.key);
        let mut problems: Vec<Problem> = self.problems.iter().filter(is_specific).cloned().collect();
        if problems.len() > MOST_PROBLEMS {
            problems.truncate(MOST_PROBLEMS);
            problems.extend(Self::general("[...] there are more problems").problems);
        }
        self.problems = problems;
        self
    }
}

/// Readings that do not depend on each other: what all have given, or the problems of all.
pub(super) trait Together {
    /// The values together.
    type All;

    /// All of them.
    fn together(self) -> Result<Self::All, SceneError>;
}

macro_rules! together {
    ($($kind:ident $value:ident),+) => {
        impl<$($kind),+> Together for ($(Result<$kind, SceneError>,)+) {
            type All = ($($kind,)+);

            fn together(self) -> Result<Self::All, SceneError> {
                let ($($value,)+) = self;
                let mut problems = Vec::new();
                $(let $value = $value.map_err(|error: SceneError| problems.extend(error.problems)).ok();)+
                match ($($value,)+) {
                    ($(Some($value),)+) => Ok(($($value,)+)),
                    _ => Err(SceneError::several(problems)),
                }
            }
        }
    };
}

together!(A a, B b);
together!(A a, B b, C c);
together!(A a, B b, C c, D d);
together!(A a, B b, C c, D d, E e);
together!(A a, B b, C c, D d, E e, F f);
together!(A a, B b, C c, D d, E e, F f, G g);
together!(A a, B b, C c, D d, E e, F f, G g, H h);
together!(A a, B b, C c, D d, E e, F f, G g, H h, I i);
together!(A a, B b, C c, D d, E e, F f, G g, H h, I i, J j);

/// Any number of readings, as [`Together`].
pub(super) fn all<T>(readings: impl Iterator<Item = Result<T, SceneError>>) -> Result<Vec<T>, SceneError> {
    let (mut values, mut problems) = (Vec::new(), Vec::new());
    for reading in readings {
        match reading {
            Ok(value) => values.push(value),
            Err(error) => problems.extend(error.problems),
        }
        // To look up the line of each takes time.
        if problems.len() > MOST_PROBLEMS {
            break;
        }
    }
    if problems.is_empty() { Ok(values) } else { Err(SceneError::several(problems)) }
}
