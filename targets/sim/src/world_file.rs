//! Reading a world from TOML; afterwards every coordinate is finite and every wall and box has a size.

use std::fmt;
use std::marker::PhantomData;
use std::ops::Range;

use mdle_runtime::{Meters, Pose, Radians};
use serde::de::value::MapAccessDeserializer;
use serde::de::{MapAccess, Visitor};
use serde::{Deserialize, Deserializer};
use toml::Spanned;

use crate::world::{Outline, Place, World};

/// The furthest coordinate, in metres: beyond it millimetres would begin to blur.
const FURTHEST: f64 = 1e6;

/// What is wrong with a world file: `file:line:column: sentence`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct WorldError {
    file: String,
    /// Line and column, from 1; `None` when it is about the file as a whole.
    place: Option<(usize, usize)>,
    what: String,
}

impl fmt::Display for WorldError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:", self.file)?;
        if let Some((line, column)) = self.place {
            write!(f, "{line}:{column}:")?;
        }
        write!(f, " {}", self.what)
    }
}

impl std::error::Error for WorldError {}

type Coordinates = Spanned<Vec<Spanned<f64>>>;

/// The file as written.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct WorldText {
    #[serde(default)]
    start: Table<StartText>,
    #[serde(default, rename = "wall")]
    walls: Vec<Table<WallText>>,
    #[serde(default, rename = "box")]
    boxes: Vec<Spanned<Table<BoxText>>>,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
struct StartText {
    x: Option<Spanned<f64>>,
    y: Option<Spanned<f64>>,
    heading: Option<Spanned<f64>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct WallText {
    name: Option<String>,
    points: Spanned<Vec<Coordinates>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct BoxText {
    name: Option<String>,
    min: Option<Coordinates>,
    max: Option<Coordinates>,
    centre: Option<Coordinates>,
    size: Option<Coordinates>,
}

/// A table and nothing else: serde would take an array for one too, and let its last values go unread.
#[derive(Default)]
struct Table<T>(T);

impl<'de, T: Deserialize<'de>> Deserialize<'de> for Table<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_map(Keys(PhantomData))
    }
}

struct Keys<T>(PhantomData<T>);

impl<'de, T: Deserialize<'de>> Visitor<'de> for Keys<T> {
    type Value = Table<T>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "a table")
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Table<T>, A::Error> {
        T::deserialize(MapAccessDeserializer::new(map)).map(Table)
    }
}

/// A fault of the text: where, and what.
struct Wrong(Option<Range<usize>>, String);

impl Wrong {
    fn at<T>(spanned: &Spanned<T>, what: impl Into<String>) -> Self {
        Self(Some(spanned.span()), what.into())
    }
}

/// The world that `text` describes.
pub(crate) fn parse(file: &str, text: &str) -> Result<World, WorldError> {
    read(text).map_err(|Wrong(span, what)| WorldError {
        file: file.to_owned(),
        place: span.map(|span| line_and_column(text, span.start)),
        what,
    })
}

fn read(text: &str) -> Result<World, Wrong> {
    let written: WorldText = toml::from_str(text).map_err(|error| {
        // In the words of whoever writes the file.
        let what = error.message().replace('\n', " ").replace("expected f64", "expected a number");
        Wrong(error.span(), what)
    })?;
    let start = start(&written.start.0)?;
    let walls = (1..).zip(&written.walls).map(|(number, wall)| outline_of_wall(number, &wall.0));
    let boxes = (1..).zip(&written.boxes).map(|(number, text)| outline_of_box(number, text));
    Ok(World { outlines: walls.chain(boxes).collect::<Result<_, _>>()?, things: Vec::new(), start })
}

fn start(text: &StartText) -> Result<Pose, Wrong> {
    let value = |written: &Option<Spanned<f64>>| written.as_ref().map_or(Ok(0.0), coordinate);
    Ok(Pose {
        x: Meters(value(&text.x)?),
        y: Meters(value(&text.y)?),
        theta: Radians::from_degrees(value(&text.heading)?).wrapped(),
    })
}

fn outline_of_wall(number: usize, text: &WallText) -> Result<Outline, Wrong> {
    let written = text.points.get_ref();
    if written.len() < 2 {
        return Err(Wrong::at(&text.points, "a wall needs at least two points, as in `points = [[0, 0], [2.5, 0]]`"));
    }
    let mut points: Vec<Place> = Vec::with_capacity(written.len());
    for point in written {
        let place = pair(point, "a point")?;
        if points.last() == Some(&place) {
            return Err(Wrong::at(point, format!("a wall of length zero: the point before it is {place} too")));
        }
        points.push(place);
    }
    Ok(Outline { name: text.name.clone().unwrap_or_else(|| format!("wall {number}")), points, solid: false })
}

fn outline_of_box(number: usize, text: &Spanned<Table<BoxText>>) -> Result<Outline, Wrong> {
    let Table(written) = text.get_ref();
    let (min, max, told) = match (&written.min, &written.max, &written.centre, &written.size) {
        (Some(min), Some(max), None, None) => (pair(min, "`min`")?, pair(max, "`max`")?, max),
        (None, None, Some(centre), Some(size)) => {
            let (Place { x, y }, half) = (pair(centre, "`centre`")?, pair(size, "`size`")?);
            let (w, h) = (half.x / 2.0, half.y / 2.0);
            (Place { x: x - w, y: y - h }, Place { x: x + w, y: y + h }, size)
        }
        (_, _, _, _) => {
            return Err(Wrong::at(text, "a box is given by its corners `min` and `max`, or by `centre` and `size`"));
        }
    };
    if min.x >= max.x || min.y >= max.y {
        return Err(Wrong::at(told, format!("a box without an inside: it would reach from {min} to {max}")));
    }
    let points = vec![min, Place { x: max.x, y: min.y }, max, Place { x: min.x, y: max.y }, min];
    Ok(Outline { name: written.name.clone().unwrap_or_else(|| format!("box {number}")), points, solid: true })
}

fn pair(written: &Coordinates, what: &str) -> Result<Place, Wrong> {
    match written.get_ref().as_slice() {
        [x, y] => Ok(Place { x: coordinate(x)?, y: coordinate(y)? }),
        other => Err(Wrong::at(written, format!("{what} is two numbers, x and y in metres, not {}", other.len()))),
    }
}

fn coordinate(written: &Spanned<f64>) -> Result<f64, Wrong> {
    let value = *written.get_ref();
    if value.is_finite() && value.abs() <= FURTHEST {
        return Ok(value);
    }
    let kilometres = FURTHEST / 1000.0;
    Err(Wrong::at(written, format!("{value:e} is no coordinate: expected a number, at most {kilometres} km")))
}

/// Line and column of a byte of `text`, from 1, columns in characters.
fn line_and_column(text: &str, byte: usize) -> (usize, usize) {
    let before = text.get(..byte).unwrap_or(text);
    let line_start = before.rfind('\n').map_or(0, |newline| newline + 1);
    let column = before.get(line_start..).unwrap_or_default().chars().count();
    (before.matches('\n').count() + 1, column + 1)
}
