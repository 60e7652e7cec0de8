//! Parses the YAML file of a map: lines of the form `key: value`, with at most seven keys.

use crate::world_error::WorldError;

/// Minimum and maximum size of a pixel, in metres.
const RESOLUTIONS: std::ops::RangeInclusive<f64> = 1e-4..=100.0;

/// Contents of the YAML file of a map of the Robot Operating System (ROS).
#[derive(Debug, Clone, PartialEq)]
pub struct Header {
    /// Path of the image, relative to the folder of the YAML file.
    pub image: String,
    /// Size of a pixel, in metres.
    pub(crate) resolution: f64,
    /// x coordinate of the image's lower left corner, in metres.
    pub(crate) x: f64,
    /// y coordinate of the image's lower left corner, in metres.
    pub(crate) y: f64,
    /// Rotation of the image, in radians.
    pub(crate) yaw: f64,
    /// `true` if white is occupied and black is free.
    pub(crate) negate: bool,
    /// Darkness, from 0 to 1, above which a pixel is occupied.
    pub(crate) occupied: f64,
}

/// Value of a key, and its position in the file.
struct HeaderValue<'t> {
    line: usize,
    column: usize,
    text: &'t str,
}

impl Header {
    /// Parses the text of a YAML file; `file` is the name of the file in error messages.
    ///
    /// # Errors
    /// Fails if the text lacks an image or a resolution, or has a value that is not a number or out of range.
    pub fn parse(file: &str, text: &str) -> Result<Self, WorldError> {
        let missing = |what: &str| WorldError::new(file, None, what.to_owned());
        let image = value(text, "image").ok_or_else(|| missing("no `image`: expected as in `image: map.pgm`"))?;
        let resolution = value(text, "resolution")
            .ok_or_else(|| missing("a map without scale: expected the metres of a pixel, as in `resolution: 0.05`"))?;
        let number = |value: &HeaderValue<'_>| {
            let number = value.text.parse().ok().filter(|number: &f64| number.is_finite());
            number.ok_or_else(|| value.wrong(file, format!("{:?} is no number", value.text)))
        };
        let metres = number(&resolution)?;
        if !RESOLUTIONS.contains(&metres) {
            return Err(resolution.wrong(file, format!("a pixel of {metres} m; expected 0.0001 to 100")));
        }
        let origin = numbers(text, "origin");
        let [x, y, yaw] = match &*origin.iter().map(number).collect::<Result<Vec<_>, _>>()? {
            [] => [0.0; 3],
            [x, y, yaw] => [*x, *y, *yaw],
            _ => {
                let what = "an origin is three numbers, as in `origin: [-10.0, -10.0, 0.0]`";
                return Err(origin.first().map_or_else(|| missing(what), |first| first.wrong(file, what.to_owned())));
            }
        };
        let or = |key, usual| value(text, key).map_or(Ok(usual), |value| number(&value));
        Ok(Self {
            image: image.text.to_owned(),
            resolution: metres,
            x,
            y,
            yaw,
            negate: or("negate", 0.0)? != 0.0,
            occupied: or("occupied_thresh", 0.65)?,
        })
    }
}

impl HeaderValue<'_> {
    fn wrong(&self, file: &str, what: String) -> WorldError {
        WorldError::new(file, Some((self.line, self.column)), what)
    }
}

/// Returns the value of a key, without quotes; `None` if the text does not have the key.
fn value<'t>(text: &'t str, key: &str) -> Option<HeaderValue<'t>> {
    let (number, line) = line(text, key)?;
    Some(trimmed(number, line, key.len() + 1, line.get(key.len() + 1..)?))
}

/// Returns the values of a key that has several values: written as `[1, 2]`, or as one line such as `- 1` for each
/// value.
fn numbers<'t>(text: &'t str, key: &str) -> Vec<HeaderValue<'t>> {
    let Some((number, line)) = line(text, key) else { return Vec::new() };
    let Some(begins) = line.find('[') else {
        let rows = (number + 1..).zip(text.lines().skip(number));
        let rows = rows.map_while(|(number, line)| {
            let after = line.trim_start().strip_prefix("- ")?;
            Some(trimmed(number, line, line.len() - after.len(), after))
        });
        return rows.collect();
    };
    let inside = line.get(begins + 1..).unwrap_or_default();
    let inside = inside.split(']').next().unwrap_or_default();
    let mut column = begins + 1;
    let values = inside.split(',').map(|part| {
        let value = trimmed(number, line, column, part);
        column += part.len() + 1;
        value
    });
    values.collect()
}

/// Returns the line that begins with `key`, and its number, counted from 1; `None` if the text does not have the key.
fn line<'t>(text: &'t str, key: &str) -> Option<(usize, &'t str)> {
    (1..).zip(text.lines()).find(|(_, line)| line.strip_prefix(key).is_some_and(|rest| rest.starts_with(':')))
}

/// Returns the value that begins at the byte `from` of a line, without spaces, comment and quotes.
fn trimmed<'t>(line: usize, whole: &'t str, from: usize, part: &'t str) -> HeaderValue<'t> {
    let part = part.split(" #").next().unwrap_or_default();
    let blanks = part.len() - part.trim_start().len();
    let column = whole.get(..from + blanks).unwrap_or_default().chars().count() + 1;
    HeaderValue { line, column, text: part.trim().trim_matches(['"', '\'']) }
}
