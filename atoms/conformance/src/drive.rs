//! Checks that the motion caused by an input has the right signs and units, and that the body stops.

use std::format;

use mdle_runtime::{Alphabet, Meters, Pose, Radians, Robot as _};

use super::measured::Measured;
use super::trial::{Trial, Way, lasting, twist};
use super::{Room, Stage, Verdict};

/// Tolerance of the body's motion, as a fraction of the commanded motion.
pub(super) const PART: f64 = 0.06;
/// Additional tolerance of the body's motion, in metres.
pub(super) const METRES: f64 = 0.02;
/// Additional tolerance of the body's turn, in radians.
pub(super) const RADIANS: f64 = 0.03;
/// Time, in seconds, after which a body must have the commanded speed.
pub(super) const SETTLES: f64 = 0.8;
/// Time after `SETTLES`, in seconds, for which the motion is measured.
pub(super) const SECONDS: f64 = 2.0;
/// Commanded speed, in m/s.
pub(super) const V: f64 = 0.2;
/// Commanded turn rate, in rad/s.
pub(super) const OMEGA: f64 = 0.4;
/// Maximum motion of a body at rest, in metres and radians.
const STANDS: (f64, f64) = (0.01, 0.02);
/// Minimum deceleration of a body that is commanded to stop, in m/s² and rad/s².
const BRAKES: (f64, f64) = (0.5, 1.5);
/// Fraction of the alphabet's speed limits that the body must reach.
const REACHED: f64 = 0.9;

/// Checks that the body was at rest.
pub(super) fn stood(way: &Way, when: &str) -> Result<(), String> {
    if way.far() <= STANDS.0 && way.turn.abs() <= STANDS.1 {
        return Ok(());
    }
    Err(format!("{when} the body went {:.3} m and turned by {:.1} degrees", way.far(), way.turn.to_degrees()))
}

/// Checks that the body has moved along the arc that results from the speed `v`, the turn rate `omega` and the duration
/// `seconds`.
fn went(way: &Way, v: f64, omega: f64, seconds: f64) -> Result<(), String> {
    let arc = Way::between(Pose::ORIGIN, Pose::ORIGIN.moved(Meters(v * seconds), Radians(omega * seconds)));
    let did = format!("told {v} m/s and {omega} rad/s for {seconds:.1} s, the body");
    let measured = |what: &str, unit, found, wanted: f64, within| {
        let what = format!("{did} {what}");
        Measured { what: &what, unit, whose: "the input", found, wanted, within }.check()
    };
    measured("turned counter-clockwise by", "rad", way.turn, arc.turn, RADIANS + PART * arc.turn.abs())?;
    measured("went forward by", "m", way.ahead, arc.ahead, METRES + PART * arc.far())?;
    measured("went to its left by", "m", way.left, arc.left, METRES + PART * arc.far())
}

/// Commands a speed and a turn rate, and checks the motion of the body as soon as the body has reached them.
fn drives<S: Stage>(stage: &mut S, v: f64, omega: f64) -> Result<(), Verdict> {
    let mut trial = Trial::of(stage, &Room::open())?;
    trial.drive(v, omega, SETTLES)?;
    let way = trial.drive(v, omega, SECONDS)?;
    went(&way, v, omega, lasting::<S>(SECONDS))?;
    Ok(())
}

pub(super) fn rests<S: Stage>(stage: &mut S) -> Result<(), Verdict> {
    let mut trial = Trial::of(stage, &Room::open())?;
    let way = trial.drive(0.0, 0.0, 1.0)?;
    stood(&way, "with the null input")?;
    trial.drive(V, OMEGA, SETTLES)?;
    trial.drive(0.0, 0.0, SETTLES)?;
    let way = trial.drive(0.0, 0.0, 1.0)?;
    Ok(stood(&way, "with the null input behind another one")?)
}

pub(super) fn ignores_what_is_no_number<S: Stage>(stage: &mut S) -> Result<(), Verdict> {
    for (v, omega) in [(f64::NAN, 0.0), (0.0, f64::NAN), (f64::INFINITY, 0.0), (0.0, f64::NEG_INFINITY)] {
        let mut trial = Trial::of(stage, &Room::open())?;
        let from = trial.truth();
        // The robot may treat this input as a fault.
        for _ in 0..10 {
            if trial.robot.exchange(&twist(v, omega)).is_err() {
                break;
            }
        }
        stood(&Way::between(from, trial.truth()), &format!("told {v} m/s and {omega} rad/s"))?;
    }
    Ok(())
}

pub(super) fn goes_forward<S: Stage>(stage: &mut S) -> Result<(), Verdict> {
    drives(stage, V, 0.0)?;
    drives(stage, -V, 0.0)
}

pub(super) fn turns<S: Stage>(stage: &mut S) -> Result<(), Verdict> {
    drives(stage, 0.0, OMEGA)?;
    drives(stage, 0.0, -OMEGA)
}

pub(super) fn goes_round<S: Stage>(stage: &mut S) -> Result<(), Verdict> {
    drives(stage, V, OMEGA)?;
    drives(stage, V, -OMEGA)?;
    drives(stage, -V, OMEGA)
}

pub(super) fn reaches_its_limits<S: Stage>(stage: &mut S) -> Result<(), Verdict> {
    let mut limits = S::Alphabet::LIMITS.iter().filter(|limit| limit.quark == "go").peekable();
    if limits.peek().is_none() {
        return Err(Verdict::NotOffered);
    }
    for limit in limits {
        for asked in [limit.least, limit.most].into_iter().filter(|asked| *asked != 0.0) {
            let mut trial = Trial::of(stage, &Room::open())?;
            let is_rate = limit.parameter == "omega";
            let (v, omega) = if is_rate { (0.0, asked) } else { (asked, 0.0) };
            trial.drive(v, omega, 2.0)?;
            // Short enough not to complete a circle.
            let seconds = lasting::<S>(0.3);
            let way = trial.drive(v, omega, seconds)?;
            let (reached, unit) = if is_rate { (way.turn, "rad/s") } else { (way.ahead, "m/s") };
            let reached = reached / seconds;
            if reached / asked < REACHED {
                return Err(Verdict::Broken(format!(
                    "the alphabet lets plans ask for {} = {asked} {unit} in `go`, and the body comes to {reached:.2} \
                     {unit}: narrow the range in alphabet.mdle",
                    limit.parameter
                )));
            }
        }
    }
    Ok(())
}

pub(super) fn stops<S: Stage>(stage: &mut S) -> Result<(), Verdict> {
    let (fast, spin) = (2.0 * V, 2.0 * OMEGA);
    for (v, omega) in [(fast, 0.0), (-fast, 0.0), (0.0, spin), (0.0, -spin)] {
        let mut trial = Trial::of(stage, &Room::open())?;
        trial.drive(v, omega, SETTLES)?;
        let from = trial.truth();
        trial.robot.stop().map_err(|fault| format!("its stop command failed: {fault}"))?;
        let way = Way::between(from, trial.truth());
        // The robot may obey the stop a period late.
        let brakes = |speed: f64, by: f64| speed.abs() * S::PERIOD.seconds() + speed * speed / (2.0 * by);
        let (most, round) = (METRES + brakes(v, BRAKES.0), RADIANS + brakes(omega, BRAKES.1));
        if way.far() > most || way.turn.abs() > round {
            let (far, turned) = (way.far(), way.turn.abs());
            let why = format!(
                "told to stop at {v} m/s and {omega} rad/s, it still went {far:.2} m and {turned:.2} rad, and a body \
                 that brakes goes {most:.2} m and {round:.2} rad at most"
            );
            return Err(Verdict::Broken(why));
        }
        stood(&trial.left_alone(1.0), "in the second after it was stopped")?;
        trial.robot.stop().map_err(|fault| format!("to be stopped twice is a fault: {fault}"))?;
        stood(&trial.left_alone(1.0), "in the second after it was stopped a second time")?;
    }
    Ok(())
}
