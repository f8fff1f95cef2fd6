//! Reasons why a call has no reply, as the page shows them.

use crate::error::Error;
use crate::scene::{KEYS, Problem, SceneError};
use serde_json::{Value, json};

/// A reason why a call has no reply.
#[derive(Debug)]
pub(super) struct Failure {
    problems: Vec<Problem>,
}

impl Failure {
    /// A reason in words.
    pub fn new(text: impl Into<String>) -> Self {
        SceneError::general(text).into()
    }

    /// The problems, each with the line and the key that it is about.
    pub fn problems(&self) -> Vec<Value> {
        let shown =
            |Problem { line, text, .. }: &Problem| json!({ "line": line, "key": key(text), "text": text });
        self.problems.iter().map(shown).collect()
    }

    /// The reply.
    pub fn reply(&self) -> Value {
        let texts: Vec<String> = self.problems.iter().map(ToString::to_string).collect();
        json!({ "error": { "text": texts.join("\n"), "problems": self.problems() } })
    }
}

/// The first key that a message names, with or without its value.
fn key(text: &str) -> Option<&'static str> {
    let mut named = text.split('`').skip(1).step_by(2).filter_map(|name| name.split(" = ").next());
    named.find_map(|name| KEYS.iter().find(|key| key.name == name)).map(|key| key.name)
}

impl From<SceneError> for Failure {
    fn from(SceneError { problems }: SceneError) -> Self {
        Self { problems }
    }
}

impl From<Error> for Failure {
    fn from(error: Error) -> Self {
        match error {
            Error::Scene { error, .. } => error.into(),
            other => Self::new(other.to_string()),
        }
    }
}

impl From<serde_json::Error> for Failure {
    fn from(error: serde_json::Error) -> Self {
        Self::new(format!("the call is not understood: {error}"))
    }
}
