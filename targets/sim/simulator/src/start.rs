//! The start pose of the robot: parsed from `x,y,deg`, and checked against the world.

use std::fmt;
use std::str::FromStr;

use mdle_quantity::Quantity;
use mdle_runtime::{Meters, Pose, Radians};

use crate::footprint::{Footprint, Form};
use crate::point::Point;
use crate::walls::{self, Walls};
use crate::world::World;

/// Number of directions in which the search looks for walls; an enclosed position has a wall in each of them.
const LOOKS: u16 = 180;
/// Range of the search for walls, in metres, which exceeds any world.
const SIGHT: f64 = 1e7;

/// A start pose given by a command-line option.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Start(pub Pose);

/// Reason why a robot cannot start at a pose.
#[derive(Debug, Clone, PartialEq)]
pub enum StartError {
    /// The text is not `x,y,deg`.
    Malformed,
    /// A part is not a number with a unit; the sentence contains the correction.
    Quantity(String),
    /// A body of this form would overlap the wall or box with this name.
    Overlaps(Form, String),
    /// The centre of the robot is inside the box with this name.
    Inside(String),
    /// The pose is outside the walls that enclose the world's own start pose.
    OffTheFloor,
    /// The pose is outside the closed wall with this name, inside which the goal or the charger is.
    Outside(String),
}

impl fmt::Display for StartError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Malformed => {
                write!(f, "expected x,y,heading: three numbers in metres and degrees, as in `0.1,-0.05,90`")
            }
            Self::Quantity(sentence) => f.write_str(sentence),
            Self::Overlaps(form, name) => write!(f, "the robot, {form}, would stand in {name:?}"),
            Self::Inside(name) => write!(f, "the robot would stand inside {name:?}"),
            Self::OffTheFloor => write!(f, "the robot would stand outside the walls of the world"),
            Self::Outside(name) => {
                write!(f, "the robot would stand outside {name:?}, and the goal or the charger is inside")
            }
        }
    }
}

impl std::error::Error for StartError {}

impl FromStr for Start {
    type Err = StartError;

    fn from_str(text: &str) -> Result<Self, StartError> {
        let [x, y, heading] = *text.split(',').map(str::trim).collect::<Vec<_>>() else {
            return Err(StartError::Malformed);
        };
        let read = |kind: Quantity, text, bare| kind.read(text, bare).map_err(StartError::Quantity);
        let x = Meters(read(Quantity::Length, x, "m")?);
        let y = Meters(read(Quantity::Length, y, "m")?);
        let theta = Radians::from_degrees(read(Quantity::Angle, heading, "deg")?).wrapped();
        Ok(Self(Pose { x, y, theta }))
    }
}

/// Checks that a robot of this form can start at `pose` in `world`, whose walls are `walls`.
///
/// # Errors
/// Returns the reason why the robot cannot start there.
pub fn check(pose: &Pose, form: Form, world: &World, walls: &Walls) -> Result<(), StartError> {
    let (place, body) = (Point::of(pose), Footprint { pose: *pose, form });
    if let Some(outline) = world.solid(place) {
        return Err(StartError::Inside(outline.name.clone()));
    }
    if walls.gap(&body, form.radius()) < 0.0 {
        let name = walls::nearest(world, &body).map(|outline| outline.name.clone());
        return Err(StartError::Overlaps(form, name.unwrap_or_default()));
    }
    // A world without closed walls has no outside. A box around the start pose is no such wall.
    let start = Point::of(&world.start);
    if !encloses(walls, place) && encloses(walls, start) && world.solid(start).is_none() {
        return Err(StartError::OffTheFloor);
    }
    match world.shut_out(place) {
        Some(outline) => Err(StartError::Outside(outline.name.clone())),
        None => Ok(()),
    }
}

/// Returns `true` if there is a wall in every direction from `place`.
fn encloses(walls: &Walls, place: Point) -> bool {
    (0..LOOKS).all(|look| {
        let direction = Radians::from_degrees(f64::from(look) * (360.0 / f64::from(LOOKS)));
        walls.ray(place, direction, SIGHT).is_some()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_numbers_and_nothing_else() {
        let Ok(Start(pose)) = "-1.5, 2,90".parse() else { panic!("a good start") };
        assert_eq!((pose.x, pose.y), (Meters(-1.5), Meters(2.0)));
        assert!((pose.theta.degrees() - 90.0).abs() < 1e-9);
        assert_eq!("-150cm,2m,90deg".parse(), Ok(Start(pose)));
        for text in ["", "1", "1,2", "1,2,3,4", "1;2;3"] {
            assert_eq!(text.parse::<Start>(), Err(StartError::Malformed), "{text}");
        }
        for text in ["a,b,c", "nan,0,0", "0,inf,0", "0,0,1e999", "1,2,90m", "1,2s,90", "1,,2"] {
            assert!(matches!(text.parse::<Start>(), Err(StartError::Quantity(_))), "{text}");
        }
    }

    /// Checks a start pose in the office world.
    fn office(x: f64, y: f64) -> Result<(), StartError> {
        let world = World::office().expect("our own floor");
        check(&Pose { x: Meters(x), y: Meters(y), theta: Radians(0.0) }, Form::SCOUT, &world, &Walls::of(&world))
    }

    #[test]
    fn a_start_must_be_on_the_floor_and_clear_of_walls() {
        for (x, y) in [(0.0, 0.0), (3.0, 0.0), (7.5, 7.7), (11.5, -2.0), (0.75, 0.0)] {
            assert_eq!(office(x, y), Ok(()), "{x} {y}");
        }
        assert_eq!(office(-0.6, 2.0), Err(StartError::Overlaps(Form::SCOUT, "A west".into())));
        assert_eq!(office(3.65, 4.25), Err(StartError::Inside("obstacle".into())));
        assert_eq!(office(3.65, 4.55), Err(StartError::Overlaps(Form::SCOUT, "obstacle".into())));
        for (x, y) in [(-3.0, 0.0), (11.5, 5.0), (100.0, 100.0), (3.0, 7.0)] {
            assert_eq!(office(x, y), Err(StartError::OffTheFloor), "{x} {y}");
        }
    }

    #[test]
    fn a_rectangle_fits_by_its_heading_where_discs_do_or_do_not() {
        let world = World::parse("one wall", "[[wall]]\nname = \"wall\"\npoints = [[0.3, -5], [0.3, 5]]")
            .expect("a good world");
        let walls = Walls::of(&world);
        let form = Form::Rectangle { half_length: 0.315, half_width: 0.27 };
        let turned = |degrees: f64| Pose { theta: Radians::from_degrees(degrees), ..Pose::ORIGIN };
        let check = |degrees: f64, form: Form| check(&turned(degrees), form, &world, &walls);
        assert_eq!([check(0.0, Form::Disc { radius: 0.27 }), check(90.0, form)], [Ok(()), Ok(())]);
        let overlaps = Err(StartError::Overlaps(form, "wall".into()));
        assert_eq!([check(0.0, form), check(45.0, form)], [overlaps.clone(), overlaps.clone()]);
        let sentence = "the robot, 0.63 m long and 0.54 m wide, would stand in \"wall\"";
        assert_eq!(overlaps.map_err(|error| error.to_string()), Err::<(), _>(sentence.to_owned()));
    }

    #[test]
    fn a_disc_around_the_start_of_the_world_is_no_floor() {
        let world = World::parse("a disc", "[[disc]]\ncentre = [0.1, 0]\nradius = 0.3").expect("a good world");
        let (beside, walls) = (Pose { x: Meters(-1.0), ..Pose::ORIGIN }, Walls::of(&world));
        assert_eq!(check(&Pose::ORIGIN, Form::SCOUT, &world, &walls), Err(StartError::Inside("disc 1".into())));
        assert_eq!(check(&beside, Form::SCOUT, &world, &walls), Ok(()));
    }

    /// A robot outside a closed wall cannot reach a place inside. Without a goal or a charger, both sides may be meant.
    #[test]
    fn a_closed_wall_around_the_goal_has_an_outside() {
        let room =
            "start = { x = 9 }\n[[wall]]\nname = \"room\"\npoints = [[-2, -2], [4, -2], [4, 2], [-2, 2], [-2, -2]]";
        let (goal, charger) = ("goal = { min = [3, -1], max = [3.5, 1] }", "charger = { at = [3, 0], heading = 0 }");
        let at = |keys: &str, x: f64| {
            let world = World::parse("a room", &format!("{keys}\n{room}")).expect("a good world");
            check(&Pose { x: Meters(x), ..Pose::ORIGIN }, Form::SCOUT, &world, &Walls::of(&world))
        };
        for keys in [goal, charger] {
            assert_eq!([at(keys, 9.0), at(keys, 0.0)], [Err(StartError::Outside("room".into())), Ok(())]);
        }
        assert_eq!(at("", 9.0), Ok(()));
        assert_eq!(at("goal = { min = [3, -1], max = [6, 1] }", 9.0), Ok(()));
    }

    #[test]
    fn walls_that_do_not_close_have_no_outside() {
        let world = World::parse("one wall", "[[wall]]\npoints = [[0, 1], [5, 1]]").expect("a good world");
        let far = Pose { x: Meters(-50.0), ..Pose::ORIGIN };
        assert_eq!(check(&far, Form::SCOUT, &world, &Walls::of(&world)), Ok(()));
    }
}
