//! Files of measured asperities, as scenes take them and as `stiction asperities` of the package leaves them, and files
//! of values.

use crate::common::program::{ASPERITIES, Folder, QUICK, assert_exit, text};
use crate::common::unlocked;
use std::sync::Arc;
use stiction::input::columns::SceneFiles;
use stiction::output::asperities;
use stiction::scene::files::{Column, Files, Measured, Values};
use stiction::scene::{Document, Scene};
use stiction::surface::Radii;

/// A folder with a file of asperities of the shipped map.
fn with_asperities() -> Folder {
    let folder = Folder::new("");
    std::fs::copy(ASPERITIES, folder.path("map.h5")).unwrap();
    folder
}

/// What is read back is what is in the file.
#[test]
fn a_file_is_read_back() {
    let folder = with_asperities();
    let back = asperities::read(&folder.path("map.h5")).unwrap();
    let file = unlocked::open(folder.path("map.h5"));
    let numbers = |name: &str| file.dataset(name).unwrap().read_raw::<f64>().unwrap();
    assert_eq!(
        (back.asperities.heights.len(), &back.asperities.heights),
        (213, &numbers("/asperities/height"))
    );
    assert_eq!(back.asperities.radii, numbers("/asperities/radius"));
    assert_eq!(back.asperities.equivalent_radii, Some(numbers("/asperities/equivalent_radius")));
    let places: Vec<[f64; 2]> =
        numbers("/asperities/x").into_iter().zip(numbers("/asperities/y")).map(|(x, y)| [x, y]).collect();
    assert_eq!(back.asperities.positions, places);
    let area: f64 = file.attr("nominal_area").unwrap().read_scalar().unwrap();
    assert_eq!(
        (back.asperities.nominal_area, back.density),
        (area, numbers("/measured/asperity_density")[0])
    );
    let mean = back.asperities.heights.iter().sum::<f64>() / 213.0;
    assert!((back.mean_plane_offset / mean - 1.0).abs() < 1e-12);
    assert_eq!(
        [back.m0, back.m2, back.m4],
        ["m0", "m2", "m4"].map(|name| numbers(&format!("/surface/{name}"))[0])
    );
    drop(file);
    let info = folder.stiction(&["info", "map.h5"]);
    assert_exit(&info, 0);
    assert!(
        text(&info.stdout).contains("stiction-asperities") && text(&info.stdout).contains("/asperities\n")
    );
}

/// Scenes of the whole of a smoothed map have the part within the border: 4 rows and 6 columns of 30 nm are off.
#[test]
fn the_border_of_a_smoothed_map_is_left_out() {
    let folder = with_asperities();
    let whole = asperities::read(&folder.path("map.h5")).unwrap();
    let file = unlocked::open_rw(folder.path("map.h5"));
    file.attr("border").unwrap().write_raw(&[4_u64, 6]).unwrap();
    file.close().unwrap();
    let back = asperities::read(&folder.path("map.h5")).unwrap();
    let near = |value: f64, exact: f64| assert!((value - exact).abs() < 1e-18, "{value:e} {exact:e}");
    let ([width, height], [x, y]) = (back.asperities.extent.unwrap(), [6.0 * 30e-9, 4.0 * 30e-9]);
    near(width, 192.0 * 30e-9 - 2.0 * x);
    near(height, 192.0 * 30e-9 - 2.0 * y);
    for (own, other) in back.asperities.positions.iter().zip(&whole.asperities.positions) {
        near(own[0], other[0] - x);
        near(own[1], other[1] - y);
    }
}

/// A file without the map is one of an earlier version, and read as ever.
#[test]
fn a_file_without_its_map_is_read() {
    let folder = with_asperities();
    let file = unlocked::open_rw(folder.path("map.h5"));
    file.unlink("map").unwrap();
    file.delete_attr("height_unit").unwrap();
    file.close().unwrap();
    assert_exit(&folder.stiction(&["validate", "map.h5"]), 0);
    assert_exit(&folder.stiction(&["info", "map.h5"]), 0);
}

/// What claims to be such a file and holds what no asperities can have is refused.
#[test]
fn files_of_asperities_are_not_trusted() {
    let folder = Folder::new("");
    let path = folder.path("out.h5");
    let write = || std::fs::copy(ASPERITIES, &path).unwrap();
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
    assert!(few.contains("has 1 value; 2 to"), "{few}");
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
