//! Warns about a `stuck` that never fires, because no law in its scope has a goal, and about one that always fires,
//! because its time is too short for 10 cm of progress (W0203).

use crate::alphabet::family_to_si;
use crate::diagnostic::{Code, Diagnostic};
use crate::plan::{Condition, Interrupt, Node, Plan, Quark, Value};

/// Laws of the common alphabet that report no progress towards a goal. Laws of a robot's own may report it.
const WITHOUT_GOAL: [&str; 9] = ["go", "stop", "rotate", "turn", "advance", "align", "Follow", "slot", "path"];
/// Progress, in metres, that begins the time of a `stuck` anew, as in `mdle-atoms`.
const PROGRESS: f64 = 0.1;
/// Relative error by which a quotient of a distance and a speed may be too small.
const ROUNDING: f64 = 1e-9;
/// Distance of a goal, in metres, below which `goAvoid` may complete before it has made this progress.
const FAR: f64 = 1.0;

/// Warns about every `stuck` that never fires, or that fires before the robot can have made progress.
pub(super) fn check(plan: &Plan, found: &mut Vec<Diagnostic>) {
    let mut lint = Goals { plan, found };
    let fastest = lint.sequence(&plan.root.body);
    lint.interrupt(&plan.root.interrupt, fastest, "no law in here has a goal");
}

struct Goals<'p, 'f> {
    plan: &'p Plan,
    found: &'f mut Vec<Diagnostic>,
}

impl Goals<'_, '_> {
    /// Checks a sequence, and returns the maximum speed, in m/s, of its laws towards their goals; 0 if none has a goal.
    fn sequence(&mut self, body: &[Node]) -> f64 {
        body.iter().map(|node| self.node(node)).fold(0.0, f64::max)
    }

    fn node(&mut self, node: &Node) -> f64 {
        match node {
            Node::Loop(repeated) => self.sequence(&repeated.body),
            Node::Scope(scope) => {
                let fastest = self.sequence(&scope.body);
                self.interrupt(&scope.interrupt, fastest, "no law in here has a goal");
                fastest
            }
            Node::Atom(atom) => {
                let fastest = towards_goal(self.plan.quark(atom.law));
                self.interrupt(&atom.interrupt, fastest, "this law has no goal");
                fastest
            }
        }
    }

    fn interrupt(&mut self, interrupt: &Interrupt, fastest: f64, here: &str) {
        let Some(&(quark, _)) = stucks(self.plan, &interrupt.condition).first() else { return };
        let text = &quark.text;
        let lint = |message, here| Diagnostic::new(Code::W0203, message, interrupt.span, here);
        let needed = PROGRESS / fastest;
        if fastest <= 0.0 {
            let help = "`stuck` asks for the progress of a `goAvoid` to a point; a time ends every law: `wait 30s`";
            self.found.push(lint(format!("`{text}` is never true"), here).help(help));
        } else if quark.args.first().and_then(si).is_some_and(|time| time <= needed * (1.0 + ROUNDING)) {
            let message = format!("`{text}` is true before the robot can have made progress");
            // Rounded down, so that "more than" is true.
            let seconds = (needed * (1.0 + ROUNDING) * 1e3).floor() / 1e3;
            let here = format!("to start and drive 10 cm at its speed takes more than {seconds} s");
            let enough = (10.0 * needed).ceil().max(30.0);
            let help = format!("give it a time in which there is progress, such as `stuck {enough}s`");
            self.found.push(lint(message, &here).help(help));
        }
    }
}

/// Returns every `stuck` in a condition, with its time in nanoseconds.
pub(super) fn stucks<'p>(plan: &'p Plan, condition: &Condition) -> Vec<(&'p Quark, u64)> {
    // The causes that `after` asks for are no operands: their elements have ended before.
    if let Some((quark, nanos)) = condition.lasting() {
        return Some((plan.quark(quark), nanos)).into_iter().filter(|(quark, _)| quark.name == "stuck").collect();
    }
    condition.children().iter().flat_map(|operand| stucks(plan, operand)).collect()
}

/// Returns the maximum speed, in m/s, at which a law comes nearer to its goal: 0 if it has none, and infinity if the
/// speed is not known.
pub(super) fn towards_goal(law: &Quark) -> f64 {
    let is_drive = law.name == "goAvoid";
    // A `goAvoid` that follows a module has no goal, and does not complete.
    if is_drive && !law.completes || WITHOUT_GOAL.contains(&law.name.as_str()) {
        return 0.0;
    }
    let [_, range, speed] = law.args.as_slice() else { return f64::INFINITY };
    match (si(range), si(speed)) {
        (Some(range), Some(speed)) if is_drive && range >= FAR && speed > 0.0 => speed,
        (_, _) => f64::INFINITY,
    }
}

/// Returns the value of a quantity in its SI unit.
fn si(value: &Value) -> Option<f64> {
    match value {
        Value::Quantity { exact, family, .. } => Some(exact.to_f64() * family_to_si(family)),
        Value::Infinity(_) | Value::Integer(_) | Value::Sonar(_) | Value::Bits(_) | Value::Name(..) => None,
    }
}
