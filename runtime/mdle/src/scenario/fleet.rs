//! Makes the turns of all robots of a scenario, on a common clock (docs/src/many_robots.md).

use std::time::Duration;

use mdle_engine::Library;
use mdle_engine::link::Air;
use mdle_host::Interruption;
use mdle_runtime::{Nanos, Plan as _, Sensed};
use mdle_sim::Footprint;

use super::member::{MemberState, Runner};
use super::output::ScenarioOutput;
use super::setup::Scenario;

/// Exit status for a run in which a plan did not end.
pub(super) const TIMED_OUT: u8 = 4;

/// Distance beyond which the gap between robots is not measured, in metres.
const FAR: f64 = 100.0;

/// The robots of a scenario.
pub(super) struct Fleet {
    runners: Vec<Runner>,
    period: Duration,
    /// Minimum gap between two robots so far, in metres, and the numbers of these robots; `None` if no two robots were
    /// closer than [`FAR`].
    nearest: Option<(f64, usize, usize)>,
}

impl Fleet {
    /// Creates the robots before their first turn. If `are_recorded` is `true`, they collect the data that a record
    /// needs.
    ///
    /// # Errors
    /// Fails with a message if a module is refused.
    pub(super) fn new(mut scenario: Scenario, library: &Library<Sensed>, are_recorded: bool) -> Result<Self, String> {
        let members = std::mem::take(&mut scenario.members);
        let names: Vec<&str> = members.iter().map(|member| member.name.as_str()).collect();
        let ends = Air::new(&names, scenario.faults, scenario.seed.unwrap_or_default());
        let runners = members.into_iter().zip(ends);
        let runners = runners.map(|(member, air)| Runner::new(member, air, &scenario, library, are_recorded));
        Ok(Self { runners: runners.collect::<Result<_, _>>()?, period: scenario.period, nearest: None })
    }

    /// Makes turns until all plans are over, until the time `timeout` has passed, or until a signal requests the end.
    /// Returns the exit status.
    ///
    /// In each turn, the robots first move, one after the other in the order of the file, each among the current poses
    /// of the others. Then all robots sense. Then all plans make their turns, with the states that the link has
    /// delivered from earlier turns.
    pub(super) fn run(mut self, timeout: Duration, interruption: &Interruption, output: &mut ScenarioOutput) -> u8 {
        let nanos = |time: Duration| u64::try_from(time.as_nanos()).unwrap_or(u64::MAX);
        let (period, timeout) = (nanos(self.period), nanos(timeout));
        for number in 0.. {
            let t = Nanos(u64::saturating_mul(number, period));
            let outputs = self.exchange();
            self.measure();
            for (runner, y) in self.runners.iter_mut().zip(&outputs) {
                let made = runner.turn(y, t, number);
                output.turn(runner, y, t, number, &made);
            }
            let are_driven = self.runners.iter().any(|runner| runner.standing == MemberState::Drives);
            if !are_driven || t.0 >= timeout || output.has_failed() || interruption.is_made() {
                self.ends(&outputs, t, output);
                break;
            }
        }
        self.status()
    }

    /// Moves all robots for a period, then takes their outputs.
    fn exchange(&mut self) -> Vec<Sensed> {
        for number in 0..self.runners.len() {
            self.look(number);
            if let Some(runner) = self.runners.get_mut(number) {
                runner.moves();
            }
        }
        let count = self.runners.len();
        let outputs = (0..count).filter_map(|number| {
            self.look(number);
            Some(self.runners.get_mut(number)?.robot.senses())
        });
        outputs.collect()
    }

    /// Updates the poses of the other robots that the robot `number` senses.
    fn look(&mut self, number: usize) {
        let others = self.runners.iter().enumerate().filter(|(other, _)| *other != number);
        let others: Vec<Footprint> = others.map(|(_, other)| other.robot.footprint()).collect();
        if let Some(runner) = self.runners.get_mut(number) {
            runner.robot.see(&others);
        }
    }

    /// Updates the minimum gap between robots.
    fn measure(&mut self) {
        let bodies: Vec<Footprint> = self.runners.iter().map(|runner| runner.robot.footprint()).collect();
        for (number, body) in bodies.iter().enumerate() {
            for (other, beside) in bodies.iter().enumerate().skip(number + 1) {
                let gap = body.gap(beside);
                if gap < self.nearest.map_or(FAR, |(least, ..)| least) {
                    self.nearest = Some((gap, number, other));
                }
            }
        }
    }

    /// Reports the end of a run at time `t`, and stops the robots that still drive. `outputs` contains the last output
    /// of each robot.
    fn ends(&mut self, outputs: &[Sensed], t: Nanos, output: &mut ScenarioOutput) {
        for (runner, y) in self.runners.iter_mut().zip(outputs) {
            let law = runner.law();
            if runner.standing == MemberState::Drives {
                output.ends(runner, (y, t), law.as_deref());
            }
            runner.stop();
        }
        let name = |number: usize| self.runners.get(number).map_or("", |runner| runner.name.as_str());
        if let Some((gap, one, other)) = self.nearest {
            let centimetres = libm::round(gap * 1000.0) / 10.0 + 0.0;
            output.text(&format!("least gap between robots: {centimetres:.1} cm ({} and {})", name(one), name(other)));
        }
    }

    fn status(&self) -> u8 {
        let has = |is_so: fn(&MemberState) -> bool| self.runners.iter().any(|runner| is_so(&runner.standing));
        match (
            has(|standing| matches!(standing, MemberState::Failed(_))),
            has(|standing| *standing != MemberState::Over),
        ) {
            (true, _) => super::FAULT,
            (false, true) => TIMED_OUT,
            (false, false) => 0,
        }
    }
}

impl Runner {
    /// Returns the current law; `None` if no law runs.
    fn law(&self) -> Option<String> {
        let machine = self.machine()?;
        machine.atom().map(|atom| machine.plan().law(atom).to_owned())
    }
}
