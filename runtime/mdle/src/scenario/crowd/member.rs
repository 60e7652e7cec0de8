//! A robot of a crowd, with its plan.

use std::sync::Arc;

use mdle_compiler::load::{Loaded, LoadedPlan};
use mdle_runtime::{Machine, Nanos, Pose, Robot as _, Turn, Twist};
use mdle_sim::{Footprint, Others, Simulated, World};

use super::alphabet::CrowdAlphabet;
use super::recorded::RecordedMember;

/// A robot of a crowd.
pub(super) struct Member {
    /// The simulated robot. It is on the heap, so that moving the members of a large crowd between lists is cheap.
    robot: Box<Simulated>,
    /// The running plan; `None` before the plan begins.
    machine: Option<Box<Machine<LoadedPlan<CrowdAlphabet>>>>,
    input: Twist,
    /// `true` once the plan is over.
    pub(super) is_over: bool,
    /// `true` once the robot has touched something.
    pub(super) has_touched: bool,
    /// Length of the driven path, in metres.
    pub(super) way: f64,
    record: Option<Box<RecordedMember>>,
}

impl Member {
    /// Creates a robot whose plan has not begun.
    pub(super) fn new(robot: Simulated) -> Self {
        let (robot, input) = (Box::new(robot), Twist::default());
        Self { robot, machine: None, input, is_over: false, has_touched: false, way: 0.0, record: None }
    }

    /// Creates another robot of the same kind at the pose `start`; `None` if it cannot start there. `world` is the
    /// world of this robot.
    pub(super) fn another(&self, world: &World, start: Pose, seed: Option<u64>) -> Option<Self> {
        self.robot.another(world, start, seed).ok().map(Self::new)
    }

    /// Adds the record to the robot; `None` means no record.
    pub(super) fn recorded(self, record: Option<RecordedMember>) -> Self {
        Self { record: record.map(Box::new), ..self }
    }

    /// Returns two distances between the centres of this robot and a similar one, in metres: the distance within which
    /// one may detect the other with its sonars, and the distance within which they may touch in a turn.
    pub(super) fn reaches(&self) -> (f64, f64) {
        (self.robot.hears(), self.robot.touches())
    }

    /// Returns the message about an error of the record; `None` if there was no error.
    pub(super) fn fault(&self) -> Option<&str> {
        self.record.as_ref().and_then(|record| record.fault())
    }

    pub(super) fn footprint(&self) -> Footprint {
        self.robot.footprint()
    }

    pub(super) fn pose(&self) -> Pose {
        self.robot.pose()
    }

    /// Moves the robot for the period that ends at time `t`; `others` contains the robots nearby.
    pub(super) fn moves(&mut self, t: Nanos, others: &mut Others) {
        let before = self.pose();
        self.robot.swap_others(others);
        if let Err(fault) = self.robot.moves(&self.input) {
            // The input was not a number: the plan is stopped, as on any robot.
            self.ends();
            if let Some(record) = &mut self.record {
                record.end((&self.robot.senses(), t), &format!("failed: {fault}"));
            }
        }
        self.robot.swap_others(others);
        self.way += self.pose().distance(&before).0;
    }

    /// Makes the turn of the plan at time `t`; `others` contains the robots nearby.
    pub(super) fn turn(&mut self, t: Nanos, plan: &Arc<Loaded<CrowdAlphabet>>, others: &mut Others) {
        self.robot.swap_others(others);
        let y = self.robot.senses();
        self.robot.swap_others(others);
        self.has_touched |= y.switches != 0;
        if self.is_over {
            return;
        }
        let machine = self.machine.get_or_insert_with(|| Box::new(Machine::begin(plan.plan(), &y, t)));
        let turn = match &mut self.record {
            None => machine.turn(&y, t, &mut ()),
            Some(record) => {
                record.transitions.clear();
                let turn = machine.turn(&y, t, &mut record.transitions);
                record.turn(machine, (&y, t), &turn);
                if turn == Turn::Over {
                    record.end((&y, t), "plan over");
                }
                turn
            }
        };
        self.input = turn.input();
        if turn == Turn::Over {
            self.ends();
        }
    }

    /// Ends the plan; from now on, the robot does not move.
    fn ends(&mut self) {
        self.is_over = true;
        self.input = Twist::default();
        // Frees the memory of the plan.
        self.machine = None;
    }

    /// Stops the robot at the end of the run, at time `t`.
    pub(super) fn stop(&mut self, t: Nanos) {
        // A simulated robot always obeys.
        let _ = self.robot.stop();
        if let Some(record) = &mut self.record {
            record.end((&self.robot.senses(), t), "end of the scenario");
        }
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;
    use std::{env, fs, process};

    use mdle_record::Begin;
    use mdle_runtime::MetersPerSecond;
    use mdle_sim::{Body, Make};

    use super::super::places::{Places, hall};
    use super::*;

    #[test]
    fn an_input_that_is_no_number_ends_the_record() {
        let world = hall(1, 2.0).map_err(|error| error.message).unwrap();
        let start = Places::of(&world, 2.0, 0).next().unwrap();
        let make = Make { body: Body::Ideal, without: Vec::new(), seed: None };
        let robot = Simulated::with(&make, &world, start, Duration::from_millis(100)).unwrap();
        let log = env::temp_dir().join(format!("mdle-crowd-{}.mcap", process::id()));
        let mut member = Member::new(robot).recorded(RecordedMember::create(&log, 1, Begin::default()).ok());
        member.input.v = MetersPerSecond(f64::NAN);
        member.moves(Nanos(100_000_000), &mut Others::default());
        member.stop(Nanos(200_000_000));
        let path = log.with_extension("1.mcap");
        let record = fs::read(&path).unwrap();
        let _ = fs::remove_file(path);
        let has = |text: &str| record.windows(text.len()).any(|bytes| bytes == text.as_bytes());
        assert!(member.is_over && has("\"text\":\"failed: ") && !has("end of the scenario"));
    }
}
