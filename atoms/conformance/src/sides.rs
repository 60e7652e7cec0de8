//! Checks that `atIsection` assigns each of its four bits to the correct side of the robot.

use std::format;

use mdle_runtime::capability::{DiffDrive, SonarRing};
use mdle_runtime::{Alphabet, Argument, Interrupt as _};

use super::ring::HEARD;
use super::trial::Trial;
use super::{Out, Room, Stage, Verdict};

/// Distance of a wall that blocks a side, as a fraction of the range below which an obstacle blocks a side.
const NEAR: f64 = 0.6;
/// Distance of a wall that does not block a side, as a multiple of the range below which an obstacle blocks a side.
const FREE: f64 = 1.4;
/// Half the length of the walls, in metres.
const HALF: f64 = 0.8;

pub(super) fn at_isection<S: Stage>(stage: &mut S) -> Result<(), Verdict>
where
    Out<S>: SonarRing + DiffDrive,
{
    for walls in [[false; 4], [true; 4], side(0), side(1), side(2), side(3)] {
        tells(stage, walls)?;
    }
    Ok(())
}

/// Returns the pattern that has a wall only on the side with this number.
fn side(number: usize) -> [bool; 4] {
    core::array::from_fn(|other| other == number)
}

/// Returns the bits as a word, as plans write them.
fn word(bits: [bool; 4]) -> String {
    bits.iter().map(|bit| if *bit { '1' } else { '0' }).collect()
}

/// Checks that, among the 16 patterns of `atIsection`, only the pattern of these walls fires.
fn tells<S: Stage>(stage: &mut S, walls: [bool; 4]) -> Result<(), Verdict>
where
    Out<S>: SonarRing + DiffDrive,
{
    let y = Trial::of(stage, &Room::open())?.y;
    let room = walls.iter().zip([0.0, 90.0, 180.0, 270.0]).fold(Room::open(), |room, (is_near, degrees)| {
        let part = if *is_near { NEAR } else { FREE };
        room.across(degrees, y.ring_radius().0 + part * y.blocked_within().0, HALF)
    });
    let mut trial = Trial::of(stage, &room)?;
    trial.drive(0.0, 0.0, HEARD)?;
    for number in 0..16 {
        let bits = core::array::from_fn(|bit| number & (8 >> bit) != 0);
        let interrupt = S::Alphabet::interrupt("atIsection", &[Argument::Bits(&bits)]).ok_or(Verdict::NotOffered)?;
        if interrupt.fired(&trial.y) != (bits == walls) {
            let fires = if bits == walls { "does not fire" } else { "fires" };
            let (bits, walls) = (word(bits), word(walls));
            let why = format!("with walls front, left, back, right as in {walls}, `atIsection {bits}` {fires}");
            return Err(Verdict::Broken(why));
        }
    }
    Ok(())
}
