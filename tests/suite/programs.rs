//! The program as other programs drive it: settings, standard input, progress and tables that are read by
//! machines, commands that are programs of their own.

use crate::common::program::{ASPERITIES, Folder, assert_exit, attribute, bits, small, text, with_result};
use crate::common::unlocked;
use serde_json::Value;
use std::io::Write;
use std::process::{Command, Output, Stdio};
use std::sync::LazyLock;

/// Runs the program in a folder with a text on standard input.
fn given(folder: &Folder, arguments: &[&str], input: &str) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_stiction"));
    command.args(arguments).current_dir(folder.path(""));
    let mut child =
        command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    // One that is refused by its arguments reads nothing.
    let _ = child.stdin.take().unwrap().write_all(input.as_bytes());
    child.wait_with_output().unwrap()
}

/// A scene with settings is the scene with these values in it: bits and the text in the file; partial
/// results hold to it.
#[test]
fn settings_are_edits_of_the_scene() {
    let folder = Folder::new(&small());
    let edited = small()
        .replace("work_of_adhesion = \"0.09 J/m^2\"", "work_of_adhesion = \"0.1 J/m^2\"")
        .replace("seed = 1", "seed = 7");
    assert_ne!(edited, small());
    std::fs::write(folder.path("edited.toml"), &edited).unwrap();
    assert_exit(&folder.stiction(&["run", "edited.toml", "--quiet"]), 0);
    let settings = ["--set", "material.work_of_adhesion=0.1 J/m^2", "--set=ensemble.seed=7", "--quiet"];
    let run = [&["run", "scene.toml", "-o", "set.h5"], &settings[..]].concat();
    assert_exit(&folder.stiction(&run), 0);
    assert_eq!(bits(&folder.path("set.h5")), bits(&folder.path("edited.h5")));
    assert_eq!(attribute(&folder.path("set.h5"), "/", "scene"), edited);
    let [plain, set] = [&["check", "edited.toml"][..], &[&["check", "scene.toml"], &settings[..3]].concat()]
        .map(|command| text(&folder.stiction(command).stdout));
    assert_eq!(plain, set);
    // The same run is complete, another setting is another run.
    let again = folder.stiction(&[&run[..], &["--resume"]].concat());
    assert_exit(&again, 0);
    assert!(text(&again.stderr).contains("nothing to resume"), "{}", text(&again.stderr));
    let other = folder.stiction(&["run", "scene.toml", "-o", "set.h5", "--resume", "--quiet"]);
    assert_exit(&other, 2);
    let compared = |scene: &str, settings: &[&str]| {
        let command = [&["compare", scene, "--laws", "emd", "--quiet"], settings].concat();
        text(&folder.stiction(&command).stdout)
    };
    assert_eq!(compared("scene.toml", &settings[..3]), compared("edited.toml", &[]));
}

/// A sweep takes settings of its keys, quoted or not, and of what all its points have.
#[test]
fn sweeps_take_settings() {
    let sweep = small().replace("replicas = 40", "replicas = 8")
        + "\n[sweep]\nsurface.surface_height_std = [\"1.4 nm\", \"1.8 nm\"]\n";
    let folder = Folder::new(&sweep);
    let edited = sweep.replace("\"1.4 nm\"", "\"1.5 nm\"").replace("\"0.5 nm\"", "\"0.4 nm\"");
    std::fs::write(folder.path("edited.toml"), &edited).unwrap();
    assert_exit(&folder.stiction(&["run", "edited.toml", "--quiet"]), 0);
    for (i, key) in
        ["sweep.surface.surface_height_std", "sweep.\"surface.surface_height_std\""].into_iter().enumerate()
    {
        let values = format!("{key}=[\"1.5 nm\", \"1.8 nm\"]");
        let output = format!("{i}.h5");
        let run =
            ["run", "scene.toml", "--set", &values, "--set", "surface.lubricant_thickness=0.4 nm", "--quiet"];
        assert_exit(&folder.stiction(&[&run[..], &["-o", &output]].concat()), 0);
        assert_eq!(bits(&folder.path(&output)), bits(&folder.path("edited.h5")), "{key}");
    }
}

#[test]
fn a_scene_from_standard_input_is_that_of_a_file() {
    let folder = with_result();
    let run = given(&folder, &["run", "-", "-o", "piped.h5", "--quiet"], &small());
    assert_exit(&run, 0);
    assert_eq!(bits(&folder.path("piped.h5")), bits(&folder.path("scene.h5")));
    assert_eq!(attribute(&folder.path("piped.h5"), "/", "scene"), small());
    let again = given(&folder, &["run", "-", "-o", "piped.h5", "--resume"], &small());
    assert!(text(&again.stderr).contains("nothing to resume"), "{}", text(&again.stderr));
    let check = given(&folder, &["check", "-"], &small());
    assert_eq!(text(&check.stdout), text(&folder.stiction(&["check", "scene.toml"]).stdout));
    // Files that it names are in the current folder.
    std::fs::write(folder.path("heights.csv"), "height\n-1\n0\n1\n2\n-2\n0.5\n-0.5\n").unwrap();
    let heights =
        "[surface]\nheights = { law = \"file\", path = \"heights.csv\", column = \"height\", unit = \"nm\" }";
    let with_file = small().replace("[surface]", heights).replace("surface_height_std = \"1.619 nm\"\n", "");
    assert_exit(&given(&folder, &["check", "-"], &with_file), 0);

    for (arguments, input, message) in [
        (&["run", "-"][..], &small()[..], "standard input has no name for its result; name one with -o"),
        (&["run", "-", "-o", "x.h5"], "format = ", "standard input: line 1: not TOML"),
        (&["run", "-", "-o", "x.h5"], "", "standard input: "),
    ] {
        let refused = given(&folder, arguments, input);
        assert_exit(&refused, 2);
        assert!(text(&refused.stderr).contains(message), "{arguments:?}: {}", text(&refused.stderr));
    }
    assert_eq!(folder.files(), ["heights.csv", "piped.h5", "scene.h5", "scene.toml"]);
}

/// What is wrong with a setting is reported by its name, and what is wrong with the scene by its own line.
#[test]
fn bad_settings_are_named() {
    let folder = Folder::new(&small());
    let cases = [
        ("material.work_of_adhesion", "KEY=VALUE is needed, such as material.work_of_adhesion="),
        (
            "material.work_of_adhesion=0.1",
            "--set material.work_of_adhesion=0.1: `material.work_of_adhesion = 0.1`: the unit is missing",
        ),
        (
            "material.hardnes=1 GPa",
            "--set material.hardnes=1 GPa: unknown key `material.hardnes`; did you mean `hardness`?",
        ),
        ("model.law=edm", "--set model.law=edm: `model.law = \"edm\"`: unknown law"),
        (
            "surface.heights.law=weibull",
            "--set surface.heights.law=weibull: `surface.heights.law = \"weibull\"`: needs shape",
        ),
        (
            "material.hardness.unit=GPa",
            "--set material.hardness.unit=GPa: `material.hardness` is no table in the scene",
        ),
        (
            "ensemble.replicas=none",
            "--set ensemble.replicas=none: `ensemble.replicas = \"none\"`: a whole number from 0",
        ),
        ("sweep.model.law=[]", "--set sweep.model.law=[]: "),
    ];
    for (setting, message) in cases {
        for command in [&["run", "scene.toml"], &["check", "scene.toml"]] {
            let refused = folder.stiction(&[&command[..], &["--set", setting]].concat());
            assert_exit(&refused, 2);
            assert!(text(&refused.stderr).contains(message), "{setting}: {}", text(&refused.stderr));
        }
    }
    std::fs::write(folder.path("scene.toml"), small().replace("seed = 1", "seed = -1")).unwrap();
    let line = 1 + small().lines().position(|line| line == "seed = 1").unwrap();
    let refused = folder.stiction(&["check", "scene.toml", "--set", "title=two\nlines"]);
    let message = format!("scene.toml: line {line}: `ensemble.seed = -1`");
    assert!(text(&refused.stderr).contains(&message), "{}", text(&refused.stderr));
    assert_eq!(folder.files(), ["scene.toml"]);
}

/// The lines of JSON of a command, and the others.
fn progress(output: &Output) -> (Vec<Value>, Vec<String>) {
    let (json, others): (Vec<String>, Vec<String>) =
        text(&output.stderr).lines().map(str::to_owned).partition(|line| line.starts_with('{'));
    (json.iter().map(|line| serde_json::from_str(line).unwrap()).collect(), others)
}

#[test]
fn progress_is_reported_in_json() {
    let folder = Folder::new(&small());
    let run = folder.stiction(&["run", "scene.toml", "--json-progress"]);
    assert_exit(&run, 0);
    let (lines, others) = progress(&run);
    assert_eq!(others, [""; 0]);
    let phases: Vec<&str> = lines.iter().map(|line| line["phase"].as_str().unwrap()).collect();
    assert_eq!(phases.first(), Some(&"integral"));
    let ensemble: Vec<&Value> = lines.iter().filter(|line| line["phase"] == "ensemble").collect();
    assert_eq!((&ensemble[0]["done"], &ensemble[0]["total"]), (&0.into(), &40.into()));
    let last = ensemble[ensemble.len() - 1];
    assert_eq!((&last["done"], &last["total"]), (&40.into(), &40.into()));
    for line in &lines {
        assert_eq!(line["run"], "");
        assert_eq!(line.as_object().unwrap().len(), 5, "{line}");
        assert_eq!(line["done"].is_null(), line["phase"] != "ensemble", "{line}");
    }
    // What is not progress stays a text.
    let refused = folder.stiction(&["run", "scene.toml", "--json-progress"]);
    assert_exit(&refused, 2);
    let (lines, others) = progress(&refused);
    assert_eq!(lines.len(), 0);
    assert!(others[0].starts_with("stiction: scene.h5 exists"), "{others:?}");
    let sweep = small().replace("replicas = 40", "replicas = 8")
        + "\n[sweep]\nsurface.surface_height_std = [\"1.4 nm\", \"1.8 nm\"]\n";
    std::fs::write(folder.path("sweep.toml"), sweep).unwrap();
    let (lines, _) = progress(&folder.stiction(&["run", "sweep.toml", "--json-progress"]));
    for run in ["point 1 of 2", "point 2 of 2"] {
        assert!(lines.iter().any(|line| line["run"] == run && line["done"] == 8 && line["total"] == 8));
    }
}

#[cfg(unix)]
#[test]
fn other_commands_are_programs() {
    use std::os::unix::fs::PermissionsExt;
    let folder = Folder::new("");
    let program = folder.path("stiction-greet");
    let script = "#!/bin/sh\necho \"$STICTION\" \"$@\"\ncat\nexit 7\n";
    std::fs::write(&program, script).unwrap();
    let run = |arguments: &[&str]| {
        let path = std::env::join_paths(
            std::iter::once(folder.path(""))
                .chain(std::env::split_paths(&std::env::var_os("PATH").unwrap_or_default())),
        );
        let mut command = Command::new(env!("CARGO_BIN_EXE_stiction"));
        command.args(arguments).env("PATH", path.unwrap()).stdin(Stdio::null()).output().unwrap()
    };
    // A file that is no program is none.
    assert_exit(&run(&["greet"]), 2);
    std::fs::set_permissions(&program, std::fs::Permissions::from_mode(0o755)).unwrap();
    let greeted = run(&["greet", "--set", "-1e-5", "--help"]);
    assert_exit(&greeted, 7);
    let this = std::fs::canonicalize(env!("CARGO_BIN_EXE_stiction")).unwrap();
    assert_eq!(text(&greeted.stdout), format!("{} --set -1e-5 --help\n", this.display()));

    for (arguments, message) in [
        (
            &["plto", "x.h5"][..],
            "no command `plto`, and no program stiction-plto beside this one or on the PATH; did you mean `stiction plot`?",
        ),
        (&["comapre"], "did you mean `stiction compare`?"),
        (&["../greet"], "no command `../greet`"),
    ] {
        let refused = run(arguments);
        assert_exit(&refused, 2);
        assert!(text(&refused.stderr).contains(message), "{}", text(&refused.stderr));
    }
    // Neither is the folder where somebody happens to be, whatever the PATH calls it.
    for path in [".", "", ":/bin", "/bin::"] {
        let mut command = Command::new(env!("CARGO_BIN_EXE_stiction"));
        let refused = command.arg("greet").env("PATH", path).current_dir(folder.path("")).output().unwrap();
        assert_exit(&refused, 2);
        assert!(text(&refused.stderr).contains("no command `greet`"), "{}", text(&refused.stderr));
    }
    // Nothing but the folder of the program is looked at where there is no PATH.
    for name in ["asperities", "finite-size", "map", "plot", "report"] {
        let refused =
            Command::new(env!("CARGO_BIN_EXE_stiction")).arg(name).env_remove("PATH").output().unwrap();
        assert_exit(&refused, 2);
        let message = format!(
            "`{name}` comes with the Python package: pip install stiction (from a checkout: pip install .)"
        );
        assert!(text(&refused.stderr).contains(&message), "{}", text(&refused.stderr));
    }
}

/// The law of the scene is compared where none is named.
#[test]
fn a_comparison_without_laws_is_of_that_of_the_scene() {
    let folder = Folder::new(&small());
    let compare = |laws: &[&str]| {
        let compared = folder.stiction(&[&["compare", "scene.toml", "--quiet"], laws].concat());
        assert_exit(&compared, 0);
        text(&compared.stdout)
    };
    assert_eq!(compare(&[]), compare(&["--laws", "hybrid"]));
    assert_eq!(compare(&["--set", "model.law=sbl"]), compare(&["--laws", "sbl"]));
}

/// The columns of a CSV text, by name.
fn column(csv: &str, name: &str) -> Vec<String> {
    let mut lines = csv.lines();
    let place = lines.next().unwrap().split(',').position(|column| column == name);
    let place = place.unwrap_or_else(|| panic!("no column {name} in {csv}"));
    lines.map(|line| line.split(',').nth(place).unwrap().to_owned()).collect()
}

fn numbers(csv: &str, name: &str) -> Vec<f64> {
    column(csv, name).iter().map(|field| field.parse().unwrap()).collect()
}

const TIP: &str = "radius,reduced_modulus,work_of_adhesion,equilibrium_spacing,interference\n";

/// Tables in SI against closed forms: Hertz's load 4/3 E R^1/2 d^3/2 and radius (R d)^1/2, the pull-off of
/// Johnson, Kendall and Roberts -3/2 pi R w and that of Derjaguin, Muller and Toporov -2 pi R w, and the
/// adhesion parameter of Maugis.
#[test]
fn asperities_in_si_are_those_of_closed_forms() {
    use std::f64::consts::PI;
    let folder = Folder::new("");
    let solved = |law: &str, table: &str, more: &[&str]| {
        let command = [&["asperity", "--law", law, "--table", "-"], more].concat();
        let output = given(&folder, &command, table);
        assert_exit(&output, 0);
        text(&output.stdout)
    };
    let close = |a: f64, b: f64, to: f64| assert!((a / b - 1.0).abs() < to, "{a:e} {b:e}");
    for (radius, modulus, work) in [(2e-6_f64, 70e9_f64, 0.05_f64), (30e-9, 1e9, 0.2), (1e-3, 1e6, 0.03)] {
        let rows = |interferences: &mut dyn Iterator<Item = f64>| {
            TIP.to_owned()
                + &interferences
                    .map(|d| format!("{radius:e},{modulus:e},{work:e},0.3e-9,{d:e}\n"))
                    .collect::<String>()
        };
        let csv = solved("hertz", &rows(&mut [1e-3, 1e-2].into_iter().map(|d| d * radius)), &[]);
        for (i, d) in [1e-3 * radius, 1e-2 * radius].into_iter().enumerate() {
            close(
                numbers(&csv, "external_force")[i],
                4.0 / 3.0 * modulus * radius.sqrt() * d.powf(1.5),
                1e-14,
            );
            close(numbers(&csv, "contact_radius")[i], (radius * d).sqrt(), 1e-14);
            assert_eq!(numbers(&csv, "interference")[i].to_bits(), d.to_bits());
            assert_eq!(column(&csv, "regime")[i], "elastic");
        }
        let k = 4.0 / 3.0 * modulus;
        let lambda = 2.0 * 1.03 * work / 0.3e-9 * (radius / (PI * work * k * k)).cbrt();
        close(numbers(&csv, "adhesion_parameter")[0], lambda, 1e-14);
        // About the depth of the pull-off of JKR, a step of which costs the square of it.
        let unit = (PI * PI * work * work * radius / (k * k)).cbrt();
        let steps = &mut (-1500..1500).map(|i| 1e-3 * f64::from(i) * unit);
        let csv = solved("jkr", &rows(steps), &["--path", "retraction"]);
        let pull_off = numbers(&csv, "external_force").into_iter().fold(0.0, f64::min);
        close(pull_off, -1.5 * PI * radius * work, 1e-5);
        let csv = solved("dmt", &rows(&mut std::iter::once(0.0)), &[]);
        close(numbers(&csv, "external_force")[0], -2.0 * PI * radius * work, 1e-14);
        let (contact, adhesion) = (numbers(&csv, "contact_force")[0], numbers(&csv, "adhesion_force")[0]);
        assert_eq!(contact - adhesion, numbers(&csv, "external_force")[0]);
    }
}

/// States of unloading, of `tests/data/md_top.csv`, by a table with the interference at the turn; three that no path leads to are
/// left out.
#[test]
fn asperities_on_their_way_back_are_those_of_the_reference() {
    let folder = Folder::new("");
    let mut lines = include_str!("../data/md_top.csv").lines();
    let columns: Vec<&str> = lines.next().unwrap().split(',').collect();
    let mut table = format!("{},hardness,poisson_ratio,deepest_interference\n", TIP.trim());
    let (mut turn, mut expected): (String, Vec<[f64; 3]>) = Default::default();
    for line in lines {
        let fields: Vec<&str> = line.split(',').collect();
        let field = |name: &str| fields[columns.iter().position(|column| *column == name).unwrap()];
        let tip =
            ["radius_m", "reduced_modulus_Pa", "work_of_adhesion_J_m2", "equilibrium_spacing_m"].map(field);
        let delta = field("interference_m");
        let is_load = field("branch") == "load";
        turn = if is_load { delta.to_owned() } else { turn };
        let deepest = if is_load { "" } else { &turn };
        let flow = ["hardness_Pa", "poisson_ratio"].map(field);
        table += &format!("{},{delta},{},{deepest}\n", tip.join(","), flow.join(","));
        expected.push(
            ["adhesion_force_N", "contact_force_N", "contact_radius_m"]
                .map(|name| field(name).parse().unwrap()),
        );
    }
    let output = given(&folder, &["asperity", "--law", "md_plastic", "--table", "-"], &table);
    assert_exit(&output, 0);
    let csv = text(&output.stdout);
    let found = ["adhesion_force", "contact_force", "contact_radius"].map(|name| numbers(&csv, name));
    let mut unstable = 0;
    for (i, expected) in expected.iter().enumerate() {
        let off = (0..3).map(|k| (found[k][i] / expected[k] - 1.0).abs()).fold(0.0, f64::max);
        let is_other = found[2][i] > 1.01 * expected[2];
        unstable += usize::from(is_other);
        assert!(off < 1e-12 || is_other, "row {i}: off by {off:e}");
    }
    assert_eq!((expected.len(), unstable), (160, 3));

    let row = "1e-6,8e10,0.01,2e-10,3e-9,2e9,0.3,";
    let refused = |law: &str, deepest: &str, message: &str| {
        let table = format!("{},hardness,poisson_ratio,deepest_interference\n{row}{deepest}\n", TIP.trim());
        let output = given(&folder, &["asperity", "--law", law, "--table", "-"], &table);
        assert_exit(&output, 2);
        assert!(text(&output.stderr).contains(message), "{}", text(&output.stderr));
    };
    let deeper = "line 2: deepest_interference = `2e-9` m is less than the interference, `3e-9` m";
    refused("md_plastic", "2e-9", deeper);
    refused("hybrid", "5e-9", "hybrid is a law of loading; take --law md_plastic");
}

/// A table in SI is the one in scaled variables in other units, with plastic contact and a lubricant too; all
/// columns of the table are there again, and rows of one asperity and of several may alternate.
#[test]
fn tables_in_si_and_in_scaled_variables_agree() {
    use std::f64::consts::PI;
    let folder = Folder::new("");
    let (radius, modulus, work, spacing): (f64, f64, f64, f64) = (3.33e-6, 85.29e9, 0.09, 0.2e-9);
    let (k, nu, hardness, lubricant) = (4.0 / 3.0 * modulus, 0.27, 2.5e9, 0.5e-9);
    let unit = (PI * PI * work * work * radius / (k * k)).cbrt();
    let lambda = 2.0 * 1.03 / PI * unit / spacing;
    let strain = PI * (0.454 + 0.41 * nu) * hardness / (2.0 * modulus);
    let critical = strain * strain * radius;
    let deltas = [-5.0, -2.0, -0.5, 0.5, 10.0, 100.0, 1200.0];
    let other = format!("other,1e-6,1e9,0.05,{spacing:e},1e-9,,,\n");
    let own = |delta: &f64| {
        let delta = delta * unit;
        format!(
            "this,{radius:e},{modulus:e},{work:e},{spacing:e},{delta:e},{hardness:e},{nu},{lubricant:e}\n"
        )
    };
    let table = format!("name,{},hardness,poisson_ratio,lubricant_thickness\n", TIP.trim())
        + &deltas.iter().map(|delta| own(delta) + &other).collect::<String>();
    std::fs::write(folder.path("tips.csv"), &table).unwrap();
    // A row without hardness stays elastic, if its law can.
    let refused = folder.stiction(&["asperity", "--law", "isbl", "--table", "tips.csv"]);
    assert_exit(&refused, 2);
    let message = "tips.csv: line 3: hardness and poisson_ratio are missing, which the law isbl needs";
    assert!(text(&refused.stderr).contains(message), "{}", text(&refused.stderr));

    let si = folder.stiction(&["asperity", "--law", "hybrid", "--table", "tips.csv"]);
    assert_exit(&si, 0);
    let si = text(&si.stdout);
    let options = [
        format!("--lambda={lambda:e}"),
        format!("--critical-interference={:e}", critical / unit),
        format!("--lubricant-thickness={:e}", lubricant / unit),
        format!("--poisson-ratio={nu}"),
        "--delta".to_owned(),
    ];
    let shown: Vec<String> = options.into_iter().chain(deltas.iter().map(f64::to_string)).collect();
    let command: Vec<&str> =
        ["asperity", "--law", "hybrid"].into_iter().chain(shown.iter().map(String::as_str)).collect();
    let scaled = folder.stiction(&command);
    assert_exit(&scaled, 0);
    let scaled = text(&scaled.stdout);
    let force = PI * work * radius;
    let contact = (PI * work * radius * radius / k).cbrt();
    for (name, unit) in [("adhesion_force", force), ("external_force", force), ("contact_radius", contact)] {
        let own = numbers(&si, name).into_iter().step_by(2);
        for (own, scaled) in own.zip(numbers(&scaled, name)) {
            assert!((own - unit * scaled).abs() <= 1e-9 * (unit * scaled).abs(), "{name} {own} {scaled}");
        }
    }
    let own: Vec<String> = column(&si, "regime").into_iter().step_by(2).collect();
    let regimes =
        ["noncontact", "lubricant", "elastic", "elastic", "elastoplastic1", "elastoplastic2", "plastic"];
    assert_eq!(own, regimes);
    let others: Vec<String> = column(&si, "external_force").into_iter().skip(1).step_by(2).collect();
    assert!(others.iter().all(|force| *force == others[0]));
    for (given, reported) in table.lines().zip(si.lines()) {
        assert!(reported.starts_with(&format!("{given},")), "{reported}");
    }
}

/// A table as another program writes it: BOM, comments, quotes, and units in the names, in letters of any case.
#[test]
fn asperities_have_the_units_above_their_columns() {
    let folder = Folder::new("");
    let command = ["asperity", "--law", "hybrid", "--table", "-"];
    let plain = given(&folder, &command, &format!("{TIP}2e-8,6e10,0.05,2e-10,1e-10\n"));
    let units = "\u{feff}# tips\nRadius (nm),reduced_modulus [GPa],\"Work_of_adhesion mJ/m\u{b2}\",equilibrium_spacing_\u{c5},\
                 interference (\u{212b}),\"who, when\"\n20,60,50,\"2\",1,\"me, now\"\n";
    let other = given(&folder, &command, units);
    assert_exit(&other, 0);
    let (plain, other) = (text(&plain.stdout), text(&other.stdout));
    assert!(other.lines().nth(1).unwrap().starts_with("20,60,50,2,1,\"me, now\","), "{other}");
    for name in ["adhesion_force", "external_force", "contact_radius", "adhesion_parameter"] {
        let last = |table: &str, from_end: usize| {
            let row = table.lines().nth(1).unwrap().rsplit(',').nth(from_end).unwrap();
            row.parse::<f64>().unwrap()
        };
        let place = plain.lines().next().unwrap().rsplit(',').position(|own| own == name).unwrap();
        let (one, two) = (last(&plain, place), last(&other, place));
        assert!((one - two).abs() <= 1e-12 * one.abs(), "{name}: {one} {two}");
    }
}

#[test]
fn bad_rows_of_asperities_are_named() {
    let folder = Folder::new("");
    let good = "1e-6,1e9,0.05,0.2e-9,1e-9";
    for (table, message) in [
        (
            format!("{TIP}{good}\n-1e-6,1e9,0.05,0.2e-9,0\n"),
            "line 3: radius = `-1e-6` will not do: a positive number is needed",
        ),
        (
            format!("{TIP}{good}\n\n1e-6,stiff,0.05,0.2e-9,0\n"),
            "line 4: reduced_modulus = `stiff` is not a number",
        ),
        (format!("{TIP}1e-6,1e9,0.05,#N/A,0\n"), "line 2: equilibrium_spacing = `#N/A` is a gap: fill it"),
        (
            format!("{TIP}\"1e-6\",1e9,0.05,\"0,2e-9\",0\n"),
            "line 2: equilibrium_spacing = `0,2e-9` is a number with a comma",
        ),
        (
            format!("{TIP}{good}\n").replace(',', ";"),
            "line 1: columns are separated by semicolons; save it as CSV",
        ),
        (
            format!("{TIP}{good}\n").replace("radius", "radius (N)"),
            "line 1: radius (N): the unit of a length is needed: m, cm, mm, um, nm",
        ),
        (format!("poisson_ratio (nm),{TIP}0.3,{good}\n"), "line 1: poisson_ratio is a number without a unit"),
        (
            format!("{TIP}1e-6,1e9,0.05,0.2e-9,inf\n"),
            "line 2: interference = `inf` will not do: a finite number",
        ),
        (format!("{TIP}1e-6,1e9,0.05,0.2e-9\n"), "line 2: has 4 fields, and the first line 5"),
        (format!("{TIP}1e6,1,0.05,0.2e-9,0\n"), "line 2: the adhesion parameter lambda is"),
        (
            "radius,interference\n1,2\n".to_owned(),
            "line 1: no column `reduced_modulus`; the columns radius,reduced_modulus,work_of_adhesion,equilibrium_spacing,interference are needed",
        ),
        (format!("hardnes,{TIP}1e9,{good}\n"), "line 1: unknown column `hardnes`; did you mean `hardness`?"),
        (format!("radius,{TIP}1e-6,{good}\n"), "line 1: columns 1 and 2 have one name"),
        (format!("hardness,{TIP}1e9,{good}\n"), "line 2: poisson_ratio is missing, which the hardness needs"),
        (
            format!("poisson_ratio,{TIP}0.6,{good}\n"),
            "line 2: poisson_ratio = `0.6` will not do: a number greater than -1 and at most 0.5",
        ),
        (
            "a,b\n1,2\n".to_owned(),
            "line 1: no column `lambda`; the columns lambda,delta are needed, or in SI radius,",
        ),
    ] {
        let refused = given(&folder, &["asperity", "--law", "hybrid", "--table", "-"], &table);
        assert_exit(&refused, 2);
        let error = text(&refused.stderr);
        assert!(error.starts_with(&format!("stiction: standard input: {message}")), "{error}");
    }
    for option in ["--critical-interference=1", "--poisson-ratio=0.3", "--lubricant-thickness=1"] {
        let table = format!("{TIP}{good}\n");
        let refused = given(&folder, &["asperity", "--law", "hybrid", "--table", "-", option], &table);
        assert_exit(&refused, 2);
        let message = format!("{} is for scaled variables", option.split('=').next().unwrap());
        assert!(text(&refused.stderr).contains(&message), "{}", text(&refused.stderr));
    }
}

/// Files, and the dimension that the table of each is about.
type Results = (Folder, Vec<(String, &'static str)>);

/// A file of each kind.
static RESULTS: LazyLock<Results> = LazyLock::new(results);

fn results() -> Results {
    let folder = Folder::new("");
    let title = "title = \"two, \u{202e}µm \\u001b[2J\"\n";
    let scene = small().lines().filter(|line| !line.starts_with("title")).collect::<Vec<_>>().join("\n");
    let scene = scene.replace("format = 1\n", &format!("format = 1\n{title}"));
    std::fs::write(folder.path("scene.toml"), &scene).unwrap();
    let points = scene.replace("replicas = 40", "replicas = 8").replace("count = 16", "count = 5");
    let grid = "\n[sweep]\nsurface.surface_height_std = [\"1.4 nm\", \"1.8 nm\"]\n\
                material.work_of_adhesion = [\"0.05 J/m^2\", \"0.1 J/m^2\", \"0.2 J/m^2\"]\n";
    let zip = grid.replace(", \"0.2 J/m^2\"", "").replace("[sweep]", "[sweep]\nmode = \"zip\"");
    std::fs::write(folder.path("grid.toml"), points.clone() + grid).unwrap();
    std::fs::write(folder.path("zip.toml"), points + &zip).unwrap();
    let commands = [
        (&["run", "scene.toml", "-o", "run.h5"][..], "run", "separation"),
        (&["run", "grid.toml", "-o", "grid.h5"], "grid", "point"),
        (&["run", "zip.toml", "-o", "zip.h5"], "zip", "point"),
        (&["compare", "scene.toml", "--laws", "hybrid,jkr", "-o", "laws.h5"], "laws", "point"),
    ];
    let mut made = Vec::new();
    for (command, name, dimension) in commands {
        assert_exit(&folder.stiction(command), 0);
        made.push((format!("{name}.h5"), dimension));
    }
    std::fs::copy(ASPERITIES, folder.path("map.h5")).unwrap();
    made.push(("map.h5".to_owned(), "asperity"));
    (folder, made)
}

/// What is printed of a file as JSON is what is in it: every dataset with its shape, its numbers and
/// the names of its dimensions, and the attributes.
#[test]
fn json_is_what_is_in_the_file() {
    let (folder, files) = &*RESULTS;
    for (name, _) in files {
        let json = folder.stiction(&["info", "--json", name]);
        assert_exit(&json, 0);
        let printed = text(&json.stdout);
        assert!(printed.is_ascii() && printed.matches('\n').count() == 1);
        let json: Value = serde_json::from_str(&printed).unwrap();
        let file = unlocked::open(folder.path(name));
        assert_eq!(json["format"], attribute(&folder.path(name), "/", "format"));
        assert_eq!(json["format_version"].as_array().unwrap().len(), 2);
        if name != "map.h5" {
            assert_eq!(json["attributes"]["scene"], attribute(&folder.path(name), "/", "scene"));
        }
        let groups = file.groups().unwrap();
        let mut count = 0;
        for group in std::iter::once(file.as_group().unwrap()).chain(groups) {
            let own = match group.name().as_str() {
                "/" => &json["groups"]["/"],
                other => &json["groups"][&other[1..]],
            };
            for dataset in group.datasets().unwrap() {
                count += 1;
                let last = dataset.name().rsplit('/').next().unwrap().to_owned();
                let reported = &own["datasets"][&last];
                let shape: Vec<usize> = serde_json::from_value(reported["shape"].clone()).unwrap();
                assert_eq!(shape, dataset.shape(), "{}", dataset.name());
                assert_eq!(reported["dimensions"].as_array().unwrap().len(), shape.len());
                for (length, dimension) in shape.iter().zip(reported["dimensions"].as_array().unwrap()) {
                    let scale = group.dataset(dimension.as_str().unwrap()).unwrap();
                    assert_eq!(scale.shape(), [*length], "{}", dataset.name());
                }
                if let Ok(units) = dataset.attr("units") {
                    let units = units.read_scalar::<hdf5::types::VarLenUnicode>().unwrap();
                    assert_eq!(reported["units"], units.as_str());
                }
                let values = reported["values"].as_array().unwrap();
                if dataset.dtype().unwrap().is::<f64>() {
                    let stored = dataset.read_raw::<f64>().unwrap();
                    assert_eq!(values.len(), stored.len());
                    for (value, stored) in values.iter().zip(stored) {
                        // The reader of JSON rounds the last bit.
                        let is_same =
                            value.as_f64().map(|value| (value - stored).abs() <= 1e-15 * stored.abs());
                        assert_eq!(is_same, stored.is_finite().then_some(true), "{}", dataset.name());
                    }
                } else if let Ok(stored) = dataset.read_raw::<u64>() {
                    assert_eq!(
                        values.iter().map(|value| value.as_u64().unwrap()).collect::<Vec<_>>(),
                        stored
                    );
                }
            }
        }
        assert!(count > 20, "{name}: {count}");
    }
    let title: Value =
        serde_json::from_str(&text(&folder.stiction(&["info", "--json", "run.h5"]).stdout)).unwrap();
    assert_eq!(title["attributes"]["title"], "two, \u{202e}µm \u{1b}[2J");
}

/// A table has a row for each index, and in each column what the dataset of its name has.
#[test]
fn tables_are_what_is_in_the_file() {
    let (folder, files) = &*RESULTS;
    let mut files = files.clone();
    files.extend([("run.h5".to_owned(), "replica"), ("run.h5".to_owned(), "scalar")]);
    for (i, (name, dimension)) in files.iter().enumerate() {
        // The first of them are what there is by default.
        let by = ["--by", dimension];
        let csv =
            folder.stiction(&[&["info", "--csv", "--all", name][..], if i < 6 { &[] } else { &by }].concat());
        assert_exit(&csv, 0);
        let csv = text(&csv.stdout);
        let file = unlocked::open(folder.path(name));
        let mut compared = 0;
        for header in csv.lines().next().unwrap().split(',') {
            let path = header.split(" [").next().unwrap();
            let Ok(dataset) = file.dataset(path) else { continue };
            if !dataset.dtype().unwrap().is::<f64>() || dataset.ndim() != 1 {
                continue;
            }
            let stored = dataset.read_raw::<f64>().unwrap();
            // Choices have names.
            if header.starts_with("model_law") {
                assert!(column(&csv, header).iter().all(|name| name.parse::<f64>().is_err()), "{csv}");
                continue;
            }
            // The keys of a grid stand at each of its points.
            if csv.lines().count() != stored.len() + 1 {
                assert_eq!(name, "grid.h5");
                continue;
            }
            compared += 1;
            for (field, stored) in numbers(&csv, header).iter().zip(stored) {
                assert!(
                    field.to_bits() == stored.to_bits() || (field.is_nan() && stored.is_nan()),
                    "{header}"
                );
            }
        }
        let least = match (name.as_str(), *dimension) {
            ("grid.h5", _) => 0,
            (_, "separation" | "point") => 15,
            _ => 4,
        };
        assert!(compared >= least, "{name} {dimension}: {compared}");
    }
    let csv = text(&folder.stiction(&["info", "--csv", "grid.h5"]).stdout);
    let work = numbers(&csv, "material_work_of_adhesion [J m-2]");
    assert_eq!(work, [0.05, 0.1, 0.2, 0.05, 0.1, 0.2]);
    assert_eq!(
        numbers(&csv, "surface_surface_height_std [m]"),
        [1.4e-9, 1.4e-9, 1.4e-9, 1.8e-9, 1.8e-9, 1.8e-9]
    );
    let forces = unlocked::open(folder.path("grid.h5")).dataset("integral/pull_off_force").unwrap();
    assert_eq!(numbers(&csv, "integral/pull_off_force [N]"), forces.read_raw::<f64>().unwrap());
    assert_eq!(column(&csv, "validation/verdict [1]").len(), 6);

    let refused = folder.stiction(&["info", "--csv", "--by", "replicas", "run.h5"]);
    assert_exit(&refused, 2);
    let message = "run.h5: has no dimension `replicas`; --by takes separation, ";
    assert!(text(&refused.stderr).contains(message), "{}", text(&refused.stderr));
    for (arguments, message) in [
        (&["--json", "scene.toml"][..], "scene.toml: is not an HDF5 file"),
        (&["--by", "law", "run.h5"], "--csv"),
        (&["--json", "--csv", "run.h5"], "cannot be used with"),
    ] {
        let refused = folder.stiction(&[&["info"], arguments].concat());
        assert_exit(&refused, 2);
        assert!(text(&refused.stderr).contains(message), "{}", text(&refused.stderr));
    }
}

/// Large datasets stand in the JSON without their values, unless they are asked for.
#[test]
#[ignore = "slow: three seconds"]
fn large_datasets_are_reported_when_asked_for() {
    let scene = small().replace("curves = false", "curves = true").replace("\"hybrid\"", "\"gw\"");
    let folder = Folder::new(&scene);
    let run = ["run", "scene.toml", "--quiet", "--set", "surface.nominal_area=1.4 um^2"];
    assert_exit(&folder.stiction(&[&run[..], &["--set", "ensemble.replicas=6400"]].concat()), 0);
    for (more, there) in [(&[][..], false), (&["--all"], true)] {
        let json = folder.stiction(&[&["info", "--json", "scene.h5"], more].concat());
        let json: Value = serde_json::from_str(&text(&json.stdout)).unwrap();
        let curves = &json["groups"]["replicas"]["datasets"]["external_force"];
        assert_eq!(curves["shape"], serde_json::json!([6400, 16]));
        assert_eq!(curves.get("values").is_some(), there);
        let pull_off = &json["groups"]["replicas"]["datasets"]["pull_off_force"]["values"];
        assert_eq!(pull_off.as_array().unwrap().len(), 6400);
    }
}
