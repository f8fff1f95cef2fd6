//! A file of a scene: one scene, or a sweep of them.

use super::definition::Scene;
use super::error::SceneError;
use super::files::{Files, NoFiles};
use super::parse::read;
use super::reader::{Section, document};
use super::sweep::Sweep;
use super::table::KEYS;
use std::sync::Arc;

impl Scene {
    /// Reads a scene that takes nothing out of files; of a sweep that of its first point.
    ///
    /// # Errors
    /// [`SceneError`] with the line, the key, what was given and what would do.
    pub fn parse(text: &str) -> Result<Self, SceneError> {
        let document = document(text)?;
        let root = Section::root(text, document.get_ref(), &KEYS);
        let files: Arc<dyn Files> = Arc::new(NoFiles);
        match root.get("sweep") {
            Some(sweep) => Sweep::read(text, &sweep, files).and_then(|sweep| sweep.scene(0)),
            None => read(text, &root, &files),
        }
        .map_err(SceneError::shortened)
    }
}

/// A file of a scene: one scene, or a sweep of them.
///
/// # Examples
/// ```
/// use stiction::scene::{Document, Sweep};
///
/// let Document { scene, sweep } = Document::from_toml_file("configs/sweep_roughness.toml")?;
/// let sweep: Sweep = sweep.expect("it has a table [sweep]");
/// let first = sweep.scene(0).expect("all points have been read");
/// assert_eq!(first.asperity, scene.asperity);
/// # Ok::<(), stiction::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Document {
    /// The scene; of a sweep that of its first point.
    pub scene: Scene,
    /// The sweep.
    pub sweep: Option<Sweep>,
}

impl Document {
    /// Reads a scene or a sweep, all of whose points have to be scenes, and what they take out of files.
    ///
    /// # Errors
    /// [`SceneError`] with the line, the key, what was given and what would do, and the point if it is a
    /// point of a sweep.
    pub fn parse(text: &str, files: Arc<dyn Files>) -> Result<Self, SceneError> {
        let document = document(text)?;
        let root = Section::root(text, document.get_ref(), &KEYS);
        let read = match root.get("sweep") {
            None => read(text, &root, &files).map(|scene| Self { scene, sweep: None }),
            Some(sweep) => Sweep::read(text, &sweep, files).and_then(Self::swept),
        };
        read.map_err(SceneError::shortened)
    }

    /// A sweep and the scene of its first point.
    fn swept(sweep: Sweep) -> Result<Self, SceneError> {
        let scene = sweep.scene(0)?;
        (1..sweep.count()).try_for_each(|point| sweep.scene(point).map(drop))?;
        Ok(Self { scene, sweep: Some(sweep) })
    }
}
