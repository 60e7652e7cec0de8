//! Gains of the laws that depend on the body. For an unknown body, the gains are chosen by its size and its sonars. All
//! other gains are constants beside their laws.

use mdle_runtime::capability::{DiffDrive, SonarRing};
use mdle_runtime::{Meters, PINGS_KEPT};

/// Radius from which a body counts as wide, so that hallways leave it little room to give way.
const WIDE: Meters = Meters(0.3);

/// Parameters of the laws that differ from body to body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Gains {
    /// `align`: maximum turn rate, in rad/s. Where sonars fire in turn, the ranges are older.
    pub(crate) align_fastest: f64,
    /// `align`: maximum difference, in metres, at which ranges count as equal. A difference of 8 mm corresponds to 2°
    /// in a hallway 1.5 m wide, for sonars with a cone of 25°. Where sonars fire in turn, the value is an inch, the
    /// resolution of the paper's sonars: beside a corner, a robot that required a smaller difference would turn into
    /// the corner.
    pub(crate) align_equal: f64,
    /// `align`: time, in seconds, to wait for a sonar that no longer hears the wall: three of its pings if it pings in
    /// every turn, otherwise two rings.
    pub(crate) align_waits: f64,
    /// `goAvoid`: length of the way ahead that should be free. With a longer look-ahead, the robot would turn into a
    /// side way before `atIsection` has confirmed it. Where sonars fire in turn, ranges are up to a second old, and
    /// obstacles may have come nearer since.
    pub(crate) look_ahead: Meters,
    /// `goAvoid`: distance between the body and an obstacle, in metres, at which a way still counts as free. A doorway
    /// 15 cm wider than the body leaves 7.5 cm on both sides, which drift and range errors of 1.5 cm reduce.
    pub(crate) hard_margin: f64,
    /// `goAvoid`: range, in metres, below which an obstacle may be nearer than its range. A Scout reports 6 inches for
    /// anything nearer, so that a wall towards which it drifts looks parallel.
    pub(crate) least_range: f64,
    /// `goAvoid`: distance to keep around the body where there is room, in metres. Where sonars fire in turn,
    /// odometry drifts too, so the robot must keep to the middle of a hallway by its ranges.
    pub(crate) soft_margin: f64,
    /// `goAvoid`: distance along a way, in metres, at which the room beside it is measured. Beside a wall, only the
    /// room ahead distinguishes a way that leads off the wall from one that keeps as close: with the room measured
    /// beside the robot, drift would never be corrected. A wide body that measured it far ahead would turn back before
    /// a gap that it can just pass.
    pub(crate) room_at: f64,
    /// `goAvoid`: distance beyond the end of a way, in metres, within which an obstacle still counts as beside the way.
    /// With 0 the robot comes as near to a wall ahead as the look-ahead permits; a wide body must begin to go round a
    /// box earlier.
    pub(crate) beyond: f64,
    /// `goAvoid`: angle turned since the law began, in radians, from which the robot turns back instead of continuing
    /// in the same direction. Four wheels that skid make an error of 2 % in each turn, with the same sign in all turns
    /// of a run.
    pub(crate) winds_most: f64,
}

/// Gains of a body whose sonars all ping in every turn.
const RING: Gains = Gains {
    align_fastest: 0.3,
    align_equal: 0.008,
    align_waits: 0.3,
    look_ahead: Meters(0.4),
    hard_margin: 0.06,
    least_range: 0.0,
    soft_margin: 0.35,
    room_at: 0.6,
    beyond: 0.0,
    winds_most: f64::INFINITY,
};

/// Gains of a Scout, whose sonars fire one after the other.
const SCOUT: Gains = Gains {
    align_fastest: 0.12,
    align_equal: 0.026,
    align_waits: 2.0,
    look_ahead: Meters(0.5),
    hard_margin: 0.04,
    least_range: 0.16,
    soft_margin: 0.4,
    room_at: 0.6,
    beyond: 0.0,
    winds_most: f64::INFINITY,
};

/// Gains of an ATRV-mini, which is twice as wide. A smaller margin would leave too little room for its corners, and an
/// obstacle heard at 6 inches is within the margin anyway.
const ATRV: Gains = Gains {
    look_ahead: Meters(0.5),
    hard_margin: 0.06,
    least_range: 0.0,
    room_at: 0.3,
    beyond: 0.3,
    winds_most: 1.5 * core::f64::consts::PI,
    ..SCOUT
};

impl Gains {
    /// Returns the gains for the body that reports the output `y`.
    pub(crate) fn of<Y: DiffDrive + SonarRing>(y: &Y) -> &'static Self {
        match (fire_in_turn(y), y.body_radius() >= WIDE) {
            (false, _) => &RING,
            (true, false) => &SCOUT,
            (true, true) => &ATRV,
        }
    }
}

/// Returns `true` if sonars fire one after the other, so that ranges are older.
pub(crate) fn fire_in_turn<Y: SonarRing>(y: &Y) -> bool {
    y.confirmation() < PINGS_KEPT
}
