//! The driver on the emulated robot does what any robot must do, over a pseudo-terminal, in lockstep: it is an ATRV-mini
//! whose sensors are exact and whose wheels do not slip.
#![allow(clippy::expect_used, reason = "a test fails by panicking")]

use std::time::Duration;

use mdle_atoms::conformance::{Room, Stage, Suite, Supplied};
use mdle_atrv::{Atrv, Clock, Config, Configured, Target, alphabet};
use mdle_atrv_emulator::atrv::{Atrv as Emulated, step};
use mdle_emulator::{Ailment, Pace, Staged};
use mdle_host::StopRequest;
use mdle_host::Target as _;
use mdle_runtime::{Nanos, PathStore, Pose};
use mdle_sim::{Body, Make, Simulated, World};

const PERIOD: Duration = Duration::from_nanos(alphabet::PERIOD.0);
/// How long a driver waits for a report, in milliseconds: longer than any machine takes.
const LONG: u64 = 60_000;

/// The robot that is switched on now.
#[derive(Default)]
struct OnItsLine(Option<Staged<Pose>>);

impl Stage for OnItsLine {
    type Robot = Atrv;
    type Alphabet = alphabet::Alphabet;
    const PERIOD: Nanos = alphabet::PERIOD;

    fn robot(&mut self, room: &Room, at: Pose) -> Result<Atrv, String> {
        let world = World::parse("the room", &room.to_string()).map_err(|error| error.to_string())?;
        let make = Make { body: Body::Atrv, without: Vec::new(), seed: None };
        let step = step(Pace::Lockstep(PERIOD));
        let body = Simulated::with(&make, &world, at, step).map_err(|error| error.to_string())?;
        let robot = Emulated::new(body, step, false)?;
        let staged = Staged::new(robot, PERIOD, Emulated::pose).map_err(|error| error.to_string())?;
        let configured = Configured::read(None, staged.device().to_str())?;
        self.0 = Some(staged);
        let config = Config { answer: LONG, ..configured.config };
        Atrv::connect(config, Clock::Stepped(PERIOD), PERIOD, &StopRequest::default())
            .map_err(|fault| fault.to_string())
    }

    fn take_paths(&mut self, robot: &mut Atrv, paths: PathStore) {
        if let Some(replays) = Target::PATHS {
            (replays.take)(robot, paths);
        }
    }

    fn supply(&mut self, _: &mut Atrv, supplied: Supplied) {
        let ailment = match supplied {
            Supplied::Well => return,
            Supplied::Low => Ailment::LowBattery,
            Supplied::Plugged => Ailment::PluggedIn,
        };
        self.0.as_ref().expect("a robot is switched on").suffers(ailment);
    }

    fn truth(&self, _: &Atrv) -> Pose {
        self.0.as_ref().expect("a robot is switched on").now()
    }

    fn left_alone(&mut self, _: &mut Atrv, periods: u32) {
        self.0.as_ref().expect("a robot is switched on").left_alone(periods);
    }
}

#[test]
fn the_driver_conforms() {
    let mut stage = OnItsLine::default();
    let report = Suite::on(&mut stage).diff_drive().odometry().bumper().sonar().paths().power().report();
    assert!(report.holds(), "{report}");
}
