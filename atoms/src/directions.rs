//! Finds the echoes that a robot has received from its four directions, regardless of the sonar that faced in each
//! direction.

use mdle_runtime::capability::SonarRing;
use mdle_runtime::{Meters, Nanos, Ping, Radians, SONARS, SonarId};

/// The sonars front, left, back and right, in the order in which the bits are written.
pub(crate) const DIRECTIONS: [SonarId; 4] = [SonarId::new(0), SonarId::new(4), SonarId::new(8), SonarId::new(12)];

/// The sonar in whose direction the robot drives.
pub(crate) const AHEAD: SonarId = SonarId::new(0);

/// Maximum angle between a direction and the axis of a ping that is used for it. It is a little more than half the
/// angle between two sonars, so that a slowly turning robot always has a sonar in each direction.
const WITHIN: Radians = Radians::from_degrees(14.0);
/// Difference, in metres, below which two ranges of one sonar are treated as echoes of the same object, and not as
/// random errors.
const SAME: f64 = 0.1;

/// Minimum distance, in metres, between a stray echo and the echoes before and after it.
const STRAY: f64 = 1.0;

/// Time between two pings of different sonars below which both belong to one ring. A Scout's ring takes 0.96 s, and
/// adjacent sonars follow each other after 0.06 s.
const ONE_LOOK: Nanos = Nanos(500_000_000);
/// Minimum angle that a robot has turned since a ping if it turns fast. At 0.36 rad/s, as in the paper's plans, a Scout
/// turns by 20° while each of its sonars pings.
const TURNED: Radians = Radians::from_degrees(28.0);
/// Half the angle of the cone in which a sonar receives echoes of a rough wall.
pub(crate) const CONE: Radians = Radians::from_degrees(12.5);
/// Maximum distance, in metres, between a wall and the edge of a cone at which the cone is treated as reaching the
/// wall.
const OF_WALL: f64 = 0.08;
/// Factor and offset, in metres, by which the ranges of a sonar's neighbours may exceed its own range along a
/// straight wall; an echo from beyond an opening is further away.
const SLANT: (f64, f64) = (1.08, 0.02);

/// Returns the minimum range of the newest pings in the present direction of a sonar; infinite if none of them had an
/// echo. These are two pings, or three if the two were [one look](is_one_look).
///
/// `None` if there were too few pings in that direction: a single ping with a near echo is enough, but a single ping
/// without a near echo does not make the direction free. Also `None` while a near echo from ahead may be
/// [stray](is_stray).
pub(crate) fn towards<Y: SonarRing>(y: &Y, direction: SonarId) -> Option<Meters> {
    let newest: [_; 3] = newest(y, direction, |sonar, ping| !is_of_side(y, direction, sonar, ping));
    let [first, second, _] = newest;
    let is_one_look = first.zip(second).is_some_and(|(one, other)| is_one_look(y, direction, one, other));
    let confirming = if is_one_look { newest } else { [first, second, second] };
    let nearest = nearest(confirming);
    match nearest.filter(|range| *range < y.blocked_within()) {
        Some(near) => (direction != AHEAD || !is_stray(newest, near)).then_some(near),
        None => confirming[2].map(|_| overheard(y, direction).or(nearest).unwrap_or(Meters(f64::INFINITY))),
    }
}

/// Returns `true` if the range `near` may be a random error, since the other two of these pings received echoes from
/// much further away. Before a driving robot, walls come nearer by a few centimetres from ping to ping; beside it,
/// they begin suddenly.
fn is_stray(pings: [Option<(SonarId, &Ping)>; 3], near: Meters) -> bool {
    let far = |ping: &(SonarId, &Ping)| ping.1.range.is_some_and(|range| range.0 > near.0 + STRAY);
    pings.iter().flatten().filter(|ping| far(ping)).count() == 2
}

/// Returns `true` if two pings in a direction are one look: a robot that turns fast has passed the direction with two
/// adjacent sonars in one ring, and has turned on since. If one of the pings is wrong, the other alone would free the
/// direction.
fn is_one_look<Y: SonarRing>(y: &Y, direction: SonarId, one: (SonarId, &Ping), other: (SonarId, &Ping)) -> bool {
    let is_of_ring = one.1.at.since(other.1.at) < ONE_LOOK;
    let Radians(turned) = Radians(y.here().theta.0 - one.1.pose.theta.0).wrapped();
    let is_of_direction = one.0 == direction || other.0 == direction;
    one.0 != other.0 && !is_of_direction && is_of_ring && turned.abs() > TURNED.0
}

/// Returns the newest pings, newest first, that were made in the present direction of the sonar `direction` and for
/// which `counts` returns `true`.
pub(crate) fn newest<Y: SonarRing, const N: usize>(
    y: &Y,
    direction: SonarId,
    counts: impl Fn(SonarId, &Ping) -> bool,
) -> [Option<(SonarId, &Ping)>; N] {
    let mut newest: [Option<(SonarId, &Ping)>; N] = [None; N];
    for number in 0..SONARS as u8 {
        let sonar = SonarId::new(number);
        let is_there = |ping: &&Ping| looked_there(y, direction, sonar, ping) && counts(sonar, ping);
        for ping in y.pings(sonar).newest_first().filter(is_there) {
            let mut older = (sonar, ping);
            for place in &mut newest {
                match place {
                    Some(known) if known.1.at >= older.1.at => {}
                    Some(known) => core::mem::swap(known, &mut older),
                    None => {
                        *place = Some(older);
                        break;
                    }
                }
            }
        }
    }
    newest
}

/// Returns `true` if this ping of `sonar` was in the present direction of the sonar `direction`, and its echo, if it
/// had one, still lies in that direction. The echo of a door post that the robot has passed no longer lies there.
fn looked_there<Y: SonarRing>(y: &Y, direction: SonarId, sonar: SonarId, ping: &Ping) -> bool {
    let here = y.here();
    let axis = Radians(ping.pose.theta.0 + sonar.bearing().0);
    let is_within = |angle: f64| Radians(angle - here.theta.0 - direction.bearing().0).wrapped().0.abs() <= WITHIN.0;
    let Some(range) = ping.range.filter(|_| sonar != direction) else { return is_within(axis.0) };
    let place = ping.pose.towards(axis, Meters(y.ring_radius().0 + range.0));
    is_within(axis.0) && is_within(libm::atan2(place.y.0 - here.y.0, place.x.0 - here.x.0))
}

/// Returns the angle from the present direction of the sonar `direction` to the axis of this ping of `sonar`.
pub(crate) fn off<Y: SonarRing>(y: &Y, direction: SonarId, sonar: SonarId, ping: &Ping) -> Radians {
    Radians(ping.pose.theta.0 + sonar.bearing().0 - y.here().theta.0 - direction.bearing().0).wrapped()
}

/// Returns `true` if the near echo of this ping may come from a wall that runs along the way in `direction`: the ping
/// faced to the side of that wall, and the edge of its cone reaches the wall. A rough wall along the way causes such
/// echoes without blocking the way.
fn is_of_side<Y: SonarRing>(y: &Y, direction: SonarId, sonar: SonarId, ping: &Ping) -> bool {
    let Some(range) = ping.range.filter(|range| *range < y.blocked_within()) else { return false };
    let (Radians(off), here) = (off(y, direction, sonar, ping), y.here());
    let side = after(direction, if off < 0.0 { 12 } else { 4 });
    let Some(wall) = nearest(newest::<_, 2>(y, side, |_, _| true)) else { return false };
    let axis = ping.pose.theta.0 + sonar.bearing().0;
    let transducer = ping.pose.towards(Radians(axis), y.ring_radius());
    let edge = transducer.towards(Radians(axis + libm::copysign(CONE.0, off)), range);
    let (sin, cos) = libm::sincos(here.theta.0 + side.bearing().0);
    let to_side = (edge.x.0 - here.x.0) * cos + (edge.y.0 - here.y.0) * sin;
    to_side > y.ring_radius().0 + wall.0 - OF_WALL
}

/// Returns the sonar that is `further` positions counter-clockwise of `sonar` on the ring.
pub(crate) fn after(sonar: SonarId, further: usize) -> SonarId {
    SonarId::new(((sonar.number() + further) % SONARS) as u8)
}

/// Returns the minimum range of these pings; `None` if none of them had an echo.
fn nearest<const N: usize>(pings: [Option<(SonarId, &Ping)>; N]) -> Option<Meters> {
    let heard = pings.into_iter().flatten().filter_map(|(_, ping)| ping.range);
    heard.reduce(|one, other| if other < one { other } else { one })
}

/// Returns the range of a wall that the third-last ping of a sonar shows and its last two pings do not. The last two
/// pings may have missed the wall or measured a wrong range, or the sonar may have turned past the wall. Therefore both
/// neighbours of the sonar must have received an echo of the wall lately, and no echo from further away.
fn overheard<Y: SonarRing>(y: &Y, sonar: SonarId) -> Option<Meters> {
    let [new, old, before] = [0, 1, 2].map(|number| y.pings(sonar).newest_first().nth(number)?.range);
    let before = before.filter(|range| *range < y.blocked_within())?;
    if new.zip(old).is_some_and(|(new, old)| (new.0 - old.0).abs() < SAME) {
        return None;
    }
    let most = SLANT.0 * before.0 + SLANT.1;
    let hears = |further: u8| {
        let beside = SonarId::new(sonar.number() as u8 + further);
        let mut ranges = y.pings(beside).newest_first().take(2).filter_map(|ping| ping.range).peekable();
        ranges.peek().is_some() && ranges.all(|range| range.0 < most)
    };
    (hears(1) && hears(SONARS as u8 - 1)).then_some(before)
}
