//! Other robots in the tree: `/link/NAME` represents a robot to which plans can be sent.

use mdle_host::Break;

use super::plans::when;
use crate::Engine;
use crate::plans::EngineAlphabet;
use crate::tree::{Answer, Change, Node, Reply, Role, Served, Value};

/// The robots to which plans can be sent.
#[derive(Debug)]
pub(super) struct LinkPart;

impl<A: EngineAlphabet> Served<Break<'_, Engine<A>>> for LinkPart {
    fn nodes(&self, moment: &Break<'_, Engine<A>>) -> Vec<(String, Node)> {
        let doc = "sends a stored plan, which takes over there: `now`, when the `atom` ends, or when the `plan` ends";
        let node = |robot: &String| (format!("/link/{robot}/send_plan"), Node::method(Role::Swap, doc));
        moment.pilot.recipients().iter().map(node).collect()
    }

    fn values(&self, moment: &Break<'_, Engine<A>>, to: &mut Vec<Option<Value>>) {
        to.extend(moment.pilot.recipients().iter().map(|_| None));
    }

    fn change(&mut self, path: &str, change: &Change, moment: &mut Break<'_, Engine<A>>, reply: Reply) {
        let robot = path.strip_prefix("/link/").and_then(|rest| rest.strip_suffix("/send_plan")).unwrap_or_default();
        let result = match change {
            Change::Call(arguments) => send(robot, arguments, moment),
            Change::Set(_) => Err(format!("`{path}` is a method: call it")),
        };
        reply.answer(match result {
            Ok(sentence) => Answer::Done(sentence),
            Err(sentence) => Answer::Refused(sentence),
        });
    }
}

/// Sends a stored plan to a robot.
fn send<A: EngineAlphabet>(
    robot: &str,
    arguments: &[String],
    moment: &mut Break<'_, Engine<A>>,
) -> Result<String, String> {
    let [name, moments @ ..] = arguments else {
        return Err("`send_plan` takes the name of a stored plan; `load_plan` stores those of a file".to_owned());
    };
    let when = when(moments)?;
    let plan = moment.pilot.plans().stored_plan(name)?;
    if plan.files.len() > 1 {
        return Err(format!("{name} uses other files, and a plan is sent without them"));
    }
    moment.pilot.send_plan(robot, (&plan.name, plan.text(), when), moment.t)?;
    Ok(format!("{name} is sent to {robot}"))
}
