//! The program as other programs drive it: settings, standard input, progress and tables that are read by
//! machines, commands that are programs of their own.

use crate::common::program::{Folder, assert_exit, attribute, bits, small, text};
use serde_json::Value;
use std::io::Write;
use std::process::{Command, Output, Stdio};

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

/// A scene with settings is the scene with these values in it: bits and the text in the file; the checkpoints
/// of a run hold to it.
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

/// What an interrupted run has kept is of the scene with its settings.
#[test]
fn checkpoints_hold_to_settings() {
    let folder = Folder::new(&small());
    let set = ["--set", "surface.surface_height_std=2 nm", "-o", "set.h5", "--quiet"];
    let shard = |index: &str, extra: &[&str]| {
        let name = format!("{index}.shard");
        let command = ["run", "scene.toml", "--shard", index, "-o", &name.replace('/', "-"), "--quiet"];
        folder.stiction(&[&command[..], extra].concat())
    };
    assert_exit(&folder.stiction(&[&["run", "scene.toml"], &set[..]].concat()), 0);
    for index in ["1/2", "2/2"] {
        assert_exit(&shard(index, &set[..2]), 0);
    }
    let merged = folder.stiction(&["merge", "1-2.shard", "2-2.shard", "-o", "merged.h5", "--quiet"]);
    assert_exit(&merged, 0);
    assert_eq!(bits(&folder.path("merged.h5")), bits(&folder.path("set.h5")));
    assert_exit(&shard("2/2", &["--force"]), 0);
    let refused = folder.stiction(&["merge", "1-2.shard", "2-2.shard", "-o", "mixed.h5", "--quiet"]);
    assert_exit(&refused, 2);
    assert!(text(&refused.stderr).contains("not the shards of one run"), "{}", text(&refused.stderr));
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
    let folder = Folder::new(&small());
    assert_exit(&folder.stiction(&["run", "scene.toml", "--quiet"]), 0);
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
        (&["finite-size", "-"], &small(), "name one with -o"),
        (&["run", "-", "-o", "x.h5"], "format = ", "standard input: line 1: not TOML"),
        (&["run", "-", "-o", "x.h5"], "", "standard input: "),
    ] {
        let refused = given(&folder, arguments, input);
        assert_exit(&refused, 2);
        assert!(text(&refused.stderr).contains(message), "{arguments:?}: {}", text(&refused.stderr));
    }
    assert_eq!(folder.files(), ["heights.csv", "piped.h5", "scene.h5", "scene.toml"]);
}

/// What is wrong with a setting is told by its name, and what is wrong with the scene by its own line.
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
            "--set ensemble.replicas=none: `ensemble.replicas = \"none\"`: a whole number from 1",
        ),
        ("sweep.model.law=[]", "--set sweep.model.law=[]: "),
    ];
    for (setting, message) in cases {
        for command in [&["run", "scene.toml"][..], &["check", "scene.toml"], &["finite-size", "scene.toml"]]
        {
            let refused = folder.stiction(&[command, &["--set", setting]].concat());
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
fn progress_is_told_in_json() {
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
        assert_eq!(line.as_object().unwrap().len(), 4, "{line}");
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
    // Nothing but the folder of the program is looked at where there is no PATH.
    for name in ["plot", "report"] {
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
