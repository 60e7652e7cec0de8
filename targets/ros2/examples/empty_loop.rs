//! An empty control loop on the driver, without a plan and a host. `tests/latency.py` compares its latency with other
//! loops.
//!
//! Usage: `empty_loop CONFIG.toml PERIOD_MS`. The robot drives backwards while sonar 0 detects an object within 60 cm.
#![allow(clippy::unwrap_used, reason = "a program of the tests, which fails loudly")]

use std::path::Path;
use std::thread::sleep;
use std::time::{Duration, Instant};

use mdle_host::StopRequest;
use mdle_ros2::config::Configured;
use mdle_ros2::{DdsLink, Input, Pacing, Ros2};
use mdle_runtime::{MetersPerSecond, RadiansPerSecond, Robot};
use mdle_serial::Moment;

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    let config = Configured::read(Some(Path::new(&arguments[1]))).unwrap().config;
    let period = Duration::from_millis(arguments[2].parse().unwrap());
    let (request, begun) = (StopRequest::default(), Moment::now());
    let (link, sensing) =
        DdsLink::connect(&config, Pacing::Wall, &request, begun).map_err(|fault| fault.to_string()).unwrap();
    let mut robot = Ros2::new(config, link, sensing, Pacing::Wall, request, begun);
    let (mut input, mut due) = (Input::default(), Instant::now());
    // Until the robot no longer answers.
    while let Ok(output) = robot.exchange(&input) {
        let is_near = output.pings[0].nearest(1).is_some_and(|range| range.0 < 0.6);
        input = Input { v: MetersPerSecond(if is_near { -0.1 } else { 0.1 }), omega: RadiansPerSecond(0.0) };
        due += period;
        sleep(due.saturating_duration_since(Instant::now()));
    }
}
