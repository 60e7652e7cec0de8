//! The pilot of a route: an engine that runs one plan after the other and so drives from landmark to landmark.

use std::collections::VecDeque;
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Arc;

use mdle_compiler::load::{self, LoadedPlan};
use mdle_engine::{Engine, EngineAlphabet, Library, PlanFacts, StoredPlan};
use mdle_files::Target;
use mdle_host::{AfterPlan, Call, Pilot, PilotFault, PilotTurn, RunTerms, Transitions};
use mdle_record::RecordedChange;
use mdle_runtime::{Cause, Machine, Nanos, Plan as _, Pose, Printable, Radians, Robot, Sensed, Turn, Twist};

use super::look::{LOOK, LandmarkMap, LookEchoes, LookPlan, Stand};
use super::reckoning::{LandmarkPlace, Reckoning};
use super::{Edge, Leg, Route, leg_text};
use crate::failure::Failure;
use crate::plans::texts;
use crate::recorded_files;

/// A leg that is ready to run.
struct ReadyLeg<A: EngineAlphabet> {
    edge: Edge,
    /// Direction of the frame in degrees, relative to the heading at the start of the run.
    turned: f64,
    graph: PathBuf,
    target: Arc<Target>,
    plan: StoredPlan<A>,
}

/// A look around that is ready to run.
struct ReadyLook<'l, A: EngineAlphabet> {
    plan: StoredPlan<A>,
    maps: &'l [LandmarkMap],
}

/// The pilot of a route.
struct Navigator<'l, A: EngineAlphabet> {
    engine: Engine<A>,
    /// The current leg, followed by the remaining legs.
    legs: VecDeque<&'l ReadyLeg<A>>,
    look: Option<&'l ReadyLook<'l, A>>,
    /// Echoes of the current look around; `None` if the robot is not looking around.
    heard: Option<LookEchoes>,
    reckoning: Reckoning<'l>,
    /// Drift of the odometry heading, as measured at the last landmark that has a map.
    drift: Radians,
    /// Continuation of the run after the last turn. It is used only if a plan ended in that turn.
    after: AfterPlan,
    messages: Vec<String>,
}

/// Drives a route of at least one leg, with the modules in `library`.
///
/// # Errors
/// Fails if a plan cannot be loaded.
pub(crate) fn drive<T, A>(
    route: &Route,
    target: &Arc<Target>,
    call: Call,
    library: &Library<Sensed>,
) -> Result<ExitCode, Failure>
where
    T: mdle_host::Target<Robot: Robot<Output = Sensed, Input = Twist>> + 'static,
    A: EngineAlphabet<Output = Sensed, Input = Twist>,
{
    let legs = route.legs.iter().map(|leg| ready::<A>(leg, target)).collect::<Result<Vec<_>, Failure>>()?;
    let look = route.look.as_ref().map(|look| ready_look::<A>(look, target)).transpose()?;
    let Some(leg) = legs.first() else { return Ok(ExitCode::SUCCESS) };
    let first = look.as_ref().filter(|look| look.knows(&leg.edge.from)).map_or(&leg.plan, |look| &look.plan);
    let (plan, places) = (|| first.loaded.plan(), &*route.places);
    let pilot = |terms: &RunTerms| {
        let engine = Engine::new(plan(), library, terms)?;
        Ok(Navigator::new(engine, &legs, look.as_ref(), places))
    };
    Ok(mdle_host::run_piloted::<T, _>(&*first.name, call, &plan, pilot, None))
}

fn ready_look<'l, A: EngineAlphabet>(look: &'l LookPlan, target: &Target) -> Result<ReadyLook<'l, A>, Failure> {
    let loaded = Arc::new(load::load::<A>(&look.machine, &look.input.sources, &target.alphabet)?);
    let (files, facts) = (texts(&look.input).into(), PlanFacts::default());
    let plan = StoredPlan { name: LOOK.into(), files, loaded, facts };
    Ok(ReadyLook { plan, maps: &look.maps })
}

impl<A: EngineAlphabet> ReadyLook<'_, A> {
    /// Returns `true` if this landmark has a map.
    fn knows(&self, landmark: &str) -> bool {
        self.maps.iter().any(|map| map.name == landmark)
    }
}

fn ready<A: EngineAlphabet>(leg: &Leg, target: &Arc<Target>) -> Result<ReadyLeg<A>, Failure> {
    let loaded = Arc::new(load::load::<A>(&leg.machine, &leg.input.sources, &target.alphabet)?);
    let (files, facts) = (texts(&leg.input).into(), PlanFacts::default());
    let plan = StoredPlan { name: leg.name.as_str().into(), files, loaded, facts };
    let (graph, target) = (leg.graph.clone(), Arc::clone(target));
    Ok(ReadyLeg { edge: leg.edge.clone(), turned: leg.turned, graph, target, plan })
}

impl<A: EngineAlphabet> ReadyLeg<A> {
    /// Returns the plan of the leg for a robot with this heading by odometry; `drift` is the drift of this heading. The
    /// plan is compiled for this heading, because direction 0 of a plan that begins during a run is the heading at its
    /// beginning. The texts of the plan were read before the run.
    fn plan_at(&self, heading: Radians, drift: Radians) -> Result<StoredPlan<A>, String> {
        let turned = libm::round((self.turned + drift.degrees() - heading.degrees()) * 100.0) / 100.0;
        let name = &self.plan.name;
        let mut files = self.plan.files.to_vec();
        if let Some((_, text)) = files.first_mut() {
            *text = leg_text(name, &self.edge.plan, turned, &self.graph);
        }
        let loaded = recorded_files::compiled(&files, Some(name), &self.target)
            .and_then(|(machine, sources)| Ok(load::load::<A>(&machine, &sources, &self.target.alphabet)?));
        let loaded = loaded.map_err(|_| format!("{name} cannot be turned by {turned} degrees"))?;
        let (loaded, facts) = (Arc::new(loaded), PlanFacts::default());
        Ok(StoredPlan { name: Arc::clone(name), files: files.into(), loaded, facts })
    }
}

impl<'l, A: EngineAlphabet<Output = Sensed>> Navigator<'l, A> {
    fn new(
        mut engine: Engine<A>,
        legs: &'l [ReadyLeg<A>],
        look: Option<&'l ReadyLook<'l, A>>,
        places: &'l [LandmarkPlace],
    ) -> Self {
        // No trial: the engine cannot return to a leg that has ended.
        engine.plans_mut().set_trial(Nanos::ZERO);
        let (legs, reckoning, drift) = (legs.iter().collect(), Reckoning::new(places), Radians(0.0));
        let after = AfterPlan::Ends;
        let mut navigator = Self { engine, legs, look, heard: None, reckoning, drift, after, messages: Vec::new() };
        if let Some(leg) = navigator.legs.front().copied() {
            navigator.stands(&leg.edge.from, None);
        }
        navigator
    }

    /// Begins a look around if the landmark has a map, and returns the plan of the look around. Otherwise, reports that
    /// the robot is at the landmark and returns `None`.
    fn stands(&mut self, landmark: &str, driven: Option<&Sensed>) -> Option<&'l StoredPlan<A>> {
        let Some(look) = self.look.filter(|look| look.knows(landmark)) else {
            self.reckoning.is_at(landmark, driven.map_or(Pose::ORIGIN, |y| y.odometry));
            self.messages.push(format!("at {}", Printable(landmark)));
            return None;
        };
        self.heard = Some(LookEchoes::at(landmark, driven));
        Some(&look.plan)
    }

    /// Begins the next plan after a plan has ended. Returns `false` if there is no next plan.
    ///
    /// # Errors
    /// Fails with a message if the robot is not where it should be, or if the next plan cannot begin.
    fn goes_on(&mut self, y: &Sensed, transitions: &Transitions) -> Result<bool, String> {
        match self.heard.take() {
            Some(heard) => self.has_looked(&heard, transitions)?,
            None => {
                if let Some(look) = self.arrives(y, transitions)? {
                    self.engine.plans_mut().follow(look)?;
                    return Ok(true);
                }
            }
        }
        let Some(next) = self.legs.front() else { return Ok(false) };
        let plan = next.plan_at(y.odometry.theta, self.drift)?;
        self.engine.plans_mut().follow(&plan)?;
        Ok(true)
    }

    /// Ends a leg. If the landmark has a map, returns the plan of the look around. Otherwise, checks by odometry that
    /// no other landmark is nearer, and returns `None`.
    fn arrives(&mut self, y: &Sensed, transitions: &Transitions) -> Result<Option<&'l StoredPlan<A>>, String> {
        let Some(leg) = self.legs.pop_front() else { return Ok(None) };
        let Edge { from, to, plan } = &leg.edge;
        if let Some(cause) = self.cut_short(plan, transitions) {
            let (from, to) = (Printable(from), Printable(to));
            return Err(format!("the way from {from} to {to} is not done: `{plan}` was ended by `{cause}`"));
        }
        if !self.look.is_some_and(|look| look.knows(to)) {
            self.reckoning.check(to, y.odometry, self.drift)?;
        }
        Ok(self.stands(to, Some(y)))
    }

    /// Evaluates a look around: checks that the robot is where it should be, and updates the drift of the odometry
    /// heading.
    ///
    /// # Errors
    /// Fails with a message if the look around was interrupted, or if the robot is not at the landmark.
    fn has_looked(&mut self, heard: &LookEchoes, transitions: &Transitions) -> Result<(), String> {
        let landmark = Printable(heard.expected());
        if let Some(cause) = self.cut_short(LOOK, transitions) {
            return Err(format!("the turn at {landmark} is not done: it was ended by `{cause}`"));
        }
        let maps = self.look.map_or(&[][..], |look| look.maps);
        let Stand { off: (x, y), drift } = heard.stand(maps, self.drift)?;
        let turned = Radians(drift.0 - self.drift.0).wrapped().degrees();
        // Adding zero removes the sign of a negative zero.
        let [x, y] = [x, y].map(|metres| libm::round(metres.0 * 100.0) / 100.0 + 0.0);
        let turned = libm::round(turned * 10.0) / 10.0 + 0.0;
        let place = format!("{x:.2} m and {y:.2} m from its place, headings {turned:.1} degrees off");
        self.messages.push(format!("at {landmark}: {place}"));
        self.drift = drift;
        self.reckoning.is_at(heard.expected(), heard.here());
        Ok(())
    }

    /// Returns the fired operands of the plan's own condition if this condition ended the plan of an edge; `None` if
    /// the plan ended because its last element ended.
    fn cut_short(&self, edge: &str, transitions: &Transitions) -> Option<String> {
        let (last, operands) = transitions.iter().last()?;
        let plan = self.engine.machine()?.plan();
        let is_own = matches!(last.cause, Cause::Fired(_)) && plan.name(last.scope) == edge;
        let source = plan.source();
        let fired = operands.iter().filter_map(|(number, _)| source.operand(last.scope, *number));
        let fired = fired.map(|words| words.written).collect::<Vec<_>>().join(" and ");
        is_own.then(|| if fired.is_empty() { plan.condition(last.scope).to_owned() } else { fired })
    }
}

impl<A: EngineAlphabet<Output = Sensed>> Pilot for Navigator<'_, A> {
    type Plan = LoadedPlan<A>;

    fn complete(&mut self, y: &mut Sensed, t: Nanos) {
        self.engine.complete(y, t);
    }

    fn turn(
        &mut self,
        moment: PilotTurn<'_, Sensed>,
        transitions: &mut Transitions,
    ) -> Result<Turn<A::Input>, PilotFault> {
        let y = moment.y;
        if let Some(heard) = &mut self.heard {
            heard.take(y);
        }
        let turn = self.engine.turn(moment, transitions)?;
        if matches!(turn, Turn::Over) {
            self.after = match self.goes_on(y, transitions) {
                Ok(true) => AfterPlan::Continues,
                Ok(false) => AfterPlan::Ends,
                Err(sentence) => AfterPlan::Fails(sentence),
            };
        }
        Ok(turn)
    }

    fn after_plan(&mut self) -> AfterPlan {
        std::mem::replace(&mut self.after, AfterPlan::Ends)
    }

    fn divert(&mut self, plan: LoadedPlan<A>, moment: PilotTurn<'_, Sensed>) {
        self.legs.clear();
        self.heard = None;
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

    fn take_changes(&mut self) -> Vec<RecordedChange> {
        self.engine.take_changes()
    }
}
