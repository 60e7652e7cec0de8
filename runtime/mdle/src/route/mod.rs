//! Routes between landmarks: the graph of plans, the legs of a route, the look around at a landmark, dead reckoning,
//! and the pilot that drives the legs.

mod graph;
mod look;
mod navigator;
mod reckoning;

use std::path::{Path, PathBuf};

use mdle_compiler::analysis::{analyze, body_ends};
use mdle_compiler::diagnostic::judged;
use mdle_compiler::fsm::Machine;
use mdle_files::{Input, Target, plan};

use crate::failure::{self, Failure};

pub(crate) use graph::{Edge, LandmarkGraph};
pub(crate) use look::{LandmarkMap, LookPlan};
pub(crate) use navigator::drive;
pub(crate) use reckoning::LandmarkPlace;

/// A route that has been checked.
pub(crate) struct Route {
    pub(crate) legs: Vec<Leg>,
    /// The look around at landmarks that have maps; `None` if no landmark has a map.
    pub(crate) look: Option<LookPlan>,
    /// The known positions of landmarks.
    pub(crate) places: Vec<LandmarkPlace>,
}

/// A leg of a route: the compiled plan of an edge, in the frame of the landmark at which the leg begins.
pub(crate) struct Leg {
    pub(crate) edge: Edge,
    /// Direction of the frame in degrees, relative to the heading at the start of the run.
    pub(crate) turned: f64,
    /// Path of the graph.
    pub(crate) graph: PathBuf,
    /// Name of the plan of the leg.
    pub(crate) name: String,
    pub(crate) machine: Machine,
    pub(crate) input: Input,
}

/// Returns the text of a leg's plan, in a frame that is turned by `turned` degrees.
fn leg_text(name: &str, plan: &str, turned: f64, graph: &Path) -> String {
    let file = graph.file_name().unwrap_or_default().display();
    format!("use \"{file}\"\n\n{{ {name}\n  FRAME {turned}deg {plan}\n}}\n")
}

/// Compiles the plan of an edge in a frame that is turned by `turned` degrees. Messages go to standard error.
pub(crate) fn leg(edge: &Edge, number: usize, turned: f64, graph: &Path, target: &Target) -> Result<Leg, Failure> {
    let name = format!("Leg{}", number + 1);
    let text = leg_text(&name, &edge.plan, turned, graph);
    let mut input = plan(&graph.with_file_name(format!("{name}.mdle")), text, target)?;
    let (mut plans, diagnostics) = input.compile(&target.alphabet, Some(&name));
    let judged = judged(&diagnostics, false);
    if judged.is_err() {
        failure::print(&input.sources, &diagnostics);
    }
    if let Err(sentence) = judged {
        return Err(Failure::OtherPlan(format!("{sentence} in the plans of {}", graph.display())));
    }
    let named = plans.drain(..).map(|compiled| (compiled.plan.root.name, compiled.machine)).collect();
    let machine: Machine = input.only(named)?;
    if analyze(&machine).shortest.is_none() {
        let Edge { from, to, plan } = edge;
        let help = format!("`mdlec analyze {} --plan {plan}` says why", graph.display());
        return Err(Failure::OtherPlan(format!("the plan `{plan}` from {from} to {to} never ends\nhelp: {help}")));
    }
    let own = machine.elements().find(|element| element.is_scope() && element.name() == edge.plan);
    if let Some(own) = own.filter(|own| !body_ends(&machine, *own)) {
        let (Edge { from, to, plan }, by) = (edge, own.condition_text());
        let help = "end its last element where the landmark is, as in `(Atom (wait 10s) …)`";
        return Err(Failure::OtherPlan(format!(
            "the plan `{plan}` from {from} to {to} never arrives: only its own condition `{by}` can end it\nhelp: {help}"
        )));
    }
    let graph = graph.to_owned();
    Ok(Leg { edge: edge.clone(), turned, graph, name, machine, input })
}
