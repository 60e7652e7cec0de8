//! Runs the turns of a plan, and prints them.

use core::fmt::{self, Write};

use mdle_runtime::trace::Line;
use mdle_runtime::{
    Compass, Machine, Nanos, PathStore, Pings, Plan, Pose, Published, SONARS, Sensed, Shape, Supply, Transition, Turn,
    Twist, Watch,
};
use static_cell::StaticCell;

/// Maximum number of transitions that are printed for a turn.
const PRINTED: usize = 4;

/// The hardware of a robot.
pub trait Robot {
    /// Waits for the next cycle, and updates `y`. Returns the time of the cycle, or `None` after the last one.
    fn sense(&mut self, y: &mut Sensed) -> Option<Nanos>;

    /// Sends speeds to the motors.
    fn drive(&mut self, input: Twist);
}

/// Returns the output of a robot of this shape before it has sensed anything.
#[must_use]
pub fn at_rest(shape: Shape) -> Sensed {
    Sensed {
        at: Nanos::ZERO,
        data_age: Nanos::ZERO,
        odometry: Pose::ORIGIN,
        velocity: Twist::default(),
        switches: 0,
        pings: [Pings::default(); SONARS],
        compass: Compass::default(),
        supply: Supply::default(),
        shape,
        paths: PathStore::EMPTY,
        published: Published::NONE,
    }
}

/// Runs a plan on a robot until the plan is over or the robot has no further cycle. For each turn, prints a line of the
/// trace and the bits of the speeds.
///
/// # Errors
/// Fails if `out` cannot be written.
pub fn run<P: Plan<Output = Sensed, Input = Twist> + 'static>(
    cell: &'static StaticCell<Machine<P>>,
    plan: fn() -> P,
    y: &mut Sensed,
    robot: &mut impl Robot,
    out: &mut impl Write,
) -> fmt::Result {
    let Some(mut t) = robot.sense(y) else { return Ok(()) };
    let machine = begin(cell, plan, y, t);
    let mut number: u64 = 0;
    loop {
        let mut story = Story::default();
        let turn = machine.turn(y, t, &mut story);
        robot.drive(turn.input());
        tell(machine, number, t, turn, &story, out)?;
        number = number.saturating_add(1);
        t = match turn {
            Turn::Over => return Ok(()),
            Turn::Law(_) | Turn::Cut => match robot.sense(y) {
                Some(t) => t,
                None => return Ok(()),
            },
        };
    }
}

/// Begins the plan in the static memory `cell`.
#[inline(never)]
fn begin<P: Plan<Output = Sensed, Input = Twist>>(
    cell: &'static StaticCell<Machine<P>>,
    plan: fn() -> P,
    y: &Sensed,
    t: Nanos,
) -> &'static mut Machine<P> {
    cell.init_with(|| Machine::begin(plan(), y, t))
}

/// Prints a turn as two lines.
#[inline(never)]
fn tell<P: Plan<Output = Sensed, Input = Twist>>(
    machine: &Machine<P>,
    turn: u64,
    t: Nanos,
    outcome: Turn<Twist>,
    story: &Story,
    out: &mut impl Write,
) -> fmt::Result {
    let law = match outcome {
        Turn::Law(_) => machine.atom().map(|atom| machine.plan().law(atom)),
        Turn::Cut | Turn::Over => None,
    };
    let fired = story.0.iter().flatten();
    let fired = fired.map(|transition| transition.fired(machine.plan(), core::iter::empty::<&str>()));
    let frame = machine.frame().filter(|_| law.is_some());
    let Twist { v, omega } = outcome.input();
    writeln!(out, "{}", Line { turn, t, state: machine.state(), law, frame, fired })?;
    writeln!(out, "u {:016x} {:016x}", v.0.to_bits(), omega.0.to_bits())
}

/// The first transitions of a turn, at most [`PRINTED`].
#[derive(Debug, Default)]
struct Story([Option<Transition>; PRINTED]);

impl Watch for Story {
    fn transition(&mut self, transition: Transition) {
        if let Some(free) = self.0.iter_mut().find(|place| place.is_none()) {
            *free = Some(transition);
        }
    }
}
