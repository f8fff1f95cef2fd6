//! `stiction asperities`: from a measured height map to its asperities.

mod record;
mod summary;

use super::apart::{apart_within, is_apart};
use super::{AsperitiesArguments, Failure, print, print_of, resources};
use crate::output::Claim;
use crate::output::maps::{self, MOST_PIXELS, MapFormat, RawMap};
use crate::output::schema::ASPERITIES;
use crate::output::writer::Writer;
use crate::scene::echo::shortened;
use crate::surface::map::{Asperities, HeightMap, MapError};
use std::path::Path;

/// Bytes that a pixel takes at most while a map is read, levelled and searched.
const PIXEL: f64 = 24.0;
/// Longest that an HDF5 file may keep a processor busy until its map is read, s; the largest, deflated, takes some 8.
const PROCESSOR_SECONDS: u64 = 40;

/// A measured surface and what was found on it.
struct Surface<'a> {
    arguments: &'a AsperitiesArguments,
    /// The kind of file, the dataset that was read included.
    source: String,
    /// Rows and columns.
    shape: [usize; 2],
    /// Height and width of a pixel, m.
    pixel: [f64; 2],
    missing: usize,
    asperities: Asperities,
    caveats: Vec<String>,
}

pub(super) fn asperities(arguments: &AsperitiesArguments) -> Result<(), Failure> {
    let (map, output) = (&arguments.map, arguments.output.as_ref());
    let most = resources::fitting(PIXEL, MOST_PIXELS);
    if MapFormat::of(map)? == MapFormat::Hdf5 {
        let dataset = arguments.dataset.as_deref();
        apart_within(map, PROCESSOR_SECONDS, |map| Ok(maps::try_dataset(map, dataset, most)?))?;
        if is_apart() {
            return Ok(());
        }
    }
    let claim = output.map(|output| Claim::new(output, std::slice::from_ref(map))).transpose()?;
    claim.as_ref().map_or(Ok(()), |claim| claim.check(arguments.force))?;
    let surface = surface(arguments, most)?;
    if let Some(claim) = &claim {
        let written = Writer::create(&ASPERITIES, claim, arguments.force).and_then(|mut writer| {
            record::write(&mut writer, &surface)?;
            writer.finish()
        });
        written.map_err(|error| error.writing(claim.output()))?;
    }
    let text = summary::summary(&surface);
    match output {
        Some(output) => print_of(output, &text),
        None => print(&text),
    }
}

/// Reads and levels the map, and finds its asperities.
fn surface(arguments: &AsperitiesArguments, most: u64) -> Result<Surface<'_>, Failure> {
    let path = &arguments.map;
    let raw = maps::read(path, arguments.dataset.as_deref(), most)?;
    let pixel = pixel(path, arguments.pixel, &raw)?;
    let unit = height_unit(path, arguments.height_unit, &raw)?;
    let format = MapFormat::of(path)?.name();
    let source = raw.dataset.as_ref().map_or(format.to_owned(), |dataset| format!("{format}, dataset {dataset}"));
    let refused = |error: MapError| Failure::Usage(format!("{}: {error}", path.display()));
    let shape = raw.shape;
    let heights = raw.heights.into_iter().map(|height| height * unit).collect();
    let measured = HeightMap::new(heights, shape, pixel).map_err(refused)?;
    let flaws = measured.flaws();
    let levelled = measured.levelled(arguments.level).map_err(refused)?;
    let asperities = Asperities::new(&levelled).map_err(refused)?;
    let missing = levelled.missing();
    let caveats = asperities.caveats(pixel).into_iter().chain(flaws).collect();
    Ok(Surface { arguments, source, shape, pixel, missing, asperities, caveats })
}

/// Height and width of a pixel, m: as given, or by the extent that the file states.
fn pixel(path: &Path, given: Option<[f64; 2]>, raw: &RawMap) -> Result<[f64; 2], Failure> {
    if let Some(given) = given {
        return Ok(given);
    }
    match raw.extent {
        [Some(height), Some(width)] => Ok([height / raw.shape[0] as f64, width / raw.shape[1] as f64]),
        _ => Err(Failure::Usage(format!(
            "{}: does not say how large it is; give --pixel with the size of a pixel, such as --pixel \"9.8 nm\"",
            path.display()
        ))),
    }
}

/// The unit of the heights in m: as given, or as the file states it.
fn height_unit(path: &Path, given: Option<f64>, raw: &RawMap) -> Result<f64, Failure> {
    if let Some(given) = given {
        return Ok(given);
    }
    let refused = |problem: String| {
        Failure::Usage(format!("{}: {problem}; give --height-unit, such as --height-unit nm", path.display()))
    };
    match &raw.unit {
        Some(unit) => super::length_unit(unit).map_err(|known| {
            refused(format!("has heights in `{}`, which is no unit of length ({known})", shortened(unit)))
        }),
        None => Err(refused("does not say in which unit its heights are".to_owned())),
    }
}
