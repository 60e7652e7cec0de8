//! Several robots in one world, each at its own line. The robots can detect and touch each other.
//!
//! In lockstep, the world advances by a step when each robot with a connected driver has received its command for that
//! step. The first step waits until a driver has connected to each robot. A robot whose driver has disconnected no
//! longer blocks the others, and its own watchdog stops it. In each step, the robots move one after another, in the
//! order of the list.

use std::io;
use std::time::{Duration, Instant};

use mdle_simulator::Footprint;
use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::io::Errno;

use crate::port::Port;
use crate::presence::Presence;
use crate::serve::{self, Embodied, Emulated, Pace, SLICE, STEP, say};

/// A robot and its line.
#[derive(Debug)]
pub struct Seat<R> {
    /// Emulated robot.
    pub robot: R,
    /// Serial line of the robot.
    pub port: Port,
}

/// Robots in one world.
#[derive(Debug)]
pub struct Several<R> {
    seats: Vec<Seat<R>>,
    presence: Presence,
}

impl<R> Several<R> {
    /// Creates the group of robots, and starts to watch their lines for drivers.
    ///
    /// # Errors
    /// Fails if the system cannot watch this number of lines.
    pub fn of(seats: Vec<Seat<R>>) -> io::Result<Self> {
        let presence = Presence::of(seats.iter().map(|seat| seat.port.path()))?;
        Ok(Self { seats, presence })
    }

    /// Returns the robots, each with its line.
    #[must_use]
    pub fn seats(&self) -> &[Seat<R>] {
        &self.seats
    }
}

impl<R: Emulated + Embodied> Several<R> {
    /// Serves all robots while `goes_on` returns `true`. Afterwards, executes the commands that have already been
    /// received.
    ///
    /// # Errors
    /// Fails if a line or the world of a robot failed.
    pub fn serve(&mut self, pace: Pace, goes_on: &dyn Fn() -> bool) -> io::Result<()> {
        let Self { seats, presence } = self;
        match seats.as_mut_slice() {
            // A single robot waits for no other.
            [Seat { robot, port }] => serve::serve(robot, port, pace, goes_on),
            several => serve_several(several, presence, pace, goes_on),
        }
    }
}

fn serve_several<R: Emulated + Embodied>(
    seats: &mut [Seat<R>],
    presence: &mut Presence,
    pace: Pace,
    goes_on: &dyn Fn() -> bool,
) -> io::Result<()> {
    // `true` for each robot whose command for the next step has arrived.
    let mut have_commands = vec![false; seats.len()];
    let mut next = Instant::now() + STEP;
    loop {
        let ends = !goes_on();
        let limit = match pace {
            _ if ends => Duration::ZERO,
            Pace::Lockstep(_) => SLICE,
            Pace::Real => next.saturating_duration_since(Instant::now()).min(SLICE),
        };
        wait(seats, presence, limit)?;
        let mut has_input = false;
        for (seat, has_command) in seats.iter_mut().zip(&mut have_commands) {
            has_input |= seat.port.read(Duration::ZERO, &mut |bytes| seat.robot.push(bytes))?;
            hear(seat, pace, has_command)?;
        }
        presence.look()?;
        match pace {
            Pace::Lockstep(step) => {
                while is_due(presence, &have_commands) {
                    pass(seats, step)?;
                    for (seat, has_command) in seats.iter_mut().zip(&mut have_commands) {
                        *has_command = false;
                        hear(seat, pace, has_command)?;
                    }
                }
            }
            Pace::Real => {
                while next <= Instant::now() {
                    pass(seats, STEP)?;
                    next += STEP;
                }
            }
        }
        if ends && !has_input {
            return Ok(());
        }
    }
}

/// Waits until a driver sends bytes, connects or disconnects, or until `limit` has passed.
fn wait<R>(seats: &[Seat<R>], presence: &Presence, limit: Duration) -> io::Result<()> {
    let timeout = Timespec { tv_sec: limit.as_secs() as i64, tv_nsec: i64::from(limit.subsec_nanos()) };
    let ends = seats.iter().map(|seat| seat.port.end()).chain([presence.end()]);
    let mut ends: Vec<_> = ends.map(|end| PollFd::new(end, PollFlags::IN)).collect();
    match poll(&mut ends, Some(&timeout)) {
        Ok(_) | Err(Errno::INTR) => Ok(()),
        Err(error) => Err(error.into()),
    }
}

/// Executes the requests of a robot, up to its command for the next step. This command sets `has_command` to `true`.
fn hear<R: Emulated>(seat: &mut Seat<R>, pace: Pace, has_command: &mut bool) -> io::Result<()> {
    while !*has_command {
        match seat.robot.obey() {
            None => break,
            Some(passes) if passes && pace != Pace::Real => *has_command = true,
            Some(_) => say(&mut seat.robot, &seat.port)?,
        }
    }
    Ok(())
}

/// Returns `true` if the world must advance: each robot has had a driver, every connected driver has sent its command,
/// and there is at least one command.
fn is_due(presence: &Presence, have_commands: &[bool]) -> bool {
    let nobody_is_waited_for =
        presence.are_open().zip(have_commands).all(|(is_open, has_command)| *has_command || !is_open);
    presence.all_have_begun() && nobody_is_waited_for && have_commands.contains(&true)
}

/// Advances the world by one step. Each robot detects the other robots at their current positions.
fn pass<R: Emulated + Embodied>(seats: &mut [Seat<R>], step: Duration) -> io::Result<()> {
    let mut footprints: Vec<Footprint> = seats.iter().map(|seat| seat.robot.footprint()).collect();
    for (number, Seat { robot, port }) in seats.iter_mut().enumerate() {
        let others =
            footprints.iter().enumerate().filter(|(other, _)| *other != number).map(|(_, footprint)| *footprint);
        robot.see(&others.collect::<Vec<_>>());
        robot.pass(step).map_err(io::Error::other)?;
        if let Some(footprint) = footprints.get_mut(number) {
            *footprint = robot.footprint();
        }
        say(robot, port)?;
    }
    Ok(())
}
