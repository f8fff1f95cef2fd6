//! Memory and disk that runs take beside what is estimated before, and runs that are refused because they
//! would take more than can be had.
#![cfg(target_os = "linux")]

use crate::common::program::{Folder, QUICK, assert_exit, looped, peak_memory, small, text};
use std::process::Command;

/// The quick scene with other sizes: asperities, separations, replicas.
fn sized(asperities: f64, separations: u32, replicas: u32) -> String {
    QUICK
        .replace("\"100 um^2\"", &format!("\"{} um^2\"", asperities / 7.39))
        .replace("count = 91", &format!("count = {separations}"))
        .replace("replicas = 200", &format!("replicas = {replicas}"))
}

fn compressed(scene: &str) -> String {
    scene.replace("[output]", "[solver]\nsummation = \"moments\"\n[output]")
}

/// What `check` says of the scene in a folder on the line that begins so, bytes.
fn estimated(folder: &Folder, what: &str) -> f64 {
    let check = folder.stiction(&["check", "scene.toml"]);
    assert_exit(&check, 0);
    let check = text(&check.stdout);
    let line = check.lines().find(|line| line.trim_start().starts_with(what)).unwrap();
    let mut words = line.split_whitespace().skip_while(|word| word.parse::<f64>().is_err());
    let value: f64 = words.next().unwrap().parse().unwrap();
    let units = [("kB", 1e3), ("MB", 1e6), ("GB", 1e9)];
    value * units.iter().find(|(unit, _)| Some(*unit) == words.clone().next()).unwrap().1
}

/// The scene pulled back after 8 preloads, on springs of 50 stiffnesses.
fn snapping(scene: &str) -> String {
    let list = |count: u32, unit: &str| {
        (1..=count).map(|i| format!("\"{i} {unit}\"")).collect::<Vec<_>>().join(", ")
    };
    let held = format!("[instability]\nstiffness = [{}]\npreload = [{}]\n", list(50, "N/m"), list(8, "uN"));
    looped(scene).replace("[output]", &format!("{held}[output]"))
}

/// Where asperities are deep in no contact: what they cost is what is kept of their replicas.
fn far(scene: &str) -> String {
    scene.replace("from = -1.0, to = 8.0", "from = 4.0, to = 4.5")
}

/// Memory is estimated within a factor of 2 of what a run takes, and its disk is not underestimated.
fn is_estimated(name: &str, scene: &str) {
    let folder = Folder::new(scene);
    let (estimate, peak) = (estimated(&folder, "memory"), peak_memory(&folder, &[]));
    println!("{name}: {:.1} MB estimated, {:.1} MB taken", estimate / 1e6, peak / 1e6);
    assert!((0.5..2.0).contains(&(estimate / peak)), "{name}: {estimate:e} estimated, {peak:e} taken");
    let (estimate, size) =
        (estimated(&folder, "disk"), folder.path("scene.h5").metadata().unwrap().len() as f64);
    assert!(size < estimate, "{name}: {estimate:e} of disk estimated, {size:e} taken");
}

/// Whatever it is that takes the memory: nothing, separations with their curves, functionals, replicas.
#[test]
#[ignore = "slow: nine seconds"]
fn memory_is_estimated_within_a_factor_of_2() {
    is_estimated("little", &sized(739.0, 91, 200));
    is_estimated("all of the joint test", &sized(739.0, 256, 16));
    is_estimated("curves", &sized(50.0, 6_000, 64).replace("curves = false", "curves = true"));
    is_estimated("replicas", &far(&sized(2.0, 2, 100_000)));
}

#[test]
fn memory_of_snaps_is_estimated_within_a_factor_of_2() {
    is_estimated("snaps", &snapping(&far(&sized(8.0, 2, 8_000))));
}

/// Asperities, few and many, direct and compressed; separations without curves.
#[test]
#[ignore = "slow: half a minute"]
fn memory_of_asperities_is_estimated_within_a_factor_of_2() {
    is_estimated("separations", &sized(50.0, 10_000, 64));
    is_estimated("asperities", &sized(1e6, 21, 8));
    is_estimated("compressed", &compressed(&sized(5e5, 91, 16)));
    is_estimated("fine steps", &compressed(&sized(7390.0, 800, 64)));
    is_estimated("summits that have yielded", &looped(&sized(3e5, 11, 2)));
}

/// The same for coupled asperities, few enough that their pairs are kept, and more.
#[test]
#[ignore = "slow: five seconds"]
fn memory_of_coupled_asperities_is_estimated_within_a_factor_of_2() {
    for (coupling, asperities) in [("periodic", 7390.0), ("patch", 7390.0), ("periodic", 4e4), ("patch", 4e4)]
    {
        let scene = sized(asperities, 3, 1).replace("from = -1.0, to = 8.0", "from = 3.0, to = 6.0");
        is_estimated(coupling, &format!("{scene}\n[substrate]\ncoupling = \"{coupling}\"\n"));
    }
}

/// The same for a million asperities and more: a minute.
#[test]
#[ignore = "slow"]
fn memory_of_many_asperities_is_estimated_within_a_factor_of_2() {
    let scenes = [
        ("direct", sized(1e6, 11, 4)),
        ("loop", looped(&sized(1e6, 91, 2))),
        ("compressed", compressed(&sized(1e6, 46, 4))),
        ("direct, more", sized(5e6, 6, 2)),
        ("compressed, more", compressed(&sized(5e6, 46, 2))),
        ("fine steps", compressed(&sized(3e6, 500, 2))),
        ("loop, more", looped(&sized(3e6, 11, 1))),
        ("many separations", sized(1.2e6, 200, 1)),
    ];
    for (name, scene) in scenes {
        let folder = Folder::new(&scene);
        let check = text(&folder.stiction(&["check", "scene.toml"]).stdout);
        if check.contains("would refuse") {
            println!("{name}: not run, this machine is too small:\n{check}");
            continue;
        }
        let (estimate, peak) = (estimated(&folder, "memory"), peak_memory(&folder, &[]));
        println!("{name}: {:.1} MB estimated, {:.1} MB taken", estimate / 1e6, peak / 1e6);
        assert!((0.5..2.0).contains(&(estimate / peak)), "{name}: {estimate:e} estimated, {peak:e} taken");
    }
}

/// What no machine holds is refused before anything is written, with what it would take and what would fit.
#[test]
fn what_does_not_fit_is_refused() {
    let cases = [
        (
            "replicas",
            sized(739.0, 91, 1_000_000_000).replace("replicas = 1", "replicas = 100"),
            &["TB of memory", "can be had", "--replicas"][..],
        ),
        (
            "curves",
            sized(739.0, 2_000, 50_000_000).replace("curves = false", "curves = true"),
            &["of disk", "--replicas", "can be had"],
        ),
    ];
    for (name, scene, said) in cases {
        let folder = Folder::new(&scene);
        let run = folder.stiction(&["run", "scene.toml"]);
        assert_exit(&run, 2);
        let error = text(&run.stderr);
        let check = folder.stiction(&["check", "scene.toml"]);
        assert_exit(&check, 2);
        assert!(said.iter().all(|part| error.contains(part)), "{name}: {error}");
        assert!(error.starts_with("stiction: scene.toml: the run would take about "), "{error}");
        // Alike, behind what it says of the scene.
        let begins = |error: &str| {
            error.split(" can be had").next().unwrap().split(", and ").next().unwrap().to_owned()
        };
        assert_eq!(begins(&text(&check.stderr)), begins(&error));
        assert!(text(&check.stdout).contains("asperity-separations"), "{}", text(&check.stdout));
        // Curves are kept by runs alone.
        if name != "curves" {
            let compare =
                folder.stiction(&["compare", "scene.toml", "--laws", "gw,md", "--ensemble", "-o", "out.h5"]);
            assert_exit(&compare, 2);
            assert!(text(&compare.stderr).contains("of memory"), "{}", text(&compare.stderr));
        }
        assert_eq!(folder.files(), ["scene.toml"]);
    }
}

/// A sweep takes the memory of its largest point, and the disk of all of them.
#[test]
fn sweeps_that_do_not_fit_are_refused() {
    let refused = |scene: String, sweep: &str| {
        let folder = Folder::new(&format!("{scene}\n[sweep]\n{sweep}\n"));
        let run = folder.stiction(&["run", "scene.toml"]);
        assert_exit(&run, 2);
        assert_eq!(folder.files(), ["scene.toml"]);
        text(&run.stderr)
    };
    let areas = "surface.nominal_area = [\"100 um^2\", \"2.5e7 um^2\", \"10 um^2\"]";
    let error = refused(looped(&sized(739.0, 91, 1)), areas);
    assert!(error.contains("of memory"), "{error}");
    let disk = |count: u32| {
        let scene = sized(739.0, 2_000, 50_000_000).replace("curves = false", "curves = true");
        let thickness = format!("{{ from = \"0 nm\", to = \"1 nm\", count = {count} }}");
        let error = refused(scene, &format!("surface.lubricant_thickness = {thickness}"));
        let (said, _) = error.split_once(" TB of disk").expect("a shortage of disk");
        said.split_whitespace().last().unwrap().parse::<f64>().unwrap()
    };
    let [two, eight] = [2, 8].map(disk);
    assert!((eight / two - 4.0).abs() < 0.1, "{two} {eight}");
}

/// A limit of address space is a limit: a run that would not fit is refused, and what is said to fit does.
#[test]
#[ignore = "slow: two seconds"]
fn what_is_said_to_fit_does() {
    let folder = Folder::new(&far(&sized(2.0, 2, 1_000_000_000)));
    let limited = |more: &str| {
        let command = format!(
            "ulimit -v 710000; exec {} run scene.toml --threads 2 {more}",
            env!("CARGO_BIN_EXE_stiction")
        );
        Command::new("sh").args(["-c", &command]).current_dir(folder.path("")).output().unwrap()
    };
    let refused = limited("");
    assert_exit(&refused, 2);
    let error = text(&refused.stderr);
    let (_, rest) = error.split_once("--replicas ").expect("replicas that fit");
    let replicas: u32 = rest.split(|end: char| !end.is_ascii_digit()).next().unwrap().parse().unwrap();
    assert!(replicas > 10_000, "{error}");
    assert_exit(&limited(&format!("--replicas {replicas}")), 0);
}

/// `check` says how many threads have work, if others have none.
#[test]
fn threads_without_work_are_said() {
    let folder = Folder::new(&small().replace("replicas = 40", "replicas = 1"));
    let check = text(&folder.stiction(&["check", "scene.toml"]).stdout);
    // Coupled replicas are computed side by side, and so none waits for a batch.
    let coupled = |replicas: usize| {
        let scene = small().replace("replicas = 40", &format!("replicas = {replicas}"));
        let folder = Folder::new(&(scene + "\n[substrate]\ncoupling = \"patch\"\n"));
        text(&folder.stiction(&["check", "scene.toml"]).stdout)
    };
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    if threads > 1 {
        assert!(check.contains("; only 1 have a batch of replicas"), "{check}");
        assert!(coupled(1).contains("; only 1 have a replica"), "{}", coupled(1));
    }
    assert!(!coupled(threads).contains("; only"), "{}", coupled(threads));
}
