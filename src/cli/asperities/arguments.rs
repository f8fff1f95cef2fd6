//! Arguments of `stiction asperities`.

use crate::scene::units::{Dimension, parse};
use crate::surface::map::{Levelling, PIXELS};
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
    /// Overwrite an existing result
    #[arg(long)]
    pub force: bool,
}

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
    let length = |text: &str| match parse(text, Dimension::Length) {
        Ok(length) if PIXELS.contains(&length) => Ok(length),
        Ok(_) => Err("a pixel is between 1e-13 and 1e3 m".to_owned()),
        Err(_) => Err(format!(
            "a length with its unit is needed, such as \"9.8 nm\" ({})",
            Dimension::Length.units()
        )),
    };
    let (width, height) = text.split_once(',').unwrap_or((text, text));
    Ok([length(height)?, length(width)?])
}

/// A unit of length in m.
pub(super) fn length_unit(unit: &str) -> Result<f64, String> {
    parse(&format!("1 {unit}"), Dimension::Length)
        .map_err(|_| format!("known: {}", Dimension::Length.units()))
}
