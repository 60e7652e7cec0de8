//! Checks that the bumper reports every contact, and nothing else.

use std::format;

use mdle_runtime::capability::{Bumpers, DiffDrive};
use mdle_runtime::{Alphabet, Interrupt as _};

use super::room::AT;
use super::trial::{Trial, Way};
use super::{Out, Room, Stage, Verdict};

/// Distance of the wall from the body, in metres.
const AWAY: f64 = 0.4;
/// Speed towards the wall, in m/s.
const V: f64 = 0.1;
/// Maximum gap, in metres, between the body and a wall at which the bumper may report contact, in addition to the
/// distance that the robot drives in one period.
const FEELS: f64 = 0.02;

pub(super) fn is_felt<S: Stage>(stage: &mut S) -> Result<(), Verdict>
where
    Out<S>: Bumpers + DiffDrive,
{
    let front = Trial::of(stage, &Room::open())?.y.half_length().0;
    let wall = front + AWAY;
    let mut trial = Trial::of(stage, &Room::open().across(0.0, wall, 1.0))?;
    let reach = FEELS + V * S::PERIOD.seconds();
    // Drives to the wall, then against it for two seconds.
    let mut turns = 0;
    while Way::between(AT, trial.truth()).ahead < AWAY - reach {
        not_felt(&trial, wall - front, reach)?;
        trial.drive(V, 0.0, S::PERIOD.seconds())?;
        turns += 1;
        if turns > 1000 {
            return Err(Verdict::Broken(format!("driven at {V} m/s, it does not come to a wall {AWAY} m away")));
        }
    }
    let pushed = trial.drive(V, 0.0, 2.0)?.ahead;
    if !trial.y.pressed() {
        let why = format!("driven against a wall for 2 s (the last {pushed:.2} m of its way), it feels no contact");
        return Err(Verdict::Broken(why));
    }
    agrees(&trial)?;
    trial.drive(-V, 0.0, 3.0)?;
    not_felt(&trial, wall - front, reach)
}

/// Checks that the robot reports no contact while the distance between its body and the wall exceeds `reach`.
fn not_felt<S: Stage>(trial: &Trial<'_, S>, wall: f64, reach: f64) -> Result<(), Verdict>
where
    Out<S>: Bumpers,
{
    agrees(trial)?;
    let away = wall - Way::between(AT, trial.truth()).ahead;
    if trial.y.pressed() && away > reach {
        let why = format!("contact is told {away:.2} m away from the only wall: a bit that is inverted, or another's");
        return Err(Verdict::Broken(why));
    }
    Ok(())
}

/// Checks that the interrupt `bumper` agrees with the contacts in the output.
fn agrees<S: Stage>(trial: &Trial<'_, S>) -> Result<(), Verdict>
where
    Out<S>: Bumpers,
{
    let bumper = S::Alphabet::interrupt("bumper", &[]).ok_or(Verdict::NotOffered)?;
    if bumper.fired(&trial.y) == trial.y.pressed() {
        return Ok(());
    }
    Err(Verdict::Broken("`bumper` and `Bumpers::pressed` do not agree".into()))
}
