//! Writes an evidence grid as a map of ROS: a YAML file, and a grey image beside it in which black is occupied.

use std::io::Write as _;
use std::path::Path;

use crate::evidence::{CELL, HALF, SavedMap, image, pixels, png_pixels};
use crate::failure::Failure;
use crate::log::{created, exists, unwritten};

/// Saves a map as the YAML file at a path, with its image beside it, and the image as the PNG `picture`, if it is
/// given.
///
/// # Errors
/// Fails if the name of the file does not end in `.yaml` or `.yml`, or if a file exists already or cannot be written.
pub(super) fn save(map: &SavedMap, file: &Path, picture: Option<&Path>) -> Result<(), Failure> {
    let image = image(file)?;
    // None is written if another is in the way.
    if let Some(other) = [Some(file), Some(&*image), picture].into_iter().flatten().find(|path| path.exists()) {
        return Err(exists(other));
    }
    let name = image.file_name().unwrap_or_default().display();
    let text = format!(
        "image: {name}\nresolution: {CELL}\norigin: [{}, {}, 0.0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.35\n{}",
        -HALF,
        -HALF,
        map.line()
    );
    write(file, text.as_bytes())?;
    write(&image, &pixels(&map.grid))?;
    picture.map_or(Ok(()), |picture| write(picture, &png_pixels(&map.grid)))
}

fn write(file: &Path, bytes: &[u8]) -> Result<(), Failure> {
    created(file)?.write_all(bytes).map_err(|error| unwritten(&file.display(), &error))
}
