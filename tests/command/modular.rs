//! The program `mdle` with modules that have attributes and settings of every kind, used by `mdle_modules.rs`.

use std::process::ExitCode;
use std::sync::Arc;
use std::thread;
use std::time::Duration;

use mdle::engine::{Background, Declare, Exchange, Fault, In, Module, Out, Turn};
use mdle_runtime::{Meters, Nanos, Pose, Radians, Sensed};

/// Value of the setting `name` that makes a module hang in its turn.
const HANGS: &str = "for ever";

/// A module that publishes the bearing and range of a point ahead, and a copy of its settings.
struct Heading {
    ahead: In<Meters>,
    bearing: Out<Radians>,
    range: Out<Meters>,
    gain: In<f64>,
    is_on: In<bool>,
    count: In<i64>,
    name: In<Arc<str>>,
    place: In<Pose>,
    delay: In<Nanos>,
    weights: In<Arc<[f64]>>,
    key: In<Arc<[u8]>>,
    copy: Out<Arc<str>>,
}

impl Heading {
    fn declare(declare: &mut Declare) -> Self {
        let heading = Self {
            ahead: declare.setting("ahead", Meters(3.0)),
            bearing: declare.publishes("bearing"),
            range: declare.publishes("range"),
            gain: declare.setting("gain", 0.25),
            is_on: declare.setting("is_on", true),
            count: declare.setting("count", -7),
            name: declare.setting("name", "a b".into()),
            place: declare.setting("place", Pose::ORIGIN),
            delay: declare.setting("delay", Nanos(1_500_000_000)),
            weights: declare.setting("weights", [1.0, -0.5].as_slice().into()),
            key: declare.setting("key", [0, 255].as_slice().into()),
            copy: declare.publishes("copy"),
        };
        declare.describe("ahead", "cm", "distance of the point from where the robot began");
        declare.describe("bearing", "deg", "direction to the point");
        heading
    }
}

impl Module<Sensed> for Heading {
    fn turn(&mut self, turn: &mut Turn<'_, Sensed>) -> Result<(), Fault> {
        let here = turn.y.odometry;
        let Some(Meters(ahead)) = turn.get(self.ahead) else { return Ok(()) };
        let (x, y) = (ahead - here.x.0, -here.y.0);
        turn.publish(self.bearing, Radians(libm::atan2(y, x) - here.theta.0).wrapped());
        turn.publish(self.range, Meters(libm::hypot(x, y)));
        while turn.get(self.name).is_some_and(|name| &*name == HANGS) {
            thread::park_timeout(Duration::from_secs(1));
        }
        let copy = (turn.get(self.gain), turn.get(self.is_on), turn.get(self.count), turn.get(self.name));
        let more = (turn.get(self.place), turn.get(self.delay), turn.get(self.weights), turn.get(self.key));
        turn.publish(self.copy, format!("{copy:?} {more:?}").into());
        Ok(())
    }
}

/// A background module that counts its exchanges.
struct Counter(Out<i64>);

impl Background for Counter {
    fn run(self: Box<Self>, mut exchange: Exchange) -> Result<(), Fault> {
        let mut count = 0;
        while exchange
            .exchange(|offer| {
                count += 1;
                offer.publish(self.0, count);
            })
            .is_ok()
        {}
        Ok(())
    }
}

fn main() -> ExitCode {
    mdle::main_with(|library| {
        library.registered("heading", Heading::declare);
        library.background("counter", |declare| Counter(declare.publishes("count")));
    })
}
