//! The map of a landmark in the form in which `mdle map` saves it: a YAML file, and the image of the grid in the same
//! folder.

use std::path::Path;

use mdle_runtime::Pose;
use mdle_sim::Start;

use super::grid::EvidenceGrid;
use super::matching::Fit;
use super::ros_image;
use crate::failure::Failure;

/// Maximum size of a file, in bytes.
const LARGEST: u64 = 1_000_000;
/// Default pose, in map coordinates, in metres and degrees. A robot is at this pose when it begins to make the map;
/// later, the search for a robot begins near this pose.
pub(crate) const USUAL_POSE: &str = "-0.75,0,0";
/// Key of the minimum score in the YAML file.
const KEY: &str = "least_score";
/// Default minimum score, for maps whose files do not contain the key.
const USUAL: f64 = 1.7;
/// Minimum score of a map, as a fraction of the score of the map's own echoes.
const FRACTION: f64 = 0.7;

/// Reads the pose that is the value of an option.
pub(crate) fn pose(option: &str, text: &str) -> Result<Pose, Failure> {
    let read: Result<Start, _> = text.parse();
    read.map(|Start(pose)| pose).map_err(|error| Failure::Usage(format!("{option} {text}: {error}")))
}

/// The map of a landmark.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct SavedMap {
    pub(crate) grid: EvidenceGrid,
    /// Minimum score for a robot that is at the landmark.
    pub(crate) least: f64,
}

impl SavedMap {
    /// Creates the map of a grid; `own_score` is the score of the echoes from which the grid was made.
    pub(crate) fn of(grid: EvidenceGrid, own_score: Option<f64>) -> Self {
        let least = own_score.map_or(USUAL, |score| libm::round(score * FRACTION * 100.0) / 100.0);
        Self { grid, least: least.max(0.01) }
    }

    /// Reads the map in a YAML file.
    ///
    /// # Errors
    /// Fails if the name does not end in `.yaml` or `.yml`, if the file or the image beside it cannot be read, or if
    /// the image is not the image of a landmark's map.
    pub(crate) fn read(file: &Path) -> Result<Self, Failure> {
        let image = ros_image::image(file)?;
        let unread = |of: &Path, why: &dyn std::fmt::Display| {
            let whose = if of == file { String::new() } else { format!(", the image of {}", file.display()) };
            Failure::Usage(format!("the map {}{whose} cannot be read: {why}", of.display()))
        };
        let yaml = mdle_host::read_file(file, LARGEST).map_err(|error| unread(file, &error))?;
        let least = least(&String::from_utf8_lossy(&yaml)).map_err(|sentence| unread(file, &sentence))?;
        let bytes = mdle_host::read_file(&image, LARGEST).map_err(|error| unread(&image, &error))?;
        let grid = ros_image::grid(&bytes).ok_or_else(|| {
            let help = "`mdle map RECORD MAP.yaml` makes one";
            Failure::Usage(format!("{} is no map of a landmark\nhelp: {help}", image.display()))
        })?;
        Ok(Self { grid, least })
    }

    /// Returns the line of the YAML file that contains the minimum score.
    pub(crate) fn line(&self) -> String {
        format!("{KEY}: {}\n", self.least)
    }

    /// Returns the reason why a robot with this fit is not at the landmark; `None` if it is at the landmark.
    pub(crate) fn objection(&self, fit: &Fit) -> Option<String> {
        if fit.is_at_edge {
            return Some("the best pose is at the edge of the search".to_owned());
        }
        let (score, least) = (fit.score, self.least);
        (score < least).then(|| format!("the score {score:.2} is less than {least:.2}"))
    }
}

/// Reads the minimum score from the text of a YAML file.
fn least(yaml: &str) -> Result<f64, String> {
    let value = yaml.lines().find_map(|line| line.strip_prefix(KEY)?.strip_prefix(':'));
    let Some(value) = value.map(str::trim) else { return Ok(USUAL) };
    let number = value.parse().ok().filter(|least: &f64| least.is_finite() && *least > 0.0);
    number.ok_or_else(|| format!("`{KEY}: {value}` is no number above 0"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_map_has_a_least_score() {
        assert_eq!(least("image: a.pgm\nleast_score: 2.5\n"), Ok(2.5));
        assert_eq!(least("image: a.pgm\n"), Ok(USUAL));
        for value in ["0", "-1", "inf", "NaN", "much", ""] {
            assert_eq!(
                least(&format!("least_score: {value}\n")),
                Err(format!("`least_score: {value}` is no number above 0"))
            );
        }
    }
}
