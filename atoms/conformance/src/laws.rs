//! Checks laws of the paper on this robot: `go`, `stop`, `rotate`, `turn` and `align` (section IV-A).

use std::format;

use mdle_runtime::capability::{DiffDrive, SonarRing};
use mdle_runtime::{Argument, Meters, MetersPerSecond, Pose, Radians, RadiansPerSecond, SonarId};

use super::drive::{METRES, OMEGA, PART, RADIANS, SETTLES, V, stood};
use super::measured::Measured;
use super::ring::HEARD;
use super::trial::{Trial, Way, lasting};
use super::{Out, Room, Stage, Verdict};

/// Tolerance of the final heading of a law that turns, in degrees, in addition to a fraction of the turn. It covers the
/// law's own tolerance of 2 degrees, and the error of odometry.
const DONE: f64 = 5.0;
/// Tolerance, in degrees, for the robot's heading after `align`. The ranges that the law compares may be off by an
/// inch, and may be a second old.
const SQUARE: f64 = 8.0;
/// Maximum duration of a turn, in seconds.
const TURNS: f64 = 25.0;
/// The wall beside which `align` runs: its distance from the body, and half its length, both in metres.
const WALL: (f64, f64) = (0.5, 1.8);
/// Angle, in degrees, between the heading at which the robot begins to align and the heading that is square to the
/// wall.
const ASKEW: f64 = 12.0;

pub(super) fn go<S: Stage>(stage: &mut S) -> Result<(), Verdict> {
    for (v, omega) in [(V, OMEGA), (-V, -OMEGA)] {
        let mut trial = Trial::of(stage, &Room::open())?;
        let arguments = [Argument::Speed(MetersPerSecond(v)), Argument::AngularRate(RadiansPerSecond(omega))];
        trial.run("go", &arguments, SETTLES, |_| Ok(()))?;
        let from = trial.truth();
        if trial.run("go", &arguments, 2.0, |_| Ok(()))?.is_some() {
            return Err(Verdict::Broken("`go` is done: it drives until an interrupt ends it".into()));
        }
        let way = Way::between(from, trial.truth());
        let seconds = lasting::<S>(2.0);
        let arc = Way::between(Pose::ORIGIN, Pose::ORIGIN.moved(Meters(v * seconds), Radians(omega * seconds)));
        let what = format!("`go {} {omega}` for {seconds:.1} s:", v * 100.0);
        let measured = |what: &str, unit, found, wanted: f64, within| {
            Measured { what, unit, whose: "`go`", found, wanted, within }.check()
        };
        measured(&format!("{what} turned by"), "rad", way.turn, arc.turn, RADIANS + PART * arc.turn.abs())?;
        measured(&format!("{what} went forward by"), "m", way.ahead, arc.ahead, METRES + PART * arc.far())?;
        measured(&format!("{what} went to its left by"), "m", way.left, arc.left, METRES + PART * arc.far())?;
    }
    Ok(())
}

pub(super) fn stop<S: Stage>(stage: &mut S) -> Result<(), Verdict> {
    let mut trial = Trial::of(stage, &Room::open())?;
    trial.drive(V, OMEGA, SETTLES)?;
    trial.run("stop", &[], SETTLES, |_| Ok(()))?;
    let from = trial.truth();
    if trial.run("stop", &[], 1.0, |_| Ok(()))?.is_some() {
        return Err(Verdict::Broken("`stop` is done: it stands until an interrupt ends it".into()));
    }
    Ok(stood(&Way::between(from, trial.truth()), "under `stop`")?)
}

/// Checks that a law has turned the body by `degrees` on the spot, and that the body is then at rest.
fn turned<S: Stage>(trial: &mut Trial<'_, S>, what: &str, from: Pose, degrees: f64, off: f64) -> Result<(), String> {
    let way = Way::between(from, trial.truth());
    let wrong = Radians(way.turn - Radians::from_degrees(degrees).0).wrapped().degrees();
    if wrong.abs() > off {
        let turned = way.turn.to_degrees();
        return Err(format!("{what} is done with the body turned by {turned:.0} degrees instead of {degrees:.0}"));
    }
    if way.far() > 0.1 {
        return Err(format!("{what} is to turn on the spot, and the body went {:.2} m", way.far()));
    }
    stood(&trial.drive(0.0, 0.0, 0.5)?, &format!("{what} is done, and then"))
}

/// Returns the tolerance, in degrees, of a turn by this angle.
fn off(degrees: f64) -> f64 {
    DONE + PART * degrees.abs()
}

pub(super) fn rotate<S: Stage>(stage: &mut S) -> Result<(), Verdict> {
    // Headings are relative to the robot's first heading, and the robot has turned since.
    for (heading, before) in [(90.0, OMEGA), (270.0, OMEGA), (-60.0, -OMEGA)] {
        let mut trial = Trial::of(stage, &Room::open())?;
        let first = trial.truth();
        trial.drive(0.0, before, 1.0)?;
        trial.drive(0.0, 0.0, SETTLES)?;
        let from = trial.truth();
        let way = Radians(Radians::from_degrees(heading).0 - Way::between(first, from).turn).wrapped().degrees();
        let mut least_and_most = (0.0_f64, 0.0_f64);
        let arguments = [Argument::Angle(Radians::from_degrees(heading))];
        let done = trial.run("rotate", &arguments, TURNS, |trial| {
            let turn = Way::between(from, trial.truth()).turn.to_degrees();
            least_and_most = (least_and_most.0.min(turn), least_and_most.1.max(turn));
            Ok(())
        })?;
        let what = format!("`rotate {heading}`");
        if done.is_none() {
            return Err(Verdict::Broken(format!("{what} was not done after {TURNS:.0} s")));
        }
        turned(&mut trial, &what, from, way, off(way))?;
        let wrong_way = if way > 0.0 { -least_and_most.0 } else { least_and_most.1 };
        if wrong_way > DONE {
            return Err(Verdict::Broken(format!("{what} went the long way round")));
        }
    }
    Ok(())
}

pub(super) fn turn<S: Stage>(stage: &mut S) -> Result<(), Verdict> {
    for angle in [90.0, -120.0, 270.0] {
        let mut trial = Trial::of(stage, &Room::open())?;
        let from = trial.truth();
        let mut round = 0.0;
        let mut last = from;
        let arguments = [Argument::Angle(Radians::from_degrees(angle))];
        let done = trial.run("turn", &arguments, TURNS, |trial| {
            round += Way::between(last, trial.truth()).turn;
            last = trial.truth();
            Ok(())
        })?;
        let what = format!("`turn {angle}`");
        if done.is_none() {
            return Err(Verdict::Broken(format!("{what} was not done after {TURNS:.0} s")));
        }
        turned(&mut trial, &what, from, angle, off(angle))?;
        if (round.to_degrees() - angle).abs() > off(angle) {
            let why = format!("{what} turned by {:.0} degrees, the other way round", round.to_degrees());
            return Err(Verdict::Broken(why));
        }
    }
    Ok(())
}

pub(super) fn align<S: Stage>(stage: &mut S) -> Result<(), Verdict>
where
    Out<S>: SonarRing + DiffDrive,
{
    let radius = Trial::of(stage, &Room::open())?.y.body_radius().0;
    // The wall is askew, on the side that each pair of sonars faces: left, behind, right, in front.
    for (first, second, side, askew) in
        [(3, 5, 90.0, ASKEW), (7, 9, 180.0, -ASKEW), (11, 13, 270.0, ASKEW), (15, 1, 0.0, -ASKEW)]
    {
        let room = Room::open().across(side + askew, radius + WALL.0, WALL.1);
        let mut trial = Trial::of(stage, &room)?;
        trial.drive(0.0, 0.0, HEARD)?;
        let from = trial.truth();
        let arguments = [first, second].map(|sonar| Argument::Sonar(SonarId::new(sonar)));
        let what = format!("`align {first} {second}` beside a wall {askew} degrees askew");
        if trial.run("align", &arguments, TURNS, |_| Ok(()))?.is_none() {
            let turned = Way::between(from, trial.truth()).turn.to_degrees();
            let why = format!("{what} was not done after {TURNS:.0} s, with the body turned by {turned:.0} degrees");
            return Err(Verdict::Broken(why));
        }
        turned(&mut trial, &what, from, askew, SQUARE)?;
    }
    Ok(())
}
