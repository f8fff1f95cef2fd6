//! Sweeps: each point is the run of its own scene, and the file of all holds what the files of the points
//! would.

use crate::common::program::{
    Folder, KILLED, assert_exit, bits, interrupt_at, looped, number, small, text, unbroken,
};
use crate::common::unlocked;
use hdf5::types::TypeDescriptor;
use std::path::Path;
use std::sync::Arc;
use stiction::layouts::{RUN, SWEEP};
use stiction::output::reader::Reader;
use stiction::output::schema::{Dimension, name_of_key};
use stiction::scene::files::NoFiles;
use stiction::scene::{Document, KEYS, MOST_POINTS, Mode, Sweep};

/// A quick scene with a sweep.
fn swept(sweep: &str) -> String {
    format!("{}\n[sweep]\n{sweep}\n", small())
}

/// Two keys, one of which moves the separations, and the other takes a regime away.
const GRID: &str = "surface.surface_height_std = [\"1.4 nm\", \"1.8 nm\"]\nsurface.lubricant_thickness = [\"0 nm\", \"0.5 nm\"]";

fn sweep(text: &str) -> Sweep {
    Document::parse(text, Arc::new(NoFiles)).unwrap().sweep.unwrap()
}

fn refusal(text: &str) -> String {
    Document::parse(text, Arc::new(NoFiles)).unwrap_err().to_string()
}

/// All numbers of a dataset as bits, and its shape; none for texts.
fn words(dataset: &hdf5::Dataset) -> Option<(Vec<usize>, Vec<u64>)> {
    let values = match dataset.dtype().unwrap().to_descriptor().unwrap() {
        TypeDescriptor::Float(_) => {
            dataset.read_raw::<f64>().unwrap().into_iter().map(f64::to_bits).collect()
        }
        TypeDescriptor::Unsigned(_) => dataset.read_raw::<u64>().unwrap(),
        _ => return None,
    };
    Some((dataset.shape(), values))
}

/// The numbers of a dataset of a sweep at a point, over as much of each dimension as a single run has.
fn part(shape: &[usize], values: &[u64], place: &[usize], own: &[usize]) -> Vec<u64> {
    let index = |i: usize| {
        let mut rest = i;
        let mut indices: Vec<usize> = own.iter().rev().map(|n| (rest % n, rest /= n).0).collect();
        indices.extend(place.iter().rev());
        indices
            .iter()
            .zip(shape.iter().rev())
            .fold((0, 1), |(at, stride), (i, n)| (at + stride * i, stride * n))
            .0
    };
    (0..own.iter().product()).map(|i| values[index(i)]).collect()
}

#[test]
fn a_point_has_the_bits_of_the_run_of_its_scene() {
    for (mode, curves) in [("grid", "true"), ("zip", "false")] {
        // Curves are copied 64 replicas at a time: there are more.
        let text = swept(&format!("mode = \"{mode}\"\n{GRID}")).replace("replicas = 40", "replicas = 72");
        let text = text.replace("curves = false", &format!("curves = {curves}"));
        let text = text.replace("\"100 um^2\"", "\"20 um^2\"");
        let folder = Folder::new(&text);
        assert_exit(&folder.stiction(&["run", "scene.toml"]), 0);
        assert_eq!(folder.files(), ["scene.h5", "scene.toml"]);
        let (sweep, all) = (sweep(&text), unlocked::open(folder.path("scene.h5")));
        for point in 0..sweep.count() {
            std::fs::write(folder.path("point.toml"), sweep.text(point).unwrap()).unwrap();
            assert_exit(&folder.stiction(&["run", "point.toml", "--force"]), 0);
            let single = unlocked::open(folder.path("point.h5"));
            same(&single, &all, &sweep.place(point));
        }
    }
}

/// Points whose asperities are coupled have a larger patch each, with places of its own, and springs as stiff as its
/// half-space.
#[test]
#[ignore = "slow: six seconds"]
fn points_of_coupled_surfaces_have_the_bits_of_their_runs() {
    let of = "surface.nominal_area = [\"2 um^2\", \"4 um^2\"]\nsubstrate.minimum_distance = [\"0.1 um\", \"0.2 um\"]\n";
    let tables = "[substrate]\ncoupling = \"patch\"\n\n[instability]\nstiffness = [0, \"patch\"]\n[output]";
    let text = swept(of).replace("[output]", tables).replace("replicas = 40", "replicas = 8");
    let text = text.replace("count = 16", "count = 6").replace("from = -1.0", "from = 1.0");
    let folder = Folder::new(&text);
    assert_exit(&folder.stiction(&["run", "scene.toml", "--threads", "2"]), 0);
    assert_exit(&folder.stiction(&["validate", "scene.h5"]), 0);
    let (sweep, all) = (sweep(&text), unlocked::open(folder.path("scene.h5")));
    for point in 0..sweep.count() {
        std::fs::write(folder.path("point.toml"), sweep.text(point).unwrap()).unwrap();
        assert_exit(&folder.stiction(&["run", "point.toml", "--force", "--threads", "1"]), 0);
        same(&unlocked::open(folder.path("point.h5")), &all, &sweep.place(point));
    }
}

/// Laws and contacts are swept by their names; a value of a zip may be there again.
#[test]
#[ignore = "slow: six seconds"]
fn points_may_have_models_of_their_own() {
    let of = "mode = \"zip\"\nmodel.law = [\"md_plastic\", \"md_plastic\", \"jkr\"]\n\
              model.plastic_contact = [\"ke\", \"zmc\", \"ke\"]\n";
    let text = looped(&swept(of));
    let text = text.replace("replicas = 40", "replicas = 8").replace("from = -1.0", "from = 1.0");
    let folder = Folder::new(&text);
    assert_exit(&folder.stiction(&["run", "scene.toml"]), 0);
    assert_exit(&folder.stiction(&["validate", "scene.h5"]), 0);
    let (sweep, all) = (sweep(&text), unlocked::open(folder.path("scene.h5")));
    // Points of one law have the same regimes. A sweep over plastic contacts has no range over them.
    for point in 0..2 {
        std::fs::write(folder.path("point.toml"), sweep.text(point).unwrap()).unwrap();
        assert_exit(&folder.stiction(&["run", "point.toml", "--force", "--no-model-range"]), 0);
        same(&unlocked::open(folder.path("point.h5")), &all, &sweep.place(point));
    }
    let attribute = unlocked::open(folder.path("point.h5")).attr("plastic_contact").unwrap();
    let name = attribute.read_scalar::<hdf5::types::VarLenUnicode>().unwrap();
    assert_eq!(name.as_str(), "zmc");
}

/// Every number of a single run stands in the sweep.
#[track_caller]
fn same(single: &hdf5::File, all: &hdf5::File, place: &[usize]) {
    let mut compared = 0;
    for variable in RUN.variables.iter().filter(|variable| !variable.path.starts_with("/diagnostics")) {
        let Ok(own) = single.dataset(&variable.path) else { continue };
        let shared = variable.scales().is_some_and(|dimension| dimension.of_points() == dimension);
        let (Some((own_shape, own)), false) = (words(&own), shared) else { continue };
        let (shape, values) = words(&all.dataset(&variable.path).unwrap()).unwrap();
        assert_eq!(part(&shape, &values, place, &own_shape), own, "{}", variable.path);
        compared += 1;
    }
    assert!(compared > 45, "{compared}");
    // What is an attribute there is a dataset here, or the same for all.
    for group in ["/", "/ensemble", "/integral", "/validation"] {
        let (own, group_of_all) = (single.group(group).unwrap(), all.group(group).unwrap());
        for name in own.attr_names().unwrap() {
            let attribute = own.attr(&name).unwrap();
            let values: Vec<u64> = match attribute.dtype().unwrap().to_descriptor().unwrap() {
                TypeDescriptor::Float(_) => {
                    attribute.read_raw::<f64>().unwrap().into_iter().map(f64::to_bits).collect()
                }
                TypeDescriptor::Unsigned(_) => attribute.read_raw::<u64>().unwrap(),
                _ => continue,
            };
            let path = format!("{}/{name}", group.trim_end_matches('/'));
            if let Some((shape, all)) = group_of_all.dataset(&name).ok().and_then(|dataset| words(&dataset)) {
                let own_shape = if values.len() == 1 { Vec::new() } else { vec![values.len()] };
                assert_eq!(part(&shape, &all, place, &own_shape), values, "{path}");
            } else if name != "format_version" {
                let of_all =
                    group_of_all.attr(&name).unwrap_or_else(|_| panic!("{path} is nowhere in the sweep"));
                let of_all: Vec<u64> = match of_all.dtype().unwrap().to_descriptor().unwrap() {
                    TypeDescriptor::Float(_) => {
                        of_all.read_raw::<f64>().unwrap().into_iter().map(f64::to_bits).collect()
                    }
                    _ => of_all.read_raw::<u64>().unwrap(),
                };
                assert_eq!(of_all, values, "{path}");
            }
        }
    }
}

/// The first point, and every point of a key that changes nothing, differ by nothing; others by the mean of
/// the differences of their replicas, whose scatter makes the standard error.
#[test]
fn differences_are_those_of_two_runs() {
    for sampling in ["independent", "antithetic"] {
        let text = swept("material.work_of_adhesion = [\"0.08 J/m^2\", \"0.09 J/m^2\"]");
        let text = text.replace("seed = 1", &format!("seed = 1\nsampling = \"{sampling}\""));
        let folder = Folder::new(&text);
        assert_exit(&folder.stiction(&["run", "scene.toml"]), 0);
        let pull_off = |point: usize| {
            let name = format!("{point}.toml");
            std::fs::write(folder.path(&name), sweep(&text).text(point).unwrap()).unwrap();
            assert_exit(&folder.stiction(&["run", &name]), 0);
            let file = unlocked::open(folder.path(&format!("{point}.h5")));
            file.dataset("/replicas/pull_off_force").unwrap().read_raw::<f64>().unwrap()
        };
        let (first, second) = (pull_off(0), pull_off(1));
        let group = if sampling == "antithetic" { 2 } else { 1 };
        let mean_of = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
        let squared_error = |values: &[f64]| {
            let groups: Vec<f64> = values.chunks(group).map(mean_of).collect();
            let (n, mean) = (groups.len() as f64, mean_of(&groups));
            groups.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / (n - 1.0) / n
        };
        let differences: Vec<f64> = first.iter().zip(&second).map(|(a, b)| b - a).collect();
        let squared = squared_error(&differences);
        let ratio = (squared_error(&first) + squared_error(&second)) / squared;
        let all = unlocked::open(folder.path("scene.h5"));
        let found = |name: &str| {
            all.dataset(&format!("/differences/pull_off_force_{name}")).unwrap().read_raw::<f64>().unwrap()
        };
        for (name, expected) in
            [("mean", mean_of(&differences)), ("standard_error", squared.sqrt()), ("variance_ratio", ratio)]
        {
            assert!(
                (found(name)[1] / expected - 1.0).abs() < 1e-9,
                "{sampling} {name}: {:?} {expected}",
                found(name)
            );
        }
        // Of what is the same in all replicas there is no error.
        assert!(found("mean")[0] == 0.0 && found("standard_error")[0].is_nan());
        assert!(found("variance_ratio")[0].is_nan());
        // Random numbers in common are worth something: points so close vary together.
        assert!(ratio > 10.0, "{ratio}");
    }
}

/// Asperities that are nowhere near to flow do not depend on the hardness: what differs between such points
/// is the rounding of their sums, by moments over other cells. It is reported as nothing, and no variance is 1e26
/// times as small. Of 16 replicas that agree at most 1 − 0.05^(1/16) = 17.07 % of patches differ.
#[test]
fn differences_below_their_rounding_are_none() {
    let scene = swept("material.hardness = [\"9 GPa\", \"7 GPa\", \"5 GPa\"]")
        .replace("replicas = 40", "replicas = 16");
    let folder = Folder::new(&(scene + "\n[solver]\nsummation = \"moments\"\n"));
    let run = folder.stiction(&["run", "scene.toml"]);
    assert_exit(&run, 0);
    for part in ["no more than the rounding of the sums", "at most 17.07 % of patches differ"] {
        assert!(unbroken(&text(&run.stdout)).contains(part), "{part}: {}", text(&run.stdout));
    }
    let file = unlocked::open(folder.path("scene.h5"));
    let values = |name: &str| file.dataset(name).unwrap().read_raw::<f64>().unwrap();
    let forces = values("/replicas/pull_off_force");
    let (first, others) = forces.split_at(forces.len() / 3);
    assert!(others.iter().zip(first.iter().cycle()).any(|(other, first)| other != first), "nothing to round");
    for name in ["pull_off_force", "pull_off_separation", "peak_secant_stiffness"] {
        assert_eq!(values(&format!("/differences/{name}_mean")), [0.0; 3], "{name}");
        for none in ["standard_error", "variance_ratio"] {
            assert!(values(&format!("/differences/{name}_{none}")).iter().all(|one| one.is_nan()), "{name}");
        }
    }
}

/// The seeds are outputs of SplitMix64, computed by another implementation (Python, unbounded integers),
/// without their lowest bits.
#[test]
fn points_may_have_random_numbers_of_their_own() {
    let text = swept(
        "common_random_numbers = false\nsurface.lubricant_thickness = [\"0.5 nm\", \"0.6 nm\", \"0.7 nm\"]",
    );
    let folder = Folder::new(&text);
    for (seed, seeds) in [
        ("1", [0x910A_2DEC_8902_5CC1_u64, 0xBEEB_8DA1_658E_EC67, 0xF893_A2EE_FB32_555E]),
        ("7", [0x63CB_E1E4_5932_0DD7, 0x044C_3CD7_F43C_661C, 0xE698_4080_BAB1_2A02]),
    ] {
        assert_exit(&folder.stiction(&["run", "scene.toml", "--force", "--seed", seed]), 0);
        let all = unlocked::open(folder.path("scene.h5"));
        let found = all.dataset("/seed").unwrap().read_raw::<u64>().unwrap();
        assert_eq!(found, seeds.map(|seed| seed >> 1));
        let ratio =
            all.dataset("/differences/pull_off_force_variance_ratio").unwrap().read_raw::<f64>().unwrap();
        assert_eq!(ratio, [1.0; 3]);
        assert_eq!(number(&folder.path("scene.h5"), "/", "seed"), seed.parse::<f64>().unwrap());
    }
}

/// Ends a sweep with a signal when a file is there.
fn stopped(folder: &Folder, signal: &str, file: &str) -> std::process::Output {
    interrupt_at(folder, signal, file, &["--checkpoint", "0", "--threads", "1"])
}

fn long() -> String {
    swept("material.work_of_adhesion = [\"0.05 J/m^2\", \"0.09 J/m^2\", \"0.2 J/m^2\"]")
        .replace("= 40", "= 320")
        .replace("\"100 um^2\"", "\"50 um^2\"")
}

#[test]
#[ignore = "slow: seven seconds"]
fn an_interrupted_sweep_goes_on_to_the_same_bits() {
    let folder = Folder::new(&long());
    assert_exit(&folder.stiction(&["run", "scene.toml", "-o", "reference.h5"]), 0);
    for (signal, code) in [("-INT", Some(130)), ("-KILL", KILLED)] {
        let output = stopped(&folder, signal, "scene.h5.points/0002.h5.partial");
        assert_eq!(output.status.code(), code);
        assert!(folder.path("scene.h5.points/0001.h5").exists() && !folder.path("scene.h5").exists());
        let message = text(&output.stderr);
        if code.is_some() {
            for part in
                ["point 2 of 3 (material.work_of_adhesion = 90 mJ/m^2)", "1 of 3 points are kept", "--resume"]
            {
                assert!(message.contains(part), "{part}: {message}");
            }
        }
        let refused = folder.stiction(&["run", "scene.toml"]);
        assert_exit(&refused, 2);
        assert!(text(&refused.stderr).contains("--resume goes on with it"), "{}", text(&refused.stderr));
        assert_exit(&folder.stiction(&["run", "scene.toml", "--resume"]), 0);
        assert!(bits(&folder.path("reference.h5")) == bits(&folder.path("scene.h5")), "{signal}");
        assert_eq!(folder.files(), ["reference.h5", "scene.h5", "scene.toml"]);
        let again = folder.stiction(&["run", "scene.toml", "--resume"]);
        assert_exit(&again, 0);
        assert!(text(&again.stderr).contains("is complete: nothing to resume"));
        std::fs::remove_file(folder.path("scene.h5")).unwrap();
    }
}

/// Points of another sweep are not taken for those of this one, and what is no point is not removed.
#[test]
fn what_is_kept_of_another_sweep_is_refused() {
    let folder = Folder::new(&long());
    stopped(&folder, "-KILL", "scene.h5.points/0002.h5.partial");
    std::fs::write(folder.path("scene.toml"), long().replace("0.05 J", "0.06 J")).unwrap();
    let refused = folder.stiction(&["run", "scene.toml", "--resume"]);
    assert_exit(&refused, 2);
    let message = text(&refused.stderr);
    assert!(message.contains("0001.h5 is not point 1 of 3") && message.contains("--force"), "{message}");
    std::fs::write(folder.path("scene.h5.points/notes.txt"), "mine").unwrap();
    assert_exit(&folder.stiction(&["run", "scene.toml", "--force", "--replicas", "16"]), 0);
    assert_eq!(std::fs::read(folder.path("scene.h5.points/notes.txt")).unwrap(), b"mine");
    std::fs::remove_dir_all(folder.path("scene.h5.points")).unwrap();
    assert_eq!(folder.files(), ["scene.h5", "scene.toml"]);
}

/// What another run keeps under the name of a sweep that is complete is not of the sweep, and stays.
#[test]
fn a_complete_sweep_leaves_what_another_run_keeps() {
    let folder = Folder::new(&swept(GRID));
    std::fs::write(folder.path("other.toml"), small()).unwrap();
    for arguments in [&["scene.toml"][..], &["other.toml", "--shard", "1/2", "-o", "other.shard"]] {
        assert_exit(&folder.stiction(&[&["run"], arguments].concat()), 0);
    }
    std::fs::rename(folder.path("other.shard"), folder.path("scene.h5.partial")).unwrap();
    let again = folder.stiction(&["run", "scene.toml", "--resume"]);
    assert_eq!(text(&again.stderr), "scene.h5 is complete: nothing to resume\n");
    assert_eq!(folder.files(), ["other.toml", "scene.h5", "scene.h5.partial", "scene.toml"]);
}

/// Holm's correction: one point that disagrees is seen, and named.
#[test]
fn validate_sees_a_point_that_disagrees() {
    let folder = Folder::new(&swept(GRID));
    assert_exit(&folder.stiction(&["run", "scene.toml"]), 0);
    let agrees = folder.stiction(&["validate", "scene.h5"]);
    assert_exit(&agrees, 0);
    assert_eq!(text(&agrees.stdout).matches("agree\n").count(), 4, "{}", text(&agrees.stdout));
    {
        let file = unlocked::open_rw(folder.path("scene.h5"));
        let dataset = file.dataset("/integral/adhesion_force").unwrap();
        let mut forces = dataset.read_raw::<f64>().unwrap();
        let separations = forces.len() / 4;
        forces[2 * separations..3 * separations].iter_mut().for_each(|force| *force *= 1.1);
        dataset.write_raw(&forces).unwrap();
    }
    let disagrees = folder.stiction(&["validate", "scene.h5"]);
    assert_exit(&disagrees, 3);
    let said = text(&disagrees.stdout);
    assert!(said.contains("disagree at 1 of 4 points") && said.contains("Holm"), "{said}");
    assert!(said.lines().any(|line| line.contains("1, 0") && line.ends_with("disagree")), "{said}");
    let info = folder.stiction(&["info", "scene.h5"]);
    assert_exit(&info, 0);
    for part in ["stiction-sweep", "sweep_keys", "/differences\n", "pull_off_force_mean", "2 x 2"] {
        assert!(text(&info.stdout).contains(part), "{part}");
    }
}

/// A file that says of itself what is not so is refused in a line.
#[test]
fn sweeps_that_are_not_what_they_say_are_refused() {
    let folder = Folder::new(&swept(GRID));
    assert_exit(&folder.stiction(&["run", "scene.toml"]), 0);
    let keys = "surface.surface_height_std, surface.lubricant_thickness";
    let rewritten = |file: &hdf5::File, name: &str, text: &str| {
        file.delete_attr(name).unwrap();
        let text: hdf5::types::VarLenUnicode = text.parse().unwrap();
        file.new_attr::<hdf5::types::VarLenUnicode>().create(name).unwrap().write_scalar(&text).unwrap();
    };
    type Change<'a> = (&'a dyn Fn(&hdf5::File), &'static str);
    let whole_numbers = |file: &hdf5::File| {
        let path = "/ensemble/adhesion_force_mean";
        let shape = file.dataset(path).unwrap().shape();
        file.unlink(path).unwrap();
        let dataset = file.new_dataset::<i32>().shape(shape.clone()).create(path).unwrap();
        dataset.write_raw(&vec![1; shape.iter().product()]).unwrap();
    };
    // Every dataset over the separations claims to hold more than any machine does.
    let claims = |file: &hdf5::File| {
        let over =
            |variable: &&stiction::output::schema::Variable| variable.dimensions == [Dimension::Separation];
        let paths = RUN
            .variables
            .iter()
            .filter(over)
            .map(|variable| variable.path.as_str())
            .filter(|path| !path.ends_with("/separation"));
        for path in ["/ensemble/separation_index"].into_iter().chain(paths) {
            let Ok(dataset) = file.dataset(path) else { continue };
            let mut shape = dataset.shape();
            *shape.last_mut().unwrap() = 1_000_000_000_000_000;
            file.unlink(path).unwrap();
            let chunk: Vec<usize> = shape.iter().map(|length| *length.min(&(1 << 16))).collect();
            file.new_dataset::<f64>().shape(shape).chunk(chunk).create(path).unwrap();
        }
    };
    let changes: [Change<'_>; 8] = [
        (&whole_numbers, "a dataset /ensemble/adhesion_force_mean that does not hold numbers"),
        (&claims, "that has more values than the file holds"),
        (&|file| file.delete_attr("sweep_keys").unwrap(), "lacks the text `sweep_keys`"),
        (&|file| rewritten(file, "sweep_keys", "surface.surface_height_std"), "of the shape [2, 2], not [2]"),
        (&|file| rewritten(file, "sweep_keys", &[keys; 9].join(", ")), "has 18 dimensions of points"),
        (
            &|file| rewritten(file, "sweep_keys", "surface.no_such, surface.lubricant_thickness"),
            "lacks the dimension",
        ),
        (&|file| rewritten(file, "sweep_mode", "zip"), "lacks the dimension `point`"),
        (
            &|file| {
                file.dataset("/ensemble/adhesion_force_mean").unwrap().write_raw(&[f64::NAN; 64]).unwrap()
            },
            "has the value NaN at 0 of /ensemble/adhesion_force_mean of the point [0, 0]",
        ),
    ];
    for (change, message) in changes {
        std::fs::copy(folder.path("scene.h5"), folder.path("changed.h5")).unwrap();
        change(&unlocked::open_rw(folder.path("changed.h5")));
        let refused = folder.stiction(&["validate", "changed.h5"]);
        assert_exit(&refused, 2);
        let error = text(&refused.stderr);
        assert!(error.contains(message) && error.lines().count() == 1, "{message}: {error}");
    }
    // Whoever reads a point first is reported the same.
    std::fs::copy(folder.path("scene.h5"), folder.path("changed.h5")).unwrap();
    claims(&unlocked::open_rw(folder.path("changed.h5")));
    let reader = Reader::open(&folder.path("changed.h5"), &[&SWEEP]).unwrap();
    let error = reader.at_point::<f64>("/ensemble/adhesion_force_mean", &[0, 0]).unwrap_err().to_string();
    assert!(
        error.contains("/ensemble/adhesion_force_mean that has more values than the file holds"),
        "{error}"
    );
}

#[test]
fn check_says_what_all_points_take() {
    let folder = Folder::new(&swept(GRID));
    let check = folder.stiction(&["check", "scene.toml"]);
    assert_exit(&check, 0);
    for part in
        ["surface.surface_height_std: 2 values, 1.4 nm to 1.8 nm", "4 points (grid)", "first point", "memory"]
    {
        assert!(text(&check.stdout).contains(part), "{part}: {}", text(&check.stdout));
    }
    let compare = folder.stiction(&["compare", "scene.toml", "--laws", "gw"]);
    assert_exit(&compare, 2);
    assert!(text(&compare.stderr).contains("has a table [sweep]"), "{}", text(&compare.stderr));
    assert_eq!(folder.files(), ["scene.toml"]);
}

#[test]
fn lists_and_ranges_have_the_values_that_they_say() {
    let values =
        |text: &str| sweep(&swept(text)).axes.iter().map(|axis| axis.values.clone()).collect::<Vec<_>>();
    assert_eq!(
        values(
            "material.hardness = [\"2 GPa\", \"1.5 GPa\"]\n\"surface.lubricant_thickness\" = [0, \"1 nm\"]"
        ),
        [vec![2e9, 1.5e9], vec![0.0, 1e-9]]
    );
    let linear = values("surface.lubricant_thickness = { from = \"0 nm\", to = \"2 nm\", count = 5 }");
    assert!(
        linear[0].iter().zip([0.0, 0.5e-9, 1e-9, 1.5e-9, 2e-9]).all(|(a, b)| (a - b).abs() < 1e-24),
        "{linear:?}"
    );
    let log = values(
        "material.work_of_adhesion = { from = \"0.01 J/m^2\", to = \"0.16 J/m^2\", count = 5, spacing = \"log\" }",
    );
    assert!(
        log[0].iter().zip([0.01, 0.02, 0.04, 0.08, 0.16]).all(|(a, b)| (a / b - 1.0).abs() < 1e-15),
        "{log:?}"
    );
    assert_eq!((log[0][0], log[0][4]), (0.01, 0.16));
    // In the order of the text, not of the alphabet; the last runs fastest.
    let grid = sweep(&swept(
        "surface.lubricant_thickness = [\"0 nm\", \"1 nm\"]\nmaterial.hardness = [\"1 GPa\", \"2 GPa\", \"3 GPa\"]",
    ));
    assert_eq!((grid.shape(), grid.count(), grid.place(4)), (vec![2, 3], 6, vec![1, 1]));
    assert_eq!(grid.values(4), [1e-9, 2e9]);
    let zip = sweep(&swept(
        "mode = \"zip\"\nmaterial.hardness = [\"1 GPa\", \"1 GPa\"]\nsurface.lubricant_thickness = [\"0 nm\", \"1 nm\"]",
    ));
    assert_eq!((zip.mode, zip.shape(), zip.values(1)), (Mode::Zip, vec![2], vec![1e9, 1e-9]));
    // A key that the scene does not have, in a table that it does not have.
    let added = small()
        .replace("surface_height_std", "asperity_height_std")
        .replace("lubricant_thickness = \"0.5 nm\"      # inferred\n", "");
    let text = format!("{added}\n[sweep]\nsurface.lubricant_thickness = [\"1 nm\"]\n");
    assert!(sweep(&text).text(0).unwrap().contains("lubricant_thickness = \"1e-9 m\""));
    assert_eq!(Document::parse(&text, Arc::new(NoFiles)).unwrap().scene.asperity.lubricant_thickness, 1e-9);
}

#[test]
fn what_cannot_be_swept_is_refused_with_what_would_do() {
    let hardness = "material.hardness = [\"1 GPa\", \"2 GPa\"]";
    for (sweep, parts) in [
        ("", ["`sweep = ", "names no key"]),
        (
            "material.hardnes = [\"1 GPa\"]",
            ["`sweep.material.hardnes = ", "did you mean `material.hardness`?"],
        ),
        ("ensemble.replicas = [1, 2]", ["`sweep.ensemble.replicas", "all points have the same replicas"]),
        ("ensemble.seed = [1, 2]", ["`sweep.ensemble.seed", "common_random_numbers = false"]),
        ("separation.h_star = [1, 2]", ["`sweep.separation", "give them in [separation]"]),
        ("model.law = [\"edm\"]", ["`sweep.model.law[0] = \"edm\"`", "known: md_plastic, hybrid, emd"]),
        ("model.history = [\"loop\"]", ["`sweep.model.history", "give it in [model]"]),
        ("title = [\"a\"]", ["`sweep.title", "is that of the whole file"]),
        ("mode = \"cube\"\nmaterial.hardness = [\"1 GPa\"]", ["`sweep.mode = \"cube\"`", "known: grid, zip"]),
        ("common_random_numbers = 1", ["`sweep.common_random_numbers = 1`", "true or false"]),
        (
            "material.hardness = \"1 GPa\"",
            ["`sweep.material.hardness", "a list, or a table { from, to, count, spacing }"],
        ),
        ("material.hardness = []", ["`sweep.material.hardness = []`", "has 0 values"]),
        ("material.hardness = [1e9]", ["`sweep.material.hardness[0] = 1e9`", "the unit is missing"]),
        (
            "material.hardness = [\"1 GPa\", \"1e9 Pa\"]",
            ["`sweep.material.hardness", "has the value 1 GPa twice"],
        ),
        (
            "material.hardness = { from = \"1 GPa\", to = \"2 GPa\" }",
            ["sweep.material.hardness.count", "is missing"],
        ),
        (
            "material.hardness = { from = \"1 GPa\", to = \"2 GPa\", count = 1 }",
            ["count = 1`", "from 2 to 10000"],
        ),
        (
            "material.hardness = { from = \"1 GPa\", to = \"2 GPa\", steps = 3 }",
            ["hardness.steps", "known here: from, to"],
        ),
        (
            "surface.lubricant_thickness = { from = 0, to = \"2 nm\", count = 3, spacing = \"log\" }",
            ["spacing = \"log\"", "greater than 0"],
        ),
        ("material = 3", ["`sweep.material = 3`", "a table is needed"]),
    ] {
        let message = refusal(&swept(sweep));
        // What is missing is on no line.
        let placed = message.starts_with("line ") || message.contains("is missing");
        assert!(parts.iter().all(|part| message.contains(part)) && placed, "{sweep}: {message}");
    }
    let twice = format!("{hardness}\n\"material.hardness\" = [\"1 GPa\"]");
    assert!(refusal(&swept(&twice)).contains("the key is swept twice"));
    let ragged = format!("mode = \"zip\"\n{hardness}\nsurface.lubricant_thickness = [0]");
    assert!(refusal(&swept(&ragged)).contains("has 1 values, but `material.hardness` has 2"));
    let count = "{ from = \"1 GPa\", to = \"2 GPa\", count = 101 }";
    let large = format!("material.hardness = {count}\nmaterial.reduced_modulus = {count}");
    assert!(refusal(&swept(&large)).contains(&format!("101 x 101 points; at most {MOST_POINTS}")));
    // What is wrong at one point is said of that point, with the line where it is one of the text.
    let point = refusal(&swept("material.poisson_ratio = [0.3, 0.4, 0.6]"));
    assert!(
        point.contains("point 3 of 3 (`material.poisson_ratio = 0.6`)") && point.contains("at most 0.5"),
        "{point}"
    );
    let other = refusal(&swept(hardness).replace("seed = 1", "seed = -1"));
    let line = 1 + swept(hardness).lines().position(|line| line == "seed = 1").unwrap();
    assert!(other.starts_with(&format!("line {line}: at point 1 of 2")), "{other}");
}

/// A refused sweep leaves nothing, not even where a law cannot be made for one of the points.
#[test]
fn nothing_is_written_of_a_sweep_that_is_refused() {
    let scene = swept("material.work_of_adhesion = [\"0.09 J/m^2\", \"0.1 J/m^2\"]");
    let folder = Folder::new(&scene);
    for arguments in [&["--replicas", "-1"][..], &["-o", "scene.toml"], &["-o", "nowhere/out.h5"]] {
        assert_exit(&folder.stiction(&[&["run", "scene.toml"], arguments].concat()), 2);
        assert_eq!(folder.files(), ["scene.toml"]);
    }
    std::fs::write(folder.path("scene.toml"), scene.replace("poisson_ratio = 0.27", "poisson_ratio = 0.7"))
        .unwrap();
    assert_exit(&folder.stiction(&["run", "scene.toml"]), 2);
    assert_eq!(folder.files(), ["scene.toml"]);
}

/// All dimensions of a run have a counterpart in a sweep, and the layout of sweeps knows the scales of these in
/// every group. No key of a sweep has the name of a dataset.
#[test]
fn every_dimension_of_a_run_is_one_of_sweeps() {
    for variable in SWEEP.known() {
        for dimension in &variable.dimensions {
            let path = format!("{}/{}", variable.group(), dimension.of_points().name());
            assert_eq!(SWEEP.variable(&path).scales(), Some(dimension.of_points()));
        }
    }
    for key in KEYS.iter().filter(|key| key.is_swept) {
        let name = name_of_key(key.name);
        assert!(!name.contains('.') && SWEEP.known().all(|variable| variable.name() != name), "{name}");
    }
    assert_eq!(Dimension::Separation.of_points(), Dimension::SeparationIndex);
    assert!(Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/sweep-format.md").exists());
}

/// Targets end each point by itself, where the run of its scene ends. What one point has more is NaN at the others, and
/// differences are those of the replicas that both have.
#[test]
fn points_end_at_their_own_targets() {
    let target = "target = { quantity = \"pull_off_force\", relative_standard_error = 0.06 }\n\
                  min_replicas = 16\nmax_replicas = 2000";
    let text =
        swept("material.work_of_adhesion = [\"0.05 J/m^2\", \"0.2 J/m^2\"]").replace("replicas = 40", target);
    let folder = Folder::new(&text);
    assert_exit(&folder.stiction(&["run", "scene.toml"]), 0);
    assert_exit(&folder.stiction(&["validate", "scene.h5"]), 0);
    let all = unlocked::open(folder.path("scene.h5"));
    let read = |file: &hdf5::File, name: &str| file.dataset(name).unwrap().read_raw::<f64>().unwrap();
    let counts = all.dataset("/replica_count").unwrap().read_raw::<u64>().unwrap();
    let forces = read(&all, "/replicas/pull_off_force");
    let most = forces.len() / 2;
    let mut own: Vec<Vec<f64>> = Vec::new();
    for (point, count) in counts.iter().enumerate() {
        std::fs::write(folder.path("point.toml"), sweep(&text).text(point).unwrap()).unwrap();
        assert_exit(&folder.stiction(&["run", "point.toml", "--force"]), 0);
        let single = read(&unlocked::open(folder.path("point.h5")), "/replicas/pull_off_force");
        let (there, beyond) = forces[point * most..(point + 1) * most].split_at(*count as usize);
        assert_eq!(there, single);
        assert!(beyond.iter().all(|force| force.is_nan()));
        own.push(single);
    }
    assert!(counts[0] != counts[1] && most == *counts.iter().max().unwrap() as usize, "{counts:?}");
    let pairs: Vec<f64> = own[0].iter().zip(&own[1]).map(|(first, other)| other - first).collect();
    let mean = pairs.iter().sum::<f64>() / pairs.len() as f64;
    let reported = read(&all, "/differences/pull_off_force_mean")[1];
    assert!((reported / mean - 1.0).abs() < 1e-12, "{reported:e} {mean:e}");
}

/// The ends of a range are the doubles that are given, which its formula gives to rounding only: 3 · (49/3) is not 49 there.
#[test]
fn ranges_end_where_they_say() {
    for (key, from, to, spacing, ends) in [
        ("material.work_of_adhesion", "0.03 J/m^2", "0.49 J/m^2", "log", [0.03, 0.49]),
        ("surface.lubricant_thickness", "7 nm", "38 nm", "linear", [7e-9, 38e-9]),
    ] {
        let range =
            format!("{key} = {{ from = \"{from}\", to = \"{to}\", count = 4, spacing = \"{spacing}\" }}");
        let values = &sweep(&swept(&range)).axes[0].values;
        assert_eq!([values[0], values[3]], ends, "{key}");
    }
}
