//! Returns the data from which a page draws a world.

use mdle_simulator::{Form, Goal, Walls, World, Zone};
use serde_json::{Value, json};

use crate::setup::ReadyRun;

/// Maximum number of corners that a world may have in order to be drawn.
const CORNERS_MOST: usize = 200_000;

/// Returns the floor of a world in TOML: the outlines, the moving objects, the start pose, the goal and the charger, in
/// metres.
pub(crate) fn floor(text: &str) -> Result<Value, String> {
    let world = World::parse("world", text).map_err(|error| error.to_string())?;
    Walls::of_any(&world).map_err(|what| format!("world: {what}"))?;
    drawn(&world, world.goal)
}

/// Returns the robot's start pose and the form of its body.
fn robot(ready: &ReadyRun) -> Value {
    let form = ready.make.form();
    let (half_length, half_width) = form.halves();
    let pose = ready.begins;
    json!({
        "pose": [pose.x.0, pose.y.0, pose.theta.0],
        "round": matches!(form, Form::Disc { .. }), "length": half_length, "width": half_width,
    })
}

/// Returns the floor before a run, with the robot.
///
/// # Errors
/// Fails if the world is too large to be drawn.
pub(crate) fn ready(ready: &ReadyRun) -> Result<Value, String> {
    Ok(json!({ "floor": drawn(&ready.world, ready.goal)?, "robot": robot(ready) }))
}

/// Returns the floor of a world, with the goal of a run.
///
/// # Errors
/// Fails if the world is too large to be drawn.
fn drawn(world: &World, goal: Option<Goal>) -> Result<Value, String> {
    let corners: usize = world.outlines.iter().map(|outline| outline.points.len()).sum();
    if corners > CORNERS_MOST {
        return Err(format!("world: {corners} corners are too many to be drawn; expected at most {CORNERS_MOST}"));
    }
    let points = |points: &[mdle_simulator::Point]| points.iter().map(|place| json!([place.x, place.y])).collect();
    let outline = |outline: &mdle_simulator::Outline| {
        let corners: Value = points(&outline.points);
        json!({ "name": outline.name, "solid": outline.solid, "points": corners })
    };
    let goal = goal.map(|goal| {
        let mut shown = match goal.zone {
            Zone::Rectangle { min, max } => json!({ "min": [min.x, min.y], "max": [max.x, max.y] }),
            Zone::Circle { center, radius } => json!({ "center": [center.x, center.y], "radius": radius }),
        };
        shown["heading"] = json!(goal.heading.map(|(heading, tolerance)| [heading.degrees(), tolerance.degrees()]));
        shown
    });
    let charger = world.charger.map(|charger| {
        json!({ "at": [charger.pose.x.0, charger.pose.y.0], "heading": charger.pose.theta.0, "reach": charger.reach })
    });
    Ok(json!({
        "outlines": world.outlines.iter().map(outline).collect::<Vec<_>>(),
        "things": world.things.iter().map(|thing| outline(&thing.outline)).collect::<Vec<_>>(),
        "start": [world.start.x.0, world.start.y.0, world.start.theta.0],
        "goal": goal,
        "charger": charger,
    }))
}
