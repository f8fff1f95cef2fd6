//! Scenes that are wrong: a line for each problem names the key, its line, what was given and what would do;
//! the exit code is 2 and nothing is written.

mod keys;

use crate::common::program::ASPERITIES;
use std::collections::BTreeSet;
use std::path::Path;
use std::process::Command;
use std::sync::Arc;
use stiction::asperity::{MODELS, Model, Plasticity};
use stiction::estimate::Plan;
use stiction::input::columns::SceneFiles;
use stiction::scene::{Absent, Document, KEYS, Key, Value};

const QUICK: &str = include_str!("../data/quick.toml");

/// What is replaced in the quick scene, by what, and what the message has to say.
const CASES: &[(&str, &str, &[&str])] = &[
    (
        "[ensemble]",
        "[van_der_waals]\nhamaker_constant = \"-1 zJ\"\nretarded = 1\nsmallest_gap = \"0 nm\"\ncap_share = 0\n[ensemble]",
        &[
            "`van_der_waals.hamaker_constant = \"-1 zJ\"`: has to be greater than 0",
            "`van_der_waals.retarded = 1`: true or false",
            "`van_der_waals.smallest_gap = \"0 nm\"`: has to be greater than 0",
            "`van_der_waals.cap_share = 0`: has to be greater than 0 and at most 1",
        ],
    ),
    (
        "[ensemble]",
        "[van_der_waals]\ncap_share = 1.01\nretardation_wavelength = \"100 nm\"\nhamaker = \"1e-19 J\"\n[ensemble]",
        &[
            "`van_der_waals.cap_share = 1.01`",
            "`van_der_waals.retardation_wavelength = \"100 nm\"`: needs retarded = true",
            "unknown key `van_der_waals.hamaker`; did you mean `hamaker_constant`?",
        ],
    ),
    (
        "[ensemble]",
        "[van_der_waals]\nsmallest_gap = \"0.4 nm\"\n[ensemble]",
        &["`van_der_waals.smallest_gap = \"0.4 nm\"`: is less than lubricant_thickness"],
    ),
    (
        "law = \"hybrid\"\nhistory = \"approach\"",
        "law = \"md\"\n[van_der_waals]\ncap_share = 0.5",
        &[
            "`van_der_waals.cap_share = 0.5`: is for laws whose attraction has no end",
            "md own the gaps below smallest_gap",
        ],
    ),
    (
        "[ensemble]",
        "[electrostatic]\ndielectric_thickness = \"100 nm\"\n[ensemble]",
        &[
            "`electrostatic.voltage` is missing",
            "`electrostatic.relative_permittivity` is missing; for example",
        ],
    ),
    (
        "[ensemble]",
        "[electrostatic]\nvoltage = \"1 V\"\nrelative_permittivity = [3.9, 0.9]\ndielectric_thickness = \"100 nm\"\n[ensemble]",
        &["`electrostatic.relative_permittivity[1] = 0.9`: has to be at least 1"],
    ),
    (
        "[ensemble]",
        "[electrostatic]\nvoltage = \"1 V\"\nrelative_permittivity = [3.9, 7]\ndielectric_thickness = \"100 nm\"\n[ensemble]",
        &["has 2 values, and dielectric_thickness 1; one for each dielectric is needed"],
    ),
    (
        "[ensemble]",
        "[electrostatic]\nvoltage = \"1 V\"\nrelative_permittivity = 3.9\n[ensemble]",
        &["`electrostatic.dielectric_thickness` is missing"],
    ),
    (
        "[ensemble]",
        "[electrostatic]\nvoltage = \"1 V\"\n[ensemble]",
        &[
            "`electrostatic.voltage = \"1 V\"`: bare electrodes touch",
            "a recess, or separations of more than h* = 10",
        ],
    ),
    // Liquids.
    (
        "law = \"hybrid\"",
        "law = \"capillary\"",
        &["`model.law = \"capillary\"`: needs a liquid: [capillary] with relative_humidity"],
    ),
    (
        "[output]",
        "[capillary]\nrelative_humidity = 0.5\ncontact_angles = [0, 0]\n[output]",
        &["the law hybrid knows no liquid; law = \"capillary\" does"],
    ),
    (
        "[output]",
        "[capillary]\nrelative_humidity = 1.0\ncontact_angles = [0, 0]\n[output]",
        &["greater than 0 and less than 1; this is 1"],
    ),
    (
        "[output]",
        "[capillary]\nrelative_humidity = 0.5\n[output]",
        &["`capillary.contact_angles` is missing; for example contact_angles = [\"30 deg\", \"30 deg\"]"],
    ),
    (
        "[output]",
        "[capillary]\nrelative_humidity = 0.5\ncontact_angles = \"30 deg\"\n[output]",
        &["a list of two is needed, one for each surface"],
    ),
    (
        "[output]",
        "[capillary]\nrelative_humidity = 0.5\ncontact_angles = [\"100 deg\", \"90 deg\"]\n[output]",
        &["between such surfaces no liquid condenses"],
    ),
    (
        "[output]",
        "[capillary]\nrelative_humidity = 0.5\ncontact_angles = [\"200 deg\", \"0 deg\"]\n[output]",
        &["from 0 to 180 deg"],
    ),
    (
        "[output]",
        "[capillary]\nrelative_humidity = 0.5\ncontact_angles = [0, 0]\ntemperature = \"-20 degC\"\n[output]",
        &["`capillary.temperature", "water is a liquid from 273.15 K"],
    ),
    (
        "[output]",
        "[capillary]\nrelative_humidity = 0.5\ncontact_angles = [0, 0]\ntemperature = 20\n[output]",
        &["the unit is missing; a temperature is needed, such as \"20 degC\" (K, degC)"],
    ),
    (
        "[output]",
        "[capillary]\nrelative_humidity = 0.5\ncontact_angles = [0, 0]\nliquid = \"oil\"\n[output]",
        &["unknown liquid; known: water"],
    ),
    (
        "[output]",
        "[capillary]\nrelative_humidity = 0.5\ncontact_angles = [0, 0]\nsurface_tension = \"20 mN/m\"\n[output]",
        &["`capillary.molar_volume` is missing"],
    ),
    (
        "[output]",
        "[capillary]\nfilm_thickness = \"1 nm\"\ncontact_angles = [0, 0]\n[output]",
        &["`capillary.film_thickness = \"1 nm\"`: a film needs hamaker_constant", "film_faces = 1 or 2"],
    ),
    (
        "[output]",
        "[capillary]\nfilm_thickness = \"1 nm\"\nrelative_humidity = 0.5\ncontact_angles = [0, 0]\n[output]",
        &["leave out relative_humidity, or this"],
    ),
    (
        "[output]",
        "[capillary]\nfilm_thickness = \"1 nm\"\nhamaker_constant = \"1e-19 J\"\ncontact_angles = [0, 0]\n[output]",
        &["`capillary.hamaker_constant", "film_faces = 1 or 2 says on how many surfaces"],
    ),
    (
        "[output]",
        "[capillary]\nrelative_humidity = 0.5\nfilm_faces = 2\ncontact_angles = [0, 0]\n[output]",
        &["`capillary.film_faces = 2`: films need hamaker_constant"],
    ),
    (
        "[output]",
        "[capillary]\nfilm_thickness = \"1 nm\"\nhamaker_constant = \"1e-19 J\"\nfilm_faces = 2\ncontact_angles = [0, \"20 deg\"]\n[output]",
        &["`capillary.contact_angles", "0 deg is the angle of each surface with one"],
    ),
    (
        "[output]",
        "[capillary]\nfilm_thickness = \"1 nm\"\nhamaker_constant = \"1e-19 J\"\nfilm_faces = 1\ncontact_angles = [0, 0]\nvolume = \"constant\"\n[output]",
        &["films feed their bridges; volume = \"equilibrium\" would do"],
    ),
    (
        "[output]",
        "[capillary]\nfilm_thickness = \"1 nm\"\nhamaker_constant = \"1e-19 J\"\nfilm_faces = 1\ncontact_angles = [0, 0]\nsurface_tension = \"25 mN/m\"\nmolar_volume = \"30 cm^3/mol\"\n[output]",
        &["`capillary.molar_volume", "has no meaning without relative_humidity"],
    ),
    (
        "[output]",
        "[capillary]\nrelative_humidity = 0.5\nhamaker_constant = \"1e-20 J\"\nfilm_faces = 2\ncontact_angles = [0, 0]\nfilm_drains = true\n[output]",
        &["`capillary.film_drains = true`: the vapour feeds films"],
    ),
    (
        "[output]",
        "[capillary]\nrelative_humidity = 0.5\ncontact_angles = [0, 0]\nvolume = \"constant\"\nbridges = \"reversible\"\n[output]",
        &["a reversible bridge has the volume in equilibrium"],
    ),
    (
        "[output]",
        "[substrate]\ncoupling = \"none\"\nkernel = \"point\"\ntolerance = 1e-9\n[output]",
        &[
            "`substrate.kernel = \"point\"`: does nothing with coupling = \"none\"; leave it out",
            "`substrate.tolerance = 1e-9`: does nothing",
        ],
    ),
    ("[material]", "[material", &["line 5", "not TOML"]),
    ("seed = 1", "seed = 1\nseed = 2", &["not TOML", "duplicate key"]),
    ("format = 1", "format = 7", &["line 2", "`format = 7`", "format 1"]),
    ("hardness =", "hardnes =", &["line 7", "unknown key `material.hardnes`", "did you mean `hardness`?"]),
    ("[ensemble]", "[ensembel]", &["unknown key `ensembel`", "did you mean `ensemble`?"]),
    (
        "[material]",
        "[material]\ncolour = 3",
        &["line 6", "unknown key `material.colour`", "known here: reduced_modulus"],
    ),
    ("hardness = \"2.5 GPa\"", "", &["`material.hardness` is missing; for example hardness = \"2.5 GPa\""]),
    (
        "equilibrium_spacing = \"0.2 nm\"",
        "equilibrium_spacing = 0.2",
        &["a length is needed, such as \"0.2 nm\" (m, cm, mm, um, nm, angstrom, pm)"],
    ),
    (
        "reduced_modulus =",
        "e_star =",
        &["did you mean `reduced_modulus`, 1/E* = (1 - nu1^2)/E1 + (1 - nu2^2)/E2 of the two bodies?"],
    ),
    (
        "reduced_modulus =",
        "young_modulus =",
        &["did you mean `youngs_modulus`, of both bodies, or of each in a list?"],
    ),
    (
        "[surface]",
        "[surface]\nheights = { law = \"file\", path = \"C:\\Users\\lab\\map.h5\", dataset = \"/z\", unit = \"m\" }",
        &[
            "not TOML",
            "a backslash begins another character; write / for it, or 'single quotes' around the path",
        ],
    ),
    (
        "[surface]",
        "[surface]\nheights = { law = \"file\", path = \"maps\\bump.csv\", column = 1, unit = \"m\" }",
        &["`surface.heights.path", "is no path", "a backslash begins another character; write / for it"],
    ),
    (
        "[material]",
        "[material]\nyoungs_modulus = [\"169 GPa\", \"70 GPa\"]",
        &["line 6: `material.youngs_modulus", "determines reduced_modulus too; give either"],
    ),
    (
        "poisson_ratio = 0.27",
        "poisson_ratio = [0.22, 0.27]",
        &[
            "two ratios are of two bodies with youngs_modulus; reduced_modulus needs that of the softer body alone",
        ],
    ),
    (
        "poisson_ratio = 0.27",
        "poissons_ratio = 0.27",
        &["`material.poissons_ratio` is now `material.poisson_ratio`"],
    ),
    (
        "reduced_modulus = \"85.29 GPa\"",
        "youngs_modulus = [\"169 GPa\", \"70 GPa\", \"1 GPa\"]",
        &["line 6: `material.youngs_modulus", "one value, or a list of two, one for each body, is needed"],
    ),
    (
        "[material]",
        "[material]\nsurface_energy = [\"50 mJ/m^2\", \"60 mJ/m^2\"]",
        &["line 6: `material.surface_energy", "determines work_of_adhesion too; give either"],
    ),
    (
        "work_of_adhesion = \"0.09 J/m^2\"",
        "surface_energy = [\"50 mJ/m^2\", \"60 mJ/m^2\"]\ninterface_energy = \"110 mJ/m^2\"",
        &["`material.interface_energy = \"110 mJ/m^2\"`: is not less than the sum of surface_energy"],
    ),
    ("work_of_adhesion =", "gamma =", &["unknown key `material.gamma`; did you mean `work_of_adhesion`"]),
    ("[surface]", "[surface]\nseed = 2", &["unknown key `surface.seed`; did you mean `ensemble.seed`?"]),
    ("law = \"hybrid\"", "law = \"JKR\"", &["unknown law (did you mean \"jkr\"?)"]),
    (
        "asperity_radius = \"3.33 um\"",
        "asperity_radius = \"3 GPa\"",
        &["line 13", "`surface.asperity_radius = \"3 GPa\"`", "that of a pressure", "a length is needed"],
    ),
    ("asperity_radius = \"3.33 um\"", "asperity_radius = \"3.33 parsec\"", &["unknown unit `parsec`", "nm"]),
    ("asperity_radius = \"3.33 um\"", "asperity_radius = 3.33", &["the unit is missing", "\"3.33 um\""]),
    ("asperity_radius = \"3.33 um\"", "asperity_radius = \"3.33\"", &["the unit is missing"]),
    ("asperity_radius = \"3.33 um\"", "asperity_radius = true", &["is a boolean", "a length is needed"]),
    ("asperity_radius = \"3.33 um\"", "asperity_radius = \"nan um\"", &["is not finite"]),
    ("asperity_radius = \"3.33 um\"", "asperity_radius = \"-1 um\"", &["has to be greater than 0"]),
    ("asperity_radius = \"3.33 um\"", "asperity_radius = \"large um\"", &["does not begin with a number"]),
    ("poisson_ratio = 0.27", "poisson_ratio = \"70 %\"", &["at most 0.5"]),
    ("poisson_ratio = 0.27", "poisson_ratio = \"27 % or so\"", &["is a string, a number is needed"]),
    ("lubricant_thickness = \"0.5 nm\"", "lubricant_thickness = \"-0.5 nm\"", &["must not be negative"]),
    (
        "surface_height_std = \"1.619 nm\"",
        "surface_height_std = \"0.1 pm\"",
        &["sigma_s^2", "negative", "surface_height_std"],
    ),
    ("surface_height_std = \"1.619 nm\"", "", &["neither surface_height_std nor asperity_height_std"]),
    ("nominal_area = \"100 um^2\"", "nominal_area = \"0.01 um^2\"", &["surface.nominal_area", "asperities"]),
    (
        "nominal_area = \"100 um^2\"",
        "nominal_area = \"1 m^2\"",
        &["surface.nominal_area", "at most 2e8", "m^2 would do"],
    ),
    ("{ from = -1.0, to = 8.0, count = 91 }", "[1.0]", &["has 1 separations", "2 to"]),
    ("{ from = -1.0, to = 8.0, count = 91 }", "[1.0, 3.0, 2.0]", &["separation.h_star[2] = 2.0", "rise"]),
    ("to = 8.0", "to = -2.0", &["greater than `from`"]),
    ("law = \"hybrid\"", "law = \"md_kin\"", &["unknown law", "did you mean \"md_kim\"?", "fit:paper"]),
    (
        "history = \"approach\"",
        "critical_approach = \"0.3 nm\"",
        &["line 21", "model.critical_approach", "the law hybrid finds its own", "only fit:paper takes it"],
    ),
    (
        "law = \"hybrid\"",
        "law = \"hybrid\"\nplastic_contact = \"jg\"",
        &[
            "line 21",
            "`model.plastic_contact = \"jg\"`",
            "the law hybrid has no contact to choose",
            "md_plastic",
        ],
    ),
    (
        "history = \"approach\"",
        "history = \"loop\"",
        &["line 21", "`model.history = \"loop\"`", "contacts of the run yield before the surfaces turn back"],
    ),
    ("replicas = 200", "replicas = -1", &["`ensemble.replicas = -1`", "from 0 to"]),
    (
        "replicas = 200",
        "replicas = 201\nsampling = \"antithetic\"",
        &["line 27", "`ensemble.replicas = 201`", "needs a multiple of 2 replicas, such as 200 or 202"],
    ),
    ("equilibrium_spacing = \"0.2 nm\"", "equilibrium_spacing = \"0.2 m\"", &["lambda", "outside 1e-6..1e6"]),
    (
        "[output]",
        "[solver]\nsummations = \"moments\"\n[output]",
        &["line 31", "unknown key `solver.summations`", "did you mean `summation`?"],
    ),
    (
        "[output]",
        "[solver]\nsum = \"compressed\"\n[output]",
        &["line 31", "`solver.sum` is now `solver.summation`; for example summation = \"moments\""],
    ),
    (
        "[output]",
        "[solver]\nsummation = \"compressed\"\n[output]",
        &["line 31", "unknown summation, which is now \"moments\""],
    ),
    (
        "law = \"hybrid\"",
        "law = \"fit:refit\"",
        &["unknown law, which has gone: fit:paper has the published fits, hybrid solves"],
    ),
    (
        "poisson_ratio = 0.27",
        "poisson_ratio = 0,27",
        &["line 8", "`poisson_ratio = 0,27` has a decimal comma; a point is needed"],
    ),
    (
        "poisson_ratio = 0.27",
        "poisson_ratio = \"0,27\"",
        &["line 8", "has a decimal comma", "no quotation marks"],
    ),
    (
        "replicas = 200",
        "replicas = 200\ntarget = { quantity = \"force\", relative_standard_error = 2 }\nsampling = \"layered\"",
        &[
            "line 27: `ensemble.replicas = 200`: with a target",
            "line 28: `ensemble.target.quantity = \"force\"`: unknown quantity",
            "line 28: `ensemble.target.relative_standard_error = 2`: a relative standard error",
            "line 29: `ensemble.sampling = \"layered\"`: unknown sampling",
        ],
    ),
    ("history = \"approach\"", "path = \"approach\"", &["line 21", "`model.path` is now `model.history`"]),
    (
        "[output]",
        "[solver]\nsummation = \"direct\"\ntolerance = 1e-9\n[output]",
        &["line 32", "`solver.tolerance = 1e-9`", "direct sums have no tolerance"],
    ),
    (
        "[output]",
        "[solver]\nsummation = \"moments\"\ntolerance = 0\n[output]",
        &["line 32", "`solver.tolerance = 0`", "between 1e-13 and 1e-3"],
    ),
    ("[output]", "solver = 3\n[output]", &["`ensemble.solver`"]),
    (
        "h_star = {",
        "stiffness_span = \"15 nm\"\nh_star = {",
        &["line 24", "`separation.stiffness_span = \"15 nm\"`", "reach over 14.571 nm", "within them"],
    ),
    (
        "[output]",
        "[instability]\n[output]",
        &["`instability.stiffness` is missing", "stiffness = \"100 kN/m\""],
    ),
    (
        "[output]",
        "[instability]\nstiffness = [\"5 N/m\", \"5 nm\"]\n[output]",
        &["line 31", "`instability.stiffness[1] = \"5 nm\"`", "that of a length"],
    ),
    (
        "[output]",
        "[instability]\nstiffness = [0, \"path\"]\n[output]",
        &["`instability.stiffness[1] = \"path\"`", "such as \"100 kN/m\" or \"patch\" (N/m"],
    ),
    (
        "[output]",
        "[instability]\nstiffness = []\n[output]",
        &["`instability.stiffness = []`", "has 0 values"],
    ),
    (
        "[output]",
        "[instability]\nstiffness = 0\npreload = \"1 mN\"\n[output]",
        &["line 32", "`instability.preload = \"1 mN\"`", "history = \"loop\""],
    ),
    (
        "history = \"approach\"",
        "history = \"loop\"\n[instability]\nstiffness = 0\npreload = [\"0 N\"]",
        &["line 24", "`instability.preload[0] = \"0 N\"`", "greater than 0"],
    ),
    ("format = 1", "format = 1\nsolver = 3", &["line 3", "`solver = 3`", "a table [solver] is needed"]),
];

#[test]
fn every_mistake_is_named_and_nothing_is_written() {
    for (from, to, messages) in CASES {
        assert_eq!(QUICK.matches(from).count(), 1, "{from} is not unique in the quick scene");
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("scene.toml"), QUICK.replace(from, to)).unwrap();
        for command in ["run", "check"] {
            let output = Command::new(env!("CARGO_BIN_EXE_stiction"))
                .args([command, "scene.toml"])
                .current_dir(folder.path())
                .output()
                .unwrap();
            let error = String::from_utf8_lossy(&output.stderr).into_owned();
            assert_eq!(output.status.code(), Some(2), "{from} -> {to}: {error}");
            for message in *messages {
                assert!(error.contains(message), "{from} -> {to}: no \"{message}\" in\n{error}");
            }
            assert!(error.starts_with("stiction: scene.toml: "), "{error}");
            assert_eq!(
                std::fs::read_dir(folder.path()).unwrap().count(),
                1,
                "{from} -> {to}: something was written"
            );
        }
    }
}

/// All problems are reported at once, a line each, in the order of the lines; a misspelt key is not missing too,
/// and nothing follows from what could not be read.
#[test]
fn all_problems_are_reported_at_once() {
    let changes = [
        ("hardness = \"2.5 GPa\"", "hardnes = \"2.5 GPa\""),
        ("poisson_ratio = 0.27", "poisson_ratio = 0.7"),
        ("work_of_adhesion = \"0.09 J/m^2\"\n", ""),
        ("asperity_radius = \"3.33 um\"", "asperity_radius = \"3,33 um\""),
        ("asperity_density = \"7.39 /um^2\"", "asperity_density = \"7.39 um\""),
        ("\"hybrid\"", "\"Hybrid\""),
        ("count = 91", "count = 1"),
        ("seed = 1", "seed = 1.5"),
        ("curves = false", "curves = 0\ncurve = true"),
    ];
    let scene = changes.iter().fold(QUICK.to_owned(), |scene, (from, to)| {
        assert!(scene.contains(from), "{from}");
        scene.replace(from, to)
    });
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("scene.toml"), scene).unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_stiction"));
    let output = command.args(["run", "scene.toml"]).current_dir(folder.path()).output().unwrap();
    let message = String::from_utf8(output.stderr).unwrap();
    let lines: Vec<&str> = message.lines().collect();
    let expected = [
        "stiction: scene.toml: 10 problems",
        "  line 7: unknown key `material.hardnes`; did you mean `hardness`?",
        "  line 8: `material.poisson_ratio = 0.7`: a Poisson ratio",
        "  line 12: `surface.asperity_radius = \"3,33 um\"`: has a decimal comma",
        "  line 13: `surface.asperity_density = \"7.39 um\"`: the unit is that of a length",
        "  line 19: `model.law = \"Hybrid\"`: unknown law (did you mean \"hybrid\"?)",
        "  line 23: `separation.h_star.count = 1`: a whole number from 2",
        "  line 27: `ensemble.seed = 1.5`: a whole number",
        "  line 30: `output.curves = 0`: true or false",
        "  line 31: unknown key `output.curve`; did you mean `curves`?",
        "  `material.work_of_adhesion` is missing; for example work_of_adhesion = \"0.09 J/m^2\"",
    ];
    assert_eq!(lines.len(), expected.len(), "{message}");
    lines
        .iter()
        .zip(expected)
        .for_each(|(line, expected)| assert!(line.starts_with(expected), "{line}\n{expected}"));
}

/// Many problems are reported up to a number.
#[test]
fn endless_problems_end() {
    let folder = tempfile::tempdir().unwrap();
    let many: String = (0..1000).map(|i| format!("colour{i} = 1\n")).collect();
    std::fs::write(folder.path().join("scene.toml"), QUICK.replace("[output]", &format!("[output]\n{many}")))
        .unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_stiction"));
    let output = command.args(["check", "scene.toml"]).current_dir(folder.path()).output().unwrap();
    let message = String::from_utf8(output.stderr).unwrap();
    assert_eq!(message.lines().count(), 22, "{message}");
    assert!(message.ends_with("  [...] there are more problems\n"), "{message}");
}

/// The keys of a scene that the others of [`variants`] change.
const PLAIN: [&str; 19] = [
    "format",
    "title",
    "material.reduced_modulus",
    "material.hardness",
    "material.poisson_ratio",
    "material.work_of_adhesion",
    "material.equilibrium_spacing",
    "surface.asperity_radius",
    "surface.asperity_density",
    "surface.surface_height_std",
    "surface.nominal_area",
    "surface.lubricant_thickness",
    "model.law",
    "model.history",
    "separation.h_star",
    "separation.stiffness_span",
    "ensemble.replicas",
    "ensemble.seed",
    "output.curves",
];

/// What is taken away from the plain scene, added to it with the key's own example, and added with a value
/// that the others need.
type Variant = (&'static [&'static str], &'static [&'static str], &'static [(&'static str, &'static str)]);

const OF_SPECTRUM: &[&str] =
    &["surface.asperity_radius", "surface.asperity_density", "surface.surface_height_std"];

const VARIANTS: &[Variant] = &[
    (&["surface.nominal_area"], &["shape.body", "shape.radius"], &[]),
    (&["surface.nominal_area"], &["shape.radii"], &[("shape.body", "\"paraboloid\"")]),
    (&["surface.nominal_area"], &["shape.radius", "shape.length"], &[("shape.body", "\"cylinder\"")]),
    (&["surface.nominal_area"], &["shape.flat_radius", "shape.edge_radius"], &[("shape.body", "\"punch\"")]),
    (&["surface.nominal_area"], &["shape.side", "shape.angle"], &[("shape.body", "\"tilted\"")]),
    (&[], &["solver.summation", "solver.tolerance", "ensemble.sampling"], &[]),
    (&[], &["substrate.coupling", "substrate.positions", "substrate.tolerance", "substrate.loads_at"], &[]),
    (&[], &["model.plastic_contact", "ensemble.model_range"], &[("model.law", "\"md_plastic\"")]),
    (&[], &["substrate.coupling", "substrate.kernel"], &[]),
    (&[], &["substrate.coupling", "substrate.minimum_distance"], &[]),
    (
        &["surface.surface_height_std", "separation.h_star", "ensemble.replicas"],
        &[
            "surface.asperity_height_std",
            "surface.mean_plane_offset",
            "separation.h",
            "ensemble.target",
            "ensemble.min_replicas",
            "ensemble.max_replicas",
        ],
        &[("surface.surface_height_std", "\"1.7 nm\"")],
    ),
    (
        &["material.reduced_modulus", "material.work_of_adhesion"],
        &["material.youngs_modulus", "material.surface_energy", "material.interface_energy"],
        &[],
    ),
    (&[], &["surface.heights", "surface.radii", "surface.count"], &[]),
    (
        &[],
        &[
            "surface.heights.law",
            "surface.heights.shape",
            "surface.radii.law",
            "surface.radii.coefficient_of_variation",
        ],
        &[],
    ),
    (&[], &["surface.heights.lower", "surface.heights.upper"], &[("surface.heights.law", "\"truncated\"")]),
    (
        &["surface.asperity_radius"],
        &[
            "surface.heights.path",
            "surface.heights.column",
            "surface.heights.unit",
            "surface.radii.path",
            "surface.radii.column",
            "surface.radii.unit",
        ],
        &[("surface.heights.law", "\"file\""), ("surface.radii.law", "\"file\"")],
    ),
    (
        &["surface.asperity_radius"],
        &["surface.heights.dataset", "surface.radii.dataset"],
        &[
            ("surface.heights.law", "\"file\""),
            ("surface.heights.path", "\"asperities.h5\""),
            ("surface.heights.unit", "\"m\""),
            ("surface.radii.law", "\"file\""),
            ("surface.radii.path", "\"asperities.h5\""),
            ("surface.radii.unit", "\"m\""),
        ],
    ),
    (&[], &["surface.summits"], &[]),
    (
        &["model.law"],
        &[
            "capillary.relative_humidity",
            "capillary.liquid",
            "capillary.temperature",
            "capillary.contact_angles",
            "capillary.volume",
            "capillary.bridges",
        ],
        &[("model.law", "\"capillary\"")],
    ),
    (
        &["model.law"],
        &[
            "capillary.relative_humidity",
            "capillary.surface_tension",
            "capillary.molar_volume",
            "capillary.contact_angles",
        ],
        &[("model.law", "\"capillary\"")],
    ),
    (
        &["model.law"],
        &[
            "capillary.film_thickness",
            "capillary.hamaker_constant",
            "capillary.film_faces",
            "capillary.film_drains",
            "capillary.surface_tension",
        ],
        &[("model.law", "\"capillary\""), ("capillary.contact_angles", "[0, 0]")],
    ),
    (OF_SPECTRUM, &["surface.spectrum"], &[]),
    (OF_SPECTRUM, &["surface.spectrum.m0", "surface.spectrum.m2", "surface.spectrum.m4"], &[]),
    (OF_SPECTRUM, &["surface.asperities"], &[]),
    (
        OF_SPECTRUM,
        &["surface.asperities.path", "surface.asperities.sample", "surface.asperities.radius"],
        &[],
    ),
    (&["model.law"], &["model.critical_approach"], &[("model.law", "\"fit:paper\"")]),
    (
        &[],
        &[
            "van_der_waals.hamaker_constant",
            "van_der_waals.retarded",
            "van_der_waals.cap_share",
            "electrostatic.voltage",
            "electrostatic.contact_potential",
            "electrostatic.dielectric_thickness",
            "electrostatic.relative_permittivity",
            "electrostatic.recess",
        ],
        &[],
    ),
    (
        &["surface.lubricant_thickness"],
        &["van_der_waals.retarded", "van_der_waals.retardation_wavelength", "van_der_waals.smallest_gap"],
        &[],
    ),
    (&["separation.h_star"], &["separation.h.from", "separation.h.to", "separation.h.count"], &[]),
    (
        &["separation.h_star"],
        &["separation.h_star.from", "separation.h_star.to", "separation.h_star.count"],
        &[],
    ),
    (
        &["ensemble.replicas"],
        &["ensemble.target.quantity", "ensemble.target.relative_standard_error", "ensemble.target.estimate"],
        &[],
    ),
    (&["ensemble.replicas"], &["ensemble.target.quantity", "ensemble.target.standard_error"], &[]),
    (
        &["surface.nominal_area", "ensemble.replicas"],
        &["ensemble.heights.path", "ensemble.heights.column", "ensemble.heights.unit"],
        &[("surface.nominal_area", "\"0.1353 um^2\""), ("ensemble.replicas", "4")],
    ),
    (
        &["surface.nominal_area", "ensemble.replicas"],
        &["ensemble.heights.dataset"],
        &[
            ("surface.nominal_area", "\"0.1353 um^2\""),
            ("ensemble.replicas", "4"),
            ("ensemble.heights.path", "\"asperities.h5\""),
            ("ensemble.heights.unit", "\"m\""),
        ],
    ),
    (
        &["model.law", "model.history"],
        &["separation.cycles", "instability.stiffness", "instability.preload", "instability.smallest_snap"],
        &[("model.law", "\"md_plastic\""), ("model.history", "\"loop\"")],
    ),
    (&[], &["device.restoring_force"], &[]),
    (&[], &["device.stiffness", "device.gap"], &[]),
    (&[], &["sweep"], &[]),
    (
        &[],
        &["sweep.mode", "sweep.common_random_numbers", "sweep.*.count", "sweep.*.spacing"],
        &[("sweep.*.from", "\"0.1 GPa\""), ("sweep.*.to", "\"10 GPa\"")],
    ),
];

fn example(key: &str) -> &'static str {
    KEYS.iter().find(|known| known.name == key).unwrap_or_else(|| panic!("no key {key}")).example
}

/// The scene of a variant.
fn scene_of((without, with, given): &Variant) -> String {
    let plain =
        PLAIN.iter().filter(|key| !without.contains(key) && !given.iter().any(|(name, _)| name == *key));
    let examples = plain.chain(with.iter()).map(|key| (*key, example(key)));
    let values: Vec<(String, &str)> = examples
        .chain(given.iter().copied())
        .map(|(key, value)| (key.replace("sweep.*", "sweep.material.hardness"), value))
        .collect();
    values.iter().map(|(key, value)| format!("{key} = {value}\n")).collect()
}

/// The line of a key in the text of a scene.
fn line<'t>(text: &'t str, key: &Key) -> Option<&'t str> {
    let begin = format!("{} = ", key.name.replace("sweep.*", "sweep.material.hardness"));
    text.split_inclusive('\n').find(|line| line.starts_with(&begin))
}

/// The plain scene, all variants, and for each key that none of these has a scene that has it, with what its table needs.
fn texts() -> Vec<String> {
    let plain: Variant = (&[], &[], &[]);
    let mut texts: Vec<String> =
        std::iter::once(plain).chain(VARIANTS.iter().copied()).map(|v| scene_of(&v)).collect();
    for key in KEYS.iter().filter(|key| !matches!(key.value, Value::Table) && !key.name.contains(['[', '*']))
    {
        if texts.iter().any(|text| line(text, key).is_some()) {
            continue;
        }
        let table = format!("{}.", key.name.split_once('.').unwrap_or_default().0);
        let has_table = |text: &&String| text.lines().any(|line| line.starts_with(&table));
        let base = texts.iter().find(has_table).unwrap_or(&texts[0]).clone();
        let is_needed = |own: &&&Key| {
            own.name.starts_with(&table)
                && (own.name == key.name || matches!(own.absent, Absent::Required))
                && !own.name.contains('[')
                && line(&base, own).is_none()
        };
        let more = KEYS.iter().filter(is_needed).map(|own| format!("{} = {}\n", own.name, own.example));
        texts.push(more.fold(base.clone(), |text, line| text + &line));
    }
    texts
}

fn stiction(folder: &Path, arguments: &[&str]) -> String {
    let mut command = Command::new(env!("CARGO_BIN_EXE_stiction"));
    let output = command.args(arguments).current_dir(folder).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

/// A folder with the files that examples name.
fn files() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::copy(ASPERITIES, folder.path().join("asperities.h5")).unwrap();
    std::fs::write(folder.path().join("heights.csv"), "height\n1.5\n-0.5\n0.2\n-1.2\n").unwrap();
    std::fs::write(folder.path().join("radii.csv"), "radius\n3.1\n2.9\n3.4\n3.0\n").unwrap();
    folder
}

/// Every key has an example that does in a scene; where it says "is missing" or "such as", that is the
/// example. Those of the keys that every scene has are a scene of sensible size.
#[test]
fn examples_of_all_keys_are_scenes() {
    let folder = files();
    let path = folder.path().join("scene.toml");
    let read = |text: &str| {
        Document::parse(text, Arc::new(SceneFiles::scene(&path))).unwrap_or_else(|e| panic!("{e}\n{text}"))
    };
    let texts = texts();
    let is_used = |key: &&&Key| texts.iter().any(|text| line(text, key).is_some());
    let mut used: BTreeSet<&str> = KEYS.iter().filter(is_used).map(|key| key.name).collect();
    for text in &texts {
        let scene = read(text).scene;
        if scene.critical_approach.is_none() {
            let plan = Plan::new(&scene, scene.law().unwrap().view());
            assert!(plan.pairs > 0.0, "{}", scene.text);
        }
    }
    for (key, list, more) in
        [("separation.h", "separation.h[]", "\"9 nm\""), ("separation.h_star", "separation.h_star[]", "8.0")]
    {
        let plain: String = PLAIN
            .iter()
            .filter(|key| !key.starts_with("separation"))
            .map(|key| format!("{key} = {}\n", example(key)))
            .collect();
        read(&format!("{plain}{key} = [{}, {more}]\n", example(list)));
        used.insert(list);
    }
    // Elements of lists have their example in that of the list.
    let keys = KEYS.iter().filter(|key| !matches!(key.value, Value::Table));
    let unused: Vec<&str> = keys.map(|key| key.name).filter(|name| !used.contains(name)).collect();
    assert!(unused.iter().all(|name| name.ends_with("[]")), "{unused:?}");
    std::fs::write(&path, scene_of(&(&[], &[], &[]))).unwrap();
    let summary = stiction(folder.path(), &["run", "scene.toml", "--quiet"]);
    assert!(summary.contains("verdict") || summary.contains("agree"), "{summary}");
}

#[test]
fn a_missing_scene_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let output = Command::new(env!("CARGO_BIN_EXE_stiction"))
        .args(["run", "absent.toml"])
        .current_dir(folder.path())
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("absent.toml: cannot be read"));
}

/// Whether the quick scene with something replaced is a scene.
fn is_scene(from: &str, to: &str) -> bool {
    assert!(QUICK.contains(from), "{from}");
    Document::parse(&QUICK.replace(from, to), Arc::new(SceneFiles::scene(Path::new("scene.toml")))).is_ok()
}

/// Whole numbers may be written as large ones are, and shares in per cent.
#[test]
fn numbers_are_written_as_people_write_them() {
    assert!(is_scene("replicas = 200", "replicas = 2e2") && is_scene("replicas = 200", "replicas = 200.0"));
    assert!(
        !is_scene("replicas = 200", "replicas = 2.5e0") && !is_scene("replicas = 200", "replicas = 1e300")
    );
    assert!(is_scene("poisson_ratio = 0.27", "poisson_ratio = \"27 %\""));
    for area in ["5e-7 cm^2", "50 µm²", "50 μm**2", "50 um2", "5e9 \u{212b}^2"] {
        let is_known = area.contains('m');
        assert_eq!(
            is_scene("nominal_area = \"100 um^2\"", &format!("nominal_area = \"{area}\"")),
            is_known,
            "{area}"
        );
    }
}

/// Surfaces are not pulled back by laws of loading alone where summits flow; the message has the contact that is nearest.
#[test]
fn laws_of_loading_do_not_pull_back_what_has_yielded() {
    let laws = [
        ("hybrid", "ke"),
        ("fit:paper", "ke"),
        ("isbl", "ke"),
        ("sbl", "ke"),
        ("ke", "ke"),
        ("ceb", "ke"),
        ("zmc", "zmc"),
        ("jg", "jg"),
        ("tn", "tn"),
    ];
    let is_of_loading = |law: &&Model| matches!(law.validity.plasticity, Plasticity::Loading(_));
    assert_eq!(MODELS.iter().filter(is_of_loading).count(), laws.len());
    for (law, contact) in laws {
        for history in ["loop", "retraction"] {
            let read = |hardness: &str| {
                let scene = QUICK.replace("2.5 GPa", hardness).replace("\"hybrid\"", &format!("\"{law}\""));
                let scene = scene.replace("\"approach\"", &format!("\"{history}\""));
                Document::parse(&scene, Arc::new(SceneFiles::scene(Path::new("scene.toml"))))
            };
            let refused = read("2.5 GPa").map(drop).expect_err("tops flow").to_string();
            for part in [
                &format!("`model.history = \"{history}\"`"),
                &format!("the law {law} is one of loading alone"),
                "model.law = \"md_plastic\"",
                &format!("model.plastic_contact = \"{contact}\""),
            ] {
                assert!(refused.contains(part), "{law}: no {part} in {refused}");
            }
            assert!(read("100 GPa").is_ok(), "{law} on {history}: none flows");
        }
    }
}

/// Limits belong to what is allowed; the next number beyond does not.
#[test]
fn limits_are_within() {
    let separations = "h_star = { from = -1.0, to = 8.0, count = 91 }";
    let list =
        |count: u32| (0..count).map(|i| format!("{}.0", f64::from(i) / 1e3)).collect::<Vec<_>>().join(", ");
    let list = |count: u32| format!("h_star = [{}]", list(count).replace(".0,", ",").trim_end_matches(".0"));
    assert!(is_scene(separations, &list(10_000)) && !is_scene(separations, &list(10_001)));
    let even = |count: u32| format!("h_star = {{ from = -1.0, to = 8.0, count = {count} }}");
    assert!([2, 10_000].into_iter().all(|count| is_scene(separations, &even(count))));
    assert!([1, 10_001].into_iter().all(|count| !is_scene(separations, &even(count))));
    let span = |span: f64| {
        is_scene(separations, &format!("h = [\"0 m\", \"8e-9 m\"]\nstiffness_span = \"{span:e} m\""))
    };
    assert!(span(8e-9) && !span(8e-9_f64.next_up()));
    let far = |h: &str| is_scene(separations, &format!("h = [\"0 m\", \"{h} m\"]"));
    assert!(!far("1e155") && !far("1e200"));
    // A million roundings of the largest separation: 8e-9 · 1e6 · 2⁻⁵².
    let least = 8e-9 * 1e6 / 2.0_f64.powi(52);
    assert!(span(least * (1.0 + 1e-15)) && !span(least * (1.0 - 1e-15)));
    let ratio = |ratio: f64| is_scene("poisson_ratio = 0.27", &format!("poisson_ratio = {ratio:?}"));
    assert!(ratio(0.5) && !ratio(0.5_f64.next_up()));
    let slope = |m2: &str| {
        let others = [
            "asperity_radius = \"3.33 um\"\n",
            "asperity_density = \"7.39 /um^2\"\n",
            "surface_height_std = \"1.619 nm\"\n",
        ];
        let text = others.iter().fold(QUICK.to_owned(), |text, other| text.replace(other, ""));
        let spectrum =
            format!("[surface]\nspectrum = {{ m0 = \"2.373e-18 m^2\", m2 = {m2}, m4 = \"1.4584e10 /m^2\" }}");
        Document::parse(
            &text.replace("[surface]", &spectrum),
            Arc::new(SceneFiles::scene(Path::new("scene.toml"))),
        )
        .map_err(|error| error.to_string())
    };
    assert!(slope("6.2595e-5").is_ok());
    assert!(
        ["0.0", "-6.2595e-5"].into_iter().all(|m2| slope(m2).is_err_and(|e| e.contains("greater than 0")))
    );
    let law = |key: &str, law: &str, parameter: &str, value: f64| {
        let entry = format!("[surface]\n{key} = {{ law = \"{law}\", {parameter} = {value:?} }}");
        is_scene("[surface]", &entry)
    };
    for (key, name, parameter, [low, high]) in [
        ("heights", "weibull", "shape", [1.0, 20.0]),
        ("heights", "lognormal", "shape", [0.01, 1.5]),
        ("radii", "lognormal", "coefficient_of_variation", [0.001, 1.0]),
        ("radii", "gamma", "coefficient_of_variation", [0.001, 1.0]),
    ] {
        assert!(law(key, name, parameter, low) && law(key, name, parameter, high), "{name}");
        assert!(!law(key, name, parameter, f64::next_down(low)), "{name}");
        assert!(!law(key, name, parameter, f64::next_up(high)), "{name}");
    }
}

/// Replicas that depend on each other, asperity by asperity, have to have as many; those of all surfaces that do are drawn
/// by each scheme.
#[test]
fn schemes_are_for_surfaces_of_a_fixed_number() {
    for (surface, is_fixed) in [
        ("", true),
        ("heights = \"gaussian\"\nradii = \"common\"\ncount = \"fixed\"", true),
        ("heights = \"exponential\"", true),
        ("heights = { law = \"truncated\", upper = 2.0 }", true),
        ("radii = { law = \"gamma\", coefficient_of_variation = 0.2 }", true),
        ("count = \"poisson\"", false),
        ("summits = \"nayak\"", true),
    ] {
        for (sampling, is_for_all) in [("independent", true), ("antithetic", false), ("stratified", false)] {
            let text = QUICK.replace("[surface]", &format!("[surface]\n{surface}"));
            let text = text.replace("seed = 1", &format!("seed = 1\nsampling = \"{sampling}\""));
            let read = Document::parse(&text, Arc::new(SceneFiles::scene(Path::new("scene.toml"))));
            assert_eq!(read.is_ok(), is_fixed || is_for_all, "{surface} {sampling}");
            let problem = read.err().map(|error| error.to_string()).unwrap_or_default();
            let named = problem.contains("`ensemble.sampling") && problem.contains("count = \"poisson\"");
            assert!(problem.is_empty() || named, "{problem}");
        }
    }
}
