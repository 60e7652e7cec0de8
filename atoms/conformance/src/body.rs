//! Checks that the dimensions that a robot reports for its body are plausible.

use std::format;

use mdle_runtime::PINGS_KEPT;
use mdle_runtime::capability::{DiffDrive, SonarRing};

use super::trial::Trial;
use super::{Out, Room, Stage, Verdict};

/// Minimum and maximum plausible radius of a body, in metres.
const RADIUS: (f64, f64) = (0.01, 5.0);

/// Checks that the dimension `found`, in metres, lies between two limits. `what` names the dimension in messages.
fn between(what: &str, found: f64, (least, most): (f64, f64)) -> Result<(), String> {
    if (least..=most).contains(&found) {
        return Ok(());
    }
    Err(format!("{what} is {found} m, and it has to be {least} m to {most} m: they are metres"))
}

pub(super) fn is_plausible<S: Stage>(stage: &mut S) -> Result<(), Verdict>
where
    Out<S>: DiffDrive,
{
    let y = Trial::of(stage, &Room::open())?.y;
    let radius = y.body_radius().0;
    between("`body_radius`", radius, RADIUS)?;
    between("`half_length`, of a body within its circle,", y.half_length().0, (RADIUS.0, radius))?;
    between("`half_width`, of a body within its circle,", y.half_width().0, (RADIUS.0, radius))?;
    between("`wheel_base`, of wheels that are within the body,", y.wheel_base().0, (RADIUS.0, 2.0 * radius))?;
    Ok(())
}

pub(super) fn has_a_ring<S: Stage>(stage: &mut S) -> Result<(), Verdict>
where
    Out<S>: SonarRing + DiffDrive,
{
    let y = Trial::of(stage, &Room::open())?.y;
    between("`ring_radius`, of sonars on the body,", y.ring_radius().0, (0.0, y.body_radius().0))?;
    between("`blocked_within`, from which a way is free,", y.blocked_within().0, (0.05, 10.0))?;
    let confirmation = y.confirmation();
    if !(1..=PINGS_KEPT).contains(&confirmation) {
        let why = format!("`confirmation` is {confirmation} pings, and there are 1 to {PINGS_KEPT}");
        return Err(Verdict::Broken(why));
    }
    Ok(())
}
