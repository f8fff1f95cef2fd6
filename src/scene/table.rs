//! The table of the keys of scenes: the reader takes units, ranges, examples and exclusions from it, and
//! `docs/scene.md` all of it. It is longer than files should be, since it is one table.

use super::keys::{Absent, Key, Sign, Value, key};
use super::material::POISSON_RATIOS;
use super::units::Dimension as Of;
use super::{FORMAT, HISTORIES, SUM_TOLERANCES, SUMS, population, separation, stopping, sweep};
use crate::asperity::UnloadedRadius;
use crate::asperity::models::MODELS;
use crate::engine::{Estimator, SCALARS};
use crate::surface::{CountLaw, SamplingScheme};
use Absent::{Follows, Is, Required};
use Sign::{Any, NotNegative, Positive};
use Value::{Choice, Number, OneOrMore, Quantity, Switch, Table, Text, Various, Whole};
use std::ops::Bound::{Excluded, Included, Unbounded};

/// Names of a closed list.
fn names<T>(list: &[(&'static str, T)]) -> Vec<&'static str> {
    list.iter().map(|(name, _)| *name).collect()
}

const RANGE: &str = "a list, or a table { from, to, count }";
const FILE_PATH: &str = "Relative to the scene. A CSV file or an HDF5 file.";
const FILE_COLUMN: &str = "For a CSV file. A column by its name, or by its number from 1.";
const FILE_DATASET: &str = "For an HDF5 file. A dataset of one dimension.";
const FILE_UNIT: &str = "The values of the file are multiplied by it.";

/// Every key of a scene by its dotted name, in the order of the reference. `[]` stands for an element of a
/// list, `sweep.*` for a key that is swept.
pub static KEYS: &[Key] = &[
    key("format", "1", Whole(FORMAT, FORMAT), Required, "version of the scene format", ""),
    key("title", "\"Case II\"", Text, Is("\"\""), "name of the scene, for people", "It changes no result."),
    key(
        "material",
        "{ reduced_modulus = \"85.29 GPa\" }",
        Table,
        Required,
        "what the two bodies are made of",
        "",
    ),
    key(
        "material.reduced_modulus",
        "\"85.29 GPa\"",
        Quantity(Of::Pressure, Positive),
        Required,
        "reduced modulus",
        "E_r with 1/E_r = (1 − ν₁²)/E₁ + (1 − ν₂²)/E₂. Give it, or the two bodies by `youngs_modulus` and \
         `poissons_ratio`.",
    )
    .swept()
    .excludes(&["material.youngs_modulus", "material.poissons_ratio"]),
    key(
        "material.youngs_modulus",
        "[\"169 GPa\", \"70 GPa\"]",
        Various("a list of two pressures, each greater than 0"),
        Follows("not used where `reduced_modulus` is given"),
        "Young's moduli E₁ and E₂ of the two bodies",
        "Needs `poissons_ratio`.",
    ),
    key("material.youngs_modulus[]", "\"169 GPa\"", Quantity(Of::Pressure, Positive), Required, "", ""),
    key(
        "material.poissons_ratio",
        "[0.22, 0.27]",
        Various("a list of two numbers, each greater than -1 and at most 0.5"),
        Follows("not used where `reduced_modulus` is given"),
        "Poisson ratios ν₁ and ν₂ of the two bodies",
        "Needs `youngs_modulus`, in the same order. They enter the reduced modulus only.",
    ),
    key("material.poissons_ratio[]", "0.22", Number(POISSON_RATIOS.0, POISSON_RATIOS.1), Required, "", ""),
    key(
        "material.hardness",
        "\"2.5 GPa\"",
        Quantity(Of::Pressure, Positive),
        Required,
        "hardness of the softer body",
        "H sets where plastic flow begins: ω_c = (π k H / 2 E_r)² R.",
    )
    .swept(),
    key(
        "material.poisson_ratio",
        "0.27",
        Number(POISSON_RATIOS.0, POISSON_RATIOS.1),
        Required,
        "Poisson ratio of the softer body",
        "It enters k = 0.454 + 0.41 ν of the elastic-plastic laws only. Beside `poissons_ratio` it has to \
         be one of the two.",
    )
    .swept(),
    key(
        "material.work_of_adhesion",
        "\"0.09 J/m^2\"",
        Quantity(Of::SurfaceEnergy, Positive),
        Required,
        "work of adhesion",
        "Δγ = γ₁ + γ₂ − γ₁₂. Give it, or the energies by `surface_energy` and `interface_energy`.",
    )
    .swept()
    .excludes(&["material.surface_energy", "material.interface_energy"]),
    key(
        "material.surface_energy",
        "[\"50 mJ/m^2\", \"60 mJ/m^2\"]",
        Various("a list of two energies per area, each greater than 0"),
        Follows("not used where `work_of_adhesion` is given"),
        "surface energies γ₁ and γ₂ of the two bodies",
        "Needs `interface_energy`.",
    ),
    key(
        "material.surface_energy[]",
        "\"50 mJ/m^2\"",
        Quantity(Of::SurfaceEnergy, Positive),
        Required,
        "",
        "",
    ),
    key(
        "material.interface_energy",
        "\"20 mJ/m^2\"",
        Quantity(Of::SurfaceEnergy, NotNegative),
        Follows("not used where `work_of_adhesion` is given"),
        "energy γ₁₂ of the interface",
        "Needs `surface_energy`. 0 for two bodies of the same material. It has to be less than γ₁ + γ₂.",
    ),
    key(
        "material.equilibrium_spacing",
        "\"0.2 nm\"",
        Quantity(Of::Length, Positive),
        Required,
        "equilibrium spacing",
        "Z₀, the distance at which the two faces neither attract nor repel each other; 0.15 to 0.4 nm for \
         most solids.",
    )
    .swept(),
    key("surface", "{ asperity_radius = \"3.33 um\" }", Table, Required, "the rough surface", ""),
    key(
        "surface.asperity_radius",
        "\"3.33 um\"",
        Quantity(Of::Length, Positive),
        Required,
        "radius of the asperities",
        "R, the radius of curvature of a top; the mean one where `radii` scatter.",
    )
    .swept(),
    key(
        "surface.asperity_density",
        "\"7.39 /um^2\"",
        Quantity(Of::ArealDensity, Positive),
        Required,
        "asperities per area",
        "η. A replica has N = η A_n asperities.",
    )
    .swept(),
    key(
        "surface.surface_height_std",
        "\"1.619 nm\"",
        Quantity(Of::Length, Positive),
        Follows("from `asperity_height_std`"),
        "standard deviation of the surface heights",
        "σ of all points of the surface, the Rq or Sq of a profilometer. One of σ and σ_s has to be there; \
         the other follows by σ_s² = σ² − 3.717·10⁻⁴/(ηR)².",
    )
    .swept(),
    key(
        "surface.asperity_height_std",
        "\"1.417 nm\"",
        Quantity(Of::Length, Positive),
        Follows("from `surface_height_std`"),
        "standard deviation of the asperity heights",
        "σ_s of the tops only. It is what the tops are drawn with.",
    )
    .swept(),
    key(
        "surface.mean_plane_offset",
        "\"1.867 nm\"",
        Quantity(Of::Length, NotNegative),
        Follows("0.045944/(ηR), that of a Gaussian surface"),
        "asperity mean plane above that of the surface",
        "y_s. Tops are d = h − y_s from the other face. 0 takes h itself as the distance of the tops.",
    )
    .swept(),
    key(
        "surface.nominal_area",
        "\"100 um^2\"",
        Quantity(Of::Area, Positive),
        Required,
        "nominal area",
        "A_n of one replica, a finite patch. Means are proportional to it; the scatter from patch to patch \
         falls as 1/√A_n. Beside `asperities` it may be left out and is then that of the map.",
    )
    .swept(),
    key(
        "surface.lubricant_thickness",
        "\"0.5 nm\"",
        Quantity(Of::Length, NotNegative),
        Is("0"),
        "thickness of the lubricant",
        "t. 0: dry. Dry laws take it as absent.",
    )
    .swept(),
    key(
        "surface.heights",
        "{ law = \"weibull\", shape = 2.0 }",
        Various("the name of a law, or a table with `law` and its parameters"),
        Is("\"gaussian\""),
        "law of the asperity heights",
        "Whatever the law, its standard deviation is σ_s and its mean 0.",
    ),
    key(
        "surface.heights.law",
        "\"weibull\"",
        Choice(|| names(&population::HEIGHT_LAWS)),
        Required,
        "name of the law",
        "",
    ),
    key(
        "surface.heights.shape",
        "1.5",
        Various("a number from 1 to 20 of `weibull`, from 0.01 to 1.5 of `lognormal`"),
        Required,
        "shape of the law of heights",
        "Of `weibull` the exponent, of `lognormal` the standard deviation of the logarithm. Other laws have \
         none.",
    )
    .swept(),
    key(
        "surface.heights.lower",
        "-3.0",
        Number(Unbounded, Unbounded),
        Follows("no limit"),
        "lower limit of truncated heights",
        "Of `truncated`, in standard deviations of the Gaussian that is cut. One of the limits has to be \
         there.",
    )
    .swept(),
    key(
        "surface.heights.upper",
        "1.5",
        Number(Unbounded, Unbounded),
        Follows("no limit"),
        "upper limit of truncated heights",
        "Of `truncated`, in standard deviations of the Gaussian that is cut; a polished surface has lost \
         its highest tops.",
    )
    .swept(),
    key(
        "surface.heights.path",
        "\"heights.csv\"",
        Text,
        Required,
        "file of heights, of the law `file`",
        FILE_PATH,
    ),
    key(
        "surface.heights.column",
        "\"height\"",
        Various("a name, or a number from 1"),
        Required,
        "column of the file",
        FILE_COLUMN,
    )
    .excludes(&["surface.heights.dataset"]),
    key(
        "surface.heights.dataset",
        "\"/asperities/height\"",
        Text,
        Required,
        "dataset of the file",
        FILE_DATASET,
    ),
    key(
        "surface.heights.unit",
        "\"nm\"",
        Various("a unit of length"),
        Required,
        "unit of the file",
        FILE_UNIT,
    ),
    key(
        "surface.radii",
        "{ law = \"gamma\", coefficient_of_variation = 0.5 }",
        Various("the name of a law, or a table with `law` and its parameters"),
        Is("\"common\""),
        "law of the asperity radii",
        "`common`: all have `asperity_radius`. Where radii scatter, each asperity has its own λ. Radius and \
         height are drawn independently.",
    ),
    key(
        "surface.radii.law",
        "\"lognormal\"",
        Choice(|| names(&population::RADIUS_LAWS)),
        Required,
        "name of the law",
        "",
    ),
    key(
        "surface.radii.coefficient_of_variation",
        "0.3",
        Number(Included(*population::VARIATIONS.start()), Included(*population::VARIATIONS.end())),
        Required,
        "coefficient of variation of the radii",
        "Of `lognormal` and `gamma`: standard deviation over mean.",
    )
    .swept(),
    key("surface.radii.path", "\"radii.csv\"", Text, Required, "file of radii, of the law `file`", FILE_PATH)
        .excludes(&["surface.asperity_radius"]),
    key(
        "surface.radii.column",
        "\"radius\"",
        Various("a name, or a number from 1"),
        Required,
        "column of the file",
        FILE_COLUMN,
    )
    .excludes(&["surface.radii.dataset"]),
    key(
        "surface.radii.dataset",
        "\"/asperities/radius\"",
        Text,
        Required,
        "dataset of the file",
        FILE_DATASET,
    ),
    key("surface.radii.unit", "\"um\"", Various("a unit of length"), Required, "unit of the file", FILE_UNIT),
    key(
        "surface.count",
        "\"poisson\"",
        Choice(|| names(&CountLaw::ALL)),
        Is("\"fixed\""),
        "whether every replica has the same number of asperities",
        "`fixed`: N = ηA_n in all of them. `poisson`: N scatters as in patches cut at random from a large \
         surface.",
    ),
    key(
        "surface.summits",
        "\"nayak\"",
        Choice(|| names(&population::SUMMIT_LAWS)),
        Follows("no; heights and radii have their own laws"),
        "heights and radii of the summits of a Gaussian surface",
        "Heights and radii are drawn together, as Nayak's theory has them: higher summits are sharper.",
    )
    .excludes(&["surface.heights", "surface.radii"]),
    key(
        "surface.spectrum",
        "{ m0 = \"2.37 nm^2\", m2 = 6.26e-5, m4 = \"0.0146 /um^2\" }",
        Table,
        Follows("not used; radius, density and heights are given"),
        "spectral moments of a Gaussian surface",
        "They say R, η, σ, σ_s and y_s. Radii scatter as by `summits`. m₀ m₄/m₂² has to be above 1.5.",
    )
    .excludes(&[
        "surface.asperity_radius",
        "surface.asperity_density",
        "surface.surface_height_std",
        "surface.asperity_height_std",
        "surface.heights",
        "surface.radii",
    ]),
    key(
        "surface.spectrum.m0",
        "\"2.37 nm^2\"",
        Quantity(Of::Area, Positive),
        Required,
        "variance of heights",
        "m₀ = σ².",
    ),
    key(
        "surface.spectrum.m2",
        "6.26e-5",
        Number(Excluded(0.0), Unbounded),
        Required,
        "variance of slopes",
        "m₂ of a profile in any direction.",
    ),
    key(
        "surface.spectrum.m4",
        "\"0.0146 /um^2\"",
        Quantity(Of::ArealDensity, Positive),
        Required,
        "variance of curvatures",
        "m₄ of a profile in any direction.",
    ),
    key(
        "surface.asperities",
        "{ path = \"asperities.h5\" }",
        Table,
        Follows("not used; asperities are drawn from laws"),
        "asperities of a measured height map",
        "Written by `stiction asperities`. They say R, η, σ, σ_s, y_s and A_n; each height keeps its own \
         radius.",
    )
    .excludes(&[
        "surface.asperity_radius",
        "surface.asperity_density",
        "surface.surface_height_std",
        "surface.asperity_height_std",
        "surface.heights",
        "surface.radii",
        "surface.summits",
        "surface.spectrum",
    ]),
    key("surface.asperities.path", "\"asperities.h5\"", Text, Required, "the file", "Relative to the scene."),
    key(
        "surface.asperities.sample",
        "\"bootstrap\"",
        Choice(|| names(&population::SAMPLES)),
        Is("\"bootstrap\""),
        "how a replica is made of them",
        "`bootstrap`: every asperity is one of the measured ones, drawn with replacement. `whole`: all of \
         them once, in every replica; then `nominal_area` is that of the map.",
    ),
    key("model", "{ law = \"hybrid\" }", Table, Required, "the law of one asperity, and the history", ""),
    key(
        "model.law",
        "\"hybrid\"",
        Choice(|| MODELS.iter().map(|model| model.name).collect()),
        Required,
        "law of one asperity",
        "`hybrid` is for every λ and ψ; the page of the laws says what each is and where it is valid.",
    ),
    key(
        "model.path",
        "\"approach\"",
        Choice(|| names(&HISTORIES)),
        Is("\"approach\""),
        "history",
        "`approach`: contact begins at first touch. `retraction`: contact lasts to the end of its stable \
         branch. `loop`: there and back, each asperity by its own history; for one radius.",
    ),
    key(
        "model.unloaded_radius",
        "\"elastic\"",
        Choice(|| names(&UnloadedRadius::ALL)),
        Is("\"kept\""),
        "radius of flattened tops on the way back",
        "Needs `path = \"loop\"`. `kept`: R. `elastic`: that of the elastic contact which has the largest \
         load and its area.",
    ),
    key(
        "model.critical_approach",
        "\"0.3 nm\"",
        Quantity(Of::Length, NotNegative),
        Follows("from the history"),
        "critical approach of the published fits",
        "δ_A of the law `fit:paper`; other laws find theirs.",
    )
    .swept(),
    key(
        "separation",
        "{ h_star = { from = -1.0, to = 8.0, count = 91 } }",
        Table,
        Required,
        "where forces are computed",
        "Of `h` and `h_star` one has to be there.",
    ),
    key(
        "separation.h",
        "{ from = \"-2 nm\", to = \"13 nm\", count = 91 }",
        Various(RANGE),
        Follows("from `h_star`"),
        "separations of the mean planes, as lengths",
        "h of the mean planes of the two faces. They rise.",
    )
    .excludes(&["separation.h_star"]),
    key("separation.h.from", "\"-2 nm\"", Quantity(Of::Length, Any), Required, "the first", ""),
    key(
        "separation.h.to",
        "\"13 nm\"",
        Quantity(Of::Length, Any),
        Required,
        "the last",
        "Greater than `from`.",
    ),
    key("separation.h.count", "91", Whole(2, separation::MOST), Required, "how many, evenly spaced", ""),
    key("separation.h[]", "\"3 nm\"", Quantity(Of::Length, Any), Required, "", ""),
    key(
        "separation.h_star",
        "{ from = -1.0, to = 8.0, count = 91 }",
        Various(RANGE),
        Follows("from `h`"),
        "separations of the mean planes over σ",
        "h* = h/σ, with σ of the surface, not σ_s. Pull-off is mostly found between 1 and 6; 0.05 is a good \
         step.",
    ),
    key("separation.h_star.from", "-1.0", Number(Unbounded, Unbounded), Required, "the first", ""),
    key(
        "separation.h_star.to",
        "8.0",
        Number(Unbounded, Unbounded),
        Required,
        "the last",
        "Greater than `from`.",
    ),
    key("separation.h_star.count", "91", Whole(2, separation::MOST), Required, "how many, evenly spaced", ""),
    key("separation.h_star[]", "2.0", Number(Unbounded, Unbounded), Required, "", ""),
    key(
        "separation.stiffness_span",
        "\"0.2 nm\"",
        Quantity(Of::Length, Positive),
        Follows("`equilibrium_spacing`"),
        "span of the secant stiffness",
        "The stiffness of a replica is the steepest secant of its force over this length. It lies within \
         the separations.",
    ),
    key("ensemble", "{ replicas = 200 }", Table, Required, "how many surfaces are drawn, and how", ""),
    key(
        "ensemble.replicas",
        "200",
        Whole(*stopping::REPLICAS.start(), *stopping::REPLICAS.end()),
        Required,
        "number of surfaces",
        "Each is drawn anew. The standard error of a mean falls as 1/√ of it.",
    )
    .excludes(&["ensemble.target"]),
    key(
        "ensemble.target",
        "{ quantity = \"pull_off_force\", relative_standard_error = 5e-3 }",
        Various("a table, or a list of them"),
        Follows("none; `replicas` says how many"),
        "how well means are to be known",
        "The run ends when all targets are met. Not in a sweep.",
    ),
    key(
        "ensemble.target.quantity",
        "\"pull_off_force\"",
        Choice(|| SCALARS.iter().map(|scalar| scalar.name).collect()),
        Required,
        "the quantity whose mean it is",
        "",
    ),
    key(
        "ensemble.target.relative_standard_error",
        "5e-3",
        Number(Included(*stopping::RELATIVE.start()), Included(*stopping::RELATIVE.end())),
        Required,
        "standard error over the mean, at most",
        "",
    )
    .excludes(&["ensemble.target.standard_error"]),
    key(
        "ensemble.target.standard_error",
        "\"0.5 uN\"",
        Various("a force, stiffness or length, as the quantity is; greater than 0"),
        Required,
        "standard error, at most",
        "",
    ),
    key(
        "ensemble.target.estimate",
        "\"controlled\"",
        Choice(|| names(&Estimator::ALL)),
        Is("\"plain\""),
        "which mean",
        "`controlled` has the integral as control variate and needs fewer replicas.",
    ),
    key(
        "ensemble.min_replicas",
        "64",
        Whole(*stopping::REPLICAS.start(), *stopping::REPLICAS.end()),
        Follows("64 groups of the sampling scheme"),
        "surfaces before the targets are looked at",
        "Needs `target`. It is rounded up to whole groups of 8.",
    )
    .excludes(&["ensemble.replicas"]),
    key(
        "ensemble.max_replicas",
        "50000",
        Whole(*stopping::REPLICAS.start(), *stopping::REPLICAS.end()),
        Is("100000"),
        "surfaces at most",
        "Needs `target`. In whole groups of the sampling scheme.",
    )
    .excludes(&["ensemble.replicas"]),
    key(
        "ensemble.sampling",
        "\"stratified\"",
        Choice(|| names(&SamplingScheme::ALL)),
        Is("\"independent\""),
        "how surfaces are drawn relative to each other",
        "`antithetic` takes them in pairs, `stratified` in groups of 8; both are for Gaussian heights, one \
         radius and a fixed number.",
    ),
    key(
        "ensemble.seed",
        "1",
        Whole(0, i64::MAX as u64),
        Is("1"),
        "seed of the random numbers",
        "The same seed gives the same bits.",
    ),
    key(
        "instability",
        "{ stiffness = \"100 kN/m\" }",
        Table,
        Follows("none; the separation is held"),
        "a spring that holds the surfaces, and where they snap",
        "",
    ),
    key(
        "instability.stiffness",
        "\"100 kN/m\"",
        OneOrMore(Of::Stiffness, NotNegative),
        Required,
        "stiffness of the spring",
        "0: load control.",
    ),
    key(
        "instability.preload",
        "\"10 mN\"",
        OneOrMore(Of::Force, Positive),
        Follows("none; the smallest separation ends the approach"),
        "external force at which the approach ends",
        "Needs `path = \"loop\"` in `[model]`.",
    ),
    key(
        "instability.smallest_snap",
        "\"0.01 nm\"",
        Quantity(Of::Length, NotNegative),
        Is("0"),
        "least distance that counts as a snap",
        "",
    ),
    key("solver", "{ sum = \"compressed\" }", Table, Follows("direct sums"), "how forces are summed", ""),
    key(
        "solver.sum",
        "\"compressed\"",
        Choice(|| names(&SUMS)),
        Is("\"direct\""),
        "way of summing",
        "`direct`: asperity by asperity. `compressed`: by moments of bins of heights, faster, to a \
         tolerance.",
    ),
    key(
        "solver.tolerance",
        "1e-9",
        Number(Included(*SUM_TOLERANCES.start()), Included(*SUM_TOLERANCES.end())),
        Is("1e-9"),
        "tolerance of compressed sums",
        "Needs `sum = \"compressed\"`. One of F_s + P.",
    )
    .swept(),
    key("output", "{ curves = true }", Table, Follows("no curves of replicas"), "what is kept", ""),
    key(
        "output.curves",
        "true",
        Switch,
        Is("false"),
        "whether the curves of every replica are kept",
        "Means, scatter and the numbers of every replica are kept in any case.",
    ),
    key(
        "sweep",
        "{ \"material.work_of_adhesion\" = [\"0.04 J/m^2\", \"0.09 J/m^2\"] }",
        Table,
        Follows("none; one scene"),
        "keys with several values",
        "",
    ),
    key(
        "sweep.mode",
        "\"grid\"",
        Choice(|| names(&sweep::Mode::ALL)),
        Is("\"grid\""),
        "how several keys are combined",
        "`grid`: every value with every other. `zip`: the first with the first, the second with the second.",
    ),
    key(
        "sweep.common_random_numbers",
        "true",
        Switch,
        Is("true"),
        "whether all points have the same random numbers",
        "Differences between points are then much better known than the points.",
    ),
    key("sweep.*.from", "", Various("a value of the key"), Required, "the first value", ""),
    key("sweep.*.to", "", Various("a value of the key"), Required, "the last value", ""),
    key("sweep.*.count", "7", Whole(2, sweep::MOST_POINTS as u64), Required, "number of values", ""),
    key(
        "sweep.*.spacing",
        "\"log\"",
        Choice(|| names(&sweep::SPACINGS)),
        Is("\"linear\""),
        "linear or logarithmic",
        "",
    ),
];
