//! The file of landmarks beside a graph. It contains, for each landmark, the direction of its axes on the floor, its
//! position, and its map (docs/src/navigation.md).

use std::io;
use std::path::{Path, PathBuf};

use mdle_host::Quantity;
use mdle_runtime::{Meters, Pose, Radians};
use mdle_sim::Start;
use serde::Deserialize;
use toml::Spanned;

use crate::evidence::{SavedMap, USUAL_POSE};
use crate::failure::Failure;
use crate::route::{LandmarkMap, LandmarkPlace};

/// Maximum size of the file, in bytes.
const LARGEST: u64 = 1_000_000;

/// A file of landmarks, as written.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(super) struct Landmarks {
    #[serde(default)]
    landmark: Vec<Landmark>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct Landmark {
    name: Spanned<String>,
    /// Direction, on the floor, of the landmark's x axis.
    axis: Spanned<String>,
    /// Position on the floor of a robot that is at the landmark.
    place: Option<Spanned<String>>,
    /// File of the landmark's map, relative to the folder of this file; `None` if the landmark has no map.
    map: Option<PathBuf>,
    /// Pose, in map coordinates, of a robot that is at the landmark and whose heading is along the landmark's x axis;
    /// `None` for the default pose.
    at: Option<Spanned<String>>,
}

impl Landmarks {
    /// Reads the file. If `is_named` is `false`, the file may be missing; the result is then `None`.
    ///
    /// # Errors
    /// Fails with a message if the file cannot be read, has errors, or names a landmark that the graph does not
    /// contain.
    pub(super) fn read(file: &Path, is_named: bool, known: &[&str]) -> Result<Option<Self>, String> {
        let shown = file.display();
        let bytes = match mdle_host::read_file(file, LARGEST) {
            Ok(bytes) => bytes,
            Err(error) if !is_named && error.kind() == io::ErrorKind::NotFound => return Ok(None),
            Err(error) => return Err(format!("the landmarks in {shown} cannot be read: {error}")),
        };
        let text = String::from_utf8(bytes).map_err(|_| format!("{shown} is not UTF-8 text"))?;
        let landmarks = Self::parse(&text, known);
        landmarks.map(Some).map_err(|(line, sentence)| format!("{shown}:{line}: {sentence}"))
    }

    /// Parses the text of the file. An error contains its line number.
    fn parse(text: &str, known: &[&str]) -> Result<Self, (usize, String)> {
        let line = |place: usize| text.get(..place).unwrap_or_default().matches('\n').count() + 1;
        let read: Result<Self, _> = toml::from_str(text);
        let landmarks = read.map_err(|error| {
            let place = error.span().map_or(0, |span| span.start);
            (line(place), error.message().to_owned())
        })?;
        for (number, Landmark { name, axis, place, map, at }) in landmarks.landmark.iter().enumerate() {
            let wrong = |place: &Spanned<String>, sentence| Err((line(place.span().start), sentence));
            if !known.contains(&name.get_ref().as_str()) {
                let near = mdle_compiler::alphabet::did_you_mean(name.get_ref(), known);
                return wrong(name, format!("the graph has no landmark `{}`{near}", name.get_ref()));
            }
            if landmarks.landmark.iter().take(number).any(|other| other.name.get_ref() == name.get_ref()) {
                return wrong(name, format!("the landmark `{}` is described twice", name.get_ref()));
            }
            match Quantity::Angle.read(axis.get_ref(), "deg") {
                Ok(angle) if angle.abs() <= 360.0 => {}
                Ok(_) => return wrong(axis, "an axis is turned by at most 360 degrees to either side".to_owned()),
                Err(sentence) => return wrong(axis, sentence),
            }
            if let Some((place, Err(sentence))) = place.as_ref().map(|place| (place, point(place.get_ref()))) {
                return wrong(place, sentence);
            }
            let Some(at) = at else { continue };
            if map.is_none() {
                return wrong(at, format!("the landmark `{}` has no `map` in which it could be", name.get_ref()));
            }
            if let Err(error) = at.get_ref().parse::<Start>() {
                return wrong(at, error.to_string());
            }
        }
        Ok(landmarks)
    }

    /// Reads the maps of the landmarks. `file` is the file of landmarks; `begins` is the direction, in degrees, of the
    /// x axis of the landmark at which the route begins.
    ///
    /// # Errors
    /// Fails if a map cannot be read.
    pub(super) fn maps(&self, file: &Path, begins: f64) -> Result<Vec<LandmarkMap>, Failure> {
        let maps = self.landmark.iter().filter_map(|landmark| {
            let map = file.with_file_name("").join(landmark.map.as_ref()?);
            let name = landmark.name.get_ref().clone();
            let at = landmark.at.as_ref().map_or(USUAL_POSE, |at| at.get_ref().as_str());
            let at = at.parse().map_or(Pose::ORIGIN, |Start(pose)| pose);
            let turned = self.axis(&name) - begins;
            Some(SavedMap::read(&map).map(|map| LandmarkMap { name, turned, at, map }))
        });
        maps.collect()
    }

    /// Returns the known positions of landmarks, in the coordinates of the route. `begins` is the direction, in
    /// degrees, of the x axis of the landmark at which the route begins.
    pub(super) fn places(&self, begins: f64) -> Vec<LandmarkPlace> {
        let (sin, cos) = libm::sincos(Radians::from_degrees(begins).0);
        let places = self.landmark.iter().filter_map(|landmark| {
            let (x, y) = point(landmark.place.as_ref()?.get_ref()).ok()?;
            let at = (Meters(x * cos + y * sin), Meters(y * cos - x * sin));
            Some(LandmarkPlace { name: landmark.name.get_ref().clone(), at })
        });
        places.collect()
    }

    /// Returns the direction, on the floor, of a landmark's x axis, in degrees; 0 if the file does not contain it.
    pub(super) fn axis(&self, name: &str) -> f64 {
        let landmark = self.landmark.iter().find(|landmark| landmark.name.get_ref() == name);
        landmark.and_then(|landmark| Quantity::Angle.read(landmark.axis.get_ref(), "deg").ok()).unwrap_or_default()
    }
}

/// Parses a position on the floor, in metres.
fn point(text: &str) -> Result<(f64, f64), String> {
    let (x, y) = text.split_once(',').ok_or("expected x, y: two numbers in metres, as in `7.45, 0.4`")?;
    let metres = |text: &str| Quantity::Length.read(text.trim(), "m");
    Ok((metres(x)?, metres(y)?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_landmark_has_an_axis() {
        let text = "[[landmark]]\nname = \"a\"\naxis = \"90deg\"\n[[landmark]]\nname = \"b\"\naxis = \"-45\"\n";
        let landmarks = Landmarks::parse(text, &["a", "b", "c"]).unwrap();
        assert_eq!(["a", "b", "c"].map(|name| landmarks.axis(name)), [90.0, -45.0, 0.0]);
    }

    #[test]
    fn a_place_at_a_landmark_is_a_pose_on_its_map() {
        let read = |rest: &str| {
            Landmarks::parse(&format!("[[landmark]]\nname = \"a\"\naxis = \"0\"\n{rest}\n"), &["a"]).map(|_| ())
        };
        let map = "map = \"a.yaml\"\n";
        assert_eq!(read(&format!("{map}at = \"-0.75, 0, 0\"")), Ok(()));
        assert_eq!(read(map), Ok(()));
        let (line, sentence) = read("at = \"-0.75, 0, 0\"").unwrap_err();
        assert_eq!((line, sentence.as_str()), (4, "the landmark `a` has no `map` in which it could be"));
        assert_eq!(read(&format!("{map}at = \"-0.75, 0\"")).unwrap_err().0, 5);
    }

    #[test]
    fn places_are_in_the_axes_of_the_first_landmark() {
        let text = "[[landmark]]\nname = \"a\"\naxis = \"90deg\"\nplace = \"1m, 50cm\"\n\
                    [[landmark]]\nname = \"b\"\naxis = \"0\"\n";
        let landmarks = Landmarks::parse(text, &["a", "b"]).unwrap();
        let places = landmarks.places(90.0);
        let [LandmarkPlace { name, at: (x, y) }] = &places[..] else { panic!("{places:?}") };
        assert_eq!(name, "a");
        assert!((x.0 - 0.5).abs() < 1e-12 && (y.0 + 1.0).abs() < 1e-12, "{places:?}");
        for wrong in ["1", "1, 0, 0", "1deg, 0"] {
            let (line, _) = Landmarks::parse(&text.replace("1m, 50cm", wrong), &["a", "b"]).unwrap_err();
            assert_eq!(line, 4, "{wrong}");
        }
    }

    #[test]
    fn faulty_landmarks_are_refused() {
        let refused = |name: &str, axis: &str| {
            let text =
                format!("[[landmark]]\nname = \"lab1\"\naxis = \"0\"\n\n[[landmark]]\nname = {name}\naxis = {axis}\n");
            let (line, sentence) = Landmarks::parse(&text, &["lab1", "lab2"]).unwrap_err();
            format!("{line}: {sentence}")
        };
        let messages = [
            refused("\"lab\"", "\"0\""),
            refused("\"lab1\"", "\"0\""),
            refused("\"lab2\"", "\"400\""),
            refused("\"lab2\"", "\"3m\""),
            refused("\"lab2\"", "3"),
        ];
        insta::assert_snapshot!(messages.join("\n"), @"
        6: the graph has no landmark `lab`; did you mean `lab1`?
        6: the landmark `lab1` is described twice
        7: an axis is turned by at most 360 degrees to either side
        7: `3m` is a length: expected an angle in deg, rad, or a number in deg
        7: invalid type: integer `3`, expected a string
        ");
    }
}
