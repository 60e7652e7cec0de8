//! Converts an evidence grid to the greyscale image of a ROS map, in which black means occupied.

use std::path::{Path, PathBuf};

use png::{BitDepth, ColorType, Encoder, EncodingError};

use super::grid::{CELLS, EvidenceGrid};
use crate::failure::Failure;

/// Grey value of a free cell.
const WHITE: f64 = 255.0;

/// Returns the image as the bytes of a PGM file. The first row of the image has the greatest y coordinate.
pub(super) fn pixels(grid: &EvidenceGrid) -> Vec<u8> {
    let mut bytes = head().into_bytes();
    bytes.extend(greys(grid));
    bytes
}

/// Returns the image as the bytes of a PNG file.
///
/// # Errors
/// Fails if the image cannot be encoded.
pub(super) fn png_pixels(grid: &EvidenceGrid) -> Result<Vec<u8>, EncodingError> {
    let mut file = Vec::new();
    let mut encoder = Encoder::new(&mut file, CELLS as u32, CELLS as u32);
    encoder.set_color(ColorType::Grayscale);
    encoder.set_depth(BitDepth::Eight);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&greys(grid))?;
    writer.finish()?;
    Ok(file)
}

/// Returns the grey values of the cells, row by row. The first row is the one with the greatest y coordinate.
fn greys(grid: &EvidenceGrid) -> Vec<u8> {
    let cells = (0..CELLS).rev().flat_map(|row| (0..CELLS).map(move |column| (column, row)));
    cells.map(|(column, row)| libm::round(WHITE * (1.0 - grid.probability(column, row))) as u8).collect()
}

/// Returns the path of the image that belongs to the YAML file of a map.
///
/// # Errors
/// Fails if the name does not end in `.yaml` or `.yml`.
pub(super) fn image(file: &Path) -> Result<PathBuf, Failure> {
    if file.extension().is_some_and(|extension| extension == "yaml" || extension == "yml") {
        return Ok(file.with_extension("pgm"));
    }
    let help = format!("name it {}", file.with_extension("yaml").display());
    Err(Failure::Usage(format!("{} is no name of a map: it has to end in .yaml\nhelp: {help}", file.display())))
}

/// Returns the grid of an image; `None` if the bytes are not an image of a landmark's map.
pub(super) fn grid(bytes: &[u8]) -> Option<EvidenceGrid> {
    let greys = bytes.strip_prefix(head().as_bytes()).filter(|greys| greys.len() == CELLS * CELLS)?;
    let rows = greys.chunks_exact(CELLS).rev().flatten();
    Some(EvidenceGrid::of(rows.map(|grey| 1.0 - f64::from(*grey) / WHITE)))
}

fn head() -> String {
    format!("P5\n{CELLS} {CELLS}\n{WHITE}\n")
}
