//! The files that a run reads: either files on the disk, or copies inside an executable.

use std::cell::{OnceCell, RefCell};
use std::collections::BTreeMap;
use std::io;
use std::path::{Path, PathBuf};

use mdle_compiler::diagnostic::Diagnostic;
use mdle_files::{Input, InputError, Settings, Target, Unsaved, plan, read_plan, without_mark};
use mdle_host::read_file;

use crate::failure;

/// The files of a scenario or of a plan, by the names that the scenario and its plans use for them.
pub(crate) struct InputFiles {
    /// Path of the scenario's or the plan's own file.
    pub(crate) path: PathBuf,
    /// Contents of the files that have been read so far; inside an executable, contents of all files.
    contents: RefCell<BTreeMap<PathBuf, Vec<u8>>>,
    /// Texts of the files inside an executable, for the plans that use them.
    texts: OnceCell<Unsaved>,
    /// `true` if the files are copies inside an executable. In this case, no other file is read.
    are_inside: bool,
}

impl InputFiles {
    /// Creates the files of the scenario or the plan at `path`, for files on the disk.
    pub(crate) fn of_system(path: &Path) -> Self {
        Self { path: path.to_owned(), contents: RefCell::default(), texts: OnceCell::new(), are_inside: false }
    }

    /// Creates the files of a scenario or a plan from copies; `path` is the name of its own file.
    pub(crate) fn inside(path: &Path, contents: BTreeMap<PathBuf, Vec<u8>>) -> Self {
        Self { path: path.to_owned(), contents: RefCell::new(contents), texts: OnceCell::new(), are_inside: true }
    }

    /// Creates the files of a scenario or a plan from the copies in an executable, its own file first.
    pub(crate) fn embedded(files: &[(&str, &[u8])]) -> Self {
        let own = files.first().map_or("", |(path, _)| *path);
        Self::inside(Path::new(own), files.iter().map(|(file, bytes)| (PathBuf::from(file), bytes.to_vec())).collect())
    }

    /// Returns the contents of all files that have been read.
    pub(crate) fn into_contents(self) -> BTreeMap<PathBuf, Vec<u8>> {
        self.contents.into_inner()
    }

    /// Returns the path of a file that the scenario names.
    pub(crate) fn named(&self, name: impl AsRef<Path>) -> PathBuf {
        self.path.with_file_name("").join(name)
    }

    /// Returns `true` if there is a file at `path`.
    pub(crate) fn exists(&self, path: &Path) -> bool {
        if self.are_inside { self.contents.borrow().contains_key(path) } else { path.exists() }
    }

    /// Returns the contents of a file of at most `most` bytes.
    ///
    /// # Errors
    /// Fails if the file cannot be read.
    pub(crate) fn read(&self, path: &Path, most: u64) -> io::Result<Vec<u8>> {
        if self.are_inside {
            return self.contents.borrow().get(path).cloned().ok_or_else(|| io::ErrorKind::NotFound.into());
        }
        let bytes = read_file(path, most)?;
        self.contents.borrow_mut().insert(path.to_owned(), bytes.clone());
        Ok(bytes)
    }

    /// Returns the text of a file of at most `most` bytes.
    ///
    /// # Errors
    /// Fails if the file cannot be read, or is not UTF-8 text.
    pub(crate) fn text(&self, path: &Path, most: u64) -> io::Result<String> {
        String::from_utf8(self.read(path, most)?).map_err(|_| io::Error::other("it is not UTF-8 text"))
    }

    /// Returns the settings for a plan in the file at `path`; empty for a plan inside an executable, which has none.
    ///
    /// # Errors
    /// Fails if the `mdle.toml` beside the plan has errors.
    pub(crate) fn settings(&self, path: &Path) -> Result<Settings, InputError> {
        if self.are_inside { Ok(Settings::default()) } else { Settings::beside(path) }
    }

    /// Returns the plan in the file at `path`. After compiling it, the caller passes the result to
    /// [`InputFiles::compiled`].
    ///
    /// # Errors
    /// Fails if the file cannot be read or is not text.
    pub(crate) fn plan(&self, path: &Path, target: &Target) -> Result<Input, InputError> {
        if !self.are_inside {
            return read_plan(path, target);
        }
        let contents = self.contents.borrow();
        let text = |bytes: &[u8]| String::from_utf8_lossy(&without_mark(bytes.to_vec())).into_owned();
        let own = contents.get(path).map(|own| text(own)).ok_or_else(|| no_file(path))?;
        let all = || Unsaved::all(contents.iter().map(|(path, bytes)| (path.clone(), text(bytes))));
        Ok(plan(path, own, target)?.with_unsaved(self.texts.get_or_init(all).clone()))
    }

    /// Stores the files of a plan that has been compiled, and prints its diagnostics. Does nothing for a plan inside an
    /// executable, because both steps were done when the executable was built.
    pub(crate) fn compiled(&self, input: &Input, diagnostics: &[Diagnostic]) {
        if !self.are_inside {
            let files = input.files().map(Path::to_owned).zip(input.texts().map(|text| text.as_bytes().to_vec()));
            self.contents.borrow_mut().extend(files);
            failure::print(&input.sources, diagnostics);
        }
    }
}

/// Returns files, each with its contents, under names that the source code of an executable can contain.
///
/// # Errors
/// Fails with a sentence if the path of a file is not UTF-8.
pub fn embeddable(files: impl IntoIterator<Item = (PathBuf, Vec<u8>)>) -> Result<Vec<(String, Vec<u8>)>, String> {
    let named = |(file, bytes): (PathBuf, Vec<u8>)| match file.into_os_string().into_string() {
        Ok(name) => Ok((name, bytes)),
        Err(file) => {
            let sentence = "is no UTF-8 text, and an executable has its files by their names";
            Err(format!("the path {} {sentence}\nhelp: rename it", file.display()))
        }
    };
    files.into_iter().map(named).collect()
}

fn no_file(path: &Path) -> InputError {
    InputError::Unusable(format!("there is no file `{}`", path.display()))
}
