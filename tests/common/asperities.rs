//! Files of asperities with the least that is in one.

use super::unlocked;
use hdf5::types::VarLenUnicode;
use std::path::Path;

/// A file of asperities at places, m, on a map of `extent`, m, with what scenes need.
pub fn write_asperities(path: &Path, [x, y, heights, radii]: [&[f64]; 4], extent: [f64; 2]) {
    let file = unlocked::create(path);
    let attribute = |name: &str, value: f64| {
        file.new_attr::<f64>().create(name).unwrap().write_scalar(&value).unwrap();
    };
    let format: VarLenUnicode = "stiction-asperities".parse().unwrap();
    file.new_attr::<VarLenUnicode>().create("format").unwrap().write_scalar(&format).unwrap();
    file.new_attr::<i32>().shape(2).create("format_version").unwrap().write(&[2, 0]).unwrap();
    file.new_attr::<u64>().shape(2).create("map_shape").unwrap().write(&[1_u64, 1]).unwrap();
    file.new_attr::<f64>().shape(2).create("pixel_size").unwrap().write(&[extent[1], extent[0]]).unwrap();
    attribute("nominal_area", extent[0] * extent[1]);
    let mean = heights.iter().sum::<f64>() / heights.len() as f64;
    attribute("mean_plane_offset", mean);
    let numbers: Vec<f64> = (0..x.len()).map(|i| i as f64).collect();
    let datasets = [("asperity", &numbers[..]), ("height", heights), ("radius", radii), ("x", x), ("y", y)];
    for (name, values) in datasets {
        file.new_dataset_builder().with_data(values).create(&*format!("asperities/{name}")).unwrap();
    }
    let density = heights.len() as f64 / (extent[0] * extent[1]);
    let numbers = [
        ("measured/asperity_density", density),
        ("measured/asperity_height_mean", mean),
        ("surface/m0", 1e-18),
        ("surface/m2", 1e-4),
        ("surface/m4", 1e10),
    ];
    for (name, value) in numbers {
        file.new_dataset::<f64>().create(name).unwrap().write_scalar(&value).unwrap();
    }
}
