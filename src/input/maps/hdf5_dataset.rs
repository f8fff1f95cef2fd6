//! Datasets of HDF5 files.

use super::{RawMap, not_two, within};
use crate::output::attributes::{lossy, read_text};
use crate::output::guard;
use crate::scene::echo::shortened;
use hdf5::types::TypeDescriptor;
use hdf5::{Dataset, File};
use std::path::Path;

/// Most names that a message lists.
const MOST_NAMES: usize = 12;

pub(super) fn read(path: &Path, length: u64, name: &str, most: u64) -> Result<RawMap, String> {
    let file = guard::open(path)?;
    let dataset = guard::dataset(&file, name).map_err(|problem| with_names(problem, &file))?;
    let broken = |problem: &str| format!("has a dataset {name} that {problem}");
    let lengths: Vec<u64> = dataset.shape().iter().map(|length| *length as u64).collect();
    let &[rows, columns] = lengths.as_slice() else { return Err(broken(&not_two(&lengths))) };
    let shape = within([rows, columns], most).map_err(|problem| broken(&problem))?;
    if !holds_numbers(&dataset) {
        return Err(broken("does not hold numbers"));
    }
    guard::fits(&dataset, length).map_err(|problem| broken(&problem))?;
    let heights = dataset.read_raw::<f64>().map_err(|_| broken("is damaged"))?;
    let unit = dataset.attr("units").is_ok().then(|| read_text(&dataset, "units").ok()).flatten();
    Ok(RawMap { heights, shape, extent: [None; 2], unit, dataset: Some(name.to_owned()) })
}

fn holds_numbers(dataset: &Dataset) -> bool {
    let descriptor = dataset.dtype().and_then(|dtype| dtype.to_descriptor());
    matches!(
        descriptor,
        Ok(TypeDescriptor::Integer(_) | TypeDescriptor::Unsigned(_) | TypeDescriptor::Float(_))
    )
}

/// The datasets of the root that may be maps.
fn maps(file: &File) -> Vec<String> {
    let names = file.member_names().unwrap_or_default().into_iter();
    let two_dimensional = |name: &String| {
        guard::dataset(file, name).is_ok_and(|dataset| dataset.ndim() == 2 && holds_numbers(&dataset))
    };
    names.filter(two_dimensional).collect()
}

/// The name of the only dataset that may be a map; otherwise what there is in its place.
pub(super) fn only_map(path: &Path) -> Result<Result<String, String>, String> {
    Ok(match maps(&guard::open(path)?).as_slice() {
        [only] => Ok(only.clone()),
        [] => Err("has no dataset of two dimensions in its root; name the path of one".to_owned()),
        several => Err(format!("has several datasets; name one of {}", listed(several))),
    })
}

fn with_names(problem: String, file: &File) -> String {
    match maps(file).as_slice() {
        [] => problem,
        names => format!("{problem}; it has {}", listed(names)),
    }
}

fn listed(names: &[String]) -> String {
    let shown: Vec<String> =
        names.iter().take(MOST_NAMES).map(|name| shortened(&lossy(name.as_bytes()))).collect();
    let more = if names.len() > MOST_NAMES { ", ..." } else { "" };
    shown.join(", ") + more
}
