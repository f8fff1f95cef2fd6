//! Measured surfaces and what is found on them.

use super::arguments::{AsperitiesArguments, length_unit};
use crate::cli::failure::Failure;
use crate::format::si;
use crate::input::maps::{self, MapFormat, RawMap};
use crate::scene::echo::shortened;
use crate::surface::map::{Asperities, AtCutoff, HeightMap, MapError};
use std::ops::RangeInclusive;
use std::path::Path;

/// Root mean square slopes of surfaces, polished optics and torn ones included: others come of a wrong unit.
const SLOPES: RangeInclusive<f64> = 1e-7..=10.0;
/// The range of most surfaces.
const USUAL_SLOPES: RangeInclusive<f64> = 1e-4..=1.0;
/// Units that heights may be in.
const UNITS: [&str; 5] = ["m", "mm", "um", "nm", "pm"];

/// Relative difference below which sizes are equal.
const ALIKE: f64 = 1e-6;

/// A measured surface and what was found on it.
pub(super) struct Surface<'a> {
    pub arguments: &'a AsperitiesArguments,
    /// The kind of file, the dataset that was read included.
    pub source: String,
    /// The map as it was searched.
    pub map: HeightMap,
    pub missing: usize,
    pub asperities: Asperities,
    /// The summits over the cut-off, where they are asked for.
    pub series: Vec<AtCutoff>,
    pub caveats: Vec<String>,
}

/// Reads, levels and smooths the map, and finds its asperities.
pub(super) fn surface(arguments: &AsperitiesArguments, most: u64) -> Result<Surface<'_>, Failure> {
    let path = &arguments.map;
    let raw = maps::read(path, arguments.dataset.as_deref(), most)?;
    let (pixel, other_pixel) = pixel(path, arguments.pixel, &raw)?;
    let (unit, other_unit) = height_unit(path, arguments.height_unit.as_ref().map(|unit| unit.length), &raw)?;
    let format = MapFormat::of(path)?.name();
    let source =
        raw.dataset.as_ref().map_or(format.to_owned(), |dataset| format!("{format}, dataset {dataset}"));
    let refused = |error: MapError| Failure::Usage(format!("{}: {}", path.display(), told(&error)));
    let shape = raw.shape;
    let heights = raw.heights.into_iter().map(|height| height * unit).collect();
    let measured = HeightMap::new(heights, shape, pixel).map_err(refused)?;
    let flaws = measured.flaws();
    let levelled = measured.levelled(arguments.level).map_err(refused)?;
    let (prominence, missing) = (arguments.prominence, levelled.missing());
    let series = series(arguments, &levelled).map_err(refused)?;
    let map = match arguments.smooth {
        Some(cutoff) => levelled.smoothed(cutoff).map_err(refused)?,
        None => levelled,
    };
    let asperities = match prominence {
        Some(least) => Asperities::prominent(&map, least),
        None => Asperities::new(&map),
    };
    let asperities = asperities.map_err(refused)?;
    let first = other_pixel.into_iter().chain(other_unit).chain(wrong_unit(&asperities, unit));
    let caveats = first.chain(asperities.caveats(pixel)).chain(flaws).collect();
    Ok(Surface { arguments, source, map, missing, asperities, series, caveats })
}

/// The summits over the cut-off, the cut-off of the map included.
fn series(arguments: &AsperitiesArguments, levelled: &HeightMap) -> Result<Vec<AtCutoff>, MapError> {
    let Some(count) = arguments.cutoffs else { return Ok(Vec::new()) };
    let mut cutoffs = levelled.cutoff_series(usize::from(count))?;
    cutoffs.extend(arguments.smooth);
    cutoffs.sort_unstable_by(f64::total_cmp);
    cutoffs.dedup();
    levelled.at_cutoffs(&cutoffs, arguments.prominence)
}

/// The problem of a map, and its remedy.
fn told(error: &MapError) -> String {
    let length = |length: f64| si(length, "m");
    match *error {
        MapError::Undetermined { .. } => format!("{error}; try --level none"),
        MapError::Cutoff { given, least, .. } if given < least => format!(
            "--smooth {} is below two pixels, which is the shortest wave of the map; give {} or more",
            length(given),
            length(least)
        ),
        MapError::Cutoff { given, most, .. } => format!(
            "--smooth {} is above half the shorter side of the map; give {} or less",
            length(given),
            length(most)
        ),
        MapError::NoCutoffs { least, most } => format!(
            "--cutoffs has no room between two pixels, {}, and a quarter of the shorter side, {}; leave it out",
            length(least),
            length(most)
        ),
        MapError::NotProminent { least, most } => format!(
            "no summit has a prominence of {}; the most prominent one has {}, so that --prominence has to be less",
            length(least),
            length(most)
        ),
        _ => error.to_string(),
    }
}

/// Height and width of a pixel, m: as given, or by the extent that the file states; and that it states
/// another one.
fn pixel(path: &Path, given: Option<[f64; 2]>, raw: &RawMap) -> Result<([f64; 2], Option<String>), Failure> {
    let stated = match raw.extent {
        [Some(height), Some(width)] => Some([height / raw.shape[0] as f64, width / raw.shape[1] as f64]),
        _ => None,
    };
    let alike =
        |one: [f64; 2], other: [f64; 2]| one.iter().zip(other).all(|(a, b)| (a / b - 1.0).abs() < ALIKE);
    let shown = |[height, width]: [f64; 2]| format!("{} x {}", si(width, "m"), si(height, "m"));
    match (given, stated) {
        (Some(given), Some(stated)) if !alike(given, stated) => {
            let problem = format!(
                "--pixel says {}, and the file {}: taken as --pixel says",
                shown(given),
                shown(stated)
            );
            Ok((given, Some(problem)))
        }
        (Some(pixel), _) | (None, Some(pixel)) => Ok((pixel, None)),
        (None, None) => Err(Failure::Usage(format!(
            "{}: does not say how large it is; give --pixel with the size of a pixel, such as --pixel \"9.8 nm\"",
            path.display()
        ))),
    }
}

/// The unit of the heights in m: as given, or as the file states it; and that it states another one.
fn height_unit(path: &Path, given: Option<f64>, raw: &RawMap) -> Result<(f64, Option<String>), Failure> {
    let stated = raw.unit.as_ref().map(|unit| (length_unit(unit), shortened(unit)));
    let refused = |problem: String| {
        Failure::Usage(format!("{}: {problem}; give --height-unit, such as --height-unit nm", path.display()))
    };
    match (given, stated) {
        (Some(given), Some((stated, name)))
            if !stated.as_ref().is_ok_and(|stated| (given / stated - 1.0).abs() < ALIKE) =>
        {
            let given_name = si(given, "m");
            Ok((
                given,
                Some(format!(
                    "--height-unit says {given_name}, and the file {name}: taken as --height-unit says"
                )),
            ))
        }
        (Some(unit), _) | (None, Some((Ok(unit), _))) => Ok((unit, None)),
        (None, Some((Err(known), name))) => {
            Err(refused(format!("has heights in `{name}`, which is no unit of length ({known})")))
        }
        (None, None) => Err(refused("does not say in which unit its heights are".to_owned())),
    }
}

/// Warns of slopes that no surface has, where heights or pixels are in a wrong unit, and says which unit of
/// heights would make them usual.
fn wrong_unit(asperities: &Asperities, unit: f64) -> Option<String> {
    let slope = asperities.moments.m2().sqrt();
    if SLOPES.contains(&slope) {
        return None;
    }
    let by = |name: &str| length_unit(name).map_or(f64::NAN, |other| slope * other / unit);
    let usual =
        UNITS.into_iter().map(|name| (name, by(name))).find(|(_, slope)| USUAL_SLOPES.contains(slope));
    let advice = usual.map(|(name, slope)| format!("; with --height-unit {name} they would be {slope:.1e}"));
    let advice = advice.unwrap_or_default();
    Some(format!(
        "slopes are {slope:.1e} on average, as on no surface: the unit of the heights or of the pixels is wrong{advice}"
    ))
}
