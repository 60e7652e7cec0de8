//! A file that an option names: refused before the run when it could not be written, and written whole or not at all.

use std::ffi::OsString;
use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// Where the file goes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct WholeFile {
    path: PathBuf,
    /// Beside it, so that a rename puts it in place at once.
    unfinished: PathBuf,
}

impl WholeFile {
    /// The file at `path`, as `option` names it, which can be written as far as can be told now. Leaves no file behind.
    pub(crate) fn at(option: &str, path: &Path) -> Result<Self, String> {
        let shown = path.display();
        // Through a link, or the rename would replace the link.
        let path = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
        match fs::metadata(&path) {
            Ok(found) if found.is_dir() => {
                return Err(format!("--{option} {shown}: that is a folder; name a file in it"));
            }
            Ok(found) if !found.is_file() => return Err(format!("--{option} {shown}: that is not a regular file")),
            Ok(found) if found.permissions().readonly() => {
                return Err(format!("--{option} {shown}: that file is read-only"));
            }
            Ok(_) | Err(_) => {}
        }
        let Some(name) = path.file_name() else {
            return Err(format!("--{option} {shown}: that is not the name of a file"));
        };
        let mut unfinished = OsString::from(".");
        unfinished.push(name);
        unfinished.push(format!(".{}.tmp", std::process::id()));
        let unfinished = path.with_file_name(unfinished);
        let tried = fs::File::create(&unfinished).and_then(|_| fs::remove_file(&unfinished));
        tried.map_err(|error| {
            if error.kind() == ErrorKind::NotFound {
                format!("--{option} {shown}: the folder does not exist; make it first")
            } else {
                format!("--{option} {shown}: nothing can be written there: {error}")
            }
        })?;
        Ok(Self { path, unfinished })
    }

    /// Writes the file; `what` it is goes into the sentence of an error.
    pub(crate) fn write(&self, what: &str, text: &str) -> Result<(), String> {
        let written = fs::write(&self.unfinished, text).and_then(|()| fs::rename(&self.unfinished, &self.path));
        written.map_err(|error| {
            // What could not be finished is not left lying about; if that fails too, the first error is the one to tell.
            let _ = fs::remove_file(&self.unfinished);
            format!("the {what} {} cannot be written: {error}", self.path.display())
        })
    }
}
