//! Checks the sixteen sonars: their directions, their ranges, and the times of their pings.

use std::format;

use mdle_runtime::capability::{DiffDrive, SonarRing};
use mdle_runtime::{Alphabet, Argument, Nanos, Output as _, Ping, Pose, SONARS, Signal as _, SonarId};

use super::room::AT;
use super::trial::{Trial, Way};
use super::{Out, Room, Stage, Verdict};

/// Time, in seconds, within which every sonar pings three times, even on a robot whose sonars fire in turn.
pub(super) const HEARD: f64 = 3.2;
/// Tolerance of a range, in metres. A sonar may have a resolution of an inch, and need not be mounted exactly on the
/// ring.
const RANGE: f64 = 0.05;
/// Distances from the centre, in metres, of the walls in front of the sonars, all different. Sonars with even numbers
/// have nearer walls than their neighbours, because on some robots a sonar with an even number measures with two
/// transducers. The sequence differs from each of its rotations and reversals, so that the checks detect sonars in a
/// wrong order.
const WALLS: [f64; SONARS] =
    [1.08, 1.71, 0.75, 2.37, 1.41, 1.93, 0.86, 1.60, 1.19, 2.15, 0.97, 2.26, 1.52, 1.82, 1.30, 2.04];
/// Half-widths of the walls, for sonars with even and with odd numbers, per metre of distance. Walls that are this
/// narrow cause no echoes at the neighbouring sonars.
const HALF: [f64; 2] = [0.05, 0.08];
/// Maximum age of a ping, in seconds: a full round of all sonars takes one second.
const OLD: f64 = 2.0;
/// Tolerance of the pose at which a ping was made, in metres and radians.
const THERE: (f64, f64) = (0.06, 0.1);

/// Returns all sixteen sonars.
fn sonars() -> impl Iterator<Item = SonarId> {
    (0..SONARS as u8).map(SonarId::new)
}

/// Returns the last echo of a sonar, as the distance from the centre of the body in metres; `None` if there was no
/// echo.
fn heard<S: Stage>(trial: &Trial<'_, S>, sonar: SonarId) -> Result<Option<f64>, String>
where
    Out<S>: SonarRing,
{
    let newest = trial.y.pings(sonar).newest_first().next();
    let Ping { range, .. } = newest.ok_or_else(|| {
        let number = sonar.number();
        format!(
            "sonar {number} has not pinged in {:.1} s: `pings` of what pinged and heard nothing hold a `None`",
            trial.now().seconds()
        )
    })?;
    Ok(range.map(|range| range.0 + trial.y.ring_radius().0))
}

/// Returns the direction of a sonar, for messages.
fn direction(sonar: SonarId) -> String {
    format!("{:.1} degrees counter-clockwise from the front", sonar.bearing().degrees())
}

pub(super) fn looks_all_round<S: Stage>(stage: &mut S) -> Result<(), Verdict>
where
    Out<S>: SonarRing + DiffDrive,
{
    let walls = || sonars().zip(WALLS);
    let halves = HALF.into_iter().cycle();
    let room = walls()
        .zip(halves)
        .fold(Room::open(), |room, ((sonar, wall), half)| room.across(sonar.bearing().degrees(), wall, half * wall));
    let mut trial = Trial::of(stage, &room)?;
    trial.drive(0.0, 0.0, HEARD)?;
    let mut wrong = Vec::new();
    for (sonar, wall) in walls() {
        let found = heard(&trial, sonar)?;
        if found.is_some_and(|found| (found - wall).abs() <= RANGE) {
            continue;
        }
        let number = sonar.number();
        let what = found.map_or_else(
            || "nothing".into(),
            |found| {
                let other = walls().find(|(_, other)| (found - other).abs() <= RANGE);
                let other =
                    other.map_or_else(String::new, |(other, _)| format!(", as sonar {} should", other.number()));
                format!("something {found:.2} m from the centre{other}")
            },
        );
        wrong.push(format!(
            "sonar {number} hears {what}; {}, where it should look, a wall is {wall} m away",
            direction(sonar)
        ));
    }
    if let [first, ..] = &*wrong {
        let many = if wrong.len() > 1 { format!("; {} of the sixteen are wrong", wrong.len()) } else { String::new() };
        return Err(Verdict::Broken(format!("{first}{many}")));
    }
    for (sonar, wall) in walls() {
        let signal = S::Alphabet::signal("r", &[Argument::Sonar(sonar)]).ok_or(Verdict::NotOffered)?;
        let value = signal.value(&trial.y) + trial.y.ring_radius().0;
        if (value - wall).abs() > RANGE {
            let why = format!("signal `r{}` is not what this sonar heard, in metres from the sonar", sonar.number());
            return Err(Verdict::Broken(why));
        }
    }
    Ok(())
}

pub(super) fn hears_nothing<S: Stage>(stage: &mut S) -> Result<(), Verdict>
where
    Out<S>: SonarRing,
{
    let room = Room::open();
    let mut trial = Trial::of(stage, &room)?;
    trial.drive(0.0, 0.0, HEARD)?;
    let least = room.nearest(AT).0 - 1.0;
    for sonar in sonars() {
        if let Some(found) = heard(&trial, sonar)?.filter(|found| *found < least) {
            let why = format!(
                "sonar {} hears something {found:.2} m away in a hall of {least:.0} m: what a sonar says that heard \
                 nothing is a `None`",
                sonar.number()
            );
            return Err(Verdict::Broken(why));
        }
        let signal = S::Alphabet::signal("r", &[Argument::Sonar(sonar)]);
        if signal.is_some_and(|signal| signal.value(&trial.y) < least) {
            let why = format!("signal `r{}` has to be infinite where nothing is heard", sonar.number());
            return Err(Verdict::Broken(why));
        }
    }
    Ok(())
}

pub(super) fn hears_what_comes<S: Stage>(stage: &mut S) -> Result<(), Verdict>
where
    Out<S>: SonarRing + DiffDrive,
{
    let radius = Trial::of(stage, &Room::open())?.y.body_radius().0;
    let wall = radius + 0.9;
    let mut trial = Trial::of(stage, &Room::open().across(0.0, wall, 1.0))?;
    let front = SonarId::new(0);
    let check = |trial: &Trial<'_, S>, when: &str, off: f64| {
        let away = wall - Way::between(AT, trial.truth()).ahead;
        match heard(trial, front)? {
            Some(found) if (found - away).abs() <= off => Ok(()),
            Some(found) => Err(format!(
                "{when} {away:.2} m before a wall, sonar 0 hears it at {found:.2} m (both from the centre)"
            )),
            None => Err(format!("{when} {away:.2} m before a wall, sonar 0 hears nothing")),
        }
    };
    trial.drive(0.0, 0.0, HEARD)?;
    check(&trial, "standing", RANGE)?;
    // Ranges heard while driving are up to a second old.
    trial.drive(0.2, 0.0, 3.0)?;
    check(&trial, "driving at 0.2 m/s", RANGE + 0.25)?;
    trial.drive(0.0, 0.0, HEARD)?;
    check(&trial, "standing", RANGE)?;
    trial.drive(0.1, 0.0, 5.0)?;
    trial.drive(0.0, 0.0, HEARD)?;
    // At this distance, a sonar may report its minimum range.
    Ok(check(&trial, "in contact", RANGE + 0.25)?)
}

pub(super) fn dates_its_pings<S: Stage>(stage: &mut S) -> Result<(), Verdict>
where
    Out<S>: SonarRing,
{
    let mut trial = Trial::of(stage, &Room::open())?;
    let mut been: Vec<(Nanos, Pose)> = Vec::new();
    been.push((trial.now(), trial.y.here()));
    while trial.now().seconds() < HEARD + 3.0 {
        trial.drive(0.2, 0.4, S::PERIOD.seconds())?;
        been.push((trial.now(), trial.y.here()));
        let (now, reported) = (trial.now(), trial.y.now());
        if now.since(reported).0.max(reported.since(now).0) > S::PERIOD.0 {
            let (now, reported) = (now.seconds(), reported.seconds());
            let why = format!("`now` is {reported:.1} s, and it is {now:.1} s from the first exchange on");
            return Err(Verdict::Broken(why));
        }
        for sonar in sonars() {
            let pings: Vec<&Ping> = trial.y.pings(sonar).newest_first().collect();
            let broken = |what: &str| Verdict::Broken(format!("sonar {}: {what}", sonar.number()));
            if pings.windows(2).any(|two| matches!(two, [newer, older] if newer.at < older.at)) {
                return Err(broken("its newest ping is older than the one behind it"));
            }
            let Some(newest) = pings.first() else { continue };
            if newest.at > trial.now() {
                return Err(broken("its newest ping is of a time to come: count from the first exchange"));
            }
            if trial.now().seconds() > HEARD && trial.now().since(newest.at).seconds() > OLD {
                return Err(broken("its newest ping is more than 2 s old"));
            }
            let near = |time: Nanos| time.since(newest.at).0.max(newest.at.since(time).0) <= S::PERIOD.0;
            let was_there = been.iter().filter(|(time, _)| near(*time)).any(|(_, pose)| {
                let off = Way::between(*pose, newest.pose);
                off.far() <= THERE.0 && off.turn.abs() <= THERE.1
            });
            if !was_there {
                return Err(broken("its newest ping says another pose than the robot then had by odometry"));
            }
        }
    }
    Ok(())
}
