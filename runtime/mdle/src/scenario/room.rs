//! Checks that the places of a formation leave room for the bodies of its robots.

use mdle_compiler::fsm::{FormationPlace, Machine, formation_places};
use mdle_sim::Make;

use super::file::{RobotText, ScenarioError, body};

/// Checks that a robot in its places does not touch the robot that it follows.
///
/// # Errors
/// Fails if a place is too near, or if the body of a robot has no such name.
pub(super) fn check(machine: &Machine, text: &RobotText, robots: &[RobotText]) -> Result<(), ScenarioError> {
    for FormationPlace { robot, ahead, left } in formation_places(machine) {
        let Some(other) = robots.iter().find(|other| other.name.get_ref() == robot) else { continue };
        let (apart, least) = (libm::hypot(ahead, left), half_width(text)? + half_width(other)?);
        if apart <= least {
            let own = text.name.get_ref();
            let message = format!(
                "`{own}` would touch `{robot}` in the formation: the place is {apart:.2} m from it, and their bodies \
                 touch at {least:.2} m"
            );
            return Err(ScenarioError::at(text.file.span(), message).help("give the formation a larger distance"));
        }
    }
    Ok(())
}

/// Returns half of the smaller side of a robot's body, in metres: two robots that are nearer than these distances touch
/// each other in any heading.
fn half_width(robot: &RobotText) -> Result<f64, ScenarioError> {
    let (length, width) = Make { body: body(robot.body.as_ref())?, without: Vec::new(), seed: None }.form().halves();
    Ok(length.min(width))
}
