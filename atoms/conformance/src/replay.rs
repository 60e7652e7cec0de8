//! Checks that the robot's output contains the paths that the robot was given, and that the law `path` replays one of
//! them (section IV-A).

use std::format;

use mdle_runtime::capability::Paths;
use mdle_runtime::{Argument, Meters, Radians};

use super::drive::SETTLES;
use super::stored_path::{BEND, NAME, SPEED};
use super::trial::{Trial, Way};
use super::{Out, Room, Stage, Verdict};

/// Maximum errors at the end of the path: of the position, in metres, and of the heading, in degrees. The body deviates
/// from the path because it has to accelerate and to stop.
const ENDS: (f64, f64) = (0.1, 10.0);

pub(super) fn are_there<S: Stage>(stage: &mut S) -> Result<(), Verdict>
where
    Out<S>: Paths,
{
    let mut trial = Trial::of(stage, &Room::open())?;
    for _ in 0..3 {
        if trial.y.path(NAME) != Some(&BEND[..]) {
            let why = "a path that the robot was given is not in its output: `Stage::take_paths` hands it over";
            return Err(Verdict::Broken(why.into()));
        }
        if trial.y.path("none.csv").is_some() {
            return Err(Verdict::Broken("there is a path of a name that the robot was not given".into()));
        }
        trial.drive(0.0, 0.0, S::PERIOD.seconds())?;
    }
    Ok(())
}

pub(super) fn replays<S: Stage>(stage: &mut S) -> Result<(), Verdict> {
    let mut trial = Trial::of(stage, &Room::open())?;
    let from = trial.truth();
    let done = trial.run("path", &[Argument::Name(NAME)], 6.0, |_| Ok(()))?;
    let Some(seconds) = done else { return Err(Verdict::Broken("`path` was not done 2 s after its end".into())) };
    if (seconds - 4.0).abs() > 2.0 * S::PERIOD.seconds() {
        return Err(Verdict::Broken(format!("`path` was done after {seconds:.1} s, of a path of 4 s")));
    }
    trial.drive(0.0, 0.0, SETTLES)?;
    let (goal, quarter) = (from.moved(Meters(SPEED), Radians(0.0)), Radians::from_degrees(90.0));
    let goal = goal.moved(Meters(2.0 * SPEED), quarter).moved(Meters(SPEED), Radians(0.0));
    let off = Way::between(goal, trial.truth());
    if off.far() > ENDS.0 || off.turn.to_degrees().abs() > ENDS.1 {
        let (far, turned) = (off.far(), off.turn.to_degrees());
        return Err(Verdict::Broken(format!(
            "`path` has brought the body {far:.2} m from the end of the path, {turned:.0} degrees off its heading"
        )));
    }
    Ok(())
}
