//! Tests collisions with the walker in the world `hall`: a robot that collides would also have collided if it had
//! stopped shortly before.

use std::time::Duration;

use mdle_runtime::capability::Bumpers as _;
use mdle_runtime::{
    Begin, Completes as _, Control as _, Frame, Law as _, Meters, MetersPerSecond, Nanos, Output as _, Radians,
    Robot as _, Twist,
};
use mdle_sim::alphabet::GoAvoid;
use mdle_sim::{Body, Make, Point, Simulated};

use crate::room::number;
use crate::worlds::{Crossing, hall};

const PERIOD: Duration = Duration::from_millis(100);
/// Number of turns after which a run counts as failed: three minutes.
const TURNS: u64 = 1800;
/// Number of turns after the contact for which a stationary robot is observed; by then the walker has passed.
const PASSED: u64 = 50;
/// Start and radius of the walker, in metres, as in the world.
const WALKER: (Point, f64) = (Point { x: 8.0, y: 1.0 }, 0.25);

/// Returns `true` if the obstacle that the robot's bumper reports is the walker.
fn is_walker(robot: &Simulated) -> bool {
    // The only other moving object of the world is a door.
    let Some(Some(gone)) = robot.gone().next() else { return false };
    let (pose, radius) = (robot.pose(), robot.footprint().form.radius());
    let (dx, dy) = (WALKER.0.x + gone.x - pose.x.0, WALKER.0.y + gone.y - pose.y.0);
    libm::hypot(dx, dy) < radius + WALKER.1 + 0.03
}

/// Drives across the hall, and stops from turn `stands` on. Returns the turn in which the robot collides with the
/// walker; `None` if it does not collide.
fn meets(body: Body, seed: u64, stands: u64) -> Option<u64> {
    crosses(body, seed, stands, &hall(body, seed))
}

/// Drives through a given world, as [`meets`] does through the hall.
fn crosses(body: Body, seed: u64, stands: u64, Crossing { world, to }: &Crossing) -> Option<u64> {
    let make = Make { body, seed: (body != Body::Ideal).then_some(seed), ..Make::default() };
    let mut robot = Simulated::with(&make, world, world.start, PERIOD).expect("a start on the floor");
    let range = libm::hypot(to.x - world.start.x.0, to.y - world.start.y.0);
    let bearing = libm::atan2(to.y - world.start.y.0, to.x - world.start.x.0) - world.start.theta.0;
    let quark = GoAvoid::new(Radians(bearing), Meters(range), MetersPerSecond(0.2));
    let (mut input, mut law, mut touched) = (Twist::default(), None, false);
    for turn in 0..TURNS {
        let y = robot.exchange(&input).expect("finite inputs");
        let t = Nanos(turn * 100_000_000);
        if y.pressed() && !touched && is_walker(&robot) {
            return Some(turn);
        }
        touched = y.pressed();
        let law = law.get_or_insert_with(|| quark.begin(&y, Begin { now: t, frame: Frame(y.here().theta) }));
        if law.completed(&y, t) {
            return None;
        }
        input = if turn < stands { law.input(&y, t) } else { Twist::default() };
    }
    None
}

/// Returns `true` if the robot avoids the contact in turn `contact` by stopping `before` turns earlier.
fn avoids(body: Body, seed: u64, contact: u64, before: u64) -> bool {
    meets(body, seed, contact.saturating_sub(before)).is_none_or(|turn| turn > contact + PASSED)
}

/// Checks that a collision with the walker is detected, so that the test below can fail. The walker walks from (8, 1)
/// to (8, 9).
#[test]
fn a_robot_in_the_way_of_the_walker_is_met() {
    for body in [Body::Ideal, Body::Scout, Body::Atrv] {
        let mut crossing = hall(body, 1);
        crossing.world.start.x.0 = 8.0;
        crossing.world.start.y.0 = 5.0;
        let met = crosses(body, 1, 0, &crossing);
        assert!(met.is_some_and(|turn| (60..90).contains(&turn)), "{body}: {met:?}");
    }
}

/// Checks that stopping 1 or 2 s before a contact would not have avoided it. Stopping 3 s before would have avoided one
/// contact of an ATRV-mini in 120 runs; 5 s before, the robot is still a metre away. The test prints the number of
/// contacts that each time would have avoided.
#[test]
fn standing_still_would_not_avoid_the_walker() {
    let (first, count) = (number("MDLE_FIRST", 5000), 12 * number("MDLE_LONG", 1));
    let counts = [Body::Ideal, Body::Scout, Body::Atrv].map(|body| {
        let (mut met, mut avoidable) = (0, [0; 4]);
        for seed in first..first + count {
            let Some(contact) = meets(body, seed, TURNS) else { continue };
            met += 1;
            let avoided = [10, 20, 30, 50].map(|before| avoids(body, seed, contact, before));
            avoidable = std::array::from_fn(|at| avoidable[at] + u64::from(avoided[at]));
            println!(
                "{body} {seed}: met at {:.1} s; standing 1, 2, 3, 5 s before: avoided {avoided:?}",
                contact as f64 / 10.0
            );
        }
        println!("{body}: {met} of {count} meet the walker; avoidable from 1, 2, 3, 5 s before: {avoidable:?}");
        (body, avoidable)
    });
    for (body, avoidable) in counts {
        assert_eq!(avoidable[..2], [0; 2], "{body}");
        assert!(avoidable[2] <= count / 12, "{body}: {avoidable:?}");
    }
}
