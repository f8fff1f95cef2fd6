//! The layouts of result files: every dataset's name, dimensions, units and meaning, and the version of the
//! whole.
//!
//! Every group has its own copy of the scales of the dimensions that its datasets have: netCDF-4 readers
//! hand the dimensions of the root down to all groups.
//!
//! Others script against these names. They may be added to (a minor version step); changing one is a major
//! version step.

mod asperities;
mod curves;

pub use asperities::ASPERITIES;
pub(crate) use curves::{
    OF_ENSEMBLE, OF_INTEGRAL, Statistic, features, forces, joint_test, quantile, quantities, regimes,
    scalars, scores,
};

use std::sync::LazyLock;

/// A kind of file.
///
/// # Examples
/// ```
/// use stiction::layouts::{LAYOUTS, RUN};
/// use stiction::output::Layout;
///
/// let run: &Layout = &RUN;
/// assert_eq!(run.command, "stiction run");
/// assert!(run.variables.iter().any(|variable| variable.path == "/ensemble/adhesion_force_mean"));
/// assert_eq!(LAYOUTS.len(), 3);
/// ```
#[derive(Debug)]
pub struct Layout {
    /// Value of the root attribute `format`.
    pub format: &'static str,
    /// The command that makes it.
    pub command: &'static str,
    /// Value of the root attribute `format_version`: major, minor. A file of another major version is not
    /// read.
    pub version: [u32; 2],
    /// The groups.
    pub groups: &'static [&'static str],
    /// Groups that some of its files have.
    pub optional_groups: &'static [&'static str],
    /// All datasets that a file may hold, group by group, but for datasets of points.
    pub variables: LazyLock<Vec<Variable>>,
    /// The layout of a file of each point, for a file of points: it may hold the datasets of that too, led by
    /// the dimensions of the points ([`Dimension::of_points`]).
    pub of_points: Option<&'static Layout>,
}

impl Layout {
    /// All datasets that a file may hold, datasets of points included.
    pub fn known(&'static self) -> impl Iterator<Item = &'static Variable> {
        let of_points: &[Variable] = self.of_points.map_or(&[], |layout| &layout.variables);
        self.variables.iter().chain(of_points)
    }

    /// The entry of a path.
    ///
    /// # Panics
    /// When the layout has no such dataset, which is an error in this program.
    pub fn variable(&'static self, path: &str) -> &'static Variable {
        let found = self.known().find(|variable| variable.path == path);
        found.unwrap_or_else(|| panic!("no dataset {path} in the layout"))
    }

    /// The copy of a coordinate, a scale or what accompanies one, in the first group that may have it.
    ///
    /// # Panics
    /// When the layout has no such coordinate, which is an error in this program.
    pub fn coordinate(&'static self, name: &str) -> &'static str {
        let found = self.coordinates(name).next();
        found.unwrap_or_else(|| panic!("no coordinate {name} in the layout"))
    }

    /// All copies of a coordinate.
    pub fn coordinates(&'static self, name: &str) -> impl Iterator<Item = &'static str> {
        let own = self.known().filter(move |variable| variable.is_coordinate() && variable.name() == name);
        own.map(|variable| variable.path.as_str())
    }
}

/// A dimension, which is also the name of the datasets that scale it.
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
    /// Stiffnesses, by index: the stiffness of the half-space under a patch is one of every point.
    StiffnessIndex,
    /// Sizes of avalanches, by the smallest of a class.
    AvalancheSize,
    /// Energies that are lost at a separation, by the least of a class.
    EnergyClass,
    /// Targets at which a run ends.
    Target,
    /// Columns of a map, by the middle of their pixels, m.
    MapX,
    /// Rows of a map, by the middle of their pixels, m.
    MapY,
    /// Cut-off wavelengths of the filter of a map, m.
    Cutoff,
    /// Asperities of a surface.
    Asperity,
    /// States in which the asperities are recorded one by one.
    State,
    /// Steps between neighbouring separations, m.
    Step,
    /// Stiffnesses of what holds the surfaces, N/m.
    Stiffness,
    /// External forces at which the surfaces turn back, N.
    Preload,
    /// Probabilities of quantiles.
    Quantile,
    /// Probabilities of quantiles of the pull-off force.
    PullOffQuantile,
    /// Plastic contacts of asperities.
    PlasticContact,
}

impl Dimension {
    /// The name of the dimension and of its scale.
    pub fn name(self) -> &'static str {
        self.scale().0
    }

    /// Name, units and meaning of the scale.
    fn scale(self) -> (&'static str, &'static str, &'static str) {
        match self {
            Self::Separation => ("separation", "m", "separation h of the mean planes of the surfaces"),
            Self::Regime => ("regime", "1", "regime of an asperity"),
            Self::Replica => ("replica", "1", "index of the replica"),
            Self::Component => ("component", "1", "functional of the joint test"),
            Self::Scalar => ("scalar", "1", "number that is read off a replica's own curve"),
            Self::Control => {
                ("control", "m", "separation h at which the external force is a control variate")
            }
            Self::Phase => ("phase", "1", "phase of the run"),
            Self::SkipReason => ("skip_reason", "1", "why an asperity needed no solve"),
            Self::FittedForce => ("fitted_force", "1", "force that has a curve fit"),
            Self::Coefficient => ("coefficient", "1", "coefficient of the curve fits"),
            Self::RangeEnd => ("range_end", "1", "end of a range"),
            Self::Point => ("point", "1", "index of the point"),
            Self::SeparationIndex => ("separation_index", "1", "index of the separation"),
            Self::ControlIndex => ("control_index", "1", "index of the control variate"),
            Self::StiffnessIndex => ("stiffness_index", "1", "index of the stiffness"),
            Self::AvalancheSize => {
                ("avalanche_size", "1", "asperities in an avalanche at least, and fewer than twice as many")
            }
            Self::EnergyClass => (
                "energy_class",
                "1",
                "least energy of a class, over energy_unit; the class reaches to twice that",
            ),
            Self::Target => ("target", "1", "quantity with a target for its mean"),
            Self::MapX => ("x", "m", "middle of the pixels along the rows of the map"),
            Self::MapY => ("y", "m", "middle of the pixels along the columns of the map"),
            Self::Cutoff => ("cutoff", "m", "cut-off wavelength of the filter of the map"),
            Self::Asperity => ("asperity", "1", "index of the asperity; of a map row by row"),
            Self::State => ("state", "1", "index of a state with its asperities one by one"),
            Self::Step => ("step", "m", "middle between neighbouring separations h"),
            Self::Stiffness => {
                ("stiffness", "N m-1", "stiffness of what holds the surface, 0 for load control")
            }
            Self::Preload => (
                "preload",
                "N",
                "external force at which the surface turns back, NaN for the smallest separation",
            ),
            Self::Quantile => ("quantile", "1", "probability of a quantile"),
            Self::PullOffQuantile => {
                ("pull_off_quantile", "1", "probability of a quantile of the pull-off force")
            }
            Self::PlasticContact => ("plastic_contact", "1", "plastic contact of the asperities"),
        }
    }

    /// The dimension of a file of points for one of a run: an index, if its values may differ from point to
    /// point.
    pub fn of_points(self) -> Self {
        match self {
            Self::Separation => Self::SeparationIndex,
            Self::Control => Self::ControlIndex,
            Self::Stiffness => Self::StiffnessIndex,
            other => other,
        }
    }
}

/// A dataset.
#[derive(Clone, Debug)]
pub struct Variable {
    /// The path.
    pub path: String,
    /// The dimensions, slowest first; none for a scalar.
    pub dimensions: Vec<Dimension>,
    /// The unit, `1` for a pure number; SI. None where rows have units of their own.
    pub units: Option<&'static str>,
    /// The meaning, in words.
    pub long_name: String,
    /// Datasets of its group that belong to its dimensions besides the scales.
    pub coordinates: Vec<&'static str>,
}

impl Variable {
    /// The path of its group; empty for the root.
    pub fn group(&self) -> &str {
        self.path.rsplit_once('/').map_or("", |(group, _)| group)
    }

    /// The name in the group.
    pub fn name(&self) -> &str {
        self.path.rsplit_once('/').map_or(&self.path, |(_, name)| name)
    }

    /// The dimension that it is the scale of, if it is one.
    pub fn scales(&self) -> Option<Dimension> {
        match self.dimensions[..] {
            [dimension] if self.name() == dimension.name() => Some(dimension),
            _ => None,
        }
    }

    /// Whether it is a scale or accompanies one.
    pub fn is_coordinate(&self) -> bool {
        self.scales().is_some()
            || self.dimensions == S && BESIDE_SEPARATION.iter().any(|own| self.name() == own.name)
    }
}

/// The name of the dimension of a sweep's key, which programs can take as a name: it has no dot.
pub fn name_of_key(key: &str) -> String {
    key.replace('.', "_")
}

/// The ends of a range, the names of [`Dimension::RangeEnd`].
pub const RANGE_ENDS: [&str; 2] = ["from", "to"];

/// Name, units and meaning of what every group has besides the scale of the separations.
static BESIDE_SEPARATION: [Row; 2] = [
    row("h_star", S, "1", "separation h over the standard deviation of the surface heights"),
    row("asperity_separation", S, "m", "separation d = h - y_s of flat and asperity mean plane"),
];

pub(crate) const NONE: &[Dimension] = &[];
const S: &[Dimension] = &[Dimension::Separation];
const N: &[Dimension] = &[Dimension::Replica];

/// A dataset of a group.
pub(crate) struct Row {
    name: &'static str,
    dimensions: &'static [Dimension],
    /// Units; such as end with `_units` name the dataset that lists the units of each row.
    units: &'static str,
    long_name: &'static str,
}

/// A dataset of a group: its name, dimensions, units and meaning.
pub(crate) const fn row(
    name: &'static str,
    dimensions: &'static [Dimension],
    units: &'static str,
    long_name: &'static str,
) -> Row {
    Row { name, dimensions, units, long_name }
}

/// The datasets of a group, their dimensions led by others.
pub(crate) fn group(group: &str, lead: &[Dimension], rows: &[Row]) -> Vec<Variable> {
    let own = |Row { name, dimensions, units, long_name }: &Row| {
        variable(format!("{group}/{name}"), &[lead, dimensions].concat(), units, *long_name)
    };
    rows.iter().map(own).collect()
}

/// A dataset by its path.
pub(crate) fn variable(
    path: String,
    dimensions: &[Dimension],
    units: &'static str,
    long_name: impl Into<String>,
) -> Variable {
    let are_listed = units.ends_with("_units");
    let mut variable = Variable {
        path,
        dimensions: dimensions.to_vec(),
        units: Some(units).filter(|_| !are_listed),
        long_name: long_name.into(),
        coordinates: are_listed.then_some(units).into_iter().collect(),
    };
    if dimensions.contains(&Dimension::Separation) && !variable.is_coordinate() {
        variable.coordinates.extend(BESIDE_SEPARATION.iter().map(|own| own.name));
    }
    variable
}

/// The scale of a dimension in a group.
pub(crate) fn scale(group: &str, dimension: Dimension) -> Variable {
    let (name, units, long_name) = dimension.scale();
    variable(format!("{group}/{name}"), &[dimension], units, long_name)
}

/// The datasets, each group of them behind the coordinates of its dimensions.
pub(crate) fn with_coordinates(variables: Vec<Variable>) -> Vec<Variable> {
    let mut all: Vec<Variable> = Vec::new();
    for own in variables.chunk_by(|one, next| one.group() == next.group()) {
        let group = own[0].group();
        for dimension in own.iter().flat_map(|variable| variable.dimensions.iter().copied()) {
            let scale = scale(group, dimension);
            if own.iter().chain(&all).any(|variable| variable.path == scale.path) {
                continue;
            }
            all.push(scale);
            if dimension == Dimension::Separation {
                all.extend(self::group(group, NONE, &BESIDE_SEPARATION));
            }
        }
        all.extend_from_slice(own);
    }
    all
}
