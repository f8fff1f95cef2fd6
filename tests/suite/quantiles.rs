//! Quantiles of the external force against a plain count of the curves of the first replicas, whatever the threads,
//! shards and interruptions; and the warnings of a run in its file.

use crate::common::program::{Folder, assert_exit, attribute, bits, labelled, small, text};
use crate::common::{case, law, unlocked};
use std::path::Path;
use std::process::Output;
use std::sync::atomic::AtomicBool;
use stiction::asperity;
use stiction::engine::{Ensemble, Job, Outcome, run};

const PROBABILITIES: [f64; 5] = [0.05, 0.25, 0.5, 0.75, 0.95];

/// A quantile by counting: the values that so many others are below, and linearly between two of them.
fn counted(values: &[f64], probability: f64) -> f64 {
    let of_rank = |rank: usize| {
        let is_it = |value: &&f64| {
            let below = values.iter().filter(|other| other < value).count();
            let equal = values.iter().filter(|other| other == value).count();
            (below..below + equal).contains(&rank)
        };
        *values.iter().find(is_it).unwrap()
    };
    let place = probability * (values.len() - 1) as f64;
    let share = place.fract();
    let next = if share > 0.0 { of_rank(place as usize + 1) } else { 0.0 };
    (1.0 - share) * of_rank(place as usize) + share * next
}

/// Has quantiles, a row over the states for each probability, be those of curves.
#[track_caller]
fn assert_counted(quantiles: &[f64], curves: &[Vec<f64>]) {
    let states = curves[0].len();
    assert_eq!(quantiles.len(), PROBABILITIES.len() * states);
    for (i, quantile) in quantiles.iter().enumerate() {
        let (row, state) = (i / states, i % states);
        let values: Vec<f64> = curves.iter().map(|curve| curve[state]).collect();
        let expected = counted(&values, PROBABILITIES[row]);
        let size = values.iter().fold(0.0, |size: f64, force| size.max(force.abs()));
        assert!((quantile - expected).abs() <= 1e-14 * size, "{row} {state}: {quantile:e}, not {expected:e}");
    }
}

/// Of 1040 replicas the last 40 do not count, and threads do not matter.
#[test]
fn quantiles_are_of_the_first_thousand_replicas() {
    let (asperity, mut surface) = case("II");
    surface.asperity_count = 20;
    let separations: Vec<f64> = (-1..4).map(|i| f64::from(i) * surface.surface_height_std).collect();
    let law = law("dmt", &asperity, asperity::Path::Approach, (-60e-9, 40e-9));
    let job = Job { keep_curves: true, ..crate::common::job(law.as_ref(), &surface, &separations, 1040) };
    let on = |threads: usize| -> (Ensemble, Vec<f64>) {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let mut curves = Vec::new();
        let outcome = run::<()>(&job, &pool, &AtomicBool::new(false), |batch, _| {
            curves.extend_from_slice(&batch.external_force);
            Ok(())
        });
        let Ok(Outcome::Complete(tree)) = outcome else { panic!("the run did not complete") };
        (tree.into_ensemble(&job), curves)
    };
    let (ensemble, curves) = on(1);
    let curves: Vec<Vec<f64>> = curves.chunks_exact(separations.len()).map(<[f64]>::to_vec).collect();
    assert_eq!(curves.len(), 1040);
    let quantiles = ensemble.external_force_quantiles(&PROBABILITIES).concat();
    assert_counted(&quantiles, &curves[..1000]);
    assert_eq!(on(2).0, ensemble);
    let few = Job { replicas: 19, ..job }.ensemble();
    assert!(few.external_force_quantiles(&PROBABILITIES).concat().iter().all(|force| force.is_nan()));
    let enough = Job { replicas: 20, ..job }.ensemble();
    assert_counted(&enough.external_force_quantiles(&PROBABILITIES).concat(), &curves[..20]);
}

/// A scene of so many replicas of a patch of some seven asperities, with their curves.
fn scene(replicas: usize) -> String {
    small()
        .replace("count = 16", "count = 4")
        .replace("\"100 um^2\"", "\"1 um^2\"")
        .replace("replicas = 40", &format!("replicas = {replicas}"))
        .replace("curves = false", "curves = true")
}

/// The quantiles of a file and the curves of those of its replicas that are among the first thousand of the run.
fn read(path: &Path, way: &str) -> (Vec<f64>, Vec<Vec<f64>>) {
    let file = unlocked::open(path);
    let numbers = |name: &str| file.dataset(name).unwrap().read_raw::<f64>().unwrap();
    let quantiles = numbers(&format!("/ensemble/{way}external_force_quantile"));
    assert_eq!(numbers("/ensemble/quantile"), PROBABILITIES);
    let (curves, replicas) =
        (numbers(&format!("/replicas/{way}external_force")), numbers("/replicas/replica"));
    let rows = curves.chunks_exact(curves.len() / replicas.len()).zip(&replicas);
    (quantiles, rows.filter(|(_, replica)| **replica < 1000.0).map(|(row, _)| row.to_vec()).collect())
}

/// Of a run, of its shards together, and of those of them that are there: the last ones have few of the first
/// replicas.
#[test]
fn merged_shards_have_the_quantiles_of_the_replicas_that_are_there() {
    let folder = Folder::new(&scene(1032).replace("\"approach\"", "\"loop\"").replace("hybrid", "jkr"));
    assert_exit(&folder.stiction(&["run", "scene.toml", "--threads", "1", "-o", "whole.h5"]), 0);
    for way in ["", "retraction_"] {
        let (quantiles, curves) = read(&folder.path("whole.h5"), way);
        assert_eq!(curves.len(), 1000);
        assert_counted(&quantiles, &curves);
    }
    let [there, back] = ["", "retraction_"].map(|way| read(&folder.path("whole.h5"), way).0);
    assert!(there != back, "both ways are one, and may be mixed up");
    for index in ["1", "2", "3"] {
        let shard = format!("{index}/3");
        assert_exit(&folder.stiction(&["run", "scene.toml", "--shard", &shard, "-o", index]), 0);
    }
    assert_exit(&folder.stiction(&["merge", "3", "1", "2", "-o", "merged.h5"]), 0);
    assert!(bits(&folder.path("merged.h5")) == bits(&folder.path("whole.h5")));
    assert_exit(&folder.stiction(&["merge", "3", "--partial", "-o", "last.h5"]), 0);
    let (quantiles, curves) = read(&folder.path("last.h5"), "retraction_");
    assert_eq!(curves.len(), 1000 - 688);
    assert_counted(&quantiles, &curves);
    // The last shard of many has none of them.
    assert_exit(&folder.stiction(&["run", "scene.toml", "--shard", "43/43", "-o", "43"]), 0);
    assert_exit(&folder.stiction(&["merge", "43", "--partial", "-o", "none.h5"]), 0);
    assert!(read(&folder.path("none.h5"), "").0.iter().all(|force| force.is_nan()));
    for name in ["whole.h5", "last.h5", "none.h5"] {
        assert_exit(&folder.stiction(&["validate", name]), 0);
    }
}

/// Of coupled asperities they are of the curves with coupling; shards make no difference.
#[test]
#[ignore = "slow: two seconds"]
fn coupled_replicas_have_quantiles_too() {
    let folder = Folder::new(
        &(scene(24).replace("from = -1.0", "from = 1.0") + "\n[substrate]\ncoupling = \"patch\"\n"),
    );
    assert_exit(&folder.stiction(&["run", "scene.toml", "-o", "whole.h5"]), 0);
    let (quantiles, curves) = read(&folder.path("whole.h5"), "");
    assert_counted(&quantiles, &curves);
    for index in ["1", "2"] {
        let shard = format!("{index}/2");
        assert_exit(&folder.stiction(&["run", "scene.toml", "--shard", &shard, "-o", index]), 0);
    }
    assert_exit(&folder.stiction(&["merge", "1", "2", "-o", "merged.h5"]), 0);
    assert!(bits(&folder.path("merged.h5")) == bits(&folder.path("whole.h5")));
    assert_exit(&folder.stiction(&["validate", "whole.h5"]), 0);
}

/// Each point of a sweep has those of its own, and each law of a comparison.
#[test]
fn points_and_laws_have_quantiles_of_their_own() {
    let folder = Folder::new(&scene(24));
    let swept = scene(24) + "\n[sweep]\n\"material.work_of_adhesion\" = [\"0.01 J/m^2\", \"0.04 J/m^2\"]\n";
    std::fs::write(folder.path("swept.toml"), swept).unwrap();
    assert_exit(&folder.stiction(&["run", "swept.toml"]), 0);
    let file = unlocked::open(folder.path("swept.h5"));
    let numbers = |name: &str| file.dataset(name).unwrap().read_raw::<f64>().unwrap();
    let (quantiles, curves) =
        (numbers("/ensemble/external_force_quantile"), numbers("/replicas/external_force"));
    for (quantiles, curves) in quantiles.chunks_exact(20).zip(curves.chunks_exact(24 * 4)) {
        assert_counted(quantiles, &curves.chunks_exact(4).map(<[f64]>::to_vec).collect::<Vec<_>>());
    }
    let compare = ["compare", "scene.toml", "--laws", "emd,hybrid", "--ensemble", "-o", "laws.h5"];
    assert_exit(&folder.stiction(&compare), 0);
    assert_exit(&folder.stiction(&["run", "scene.toml", "-o", "own.h5"]), 0);
    let quantiles = unlocked::open(folder.path("laws.h5"));
    let quantiles = quantiles.dataset("/ensemble/external_force_quantile").unwrap();
    assert_eq!(quantiles.shape(), [2, 5, 4]);
    assert_eq!(quantiles.read_raw::<f64>().unwrap()[20..], read(&folder.path("own.h5"), "").0);
    for name in ["swept.h5", "laws.h5"] {
        assert_exit(&folder.stiction(&["validate", name]), 0);
    }
}

/// What the summary warns of, a line each: of a sweep with the points, and of nothing where there is nothing.
#[test]
fn the_file_has_the_warnings_of_the_summary() {
    // A summary has behind each finding what to change.
    let agree = |path: &Path, said: &Output| {
        let (found, rows) = (attribute(path, "/", "warnings"), labelled(&text(&said.stdout), "warning"));
        assert_eq!(found.lines().count(), rows.len(), "{found} {rows:?}");
        assert!(found.lines().zip(&rows).all(|(finding, row)| row.starts_with(finding)), "{found} {rows:?}");
        rows.len()
    };
    let soft = small().replace("\"100 um^2\"", "\"4 um^2\"");
    let folder = Folder::new(&soft);
    let run = folder.stiction(&["run", "scene.toml"]);
    assert_exit(&run, 0);
    assert!(agree(&folder.path("scene.h5"), &run) > 0);
    let own = attribute(&folder.path("scene.h5"), "/", "warnings");
    let axis =
        "\n[sweep]\n\"material.work_of_adhesion\" = [\"0.09 J/m^2\", \"0.0900001 J/m^2\", \"0.05 J/m^2\"]\n";
    std::fs::write(folder.path("swept.toml"), soft + axis).unwrap();
    assert_exit(&folder.stiction(&["run", "swept.toml"]), 0);
    let of_points = attribute(&folder.path("swept.h5"), "/", "warnings");
    let at = " (at 2 of 3 points, first at material.work_of_adhesion = 90 mJ/m^2)";
    let of_both: Vec<&str> = of_points.lines().filter_map(|line| line.strip_suffix(at)).collect();
    assert!(of_both.iter().all(|both| own.lines().any(|line| line == *both)), "{of_points}\n{own}");
    let at = " (at material.work_of_adhesion = 50 mJ/m^2)";
    let others = of_points.lines().filter(|line| line.ends_with(at) || line.ends_with(" (at all points)"));
    assert_eq!((of_both.is_empty(), of_both.len() + others.count()), (false, of_points.lines().count()));
    let wide = Folder::new(&small().replace("count = 16", "count = 73"));
    let run = wide.stiction(&["run", "scene.toml"]);
    assert_exit(&run, 0);
    agree(&wide.path("scene.h5"), &run);
}

/// Files of the versions before have neither, and are read as ever.
#[test]
fn files_without_quantiles_and_warnings_are_read() {
    let folder = Folder::new(&scene(40));
    assert_exit(&folder.stiction(&["run", "scene.toml"]), 0);
    let file = unlocked::open_rw(folder.path("scene.h5"));
    let ensemble = file.group("ensemble").unwrap();
    ["external_force_quantile", "quantile"].iter().for_each(|name| ensemble.unlink(name).unwrap());
    file.delete_attr("warnings").unwrap();
    drop(ensemble);
    file.close().unwrap();
    for command in ["validate", "info"] {
        assert_exit(&folder.stiction(&[command, "scene.h5"]), 0);
    }
}
