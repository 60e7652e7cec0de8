//! A module that reads a sonar and the clock, with a setting, and a test of it without a robot.

use mdle::engine::{Declare, Fault, In, Module, Out, Turn};
use mdle_runtime::{Meters, MetersPerSecond, Nanos};

/// Publishes the speed at which what is in front of the robot comes closer.
pub struct Closing {
    ahead: In<Meters>,
    farthest: In<Meters>,
    /// Time and range of the last echo.
    last: Option<(Nanos, Meters)>,
    speed: Out<MetersPerSecond>,
}

impl Closing {
    /// Declares the attributes and the setting of the module, and returns it as it is before its first turn.
    pub fn declare(declare: &mut Declare) -> Self {
        Self {
            ahead: declare.reads("sensors", "r0"),
            farthest: declare.setting("farthest", Meters(3.0)),
            last: None,
            speed: declare.publishes("speed"),
        }
    }
}

// It does not read the output of the robot itself, so it is a module of any robot.
impl<Y> Module<Y> for Closing {
    fn turn(&mut self, turn: &mut Turn<'_, Y>) -> Result<(), Fault> {
        // `None` until `sensors` has published its first range.
        let (Some(ahead), Some(farthest)) = (turn.get(self.ahead), turn.get(self.farthest)) else { return Ok(()) };
        if ahead.0 > farthest.0 {
            self.last = None;
            return Ok(());
        }
        if let Some((at, before)) = self.last.replace((turn.now, ahead)) {
            turn.publish(self.speed, MetersPerSecond((before.0 - ahead.0) / turn.now.since(at).seconds()));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use std::error::Error;

    use mdle::engine::{Candidate, Modules, Service, Threads, Value};

    use super::*;

    /// Publishes these ranges, one in each turn, in place of the robot's `sensors`.
    struct Ranges(Out<Meters>, std::array::IntoIter<f64, 3>);

    impl<Y> Module<Y> for Ranges {
        fn turn(&mut self, turn: &mut Turn<'_, Y>) -> Result<(), Fault> {
            let range = self.1.next().ok_or_else(|| Fault("there are no more ranges".to_owned()))?;
            turn.publish(self.0, Meters(range));
            Ok(())
        }
    }

    /// Returns the speed that the module has published after a turn of half a second for each range.
    fn speed(ranges: [f64; 3]) -> Result<Option<Value>, Box<dyn Error>> {
        let mut modules = Modules::new(Threads::Sequential, Service::WhenDue)?;
        modules
            .load(Candidate::registered("sensors", |declare| Ranges(declare.publishes("r0"), ranges.into_iter()))?)?;
        modules.load(Candidate::registered("closing", Closing::declare)?)?;
        modules.prepare();
        for number in 0..3 {
            // `()` is the output of a robot without sensors.
            modules.turn((), number, Nanos(number * 500_000_000), None);
            modules.settle();
            modules.prepare();
        }
        let post = modules.board().post("closing", "speed");
        Ok(post.and_then(|post| post.reading.as_ref()).map(|reading| reading.value.clone()))
    }

    #[test]
    fn a_wall_comes_closer() -> Result<(), Box<dyn Error>> {
        // A module reads a value in the turn after it was published, so the last range is not read.
        assert_eq!(speed([2.0, 1.5, 9.0])?, Some(Value::Speed(MetersPerSecond(1.0))));
        assert_eq!(speed([9.0, 1.5, 1.0])?, None, "the first echo has no speed");
        Ok(())
    }
}
