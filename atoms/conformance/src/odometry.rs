//! Compares the motion that a robot reports with the true motion of its body.

use std::format;

use mdle_runtime::capability::Odometry;
use mdle_runtime::{Alphabet, Output as _, Pose, Radians, Signal as _};

use super::drive::{METRES, OMEGA, PART, RADIANS, SECONDS, SETTLES, V};
use super::measured::Measured;
use super::trial::{Trial, Way, lasting};
use super::{Out, Room, Stage, Verdict};

/// Tolerance of a measured speed, in m/s.
const SPEED: f64 = 0.015;
/// Tolerance of a measured turn rate, in rad/s.
const RATE: f64 = 0.03;

fn counted(what: &str, unit: &str, found: f64, wanted: f64, within: f64) -> Result<(), String> {
    Measured { what, unit, whose: "odometry", found, wanted, within }.check()
}

/// Checks that the path `reported` by odometry equals the path `went` of the body itself. `did` names the motion in
/// messages.
fn check_way(did: &str, reported: &Way, went: &Way) -> Result<(), String> {
    let says = |what: &str| format!("{did}, and by odometry it {what}");
    let (metres, radians) = (METRES + PART * went.far(), RADIANS + PART * went.turn.abs());
    counted(&says("turned counter-clockwise by"), "rad", reported.turn, went.turn, radians)?;
    counted(&says("went forward by"), "m", reported.ahead, went.ahead, metres)?;
    counted(&says("went to its left by"), "m", reported.left, went.left, metres)
}

/// Drives with this input. Returns the true path of the body and the path that odometry reports.
fn driven<S: Stage>(trial: &mut Trial<'_, S>, v: f64, omega: f64, seconds: f64) -> Result<(Way, Way), String>
where
    Out<S>: Odometry,
{
    let from = trial.y.pose();
    let went = trial.drive(v, omega, seconds)?;
    Ok((went, Way::between(from, trial.y.pose())))
}

pub(super) fn counts_the_way<S: Stage>(stage: &mut S) -> Result<(), Verdict>
where
    Out<S>: Odometry,
{
    for v in [V, -V] {
        let mut trial = Trial::of(stage, &Room::open())?;
        let (went, way) = driven(&mut trial, v, 0.0, SECONDS)?;
        check_way(&format!("the body went {:.2} m straight on", went.ahead), &way, &went)?;
    }
    Ok(())
}

pub(super) fn counts_turns<S: Stage>(stage: &mut S) -> Result<(), Verdict>
where
    Out<S>: Odometry,
{
    for omega in [OMEGA, -OMEGA] {
        let mut trial = Trial::of(stage, &Room::open())?;
        let (went, way) = driven(&mut trial, 0.0, omega, SECONDS)?;
        check_way(&format!("the body turned by {:.2} rad on the spot", went.turn), &way, &went)?;
    }
    Ok(())
}

pub(super) fn keeps_its_axes<S: Stage>(stage: &mut S) -> Result<(), Verdict>
where
    Out<S>: Odometry,
{
    for (v, omega) in [(V, OMEGA), (-V, OMEGA), (V, -OMEGA)] {
        let mut trial = Trial::of(stage, &Room::open())?;
        let (from, began) = (trial.y.pose(), trial.truth());
        driven(&mut trial, V, 0.0, SECONDS)?;
        driven(&mut trial, v, omega, 3.0)?;
        driven(&mut trial, V, 0.0, SECONDS)?;
        let (went, way) = (Way::between(began, trial.truth()), Way::between(from, trial.y.pose()));
        let did = format!("the body went ahead, an arc, and ahead: {:.2} m and {:.2} rad", went.far(), went.turn);
        check_way(&did, &way, &went)?;
        if trial.y.here() != trial.y.pose() {
            let why = "`Output::here` is another pose than `Odometry::pose`: headings of plans go by the first";
            return Err(Verdict::Broken(why.into()));
        }
    }
    Ok(())
}

pub(super) fn goes_round<S: Stage>(stage: &mut S) -> Result<(), Verdict>
where
    Out<S>: Odometry,
{
    for omega in [0.8, -0.8] {
        let mut trial = Trial::of(stage, &Room::open())?;
        let (from, began) = (trial.y.pose(), trial.truth());
        let most = 1.5 * omega * S::PERIOD.seconds();
        let mut last = from;
        // Turns more than a full circle.
        while trial.now().seconds() < 9.0 {
            trial.drive(0.0, omega, S::PERIOD.seconds())?;
            let turned = Way::between(last, trial.y.pose()).turn;
            if turned.abs() > most.abs() + RADIANS {
                let why = format!("turning at {omega} rad/s, its heading leapt by {turned:.2} rad in one period");
                return Err(Verdict::Broken(why));
            }
            last = trial.y.pose();
        }
        let (went, way) = (Way::between(began, trial.truth()), Way::between(from, last));
        let did = format!("the body turned by more than a circle, and {:.2} rad", went.turn);
        // The error may grow with the angle turned, which is more than a circle.
        let off = Radians(way.turn - went.turn).wrapped().0;
        counted(&format!("{did}; its odometry's heading is off by"), "rad", off, 0.0, RADIANS + PART * 7.0)?;
    }
    Ok(())
}

pub(super) fn measures_speed<S: Stage>(stage: &mut S) -> Result<(), Verdict>
where
    Out<S>: Odometry,
{
    for v in [V, -V] {
        measures(stage, v, 0.0)?;
    }
    measures(stage, 0.0, 0.0)
}

pub(super) fn measures_turn_rate<S: Stage>(stage: &mut S) -> Result<(), Verdict>
where
    Out<S>: Odometry,
{
    for omega in [OMEGA, -OMEGA] {
        measures(stage, 0.0, omega)?;
        measures(stage, V, omega)?;
    }
    Ok(())
}

fn measures<S: Stage>(stage: &mut S, v: f64, omega: f64) -> Result<(), Verdict>
where
    Out<S>: Odometry,
{
    let mut trial = Trial::of(stage, &Room::open())?;
    trial.drive(v, omega, SETTLES)?;
    let way = trial.drive(v, omega, 1.0)?;
    // Ratio of the arc length to the chord, and the duration of the arc.
    let half = way.turn / 2.0;
    let arc = if half.abs() < 1e-9 { 1.0 } else { half / libm::sin(half) };
    let (direction, seconds) = (if way.ahead < 0.0 { -1.0 } else { 1.0 }, lasting::<S>(1.0));
    let (speed, rate) = (way.far() * arc * direction / seconds, way.turn / seconds);
    let velocity = trial.y.velocity();
    let did = format!("the body moves at {speed:.2} m/s and {rate:.2} rad/s, and `velocity` says");
    let measured = |unit, found, wanted: f64, within: f64| {
        let within = within + PART * wanted.abs();
        Measured { what: &did, unit, whose: "the measured velocity", found, wanted, within }.check()
    };
    measured("m/s", velocity.v.0, speed, SPEED)?;
    measured("rad/s", velocity.omega.0, rate, RATE)?;
    Ok(())
}

pub(super) fn signals<S: Stage>(stage: &mut S) -> Result<(), Verdict>
where
    Out<S>: Odometry,
{
    let mut trial = Trial::of(stage, &Room::open())?;
    // Turns by more than half a circle, where a wrapped heading differs from an unwrapped one.
    trial.drive(V, 0.8, 5.0)?;
    let (Pose { x, y, theta }, velocity) = (trial.y.pose(), trial.y.velocity());
    let signals = [
        ("x", "m", x.0),
        ("y", "m", y.0),
        ("theta", "rad", theta.wrapped().0),
        ("v", "m/s", velocity.v.0),
        ("omega", "rad/s", velocity.omega.0),
    ];
    for (name, unit, wanted) in signals {
        let signal = S::Alphabet::signal(name, &[]).ok_or(Verdict::NotOffered)?;
        let what = format!("signal `{name}` has the value");
        Measured { what: &what, unit, whose: "the signal", found: signal.value(&trial.y), wanted, within: 1e-6 }
            .check()?;
    }
    Ok(())
}
