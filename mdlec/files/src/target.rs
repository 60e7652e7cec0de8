//! Reads the robot for which plans are written: its alphabet, and the shared alphabets that the alphabet uses.

use std::path::{Path, PathBuf};

use mdle_compiler::alphabet::Alphabet;
use mdle_compiler::builtin::{self, ReadAlphabet};
use mdle_compiler::diagnostic::Sources;
use mdle_compiler::rust;

use crate::read::LARGEST_PLAN;
use crate::text::read_text;
use crate::{FaultyFile, InputError, read};

/// The robot for which plans are checked.
#[derive(Debug)]
pub struct Target {
    /// Alphabet of the robot.
    pub alphabet: Alphabet,
    /// Folder of a third-party target; `None` for a target that is part of mdlec.
    pub folder: Option<PathBuf>,
    /// Path of the `mdle.toml` beside the plan; `None` if there is none.
    pub settings: Option<PathBuf>,
    /// Files from which the alphabet was read, so that messages can show them.
    pub(crate) sources: Vec<(String, String)>,
}

impl Target {
    /// Returns the texts of the alphabet's files: the shared alphabets, then the target's own.
    pub fn texts(&self) -> impl Iterator<Item = &str> {
        self.sources.iter().map(|(_, text)| text.as_str())
    }

    /// Returns the alphabet's files, and no others, as the sources of messages.
    #[must_use]
    pub fn sources(&self) -> Sources {
        let mut sources = Sources::default();
        for (name, text) in &self.sources {
            sources.add(name, text);
        }
        sources
    }

    /// Returns the paths of the files that were read for the target.
    pub fn files(&self) -> impl Iterator<Item = PathBuf> {
        let own =
            self.folder.iter().flat_map(|folder| ["alphabet.mdle", "src/alphabet.rs"].map(|file| folder.join(file)));
        own.chain(self.settings.clone())
    }

    /// Checks that the crate of a third-party target contains the Rust file for the target's current alphabet. Without
    /// this file, no plan can be built for the target.
    ///
    /// # Errors
    /// Fails if the generated file `src/alphabet.rs` is missing or out of date.
    pub fn must_be_bound(&self) -> Result<(), InputError> {
        let Some(folder) = &self.folder else { return Ok(()) };
        let file = folder.join("alphabet.mdle");
        // The bindings always include the engine, even for a plan that does not use it.
        let mut alphabet = self.alphabet.clone();
        alphabet.has_engine = true;
        let is_up_to_date =
            read::file(&bound(&file), LARGEST_PLAN).is_ok_and(|found| found == rust::bind(&alphabet).as_bytes());
        if is_up_to_date { Ok(()) } else { Err(InputError::Unusable(out_of_date(&file))) }
    }
}

/// Returns the path of the Rust file that `mdlec bind` generates from the alphabet in `file`.
#[must_use]
pub fn bound(file: &Path) -> PathBuf {
    file.with_file_name("src").join("alphabet.rs")
}

/// Returns the error message for the alphabet in `file`, whose Rust file is missing or out of date.
#[must_use]
pub fn out_of_date(file: &Path) -> String {
    let (rust, file) = (bound(file), file.display());
    let bound = rust.display();
    if !rust.is_file() {
        return format!("there is no `{bound}`\nhelp: `mdlec bind {file}` writes it");
    }
    format!("`{bound}` differs from the bindings of `{file}`\nhelp: `mdlec bind {file}` writes it again")
}

/// Reads the target that `option` names: a target that is part of mdlec, or the folder of a third-party target. If
/// `option` is `None`, returns a robot with every capability.
///
/// # Errors
/// Fails if there is no such target, or if its alphabet cannot be read or has errors.
pub fn target(option: Option<&str>) -> Result<Target, InputError> {
    let Some(name) = option else { return read_alphabets(None, "") };
    if let Some(builtin) = builtin::alphabets().iter().find(|alphabet| alphabet.target && alphabet.name == name) {
        return read_alphabets(Some((builtin.file.to_owned(), builtin.text.to_owned())), name);
    }
    let folder = Path::new(name);
    if !folder.is_dir() {
        return Err(InputError::UnknownTarget(name.to_owned()));
    }
    let file = folder.join("alphabet.mdle");
    let text = read_text(&file, LARGEST_PLAN)?;
    let mut target = read_alphabets(Some((file.display().to_string(), text)), name)?;
    target.folder = Some(folder.to_owned());
    Ok(target)
}

/// Reads the alphabet in this file, with the shared alphabets that it uses.
///
/// # Errors
/// Fails if the file cannot be read or has errors.
pub fn alphabet(file: &Path) -> Result<Alphabet, InputError> {
    let name = file.display().to_string();
    let text = read_text(file, LARGEST_PLAN)?;
    read_alphabets(Some((name.clone(), text)), &name).map(|target| target.alphabet)
}

fn read_alphabets(own: Option<(String, String)>, name: &str) -> Result<Target, InputError> {
    match builtin::read(own) {
        Ok(ReadAlphabet { alphabet, files }) => Ok(Target { alphabet, folder: None, settings: None, sources: files }),
        Err((sources, diagnostics)) => {
            Err(InputError::Faulty(FaultyFile { sources, diagnostics, target: Some(name.to_owned()) }))
        }
    }
}
