//! The files of a map: a YAML file in the format of ROS; a greyscale image in the same folder, in which black means
//! occupied; and a PNG.

use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};

use super::grid::{CELL, HALF};
use super::ros_image::{image, pixels, png_pixels};
use super::saved_map::SavedMap;
use crate::failure::{Failure, exists, unwritten};

/// Names of the new files of a map.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct MapFiles {
    yaml: PathBuf,
    image: PathBuf,
    /// PNG file of the image; `None` if it is not requested.
    picture: Option<PathBuf>,
}

impl MapFiles {
    /// Creates the names of a map's files: the YAML file `yaml`, the image in the same folder and, if given, the PNG
    /// `picture`.
    ///
    /// # Errors
    /// Fails if the name of the file does not end in `.yaml` or `.yml`, if one of the files exists already, or if a
    /// file cannot be created.
    pub(crate) fn new(yaml: &Path, picture: Option<&Path>) -> Result<Self, Failure> {
        let files = Self { yaml: yaml.to_owned(), image: image(yaml)?, picture: picture.map(Path::to_owned) };
        // No file is written if one of them exists already.
        if let Some(other) = files.all().find(|path| path.exists()) {
            return Err(exists(other));
        }
        for path in files.all() {
            let unfinished = unfinished(path);
            let tried = File::create_new(&unfinished).and_then(|_| fs::remove_file(&unfinished));
            tried.map_err(|error| unwritten(&path.display(), &error))?;
        }
        Ok(files)
    }

    fn all(&self) -> impl Iterator<Item = &Path> {
        [Some(&self.yaml), Some(&self.image), self.picture.as_ref()].into_iter().flatten().map(PathBuf::as_path)
    }

    /// Saves a map, and replaces an earlier version of it. Each file is written completely or not at all.
    ///
    /// # Errors
    /// Fails with a message if a file cannot be written.
    pub(crate) fn save(&self, map: &SavedMap) -> Result<(), String> {
        let name = self.image.file_name().unwrap_or_default().display();
        let text = format!(
            "image: {name}\nresolution: {CELL}\norigin: [{}, {}, 0.0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.35\n{}",
            -HALF,
            -HALF,
            map.line()
        );
        write(&self.image, &pixels(&map.grid))?;
        write(&self.yaml, text.as_bytes())?;
        let Some(picture) = &self.picture else { return Ok(()) };
        let pixels = png_pixels(&map.grid);
        let pixels = pixels.map_err(|error| format!("{} cannot be written: {error}", picture.display()))?;
        write(picture, &pixels)
    }
}

/// Returns the temporary name of a file that is being written.
fn unfinished(file: &Path) -> PathBuf {
    let mut name = file.file_name().unwrap_or_default().to_owned();
    name.push(format!(".{}.tmp", std::process::id()));
    file.with_file_name(name)
}

fn write(file: &Path, bytes: &[u8]) -> Result<(), String> {
    let unfinished = unfinished(file);
    let written = fs::write(&unfinished, bytes).and_then(|()| fs::rename(&unfinished, file));
    written.map_err(|error: io::Error| {
        // Best effort: the first error is the one to report.
        let _ = fs::remove_file(&unfinished);
        format!("{} cannot be written: {error}", file.display())
    })
}
