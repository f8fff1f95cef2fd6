//! Arguments of `stiction asperities`.

use crate::scene::units::{Dimension, parse};
use crate::surface::map::{HIGHEST, Levelling, PIXELS};
use clap::Args;
use std::path::PathBuf;

#[derive(Args)]
pub(crate) struct AsperitiesArguments {
    /// The height map: NPY, HDF5, or a text with a row of the map on each line
    pub map: PathBuf,
    /// Where the result goes; by default there is only the summary
    #[arg(short, long, value_name = "FILE.h5")]
    pub output: Option<PathBuf>,
    /// Size of a pixel, such as "9.8 nm", or its width and height, "9.8 nm,10 nm"; by default from the header
    /// of a text
    #[arg(long, value_name = "DX[,DY]", value_parser = pixel, allow_hyphen_values = true)]
    pub pixel: Option<[f64; 2]>,
    /// Unit of the heights, such as nm; by default what the file says
    #[arg(long, value_name = "UNIT", value_parser = HeightUnit::new)]
    pub height_unit: Option<HeightUnit>,
    /// Which dataset of an HDF5 file is the map
    #[arg(long, value_name = "NAME")]
    pub dataset: Option<String>,
    /// What is subtracted from the heights: none (their mean), plane or quadratic
    #[arg(long, default_value = "plane", value_parser = levelling)]
    pub level: Levelling,
    /// Smooth the levelled map: a cut-off wavelength, such as "200 nm", below which an areal Gaussian filter
    /// takes waves away (ISO 16610-61)
    #[arg(long, value_name = "WAVELENGTH", value_parser = wavelength, allow_hyphen_values = true)]
    pub smooth: Option<f64>,
    /// Count only summits that are so high above the saddle on the way to higher ground, such as "0.5 nm"
    #[arg(long, value_name = "HEIGHT", value_parser = prominence, allow_hyphen_values = true)]
    pub prominence: Option<f64>,
    /// Report density, radius and scatter of the summits over N cut-offs too, from 2 pixels to a quarter of
    /// the map's side
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(2..=MOST_CUTOFFS))]
    pub cutoffs: Option<u16>,
    /// Overwrite an existing result
    #[arg(long)]
    pub force: bool,
}

/// Most cut-offs of a series: a page has no room for more.
const MOST_CUTOFFS: i64 = 100;

/// A unit of heights as it is given.
#[derive(Clone)]
pub(crate) struct HeightUnit {
    pub name: String,
    /// m.
    pub length: f64,
}

impl HeightUnit {
    fn new(unit: &str) -> Result<Self, String> {
        Ok(Self { name: unit.to_owned(), length: length_unit(unit)? })
    }
}

fn levelling(name: &str) -> Result<Levelling, String> {
    let known = Levelling::ALL.iter().find(|(known, _)| *known == name);
    known.map(|(_, levelling)| *levelling).ok_or_else(|| "known: none, plane, quadratic".to_owned())
}

/// Height and width of a pixel, m.
fn pixel(text: &str) -> Result<[f64; 2], String> {
    let size = |text: &str| match length(text, "9.8 nm")? {
        size if PIXELS.contains(&size) => Ok(size),
        _ => Err("a pixel is between 1e-13 and 1e3 m".to_owned()),
    };
    let (width, height) = text.split_once(',').unwrap_or((text, text));
    Ok([size(height)?, size(width)?])
}

/// A cut-off in m; whether the map has such waves is not known here.
fn wavelength(text: &str) -> Result<f64, String> {
    length(text, "200 nm").and_then(|length| {
        if length > 0.0 { Ok(length) } else { Err("a cut-off wavelength is above 0".to_owned()) }
    })
}

/// A least prominence in m.
fn prominence(text: &str) -> Result<f64, String> {
    length(text, "0.5 nm").and_then(|height| {
        if (0.0..=HIGHEST).contains(&height) {
            Ok(height)
        } else {
            Err("a prominence is between 0 and 1e6 m".to_owned())
        }
    })
}

fn length(text: &str, example: &str) -> Result<f64, String> {
    parse(text, Dimension::Length).map_err(|_| {
        format!("a length with its unit is needed, such as \"{example}\" ({})", Dimension::Length.units())
    })
}

/// A unit of length in m.
pub(super) fn length_unit(unit: &str) -> Result<f64, String> {
    parse(&format!("1 {unit}"), Dimension::Length)
        .map_err(|_| format!("known: {}", Dimension::Length.units()))
}
