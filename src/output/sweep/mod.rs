//! Sweeps into a file of results, which go on after an interruption: their points, computed as single scenes, and stacked.

mod points;
mod rows;
mod stack;

pub(crate) use points::Points;
pub(crate) use rows::{DRY, run_sweep, stacked};
pub use rows::{PointPullOff, SweepPoint};

use super::kept::{OutputLock, OverwritePolicy};
use super::task::Session;
use crate::error::{Error, OutputError};
use crate::input::columns::SceneFiles;
use crate::scene::{Document, Scene};
use std::path::{Path, PathBuf};

/// Runs every point of a scene with a table `[sweep]` into one file, on all cores. What an interrupted sweep
/// into this file has kept is gone on with.
///
/// # Errors
/// [`Error::NotFor`] for a scene without a sweep, [`Error::Output`] when the file exists; as
/// [`run`](fn@crate::run).
///
/// # Examples
/// ```no_run
/// for point in stiction::sweep("configs/sweep_roughness.toml", "roughness.h5")? {
///     let [mean, error] = point.pull_offs[0].force;
///     println!("{mean:.3e} N ± {error:.0e} N");
/// }
/// # Ok::<(), stiction::Error>(())
/// ```
pub fn sweep(scene: impl AsRef<Path>, output: impl AsRef<Path>) -> Result<Vec<SweepPoint>, Error> {
    let (source, output) = (scene.as_ref(), output.as_ref());
    let Document { scene, sweep: Some(sweep) } = Document::from_toml_file(source)? else {
        let problem = "has no table [sweep], and is one point; run it as a Scene".to_owned();
        return Err(Error::NotFor(problem).in_scene(source));
    };
    let session = Session::unwatched()?;
    let lock = OutputLock::new(output, &inputs_of(source, &scene))?;
    let policy = OverwritePolicy { resume: true, force: false };
    run_sweep(&Points::new(&sweep, source, &session, &lock, policy))?
        .ok_or_else(|| OutputError::Exists(output.to_owned()).into())
}

/// The files that a scene is made of: its own, and those that it takes values from.
pub(crate) fn inputs_of(path: &Path, scene: &Scene) -> Vec<PathBuf> {
    let files = SceneFiles::scene(path);
    std::iter::once(path.to_owned()).chain(scene.inputs.iter().map(|input| files.path(&input.path))).collect()
}
