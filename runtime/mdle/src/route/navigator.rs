//! The pilot of a route: an engine that drives one plan after the other, from landmark to landmark.

use std::collections::VecDeque;
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Arc;

use mdle_compiler::load::{self, LoadedPlan};
use mdle_engine::{Engine, EngineAlphabet, Library, StoredPlan};
use mdle_files::Target;
use mdle_host::{Call, Moment, Pilot, PilotFault, RunTerms, Transitions};
use mdle_record::Change;
use mdle_runtime::{Cause, Machine, Nanos, Plan as _, Printable, Radians, Robot, Sensed, Turn, Twist};

use super::{Edge, Leg, leg_text};
use crate::failure::Failure;
use crate::plans::texts;
use crate::recorded_files;

/// A leg that is ready to run.
struct ReadyLeg<A: EngineAlphabet> {
    edge: Edge,
    /// Direction of the frame from the heading with which the run begins, in degrees.
    turned: f64,
    graph: PathBuf,
    target: Arc<Target>,
    plan: StoredPlan<A>,
}

/// The pilot of a route.
struct Navigator<'l, A: EngineAlphabet> {
    engine: Engine<A>,
    /// The leg that is driven, and those after it.
    legs: VecDeque<&'l ReadyLeg<A>>,
    messages: Vec<String>,
}

/// Drives the legs of a route, of which there is at least one, with these modules.
///
/// # Errors
/// A plan cannot be loaded.
pub(crate) fn drive<T, A>(
    legs: &[Leg],
    target: &Arc<Target>,
    call: Call,
    library: &Library<Sensed>,
) -> Result<ExitCode, Failure>
where
    T: mdle_host::Target<Robot: Robot<Output = Sensed, Input = Twist>> + 'static,
    A: EngineAlphabet<Output = Sensed, Input = Twist>,
{
    let legs = legs.iter().map(|leg| ready::<A>(leg, target)).collect::<Result<Vec<_>, Failure>>()?;
    let Some(first) = legs.first() else { return Ok(ExitCode::SUCCESS) };
    let plan = || first.plan.loaded.plan();
    let pilot = |terms: &RunTerms| Ok(Navigator::new(Engine::new(plan(), library, terms)?, &legs));
    Ok(mdle_host::run_piloted::<T, _>(&*first.plan.name, call, &plan, pilot, None))
}

fn ready<A: EngineAlphabet>(leg: &Leg, target: &Arc<Target>) -> Result<ReadyLeg<A>, Failure> {
    let loaded = Arc::new(load::load::<A>(&leg.machine, &leg.input.sources, &target.alphabet)?);
    let plan = StoredPlan { name: leg.name.as_str().into(), files: texts(&leg.input).into(), loaded };
    let (graph, target) = (leg.graph.clone(), Arc::clone(target));
    Ok(ReadyLeg { edge: leg.edge.clone(), turned: leg.turned, graph, target, plan })
}

impl<A: EngineAlphabet> ReadyLeg<A> {
    /// Returns the plan of the leg for a robot with this heading by odometry: direction 0 of a plan that begins during
    /// a run is the heading with which it begins. The texts are those that were read before the run.
    fn plan_at(&self, heading: Radians) -> Result<StoredPlan<A>, PilotFault> {
        let turned = libm::round((self.turned - heading.degrees()) * 100.0) / 100.0;
        let name = &self.plan.name;
        let mut files = self.plan.files.to_vec();
        if let Some((_, text)) = files.first_mut() {
            *text = leg_text(name, &self.edge.plan, turned, &self.graph);
        }
        let loaded = recorded_files::compiled(&files, Some(name), &self.target)
            .and_then(|(machine, sources)| Ok(load::load::<A>(&machine, &sources, &self.target.alphabet)?));
        let loaded = loaded.map_err(|_| PilotFault::Stopped(format!("{name} cannot be turned by {turned} degrees")))?;
        Ok(StoredPlan { name: Arc::clone(name), files: files.into(), loaded: Arc::new(loaded) })
    }
}

impl<'l, A: EngineAlphabet<Output = Sensed>> Navigator<'l, A> {
    fn new(mut engine: Engine<A>, legs: &'l [ReadyLeg<A>]) -> Self {
        // A leg that is over cannot go on.
        engine.plans_mut().set_trial(Nanos::ZERO);
        let mut navigator = Self { engine, legs: legs.iter().collect(), messages: Vec::new() };
        if let Some(leg) = legs.first() {
            navigator.messages.push(format!("at {}", Printable(&leg.edge.from)));
        }
        navigator
    }

    /// Goes on after the plan of a leg is over; returns `true` if there is another leg.
    fn arrives(&mut self, heading: Radians, transitions: &Transitions) -> Result<bool, PilotFault> {
        let Some(leg) = self.legs.pop_front() else { return Ok(false) };
        let Edge { from, to, plan } = &leg.edge;
        if let Some(cause) = self.cut_short(plan, transitions) {
            let (from, to) = (Printable(from), Printable(to));
            let sentence = format!("the way from {from} to {to} is not done: `{plan}` was ended by `{cause}`");
            return Err(PilotFault::Stopped(sentence));
        }
        self.messages.push(format!("at {}", Printable(to)));
        let Some(next) = self.legs.front() else { return Ok(false) };
        let plan = next.plan_at(heading)?;
        self.engine.plans_mut().follow(&plan).map_err(PilotFault::Stopped)?;
        Ok(true)
    }

    /// Returns the cause by which the plan of an edge ended, if that is its own condition rather than its last element.
    fn cut_short(&self, edge: &str, transitions: &Transitions) -> Option<String> {
        let (last, _) = transitions.iter().last()?;
        let plan = self.engine.machine()?.plan();
        let is_own = matches!(last.cause, Cause::Fired(_)) && plan.name(last.scope) == edge;
        is_own.then(|| plan.condition(last.scope).to_owned())
    }
}

impl<A: EngineAlphabet<Output = Sensed>> Pilot for Navigator<'_, A> {
    type Plan = LoadedPlan<A>;

    fn complete(&mut self, y: &mut Sensed, t: Nanos) {
        self.engine.complete(y, t);
    }

    fn turn(
        &mut self,
        moment: Moment<'_, Sensed>,
        transitions: &mut Transitions,
    ) -> Result<Turn<A::Input>, PilotFault> {
        let heading = moment.y.odometry.theta;
        let turn = self.engine.turn(moment, transitions)?;
        Ok(if matches!(turn, Turn::Over) && self.arrives(heading, transitions)? { Turn::Cut } else { turn })
    }

    fn divert(&mut self, plan: LoadedPlan<A>, moment: Moment<'_, Sensed>) {
        self.legs.clear();
        self.engine.divert(plan, moment);
    }

    fn plan_number(&self) -> u64 {
        self.engine.plan_number()
    }

    fn reason(&self) -> &str {
        self.engine.reason()
    }

    fn ended_by(&mut self, rule: &str) -> bool {
        self.engine.ended_by(rule)
    }

    fn machine(&self) -> Option<&Machine<LoadedPlan<A>>> {
        self.engine.machine()
    }

    fn zero(&self) -> Nanos {
        self.engine.zero()
    }

    fn messages(&mut self, say: &mut dyn FnMut(&str)) {
        self.messages.drain(..).for_each(|message| say(&message));
        self.engine.messages(say);
    }

    fn record(&mut self) {
        self.engine.record();
    }

    fn take_changes(&mut self) -> Vec<Change> {
        self.engine.take_changes()
    }
}
