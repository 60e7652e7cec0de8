//! Creates worlds from texts: the built-in worlds of the simulator, a user's TOML, and ROS maps.

use crate::ros_map::Header;
use crate::world::World;
use crate::world_error::WorldError;
use crate::world_file;

/// Names and texts of the built-in worlds. The first is the office floor of the tour in the paper, including the box in
/// the hallway.
const WORLDS: [(&str, &str); 4] = [
    ("office", include_str!("../worlds/office.toml")),
    ("maze", include_str!("../worlds/maze.toml")),
    ("hall", include_str!("../worlds/hall.toml")),
    ("room", include_str!("../worlds/room.toml")),
];

impl World {
    /// Returns the world that a TOML text describes; `file` is the name of the file in error messages.
    ///
    /// # Errors
    /// Returns the first error in the text, with its position.
    pub fn parse(file: &str, text: &str) -> Result<Self, WorldError> {
        world_file::parse(file, text)
    }

    /// Returns the world of a ROS map, from the text of its YAML file and the bytes of its image; `file` and `image`
    /// are their names in error messages.
    ///
    /// # Errors
    /// Returns the first error in either file, with its position.
    pub fn of_map((file, text): (&str, &str), (image, bytes): (&str, &[u8])) -> Result<Self, WorldError> {
        Header::parse(file, text)?.world(image, bytes)
    }

    /// Returns the office floor of the tour in the paper.
    ///
    /// # Errors
    /// Does not fail, as a test confirms. The text of the world has the same format as the file of a user.
    pub fn office() -> Result<Self, WorldError> {
        let [(_, office), ..] = WORLDS;
        Self::parse("the office floor", office)
    }

    /// Returns the built-in world `name`; `None` if there is no such world.
    #[must_use]
    pub fn named(name: &str) -> Option<Result<Self, WorldError>> {
        let (name, text) = WORLDS.iter().find(|(known, _)| *known == name)?;
        Some(Self::parse(name, text))
    }

    /// Returns the names of the built-in worlds.
    pub fn names() -> impl Iterator<Item = &'static str> {
        WORLDS.iter().map(|(name, _)| *name)
    }
}
