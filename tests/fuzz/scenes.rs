//! Scenes that mean harm: [`Scene::parse`] neither panics nor takes more time and memory than the text is
//! long, says what is wrong in a line for each problem, and accepts only what can be computed.

use super::text::{Mutation, changed, changes};
use super::{ALLOCATOR, cases, runner};
use proptest::prelude::*;
use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};
use stiction::asperity::{MODELS, Model};
use stiction::estimate::{Estimate, Plan};
use stiction::scene::files::NoFiles;
use stiction::scene::{Document, Scene};

/// Time that reading takes at most: for any text, and for each byte of it; a hundred times what it does take.
const TIME: (Duration, Duration) = (Duration::from_millis(20), Duration::from_micros(5));
/// Bytes that reading allocates at most, freed ones included: for any text, and for each byte of it.
const MEMORY: (usize, usize) = (256 << 10, 1 << 10);
/// Longest line of a message, bytes, and most lines.
const MESSAGE: (usize, usize) = (1000, 21);
/// Of so many scenes that are accepted one is planned, and of so many one under every law.
const PLANNED: (u32, u32) = (64, 2048);

/// The shipped scenes, and the corpus; in it are some that have to be refused, as their names say.
fn seeds() -> Vec<(bool, String)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let folders = ["configs", "configs/paper", "tests/corpus/scenes"].map(|folder| root.join(folder));
    let entries = folders
        .iter()
        .flat_map(|folder| std::fs::read_dir(folder).unwrap())
        .map(|entry| entry.unwrap().path());
    let mut files: Vec<_> =
        entries.filter(|path| path.extension().is_some_and(|extension| extension == "toml")).collect();
    files.sort();
    assert!(files.len() > 15, "{}", files.len());
    let refused = |file: &Path| file.file_name().unwrap().to_str().unwrap().starts_with("refused_");
    files.iter().map(|file| (!refused(file), std::fs::read_to_string(file).unwrap())).collect()
}

#[test]
fn every_scene_is_read_or_refused_in_a_line() {
    let _alone = super::alone();
    let seeds = seeds();
    let (mut accepted, mut refused) = (0_u32, 0_u32);
    for (right, seed) in &seeds {
        let before = accepted;
        check(seed, &mut accepted, &mut refused);
        assert_eq!(accepted > before, *right, "{seed}");
    }
    let mutation = (proptest::sample::select(changes()), any::<u32>(), any::<u32>());
    let strategy = (0..seeds.len(), proptest::collection::vec(mutation, 1..5));
    let counts = std::cell::Cell::new((0, 0));
    let case = |(seed, mutations): (usize, Vec<Mutation>)| {
        let (mut accepted, mut refused) = counts.get();
        check(&changed(&seeds[seed].1, &mutations), &mut accepted, &mut refused);
        counts.set((accepted, refused));
        Ok(())
    };
    runner(cases(4_000)).run(&strategy, case).unwrap();
    let (accepted, refused) = counts.get();
    println!("scenes: {accepted} accepted, {refused} refused");
    assert!(accepted.min(refused) > (accepted + refused) / 10, "too hard or too easy: {accepted}, {refused}");
}

fn check(text: &str, accepted: &mut u32, refused: &mut u32) {
    match parsed(text) {
        Ok(scene) => {
            *accepted += 1;
            can_be_computed(&scene);
            if accepted.is_multiple_of(PLANNED.1) {
                MODELS.iter().for_each(|model| can_be_planned(&scene, model));
            } else if accepted.is_multiple_of(PLANNED.0) {
                can_be_planned(&scene, &scene.model);
            }
        }
        Err(message) => {
            *refused += 1;
            reported(&message, text);
        }
    }
}

/// Every problem is reported in a line of its own, which names a line of the text or a key.
fn reported(message: &str, text: &str) {
    assert!((1..=MESSAGE.1).contains(&message.lines().count()), "{message}");
    for line in message.lines() {
        assert!(line.len() <= MESSAGE.0 && !line.contains(char::is_control), "{line:?}");
        let named =
            line.starts_with("line ") || line.contains(['`', '[']) || line.contains("check their units");
        assert!(named || line == "not TOML: recursion limit", "names neither line nor key: {line}");
        if let Some(number) = line.strip_prefix("line ").and_then(|rest| rest.split(':').next()) {
            assert!((1..=text.lines().count().max(1) + 1).contains(&number.parse().unwrap()), "{line}");
        }
    }
}

/// Sweeps that mean harm: reading all points neither panics nor keeps more than the sweep takes, and the
/// scenes of all points are such as can be computed.
#[test]
fn every_sweep_is_read_or_refused_in_a_line() {
    let _alone = super::alone();
    let seeds: Vec<String> =
        seeds().into_iter().map(|(_, seed)| seed).filter(|seed| seed.contains("sweep")).collect();
    assert!(seeds.len() >= 9, "{}", seeds.len());
    let mutation = (proptest::sample::select(changes()), any::<u32>(), any::<u32>());
    let strategy = (0..seeds.len(), proptest::collection::vec(mutation, 0..4));
    let counts = std::cell::Cell::new((0, 0));
    let case = |(seed, mutations): (usize, Vec<Mutation>)| {
        let text = changed(&seeds[seed], &mutations);
        let before = ALLOCATOR.allocated();
        match Document::parse(&text, Arc::new(NoFiles)) {
            Ok(Document { sweep: Some(sweep), scene }) => {
                counts.set((counts.get().0 + 1, counts.get().1));
                let kept = ALLOCATOR.allocated().saturating_sub(before);
                assert!(kept <= MEMORY.0 + MEMORY.1 * text.len(), "{kept} bytes for {} bytes", text.len());
                assert_eq!(scene.text, sweep.text(0).unwrap());
                for point in [0, sweep.count() / 2, sweep.count() - 1] {
                    can_be_computed(&sweep.scene(point).unwrap());
                }
            }
            Ok(_) => {}
            Err(error) => {
                counts.set((counts.get().0, counts.get().1 + 1));
                reported(&error.to_string(), &text);
            }
        }
        Ok(())
    };
    runner(cases(24)).run(&strategy, case).unwrap();
    let (accepted, refused) = counts.get();
    println!("sweeps: {accepted} accepted, {refused} refused");
    assert!(accepted.min(refused) > 4, "too hard or too easy: {accepted}, {refused}");
}

/// Reads a scene and sees to what that takes.
fn parsed(text: &str) -> Result<Scene, String> {
    let most = TIME.0 + TIME.1 * text.len() as u32;
    // Others use the machine too: what was too slow once is tried again.
    for attempt in 1.. {
        let (before, begun) = (ALLOCATOR.total_allocated(), Instant::now());
        let result = Scene::parse(text);
        let (taken, allocated) = (begun.elapsed(), ALLOCATOR.total_allocated() - before);
        assert!(allocated <= MEMORY.0 + MEMORY.1 * text.len(), "{allocated} bytes for {} bytes", text.len());
        if taken <= most || attempt == 5 {
            assert!(taken <= most, "{taken:?} for {} bytes", text.len());
            return result.map_err(|error| error.to_string());
        }
    }
    unreachable!("five attempts at most")
}

fn can_be_computed(scene: &Scene) {
    let (scale, surface, asperity) = (scene.scale(), &scene.surface, &scene.asperity);
    let positive = [
        ("lambda", scale.lambda),
        ("unit of length", scale.length),
        ("unit of radius", scale.radius),
        ("unit of force", scale.force),
        ("sigma", surface.surface_height_std),
        ("sigma_s", surface.heights.std),
        ("area", surface.nominal_area),
        ("count", surface.asperity_count as f64),
        ("omega_c", asperity.critical_interference()),
        ("psi of sigma_s", asperity.plasticity_index(surface.heights.std)),
        ("psi of sigma", asperity.plasticity_index(surface.surface_height_std)),
        ("peak density of heights", surface.heights.density(0.0)),
    ];
    for (name, value) in positive {
        assert!(value > 0.0 && value.is_finite(), "{name} = {value}");
    }
    assert!(surface.mean_plane_offset >= 0.0 && surface.mean_plane_offset.is_finite(), "{surface:?}");
    assert!(surface.asperity_count <= 200_000_000, "{surface:?}");
    let separations = &scene.separations;
    assert!((2..=10_000).contains(&separations.len()), "{}", separations.len());
    assert!(separations.iter().all(|h| h.is_finite() && surface.asperity_separation(*h).is_finite()));
    assert!(separations.windows(2).all(|pair| pair[0] < pair[1]));
    let (low, high) = scene.interference_range();
    assert!(low < high && low.is_finite() && high.is_finite(), "{low} {high}");
}

/// A law and a plan are made, or the law is refused with a reason, whatever the scene's quantities.
fn can_be_planned(scene: &Scene, model: &Model) {
    let begun = Instant::now();
    match scene.law_of(model) {
        Ok(law) => {
            let plan = Plan::new(scene, law.view());
            let estimate = Estimate::new(scene, law.view(), 4);
            let numbers = [plan.beyond, plan.pairs, estimate.memory(), estimate.disk()];
            assert!(
                numbers.into_iter().all(|number| number >= 0.0),
                "{}: {plan:?}\n{}",
                model.name,
                scene.text
            );
        }
        Err(error) => assert!(!error.to_string().is_empty()),
    }
    assert!(
        begun.elapsed() < Duration::from_secs(20),
        "{}: {:?}\n{}",
        model.name,
        begun.elapsed(),
        scene.text
    );
}
