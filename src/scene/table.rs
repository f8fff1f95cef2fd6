//! The table of the keys of scenes: the reader takes units, ranges, examples and exclusions from it, and
//! `docs/scene.md` all of it. It is longer than files should be, since it is one table.

use super::background::FORCES;
use super::capillary::LIQUIDS;
use super::choices::{
    COUPLINGS, FORMAT, HEIGHT_LAWS, HISTORIES, KERNELS, MEASURED_RADII, MOST_CYCLES, MOST_POINTS,
    MOST_SEPARATIONS, Mode, PATCH, POISSON_RATIOS, POSITIONS, RADIUS_LAWS, RELATIVE, REPLICAS, SAMPLES,
    SPACINGS, SUM_TOLERANCES, SUMMIT_LAWS, SUMS, TOLERANCES_OF_LOADS, VARIATIONS,
};
use super::keys::{Key, Sign, Value, key};
use super::shape::SHAPES;
use super::units::Dimension as Of;
use crate::asperity::MODELS;
use crate::asperity::PlasticContact;
use crate::engine::{Estimator, SCALARS};
use crate::liquid::{Bridges, Volume};
use crate::surface::{CountLaw, SamplingScheme};
use Sign::{Any, NotNegative, Positive};
use Value::{Choice, Number, OneOrMore, Quantity, Switch, Table, Text, Various, Whole};
use std::ops::Bound::{Excluded, Included, Unbounded};
use std::sync::LazyLock;

/// Names of a closed list.
fn names<T>(list: &[(&'static str, T)]) -> Vec<&'static str> {
    list.iter().map(|(name, _)| *name).collect()
}

const RANGE: &str = "a list, or a table { from, to, count }";
const FILE_PATH: &str = "Relative to the scene. A plain CSV file, with commas between columns and points in numbers, \
    names above the columns and comments behind `#` if there are such; or an HDF5 file.";
const FILE_COLUMN: &str = "For a CSV file. A column by its name, or by its number from 1.";
const FILE_DATASET: &str = "For an HDF5 file. A dataset of one dimension.";
const FILE_UNIT: &str = "The values of the file are multiplied by it. The name above a column may have it: `height (nm)`, `height_nm`.";

/// Every key of a scene by its dotted name, in the order of the reference. `[]` is an element of a list, `sweep.*` a key
/// that is swept.
pub static KEYS: LazyLock<Vec<&'static Key>> =
    LazyLock::new(|| FIRST.iter().chain(FORCES.iter().flat_map(|table| table.keys)).chain(REST).collect());

/// The keys before those of forces between the mean planes.
static FIRST: &[Key] = &[
    key("format", "1", Whole(FORMAT, FORMAT)).what("version of the scene format").defaults_to("1"),
    key("title", "\"Case II\"", Text)
        .what("name of the scene, for people")
        .about("It changes no result.")
        .defaults_to("\"\""),
    key("material", "{ reduced_modulus = \"85.29 GPa\" }", Table).what("what the two bodies are made of"),
    key("material.reduced_modulus", "\"85.29 GPa\"", Quantity(Of::Pressure, Positive))
        .what("reduced modulus")
        .about(
            "E* with 1/E* = (1 − ν₁²)/E₁ + (1 − ν₂²)/E₂. Give it, or the two bodies by `youngs_modulus` \
             and `poisson_ratio`.",
        )
        .swept()
        .excludes(&["material.youngs_modulus"]),
    key("material.youngs_modulus", "\"169 GPa\"", Quantity(Of::Pressure, Positive))
        .what("Young's modulus of the two bodies")
        .about("E₁ and E₂ as a list of two, `[\"169 GPa\", \"70 GPa\"]`; one value is for both.")
        .follows("not used where `reduced_modulus` is given"),
    key("material.hardness", "\"2.5 GPa\"", Quantity(Of::Pressure, Positive))
        .what("hardness of the softer body")
        .about(
            "H sets where plastic flow begins: ω_c = (π k H / 2 E*)² R. A list of two has the hardness of both bodies: \
             the one with the smaller k H flows.",
        )
        .follows("infinite under a law without plastic flow, such as `md`, `jkr` or `dmt`; all others require it")
        .swept(),
    key("material.poisson_ratio", "0.27", Number(POISSON_RATIOS.0, POISSON_RATIOS.1))
        .formerly("poissons_ratio")
        .what("Poisson ratio of the softer body, or of both")
        .about(
            "It enters k = 0.454 + 0.41 ν of plastic flow, and with `youngs_modulus` the reduced modulus. A list of two \
             is for both bodies, in the order of `youngs_modulus`; one value is for both.",
        )
        .follows("not used without `hardness` and `youngs_modulus`; either requires it")
        .swept(),
    key("material.work_of_adhesion", "\"0.09 J/m^2\"", Quantity(Of::SurfaceEnergy, Positive))
        .what("work of adhesion")
        .about("Δγ = γ₁ + γ₂ − γ₁₂. Give it, or the energies by `surface_energy` and `interface_energy`.")
        .swept()
        .excludes(&["material.surface_energy", "material.interface_energy"]),
    key("material.surface_energy", "\"50 mJ/m^2\"", Quantity(Of::SurfaceEnergy, Positive))
        .what("surface energy of the two bodies")
        .about("γ₁ and γ₂ as a list of two, `[\"50 mJ/m^2\", \"60 mJ/m^2\"]`; one value is for both. Two different bodies need `interface_energy`.")
        .follows("not used where `work_of_adhesion` is given"),
    key("material.interface_energy", "\"20 mJ/m^2\"", Quantity(Of::SurfaceEnergy, NotNegative))
        .what("energy γ₁₂ of the interface")
        .about(
            "Needs `surface_energy`. It has to be less than γ₁ + γ₂.",
        )
        .follows("0 for two bodies of one material; not used where `work_of_adhesion` is given"),
    key("material.equilibrium_spacing", "\"0.2 nm\"", Quantity(Of::Length, Positive))
        .what("equilibrium spacing")
        .about(
            "Z₀, the distance at which the two faces neither attract nor repel each other; 0.15 to 0.4 nm \
             for most solids.",
        )
        .defaults_to("\"0.2 nm\"")
        .swept(),
    key("surface", "{ asperity_radius = \"3.33 um\" }", Table).what("the rough surface"),
    key("surface.asperity_radius", "\"3.33 um\"", Quantity(Of::Length, Positive))
        .what("radius of the asperities")
        .about(
            "R, the radius of curvature of a summit of both faces together: 1/κ with κ² the sum over the faces of their 1/R², so \
             R/√2 of two like faces. The mean one where `radii` scatter.",
        )
        .swept(),
    key("surface.asperity_density", "\"7.39 /um^2\"", Quantity(Of::ArealDensity, Positive))
        .what("asperities per area")
        .about("η. A replica has N = η A_n asperities.")
        .swept(),
    key("surface.surface_height_std", "\"1.619 nm\"", Quantity(Of::Length, Positive))
        .what("standard deviation of the surface heights")
        .about(
            "σ of all points of the surface, the Rq or Sq of a profilometer. A list of two is for two rough faces: σ² is \
             the sum of their squares. One of σ and σ_s is required; the other follows by σ_s² = σ² − 3.717·10⁻⁴/(ηR)².",
        )
        .follows("from `asperity_height_std`")
        .swept(),
    key("surface.asperity_height_std", "\"1.417 nm\"", Quantity(Of::Length, Positive))
        .what("standard deviation of the asperity heights")
        .about("σ_s of the tops only. Tops are drawn with it.")
        .follows("from `surface_height_std`")
        .swept(),
    key("surface.mean_plane_offset", "\"1.867 nm\"", Quantity(Of::Length, NotNegative))
        .what("height of the asperity mean plane above the surface mean plane")
        .about("y_s. Tops are d = h − y_s from the other face. 0 takes h itself as the distance of the tops.")
        .follows("0.045944/(ηR), as for a Gaussian surface")
        .swept(),
    key("surface.nominal_area", "\"100 um^2\"", Quantity(Of::Area, Positive))
        .what("nominal area")
        .about(
            "A_n of one replica, a finite patch. Means are proportional to it; the scatter from patch to \
             patch falls as 1/√A_n. With `asperities` it may be left out and is then the area of the map.",
        )
        .swept(),
    key("surface.lubricant_thickness", "\"0.5 nm\"", Quantity(Of::Length, NotNegative))
        .what("thickness of the lubricant")
        .about("t. 0: dry. Dry laws ignore it.")
        .defaults_to("0")
        .swept(),
    key(
        "surface.heights",
        "{ law = \"weibull\", shape = 2.0 }",
        Various("the name of a law, or a table with `law` and its parameters"),
    )
    .what("law of the asperity heights")
    .about("Whatever the law, its standard deviation is σ_s and its mean 0.")
    .defaults_to("\"gaussian\""),
    key("surface.heights.law", "\"weibull\"", Choice(|| names(&HEIGHT_LAWS))).what("name of the law"),
    key(
        "surface.heights.shape",
        "1.5",
        Various("a number from 1 to 20 of `weibull`, from 0.01 to 1.5 of `lognormal`"),
    )
    .what("shape of the law of heights")
    .about(
        "For `weibull` the exponent, for `lognormal` the standard deviation of the logarithm. Other \
             laws have none.",
    )
    .swept(),
    key("surface.heights.lower", "-3.0", Number(Unbounded, Unbounded))
        .what("lower limit of truncated heights")
        .about(
            "For `truncated`, in standard deviations of the uncut Gaussian. One of the limits is \
             required.",
        )
        .follows("no limit")
        .swept(),
    key("surface.heights.upper", "1.5", Number(Unbounded, Unbounded))
        .what("upper limit of truncated heights")
        .about(
            "For `truncated`, in standard deviations of the uncut Gaussian; a polished surface has \
             lost its highest tops.",
        )
        .follows("no limit")
        .swept(),
    key("surface.heights.path", "\"heights.csv\"", Text)
        .what("file of heights, for the law `file`")
        .about(FILE_PATH),
    key("surface.heights.column", "\"height\"", Various("a name, or a number from 1"))
        .what("column of the file")
        .about(FILE_COLUMN)
        .excludes(&["surface.heights.dataset"]),
    key("surface.heights.dataset", "\"/asperities/height\"", Text)
        .what("dataset of the file")
        .about(FILE_DATASET),
    key("surface.heights.unit", "\"nm\"", Various("a unit of length"))
        .what("unit of the file")
        .about(FILE_UNIT)
        .follows("the unit above the column; required if there is none"),
    key(
        "surface.radii",
        "{ law = \"gamma\", coefficient_of_variation = 0.5 }",
        Various("the name of a law, or a table with `law` and its parameters"),
    )
    .what("law of the asperity radii")
    .about(
        "`common`: all have `asperity_radius`. Where radii scatter, each asperity has its own λ. \
             Radius and height are drawn independently.",
    )
    .defaults_to("\"common\""),
    key("surface.radii.law", "\"lognormal\"", Choice(|| names(&RADIUS_LAWS))).what("name of the law"),
    key(
        "surface.radii.coefficient_of_variation",
        "0.3",
        Number(Included(*VARIATIONS.start()), Included(*VARIATIONS.end())),
    )
    .what("coefficient of variation of the radii")
    .about("For `lognormal` and `gamma`: standard deviation over mean.")
    .swept(),
    key("surface.radii.path", "\"radii.csv\"", Text)
        .what("file of radii, for the law `file`")
        .about(FILE_PATH)
        .excludes(&["surface.asperity_radius"]),
    key("surface.radii.column", "\"radius\"", Various("a name, or a number from 1"))
        .what("column of the file")
        .about(FILE_COLUMN)
        .excludes(&["surface.radii.dataset"]),
    key("surface.radii.dataset", "\"/asperities/radius\"", Text)
        .what("dataset of the file")
        .about(FILE_DATASET),
    key("surface.radii.unit", "\"um\"", Various("a unit of length"))
        .what("unit of the file")
        .about(FILE_UNIT)
        .follows("the unit above the column; required if there is none"),
    key("surface.count", "\"poisson\"", Choice(|| names(&CountLaw::ALL)))
        .what("whether the number of asperities is fixed or scatters")
        .about(
            "`fixed`: N = ηA_n in every replica. `poisson`: N scatters as in patches cut at random from a \
             large surface.",
        )
        .defaults_to("\"fixed\""),
    key("surface.summits", "\"nayak\"", Choice(|| names(&SUMMIT_LAWS)))
        .what("heights and radii of the summits of a Gaussian surface")
        .about(
            "Heights and radii are drawn together, as Nayak's theory has them: higher summits are \
             sharper.",
        )
        .follows("no; heights and radii have their own laws")
        .excludes(&["surface.heights", "surface.radii"]),
    key("surface.spectrum", "{ m0 = \"2.37 nm^2\", m2 = 6.26e-5, m4 = \"0.0146 /um^2\" }", Table)
        .what("spectral moments of a Gaussian surface")
        .about("R, η, σ, σ_s and y_s follow. Radii scatter as with `summits`. m₀ m₄/m₂² has to be above 1.5.")
        .follows("not used; radius, density and heights are given")
        .excludes(&[
            "surface.asperity_radius",
            "surface.asperity_density",
            "surface.surface_height_std",
            "surface.asperity_height_std",
            "surface.heights",
            "surface.radii",
        ]),
    key("surface.spectrum.m0", "\"2.37 nm^2\"", Quantity(Of::Area, Positive))
        .what("variance of heights")
        .about("m₀ = σ²."),
    key("surface.spectrum.m2", "6.26e-5", Number(Excluded(0.0), Unbounded))
        .what("variance of slopes")
        .about("m₂ of a profile in any direction."),
    key("surface.spectrum.m4", "\"0.0146 /um^2\"", Quantity(Of::ArealDensity, Positive))
        .what("variance of curvatures")
        .about("m₄ of a profile in any direction."),
    key("surface.asperities", "{ path = \"asperities.h5\" }", Table)
        .what("asperities of a measured height map")
        .about(
            "Written by `stiction asperities`. R, η, σ, σ_s, y_s and A_n follow; each height keeps its \
             own radius.",
        )
        .follows("not used; asperities are drawn from laws")
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
    key("surface.asperities.path", "\"asperities.h5\"", Text)
        .what("the file")
        .about("Relative to the scene."),
    key("surface.asperities.sample", "\"bootstrap\"", Choice(|| names(&SAMPLES)))
        .what("how a replica is made of them")
        .about(
            "`bootstrap`: every asperity is one of the measured ones, drawn with replacement. `whole`: \
             all of them once, in every replica; `nominal_area` is then the area of the map. Under `[shape]` it has a random place \
             of the map, which counts as repeated, with the asperities that are there.",
        )
        .defaults_to("\"bootstrap\""),
    key("surface.asperities.radius", "\"equivalent\"", Choice(|| names(&MEASURED_RADII)))
        .what("radius of each of them")
        .about(
            "`mean_curvature`: its reciprocal. `equivalent`: the geometric mean of the principal radii, \
             which comes closer to the force of an ellipsoid.",
        )
        .defaults_to("\"mean_curvature\""),
    key("shape", "{ body = \"sphere\", radius = \"10 um\" }", Table)
        .what("the body over the rough surface, such as a probe")
        .about(
            "Asperities are drawn at random places under it, each lower by the depth s of its place behind the nearest point; h is \
             the separation there. Places from which nothing pulls at the smallest h are left out; `nominal_area` follows from that. A \
             replica is a spot, with a Poisson number of asperities.",
        )
        .follows("none; a flat patch"),
    key("shape.body", "\"sphere\"", Choice(|| names(SHAPES)))
        .what("shape of the body")
        .about(
            "`sphere` has a `radius`; `paraboloid` two principal `radii`, as crossed cylinders have; `cylinder`, which lies on the \
             surface, `radius` and `length`; `punch` the `flat_radius` of its end and the `edge_radius` of its rounded edge; `tilted`, a flat \
             square, `side` and `angle`.",
        ),
    key("shape.radius", "\"10 um\"", Quantity(Of::Length, Positive))
        .what("radius of a sphere or a cylinder")
        .about("R_m. The depth is s = r²/2(R_m + R), and the equivalent radius of contacts 1/(1/R + 1/R_m).")
        .follows("none; required for `sphere` and `cylinder`")
        .swept(),
    key("shape.radii", "[\"10 um\", \"20 um\"]", OneOrMore(Of::Length, Positive, &[]))
        .what("principal radii of a paraboloid")
        .about("Crossed cylinders have their radii.")
        .follows("none; required for `paraboloid`"),
    key("shape.length", "\"50 um\"", Quantity(Of::Length, Positive))
        .what("length of a cylinder")
        .follows("none; required for `cylinder`")
        .swept(),
    key("shape.flat_radius", "\"1 um\"", Quantity(Of::Length, Positive))
        .what("radius of the flat end of a punch")
        .follows("none; required for `punch`")
        .swept(),
    key("shape.edge_radius", "\"0.2 um\"", Quantity(Of::Length, Positive))
        .what("radius of the edge of a punch")
        .follows("none; required for `punch`")
        .swept(),
    key("shape.side", "\"10 um\"", Quantity(Of::Length, Positive))
        .what("side of a tilted square")
        .follows("none; required for `tilted`")
        .swept(),
    key("shape.angle", "\"0.1 deg\"", Quantity(Of::Angle, Positive))
        .what("angle of a tilted square")
        .follows("none; required for `tilted`")
        .swept(),
    key("model", "{ law = \"md_plastic\" }", Table)
        .what("the law of one asperity, and the history")
        .follows("the defaults of its keys"),
    key("model.law", "\"hybrid\"", Choice(|| MODELS.iter().map(|model| model.name).collect()))
        .what("law of one asperity")
        .swept()
        .about(
            "`md_plastic` covers elastic contacts at any λ and plastic flow up to λ ≈ 1, and is continuous where contacts \
             begin to flow; the page of the laws gives the range of each law.",
        )
        .follows("`md_plastic`; with `[capillary]` `capillary`"),
    key("model.plastic_contact", "\"zmc\"", Choice(|| names(&PlasticContact::ALL)))
        .what("plastic contact under `md_plastic` and `capillary`")
        .about(
            "The load and the contact radius of an asperity that flows, without adhesion: `jg` Jackson and Green, `ke` \
             Kogut and Etsion, `zmc` Zhao, Maietta and Chang, `tn` Thornton and Ning.",
        )
        .defaults_to("\"jg\"")
        .swept(),
    key("model.history", "\"approach\"", Choice(|| names(&HISTORIES)))
        .formerly("path")
        .what("history")
        .about(
            "`approach`: contact begins at first touch. `loop`: approach to the closest separation, then retraction from there, \
             each asperity by its own history. `retraction`: the retraction of that loop, without the approach. Surfaces that \
             have touched are pulled off on `loop` or `retraction`.",
        )
        .defaults_to("\"approach\""),
    key("model.critical_approach", "\"0.3 nm\"", Quantity(Of::Length, NotNegative))
        .what("critical approach of the published fits")
        .about("δ_A of the law `fit:paper`; other laws find theirs.")
        .follows("from the history")
        .swept(),
    key(
        "capillary",
        "{ relative_humidity = 0.45, contact_angles = [\"30 deg\", \"30 deg\"] }",
        Table,
    )
    .what("the liquid that condenses around the asperities")
    .about("Needs `law = \"capillary\"` in `[model]`, which needs it.")
    .follows("none; the asperities are dry"),
    key("capillary.relative_humidity", "0.45", Number(Excluded(0.0), Excluded(1.0)))
        .what("relative humidity")
        .about(
            "φ, the pressure of the vapour over the pressure at saturation. It sets r_K = γV_m/(R_g T |ln φ|). Required without \
             `film_thickness`.",
        )
        .follows("from `film_thickness`")
        .excludes(&["capillary.film_thickness"])
        .swept(),
    key("capillary.film_thickness", "\"1 nm\"", Quantity(Of::Length, Positive))
        .what("thickness of liquid films on the faces")
        .about(
            "t, of a liquid that does not evaporate; r_K = 6πγt³/A. Needs `hamaker_constant` and `film_faces`; replaces \
             `relative_humidity`.",
        )
        .follows("from the vapour where there is `hamaker_constant`: (A/6πp_c)^(1/3)")
        .excludes(&["capillary.relative_humidity"])
        .swept(),
    key("capillary.hamaker_constant", "\"1e-19 J\"", Quantity(Of::Energy, Positive))
        .what("Hamaker constant of liquid films on the faces")
        .about("A, of a face across the film: its disjoining pressure is A/(6πt³). Needs `film_faces`.")
        .follows("none; faces are without films")
        .swept(),
    key("capillary.film_faces", "1", Whole(1, 2))
        .what("how many of the faces have a film")
        .about("Each needs the contact angle 0. Needs `hamaker_constant`.")
        .follows("none; faces are without films"),
    key("capillary.film_drains", "true", Switch)
        .what("whether bridges are filled from the films between them")
        .about("Needs `film_thickness`, which then refers to faces that are apart.")
        .defaults_to("true"),
    key("capillary.liquid", "\"water\"", Choice(|| names(&LIQUIDS)))
        .what("name of the liquid")
        .about("Surface tension and density of water follow from the temperature (IAPWS). Another liquid is given by `surface_tension` and `molar_volume`.")
        .defaults_to("\"water\"")
        .excludes(&["capillary.surface_tension", "capillary.molar_volume"]),
    key("capillary.temperature", "\"20 degC\"", Quantity(Of::Temperature, Positive))
        .what("temperature")
        .about("T, of the liquid, its vapour and the solids.")
        .defaults_to("\"20 degC\"")
        .swept(),
    key("capillary.surface_tension", "\"72.7 mN/m\"", Quantity(Of::SurfaceEnergy, Positive))
        .what("surface tension of a liquid of one's own")
        .about("γ. Needs `molar_volume` with `relative_humidity`.")
        .follows("from `liquid`")
        .swept(),
    key("capillary.molar_volume", "\"18 cm^3/mol\"", Quantity(Of::MolarVolume, Positive))
        .what("molar volume of a liquid of one's own")
        .about("V_m. Needs `surface_tension` and `relative_humidity`.")
        .follows("from `liquid`")
        .swept(),
    key(
        "capillary.contact_angles",
        "[\"30 deg\", \"30 deg\"]",
        Various("a list of two angles, each from 0 to 180 deg"),
    )
    .what("contact angles of the two faces")
    .about("θ₁ and θ₂. cos θ₁ + cos θ₂ has to be above 0: else no liquid condenses."),
    key("capillary.contact_angles[]", "\"30 deg\"", Quantity(Of::Angle, NotNegative)),
    key("capillary.volume", "\"equilibrium\"", Choice(|| names(&Volume::ALL)))
        .what("amount of liquid in a bridge while the faces part")
        .about(
            "`equilibrium`: in equilibrium with the vapour, slow retraction. `constant`: bridges keep their liquid \
             when contact ends, fast retraction.",
        )
        .defaults_to("\"equilibrium\""),
    key("capillary.bridges", "\"metastable\"", Choice(|| names(&Bridges::ALL)))
        .what("when bridges form and break")
        .about(
            "`metastable`: they form where the solids touch, and break where they become unstable. `reversible`: they \
             form and break where a bridge and no bridge have equal energy.",
        )
        .defaults_to("\"metastable\""),
    key("separation", "{ h_star = { from = -1.0, to = 8.0, count = 91 } }", Table)
        .what("where forces are computed")
        .about(
            "Without `h` and `h_star` the range follows from the surface: from where a tenth of the nominal area touches, or \
             where the largest preload is reached, to where nothing pulls, in 161 steps.",
        )
        .follows("a range that follows from the surface"),
    key("separation.h", "{ from = \"-2 nm\", to = \"13 nm\", count = 91 }", Various(RANGE))
        .what("separations of the mean planes, as lengths")
        .about("h of the mean planes of the two faces. They rise.")
        .follows("from `h_star`")
        .excludes(&["separation.h_star"]),
    key("separation.h.from", "\"-2 nm\"", Quantity(Of::Length, Any)).what("the first"),
    key("separation.h.to", "\"13 nm\"", Quantity(Of::Length, Any))
        .what("the last")
        .about("Greater than `from`."),
    key("separation.h.count", "91", Whole(2, MOST_SEPARATIONS)).what("how many, evenly spaced"),
    key("separation.h[]", "\"3 nm\"", Quantity(Of::Length, Any)),
    key("separation.h_star", "{ from = -1.0, to = 8.0, count = 91 }", Various(RANGE))
        .what("separations of the mean planes over σ")
        .about(
            "h* = h/σ, with σ of the surface, not σ_s. Pull-off is mostly found between 1 and 6; 0.05 is \
             a good step.",
        )
        .follows("from `h`"),
    key("separation.h_star.from", "-1.0", Number(Unbounded, Unbounded)).what("the first"),
    key("separation.h_star.to", "8.0", Number(Unbounded, Unbounded))
        .what("the last")
        .about("Greater than `from`."),
    key("separation.h_star.count", "91", Whole(2, MOST_SEPARATIONS)).what("how many, evenly spaced"),
    key("separation.h_star[]", "2.0", Number(Unbounded, Unbounded)),
    key("separation.cycles", "2", Whole(1, MOST_CYCLES))
        .what("how often the surfaces of a loop are brought close and pulled back")
        .about(
            "Needs `history = \"loop\"`. From 2 on the file has the second approach, in datasets that begin with `reapproach_`, and the energy that each \
             cycle after the first dissipates. Between cycles the surfaces are parted until nothing touches. The second \
             retraction equals the first, and every further cycle equals the second.",
        )
        .defaults_to("1"),
    key("separation.stiffness_span", "\"0.2 nm\"", Quantity(Of::Length, Positive))
        .what("span of the secant stiffness")
        .about(
            "The stiffness of a replica is the steepest secant of its force over this length. It lies \
             within the separations.",
        )
        .follows("`equilibrium_spacing`"),
    key("ensemble", "{ replicas = 200 }", Table)
        .what("how many surfaces are drawn, and how")
        .follows("the defaults of its keys"),
    key("ensemble.replicas", "200", Whole(0, *REPLICAS.end()))
        .what("number of surfaces")
        .about(
            "Each is drawn anew. The standard error of a mean falls as 1/√ of it. With 0 the integral alone is computed.",
        )
        .defaults_to("200")
        .excludes(&["ensemble.target"]),
    key(
        "ensemble.target",
        "{ quantity = \"pull_off_force\", relative_standard_error = 5e-3 }",
        Various("a table, or a list of them"),
    )
    .what("how well means are to be known")
    .about("The run ends when all targets are met; in a sweep or with several sizes each point by itself.")
    .follows("none; `replicas` says how many"),
    key(
        "ensemble.target.quantity",
        "\"pull_off_force\"",
        Choice(|| SCALARS.iter().map(|scalar| scalar.name).collect()),
    )
    .what("the quantity to average"),
    key(
        "ensemble.target.relative_standard_error",
        "5e-3",
        Number(Included(*RELATIVE.start()), Included(*RELATIVE.end())),
    )
    .what("standard error over the mean, at most")
    .excludes(&["ensemble.target.standard_error"]),
    key(
        "ensemble.target.standard_error",
        "\"0.5 uN\"",
        Various("a force, stiffness or length, as the quantity is; greater than 0"),
    )
    .what("standard error, at most"),
    key("ensemble.target.estimate", "\"controlled\"", Choice(|| names(&Estimator::ALL)))
        .what("which mean")
        .about("`controlled` uses the integral as control variate and needs fewer replicas.")
        .defaults_to("\"plain\""),
    key("ensemble.min_replicas", "64", Whole(*REPLICAS.start(), *REPLICAS.end()))
        .what("surfaces before the targets are first checked")
        .about("Needs `target`. It is rounded up to whole groups of 8.")
        .follows("64 groups of the sampling scheme")
        .excludes(&["ensemble.replicas"]),
    key("ensemble.max_replicas", "50000", Whole(*REPLICAS.start(), *REPLICAS.end()))
        .what("surfaces at most")
        .about("Needs `target`. In whole groups of the sampling scheme.")
        .defaults_to("100000")
        .excludes(&["ensemble.replicas"]),
    key("ensemble.sampling", "\"stratified\"", Choice(|| names(&SamplingScheme::ALL)))
        .what("how surfaces are drawn relative to each other")
        .about(
            "`antithetic` takes them in pairs, `stratified` in groups of 8, related asperity by asperity in the order of their \
             heights; both need a fixed number of asperities, and measured ones that are drawn.",
        )
        .defaults_to("\"independent\""),
    key("ensemble.heights", "{ path = \"patches.h5\", dataset = \"/height\", unit = \"m\" }", Table)
        .what("file of the heights of all patches, in the place of drawn ones")
        .about(
            "Above the mean plane of the asperities, patch after patch. For patches of your own, such as correlated ones; the \
             integral and the cross-check remain by the law of `[surface]`.",
        )
        .follows("none; heights are drawn by the law of `[surface]`"),
    key("ensemble.heights.path", "\"heights.csv\"", Text).what("file of heights").about(FILE_PATH),
    key("ensemble.heights.column", "\"height\"", Various("a name, or a number from 1"))
        .what("column of the file")
        .about(FILE_COLUMN)
        .excludes(&["ensemble.heights.dataset"]),
    key("ensemble.heights.dataset", "\"/asperities/height\"", Text).what("dataset of the file").about(FILE_DATASET),
    key("ensemble.heights.unit", "\"nm\"", Various("a unit of length"))
        .what("unit of the file")
        .about(FILE_UNIT)
        .follows("the unit that is above the column; where there is none it has to be there"),
    key("ensemble.seed", "1", Whole(0, i64::MAX as u64))
        .what("seed of the random numbers")
        .about("A run with an equal seed gives equal bits.")
        .defaults_to("1"),
    key("ensemble.model_range", "false", Switch)
        .what("whether results are computed by every plastic contact where contacts yield")
        .about(
            "The range over them is the error of the model. A fifth of the replicas, and at most 64, by each of the others take at most the time of \
             the run again. Needs surfaces that are pulled back after contacts yielded, a law with `plastic_contact`, and three replicas or groups of them. \
             `stiction run --no-model-range` leaves it out.",
        )
        .defaults_to("true"),
    key("substrate", "{ coupling = \"periodic\" }", Table)
        .what("the elastic half-space that couples the asperities")
        .about("With it each run also has the curves of its asperities without coupling, and the differences.")
        .follows("none; asperities are independent"),
    key("substrate.coupling", "\"periodic\"", Choice(|| names(&COUPLINGS)))
        .what("what surrounds the surface")
        .about(
            "`none`: asperities are independent, as without the table, and its other keys are refused. `periodic`: the surface, a \
             square, is repeated without end, and h is the distance from the mean plane of the deformed surface. `patch`: the square is alone on a half-space, and h is the distance far away.",
        )
        .swept(),
    key("substrate.kernel", "\"contact\"", Choice(|| names(&KERNELS)))
        .what("how contacts act on each other")
        .about(
            "`point`: each as its force at a point. `contact`: each with the second moment of its pressure too, on a substrate that \
             the others have bent and tilted: the next orders in contact radius over distance. It takes some four times as long.",
        )
        .defaults_to("\"point\"")
        .swept(),
    key("substrate.positions", "\"uniform\"", Choice(|| names(&POSITIONS)))
        .what("places of the asperities")
        .about(
            "`hard_core`: at random, one after the other, no two closer than `minimum_distance`. `uniform`: at random. \
             `square`, `hexagonal`: on a lattice, which needs a number of asperities that fits. Measured asperities that \
             are taken whole have their own places, and the key is refused.",
        )
        .defaults_to("\"hard_core\""),
    key("substrate.minimum_distance", "\"0.18 um\"", Quantity(Of::Length, Positive))
        .what("least distance of asperities")
        .about("For `hard_core` positions only.")
        .follows("half of 1/√η")
        .swept(),
    key(
        "substrate.tolerance",
        "1e-9",
        Number(Included(*TOLERANCES_OF_LOADS.start()), Included(*TOLERANCES_OF_LOADS.end())),
    )
    .what("largest error of a load, relative to the largest load")
    .defaults_to("1e-9"),
    key("substrate.loads_at", "[2.0, \"3 nm\"]", Various("a list of numbers and lengths"))
        .what("separations at which the asperities are recorded one by one")
        .about(
            "h* as numbers, or h as lengths; each means the nearest separation. There the file has place, height, \
             interference, forces and state of every asperity of the first replica.",
        )
        .follows("nowhere"),
];

/// The keys behind those of forces.
static REST: &[Key] = &[
    key("instability", "{ stiffness = \"100 kN/m\" }", Table)
        .what("a spring that holds the surfaces, and where they snap")
        .follows("none; the separation is held"),
    key("instability.stiffness", "\"100 kN/m\"", OneOrMore(Of::Stiffness, NotNegative, &[PATCH]))
        .what("stiffness of the spring")
        .about(
            "0: load control. `patch`: E*L/0.946402, the stiffness of the half-space under a single square of \
             side L, with L² the nominal area.",
        )
        .follows("none, with `preload`; without a spring no snaps are looked for"),
    key("instability.preload", "\"10 mN\"", OneOrMore(Of::Force, Positive, &[]))
        .what("external force at which the approach ends")
        .about("Needs `history = \"loop\"` in `[model]`.")
        .follows("none; the smallest separation ends the approach"),
    key("instability.smallest_snap", "\"0.01 nm\"", Quantity(Of::Length, NotNegative))
        .what("least distance that counts as a snap")
        .defaults_to("0"),
    key("device", "{ restoring_force = \"1 uN\" }", Table)
        .what("the force that pulls the surfaces apart in the device")
        .about("With it a run gives the probability that the surfaces stay stuck: that the pull-off force is larger.")
        .follows("none; no probability"),
    key("device.restoring_force", "\"1 uN\"", Quantity(Of::Force, Positive))
        .what("restoring force")
        .about("Give it, or `stiffness` and `gap`. `stiction run --above \"1 uN\"` sets it.")
        .follows("from `stiffness` and `gap`")
        .excludes(&["device.stiffness", "device.gap"])
        .swept(),
    key("device.stiffness", "\"2 N/m\"", Quantity(Of::Stiffness, Positive))
        .what("stiffness of the suspension")
        .about("Needs `gap`; the restoring force is their product.")
        .follows("not used where `restoring_force` is given"),
    key("device.gap", "\"0.5 um\"", Quantity(Of::Length, Positive))
        .what("deflection of the suspension where the surfaces touch")
        .about("Needs `stiffness`.")
        .follows("not used where `restoring_force` is given"),
    key("solver", "{ summation = \"direct\" }", Table).what("how forces are summed").follows("what is faster"),
    key("solver.summation", "\"moments\"", Choice(|| names(&SUMS)))
        .formerly("sum")
        .what("way of summing")
        .about(
            "`direct`: asperity by asperity. `moments`: by moments of bins of heights, to a tolerance. `auto`: by \
             moments where the run is large enough to gain by it and a trial on four replicas meets the tolerance; \
             the summary says so.",
        )
        .defaults_to("\"auto\""),
    key(
        "solver.tolerance",
        "1e-9",
        Number(Included(*SUM_TOLERANCES.start()), Included(*SUM_TOLERANCES.end())),
    )
    .what("tolerance of sums by moments")
    .about("Relative to F_s + P.")
    .defaults_to("1e-9")
    .swept(),
    key("output", "{ curves = true }", Table).what("what is kept").follows("no curves of replicas"),
    key("output.curves", "true", Switch)
        .what("whether the curves of every replica are kept")
        .about("Means, scatter and the numbers of every replica are kept in any case.")
        .defaults_to("false"),
    key("sweep", "{ \"material.work_of_adhesion\" = [\"0.04 J/m^2\", \"0.09 J/m^2\"] }", Table)
        .what("keys with several values")
        .follows("none; one scene"),
    key("sweep.mode", "\"grid\"", Choice(|| names(&Mode::ALL)))
        .what("how several keys are combined")
        .about(
            "`grid`: every value with every other. `zip`: the first with the first, the second with the \
             second.",
        )
        .defaults_to("\"grid\""),
    key("sweep.common_random_numbers", "true", Switch)
        .what("whether all points share their random numbers")
        .about("Differences between points are then known much better than the points.")
        .defaults_to("true"),
    key("sweep.*.from", "", Various("a value of the key")).what("the first value"),
    key("sweep.*.to", "", Various("a value of the key")).what("the last value"),
    key("sweep.*.count", "7", Whole(2, MOST_POINTS as u64)).what("number of values"),
    key("sweep.*.spacing", "\"log\"", Choice(|| names(&SPACINGS)))
        .what("linear or logarithmic")
        .defaults_to("\"linear\""),
];
