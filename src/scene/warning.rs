//! Warnings of a scene, and the places where its results are read off.

/// A limit that is exceeded.
#[derive(Clone, Debug, PartialEq)]
pub struct Warning {
    /// The number and the limit.
    pub finding: String,
    /// Reason for the limit, and its source.
    pub reason: String,
    /// What to change of the scene.
    pub change: String,
}

impl Warning {
    pub(crate) fn new(finding: String, reason: impl Into<String>, change: impl Into<String>) -> Self {
        Self { finding, reason: reason.into(), change: change.into() }
    }

    /// The reason, and what to change.
    pub fn explanation(&self) -> String {
        format!("{}; {}", self.reason, self.change)
    }
}

/// Advice where the units of some keys may be wrong.
pub(super) fn units(keys: &[&str]) -> String {
    format!("check the units of {}", keys.join(", "))
}

/// The findings of warnings, a line each.
pub fn findings(warnings: &[Warning]) -> String {
    warnings.iter().map(|warning| warning.finding.as_str()).collect::<Vec<&str>>().join("\n")
}

/// Features of a scene's curves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WhatIsRead {
    /// The pull-off.
    PullOff,
    /// The largest stiffness.
    StiffestPoint,
    /// The turn of surfaces that are pulled back: all that follows depends on it.
    Turn,
    /// The fractions at the smallest separation, where nothing pulls.
    Nearest,
}

/// A place where something is read off, by the integral.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reading {
    /// The feature.
    pub what: WhatIsRead,
    /// Separation h of the place, m.
    pub separation: f64,
    /// Expected fraction of the nominal area in contact there.
    pub share_in_contact: f64,
    /// Expected fraction of the adhesion force there that contacts carry which have yielded.
    pub flowed_adhesion: f64,
    /// Expected fraction of the adhesion force there of asperities that do not touch.
    pub untouched_adhesion: f64,
    /// The fraction of it that is missed: no separation of the scene has a force that large.
    pub missed: f64,
}

/// Expectations by the integral of a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Expected {
    /// Places where results are read off.
    pub readings: Vec<Reading>,
    /// Whether contacts yield before the surfaces turn back, so that the pull-off depends on the plastic contact.
    pub yields: bool,
    /// The bound of the integral's relative error.
    pub error: f64,
    /// Pull-off on approach, and pull-off of surfaces that have touched, N, where the law has another one for
    /// them.
    pub held: Option<[f64; 2]>,
}

impl WhatIsRead {
    /// Place of the feature, in words.
    pub(super) fn place(self) -> &'static str {
        match self {
            Self::PullOff => "at pull-off",
            Self::StiffestPoint => "at the stiffest point",
            Self::Turn => "where the surfaces turn back",
            Self::Nearest => "at the smallest separation",
        }
    }

    /// Name of the feature.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::PullOff => "pull-off",
            Self::StiffestPoint => "peak stiffness",
            Self::Turn | Self::Nearest => "curve",
        }
    }
}
