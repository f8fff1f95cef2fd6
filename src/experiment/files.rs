//! Experiments from a scene's file into a file of results, which go on after an interruption.

use super::Error;
use super::partial::OverwritePolicy;
use super::points::Points;
use super::prepared::{Session, thread_pool};
use super::stacked::{SweepPoint, run_sweep};
use crate::input::columns::SceneFiles;
use crate::output::{OutputError, OutputLock};
use crate::scene::{Document, Scene, Sweep};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

/// Seconds after which what has been done is kept.
const INTERVAL: Duration = Duration::from_secs(30);

/// Runs every point of a scene with a table `[sweep]` into one file, on all cores. What an interrupted sweep
/// into this file has kept is gone on with.
///
/// # Errors
/// [`Error::NotFor`] for a scene without a sweep, [`Error::Output`] when the file exists; as
/// [`run`](fn@super::run).
///
/// # Examples
/// ```no_run
/// for point in stiction::sweep("configs/sweep_roughness.toml", "roughness.h5")? {
///     println!("{:.3e} N ± {:.0e} N", point.pull_off[0], point.pull_off[1]);
/// }
/// # Ok::<(), stiction::Error>(())
/// ```
pub fn sweep(scene: impl AsRef<Path>, output: impl AsRef<Path>) -> Result<Vec<SweepPoint>, Error> {
    let (source, output) = (scene.as_ref(), output.as_ref());
    let Document { scene, sweep: Some(sweep) } = Document::from_toml_file(source)? else {
        let problem = "has no table [sweep], and is one point; run it as a Scene".to_owned();
        return Err(Error::NotFor(problem).in_scene(source));
    };
    let session = session(0)?;
    let lock = OutputLock::new(output, &inputs_of(source, &scene))?;
    let points = points(&sweep, source, &session, &lock);
    run_sweep(&points)?.ok_or_else(|| OutputError::Exists(output.to_owned()).into())
}

/// A session on `threads` threads, or one for each core with 0, that nobody watches.
pub(super) fn session(threads: usize) -> Result<Session, Error> {
    Ok(Session { stop: Arc::default(), pool: thread_pool(threads)?, interval: INTERVAL, host: Box::new(()) })
}

fn points<'a>(sweep: &'a Sweep, source: &'a Path, session: &'a Session, lock: &'a OutputLock) -> Points<'a> {
    let policy = OverwritePolicy { resume: true, force: false };
    Points { sweep, source, session, lock, policy, replicas: None, seed: None, shard: None }
}

/// The files that a scene is made of: its own, and those that it takes values from.
pub(crate) fn inputs_of(path: &Path, scene: &Scene) -> Vec<PathBuf> {
    let files = SceneFiles::scene(path);
    std::iter::once(path.to_owned()).chain(scene.inputs.iter().map(|input| files.path(&input.path))).collect()
}
