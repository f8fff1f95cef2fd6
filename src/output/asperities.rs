//! Reading the asperities of a measured surface back, as `stiction asperities` leaves them.

use super::OutputError;
use super::reader::Reader;
use super::schema::ASPERITIES;
use crate::scene::files::Measured;
use std::path::Path;

/// The asperities of a measured surface.
///
/// # Examples
/// ```no_run
/// use stiction::output::asperities::{AsperityFile, read};
///
/// // What `stiction asperities map.npy -o asperities.h5` has written.
/// let AsperityFile { asperities, .. } = read("asperities.h5".as_ref())?;
/// assert_eq!(asperities.heights.len(), asperities.radii.len());
/// # Ok::<(), stiction::OutputError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct AsperityFile {
    /// The asperities: radii and area are positive; equivalent radii are none of files of before version 2.2. Places and lengths of a
    /// smoothed map are less its border.
    pub asperities: Measured,
    /// Asperities over that area, 1/m².
    pub density: f64,
    /// Mean of the heights, m: the height of the mean plane of the asperities above the surface's.
    pub mean_plane_offset: f64,
    /// Mean square height of the surface, m².
    pub m0: f64,
    /// Mean square slope of profiles.
    pub m2: f64,
    /// Mean square second derivative of profiles, 1/m².
    pub m4: f64,
}

/// Reads a result of `stiction asperities`.
///
/// Like every result it may come from anywhere: what it claims is checked, but a broken structure can keep
/// libhdf5 for ever ([`super::reader`]).
///
/// # Errors
/// [`OutputError::NotAResult`] when it is no such result, lacks a dataset, or holds what no asperities can
/// have.
pub fn read(path: &Path) -> Result<AsperityFile, OutputError> {
    let reader = Reader::open(path, &[&ASPERITIES])?;
    let refused = |problem: String| OutputError::NotAResult { path: path.to_owned(), problem };
    let finite = |name: &str, does: fn(f64) -> bool| -> Result<Vec<f64>, OutputError> {
        let values: Vec<f64> = reader.values(name)?;
        match values.iter().position(|value| !(value.is_finite() && does(*value))) {
            Some(place) => Err(refused(format!("has the value {:e} at {place} of {name}", values[place]))),
            None => Ok(values),
        }
    };
    let any: fn(f64) -> bool = |_| true;
    let positive: fn(f64) -> bool = |value| value > 0.0;
    let number = |name: &str| finite(name, positive).map(|values| values[0]);
    let heights = finite("/asperities/height", any)?;
    if heights.is_empty() {
        return Err(refused("has no asperities".to_owned()));
    }
    let radii = finite("/asperities/radius", positive)?;
    const EQUIVALENT: &str = "/asperities/equivalent_radius";
    let equivalent_radii = reader.has(EQUIVALENT).then(|| finite(EQUIVALENT, positive)).transpose()?;
    let [down, along] = border(&reader)?;
    let positions = finite("/asperities/x", any)?.into_iter().zip(finite("/asperities/y", any)?);
    let nominal_area: f64 = reader.number("/", "nominal_area")?;
    if !(nominal_area > 0.0 && nominal_area.is_finite()) {
        return Err(refused(format!("has nominal_area = {nominal_area:e}, and a positive area is needed")));
    }
    let extent = extent(&reader)?;
    let mean_plane_offset = finite("/measured/asperity_height_mean", any)?[0];
    let m0 = number("/surface/m0")?;
    let asperities = Measured {
        positions: positions.map(|(x, y)| [x - along, y - down]).collect(),
        extent,
        heights,
        radii,
        equivalent_radii,
        nominal_area,
        surface_height_std: m0.sqrt(),
    };
    Ok(AsperityFile {
        asperities,
        density: number("/measured/asperity_density")?,
        mean_plane_offset,
        m0,
        m2: number("/surface/m2")?,
        m4: number("/surface/m4")?,
    })
}

/// The lengths of the map along x and y, m, if the file says how many pixels it has, and how large they are.
fn extent(reader: &Reader) -> Result<Option<[f64; 2]>, OutputError> {
    if !(reader.has_attribute("/", "map_shape")? && reader.has_attribute("/", "pixel_size")?) {
        return Ok(None);
    }
    let shape: Vec<u64> = reader.attribute("/", "map_shape")?;
    let pixel: Vec<f64> = reader.attribute("/", "pixel_size")?;
    let ([rows, columns], [height, width]) = (&shape[..], &pixel[..]) else { return Ok(None) };
    let [down, along] = border(reader)?;
    let extent = [*columns as f64 * width - 2.0 * along, *rows as f64 * height - 2.0 * down];
    Ok(extent.iter().all(|length| *length > 0.0 && length.is_finite()).then_some(extent))
}

/// Height and width of the border that was not searched on either side of a smoothed map, m; 0 where the file
/// does not say.
fn border(reader: &Reader) -> Result<[f64; 2], OutputError> {
    if !(reader.has_attribute("/", "border")? && reader.has_attribute("/", "pixel_size")?) {
        return Ok([0.0; 2]);
    }
    let border: Vec<u64> = reader.attribute("/", "border")?;
    let pixel: Vec<f64> = reader.attribute("/", "pixel_size")?;
    let (&[down, along], &[height, width]) = (&border[..], &pixel[..]) else { return Ok([0.0; 2]) };
    Ok([down as f64 * height, along as f64 * width])
}
