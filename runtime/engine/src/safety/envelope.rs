//! The envelope, which applies the safety rules and decides which input is sent to a robot. It reads no clock and no
//! file, so it decides in the same way when a run is replayed.

use std::time::Duration;

use mdle_host::{Intervention, LimitedQuantity, Verdict};
use mdle_runtime::capability::{Bumpers, DiffDrive, Odometry, SonarRing};
use mdle_runtime::{MetersPerSecond, Nanos, RadiansPerSecond, Twist};

use super::{Fence, Limits, Measure, RuleId, Rules, Then};

/// Speed, in metres per second, below which a robot that was slowed down by a fence is treated as stopped.
const CREEP: f64 = 0.01;
/// Number of turn rates that are tried at a fence, in steps from the plan's turn rate to the robot's current turn rate.
const RATES: u32 = 4;

/// Safety rules that are applied between a plan and a robot, with their state in a run.
#[derive(Debug, Clone)]
pub struct Envelope {
    rules: Rules,
    /// Limits at the beginning of the run.
    first_limits: Limits,
    /// Period of a turn, in seconds.
    period: f64,
    /// Input that was sent last.
    last: Twist,
    /// Time of the last decision; `None` before the first decision.
    at: Option<Nanos>,
    /// Number of consecutive late turns.
    late: u64,
    /// Rules that have replaced the plan by another plan, and have been switched off since then.
    spent: Vec<RuleId>,
    /// Verdict of the last turn, and the rule that caused it; `None` if no rule changed the input.
    verdict: Option<(Verdict, RuleId)>,
    /// Quantity that was limited in the last turn; `None` if no quantity was limited.
    limited: Option<LimitedQuantity>,
    /// Number of turns in which each rule has changed the input, in the order of `Rules::ids`.
    counts: Vec<(RuleId, u64)>,
}

impl Envelope {
    /// Creates an envelope with these rules for a run with this period.
    #[must_use]
    pub fn new(rules: Rules, period: Duration) -> Self {
        let mut envelope = Self {
            first_limits: rules.limits,
            rules,
            period: period.as_secs_f64(),
            last: Twist::default(),
            at: None,
            late: 0,
            spent: Vec::new(),
            verdict: None,
            limited: None,
            counts: Vec::new(),
        };
        envelope.counts = envelope.rules.ids().map(|id| (id, 0)).collect();
        envelope
    }

    /// Returns the input to send to the robot instead of `asked`, in the turn with output `y` at time `now`. `fired`
    /// contains an entry for each guard: `true` if the condition of the guard is true for `y`.
    pub fn filter<Y>(&mut self, asked: Twist, y: &Y, now: Nanos, fired: &[bool]) -> Twist
    where
        Y: Odometry + Bumpers + SonarRing + DiffDrive,
    {
        self.observe(now);
        let demand = self.demand(asked, y, now, fired);
        self.limited = None;
        let (sent, verdict) = match demand {
            Some((Then::End, id)) => (Twist::default(), Some((Verdict::Ended, id))),
            Some((Then::Divert(plan), id)) => {
                self.spent.push(id);
                (Twist::default(), Some((Verdict::Diverted(plan), id)))
            }
            Some((Then::Hold, id)) => (Twist::default(), Some((Verdict::Held, id))),
            Some((Then::HoldForward, id)) if asked.v.0 > 0.0 => {
                let (sent, _) = self.within_limits(Twist { v: MetersPerSecond(0.0), ..asked }, y);
                (sent, Some((Verdict::HeldForward, id)))
            }
            Some((Then::HoldForward, _)) | None => self.within_limits(asked, y),
        };
        self.last = sent;
        self.verdict = verdict;
        if let Some((_, id)) = verdict
            && let Some((_, count)) = self.counts.iter_mut().find(|(known, _)| *known == id)
        {
            *count = count.saturating_add(1);
        }
        sent
    }

    /// Counts consecutive late turns. A turn is late if it begins more than one and a half periods after the previous
    /// one.
    fn observe(&mut self, now: Nanos) {
        let is_late = self.at.is_some_and(|at| now.since(at).seconds() > 1.5 * self.period);
        self.late = if is_late { self.late.saturating_add(1) } else { 0 };
        self.at = Some(now);
    }

    /// Returns the strictest consequence that any rule except limits and fences demands, with the rule. Among equally
    /// strict consequences, the first one is returned. Returns `None` if no rule demands a consequence.
    fn demand<Y>(&self, asked: Twist, y: &Y, now: Nanos, fired: &[bool]) -> Option<(Then, RuleId)>
    where
        Y: Bumpers + SonarRing,
    {
        let Rules { contact, stale, stale_module, overrun, guards, .. } = &self.rules;
        let finite = (!(asked.v.0.is_finite() && asked.omega.0.is_finite())).then_some((Then::End, RuleId::Finite));
        let data_age = Nanos(now.since(y.now()).0.saturating_add(y.data_age().0));
        let stale = stale.filter(|(age, _)| data_age > *age).map(|(_, then)| (then, RuleId::Stale));
        let module = stale_module.filter(|(age, _)| y.oldest_published() > *age);
        let module = module.map(|(_, then)| (then, RuleId::StaleModule));
        let overrun = overrun.filter(|(turns, _)| self.late >= *turns).map(|(_, then)| (then, RuleId::Overrun));
        let contact = contact.filter(|_| y.pressed()).map(|then| (then, RuleId::Contact));
        let guards = guards.iter().zip(fired).enumerate().filter(|(_, (_, fired))| **fired);
        let guards = guards.map(|(number, (guard, _))| (guard.then, RuleId::Guard(number)));
        let demands = [finite, stale, module, overrun, contact].into_iter().flatten().chain(guards);
        let demands = demands.filter(|(_, id)| !self.spent.contains(id));
        demands.reduce(|strictest, other| if other.0 > strictest.0 { other } else { strictest })
    }

    /// Applies limits and fences to an input. Returns the resulting input, with the verdict and the last rule that
    /// changed the input; `None` if no rule changed it.
    fn within_limits<Y: Odometry + DiffDrive>(&mut self, asked: Twist, y: &Y) -> (Twist, Option<(Verdict, RuleId)>) {
        let limits = self.rules.limits;
        let mut input = Limited { v: asked.v.0, omega: asked.omega.0, by: None };
        input.turn_within(limits.turn_rate, RuleId::TurnRate);
        input.drive_within(limits.speed, RuleId::Speed);
        let before = self.last.v.0;
        let kept = if input.v * before > 0.0 { before.abs() } else { 0.0 };
        input.drive_within(kept + limits.acceleration * self.period, RuleId::Acceleration);
        for (number, fence) in self.rules.fences.iter().enumerate() {
            let id = RuleId::Fence(number);
            let (pose, turns) = (y.pose(), y.velocity().omega.0);
            input.turn(self.turn_rate_at(fence, input.omega, y), id);
            // Until the wheels have reached the new turn rate, the robot keeps its current turn rate.
            let fastest = |omega| fence.fastest(&pose, input.v, omega, self.period);
            input.drive_within(fastest(input.omega).min(fastest(turns)), id);
        }
        let is_held = input.v.abs() < CREEP && asked.v.0.abs() >= CREEP;
        self.limited = input.by.map(|(_, measure)| of_measure(measure, asked, &input));
        let verdict = input.by.map(|(id, _)| {
            let is_fence = matches!(id, RuleId::Fence(_));
            (if is_fence && is_held { Verdict::Held } else { Verdict::Limited }, id)
        });
        (Twist { v: MetersPerSecond(input.v), omega: RadiansPerSecond(input.omega) }, verdict)
    }

    /// Returns a turn rate with which the robot can brake before a fence: the plan's turn rate, or a value between the
    /// plan's and the robot's current turn rate. A robot that drives along a fence cannot first turn towards the fence
    /// and then brake, and wheels cannot brake while they change the turn rate as fast as possible.
    fn turn_rate_at<Y: Odometry + DiffDrive>(&self, fence: &Fence, asked: f64, y: &Y) -> f64 {
        let Twist { v, omega } = y.velocity();
        // A robot that has been sent the opposite direction still rolls in the old one until its wheels have stopped.
        let speeds = [v.0, self.last.v.0];
        let can_brake =
            |rate, brakes| speeds.iter().all(|v| fence.fastest(&y.pose(), *v, rate, self.period) >= v.abs() - brakes);
        let brakes = fence.deceleration * self.period;
        let asked = if can_brake(omega.0, 0.0) {
            asked
        } else {
            let change = 2.0 * brakes / y.wheel_base().0;
            omega.0 + within(asked - omega.0, change)
        };
        let mut rates = (0..RATES).map(|part| asked + (omega.0 - asked) * f64::from(part) / f64::from(RATES));
        rates.find(|rate| can_brake(*rate, brakes)).unwrap_or(omega.0)
    }

    /// Returns the intervention of the last [`Envelope::filter`]; `None` if the input was not changed.
    #[must_use]
    pub fn intervention(&self) -> Option<Intervention<'_>> {
        let Self { verdict, limited, .. } = self;
        verdict.map(|(verdict, id)| Intervention { verdict, rule: self.rules.name(id), limited: *limited })
    }

    /// Returns the rules.
    #[must_use]
    pub fn rules(&self) -> &Rules {
        &self.rules
    }

    /// Returns the rules so that they can be changed; changes apply from the next turn on. The numbers of guards and
    /// fences must not change.
    pub fn rules_mut(&mut self) -> &mut Rules {
        &mut self.rules
    }

    /// Resets the rules: limits have their values from the beginning of the run again, counts are 0, and rules that
    /// have replaced a plan are switched on again. Returns the names of the rules that were switched on.
    pub fn reset(&mut self) -> Vec<String> {
        self.rules.limits = self.first_limits;
        self.counts.iter_mut().for_each(|(_, count)| *count = 0);
        let spent = std::mem::take(&mut self.spent);
        spent.into_iter().map(|id| self.rules.name(id).to_owned()).collect()
    }

    /// Returns the limits at the beginning of the run.
    #[must_use]
    pub fn first_limits(&self) -> Limits {
        self.first_limits
    }

    /// Returns each rule with the number of turns in which it changed the input.
    pub fn counts(&self) -> impl Iterator<Item = (RuleId, u64)> {
        self.counts.iter().copied()
    }
}

/// An input to which limits are applied, and the last rule that changed it.
#[derive(Debug)]
struct Limited {
    v: f64,
    omega: f64,
    by: Option<(RuleId, Measure)>,
}

impl Limited {
    fn turn_within(&mut self, most: f64, rule: RuleId) {
        self.turn(within(self.omega, most), rule);
    }

    fn turn(&mut self, omega: f64, rule: RuleId) {
        if self.omega != omega {
            (self.omega, self.by) = (omega, Some((rule, Measure::TurnRate)));
        }
    }

    fn drive_within(&mut self, most: f64, rule: RuleId) {
        let v = within(self.v, most);
        if self.v != v {
            (self.v, self.by) = (v, Some((rule, Measure::Speed)));
        }
    }
}

/// Returns the quantity `measure` in two inputs: in `asked`, which the plan requested, and in the limited input.
fn of_measure(measure: Measure, asked: Twist, input: &Limited) -> LimitedQuantity {
    let (asked, sent) = match measure {
        Measure::TurnRate => (asked.omega.0, input.omega),
        Measure::Speed | Measure::Acceleration => (asked.v.0, input.v),
    };
    let (_, unit) = measure.quantity();
    LimitedQuantity { name: measure.key(), unit, asked: measure.in_its_unit(asked), sent: measure.in_its_unit(sent) }
}

/// Limits a value to the range from -`most` to `most`.
fn within(value: f64, most: f64) -> f64 {
    if value.abs() > most { most.copysign(value) } else { value }
}
