//! Creates random rooms with convex obstacles, with gaps wide enough for the robot, and runs `goAvoid` in them.

use std::fmt::Write;
use std::time::Duration;

use mdle_runtime::capability::Bumpers;
use mdle_runtime::{
    Begin, Completes, Control, Frame, Law, Meters, MetersPerSecond, Nanos, Output, Pose, Radians, Robot, Twist,
};
use mdle_sim::alphabet::GoAvoid;
use mdle_sim::{Make, Point, Simulated, World};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

/// Side length of a room, in metres.
const SIDE: f64 = 8.0;
/// Number of turns in a minute.
const MINUTE: u64 = 600;

/// Outcome of a run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Outcome {
    /// The run arrived without contact.
    Clean,
    /// The robot touched something this many times, whether it arrived or not.
    Touched(u32),
    /// The robot touched nothing, but did not arrive in time.
    TimedOut,
}

/// Returns a room with a dozen boxes and discs between the start (lower left) and the upper right corner, at least
/// `gap` metres apart from each other and from the walls.
pub(crate) fn room(seed: u64, gap: f64) -> World {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut uniform =
        |least: f64, most: f64| least + (most - least) * ((random.next_u64() >> 11) as f64 / (1_u64 << 53) as f64);
    let mut text = format!("start = {{ x = 1, y = 1, heading = {} }}\n", uniform(-180.0, 180.0));
    writeln!(text, "[[wall]]\npoints = [[0, 0], [{SIDE}, 0], [{SIDE}, {SIDE}], [0, {SIDE}], [0, 0]]")
        .expect("a string");
    // Occupied rectangles; for the gaps, a disc counts as its bounding square.
    let mut taken: Vec<[f64; 4]> = vec![[0.9, 0.9, 1.1, 1.1], [6.9, 6.9, 7.1, 7.1]];
    for _ in 0..2000 {
        if taken.len() == 14 {
            break;
        }
        let is_disc = uniform(0.0, 1.0) < 0.4;
        let (w, h) = (uniform(0.1, 0.6), uniform(0.1, 0.6));
        let (w, h) = if is_disc { (w, w) } else { (w, h) };
        let (x, y) = (uniform(gap + w, SIDE - gap - w), uniform(gap + h, SIDE - gap - h));
        let apart = |other: &[f64; 4]| {
            let dx = (other[0] - (x + w)).max((x - w) - other[2]).max(0.0);
            let dy = (other[1] - (y + h)).max((y - h) - other[3]).max(0.0);
            libm::hypot(dx, dy)
        };
        if taken.iter().any(|other| apart(other) < gap) {
            continue;
        }
        taken.push([x - w, y - h, x + w, y + h]);
        if is_disc {
            writeln!(text, "[[disc]]\ncentre = [{x}, {y}]\nradius = {w}").expect("a string");
        } else {
            writeln!(text, "[[box]]\ncentre = [{x}, {y}]\nsize = [{}, {}]", 2.0 * w, 2.0 * h).expect("a string");
        }
    }
    World::parse("a random room", &text).expect("a good room")
}

/// Returns the whole number in the environment variable `name`; `usual` if the variable is not set.
pub(crate) fn number(name: &str, usual: u64) -> u64 {
    std::env::var(name).map_or(usual, |text| text.parse().expect("a whole number"))
}

/// Drives to a place in `world`. A run fails after this number of minutes, or after `MDLE_MINUTES`.
pub(crate) fn drive(make: &Make, world: &World, to: Point, minutes: u64) -> Outcome {
    let period = Duration::from_millis(100);
    let mut robot = Simulated::with(make, world, world.start, period).expect("a start on the floor");
    let (mut input, mut law) = (Twist::default(), None);
    let (mut contacts, mut touched) = (0, false);
    let Pose { x, y, theta } = world.start;
    let bearing = libm::atan2(to.y - y.0, to.x - x.0) - theta.0;
    let range = libm::hypot(to.x - x.0, to.y - y.0);
    for turn in 0..MINUTE * number("MDLE_MINUTES", minutes) {
        let y = robot.exchange(&input).expect("finite inputs");
        let t = Nanos(turn * 100_000_000);
        contacts += u32::from(y.pressed() && !touched);
        touched = y.pressed();
        let quark = GoAvoid::new(Radians(bearing), Meters(range), MetersPerSecond(0.2));
        let law = law.get_or_insert_with(|| quark.begin(&y, Begin { now: t, frame: Frame(y.here().theta) }));
        if law.completed(&y, t) {
            return if contacts == 0 { Outcome::Clean } else { Outcome::Touched(contacts) };
        }
        input = law.input(&y, t);
    }
    if contacts == 0 { Outcome::TimedOut } else { Outcome::Touched(contacts) }
}
