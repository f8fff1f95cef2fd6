//! The layouts of result files: every dataset's name, dimensions, units and meaning, and the version of the
//! whole.
//!
//! Others script against these names. They may be added to (a minor version step); changing one is a major
//! version step.

mod asperities;
mod comparison;
mod finite_size;
mod run;
mod sweep;

pub use asperities::ASPERITIES;
pub use comparison::COMPARISON;
pub use finite_size::FINITE_SIZE;
pub use run::RUN;
pub use sweep::SWEEP;

/// A kind of file.
#[derive(Debug)]
pub struct Layout {
    /// Value of the root attribute `format`.
    pub format: &'static str,
    /// The command that makes it.
    pub command: &'static str,
    /// Value of the root attribute `format_version`: major, minor. A file of another major version is not
    /// read.
    pub version: [u32; 2],
    /// Its groups.
    pub groups: &'static [&'static str],
    /// Groups that some of its files have.
    pub optional_groups: &'static [&'static str],
    /// All datasets that a file may hold, but for those of points.
    pub variables: &'static [Variable],
    /// The layout of a file of each point, for a file of points: it may hold the datasets of that too, led by
    /// the dimensions of the points ([`Dimension::of_points`]).
    pub of_points: Option<&'static Layout>,
}

impl Layout {
    /// All kinds of files.
    pub const ALL: [&'static Self; 5] = [&RUN, &COMPARISON, &SWEEP, &ASPERITIES, &FINITE_SIZE];

    /// All datasets that a file may hold, those of points included.
    pub fn known(&self) -> impl Iterator<Item = &'static Variable> {
        self.variables.iter().chain(self.of_points.map_or(&[][..], |layout| layout.variables))
    }

    /// The entry of a path.
    ///
    /// # Panics
    /// When the layout has no such dataset, which is an error in this program.
    pub fn variable(&self, path: &str) -> &'static Variable {
        let found = self.known().find(|variable| variable.path == path);
        found.unwrap_or_else(|| panic!("no dataset {path} in the layout"))
    }
}

/// A dimension, which is also the dataset that scales it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dimension {
    /// Separations h of the mean planes of the surfaces, m.
    Separation,
    /// Regimes of the law.
    Regime,
    /// Replicas.
    Replica,
    /// Functionals of the joint test.
    Component,
    /// Numbers that are read off a replica's own curve.
    Scalar,
    /// Separations h of the control variates, m.
    Control,
    /// Phases of a run.
    Phase,
    /// Reasons for which an asperity needed no solve.
    SkipReason,
    /// Laws that are compared.
    Law,
    /// Interferences of one asperity, m.
    Interference,
    /// Forces that have a curve fit.
    FittedForce,
    /// Coefficients of the curve fits.
    Coefficient,
    /// Ends of a range.
    RangeEnd,
    /// Points of a sweep whose keys go together.
    Point,
    /// Separations, by index: every point may have its own.
    SeparationIndex,
    /// Control variates, by index: every point may have its own.
    ControlIndex,
    /// Targets at which a run ends.
    Target,
    /// Asperities of a measured surface.
    Asperity,
    /// Steps between neighbouring separations, m.
    Step,
    /// Stiffnesses of what holds the surfaces, N/m.
    Stiffness,
    /// External forces at which the surfaces turn back, N.
    Preload,
    /// Numbers of asperities.
    AsperityCount,
    /// Probabilities of quantiles.
    Quantile,
    /// Relative accuracies.
    Accuracy,
}

impl Dimension {
    /// Its name, and that of its scale.
    pub fn name(self) -> &'static str {
        match self {
            Self::Separation => "separation",
            Self::Regime => "regime",
            Self::Replica => "replica",
            Self::Component => "component",
            Self::Scalar => "scalar",
            Self::Control => "control",
            Self::Phase => "phase",
            Self::SkipReason => "skip_reason",
            Self::Law => "law",
            Self::Interference => "interference",
            Self::FittedForce => "fitted_force",
            Self::Coefficient => "coefficient",
            Self::RangeEnd => "range_end",
            Self::Point => "point",
            Self::SeparationIndex => "separation_index",
            Self::ControlIndex => "control_index",
            Self::Target => "target",
            Self::Asperity => "asperity",
            Self::Step => "step",
            Self::Stiffness => "stiffness",
            Self::Preload => "preload",
            Self::AsperityCount => "asperity_count",
            Self::Quantile => "quantile",
            Self::Accuracy => "accuracy",
        }
    }

    /// What the dimension of one run is in a file of points: an index, if its values may differ from point to
    /// point.
    pub fn of_points(self) -> Self {
        match self {
            Self::Separation => Self::SeparationIndex,
            Self::Control => Self::ControlIndex,
            other => other,
        }
    }
}

/// A dataset.
#[derive(Clone, Copy, Debug)]
pub struct Variable {
    /// Its path.
    pub path: &'static str,
    /// Its dimensions, slowest first; none for a scalar.
    pub dimensions: &'static [Dimension],
    /// Its unit, `1` for a pure number; SI.
    pub units: &'static str,
    /// What it is.
    pub long_name: &'static str,
}

impl Variable {
    /// The dimension that it is the scale of, if it is one.
    pub fn scales(&self) -> Option<Dimension> {
        match self.dimensions {
            [dimension] if self.path.strip_prefix('/') == Some(dimension.name()) => Some(*dimension),
            _ => None,
        }
    }
}

/// The ends of a range, the names of [`Dimension::RangeEnd`].
pub const RANGE_ENDS: [&str; 2] = ["from", "to"];

const NONE: &[Dimension] = &[];
const S: &[Dimension] = &[Dimension::Separation];
const N: &[Dimension] = &[Dimension::Replica];

const fn variable(
    path: &'static str,
    dimensions: &'static [Dimension],
    units: &'static str,
    long_name: &'static str,
) -> Variable {
    Variable { path, dimensions, units, long_name }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_are_unique_and_every_dimension_has_its_scale() {
        for layout in Layout::ALL {
            for variable in layout.variables {
                let same = layout.known().filter(|other| other.path == variable.path);
                assert_eq!(same.count(), 1, "{}", variable.path);
                for dimension in variable.dimensions {
                    let scale = layout.variable(&format!("/{}", dimension.name()));
                    assert_eq!(scale.dimensions, [*dimension]);
                }
                let group = variable.path[1..].split_once('/').map(|(group, _)| group);
                assert!(
                    group.is_none_or(|group| layout
                        .groups
                        .iter()
                        .chain(layout.optional_groups)
                        .any(|known| *known == group)),
                    "{}",
                    variable.path
                );
            }
        }
    }

    #[test]
    fn the_format_pages_describe_every_dataset() {
        let pages = [
            include_str!("../../../docs/format.md"),
            include_str!("../../../docs/comparison.md"),
            include_str!("../../../docs/sweep-format.md"),
            include_str!("../../../docs/asperity-file.md"),
            include_str!("../../../docs/finite-size.md"),
        ];
        for (layout, page) in Layout::ALL.into_iter().zip(pages) {
            assert!(page.contains(&format!("`{}`", layout.format)));
            assert!(page.contains(&format!("version {}.{}", layout.version[0], layout.version[1])));
            for variable in layout.variables {
                let (group, name) = variable.path.rsplit_once('/').expect("paths begin with a slash");
                let row = page.lines().find(|line| {
                    line.starts_with(&format!("| `{name}` |")) && line.contains(variable.long_name)
                });
                assert!(row.is_some(), "the page lacks {group}/{name}: {}", variable.long_name);
            }
        }
    }
}
