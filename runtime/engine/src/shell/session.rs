//! The supervisor of a run with a shell.

use std::time::Duration;

use mdle_host::{Break, Intervention, Orders, RunTerms, StopRequest, Supervisor};
use mdle_runtime::capability::{Bumpers, DiffDrive, Odometry, SonarRing};
use mdle_runtime::{Alphabet, Nanos, Twist};

use super::clock::SessionClock;
use super::parts::{EnginePart, PlanPart, RobotPart};
use crate::safety::Guardian;
use crate::tree::{Desk, Served};

/// Maximum wait for a request while the clock stands, between two checks of the signals.
const LOOK: Duration = Duration::from_millis(20);

/// The supervisor of a run with a shell: it serves requests at breaks, and applies the safety rules, if there are any.
#[derive(Debug)]
pub struct Session<A: Alphabet> {
    desk: Desk,
    guardian: Option<Guardian<A>>,
    clock: SessionClock,
    engine: EnginePart,
    request: StopRequest,
}

impl<A: Alphabet> Session<A> {
    /// Returns the session of a run with these terms. If `is_paused`, stepped time stands before the first turn.
    #[must_use]
    pub fn new(desk: Desk, guardian: Option<Guardian<A>>, terms: &RunTerms, is_paused: bool) -> Self {
        let clock = SessionClock::new(terms.period, terms.time, is_paused);
        Self { desk, guardian, clock, engine: EnginePart::default(), request: terms.request.clone() }
    }
}

impl<A> Supervisor<A::Output, Twist> for Session<A>
where
    A: Alphabet<Input = Twist>,
    A::Output: Odometry + Bumpers + SonarRing + DiffDrive,
{
    fn filter(&mut self, asked: Twist, y: &A::Output, t: Nanos) -> Twist {
        self.guardian.as_mut().map_or(asked, |guardian| guardian.filter(asked, y, t))
    }

    fn intervention(&self) -> Option<Intervention<'_>> {
        self.guardian.as_ref()?.intervention()
    }

    fn at_break(&mut self, moment: &Break<'_, A::Output, Twist>) -> Orders {
        self.clock.made(moment);
        self.serve(moment, None);
        while self.clock.is_paused && !moment.is_over && !self.engine.quits && !self.request.is_made() {
            self.serve(moment, Some(LOOK));
        }
        Orders { pace: self.clock.ordered.take(), end: self.engine.quits }
    }
}

impl<A> Session<A>
where
    A: Alphabet<Input = Twist>,
    A::Output: Odometry + Bumpers + SonarRing + DiffDrive,
{
    /// Serves requests; waits for one for this long, if it is to wait.
    fn serve(&mut self, moment: &Break<'_, A::Output, Twist>, wait: Option<Duration>) {
        let Self { desk, guardian, clock, engine, .. } = self;
        let (mut robot, mut plan) = (RobotPart, PlanPart);
        let mut all: [&mut dyn Served<Break<'_, A::Output, Twist>>; 5];
        let mut unguarded: [&mut dyn Served<Break<'_, A::Output, Twist>>; 4];
        let parts: &mut [&mut dyn Served<_>] = match guardian {
            Some(guardian) => {
                all = [&mut robot, &mut plan, clock, engine, guardian];
                &mut all
            }
            None => {
                unguarded = [&mut robot, &mut plan, clock, engine];
                &mut unguarded
            }
        };
        match wait {
            None if moment.is_over => desk.close(parts, moment),
            None => desk.serve(parts, moment),
            Some(time) => desk.wait(parts, moment, time),
        }
    }
}
