//! The driver on the emulated robot does what any robot must do, over a pseudo-terminal, in lockstep: it is a Super Scout
//! whose sensors are exact and whose wheels do not slip.
#![allow(clippy::expect_used, reason = "a test fails by panicking")]

use std::time::Duration;

use mdle_atoms::conformance::{Room, Stage, Suite, Supplied};
use mdle_emulator::{Ailment, Staged};
use mdle_host::StopRequest;
use mdle_host::Target as _;
use mdle_runtime::{Nanos, PathStore, Pose};
use mdle_scout::{Clock, Config, Configured, Scout, Target, alphabet};
use mdle_scout_emulator::scout::Scout as Emulated;
use mdle_sim::{Body, Make, Simulated, World};

const PERIOD: Duration = Duration::from_nanos(alphabet::PERIOD.0);
/// How long a driver waits for an answer, in milliseconds: longer than any machine takes.
const LONG: u64 = 60_000;

/// The robot that is switched on now.
#[derive(Default)]
struct OnItsLine(Option<Staged<Pose>>);

impl Stage for OnItsLine {
    type Robot = Scout;
    type Alphabet = alphabet::Alphabet;
    const PERIOD: Nanos = alphabet::PERIOD;

    fn robot(&mut self, room: &Room, at: Pose) -> Result<Scout, String> {
        let world = World::parse("the room", &room.to_string()).map_err(|error| error.to_string())?;
        let make = Make { body: Body::Scout, without: Vec::new(), seed: None };
        let body = Simulated::with(&make, &world, at, PERIOD).map_err(|error| error.to_string())?;
        let staged = Staged::new(Emulated::new(body)?, PERIOD, Emulated::pose).map_err(|error| error.to_string())?;
        let configured = Configured::read(None, staged.device().to_str())?;
        self.0 = Some(staged);
        let config = Config { answer: LONG, ..configured.config };
        Scout::connect(config, Clock::Stepped(PERIOD), PERIOD, &StopRequest::default())
            .map_err(|fault| fault.to_string())
    }

    fn take_paths(&mut self, robot: &mut Scout, paths: PathStore) {
        if let Some(replays) = Target::PATHS {
            (replays.take)(robot, paths);
        }
    }

    fn supply(&mut self, _: &mut Scout, supplied: Supplied) {
        let ailment = match supplied {
            Supplied::Well => return,
            Supplied::Low => Ailment::LowBattery,
            Supplied::Plugged => Ailment::PluggedIn,
        };
        self.0.as_ref().expect("a robot is switched on").suffers(ailment);
    }

    fn truth(&self, _: &Scout) -> Pose {
        self.0.as_ref().expect("a robot is switched on").now()
    }

    fn left_alone(&mut self, _: &mut Scout, periods: u32) {
        self.0.as_ref().expect("a robot is switched on").left_alone(periods);
    }
}

#[test]
fn the_driver_conforms() {
    let mut stage = OnItsLine::default();
    let report = Suite::on(&mut stage).diff_drive().odometry().bumper().sonar().paths().power().report();
    assert!(report.holds(), "{report}");
}
