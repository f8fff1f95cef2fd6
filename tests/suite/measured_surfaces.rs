//! Asperities of height maps that are known: spheres on a plane, an egg-box, Gaussian surfaces of Nayak's
//! theory; and the program that finds them.

use crate::common::program::{Folder, QUICK, assert_exit, attribute, bits, text};
use crate::common::unlocked;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use statrs::distribution::{ContinuousCDF, StudentsT};
use std::f64::consts::PI;
use std::path::Path;
use std::sync::Arc;
use stiction::input::columns::SceneFiles;
use stiction::math::instruction_set::InstructionSet;
use stiction::math::moments::Moments;
use stiction::output::asperities;
use stiction::scene::files::{Column, Files, Measured, Values};
use stiction::scene::{Document, Scene};
use stiction::surface::Radii;
use stiction::surface::map::{Asperities, HeightMap, Levelling, forces_of_spheres};

const MAP: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/configs/maps/polished.txt");

fn map(shape: [usize; 2], pixel: [f64; 2], height: impl Fn(f64, f64) -> f64) -> HeightMap {
    let [rows, columns] = shape;
    let place = |i: usize| ((i % columns) as f64 * pixel[1], (i / columns) as f64 * pixel[0]);
    let heights = (0..rows * columns).map(place).map(|(x, y)| height(x, y)).collect();
    HeightMap::new(heights, shape, pixel).unwrap()
}

/// Spheres of radius R on a plane, anywhere between the pixels. The pixel next to a top is at most (a, b) =
/// (dx, dy)/2 off it: its height is less by at most (a² + b²)/2R, and its mean curvature off by the relative
/// (a² + b²)/R² + dx²/4R², to leading order, where the last is that of second differences: Δ⁴z dx²/12 with
/// Δ⁴z = 3/R³.
#[test]
fn spheres_on_a_plane_are_found_one_by_one() {
    let (radius, pixel, spacing, protrusion) = (40e-9, 1e-9, 40, 10e-9);
    let mut random = ChaCha8Rng::seed_from_u64(5);
    let mut place = |i: usize| (((i as f64) + 0.5) * spacing as f64 + random.random_range(-3.0..3.0)) * pixel;
    let (down, across) = (8, 9);
    let tops: Vec<(f64, f64)> = (0..down * across).map(|i| (place(i % across), place(i / across))).collect();
    let shape = [down * spacing, across * spacing];
    let height = |x: f64, y: f64| {
        let nearest =
            tops.iter().map(|(u, v)| (x - u).powi(2) + (y - v).powi(2)).fold(f64::INFINITY, f64::min);
        (protrusion - radius + (radius * radius - nearest).max(0.0).sqrt()).max(0.0)
    };
    let spheres = map(shape, [pixel; 2], height);
    let mean = spheres.heights().iter().sum::<f64>() / spheres.heights().len() as f64;
    let found = Asperities::new(&spheres.levelled(Levelling::None).unwrap()).unwrap();
    assert_eq!(found.summits.len(), tops.len());
    let (slack, ratio) = (1.0 + 1e-2, pixel / radius);
    for summit in &found.summits {
        let (x, y) = (summit.column as f64 * pixel, summit.row as f64 * pixel);
        let near = |(u, v): &&(f64, f64)| (x - u).abs() <= 0.5001 * pixel && (y - v).abs() <= 0.5001 * pixel;
        assert_eq!(tops.iter().filter(near).count(), 1, "{summit:?}");
        let below = protrusion - (summit.height + mean);
        assert!(below > -1e-6 * protrusion && below <= slack * pixel * pixel / (4.0 * radius), "{below:e}");
        let deviation = radius * summit.mean_curvature() - 1.0;
        assert!(deviation > 0.0 && deviation <= slack * 0.75 * ratio * ratio, "{deviation:e}");
    }
    let area = ((shape[0] - 2) * (shape[1] - 2)) as f64 * pixel * pixel;
    assert!((found.nominal_area / area - 1.0).abs() < 1e-14);
    assert!((found.measured.density * area / 72.0 - 1.0).abs() < 1e-14);
}

/// z = a (cos kx + cos ky) with its summits at a fixed part of a pixel off the next one: the density is one
/// in a period squared, and height 2a and radius 1/(ak²) are approached with the second order of the pixel.
#[test]
fn an_egg_box_is_approached_with_second_order() {
    let (a, period, periods) = (2e-9, 480e-9, 5);
    let k = 2.0 * PI / period;
    let errors = |pixels: usize| {
        let pixel = period / pixels as f64;
        let (left, above) = (0.3 * pixel - period / 2.0, 0.2 * pixel - period / 2.0);
        let box_of_eggs = |x: f64, y: f64| a * ((k * (x + left)).cos() + (k * (y + above)).cos());
        // Searched are whole periods: all pixels but the border.
        let side = periods * pixels + 2;
        let surface = map([side, side], [pixel; 2], box_of_eggs);
        let mean = surface.heights().iter().sum::<f64>() / surface.heights().len() as f64;
        let found = Asperities::new(&surface.levelled(Levelling::None).unwrap()).unwrap();
        assert_eq!(found.summits.len(), periods * periods);
        assert!((found.measured.density * period * period - 1.0).abs() < 1e-12, "{pixels}");
        let height = found.measured.height_mean + mean;
        [height / (2.0 * a) - 1.0, found.measured.radius * a * k * k - 1.0]
    };
    let errors = [12, 24, 48, 96].map(errors);
    for pair in errors.windows(2) {
        for (coarse, fine) in pair[0].iter().zip(pair[1]) {
            let order = (coarse / fine).log2();
            assert!((order - 2.0).abs() < 0.02, "{errors:?}");
        }
    }
    // By the cosines at the pixel's distance: cos(0.3 kdx) + cos(0.2 kdx) = 2 − (0.09 + 0.04)(kdx)²/2.
    let step = 2.0 * PI / 96.0;
    assert!((errors[3][0] / (-0.0325 * step * step) - 1.0).abs() < 1e-3, "{errors:?}");
}

/// An isotropic Gaussian surface of unit variance as a sum of many waves whose wave vectors are drawn from a
/// disc of radius q: profiles have m₂ = q²/4 and m₄ = q⁴/8, so α = 2. Every wave is a product of functions of
/// x and y, summed without evaluating cosines anew.
fn gaussian_surface(side: usize, q: f64, random: &mut ChaCha8Rng) -> HeightMap {
    const WAVES: usize = 500;
    let mut heights = vec![0.0; side * side];
    let amplitude = (2.0 / WAVES as f64).sqrt();
    for wave in 0..WAVES {
        // Radii and directions in as many equally probable ranges as there are waves: less scatter from map
        // to map.
        let radius = q * ((wave as f64 + random.random::<f64>()) / WAVES as f64).sqrt();
        let direction: f64 = PI * ((wave * 263 % WAVES) as f64 + random.random::<f64>()) / WAVES as f64;
        let phase: f64 = 2.0 * PI * random.random::<f64>();
        let (kx, ky) = (radius * direction.cos(), radius * direction.sin());
        let (sines, cosines): (Vec<f64>, Vec<f64>) =
            (0..side).map(|j| (kx * j as f64 + phase).sin_cos()).unzip();
        InstructionSet::current().run(
            #[inline(always)]
            || {
                for (i, row) in heights.chunks_exact_mut(side).enumerate() {
                    let (sin, cos) = (ky * i as f64).sin_cos();
                    let (sin, cos) = (amplitude * sin, amplitude * cos);
                    for ((z, s), c) in row.iter_mut().zip(&sines).zip(&cosines) {
                        *z += cos * c - sin * s;
                    }
                }
            },
        );
    }
    HeightMap::new(heights, [side; 2], [1.0; 2]).unwrap()
}

/// Every other pixel of every other row.
fn coarser(map: &HeightMap) -> HeightMap {
    let side = map.shape()[1];
    let heights: Vec<f64> =
        map.heights().chunks_exact(side).step_by(2).flat_map(|row| row.iter().step_by(2)).copied().collect();
    HeightMap::new(heights, map.shape().map(|length| length / 2), map.pixel().map(|size| 2.0 * size)).unwrap()
}

/// Density of summits, mean and standard deviation of their heights, mean of their curvatures, and m₂, m₄.
fn statistics(map: HeightMap) -> [f64; 6] {
    let found = Asperities::new(&map.levelled(Levelling::None).unwrap()).unwrap();
    let measured = found.measured;
    let curvature = 1.0 / measured.radius;
    [
        measured.density,
        measured.height_mean,
        measured.height_std,
        curvature,
        found.moments.m2(),
        found.moments.m4(),
    ]
}

/// Nayak (1971): η = m₄/(6π√3 m₂), mean height 4√(m₀/(πα)); Bush, Gibson and Thomas (1975): mean curvature
/// 8/3 √(m₄/π); the variance of heights is (1 − 0.896805756…/α) m₀, by quadrature of Nayak's density in 30
/// digits. The means of two maps, of pixels of 1/28 and 1/14 of the wavelength 2π√(m₂/m₄), are extrapolated
/// to pixels of no size, with the second order that differences have. Student's t of six means over 40
/// independent maps; false alarms: 6 × 2·10⁻⁵.
#[test]
#[ignore = "slow: four seconds"]
fn summits_of_gaussian_surfaces_are_those_of_nayaks_theory() {
    const MAPS: u64 = 40;
    let q = 2.0 * PI / 28.0 * 2.0_f64.sqrt();
    let (m2, m4) = (q * q / 4.0, q.powi(4) / 8.0);
    let exact = [
        m4 / m2 / (6.0 * PI * 3.0_f64.sqrt()),
        4.0 / (2.0 * PI).sqrt(),
        (1.0_f64 - 0.896805756 / 2.0).sqrt(),
        8.0 / 3.0 * (m4 / PI).sqrt(),
        m2,
        m4,
    ];
    let mut moments = Moments::new(6);
    let mut coarse_moments = Moments::new(6);
    for seed in 0..MAPS {
        let map = gaussian_surface(600, q, &mut ChaCha8Rng::seed_from_u64(seed));
        let coarse = statistics(coarser(&map));
        let fine = statistics(map);
        let extrapolated: [f64; 6] = std::array::from_fn(|i| ((4.0 * fine[i] - coarse[i]) / 3.0) / exact[i]);
        moments.push(&extrapolated);
        coarse_moments.push(&std::array::from_fn::<f64, 6, _>(|i| coarse[i] / exact[i]));
    }
    let limit = StudentsT::new(0.0, 1.0, (MAPS - 1) as f64).unwrap().inverse_cdf(1.0 - 1e-5);
    let errors = moments.standard_error();
    for i in 0..6 {
        let t = (moments.mean()[i] - 1.0) / errors[i];
        assert!(t.abs() < limit, "{i}: {:?} ± {errors:?}, t = {t}", moments.mean());
        assert!(errors[i] < 0.007, "{errors:?}");
    }
    // What docs/measured-surfaces.md says of pixels of 1/14 of the wavelength.
    let coarse = coarse_moments.mean();
    assert!(
        (coarse[0] - 1.0).abs() < 0.03 && (coarse[1] - 1.0).abs() < 0.03 && (coarse[2] - 1.0).abs() < 0.03,
        "{coarse:?}"
    );
    assert!(coarse[3] > 0.94 && coarse[3] < 1.0, "{coarse:?}");
}

/// Turning a map by a quarter exchanges x and y and changes nothing else; coarser steps along y are no other
/// heights.
#[test]
fn directions_are_not_mixed_up() {
    let wave = |x: f64, y: f64| {
        1e-9 * ((0.3e9 * x).cos() + 2.0 * (0.2e9 * y + 0.1).cos() + 0.1 * (0.11e9 * (x + y)).sin())
    };
    let level = |map: HeightMap| Asperities::new(&map.levelled(Levelling::Plane).unwrap()).unwrap();
    let upright = level(map([120, 90], [2e-9, 1e-9], wave));
    let turned = level(map([90, 120], [1e-9, 2e-9], |x, y| wave(y, x)));
    assert_eq!(upright.summits.len(), turned.summits.len());
    let mut swapped = turned.summits.clone();
    swapped.sort_by_key(|summit| (summit.column, summit.row));
    for (a, b) in upright.summits.iter().zip(&swapped) {
        assert_eq!((a.row, a.column), (b.column, b.row));
        for i in 0..2 {
            assert!((a.curvature[i] / b.curvature[1 - i] - 1.0).abs() < 1e-9, "{a:?} {b:?}");
        }
    }
    for i in 0..2 {
        assert!((upright.moments.slope[i] / turned.moments.slope[1 - i] - 1.0).abs() < 1e-12);
    }
    // −∂²z/∂y² of the second wave at its crests is 2·(0.2)² = 0.08, against 0.09 along x.
    let [along_y, along_x] = [0, 1]
        .map(|i| upright.summits.iter().map(|s| s.curvature[i]).sum::<f64>() / upright.summits.len() as f64);
    assert!(
        (along_y / 0.08e9 - 1.0).abs() < 0.05 && (along_x / 0.09e9 - 1.0).abs() < 0.05,
        "{along_y:e} {along_x:e}"
    );
}

/// The heights of the shipped map, nm, and its side.
fn shipped() -> (Vec<f64>, usize) {
    let text = std::fs::read_to_string(MAP).unwrap();
    let rows = text.lines().filter(|line| !line.starts_with('#'));
    let heights: Vec<f64> =
        rows.flat_map(|row| row.split('\t')).map(|field| field.parse().unwrap()).collect();
    let side = heights.len().isqrt();
    assert_eq!(side * side, heights.len());
    (heights, side)
}

fn write_npy(path: &Path, heights: &[f64], side: usize) {
    let header = format!("{{'descr': '<f8', 'fortran_order': False, 'shape': ({side}, {side}), }}\n");
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((header.len() as u16).to_le_bytes());
    bytes.extend(header.as_bytes());
    bytes.extend(heights.iter().flat_map(|height| height.to_le_bytes()));
    std::fs::write(path, bytes).unwrap();
}

fn write_hdf5(path: &Path, heights: &[f64], side: usize) {
    let file = unlocked::create(path);
    let group = file.create_group("scan").unwrap();
    for name in ["forward", "backward"] {
        let dataset = group.new_dataset::<f64>().shape((side, side)).create(name).unwrap();
        dataset.write_raw(heights).unwrap();
    }
}

/// Whatever the kind of file, the same heights give the same bits; and what is read back is what the summits
/// are.
#[test]
fn kinds_of_files_give_the_same_bits() {
    let folder = Folder::new("");
    let (heights, side) = shipped();
    write_npy(&folder.path("map.npy"), &heights, side);
    write_hdf5(&folder.path("map.h5"), &heights, side);
    let read = |arguments: &[&str]| {
        let run = folder.stiction(&[&["asperities"], arguments].concat());
        assert_exit(&run, 0);
        text(&run.stdout)
    };
    let summary = read(&[MAP, "-o", "text.h5"]);
    for part in
        ["pixels", "levelled", "alpha", "of summits", "of moments", "density", "eta R sigma_s", "text.h5"]
    {
        assert!(summary.contains(part), "{part}: {summary}");
    }
    read(&["map.npy", "--pixel", "30 nm", "--height-unit", "nm", "-o", "npy.h5"]);
    read(&[
        "map.h5",
        "--dataset",
        "scan/forward",
        "--pixel",
        "0.03 um,30 nm",
        "--height-unit",
        "nm",
        "-o",
        "hdf5.h5",
    ]);
    let expected = bits(&folder.path("text.h5"));
    assert!(expected.len() > 20 && expected.iter().any(|(_, values)| values.len() > 100));
    for other in ["npy.h5", "hdf5.h5"] {
        assert_eq!(bits(&folder.path(other)), expected, "{other}");
    }
    assert_eq!(attribute(&folder.path("hdf5.h5"), "/", "map_source"), "HDF5, dataset scan/forward");
    let back = asperities::read(&folder.path("text.h5")).unwrap();
    let nanometres = heights.iter().map(|height| 1e-9 * height).collect();
    let found = HeightMap::new(nanometres, [side; 2], [3e-8; 2]).unwrap().levelled(Levelling::Plane).unwrap();
    let found = Asperities::new(&found).unwrap();
    assert_eq!(back.heights.len(), found.summits.len());
    let close = |a: f64, b: f64| (a / b - 1.0).abs() < 1e-9;
    for (i, summit) in found.summits.iter().enumerate() {
        assert!(
            close(back.radii[i], summit.radius()) && (back.heights[i] - summit.height).abs() < 1e-18,
            "{i}"
        );
        let [x, y] = back.positions[i];
        assert!(
            close(x, 3e-8 * (summit.column as f64 + 0.5)) && close(y, 3e-8 * (summit.row as f64 + 0.5)),
            "{i}"
        );
    }
    assert!(close(back.nominal_area, found.nominal_area) && close(back.density, found.measured.density));
    assert!(close(back.mean_plane_offset, back.heights.iter().sum::<f64>() / back.heights.len() as f64));
    assert!(
        close(back.m0, found.moments.m0)
            && close(back.m2, found.moments.m2())
            && close(back.m4, found.moments.m4())
    );
    let info = folder.stiction(&["info", "text.h5"]);
    assert_exit(&info, 0);
    assert!(
        text(&info.stdout).contains("stiction-asperities") && text(&info.stdout).contains("/asperities\n")
    );
}

/// Without -o there is a summary and no file.
#[test]
fn without_an_output_nothing_is_written() {
    let folder = Folder::new("");
    assert_exit(&folder.stiction(&["asperities", MAP, "--level", "quadratic"]), 0);
    assert_eq!(folder.files(), ["scene.toml"]);
}

/// A missing height is left out with its surroundings, and said.
#[test]
fn missing_heights_are_left_out() {
    let folder = Folder::new("");
    let (mut heights, side) = shipped();
    heights.iter_mut().enumerate().filter(|(i, _)| i % 41 == 0).for_each(|(_, height)| *height = f64::NAN);
    write_npy(&folder.path("map.npy"), &heights, side);
    let run = folder.stiction(&[
        "asperities",
        "map.npy",
        "--pixel",
        "30 nm",
        "--height-unit",
        "nm",
        "-o",
        "map.h5",
    ]);
    assert_exit(&run, 0);
    assert!(
        text(&run.stdout).contains("warning           2.4 % of the heights are missing"),
        "{}",
        text(&run.stdout)
    );
    assert!(attribute(&folder.path("map.h5"), "/", "warnings").contains("2.4 % of the heights are missing"));
    let whole = Folder::new("");
    assert_exit(&whole.stiction(&["asperities", MAP, "-o", "map.h5"]), 0);
    let [part, all] = [&folder, &whole].map(|folder| asperities::read(&folder.path("map.h5")).unwrap());
    // A missing pixel takes 9 with it.
    let share = part.nominal_area / all.nominal_area;
    assert!((share - (1.0 - 9.0 / 41.0)).abs() < 0.01, "{share}");
    // Of about 200 summits about 170 are left: the density changes by no more than 5 standard errors of what
    // is lost.
    assert!(
        (part.density / all.density - 1.0).abs() < 5.0 * (0.22_f64 / 0.78 / 213.0).sqrt(),
        "{}",
        part.density
    );
}

/// The map that was searched stands in the file: the heights that were given less their mean or their plane, and NaN
/// where they are missing.
#[test]
fn the_file_has_the_map_that_was_searched() {
    let folder = Folder::new("");
    let (mut heights, side) = shipped();
    let (rows, columns) = (side - 3, side);
    heights.truncate(rows * columns);
    (heights[5], heights[7 * columns + 9]) = (f64::NAN, f64::NAN);
    let lines = heights.chunks_exact(columns);
    let lines =
        lines.map(|row| row.iter().map(|height| format!("{height:e}")).collect::<Vec<_>>().join(" ") + "\n");
    std::fs::write(folder.path("map.txt"), lines.collect::<String>()).unwrap();
    let find = |level: &str, more: &[&str]| {
        let fixed =
            ["asperities", "map.txt", "--pixel", "30 nm,20 nm", "-o", "map.h5", "--force", "--level", level];
        assert_exit(&folder.stiction(&[&fixed, more].concat()), 0);
        let file = unlocked::open(folder.path("map.h5"));
        let numbers = |name: &str| file.dataset(name).unwrap().read_raw::<f64>().unwrap();
        assert_eq!(file.dataset("/map/height").unwrap().shape(), [rows, columns]);
        let middles =
            |count: usize, pixel: f64| (0..count).map(|i| (i as f64 + 0.5) * pixel).collect::<Vec<f64>>();
        for (name, count, pixel) in [("/map/x", columns, 30e-9), ("/map/y", rows, 20e-9)] {
            let middles = middles(count, pixel);
            assert!(numbers(name).iter().zip(&middles).all(|(a, b)| (a - b).abs() < 1e-12 * b), "{name}");
        }
        (
            numbers("/map/height"),
            numbers("/asperities/x"),
            numbers("/asperities/y"),
            numbers("/asperities/height"),
        )
    };
    let known = |values: &[f64]| values.iter().copied().filter(|value| !value.is_nan()).collect::<Vec<f64>>();
    let mean = known(&heights).iter().sum::<f64>() / known(&heights).len() as f64;
    let (plain, ..) = find("none", &["--height-unit", "nm"]);
    assert_eq!(attribute(&folder.path("map.h5"), "/", "height_unit"), "nm");
    for (found, given) in plain.iter().zip(&heights) {
        assert_eq!(found.is_nan(), given.is_nan());
        assert!(given.is_nan() || (found - 1e-9 * (given - mean)).abs() < 1e-22, "{found:e} {given:e}");
    }
    // What is left of a plane leans to neither side.
    let (level, x, y, own) = find("plane", &["--height-unit", "nm"]);
    let lean = |of: &dyn Fn(usize) -> f64| -> f64 {
        let terms = level.iter().enumerate().filter(|(_, height)| !height.is_nan());
        terms.map(|(i, height)| of(i) * height).sum()
    };
    let size: f64 = known(&level).iter().map(|height| height.abs()).sum();
    for tilt in [lean(&|_| 1.0), lean(&|i| (i % columns) as f64), lean(&|i| (i / columns) as f64)] {
        assert!(tilt.abs() < 1e-9 * size, "{tilt:e} {size:e}");
    }
    for ((x, y), height) in x.iter().zip(&y).zip(&own) {
        let place = (y / 20e-9) as usize * columns + (x / 30e-9) as usize;
        assert_eq!(level[place], *height);
    }
    assert!(!own.is_empty());
    // A text may say its unit.
    let map = std::fs::read_to_string(folder.path("map.txt")).unwrap();
    std::fs::write(folder.path("map.txt"), format!("# Value units: nm\n{map}")).unwrap();
    let (again, ..) = find("plane", &[]);
    assert_eq!(attribute(&folder.path("map.h5"), "/", "height_unit"), "");
    assert!(again.iter().zip(&level).all(|(a, b)| a.to_bits() == b.to_bits()));
    assert_exit(&folder.stiction(&["validate", "map.h5"]), 0);
}

/// A file without the map is one of an earlier version, and read as ever.
#[test]
fn a_file_without_its_map_is_read() {
    let folder = Folder::new("");
    assert_exit(&folder.stiction(&["asperities", MAP, "-o", "map.h5"]), 0);
    let file = unlocked::open_rw(folder.path("map.h5"));
    file.unlink("map").unwrap();
    file.delete_attr("height_unit").unwrap();
    file.close().unwrap();
    assert_exit(&folder.stiction(&["validate", "map.h5"]), 0);
    assert_exit(&folder.stiction(&["info", "map.h5"]), 0);
}

/// The page's table of errors of force, per cent, and that the geometric mean is the nearer one.
#[test]
fn errors_of_spheres_are_those_of_the_page() {
    let page = concat!(env!("CARGO_MANIFEST_DIR"), "/docs/measured-surfaces.md");
    let page = std::fs::read_to_string(page).unwrap();
    for ratio in [1.5, 2.0, 3.0, 5.0, 10.0, 30.0] {
        let [of_mean, of_geometric] = forces_of_spheres(ratio).map(|share| 100.0 * (share - 1.0));
        let row = format!("| {ratio} | −{:.1} % | −{:.1} % |", -of_mean, -of_geometric);
        assert!(page.contains(&row), "{row}");
        assert!(of_mean < of_geometric && of_geometric < 0.0);
    }
    // Of curvatures 1 ± ε.
    for epsilon in [0.01_f64, 0.02] {
        let [of_mean, of_geometric] =
            forces_of_spheres((1.0 + epsilon) / (1.0 - epsilon)).map(|share| 1.0 - share);
        let square = epsilon * epsilon;
        assert!(
            (of_mean / square - 1.0 / 3.0).abs() < 1e-3 && (of_geometric / square - 1.0 / 12.0).abs() < 1e-3
        );
    }
}

/// A rough surface with 40 pixels from maximum to maximum of a profile, and noise of a tenth of its standard deviation
/// from pixel to pixel: the noise makes most of the summits, and either the filter or prominence takes these away, so
/// that those of the surface are left, within 15 %.
#[test]
fn noise_is_taken_away() {
    let q = 2.0 * PI / 40.0 * 2.0_f64.sqrt();
    let mut random = ChaCha8Rng::seed_from_u64(11);
    let clean = gaussian_surface(400, q, &mut random);
    let noise = (0..400 * 400).map(|_| 0.1 * random.random_range(-1.0..1.0));
    let noisy = clean.heights().iter().zip(noise).map(|(z, noise)| z + noise).collect();
    let noisy = HeightMap::new(noisy, [400; 2], [1.0; 2]).unwrap().levelled(Levelling::None).unwrap();
    let density = |found: Asperities| found.measured.density;
    let exact = density(Asperities::new(&clean.levelled(Levelling::None).unwrap()).unwrap());
    assert!(density(Asperities::new(&noisy).unwrap()) > 10.0 * exact);
    let smooth = density(Asperities::new(&noisy.smoothed(14.0).unwrap()).unwrap());
    let prominent = density(Asperities::prominent(&noisy, 0.15).unwrap());
    for found in [smooth, prominent] {
        assert!((found / exact - 1.0).abs() < 0.15, "{smooth:e} {prominent:e} {exact:e}");
    }
}

/// What the options do to the file and the summary: the border that is left out, the prominence of each, and the
/// series, whose row at the cut-off of the map is what is measured on it.
#[test]
fn a_smoothed_map_is_told_as_such() {
    let folder = Folder::new("");
    let find = |arguments: &[&str]| {
        let run = folder.stiction(&[&["asperities", MAP, "-o", "map.h5", "--force"], arguments].concat());
        assert_exit(&run, 0);
        assert_exit(&folder.stiction(&["validate", "map.h5"]), 0);
        (text(&run.stdout), unlocked::open(folder.path("map.h5")))
    };
    let numbers = |file: &hdf5::File, name: &str| file.dataset(name).unwrap().read_raw::<f64>().unwrap();
    let (said, file) = find(&["--smooth", "0.2 um", "--prominence", "300 pm", "--cutoffs", "5"]);
    for part in [
        "smoothed          Gaussian, cut-off 200.0 nm; 4 x 4 pixels",
        "prominent by 300.0 pm or more",
        "k1/k2 = ",
        "200.0 nm *",
    ] {
        assert!(said.contains(part), "{part}: {said}");
    }
    assert_eq!(file.attr("border").unwrap().read_raw::<u64>().unwrap(), [4, 4]);
    let area: f64 = file.attr("nominal_area").unwrap().read_scalar().unwrap();
    assert!((area / (184.0 * 30e-9_f64).powi(2) - 1.0).abs() < 1e-12);
    let prominences = numbers(&file, "/asperities/prominence");
    assert!(prominences.iter().all(|own| *own >= 3e-10) && prominences.len() > 20);
    let cutoffs = numbers(&file, "/cutoffs/cutoff");
    assert_eq!((cutoffs.len(), cutoffs[0]), (6, 60e-9));
    assert!((cutoffs[5] / (48.0 * 30e-9) - 1.0).abs() < 1e-12);
    let place = cutoffs.iter().position(|cutoff| *cutoff == 2e-7).unwrap();
    for name in ["asperity_density", "asperity_radius", "asperity_height_std", "asperity_curvature_std"] {
        let (series, own) =
            (numbers(&file, &format!("/cutoffs/{name}")), numbers(&file, &format!("/measured/{name}")));
        assert_eq!(series[place].to_bits(), own[0].to_bits(), "{name}");
    }
    drop(file);
    // Scenes of the whole map have the part within the border.
    let back = asperities::read(&folder.path("map.h5")).unwrap();
    let extent = back.extent.unwrap();
    assert!(extent.iter().all(|length| (length / (184.0 * 30e-9) - 1.0).abs() < 1e-12), "{extent:?}");
    assert!(back.positions.iter().flatten().all(|place| *place > 0.0 && *place < extent[0]));
    // Without the options nothing is left out, and nothing of it is in the file.
    let (said, file) = find(&[]);
    assert!(!said.contains("smoothed") && !said.contains("prominent") && !said.contains("cut-off"), "{said}");
    assert!(file.dataset("/asperities/prominence").is_err() && file.group("cutoffs").is_err());
    assert_eq!(file.attr("smooth").unwrap().read_scalar::<f64>().unwrap(), 0.0);
}

/// Cut-offs and prominences that the map does not have are refused with what would do.
#[test]
fn options_that_the_map_does_not_allow_are_refused() {
    let folder = Folder::new("");
    for (arguments, part) in [
        (
            ["--smooth", "59 nm"],
            "--smooth 59.00 nm is below two pixels, which is the shortest wave of the map; give 60.00 nm or more",
        ),
        (
            ["--smooth", "2.9 um"],
            "--smooth 2.900 µm is above half the shorter side of the map; give 2.880 µm or less",
        ),
        (["--smooth", "-1 nm"], "a cut-off wavelength is above 0"),
        (["--smooth", "200"], "such as \"200 nm\""),
        (["--prominence", "1 um"], "no summit has a prominence of 1.000 µm; the most prominent one has "),
        (["--prominence", "-1 nm"], "a prominence is between 0 and 1e6 m"),
        (["--prominence", "much"], "such as \"0.5 nm\""),
        (["--cutoffs", "1"], "1 is not in 2..=100"),
    ] {
        let run = folder.stiction(&["asperities", MAP, "-o", "out.h5", arguments[0], arguments[1]]);
        assert_exit(&run, 2);
        assert!(text(&run.stderr).contains(part), "{part}: {}", text(&run.stderr));
    }
    std::fs::write(
        folder.path("small.txt"),
        (0..8).map(|i| format!("0 {i} 3 0 {} 2 5 1\n", i % 3)).collect::<String>(),
    )
    .unwrap();
    let run = folder.stiction(&[
        "asperities",
        "small.txt",
        "--pixel",
        "1 nm",
        "--height-unit",
        "nm",
        "--cutoffs",
        "3",
    ]);
    assert_exit(&run, 2);
    assert!(text(&run.stderr).contains("--cutoffs has no room"), "{}", text(&run.stderr));
    assert_eq!(folder.files(), ["scene.toml", "small.txt"]);
}

/// Saddles among the summits are counted, and told.
#[test]
fn saddles_are_told() {
    let mut random = ChaCha8Rng::seed_from_u64(3);
    let noise: Vec<f64> = (0..200 * 200).map(|_| random.random_range(-1.0..1.0)).collect();
    let folder = Folder::new("");
    write_npy(&folder.path("map.npy"), &noise, 200);
    let map = HeightMap::new(noise, [200; 2], [10.0; 2]).unwrap().levelled(Levelling::None).unwrap();
    let found = Asperities::new(&map).unwrap();
    let is_saddle = |summit: &&stiction::surface::map::Summit| {
        summit.curvature[0] * summit.curvature[1] <= summit.twist.powi(2)
    };
    let (saddles, count) = (found.summits.iter().filter(is_saddle).count(), found.summits.len());
    assert!(saddles > 0);
    assert_eq!(found.shape.saddles, saddles);
    let arguments = ["map.npy", "--pixel", "10 nm", "--height-unit", "nm", "--level", "none"];
    let run = folder.stiction(&[&["asperities"], &arguments[..]].concat());
    assert_exit(&run, 0);
    let told = format!("{saddles} of {count} ");
    assert!(text(&run.stdout).contains(&told), "{told}: {}", text(&run.stdout));
}

/// Coarse pixels, few summits, a lay and steps of height are warned of.
#[test]
fn what_the_map_does_not_show_is_warned_of() {
    let folder = Folder::new("");
    let warned = |heights: &[f64], side: usize, part: &str| {
        write_npy(&folder.path("map.npy"), heights, side);
        let run = folder.stiction(&["asperities", "map.npy", "--pixel", "10 nm", "--height-unit", "nm"]);
        assert_exit(&run, 0);
        assert!(text(&run.stdout).contains(part), "{part}: {}", text(&run.stdout));
    };
    let (heights, side) = shipped();
    let coarse: Vec<f64> = (0..64 * 64).map(|i| heights[3 * (i / 64) * side + 3 * (i % 64)]).collect();
    warned(&coarse, 64, "pixels are too coarse for the summits");
    warned(&heights[..side * 50][..50 * 50], 50, "summits are few");
    let stepped: Vec<f64> = heights.iter().map(|height| (height / 0.5).round() * 0.5).collect();
    warned(&stepped, side, "of neighbouring pixels are equally high");
    let lay: Vec<f64> =
        heights.iter().enumerate().map(|(i, z)| z + 3.0 * (0.4 * (i % side) as f64).sin()).collect();
    warned(&lay, side, "mean square slopes along x and y differ");
    let spiky: Vec<f64> = heights.iter().map(|height| height.powi(3)).collect();
    warned(&spiky, side, "heights are far from Gaussian");
}

/// Whatever is wrong with a map is said in a line that names it; nothing is written.
#[test]
fn what_is_no_map_is_refused() {
    let folder = Folder::new("");
    let write = |name: &str, text: &str| std::fs::write(folder.path(name), text).unwrap();
    let row = |value: &str| format!("{}\n", [value; 10].join(" "));
    write("flat.txt", &row("1.5").repeat(10));
    write("small.txt", &row("1.5").repeat(5));
    write("ragged.txt", &(row("1") + "1 2 3\n"));
    write("word.txt", &(row("1") + &row("one")));
    write("infinite.txt", &(row("1").repeat(9) + &row("-inf")));
    write("nan.txt", &row("nan").repeat(10));
    write("commas.txt", "1,5\t2,5\n");
    write("empty.txt", "");
    write("slope.txt", &(0..10).map(|i| row(&format!("{}", i * i))).collect::<String>());
    write("unit.txt", &("# Value units: V\n".to_owned() + &row("1").repeat(10)));
    write("npy.npy", "\u{93}NUMPY");
    std::fs::write(folder.path("broken.npy"), b"\x93NUMPY\x01\x00\x10\x00{'descr': '<f8'}\n").unwrap();
    std::fs::write(folder.path("broken.h5"), b"\x89HDF\r\n\x1a\n and nothing else").unwrap();
    let (heights, side) = shipped();
    write_hdf5(&folder.path("map.h5"), &heights, side);
    let before = folder.files();
    let units = ["--pixel", "1 nm", "--height-unit", "nm"];
    let refused = |name: &str, arguments: &[&str], part: &str| {
        let run = folder.stiction(&[&["asperities", name, "-o", "out.h5"], arguments].concat());
        assert_exit(&run, 2);
        let message = text(&run.stderr);
        assert!(message.contains(part), "{name}: {message}");
        assert_eq!(folder.files(), before);
    };
    refused("flat.txt", &units, "flat.txt: the levelled map is flat");
    refused("small.txt", &units, "5 rows and 10 columns; at least 8");
    refused("ragged.txt", &units, "ragged.txt: line 2: has 3 numbers, and the rows before it have 10");
    refused("word.txt", &units, "line 2: column 1: `one` is not a number");
    refused("infinite.txt", &units, "row 10, column 1: the height is -inf m");
    refused("nan.txt", &units, "0 of 100 heights are known");
    refused("commas.txt", &units, "decimal points are needed");
    refused("empty.txt", &units, "is empty");
    refused("slope.txt", &units, "no summit");
    refused("flat.txt", &["--height-unit", "nm"], "give --pixel");
    refused("flat.txt", &["--pixel", "1 nm"], "give --height-unit");
    refused("unit.txt", &["--pixel", "1 nm"], "has heights in `V`, which is no unit of length");
    refused("flat.txt", &["--pixel", "1", "--height-unit", "nm"], "a length with its unit is needed");
    refused("flat.txt", &["--pixel", "1 nm,0 nm"], "between 1e-13 and 1e3 m");
    refused("flat.txt", &["--pixel", "-1 nm"], "between 1e-13 and 1e3 m");
    refused("flat.txt", &["--height-unit", "parsec"], "known: m, cm, mm, um, nm");
    refused("flat.txt", &["--level", "cubic"], "known: none, plane, quadratic");
    refused("flat.txt", &[&units[..], &["--dataset", "z"]].concat(), "is no HDF5 file");
    refused("broken.npy", &units, "broken.npy: is an NPY file that is damaged");
    refused("broken.h5", &units, "broken.h5: is an HDF5 file that is damaged or incomplete");
    refused("map.h5", &units, "give --dataset");
    refused("map.h5", &[&units[..], &["--dataset", "scan"]].concat(), "lacks the dataset scan");
    refused("none.txt", &units, "cannot be read");
    refused(".", &units, "is a folder");
    let own = folder.stiction(
        &[&["asperities", "map.h5", "--dataset", "scan/forward", "-o", "map.h5", "--force"], &units[..]]
            .concat(),
    );
    assert_exit(&own, 2);
    assert!(text(&own.stderr).contains("which this command reads"), "{}", text(&own.stderr));
    assert_eq!(folder.files(), before);
}

#[test]
fn an_existing_output_is_kept_unless_forced() {
    let folder = Folder::new("");
    std::fs::write(folder.path("out.h5"), "kept").unwrap();
    let refused = folder.stiction(&["asperities", MAP, "-o", "out.h5"]);
    assert_exit(&refused, 2);
    assert_eq!(std::fs::read_to_string(folder.path("out.h5")).unwrap(), "kept");
    assert_exit(&folder.stiction(&["asperities", MAP, "-o", "out.h5", "--force"]), 0);
    assert!(asperities::read(&folder.path("out.h5")).is_ok());
}

/// What claims to be such a file and holds what no asperities can have is refused.
#[test]
fn files_of_asperities_are_not_trusted() {
    let folder = Folder::new("");
    let write = || assert_exit(&folder.stiction(&["asperities", MAP, "-o", "out.h5", "--force"]), 0);
    let path = folder.path("out.h5");
    let refused = |part: &str| {
        let error = asperities::read(&path).unwrap_err().to_string();
        assert!(error.contains(part), "{part}: {error}");
    };
    for (dataset, value) in
        [("/asperities/radius", -1e-6), ("/asperities/height", f64::NAN), ("/asperities/x", f64::INFINITY)]
    {
        write();
        let file = unlocked::open_rw(&path);
        let mut values = file.dataset(dataset).unwrap().read_raw::<f64>().unwrap();
        values[3] = value;
        file.dataset(dataset).unwrap().write_raw(&values).unwrap();
        drop(file);
        refused(&format!("at 3 of {dataset}"));
    }
    write();
    unlocked::open_rw(&path).unlink("/surface/m4").unwrap();
    refused("lacks the dataset /surface/m4");
    std::fs::write(&path, "no HDF5").unwrap();
    refused("is not an HDF5 file");
}

/// Summits of 6 pixels from one to the next are told to be too coarse, along whichever side; of 16 they are
/// not. A caveat is of the surface as well as of the pixels: an egg-box is no Gaussian surface.
#[test]
fn coarse_pixels_are_told() {
    let period = 480e-9;
    let k = 2.0 * PI / period;
    for (down, across, is_told) in [(16, 16, false), (6, 6, true), (6, 16, true), (16, 6, true)] {
        let pixel = [period / f64::from(down), period / f64::from(across)];
        let shape = [5 * down as usize + 2, 5 * across as usize + 2];
        let eggs = map(shape, pixel, |x, y| {
            2e-9 * ((k * (x + 0.1 * period)).cos() + (k * (y + 0.2 * period)).cos())
        });
        let found = Asperities::new(&eggs.levelled(Levelling::None).unwrap()).unwrap();
        let caveats = found.caveats(pixel);
        let of_pixels = |caveat: &&String| caveat.contains("pixels are too coarse");
        assert_eq!(
            caveats.iter().filter(of_pixels).count(),
            usize::from(is_told),
            "{down} {across}: {caveats:?}"
        );
    }
}

/// Mean square slopes along two directions are as the squares of the wave numbers: an egg-box with periods
/// that differ by 3 is told to be anisotropic, whichever is the longer; one whose periods differ by 5 % is
/// not.
#[test]
fn unequal_slopes_are_told() {
    let shortest = 480e-9;
    for (down, across, is_told) in [(1.0, 1.0, false), (1.0, 1.05, false), (1.0, 3.0, true), (3.0, 1.0, true)]
    {
        let pixel = [shortest / 24.0; 2];
        let shape = [3 * 24 * 3 + 2, 3 * 24 * 3 + 2];
        let eggs = map(shape, pixel, |x, y| {
            let [x, y] = [2.0 * PI / (shortest * across) * x + 0.6, 2.0 * PI / (shortest * down) * y + 1.3];
            2e-9 * (x.cos() + y.cos())
        });
        let found = Asperities::new(&eggs.levelled(Levelling::None).unwrap()).unwrap();
        let caveats = found.caveats(pixel);
        let of_slopes = |caveat: &&String| caveat.contains("slopes along x and y differ");
        assert_eq!(
            caveats.iter().filter(of_slopes).count(),
            usize::from(is_told),
            "{down} {across}: {caveats:?}"
        );
    }
}

/// Files with a few values, by hand.
#[derive(Debug)]
struct Few;

impl Files for Few {
    fn column(&self, path: &str, column: &Column) -> Result<Values, String> {
        assert_eq!(path, "few.csv");
        let values = |numbers: &[f64], unit: Option<&str>| {
            Ok(Values { numbers: numbers.to_vec(), unit: unit.map(str::to_owned) })
        };
        match column {
            Column::Numbered(2) => values(&[1.0, 2.0, 6.0], None),
            Column::Numbered(3) => values(&[1.0, 0.0], None),
            Column::Named(name) if name == "second" => values(&[3.0, 5.0], None),
            Column::Named(name) if name == "fourth" => values(&[3.0, 5.0], Some("µm")),
            Column::Named(name) if name == "fifth" => values(&[3.0, 5.0], Some("GPa")),
            Column::Dataset(name) if name == "third" => values(&[4.0], None),
            other => Err(format!("{other:?}")),
        }
    }

    fn asperities(&self, path: &str) -> Result<Measured, String> {
        assert_eq!(path, "few.h5");
        let (heights, radii) = (vec![1e-9, 4e-9, 2.5e-9, 0.5e-9], vec![2e-6, 1e-6, 4e-6, 5e-6]);
        let positions = vec![[0.1e-6, 0.2e-6], [1.9e-6, 0.1e-6], [0.5e-6, 0.9e-6], [1.2e-6, 0.6e-6]];
        let extent = Some([2e-6, 1e-6]);
        let equivalent_radii = Some(vec![3e-6, 2e-6, 5e-6, 6e-6]);
        let (nominal_area, surface_height_std) = (2e-12, 2e-9);
        Ok(Measured { heights, radii, equivalent_radii, positions, extent, nominal_area, surface_height_std })
    }
}

fn scene_with(surface: &str) -> Result<Scene, String> {
    let (head, rest) = QUICK.split_once("[surface]").unwrap();
    let text = format!("{head}[surface]\n{surface}\n[model]{}", rest.split_once("[model]").unwrap().1);
    Document::parse(&text, Arc::new(Few)).map(|document| document.scene).map_err(|error| error.to_string())
}

/// Four measured asperities, by hand: heights about their mean, 2 nm, with a variance of (1 + 4 + 0.25 +
/// 2.25)/4 nm²; two to a µm².
#[test]
fn measured_asperities_are_taken_as_they_are() {
    let scene = scene_with("asperities = { path = \"few.h5\", sample = \"whole\" }").unwrap();
    let surface = &scene.surface;
    let near = |value: f64, exact: f64| assert!((value / exact - 1.0).abs() < 1e-12, "{value:e} {exact:e}");
    near(surface.asperity_radius, 3e-6);
    near(surface.mean_plane_offset, 2e-9);
    near(surface.surface_height_std, 2e-9);
    near(surface.heights.std, 1.875_f64.sqrt() * 1e-9);
    near(surface.nominal_area, 2e-12);
    assert_eq!((surface.asperity_count, surface.whole), (4, true));
    let Radii::Measured(pairs) = &surface.radii else { panic!("{:?}", surface.radii) };
    let exact = [[-1.0, 2.0], [2.0, 1.0], [0.5, 4.0], [-1.5, 5.0]];
    for (pair, [height, radius]) in pairs.iter().zip(exact) {
        near(pair[0], height * 1e-9);
        near(pair[1], radius * 1e-6);
    }
    let equivalent =
        scene_with("asperities = { path = \"few.h5\", radius = \"equivalent\" }").unwrap().surface;
    near(equivalent.asperity_radius, 4e-6);
    let Radii::Measured(pairs) = &equivalent.radii else { panic!("{:?}", equivalent.radii) };
    near(pairs[2][1], 5e-6);
    let drawn = scene_with("asperities = { path = \"few.h5\" }\nnominal_area = \"50 um^2\"").unwrap().surface;
    assert_eq!((drawn.asperity_count, drawn.whole, drawn.nominal_area), (100, false, 50e-12));
    assert_eq!(scene_with("asperities = { path = \"few.h5\" }").unwrap().surface.asperity_count, 4);
}

/// Values of a file by number and name of a column and by name of a dataset, in the unit that is given; of
/// two values on.
#[test]
fn given_values_are_taken_as_they_are() {
    let rest = "asperity_density = \"7 /um^2\"\nnominal_area = \"10 um^2\"\nsurface_height_std = \"9 nm\"";
    let given = |key: &str, values: &str, unit: &str| {
        let radius = if key == "heights" { "asperity_radius = \"3 um\"" } else { "" };
        let unit = if unit.is_empty() { String::new() } else { format!(", unit = \"{unit}\"") };
        let given = format!("{key} = {{ law = \"file\", path = \"few.csv\", {values}{unit} }}");
        scene_with(&format!("{given}\n{rest}\n{radius}")).map(|scene| scene.surface)
    };
    let heights = given("heights", "column = 2", "nm").unwrap().heights;
    let values = heights.values().unwrap();
    assert!(
        values.iter().zip([-2e-9, -1e-9, 3e-9]).all(|(value, exact)| (value / exact - 1.0).abs() < 1e-12),
        "{values:?}"
    );
    assert!((heights.std / (14.0_f64 / 3.0).sqrt() * 1e9 - 1.0).abs() < 1e-12, "{:e}", heights.std);
    let radii = given("radii", "column = \"second\"", "um").unwrap();
    assert!((radii.asperity_radius / 4e-6 - 1.0).abs() < 1e-12);
    let Radii::Sample(values) = radii.radii else { panic!("{:?}", radii.radii) };
    assert!(
        (values[0] / 3e-6 - 1.0).abs() < 1e-12 && (values[1] / 5e-6 - 1.0).abs() < 1e-12 && values.len() == 2
    );
    let few = given("radii", "dataset = \"third\"", "um").unwrap_err();
    assert!(few.contains("has 1 values; 2 to"), "{few}");
    let none = given("radii", "column = 3", "um").unwrap_err();
    assert!(none.contains("radii are positive"), "{none}");
    // The unit above a column is its unit.
    for unit in ["", "um"] {
        let radii = given("radii", "column = \"fourth\"", unit).unwrap();
        assert!((radii.asperity_radius / 4e-6 - 1.0).abs() < 1e-12);
    }
    for (column, unit, problem) in [
        ("fourth", "nm", "the unit above the column is another one; leave this one out"),
        ("fifth", "", "the unit above the column will not do: a unit of length is needed"),
        ("second", "", "surface.radii.unit"),
    ] {
        let refused = given("radii", &format!("column = \"{column}\""), unit).unwrap_err();
        assert!(refused.contains(problem), "{refused}");
    }
}

/// Columns of a file are counted from 1.
#[test]
fn columns_are_counted_from_one() {
    let folder = Folder::new("");
    std::fs::write(folder.path("few.csv"), "1,10,100\n2,20,200\n").unwrap();
    let beside = SceneFiles::scene(&folder.path("scene.toml"));
    for (number, values) in [(1, [1.0, 2.0]), (2, [10.0, 20.0]), (3, [100.0, 200.0])] {
        assert_eq!(beside.column("few.csv", &Column::Numbered(number)).unwrap().numbers, values);
    }
    assert!(beside.column("few.csv", &Column::Numbered(4)).is_err());
}
