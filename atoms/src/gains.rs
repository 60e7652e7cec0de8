//! Contains the gains of the laws that depend on the body. They are chosen by the size and the sonars of the body. All
//! other gains are constants in the modules of their laws.

use mdle_runtime::capability::{DiffDrive, SonarRing};
use mdle_runtime::{Meters, PINGS_KEPT};

/// Radius from which a body is treated as wide: in hallways, it has little room to give way.
const WIDE: Meters = Meters(0.3);

/// Factor of the cost of a cell on the map of `goAvoid`, for each class of cells.
pub(crate) type Factors = [u16; 8];

/// Weights of the evidence on the map of `goAvoid`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Evidence {
    /// Amount by which an echo increases the evidence of a cell.
    pub(crate) hit: u8,
    /// Maximum amount by which the evidence of a cell may be below that of the cell with the most evidence on the arc
    /// of an echo, if the echo increases it.
    pub(crate) below: u8,
    /// Distance, in metres, up to which a ping passes the cells at the edges of its cone. A jamb further away may be
    /// there without an echo.
    pub(crate) edges: f64,
}

/// Parameters of the laws that differ from body to body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Gains {
    /// `align`: maximum turn rate, in rad/s. It is lower where sonars fire in turn, because the ranges are older there.
    pub(crate) align_fastest: f64,
    /// `align`: maximum difference, in metres, at which ranges are treated as equal. A difference of 8 mm corresponds
    /// to 2° in a hallway 1.5 m wide, for sonars with a cone of 25°. Where sonars fire in turn, the value is an inch,
    /// the resolution of the paper's sonars: beside a corner, a robot that required a smaller difference would turn
    /// into the corner.
    pub(crate) align_equal: f64,
    /// `align`: time, in seconds, to wait for a sonar that no longer receives an echo of the wall. It is the time of
    /// three pings if the sonar pings in every turn, and otherwise the time in which all sonars ping twice.
    pub(crate) align_waits: f64,
    /// `goAvoid`: length of the way ahead that should be free. With a longer look-ahead, the robot would turn into a
    /// side corridor before `atIsection` has confirmed it. Where sonars fire in turn, ranges are up to a second old,
    /// and obstacles may have come nearer in the meantime.
    pub(crate) look_ahead: Meters,
    /// `goAvoid`: distance between the body and an obstacle, in metres, at which a way is still treated as free. A
    /// doorway 15 cm wider than the body leaves 7.5 cm on each side, from which drift and range errors of 1.5 cm have
    /// to be subtracted.
    pub(crate) hard_margin: f64,
    /// `goAvoid`: range, in metres, below which an obstacle may be nearer than its range. A Scout reports 6 inches for
    /// every nearer obstacle, so that a wall towards which it drifts seems to be parallel to its way.
    pub(crate) least_range: f64,
    /// `goAvoid`: range, in metres, below which an echo may have the minimum range of its transducer. Such echoes show
    /// neither how near a wall is nor which part of it is nearest. An ATRV-mini's transducers have a minimum range of 6
    /// inches and are not on its ring, from which these echoes therefore have ranges of up to 17.2 cm.
    pub(crate) saturates: f64,
    /// `goAvoid`: distance to keep around the body where there is room, in metres. Where sonars fire in turn,
    /// odometry drifts too, so the robot must keep to the middle of a hallway by its ranges.
    pub(crate) soft_margin: f64,
    /// `goAvoid`: distance along a way, in metres, at which the room beside it is measured if the way is not free for
    /// long. A wide body that measured the room too far ahead would turn back before a gap that it can just pass.
    pub(crate) room_at: f64,
    /// `goAvoid`: distance beyond the end of a way, in metres, within which an obstacle is still treated as beside the
    /// way. With 0, the robot comes as near to a wall ahead as the look-ahead permits. A wide body has a larger value,
    /// because it must begin earlier to go round a box.
    pub(crate) beyond: f64,
    /// `goAvoid`: `true` if a remembered echo is an obstacle only while the map has an occupied cell beside it. An
    /// echo is remembered on the axis of its sonar, up to 20 cm off the object, so that the echoes of both sides of a
    /// passage 1.2 m wide close it for a wide body. A small body still passes, and it needs the ends of walls, which
    /// its sonars detect from few directions only.
    pub(crate) confirms_memory: bool,
    /// `goAvoid`: room around the body, in metres, below which a place is narrow. A robot all of whose sonars ping in
    /// every turn hears nearly everything around it. Its map is coarse, but shows the end of a wall between two sonars.
    pub(crate) room: f64,
    /// `goAvoid`: weights of the evidence on the map. An echo of a jamb may come from anywhere on an arc that reaches
    /// up to 20 cm into the doorway. With the weights of the other bodies, further echoes increase the evidence of
    /// cells again that pings have passed, and doorways become too narrow for a Scout. ATRV-minis touched jambs more
    /// often with the weights of a Scout, and ideal robots touched boxes.
    pub(crate) evidence: Evidence,
    /// `goAvoid`: factors of the costs of cells on the map. A Scout passes a doorway 15 cm wider than itself in cells
    /// of the classes 1 to 3, and an ATRV-mini passes a doorway of 0.9 m in cells of the class 4. With the factors of
    /// an ideal robot, such a doorway in a wall 10 cm thick costs more than several metres elsewhere, and robots drove
    /// along the wall instead. ATRV-minis touched furniture more often with the factors of a Scout.
    pub(crate) factors: Factors,
    /// `goAvoid`: cost of a movement, in metres, per metre by which it brings the body nearer than 8 cm to an
    /// obstacle that is too near to be measured. On the map, such an obstacle may be 5 cm further away than it is. With
    /// the value of a Scout, ATRV-minis touched furniture more often; with theirs, fewer Scouts passed doorways in
    /// thick walls.
    pub(crate) too_near_costs: f64,
    /// `goAvoid`: cost of a movement, in metres, per metre by which it brings the body nearer than 8 cm to a doubtful
    /// cell of the map. Without it, 126 of 11400 Scouts touched a jamb of a doorway 15 cm wider than they are; now 72
    /// do. ATRV-minis touch as many jambs with it as without, and arrive less often.
    pub(crate) doubt_costs: f64,
    /// `goAvoid`: angle turned since the law began, in radians, from which the robot turns back instead of continuing
    /// in the same direction. On a body with four skidding wheels, odometry has an error of 2 % of each turn, with the
    /// same sign in all turns of a run.
    pub(crate) winds_most: f64,
}

/// Weights of the evidence of all bodies except a Scout.
const EVIDENCE: Evidence = Evidence { hit: 4, below: 2, edges: f64::INFINITY };

/// Gains of a body whose sonars all ping in every turn.
const RING: Gains = Gains {
    align_fastest: 0.3,
    align_equal: 0.008,
    align_waits: 0.3,
    look_ahead: Meters(0.4),
    hard_margin: 0.06,
    least_range: 0.0,
    saturates: 0.0,
    soft_margin: 0.35,
    room_at: 0.6,
    beyond: 0.0,
    confirms_memory: false,
    room: 0.04,
    evidence: EVIDENCE,
    factors: [0, 10, 6, 5, 4, 4, 2, 1],
    too_near_costs: 3.0,
    doubt_costs: 0.0,
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
    saturates: 0.0,
    soft_margin: 0.4,
    room_at: 0.6,
    beyond: 0.0,
    confirms_memory: false,
    room: 0.1,
    evidence: Evidence { hit: 2, below: 0, edges: 0.6 },
    factors: [0, 4, 3, 3, 3, 3, 2, 1],
    too_near_costs: 3.0,
    doubt_costs: 3.0,
    winds_most: f64::INFINITY,
};

/// Gains of an ATRV-mini, which is twice as wide as a Scout. A smaller margin would leave too little room for its
/// corners, and an obstacle at the minimum range of 6 inches is within the margin anyway.
const ATRV: Gains = Gains {
    look_ahead: Meters(0.5),
    hard_margin: 0.06,
    least_range: 0.0,
    saturates: 0.175,
    room_at: 0.3,
    beyond: 0.3,
    confirms_memory: true,
    evidence: EVIDENCE,
    factors: [0, 10, 6, 4, 3, 2, 2, 1],
    too_near_costs: 6.0,
    doubt_costs: 0.0,
    winds_most: 1.5 * core::f64::consts::PI,
    ..SCOUT
};

impl Gains {
    /// Returns the gains for the body of the robot with the output `y`.
    pub(crate) fn of<Y: DiffDrive + SonarRing>(y: &Y) -> &'static Self {
        match (fire_in_turn(y), y.body_radius() >= WIDE) {
            (false, _) => &RING,
            (true, false) => &SCOUT,
            (true, true) => &ATRV,
        }
    }
}

/// Returns `true` if sonars fire one after the other. Their ranges are then older.
pub(crate) fn fire_in_turn<Y: SonarRing>(y: &Y) -> bool {
    y.confirmation() < PINGS_KEPT
}
