//! One robot of a fleet that sends its state 50 times a second: `latency (tcp|router) NUMBER COUNT PORT SECONDS`. Robot
//! 0 measures the time between the turn in which another robot hands over a state and the arrival of this state.
//!
//! Robot `n` listens at `PORT + n` for the link over TCP; the router listens at `PORT`.
#![allow(clippy::print_stdout, reason = "it prints what it measures")]

use std::collections::BTreeMap;
use std::error::Error;
use std::net::{Ipv4Addr, SocketAddr};
use std::thread::sleep;
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use mdle::RouterSettings;
use mdle_engine::link::{Link, LinkSettings, State, Tcp, TcpSettings};
use mdle_runtime::{Meters, Nanos, Pose, Twist};

const TURN: Duration = Duration::from_millis(20);
/// Time between two checks for states. On average, the measured latencies are too long by half this time.
const LOOK: Duration = Duration::from_micros(100);
/// Time in which the robots connect, before latencies are measured.
const WARM_UP: Duration = Duration::from_secs(5);

/// Returns the system time in seconds of the current day. States carry it as a position, and a link refuses positions
/// that are more than a million metres away, as the seconds since the Unix epoch would be.
fn clock() -> f64 {
    SystemTime::now().duration_since(UNIX_EPOCH).map_or(0.0, |time| time.as_secs_f64() % 86_400.0)
}

fn opened(kind: &str, number: usize, count: usize, port: u16) -> Result<Box<dyn Link>, Box<dyn Error>> {
    let name = |number: usize| format!("robot{number}");
    let at = |offset: usize| SocketAddr::from((Ipv4Addr::LOCALHOST, port + offset as u16));
    let others: Vec<usize> = (0..count).filter(|other| *other != number).collect();
    let peers = others.iter().map(|other| name(*other)).collect();
    let link = LinkSettings { name: name(number), peers, key: "key".to_owned(), plans: Vec::new() };
    if kind == "tcp" {
        let addresses = others.iter().map(|other| at(*other)).collect();
        return Ok(Box::new(Tcp::open(&TcpSettings { link, listen: at(number), addresses })?));
    }
    Ok(mdle_fleet::open(&RouterSettings { link, router: at(0), file: "latency".into() })?)
}

/// Latencies of states, in seconds. Also, for each robot, the numbers of its first and its last state, and the number
/// of states that have arrived.
#[derive(Default)]
struct Heard {
    latencies: Vec<f64>,
    robots: BTreeMap<String, (u64, u64, u64)>,
}

impl Heard {
    fn take(&mut self, state: State) {
        self.latencies.push(clock() - state.pose.x.0);
        let (_, last, count) = self.robots.entry(state.name).or_insert((state.number, state.number, 0));
        (*last, *count) = (state.number, *count + 1);
    }

    /// Prints the latencies.
    ///
    /// # Errors
    /// Fails if no state has arrived.
    fn print(mut self, kind: &str) -> Result<(), Box<dyn Error>> {
        if self.latencies.is_empty() {
            return Err(format!("{kind}: no state has arrived").into());
        }
        self.latencies.sort_by(f64::total_cmp);
        let sent: u64 = self.robots.values().map(|(first, last, _)| last - first + 1).sum();
        let at =
            |part: usize| self.latencies.get(self.latencies.len() * part / 1000).map_or(f64::NAN, |time| time * 1e3);
        println!(
            "{kind}: p50 {:.2} ms, p99 {:.2} ms, p99.9 {:.2} ms, {} of {sent} states of {} robots",
            at(500),
            at(990),
            at(999),
            self.latencies.len(),
            self.robots.len()
        );
        Ok(())
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let [kind, number, count, port, seconds] = words.as_slice() else {
        return Err("latency (tcp|router) NUMBER COUNT PORT SECONDS".into());
    };
    let number: usize = number.parse()?;
    let mut link = opened(kind, number, count.parse()?, port.parse()?)?;
    let (begun, end) = (Instant::now(), WARM_UP + Duration::from_secs(seconds.parse()?));
    let (mut heard, mut sent, mut next) = (Heard::default(), 0, begun);
    while begun.elapsed() < end {
        if Instant::now() >= next {
            (next, sent) = (next + TURN, sent + 1);
            let (name, session) = (format!("robot{number}"), link.session());
            let pose = Pose { x: Meters(clock()), ..Pose::ORIGIN };
            let (velocity, rounds, attributes) = (Twist::default(), Vec::new(), Vec::new());
            let (number, age) = (sent, Nanos::ZERO);
            let state = State { name, session, number, age, pose, velocity, rounds, atom: 1, attributes };
            link.send(&state, Nanos::ZERO);
        }
        let counts = number == 0 && begun.elapsed() > WARM_UP;
        link.receive(Nanos::ZERO, &mut |state| {
            if counts {
                heard.take(state)
            }
        });
        sleep(if number == 0 { LOOK } else { next.saturating_duration_since(Instant::now()) });
    }
    if number == 0 {
        heard.print(kind)?;
    }
    Ok(())
}
