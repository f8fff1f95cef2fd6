//! The asperities of a measured surface under the names of their file layout.

use super::surface::Surface;
use crate::experiment::result_file::write_program;
use crate::output::OutputError;
use crate::output::schema::Dimension;
use crate::output::writer::Writer;
use crate::surface::map::{AtCutoff, HeightMap, Summit};

pub(super) fn write(writer: &mut Writer<'_>, surface: &Surface<'_>) -> Result<(), OutputError> {
    let Surface { arguments, asperities, map, .. } = surface;
    write_program(writer)?;
    let name = arguments.map.file_name().unwrap_or_default().to_string_lossy();
    writer.text("/", "map", &name)?;
    writer.text("/", "map_source", &surface.source)?;
    let unit = arguments.height_unit.as_ref().map_or("", |unit| &unit.name);
    writer.text("/", "height_unit", unit)?;
    writer.text("/", "level", arguments.level.name())?;
    writer.number("/", "smooth", arguments.smooth.unwrap_or(0.0))?;
    writer.number("/", "prominence", arguments.prominence.unwrap_or(0.0))?;
    writer.number("/", "cutoffs", u64::from(arguments.cutoffs.unwrap_or(0)))?;
    writer.numbers("/", "border", &map.margin().map(|pixels| pixels as u64))?;
    writer.numbers("/", "map_shape", &map.shape().map(|length| length as u64))?;
    writer.numbers("/", "pixel_size", &map.pixel())?;
    writer.number("/", "missing_pixels", surface.missing as u64)?;
    writer.number("/", "nominal_area", asperities.nominal_area)?;
    writer.number("/", "mean_plane_offset", asperities.measured.height_mean)?;
    writer.text("/", "warnings", &surface.caveats.join("\n"))?;
    let count = asperities.summits.len() as u64;
    writer.scale(Dimension::Asperity, &(0..count).collect::<Vec<u64>>());
    write_asperities(writer, surface)?;
    write_map(writer, &surface.map)?;
    write_series(writer, &surface.series)?;
    write_surface(writer, surface)
}

fn write_asperities(writer: &Writer<'_>, surface: &Surface<'_>) -> Result<(), OutputError> {
    let [dy, dx] = surface.map.pixel();
    let write = |name: &str, of: &dyn Fn(&Summit) -> f64| {
        let values: Vec<f64> = surface.asperities.summits.iter().map(of).collect();
        writer.dataset(&format!("/asperities/{name}"), &values)
    };
    write("height", &|summit| summit.height)?;
    write("radius", &Summit::radius)?;
    write("x", &|summit| middle(summit.column, dx))?;
    write("y", &|summit| middle(summit.row, dy))?;
    write("curvature_x", &|summit| summit.curvature[1])?;
    write("curvature_y", &|summit| summit.curvature[0])?;
    write("curvature_xy", &|summit| summit.twist)?;
    write("principal_radius_1", &|summit| 1.0 / summit.principal_curvatures()[0])?;
    let of_blunt = |blunt: f64| if blunt > 0.0 { 1.0 / blunt } else { f64::NAN };
    write("principal_radius_2", &|summit| of_blunt(summit.principal_curvatures()[1]))?;
    write("equivalent_radius", &Summit::equivalent_radius)?;
    let prominences = &surface.asperities.prominences;
    prominences.as_ref().map_or(Ok(()), |values| writer.dataset("/asperities/prominence", values))
}

/// Writes what is counted over the cut-off, if it is; where there is no summit a radius is NaN.
fn write_series(writer: &mut Writer<'_>, series: &[AtCutoff]) -> Result<(), OutputError> {
    if series.is_empty() {
        return Ok(());
    }
    writer.group("cutoffs")?;
    writer.scale(Dimension::Cutoff, &series.iter().map(|at| at.cutoff).collect::<Vec<f64>>());
    let write = |name: &str, of: &dyn Fn(&AtCutoff) -> f64| {
        writer.dataset(&format!("/cutoffs/{name}"), &series.iter().map(of).collect::<Vec<f64>>())
    };
    let counts: Vec<u64> = series.iter().map(|at| at.count as u64).collect();
    writer.dataset("/cutoffs/summit_count", &counts)?;
    write("nominal_area", &|at| at.nominal_area)?;
    write("asperity_density", &|at| at.measured.map_or(0.0, |measured| measured.density))?;
    write("asperity_radius", &|at| at.measured.map_or(f64::NAN, |measured| measured.radius))?;
    write("asperity_height_std", &|at| at.measured.map_or(f64::NAN, |measured| measured.height_std))?;
    write("asperity_curvature_std", &|at| at.measured.map_or(f64::NAN, |measured| measured.curvature_std))
}

/// Writes the heights that were searched.
fn write_map(writer: &mut Writer<'_>, map: &HeightMap) -> Result<(), OutputError> {
    let ([rows, columns], [dy, dx]) = (map.shape(), map.pixel());
    let middles =
        |count: usize, pixel: f64| (0..count).map(|index| middle(index, pixel)).collect::<Vec<f64>>();
    writer.group("map")?;
    writer.scale(Dimension::MapX, &middles(columns, dx));
    writer.scale(Dimension::MapY, &middles(rows, dy));
    writer.compressed("/map/height", map.heights())
}

/// The middle of a pixel; the first one begins at 0.
fn middle(index: usize, pixel: f64) -> f64 {
    (index as f64 + 0.5) * pixel
}

fn write_surface(writer: &Writer<'_>, surface: &Surface<'_>) -> Result<(), OutputError> {
    let (moments, measured) = (&surface.asperities.moments, &surface.asperities.measured);
    let equivalent = &surface.asperities.equivalent;
    let write = |path: &str, value: f64| writer.dataset(path, &[value]);
    write("/surface/m0", moments.m0)?;
    write("/surface/m2", moments.m2())?;
    write("/surface/m4", moments.m4())?;
    write("/surface/slope_x", moments.slope[1])?;
    write("/surface/slope_y", moments.slope[0])?;
    write("/surface/alpha", moments.alpha())?;
    write("/surface/skewness", moments.skewness)?;
    write("/surface/excess_kurtosis", moments.excess_kurtosis)?;
    write("/measured/asperity_density", measured.density)?;
    write("/measured/asperity_radius", measured.radius)?;
    write("/measured/asperity_height_mean", measured.height_mean)?;
    write("/measured/asperity_height_std", measured.height_std)?;
    write("/measured/asperity_curvature_std", measured.curvature_std)?;
    write("/measured/curvature_ratio_median", surface.asperities.shape.ratio)?;
    writer.dataset("/measured/saddle_count", &[surface.asperities.shape.saddles as u64])?;
    write("/equivalent/asperity_density", equivalent.density)?;
    write("/equivalent/asperity_radius", equivalent.radius)?;
    write("/equivalent/asperity_height_mean", equivalent.height_mean)?;
    write("/equivalent/asperity_height_std", equivalent.height_std)
}
