//! Runs the tour on the simulated robot, and records its cycles.

use std::error::Error;
use std::fs;
use std::time::Duration;

use mdle_board::{Input, Output, Robot, at_rest, record, run};
use mdle_runtime::{Machine, Nanos, Robot as _, Shape};
use mdle_simulator::{Body, Make, Simulated, World};
use static_cell::StaticCell;

use crate::lab_tour::LabTour;

static MACHINE: StaticCell<Machine<LabTour>> = StaticCell::new();

/// Period of a turn, as in `alphabet.mdle`.
const PERIOD: Duration = Duration::from_millis(100);
/// Maximum number of turns; a tour takes fewer.
const TURNS: usize = 6000;

/// Runs the tour, and writes both files.
pub(crate) fn tour() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let body = match arguments.next().as_deref() {
        None | Some("ideal") => Body::Ideal,
        Some("scout") => Body::Scout,
        Some("atrv") => Body::Atrv,
        Some(other) => return Err(format!("there is no body `{other}`").into()),
    };
    let seed = arguments.next().map(|seed| seed.parse()).transpose()?;
    let world = World::office()?;
    let mut robot = Simulated::with(&Make { body, seed, ..Make::default() }, &world, world.start, PERIOD)?;
    // The first exchange only provides the shape of the body; the run repeats it.
    let shape = robot.exchange(&Input::default())?.shape;
    let robot = Simulated::with(&Make { body, seed, ..Make::default() }, &world, world.start, PERIOD)?;
    let mut recorder = Recorder { robot, input: Input::default(), last: None, turns: 0, bytes: begin(&shape) };
    let mut text = String::new();
    run(&MACHINE, LabTour::new, &mut at_rest(shape), &mut recorder, &mut text)?;
    fs::write("sensed", recorder.bytes)?;
    fs::write("desk.out", text)?;
    Ok(())
}

/// The simulated robot, with the record of its cycles.
struct Recorder {
    robot: Simulated,
    /// Speeds that were sent in the last cycle.
    input: Input,
    last: Option<Output>,
    turns: usize,
    bytes: Vec<u8>,
}

impl Robot for Recorder {
    fn sense(&mut self, y: &mut Output) -> Option<Nanos> {
        self.turns += 1;
        let sensed = self.robot.exchange(&self.input).ok().filter(|_| self.turns < TURNS)?;
        let pings = new_pings(&sensed, self.last.as_ref());
        let turn = turn(&sensed, pings.len() as u64);
        self.bytes.extend(turn.iter().chain(pings.as_flattened()));
        let (t, _) = record::turn(&turn, y);
        pings.iter().for_each(|ping| record::ping(ping, y));
        record::hear(y);
        assert_eq!(*y, sensed, "the record lacks something");
        self.last = Some(sensed);
        Some(t)
    }

    fn drive(&mut self, input: Input) {
        self.input = input;
    }
}

/// Returns the record of a body.
fn begin(shape: &Shape) -> Vec<u8> {
    let Shape { body_radius, half_length, half_width, wheel_base, ring_radius, sonars_apart, confirmation, .. } =
        *shape;
    let apart = sonars_apart.map_or(-1.0, |apart| apart.0);
    let metres = [body_radius.0, half_length.0, half_width.0, wheel_base.0, ring_radius.0, apart];
    let whole = metres.map(f64::to_bits).into_iter().chain([confirmation as u64]);
    whole.flat_map(u64::to_le_bytes).collect()
}

/// Returns the record of a turn, without its pings.
fn turn(y: &Output, pings: u64) -> record::Turn {
    let bits = |numbers: [f64; 3]| numbers.map(f64::to_bits);
    let [x, along, theta] = bits([y.odometry.x.0, y.odometry.y.0, y.odometry.theta.0]);
    let [v, omega, battery] = bits([y.velocity.v.0, y.velocity.omega.0, y.supply.battery.0]);
    let flags = u64::from(y.supply.is_low) | u64::from(y.supply.is_plugged) << 1;
    let whole = [y.at.0, x, along, theta, v, omega, y.switches.into(), battery, flags, pings];
    bytes(&whole)
}

/// Returns the bytes of the numbers in order.
fn bytes<const N: usize>(whole: &[u64]) -> [u8; N] {
    let mut record = [0; N];
    for (place, number) in record.as_chunks_mut().0.iter_mut().zip(whole) {
        *place = number.to_le_bytes();
    }
    record
}

/// Returns the records of the pings that the previous output does not contain, for each sonar from the oldest to the
/// newest.
fn new_pings(y: &Output, before: Option<&Output>) -> Vec<record::Ping> {
    let mut records = Vec::new();
    for (sonar, pings) in (0_u64..).zip(&y.pings) {
        let known = before.and_then(|before| before.pings.get(sonar as usize)?.newest_first().next().copied());
        let new: Vec<_> = pings.newest_first().take_while(|ping| known.as_ref() != Some(*ping)).collect();
        for ping in new.into_iter().rev() {
            let pose = ping.pose;
            let range = ping.range.map_or(f64::NAN, |range| range.0);
            let [range, x, along, theta] = [range, pose.x.0, pose.y.0, pose.theta.0].map(f64::to_bits);
            let mount = u64::from(ping.mount.left.to_bits()) | u64::from(ping.mount.turned.to_bits()) << 32;
            records.push(bytes(&[sonar, range, ping.at.0, x, along, theta, mount]));
        }
    }
    records
}
