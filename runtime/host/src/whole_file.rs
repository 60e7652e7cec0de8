//! A file that an option names. If the file cannot be written, the run is refused. The file is written completely or
//! not at all.

use std::ffi::OsString;
use std::fs::{self, File};
use std::io::{self, BufWriter, ErrorKind, Write};
use std::path::{Path, PathBuf};

/// A file that is written completely or not at all.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct WholeFile {
    path: PathBuf,
    /// Path of the unfinished file. It is in the same folder as the file, so that a rename puts the complete file in
    /// place in one step.
    unfinished: PathBuf,
}

impl WholeFile {
    /// Returns the file at `path`, which the option `option` names, after checking that it can probably be written. The
    /// check leaves no file behind.
    ///
    /// # Errors
    /// Returns a message for the user if the file cannot be written.
    pub fn at(option: &str, path: &Path) -> Result<Self, String> {
        let shown = path.display();
        if path.as_os_str().as_encoded_bytes().ends_with(b"/") {
            return Err(format!("--{option} {shown}: that is a folder; name a file in it"));
        }
        // Resolves a symbolic link, because the rename would replace the link.
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
        // `create_new` never follows a link that another user has put there.
        let tried = File::create_new(&unfinished).and_then(|_| fs::remove_file(&unfinished));
        tried.map_err(|error| {
            if error.kind() == ErrorKind::NotFound {
                format!("--{option} {shown}: the folder does not exist; make it first")
            } else {
                format!("--{option} {shown}: nothing can be written there: {error}")
            }
        })?;
        Ok(Self { path, unfinished })
    }

    /// Writes the file; error messages call it `what`.
    ///
    /// # Errors
    /// Returns a message for the user if the file cannot be written.
    pub fn write(&self, what: &str, text: &str) -> Result<(), String> {
        let mut unfinished = Unfinished::new(self.clone());
        unfinished.write(text);
        unfinished.finish(what)
    }
}

/// A file that is being written in parts.
#[derive(Debug)]
pub struct Unfinished<W: Write = BufWriter<File>> {
    file: WholeFile,
    /// Writer of the file, or the first error. After an error, nothing is written; `finish` reports the error.
    written: io::Result<W>,
    is_finished: bool,
}

impl Unfinished {
    /// Begins writing the file.
    #[must_use]
    pub fn new(file: WholeFile) -> Self {
        Self::through(file, |file| Ok(BufWriter::new(file)))
    }
}

impl<W: Write> Unfinished<W> {
    /// Begins writing the file through the writer that `writer` returns.
    pub(crate) fn through(file: WholeFile, writer: impl FnOnce(File) -> io::Result<W>) -> Self {
        let opened = File::create_new(&file.unfinished);
        // An existing file does not belong to this program, and is not removed.
        let is_finished = opened.is_err();
        Self { file, written: opened.and_then(writer), is_finished }
    }

    /// Appends `text` to the file.
    pub fn write(&mut self, text: &str) {
        if let Ok(file) = &mut self.written
            && let Err(error) = file.write_all(text.as_bytes())
        {
            self.written = Err(error);
        }
    }

    /// Completes the file and moves it to its path; error messages call it `what`.
    ///
    /// # Errors
    /// Returns a message for the user if the file cannot be written.
    pub fn finish(mut self, what: &str) -> Result<(), String> {
        let written = std::mem::replace(&mut self.written, Err(ErrorKind::Other.into()));
        let put = written.and_then(|mut file| file.flush());
        let put = put.and_then(|()| fs::rename(&self.file.unfinished, &self.file.path));
        self.is_finished |= put.is_ok();
        put.map_err(|error| format!("the {what} {} cannot be written: {error}", self.file.path.display()))
    }
}

impl<W: Write> Drop for Unfinished<W> {
    fn drop(&mut self) {
        if !self.is_finished {
            // Removes the unfinished file. An error of the removal is ignored, because the first error is the one to
            // report.
            let _ = fs::remove_file(&self.file.unfinished);
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test fails by panicking")]
mod tests {
    use super::*;

    #[test]
    fn a_link_in_the_place_of_the_unfinished_file_is_not_followed() {
        let folder = std::env::temp_dir().join(format!("mdle-whole-file-{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        let (victim, path) = (folder.join("victim"), folder.join("plot.svg"));
        fs::write(&victim, "precious").unwrap();
        let file = WholeFile::at("plot", &path).unwrap();
        std::os::unix::fs::symlink(&victim, &file.unfinished).unwrap();
        let written = file.write("plot", "a picture");
        assert!(written.unwrap_err().ends_with("cannot be written: File exists (os error 17)"));
        assert!(WholeFile::at("plot", &path).is_err());
        assert_eq!(fs::read_to_string(&victim).unwrap(), "precious");
        fs::remove_file(&file.unfinished).unwrap();
        file.write("plot", "a picture").unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), "a picture");
        assert!(
            WholeFile::at("plot", &folder.join("new/")).unwrap_err().ends_with("that is a folder; name a file in it")
        );
        fs::remove_dir_all(&folder).unwrap();
    }
}
