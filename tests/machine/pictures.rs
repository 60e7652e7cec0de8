//! Tests pictures of random plans: they are complete, nothing leaves their edges, and they show every condition and the
//! transitions of the plan. Also tests plans that are too large for a picture.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]
#![allow(clippy::print_stdout, reason = "who reads a failure wants the seed and the plan")]

use std::collections::BTreeSet;
use std::fs;
use std::io::Write;
use std::process::{Command, Stdio};

use mdle_compiler::Compiled;
use mdle_compiler::fsm::{Machine, expand, lower};
use mdle_compiler::picture::{dot, mermaid, svg};
use mdle_compiler::plan::Condition;
use mdle_compiler::trace::{Script, TableMachine, TraceLine, run};
use mdle_tests::chance::{Chance, repeated};
use mdle_tests::executable::{folder, run_mdlec};
use mdle_tests::golden::judge;
use mdle_tests::graphs::{Graph, read_dot, read_mermaid};
use mdle_tests::pipeline::compile;
use mdle_tests::random_plan::RandomPlan;
use mdle_tests::random_script::script;
use mdle_tests::repository::TextFile;
use mdle_tests::xml::{Element, read};

/// Number of random plans.
const PLANS: u64 = 100;

/// Returns random plans, each with its seed and a random script.
fn plans() -> impl Iterator<Item = (u64, Compiled, String)> {
    (0..repeated(PLANS)).filter_map(|seed| {
        let mut chance = Chance::new(seed);
        let text = RandomPlan::new(&mut chance, 2 + (seed % 30) as usize, false).to_string();
        let script = script(&mut chance, 12);
        println!("seed {seed}\n{text}");
        compile(&text).ok().map(|compiled| (seed, compiled, script))
    })
}

/// Left, top, right and bottom of a rectangle.
type Edges = [i64; 4];

fn edges(rectangle: &Element) -> Edges {
    let number = |name: &str| rectangle.attributes.get(name).map_or(0, |text| text.parse().expect("a whole number"));
    let (x, y) = (number("x"), number("y"));
    [x, y, x + number("width"), y + number("height")]
}

fn is_inside(inner: Edges, outer: Edges) -> bool {
    inner[0] >= outer[0] && inner[1] >= outer[1] && inner[2] <= outer[2] && inner[3] <= outer[3]
}

/// Returns the boxes of a picture in the order of their brackets, each with its edges.
fn boxes(picture: &Element) -> Vec<(&Element, Edges)> {
    let groups = picture.children.iter().filter(|child| child.name == "g");
    groups.map(|group| (group, edges(&group.children[1]))).collect()
}

/// Asserts that a picture has a box for each element, inside the box of the enclosing element and apart from the boxes
/// beside it, that texts and lines stay within their edges, and that the picture contains each condition.
fn assert_well_drawn(machine: &Machine, picture: &Element) {
    let whole = edges(picture);
    let boxes = boxes(picture);
    assert_eq!(boxes.len(), machine.elements().len());
    let outside_boxes =
        picture.children.iter().filter(|child| child.name == "text" && child.attribute("class") == "quiet");
    for text in outside_boxes.filter(|text| !text.attributes.contains_key("text-anchor")) {
        let x: i64 = text.attribute("x").parse().unwrap();
        let right = x + text.text.chars().count() as i64 * 73 / 10;
        assert!(right <= whole[2], "{:?} leaves the picture", text.text);
    }
    for (element, (number, (group, here))) in machine.elements().zip(boxes.iter().enumerate()) {
        let parent = element.parent().map(|around| around.index());
        let around = parent.map_or(whole, |parent| boxes[parent].1);
        assert!(is_inside(*here, around), "box {number} leaves the one around it: {here:?} {around:?}");
        for (other, (_, there)) in machine.elements().zip(&boxes).take(number) {
            let beside = other.parent().map(|around| around.index()) == parent;
            let other = other.number();
            let apart = here[0] >= there[2] || there[0] >= here[2] || here[1] >= there[3] || there[1] >= here[3];
            assert!(!beside || apart, "boxes {other} and {number} overlap");
        }
        for text in group.children.iter().filter(|child| child.name == "text" && child.attribute("class") != "count") {
            let x: i64 = text.attribute("x").parse().unwrap();
            // Letters are 12 pixels high and at most 7.3 pixels wide.
            let right = x + text.text.chars().count() as i64 * 73 / 10;
            assert!(right <= here[2], "{:?} is too long for its box", text.text);
        }
        if let Some(interrupt) = element.interrupt().filter(|interrupt| interrupt.condition != Condition::Null) {
            let title = &group.children[0].text;
            let is_shown = title.contains(&interrupt.text) || title.contains("done");
            assert!(is_shown, "{title:?} does not tell {}", interrupt.text);
        }
    }
    let lines =
        picture.all().into_iter().filter(|element| element.name == "path" && element.attributes.contains_key("class"));
    for path in lines.filter(|path| path.attribute("class").starts_with("flow")) {
        let words = path.attribute("d").split(['M', 'L', 'Q', ' ']).filter(|word| !word.is_empty());
        let numbers: Vec<i64> = words.map(|word| word.parse().expect("a whole number")).collect();
        let outside = numbers.chunks(2).find(|point| !is_inside([point[0], point[1], point[0], point[1]], whole));
        assert_eq!((numbers.len() % 2, outside), (0, None), "{path:?}");
    }
}

#[test]
fn boxes_are_inside_each_other_and_beside_each_other_and_tell_everything() {
    let mut atoms = 0;
    for (_, compiled, _) in plans() {
        let text = svg(&compiled.machine).unwrap();
        assert_well_drawn(&compiled.machine, &read(&text));
        assert_eq!(svg(&compiled.machine).unwrap(), text);
        atoms += compiled.machine.atoms().len();
    }
    assert!(atoms > 6 * repeated(PLANS) as usize, "{atoms} atoms");
}

fn compiled(text: &str) -> Compiled {
    let (mut compiled, message) = judge(&TextFile { path: "plan.mdle".into(), text: text.into() }, None);
    assert_eq!(compiled.len(), 1, "{message}");
    compiled.swap_remove(0)
}

#[test]
fn plans_of_3_to_1000_atoms_are_no_wider_than_a_screen() {
    for atoms in [3, 10, 60, 1000] {
        let atom = "(Atom (atIsection 0100 OR wait 20) (goAvoid 90 40 20))";
        let machine = compiled(&format!("{{ P (bumper) {} }}", atom.repeat(atoms))).machine;
        let picture = read(&svg(&machine).unwrap());
        assert_well_drawn(&machine, &picture);
        let [.., width, height] = edges(&picture);
        assert!(width <= 1300 && height <= 200 + 40 * atoms as i64, "{atoms} atoms: {width} by {height}");
    }
}

#[test]
fn a_long_condition_is_whole_in_its_tooltip() {
    let operands: Vec<_> = (1..=50).map(|seconds| format!("wait {seconds}")).collect();
    let condition = operands.join(" OR ");
    let text = svg(&compiled(&format!("{{ P ({condition}) (Atom (bumper) stop) }}")).machine).unwrap();
    let picture = read(&text);
    let (group, _) = boxes(&picture)[0];
    assert_eq!(group.children[0].text, format!("P\nuntil {condition}"));
    assert!(group.children.iter().any(|child| child.text.ends_with('…')), "{text}");
    // Very long conditions are shortened in tooltips, too.
    let long: Vec<_> = (1..=2000).map(|seconds| format!("wait {seconds}")).collect();
    let text = svg(&compiled(&format!("{{ P (Atom ({}) stop) }}", long.join(" OR "))).machine).unwrap();
    assert!(text.len() < 20_000 && text.contains("more characters"), "{} bytes", text.len());
}

/// Returns `true` if an edge leads from the state `from`, or from a cluster that contains it, to the state `to`.
fn leads(graph: &Graph, from: &str, to: &str) -> bool {
    graph.edges.iter().any(|(tail, head, attributes)| {
        let cluster = attributes.get("class").map(|name| &graph.clusters[name]);
        head == to && (tail == from || cluster.is_some_and(|cluster| cluster.contains(from)))
    })
}

#[test]
fn graphs_have_the_transitions_of_the_plan() {
    let mut transitions = 0_u64;
    for (seed, compiled, script) in plans() {
        let graph = read_dot(&dot(&compiled.machine).unwrap());
        assert_eq!(graph.nodes.len(), compiled.machine.atoms().len() + 2);
        for (from, to, attributes) in &graph.edges {
            assert!(graph.nodes.contains_key(from) && graph.nodes.contains_key(to), "{from} -> {to}");
            if let Some(cluster) = attributes.get("ltail") {
                let inside = &graph.clusters[cluster];
                assert!(inside.contains(from) && !inside.contains(to), "{from} -> {to} of {cluster}");
            }
        }
        if compiled.machine.states() > 300 {
            continue;
        }
        let expanded = lower(&expand(&compiled.nondegenerate).unwrap()).unwrap();
        let graph = read_dot(&dot(&expanded).unwrap());
        let name = |state: u64| if state == expanded.states() { "over".into() } else { format!("a{state}") };
        let turns = Script::read(&script).unwrap();
        for TraceLine { outcome, .. } in run(TableMachine::new(&compiled.nondegenerate).unwrap(), &turns)
            .filter(|line| line.outcome.fired.len() < 100)
        {
            let behind = outcome.fired.iter().skip(1).map(|fired| fired.from).chain([outcome.state]);
            for (fired, to) in outcome.fired.iter().zip(behind) {
                let (from, to) = (name(fired.from), name(to));
                transitions += 1;
                assert!(leads(&graph, &from, &to), "seed {seed}: no edge {from} -> {to}");
            }
        }
    }
    assert!(transitions > repeated(PLANS), "{transitions} transitions");
}

#[test]
fn graphviz_takes_the_graphs_where_it_is_installed() {
    let with = |text: &str| {
        let mut command = Command::new("dot");
        command.arg("-Tsvg").stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = command.spawn().ok()?;
        child.stdin.take().unwrap().write_all(text.as_bytes()).unwrap();
        child.wait_with_output().ok()
    };
    for (seed, compiled, _) in plans().filter(|(seed, ..)| seed % 30 == 29) {
        let text = dot(&compiled.machine).unwrap();
        // Without Graphviz, only the grammar of the graph is checked.
        assert!(!read_dot(&text).nodes.is_empty());
        let Some(output) = with(&text) else { continue };
        let message = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success() && message.is_empty(), "seed {seed}: {message}\n{text}");
    }
}

#[test]
fn diagrams_have_every_atom_and_lead_nowhere_outside() {
    for (_, compiled, _) in plans() {
        let machine = &compiled.machine;
        let diagram = read_mermaid(&mermaid(machine).unwrap());
        let states: BTreeSet<_> = diagram.states.values().flatten().collect();
        assert_eq!(states.len(), machine.elements().len());
        // Each composite state has an initial transition.
        let begins = diagram.transitions.values().flatten().filter(|(from, ..)| from == "[*]");
        assert_eq!(begins.count(), diagram.transitions.len());
    }
}

/// A plan with a behavior, both kinds of loops, and texts that must be escaped.
const PLAN: &str = "{ Patrol (bumper OR wait 600)\n  s1: (Atom (r_3 < 40cm) (goAvoid 90 40 20))\n  ({ Leg (wait 30) \
                    (Atom (wait 1) (go 20 0)) ((Atom (wait 2) (go 5 0)) (Atom (null) turn 90))^3 }\n   (Atom (after s1) \
                    stop))^inf\n}\n";

#[test]
fn pictures_as_text() {
    let machine = compiled(PLAN).machine;
    insta::assert_snapshot!("patrol_dot", dot(&machine).unwrap());
    insta::assert_snapshot!("patrol_mermaid", mermaid(&machine).unwrap());
}

#[test]
fn draw_writes_a_file_or_prints() {
    let folder = folder("draw");
    fs::write(folder.join("plan.mdle"), PLAN).unwrap();
    let printed = run_mdlec(&folder, &["draw", "plan.mdle"]);
    assert_eq!(printed.status.code(), Some(0));
    let written = run_mdlec(&folder, &["draw", "plan.mdle", "-o", "plan.svg"]);
    assert_eq!((written.status.code(), written.stdout.len()), (Some(0), 0));
    assert!(fs::read(folder.join("plan.svg")).unwrap() == printed.stdout);
    for (kind, begin) in [("dot", "digraph \"Patrol\" {\n"), ("mermaid", "stateDiagram-v2\n"), ("scxml", "<?xml ")] {
        let printed = run_mdlec(&folder, &["plan.mdle", "--emit", kind]);
        assert!(String::from_utf8(printed.stdout).unwrap().starts_with(begin));
    }
    let nowhere = run_mdlec(&folder, &["draw", "plan.mdle", "-o", "no/plan.svg"]);
    assert_eq!(nowhere.status.code(), Some(2));
}

#[test]
fn too_large_a_picture_is_an_error_with_help() {
    let folder = folder("draw_large");
    let plans = [
        (format!("{{ P {} }}", "(Atom (wait 1) stop)\n".repeat(100_000)), "has 100000 atoms; a picture shows 1000"),
        (format!("{{ P {} }}", "({ Q (Atom (wait 1) stop) })^2\n".repeat(501)), "1003 scopes and loops"),
    ];
    for (plan, report) in plans {
        fs::write(folder.join("plan.mdle"), plan).unwrap();
        for arguments in
            [&["draw", "plan.mdle"][..], &["plan.mdle", "--emit", "dot"], &["plan.mdle", "--emit", "mermaid"]]
        {
            let output = run_mdlec(&folder, arguments);
            let message = String::from_utf8(output.stderr).unwrap();
            assert_eq!((output.status.code(), output.stdout.len()), (Some(1), 0), "{message}");
            assert!(
                message.contains("error[E0502]") && message.contains(report) && message.contains("`--plan NAME`"),
                "{message}"
            );
        }
    }
}
