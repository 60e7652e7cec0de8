//! The session: the supervisor of a run with a shell.

use std::time::Duration;

use mdle_host::{Break, BreakOrders, Intervention, RunTerms, StopRequest, Supervisor};
use mdle_record::RecordedChange;
use mdle_runtime::capability::{Bumpers, DiffDrive, Odometry, SonarRing};
use mdle_runtime::{Alphabet, Nanos, Twist};

use super::clock::SessionClock;
use super::link::LinkPart;
use super::modules::ModulesPart;
use super::parts::{EnginePart, RobotPart, SafetyPart};
use super::plans::PlansPart;
use super::recorder::RecorderPart;
use crate::engine::Engine;
use crate::plans::EngineAlphabet;
use crate::safety::{Guardian, Limits};
use crate::tree::{Desk, Served};

/// Interval at which a paused run checks whether it has to stop.
const LOOK: Duration = Duration::from_millis(20);

/// Supervisor of a run with a shell. It serves requests at turn breaks, and applies the safety rules, if the run has
/// any.
#[derive(Debug)]
pub struct Session<A: Alphabet> {
    desk: Desk,
    parts: TreeParts<A>,
    request: StopRequest,
    /// Limits of the safety rules as last recorded; `None` if the run has no record or no rules.
    recorded: Option<Limits>,
}

/// All parts of the tree.
#[derive(Debug)]
struct TreeParts<A: Alphabet> {
    robot: RobotPart,
    plans: PlansPart,
    modules: ModulesPart,
    clock: SessionClock,
    engine: EnginePart,
    safety: SafetyPart<A>,
    recorder: RecorderPart,
    link: LinkPart,
    /// Number of turns that the recorder has received.
    recorded: u64,
}

impl<A: Alphabet> Session<A> {
    /// Creates a session for a run with these terms. If `is_paused` is `true`, the run begins paused; in real time,
    /// this has no effect.
    #[must_use]
    pub fn new(desk: Desk, guardian: Option<Guardian<A>>, terms: &RunTerms, is_paused: bool) -> Self {
        let parts = TreeParts {
            robot: RobotPart,
            plans: PlansPart::default(),
            modules: ModulesPart::default(),
            clock: SessionClock::new(terms.period, terms.time, is_paused),
            engine: EnginePart::default(),
            safety: SafetyPart(guardian),
            recorder: RecorderPart::new(terms, A::NAME),
            link: LinkPart,
            recorded: 0,
        };
        Self { desk, parts, request: terms.request.clone(), recorded: None }
    }
}

impl<A> Supervisor<Engine<A>> for Session<A>
where
    A: EngineAlphabet<Input = Twist>,
    A::Output: Odometry + Bumpers + SonarRing + DiffDrive,
{
    fn filter(&mut self, asked: Twist, y: &A::Output, t: Nanos) -> Twist {
        match &mut self.parts.safety.0 {
            Some(guardian) => guardian.filtered(asked, y, t),
            None => asked,
        }
    }

    fn intervention(&self) -> Option<Intervention<'_>> {
        self.parts.safety.0.as_ref()?.envelope().intervention()
    }

    fn messages(&mut self, say: &mut dyn FnMut(&str)) {
        if let Some(guardian) = &mut self.parts.safety.0 {
            guardian.warn(say);
        }
    }

    fn at_break(&mut self, moment: &mut Break<'_, Engine<A>>) -> BreakOrders {
        self.desk.begin_break();
        self.parts.recorder.made(moment);
        self.parts.recorded = moment.turns;
        self.parts.clock.made(moment);
        self.serve(moment, None);
        while self.parts.clock.is_paused && !moment.is_over && !self.parts.engine.quits && !self.request.is_made() {
            self.serve(moment, Some(LOOK));
        }
        BreakOrders { pace: self.parts.clock.ordered.take(), end: self.parts.engine.quits }
    }

    fn at_end(&mut self, moment: &Break<'_, Engine<A>>) {
        let Self { desk, parts, .. } = self;
        if moment.turns > parts.recorded {
            parts.recorder.made(moment);
        }
        parts.clock.at_end(moment);
        desk.close(&parts.all(), moment, moment.t);
    }

    fn ended(&mut self, why: &str, status: u8) {
        self.parts.clock.ended(why, status);
    }

    fn record(&mut self) {
        let limits = self.parts.safety.0.as_ref().map(|guardian| guardian.envelope().rules().limits);
        self.recorded = limits;
    }

    fn take_changes(&mut self) -> Vec<RecordedChange> {
        let Some((recorded, guardian)) = self.recorded.as_mut().zip(self.parts.safety.0.as_mut()) else {
            return Vec::new();
        };
        guardian.changes_since(recorded)
    }

    fn take_requests(&mut self) -> Vec<String> {
        self.desk.take_carried_out()
    }
}

impl<A> Session<A>
where
    A: EngineAlphabet<Input = Twist>,
    A::Output: Odometry + Bumpers + SonarRing + DiffDrive,
{
    /// Serves requests. Waits at most `wait` for a request; `None` means no waiting.
    fn serve(&mut self, moment: &mut Break<'_, Engine<A>>, wait: Option<Duration>) {
        let Self { desk, parts, .. } = self;
        let has_changed = match wait {
            Some(time) => desk.wait(&mut parts.all(), moment, time),
            None => desk.serve(&mut parts.all(), moment),
        };
        parts.proceed(moment.pilot, moment.t, has_changed);
        if wait.is_none() && moment.is_over {
            desk.close(&parts.all(), moment, moment.t);
        } else {
            desk.publish(&parts.all(), moment, moment.t);
        }
    }
}

impl<A> TreeParts<A>
where
    A: EngineAlphabet<Input = Twist>,
    A::Output: Odometry + Bumpers + SonarRing + DiffDrive,
{
    fn all<'b>(&mut self) -> [&mut dyn Served<Break<'b, Engine<A>>>; 8] {
        let Self { robot, plans, modules, clock, engine, safety, recorder, link, .. } = self;
        [robot, plans, modules, clock, engine, safety, recorder, link]
    }

    /// Continues requests that take longer than a turn break, and answers requests whose result is known.
    fn proceed(&mut self, pilot: &mut Engine<A>, now: Nanos, has_changed: bool) {
        if has_changed || self.plans.waits() || self.modules.waits() {
            let loaded = pilot.progress();
            loaded.into_iter().for_each(|(number, result)| self.modules.answer(number, result));
        }
        self.recorder.proceed().into_iter().for_each(|message| pilot.tell(message));
        self.plans.answer(pilot, now).into_iter().for_each(|message| pilot.tell(message));
    }
}
