//! Worlds through which a body can barely pass: doorways, boxes in a hallway, corners, and random rooms; also the
//! simulator's own worlds.

use mdle_sim::{Body, Point, World};

use crate::chance::Chance;

/// A world to cross, and the destination.
pub(crate) struct Crossing {
    pub(crate) world: World,
    pub(crate) to: Point,
}

/// Returns the width on which the widths of passages are based, in metres: the diameter of a Scout, or the shorter side
/// of an ATRV-mini.
pub(crate) fn width(body: Body) -> f64 {
    match body {
        Body::Ideal | Body::Scout => 0.41,
        Body::Atrv => 0.54,
    }
}

/// Returns a world with these outlines, a start near the origin, and a goal `far` metres along the first axis.
fn ahead(seed: u64, far: f64, outlines: &str) -> Crossing {
    let mut chance = Chance::new(seed);
    let (y, heading) = (chance.within(0.05), chance.within(5.0));
    let text = format!("start = {{ y = {y}, heading = {heading} }}\n{outlines}");
    Crossing { world: World::parse("a test's world", &text).expect("a good world"), to: Point { x: far, y } }
}

/// Returns a hallway of this width along the first axis, closed at its ends.
fn hallway(width: f64) -> String {
    let half = width / 2.0;
    format!("[[wall]]\npoints = [[-1, {half}], [9, {half}], [9, -{half}], [-1, -{half}], [-1, {half}]]\n")
}

/// Returns a doorway across a hallway, 15 cm wider than the body and up to 30 cm off the middle.
pub(crate) fn doorway(body: Body, seed: u64) -> Crossing {
    let off = Chance::new(seed ^ 0xd00).within(0.3);
    let half = (width(body) + 0.15) / 2.0;
    let (wide, left, right) = (2.5, off + half, off - half);
    let jambs = format!("[[wall]]\npoints = [[3, {left}], [3, 1.25]]\n[[wall]]\npoints = [[3, {right}], [3, -1.25]]");
    ahead(seed, 6.0, &[hallway(wide), jambs].concat())
}

/// Returns a doorway, 15 cm wider than the body and up to 30 cm off the robot's way, in a wall 3 to 15 cm thick across
/// a room that is 6 m wide.
pub(crate) fn thick(body: Body, seed: u64) -> Crossing {
    let mut chance = Chance::new(seed ^ 0x7c);
    let off = chance.within(0.3);
    let (half, to) = ((width(body) + 0.15) / 2.0, 3.03 + 0.12 * chance.unit());
    let around = "[[wall]]\npoints = [[-1, -3], [7, -3], [7, 3], [-1, 3], [-1, -3]]\n";
    let jamb = |side: f64| {
        let (jamb, end) = (off + side * half, 3.0 * side);
        format!("[[wall]]\npoints = [[3, {end}], [3, {jamb}], [{to}, {jamb}], [{to}, {end}]]\n")
    };
    ahead(seed, 6.0, &[around, &jamb(1.0), &jamb(-1.0)].concat())
}

/// Returns a box in the middle of a hallway, with a gap on both sides that is 25 cm wider than the body.
pub(crate) fn middle(body: Body, seed: u64) -> Crossing {
    let side = 0.3 + 0.2 * Chance::new(seed ^ 0xb0c).unit();
    let wide = side + 2.0 * (width(body) + 0.25);
    let block = format!("[[box]]\ncentre = [3, 0]\nsize = [{side}, {side}]");
    ahead(seed, 6.0, &[hallway(wide), block].concat())
}

/// Returns a start 2 to 12 cm beside a wall that runs along the robot, and a goal in any direction on the free side of
/// the wall.
pub(crate) fn beside(body: Body, seed: u64) -> Crossing {
    let mut chance = Chance::new(seed ^ 0xbe5);
    let side = if chance.unit() < 0.5 { 1.0 } else { -1.0 };
    let (wall, far) = (-side * (width(body) / 2.0 + 0.02 + 0.1 * chance.unit()), 4.0 * side);
    let (sin, cos) = libm::sincos(core::f64::consts::PI * chance.unit());
    let text = format!("[[wall]]\npoints = [[-5, {wall}], [5, {wall}], [5, {far}], [-5, {far}], [-5, {wall}]]");
    let to = Point { x: 2.5 * cos, y: 2.5 * side * sin };
    Crossing { world: World::parse("a wall beside the start", &text).expect("a good world"), to }
}

/// Returns a U-shaped wall across the path, open towards the start and up to 1.5 m deep.
pub(crate) fn corner(body: Body, seed: u64) -> Crossing {
    let mut chance = Chance::new(seed ^ 0xc0);
    let (depth, half) = (0.5 + chance.unit(), width(body) / 2.0 + 0.5 + 0.4 * chance.unit());
    let mouth = 4.0 - depth;
    let around = "[[wall]]\npoints = [[-2, -4], [10, -4], [10, 4], [-2, 4], [-2, -4]]\n";
    let pocket = format!("[[wall]]\npoints = [[{mouth}, {half}], [4, {half}], [4, -{half}], [{mouth}, -{half}]]");
    ahead(seed, 7.0, &[around, &pocket].concat())
}

/// Returns the world `room`, with a destination 7 m from the start along the start heading.
pub(crate) fn room(_: Body, seed: u64) -> Crossing {
    let mut world = World::named("room").expect("a world").expect("a good world");
    let mut chance = Chance::new(seed);
    let far = 7.0 * libm::cos(world.start.theta.0);
    let to = Point { x: world.start.x.0 + far, y: world.start.y.0 + far };
    world.start.theta.0 += chance.within(5.0_f64.to_radians());
    Crossing { world, to }
}

/// Returns the world `hall`, with a path past the walker from the start to the other end.
pub(crate) fn hall(_: Body, seed: u64) -> Crossing {
    let mut world = World::named("hall").expect("a world").expect("a good world");
    let mut chance = Chance::new(seed);
    world.start.x.0 += 1.5 * chance.unit();
    world.start.y.0 += chance.within(0.5);
    Crossing { to: Point { x: 14.5, y: world.start.y.0 }, world }
}

/// Returns an open floor with a person who walks straight across the way, 3 m from the origin, at 0.5 to 1.2 m/s. The
/// person is on the way when a robot that does not react is between 1 m before the person and 1.5 m beyond.
pub(crate) fn lane(_: Body, seed: u64) -> Crossing {
    past_a_person(seed, "", 0.0, |passed| 7.0 + passed.max(0.0))
}

/// Returns the floor of [`lane`], with a rough wall across the way behind the person, and the goal before this wall.
pub(crate) fn corridor(_: Body, seed: u64) -> Crossing {
    past_a_person(seed, "[[wall]]\nrough = 1\npoints = [[4.6, -9], [4.6, 9]]\n", 0.0, |_| 3.9)
}

/// Returns the floor of [`lane`] with a person whose way crosses that of the robot at 45°, against it.
pub(crate) fn slanting(_: Body, seed: u64) -> Crossing {
    past_a_person(seed, "", 1.0, |passed| 7.0 + passed.max(0.0))
}

/// Returns the floor of [`lane`] with these walls and a goal at this distance along the first axis. The distance
/// depends on where, in metres beyond the person, a robot would be that does not react. For each metre across the
/// robot's way, the person walks `slant` metres against it.
fn past_a_person(seed: u64, walls: &str, slant: f64, far_to: impl Fn(f64) -> f64) -> Crossing {
    let mut chance = Chance::new(seed ^ 0x1a);
    let speed = [0.5, 0.8, 1.0, 1.2][(seed / 2 % 4) as usize];
    let (far, passed) = (7.5, 0.25 + chance.within(1.25));
    let from = if seed.is_multiple_of(2) { far } else { -far };
    let (half, along) = (far * libm::hypot(1.0, slant) / speed, far * slant);
    let (x, y, heading) = (3.0 + passed - 0.2 * half, chance.within(0.1), chance.within(5.0));
    let schedule = format!("[[0, {}, {from}], [{}, {}, {}]]", 3.0 + along, 2.0 * half, 3.0 - along, -from);
    let start = format!("start = {{ x = {x}, y = {y}, heading = {heading} }}\n");
    let text = format!("{start}{walls}[[disc]]\nradius = 0.25\nschedule = {schedule}");
    let world = World::parse("a test's world", &text).expect("a good world");
    Crossing { world, to: Point { x: far_to(passed), y: 0.0 } }
}

/// Returns a random room whose gaps are 15 cm wider than the body.
pub(crate) fn random(body: Body, seed: u64) -> Crossing {
    let world = crate::room::room(seed, width(body) + 0.15);
    Crossing { world, to: Point { x: 7.0, y: 7.0 } }
}

/// Returns the world `maze`, with a path through its first passages, from the start to the first corner.
pub(crate) fn maze(_: Body, seed: u64) -> Crossing {
    let mut world = World::named("maze").expect("a world").expect("a good world");
    let mut chance = Chance::new(seed);
    world.start.x.0 += chance.within(0.05);
    world.start.theta.0 = core::f64::consts::FRAC_PI_2 + chance.within(0.1);
    Crossing { to: Point { x: 1.8, y: 4.2 }, world }
}

/// Returns the world `maze`, with a start in the lower row that faces up, and a goal in the upper left corner, which is
/// 7 m off.
pub(crate) fn whole_maze(_: Body, seed: u64) -> Crossing {
    let mut world = World::named("maze").expect("a world").expect("a good world");
    let mut chance = Chance::new(seed ^ 0x3a);
    world.start.x.0 = 4.2 + chance.within(0.1);
    world.start.y.0 = 0.6 + chance.within(0.1);
    world.start.theta.0 = core::f64::consts::FRAC_PI_2 + chance.within(0.087);
    let to = Point { x: world.start.x.0 - 3.5, y: world.start.y.0 + 6.06 };
    Crossing { world, to }
}
