//! The tree in which batches are merged: the same bits however its leaves are divided, and moments that are
//! those of all replicas.

use crate::common::{bytes, case, job, reread};
use std::sync::atomic::AtomicBool;
use stiction::asperity::{Path, Quantity};
use stiction::engine::{Bounds, Ensemble, Job, Outcome, ReductionTree, Replica, Shard, run_from};
use stiction::surface::Surface;

/// Batches of the run: no power of two, and the last one is not whole.
const BATCHES: u64 = 27;
const REPLICAS: u64 = 8 * BATCHES - 3;

struct Scene {
    law: Box<dyn stiction::asperity::Law>,
    surface: Surface,
    separations: Vec<f64>,
}

fn scene() -> Scene {
    let (asperity, mut surface) = case("II");
    surface.asperity_count = 40;
    let separations: Vec<f64> = (0..9).map(|k| 0.5 * f64::from(k) * surface.surface_height_std).collect();
    Scene {
        law: crate::common::law("hybrid", &asperity, Path::Approach, (-3e-8, 3e-8)),
        surface,
        separations,
    }
}

fn computed(job: &Job<'_>, start: ReductionTree) -> ReductionTree {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build().unwrap();
    let bounds = Bounds { merged: start, rule: None };
    match run_from::<()>(job, &pool, &AtomicBool::new(false), bounds, |_, _| Ok(())) {
        Ok(Outcome::Complete(reduction_tree)) => *reduction_tree,
        other => panic!("the run did not complete: {other:?}"),
    }
}

fn bits(ensemble: &Ensemble) -> (Vec<u8>, Vec<u8>) {
    (bytes(ensemble), bytes(&ensemble.replicas))
}

/// Ranges of batches are merged by themselves, written, read and put together.
#[test]
fn bits_do_not_depend_on_how_batches_are_divided() {
    let scene = scene();
    let job = job(scene.law.as_ref(), &scene.surface, &scene.separations, REPLICAS);
    let whole = computed(&job, ReductionTree::of(&job));
    assert!(whole.is_complete() && whole.replicas.len() as u64 == REPLICAS);
    let whole = bits(&whole.into_ensemble(&job));
    for count in [1, 2, 3, 5, 16, 27, 40] {
        let mut merged = ReductionTree::of(&job);
        for index in 1..=count {
            let own = computed(&job, ReductionTree::new(Shard { index, count }.range(BATCHES)));
            // A run of consecutive leaves needs no more nodes than the two flanks of a tree have levels.
            let empty = bytes(&Ensemble::new(&job)).len();
            assert!(bytes(&own).len() < 9 * empty, "{count}");
            let restored = reread(&own).restored(&job).unwrap();
            assert!(restored == own);
            merged.append(restored);
        }
        assert!(merged.is_complete());
        assert!(bits(&merged.into_ensemble(&job)) == whole, "{count} shards");
    }
}

/// What is missing changes nothing but that it is missing: the moments are those of the replicas that are
/// there, by two passes.
#[test]
fn what_is_missing_is_left_out() {
    let scene = scene();
    let job = job(scene.law.as_ref(), &scene.surface, &scene.separations, REPLICAS);
    let mut merged = ReductionTree::of(&job);
    for index in [1, 2, 5, 9] {
        merged.append(computed(&job, ReductionTree::new(Shard { index, count: 9 }.range(BATCHES))));
    }
    let whole = computed(&job, ReductionTree::of(&job)).replicas;
    let there: Vec<Replica> =
        [0..48, 96..120, 192..REPLICAS as usize].into_iter().flat_map(|r| whole[r].to_vec()).collect();
    assert!(merged.replicas == there);
    let merged = merged.into_ensemble(&job);
    let n = there.len() as f64;
    assert_eq!(merged.regime_count.count() as usize, there.len());
    let forces: Vec<f64> = there.iter().map(|replica| replica.pull_off_force).collect();
    let mean = forces.iter().sum::<f64>() / n;
    let parts = stiction::math::control_variates::controlled_means(&merged.groups.scalars, &[]);
    assert!((parts[0].mean / mean - 1.0).abs() < 1e-13, "{} {mean}", parts[0].mean);
    let square = forces.iter().map(|force| (force - mean).powi(2)).sum::<f64>() / (n - 1.0) / n;
    assert!((parts[0].standard_error / square.sqrt() - 1.0).abs() < 1e-12);
    let counted: f64 = merged.curves[Quantity::ContactArea.index()].mean().iter().sum();
    assert!(counted.is_finite());
}

#[test]
fn a_state_of_another_job_or_range_is_refused() {
    let scene = scene();
    let job = job(scene.law.as_ref(), &scene.surface, &scene.separations, REPLICAS);
    let own = computed(&job, ReductionTree::new(3..9));
    let read = |job: &Job<'_>, state: &[u8], replicas: &[Replica], curves: &[f64]| {
        let mut tree: ReductionTree = postcard::from_bytes(state).ok()?;
        (tree.replicas, tree.first_curves) = (replicas.to_vec(), curves.to_vec());
        tree.restored(job)
    };
    let restored =
        |job: &Job<'_>, state: &[u8], replicas: &[Replica]| read(job, state, replicas, &own.first_curves);
    let state = bytes(&own);
    assert!(restored(&job, &state, &own.replicas).is_some());
    assert!(restored(&job, &state, &own.replicas[1..]).is_none());
    assert!(read(&job, &state, &own.replicas, &own.first_curves[1..]).is_none());
    assert!(restored(&job, &state[..state.len() - 1], &own.replicas).is_none());
    assert!(restored(&Job { replicas: 64, ..job }, &state, &own.replicas).is_none());
    assert!(restored(&Job { separations: &scene.separations[1..], ..job }, &state, &own.replicas).is_none());
    // Begin, end and next batch, number of nodes, begin and end of the first: a byte each.
    assert_eq!(state[..6], [3, 9, 9, 3, 3, 4]);
    for place in 0..6 {
        for change in [1, 40, 127] {
            let mut wrong = state.clone();
            wrong[place] = (wrong[place] + change) % 128;
            let found = restored(&job, &wrong, &own.replicas);
            // Its range may be longer than what is there.
            assert!(
                found.is_none_or(|reduction_tree| place == 1 && !reduction_tree.is_complete()),
                "{place} {change}"
            );
        }
    }
    assert!(restored(&job, &[], &[]).is_none());
}
