//! Creates worlds from texts: the worlds that come with the simulator, a user's TOML, and ROS maps.

use crate::ros_map::Header;
use crate::world::World;
use crate::world_error::WorldError;
use crate::world_file;

/// The names and texts of the worlds that come with the simulator. The first is the floor of the paper's tour,
/// including the box in the hallway.
const WORLDS: [(&str, &str); 4] = [
    ("office", include_str!("../worlds/office.toml")),
    ("maze", include_str!("../worlds/maze.toml")),
    ("hall", include_str!("../worlds/hall.toml")),
    ("room", include_str!("../worlds/room.toml")),
];

impl World {
    /// Returns the world of a TOML text; `file` is the name of the file in error messages.
    ///
    /// # Errors
    /// Fails with the error of the text, and its place.
    pub fn parse(file: &str, text: &str) -> Result<Self, WorldError> {
        world_file::parse(file, text)
    }

    /// Returns the world of a ROS map, from the text of its YAML file and the bytes of its image; `file` and `image`
    /// are their names in error messages.
    ///
    /// # Errors
    /// Fails with the defect of either file, and its place.
    pub fn of_map((file, text): (&str, &str), (image, bytes): (&str, &[u8])) -> Result<Self, WorldError> {
        Header::parse(file, text)?.world(image, bytes)
    }

    /// Returns the office floor of the paper's tour.
    ///
    /// # Errors
    /// Never fails, as a test reads the world. Its file has the same format as a user's file.
    pub fn office() -> Result<Self, WorldError> {
        let [(_, office), ..] = WORLDS;
        Self::parse("the office floor", office)
    }

    /// Returns the world `name` that comes with the simulator; `None` if there is no such world.
    #[must_use]
    pub fn named(name: &str) -> Option<Result<Self, WorldError>> {
        let (name, text) = WORLDS.iter().find(|(known, _)| *known == name)?;
        Some(Self::parse(name, text))
    }

    /// Returns the names of the worlds that come with the simulator.
    pub fn names() -> impl Iterator<Item = &'static str> {
        WORLDS.iter().map(|(name, _)| *name)
    }
}
