//! `stiction asperities`: from a measured height map to its asperities.

mod arguments;
mod file;
mod summary;
mod surface;

pub(super) use arguments::AsperitiesArguments;

use self::surface::surface;
use super::failure::Failure;
use super::resources;
use super::terminal::{print, print_of};
use crate::experiment::Error;
use crate::input::maps::MOST_PIXELS;
use crate::output::OutputLock;
use crate::output::schema::ASPERITIES;
use crate::output::writer::Writer;

/// Bytes that a pixel takes at most while a map is read, levelled and searched; while it is smoothed; and while
/// its summits are sorted out by prominence.
const PIXEL: (f64, f64, f64) = (24.0, 56.0, 32.0);

pub(super) fn asperities(arguments: &AsperitiesArguments) -> Result<(), Failure> {
    let (map, output) = (&arguments.map, arguments.output.as_ref());
    let is_smoothed = arguments.smooth.is_some() || arguments.cutoffs.is_some();
    let of_filter = if is_smoothed { PIXEL.1 } else { PIXEL.0 };
    let of_search = if arguments.prominence.is_some() { PIXEL.2 } else { PIXEL.0 };
    let most = resources::fitting(of_filter.max(of_search), MOST_PIXELS);
    let lock = output.map(|output| OutputLock::new(output, std::slice::from_ref(map))).transpose()?;
    lock.as_ref().map_or(Ok(()), |lock| lock.check(arguments.force))?;
    let surface = surface(arguments, most)?;
    if let Some(lock) = &lock {
        let written = Writer::create(&ASPERITIES, lock, arguments.force).and_then(|mut writer| {
            file::write(&mut writer, &surface)?;
            writer.finish()
        });
        written.map_err(|error| Error::NotWritten(error.writing(lock.output())))?;
    }
    let text = summary::summary(&surface);
    match output {
        Some(output) => print_of(output, &text),
        None => print(&text),
    }
}
