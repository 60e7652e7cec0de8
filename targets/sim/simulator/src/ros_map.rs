//! Creates worlds from ROS maps as `map_server` saves them: a YAML file with a few keys, and an image.
//!
//! Pixels darker than the threshold are occupied. Walls are where occupied pixels border on other pixels. The pixel
//! steps of a slanted wall are smoothed, because a sonar would otherwise receive no echo of the wall. Unknown pixels
//! are floor. The robot starts at the origin of the map's frame, at which the robot that made the map began.

mod contours;
mod header;
mod image;
#[cfg(test)]
mod tests;

use mdle_runtime::Pose;

use crate::outline::Outline;
use crate::point::Point;
use crate::world::World;
use crate::world_error::WorldError;
use contours::contours;
pub use header::Header;
use image::Image;

impl Header {
    /// Creates the world that this header and an image describe. `bytes` contains the image file; `file` is its name in
    /// error messages.
    ///
    /// # Errors
    /// Fails if the image is not readable or has too many walls.
    pub fn world(&self, file: &str, bytes: &[u8]) -> Result<World, WorldError> {
        let image = Image::read(bytes).map_err(|what| WorldError::new(file, None, what))?;
        let (sin, cos) = libm::sincos(self.yaw);
        // Image rows count from the top, the map's second axis from the bottom.
        let place = |(column, row): (i32, i32)| {
            let (x, y) =
                (f64::from(column) * self.resolution, (image.height as f64 - f64::from(row)) * self.resolution);
            Point { x: self.x + x * cos - y * sin, y: self.y + x * sin + y * cos }
        };
        let dark = image.darker(self.occupied, self.negate);
        let stands = |column, row| dark.get(row * image.width + column).copied().unwrap_or(false);
        let loops = contours(image.width, image.height, stands).map_err(|what| WorldError::new(file, None, what))?;
        let outlines: Vec<_> = (1..)
            .zip(loops)
            .map(|(number, corners): (usize, Vec<_>)| Outline {
                name: format!("contour {number}"),
                points: corners.into_iter().map(place).collect(),
                solid: false,
                rough: 0.0,
            })
            .collect();
        let world = World {
            contours: outlines.len(),
            outlines,
            things: Vec::new(),
            start: Pose::ORIGIN,
            start_at: None,
            goal: None,
            charger: None,
            sounds: Vec::new(),
            t60: 0.0,
            rough: 0.0,
        };
        world.check_size().map_err(|what| WorldError::new(file, None, what))?;
        Ok(world)
    }
}
