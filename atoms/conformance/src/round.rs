//! Checks that `goAvoid` reaches its goal without contact (section IV-A).

use std::format;

use mdle_runtime::capability::{DiffDrive, SonarRing};
use mdle_runtime::{Argument, Meters, MetersPerSecond, Pose, Radians};

use super::trial::{Trial, Way};
use super::{Out, Room, Stage, Verdict};

/// Maximum distance from the goal at the end, in metres: the tolerance of the law, 0.12 m, and the error of odometry.
const ARRIVED: f64 = 0.2;
/// Distance of the goal from the start, in metres.
const RANGE: f64 = 1.0;
/// Speed to drive at, in m/s.
const SPEED: f64 = 0.2;
/// Maximum distance, in metres, between a wall and a body that is treated as touching it.
const TOUCHES: f64 = 0.002;

fn arguments(degrees: f64, range: f64) -> [Argument<'static>; 3] {
    [
        Argument::Angle(Radians::from_degrees(degrees)),
        Argument::Length(Meters(range)),
        Argument::Speed(MetersPerSecond(SPEED)),
    ]
}

pub(super) fn arrives<S: Stage>(stage: &mut S) -> Result<(), Verdict> {
    for degrees in [60.0, -60.0, 0.0] {
        let mut trial = Trial::of(stage, &Room::open())?;
        // Bearings are relative to the robot's first heading, and the robot has turned and driven since.
        let first = trial.truth();
        trial.drive(SPEED, 0.4, 1.5)?;
        trial.drive(0.0, 0.0, 0.8)?;
        let from = Pose { theta: first.theta, ..trial.truth() };
        trial.run_until_done("goAvoid", &arguments(degrees, RANGE), 25.0)?;
        let goal = from.towards(Radians(from.theta.0 + Radians::from_degrees(degrees).0), Meters(RANGE));
        let off = trial.truth().distance(&goal).0;
        if off > ARRIVED {
            let Way { ahead, left, .. } = Way::between(from, trial.truth());
            return Err(Verdict::Broken(format!(
                "`goAvoid {degrees} {RANGE}` is done {off:.2} m from its goal: {ahead:.2} m ahead and {left:.2} m to \
                 the left of where it began"
            )));
        }
    }
    Ok(())
}

pub(super) fn touches_nothing<S: Stage>(stage: &mut S) -> Result<(), Verdict>
where
    Out<S>: SonarRing + DiffDrive,
{
    let radius = Trial::of(stage, &Room::open())?.y.body_radius().0;
    // A wall blocks the way: the robot must go round it or stay where it is.
    let room = Room::open().across(0.0, radius + 1.0, 1.0);
    let mut trial = Trial::of(stage, &room)?;
    trial.drive(0.0, 0.0, super::ring::HEARD)?;
    trial.run("goAvoid", &arguments(0.0, radius + 2.5), 20.0, |trial| {
        let away = room.nearest(trial.truth()).0;
        if away > radius + TOUCHES {
            return Ok(());
        }
        Err(format!("`goAvoid` drove into a wall {away:.2} m from its centre, with a body of {radius:.2} m"))
    })?;
    Ok(())
}
