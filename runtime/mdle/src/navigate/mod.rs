//! `mdle navigate`: drives from one landmark to another with the plans of a graph (docs/src/navigation.md).

mod landmarks;

use std::ffi::OsString;
use std::path::Path;
use std::process::ExitCode;
use std::sync::Arc;

use mdle_compiler::alphabet::did_you_mean;
use mdle_engine::Library;
use mdle_files::{InputError, KnownSettings, SafetyEntry, Settings, Target, read_plan};
use mdle_host::{Call, Program, RecordedPlan};
use mdle_runtime::{Printable, Sensed};

use crate::arguments::Navigate;
use crate::failure::{self, Failure};
use crate::plans::texts;
use crate::route::{Edge, LandmarkGraph, LandmarkMap, Leg, LookPlan, Route, leg};
use crate::targets;
use landmarks::Landmarks;

/// Name of the file of landmarks beside a graph.
const LANDMARKS: &str = "landmarks.toml";

/// Drives from one landmark to another with the modules in `library`; returns the exit status of the run.
///
/// # Errors
/// Fails if there is no route, or if a plan on it cannot be run.
pub(crate) fn navigate(arguments: Navigate, library: &mut Library<Sensed>) -> Result<ExitCode, Failure> {
    let settings = Settings::beside(&arguments.graph)?;
    if let Some(SafetyEntry { place, .. }) = settings.safety() {
        return Err(Failure::Usage(format!("{place}: `mdle navigate` has no safety rules")));
    }
    let name = settings.name_of_target(arguments.target.as_deref()).ok_or(InputError::NoTarget)?;
    let linked = targets::linked(&name).map_err(Failure::Usage)?;
    let target = Arc::new(settings.target(arguments.target.as_deref())?);
    let mut input = read_plan(&arguments.graph, &target)?;
    let graph = LandmarkGraph::of(input.labels());
    let route = route(&graph, &arguments)?;
    for Edge { from, to, plan } in &route {
        if input.takes_parameters(plan) {
            let help = format!("label a plan that uses it: `Γ_{from}^{to} = {{ Name {plan}(…) }}`");
            let sentence = format!("the plan `{plan}` from {from} to {to} takes parameters, and a route gives it none");
            return Err(Failure::OtherPlan(format!("{sentence}\nhelp: {help}")));
        }
    }
    let (beside, known) = (arguments.graph.with_file_name(LANDMARKS), graph.landmarks());
    let file = arguments.landmarks.as_deref();
    let file = (file.unwrap_or(&beside), file.is_some());
    let described = Landmarks::read(file.0, file.1, &known).map_err(Failure::Usage)?;
    let is_described = described.is_some();
    let landmarks = described.unwrap_or_default();
    let legs = legs(&route, &landmarks, &arguments, &target)?;
    let Some(first) = legs.first() else {
        let sentence = format!("the robot is at {} already", Printable(&arguments.to));
        failure::print_line(&sentence)?;
        return Ok(ExitCode::SUCCESS);
    };
    failure::print_line(&format!("route: {}", words(&route)))?;
    if !is_described {
        failure::warning(&without_axes(file.0));
    }
    let maps = landmarks.maps(file.0, landmarks.axis(&arguments.from))?;
    let places = landmarks.places(landmarks.axis(&arguments.from));
    let look = (!maps.is_empty()).then(|| LookPlan::of(maps, &arguments.graph, &target)).transpose()?;
    if let Some(sentence) = look.as_ref().and_then(|look| lonely(&look.maps)) {
        failure::warning(&sentence);
    }
    let looks = look.as_ref().filter(|look| look.maps.iter().any(|map| map.name == arguments.from));
    let program = Program { plan: &first.name, version: "" };
    let given: Vec<_> = arguments.options.iter().map(|option| option.to_string_lossy().into_owned()).collect();
    let mut options: Vec<OsString> = Vec::new();
    for option in settings.run_options(arguments.target.as_deref(), &given, |_| KnownSettings::default())? {
        (linked.check)(program, &call(&arguments, option.arguments.clone())).map_err(|text| option.refused(&text))?;
        options.extend(option.arguments);
    }
    options.extend(arguments.options.iter().cloned());
    let files = texts(looks.map_or(&first.input, |look| &look.input));
    let recorded = RecordedPlan { files, ..RecordedPlan::default() };
    let read = input.inputs(&target);
    let route = Route { legs, look, places };
    (linked.navigate)(&route, &target, Call { recorded, read, ..call(&arguments, options) }, library)
}

/// Returns a warning if only one landmark has a map; `None` otherwise.
fn lonely(maps: &[LandmarkMap]) -> Option<String> {
    let [LandmarkMap { name, .. }] = maps else { return None };
    let (name, help) = (Printable(name), "name a `map` of each landmark that a robot may mistake for it");
    Some(format!("{name} is the only landmark with a map: a robot at another one may pass as at {name}\nhelp: {help}"))
}

/// Returns a warning about the file of landmarks, which is missing.
fn without_axes(file: &Path) -> String {
    let sentence = format!("there is no file `{}`, so all landmarks have the axis 0", file.display());
    let entry = "`[[landmark]]`, `name = \"…\"` and `axis = \"…deg\"`";
    format!("{sentence}\nhelp: write {entry} of each landmark there, or name another file by `--landmarks`")
}

fn call(arguments: &Navigate, options: Vec<OsString>) -> Call {
    let recorded = RecordedPlan::default();
    Call {
        words: arguments.words.clone(),
        options,
        read: Vec::new(),
        recorded,
        later_path: None,
        own_options: Vec::new(),
    }
}

/// Finds the route that leads from each landmark to the next.
fn route<'g>(graph: &'g LandmarkGraph, arguments: &Navigate) -> Result<Vec<&'g Edge>, Failure> {
    let (mut edges, mut from) = (Vec::new(), arguments.from.as_str());
    for to in arguments.to.split(',') {
        edges.extend(part(graph, arguments, from, to)?);
        from = to;
    }
    Ok(edges)
}

/// Finds the route from one landmark to another; the result lists the edges of the graph.
fn part<'g>(
    graph: &'g LandmarkGraph,
    Navigate { graph: file, .. }: &Navigate,
    from: &str,
    to: &str,
) -> Result<Vec<&'g Edge>, Failure> {
    let (known, file) = (graph.landmarks(), file.display());
    if known.is_empty() {
        let help = "write the landmarks before the plan, as in `Γ_a^b = { Name … }`";
        return Err(Failure::Usage(format!("no plan of {file} leads from one landmark to another\nhelp: {help}")));
    }
    if let Some(name) = [from, to].into_iter().find(|name| !known.contains(name)) {
        let (name, near) = (Printable(name), did_you_mean(name, &known));
        let help = format!("its landmarks are {}", known.join(", "));
        return Err(Failure::Usage(format!("{file} has no landmark `{name}`{near}\nhelp: {help}")));
    }
    graph.route(from, to).ok_or_else(|| {
        let reachable = graph.reachable(from);
        let help = match reachable.is_empty() {
            true => format!("no plan begins at {from}"),
            false => format!("routes lead from {from} to {}", reachable.join(", ")),
        };
        Failure::OtherPlan(format!("{file} has no route from {from} to {to}\nhelp: {help}"))
    })
}

fn words(route: &[&Edge]) -> String {
    let first = route.first().map_or("", |edge| &edge.from);
    let rest = route.iter().map(|edge| format!(" -> {} ({})", edge.to, edge.plan));
    first.to_owned() + &rest.collect::<String>()
}

/// Compiles the plans of a route, and checks that each of them can end. Odometry begins in the frame of the first
/// landmark.
fn legs(route: &[&Edge], landmarks: &Landmarks, arguments: &Navigate, target: &Target) -> Result<Vec<Leg>, Failure> {
    let begins = landmarks.axis(&arguments.from);
    let legs = route.iter().enumerate().map(|(number, edge)| {
        let turned = (landmarks.axis(&edge.from) - begins).rem_euclid(360.0);
        leg(edge, number, turned, &arguments.graph, target)
    });
    legs.collect()
}
