//! The scene of a command: a file or standard input, with the settings that the command line has for it.

use super::failure::Failure;
use crate::error::Error;
use crate::input::columns::SceneFiles;
use crate::input::scene_file::{LONGEST_SCENE, read_text, text_of};
use crate::output::sweep::inputs_of;
use crate::scene::settings::{Setting, located, with_settings};
use crate::scene::{Document, Scene, SceneError};
use clap::Args;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The name of standard input on the command line.
const STANDARD_INPUT: &str = "-";

#[derive(Args)]
pub(super) struct SceneArguments {
    /// The scene, TOML; - for standard input, files that it names are then in the current folder
    pub scene: PathBuf,
    /// Set a key of the scene: a dotted name, as in TOML, and a value; a text needs no quotation marks of its
    /// own; may be given several times
    #[arg(long = "set", value_name = "KEY=VALUE")]
    settings: Vec<Setting>,
}

impl SceneArguments {
    /// The place of the scene, as messages name it and files in it are looked for.
    pub fn path(&self) -> &Path {
        if is_standard_input(&self.scene) { Path::new("standard input") } else { &self.scene }
    }

    /// The scene or the sweep.
    pub fn document(&self) -> Result<Document, Failure> {
        self.document_with(Vec::new())
    }

    /// The scene or the sweep with further settings.
    pub fn document_with(&self, further: Vec<Setting>) -> Result<Document, Failure> {
        self.document_of(&self.text()?, &[&self.settings[..], &further].concat())
    }

    /// The sweep over laws, or over that of the scene alone where none is named.
    ///
    /// # Errors
    /// [`Failure`] also where the scene is a sweep itself.
    pub fn along_laws(&self, laws: &[String]) -> Result<Document, Failure> {
        let text = self.text()?;
        let Document { scene, sweep: None } = self.document_of(&text, &self.settings)? else {
            return Err(Error::IsSweep(self.path().to_owned()).into());
        };
        let own = [scene.model.name.to_owned()];
        let laws = if laws.is_empty() { &own[..] } else { laws };
        let laws: toml_edit::Array = laws.iter().collect();
        let setting = Setting::by("--laws", "sweep.model.law", laws);
        self.document_of(&text, &[&self.settings[..], &[setting]].concat())
    }

    fn text(&self) -> Result<String, Failure> {
        let unreadable = |problem| Error::Unreadable { path: self.path().to_owned(), problem };
        Ok(text(&self.scene, LONGEST_SCENE).map_err(unreadable)?)
    }

    fn document_of(&self, text: &str, settings: &[Setting]) -> Result<Document, Failure> {
        let path = self.path();
        let refused = |error: SceneError| Error::Scene { path: path.to_owned(), error };
        let edited = with_settings(text, settings).map_err(refused)?;
        let document = Document::parse(&edited, Arc::new(SceneFiles::scene(path)));
        Ok(document.map_err(|error| refused(located(error, text, &edited, settings)))?)
    }

    /// The output that is named, or else the scene's name with this ending, in the current folder.
    pub fn output(&self, named: Option<&Path>, ending: &str) -> Result<PathBuf, Failure> {
        match named {
            Some(output) => Ok(output.to_owned()),
            None if is_standard_input(&self.scene) => Err(Failure::Usage(
                "a scene from standard input has no name for its result; name one with -o".to_owned(),
            )),
            None => {
                let mut name = self.scene.file_stem().unwrap_or_default().to_owned();
                name.push(ending);
                Ok(name.into())
            }
        }
    }

    /// The files that the scene is made of.
    pub fn inputs(&self, scene: &Scene) -> Vec<PathBuf> {
        let mut inputs = inputs_of(self.path(), scene);
        if is_standard_input(&self.scene) {
            inputs.remove(0);
        }
        inputs
    }
}

fn is_standard_input(path: &Path) -> bool {
    path == Path::new(STANDARD_INPUT)
}

/// The text of a file, or of standard input for `-`, of at most `most` bytes.
pub(super) fn text(path: &Path, most: u64) -> Result<String, String> {
    if is_standard_input(path) { text_of(std::io::stdin().lock(), most) } else { read_text(path, most) }
}
