//! Reads a world from TOML, and checks that every coordinate is finite, in metres, and that every wall, box and disc
//! has a positive size.
//!
//! Obstacles may overlap and then act as one. Moving objects pass through fixed obstacles, but never into the robot.

mod outlines;
mod sounds;
mod text;
mod unreadable;

use std::ops::Range;

use mdle_runtime::Pose;
use toml::Spanned;

use crate::footprint::RADIUS;
use crate::world::World;
use crate::world_error::WorldError;
use outlines::{Stands, Unit};
use text::WorldText;
use unreadable::unreadable;

/// Maximum size of the text, in bytes; parsing takes up to 70 times the size in memory.
const BYTES_MOST: usize = 8 << 20;

/// An error in the text: its byte range (`None` for the whole text), and a message.
pub(crate) struct Wrong(pub(crate) Option<Range<usize>>, pub(crate) String);

impl Wrong {
    pub(crate) fn at<T>(spanned: &Spanned<T>, what: impl Into<String>) -> Self {
        Self(Some(spanned.span()), what.into())
    }
}

/// Returns the world that `text` describes.
pub(crate) fn parse(file: &str, text: &str) -> Result<World, WorldError> {
    read(file, text)
        .map_err(|Wrong(span, what)| WorldError::new(file, span.map(|span| line_and_column(text, span.start)), what))
}

fn read(file: &str, text: &str) -> Result<World, Wrong> {
    if text.len() > BYTES_MOST {
        let bytes = text.len();
        return Err(Wrong(None, format!("a world of {bytes} bytes is too large; expected at most {BYTES_MOST}")));
    }
    let written: WorldText = toml::from_str(text).map_err(|error| unreadable(text, &error))?;
    let unit = Unit::of(written.units.as_ref())?;
    let rough = outlines::rough(written.rough.as_ref(), 0.0)?;
    let start = written.start.as_ref().map_or(Ok(Pose::ORIGIN), |start| unit.start(&start.get_ref().0))?;
    let start_at = written.start.as_ref().map(|start| {
        let (line, column) = line_and_column(text, start.span().start);
        format!("{file}:{line}:{column}")
    });
    let goal = written.goal.as_ref().map(|goal| unit.goal(goal)).transpose()?;
    let (mut outlines, mut things) = (Vec::new(), Vec::new());
    for (number, wall) in (1..).zip(&written.walls) {
        outlines.push(unit.wall(number, &wall.0, rough)?);
    }
    for (number, text) in (1..).zip(&written.boxes) {
        match unit.box_(number, text, rough)? {
            Stands::Still(outline) => outlines.push(outline),
            Stands::Never(thing) => things.push(thing),
        }
    }
    for (number, text) in (1..).zip(&written.discs) {
        match unit.disc(number, text, rough)? {
            Stands::Still(outline) => outlines.push(outline),
            Stands::Never(thing) => things.push(thing),
        }
    }
    for (number, door) in (1..).zip(&written.doors) {
        things.push(unit.door(number, door, rough)?);
    }
    let charger = written.charger.as_ref().map(|charger| unit.charger(charger)).transpose()?;
    let (sounds, t60) = (unit.sounds(&written.sounds)?, sounds::t60(written.t60.as_ref())?);
    let world = World { outlines, things, start, start_at, goal, charger, sounds, t60, rough, contours: 0 };
    world.check_size().map_err(|what| Wrong(None, what))?;
    let blocked = charger.and_then(|charger| world.obstacle_at(&charger, RADIUS));
    if let (Some(name), Some(text)) = (blocked, &written.charger) {
        let what = format!("the charger is in {name:?}: a robot on it, {RADIUS} m around `at`, would overlap that");
        return Err(Wrong::at(&text.get_ref().0.at, what));
    }
    Ok(world)
}

/// Returns the line and column of a byte of `text`, counted from 1; columns count characters.
fn line_and_column(text: &str, byte: usize) -> (usize, usize) {
    let before = text.get(..byte).unwrap_or(text);
    let line_start = before.rfind('\n').map_or(0, |newline| newline + 1);
    let column = before.get(line_start..).unwrap_or_default().chars().count();
    (before.matches('\n').count() + 1, column + 1)
}
