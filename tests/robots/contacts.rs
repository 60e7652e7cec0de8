//! Tests all plans of `plans/` and of the book in every world in which they make sense: a robot comes into contact only
//! if the plan requests contact. Such a plan has an atom whose own interrupt names `bumper`, and after a contact it
//! backs off and turns as far as its author intends. The law `goAvoid` must never cause contact.
//!
//! By default, each plan is driven on one body in each world. `MDLE_LONG=300 cargo test --release -p mdle-tests --test
//! robots contacts:: -- --nocapture` drives a hundred seeds on each of the three bodies; `MDLE_FIRST` is the first
//! seed.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout, reason = "a test tells")]

mod table;

use std::collections::BTreeSet;
use std::time::Duration;

use mdle_runtime::{Meters, MetersPerSecond, PathStore, Pose, Radians, RadiansPerSecond, StoredPath, Twist};
use mdle_sim::{Body, World};
use mdle_tests::book::{Fence, fences, name, pages};
use mdle_tests::chance::repeated;
use mdle_tests::repository::files;

use crate::driven::{Contact, Driven, first_seed, plans, robot};
use table::{Row, TABLE};

const BODIES: [Body; 3] = [Body::Scout, Body::Atrv, Body::Ideal];
/// Time limit of a run.
const LONGEST: Duration = Duration::from_secs(150);
/// A floor whose walls are 50 m from the start.
const FLOOR: &str = "[[wall]]\npoints = [[-50, -50], [50, -50], [50, 50], [-50, 50], [-50, -50]]\n";

/// Returns all plans of the repository that the simulator can run, without duplicates, each with its file or its page
/// of the book.
fn all_plans() -> Vec<(String, Driven)> {
    let mut all = Vec::new();
    let shown: Vec<_> = files(&[".mdle"]).into_iter().filter(|file| file.path.starts_with("plans/")).collect();
    for file in &shown {
        all.extend(plans(&file.path, &file.text).into_iter().map(|plan| (file.path.clone(), plan)));
    }
    let is_shown = |block: &Fence| shown.iter().any(|file| file.text.trim() == block.text.trim());
    for page in pages() {
        let blocks: Vec<Fence> = fences(&page).into_iter().filter(|fence| fence.words[0] == "mdle").collect();
        for block in blocks.iter().filter(|block| !is_shown(block)) {
            let text = with_used(&block.text, &blocks);
            all.extend(plans(name(&page), &text).into_iter().map(|plan| (name(&page).to_owned(), plan)));
        }
    }
    all
}

/// Returns the text of a block with each `use` of a file replaced by the page's block for this file.
fn with_used(text: &str, blocks: &[Fence]) -> String {
    let file = |line: &str| Some(line.strip_prefix("use \"")?.strip_suffix('"')?.to_owned());
    let used = |path: String| blocks.iter().find(|block| block.file().is_some_and(|file| file.ends_with(&path)));
    let line = |line: &str| match file(line) {
        Some(path) => used(path).expect("a block of the page").text.clone(),
        None => format!("{line}\n"),
    };
    text.lines().map(line).collect()
}

/// Returns the text of a file that a page of the book writes.
fn of_book(page: &str, file: &str) -> String {
    let page = pages().into_iter().find(|other| name(other) == page).unwrap();
    fences(&page).into_iter().find(|fence| fence.file() == Some(file)).unwrap().text
}

/// Returns the world with this name, with the start of the plans that are driven in it.
fn world(name: &str) -> World {
    let parsed = |text: &str| World::parse(name, text).unwrap();
    match name {
        "floor" => parsed(FLOOR),
        "home" => parsed(&of_book("simulator.md", "home.toml")),
        "yard" => parsed(&of_book("worlds.md", "yard.toml")),
        "lab 1" => {
            let start = Pose { x: Meters(7.5), y: Meters(0.3), theta: Radians::from_degrees(180.0) };
            let mut office = World::office().unwrap();
            office.start = start;
            office
        }
        name => World::named(name).unwrap().unwrap(),
    }
}

/// Returns a store with the path that the book shows.
fn paths() -> PathStore {
    let fastest = Twist { v: MetersPerSecond(1.0), omega: RadiansPerSecond(6.0) };
    let setpoints = mdle_host::setpoints("bend.csv", of_book("quarks.md", "bend.csv").as_bytes(), fastest).unwrap();
    PathStore::new(vec![StoredPath { name: "bend", setpoints: setpoints.leak() }].leak())
}

/// Contacts of a plan in a world.
#[derive(Default)]
struct Touched {
    /// A line about the first contact that the plan did not request, for each run with such a contact.
    unasked: Vec<String>,
    /// Number of contacts during atoms whose interrupt names `bumper`.
    by_bumper: usize,
}

/// Drives a plan in a world `runs` times, and returns its contacts.
fn touched(row: &Row, plan: &Driven, place: &str, paths: PathStore, runs: u64) -> Touched {
    let (world, mut touched) = (world(place), Touched::default());
    for run in 0..runs {
        // The first body depends on the plan and the world.
        let seed = first_seed(0) + run / 3;
        let body = BODIES[(run as usize + plan.name.len() + place.len()) % BODIES.len()];
        let contacts = plan.drive(robot(body, &world, seed), paths, LONGEST).contacts;
        touched.by_bumper += contacts.iter().filter(|contact| contact.interrupt.contains("bumper")).count();
        let is_asked = |contact: &&Contact| {
            contact.interrupt.contains("bumper") || !row.asks.is_empty() && !contact.law.starts_with("goAvoid")
        };
        if let Some(Contact { t, law, interrupt, pose }) = contacts.iter().find(|contact| !is_asked(contact)) {
            let (x, y, heading) = (pose.x.0, pose.y.0, pose.theta.degrees());
            let when = format!("{} {} in {place}: {body} {seed} at {t:.1} s", row.file, plan.name);
            touched.unasked.push(format!("{when}, ({x:.2}, {y:.2}) heading {heading:.0}: {law} until {interrupt}"));
        }
    }
    touched
}

#[test]
fn every_plan_has_its_worlds() {
    let listed: BTreeSet<_> =
        TABLE.iter().map(|Row { file, plan, .. }| ((*file).to_owned(), (*plan).to_owned())).collect();
    let there: BTreeSet<_> = all_plans().into_iter().map(|(file, plan)| (file, plan.name)).collect();
    assert_eq!(listed, there);
}

#[test]
fn robots_touch_what_their_plans_ask_for() {
    let (paths, runs) = (paths(), repeated(1));
    let (all, mut faults) = (all_plans(), Vec::new());
    for row in TABLE {
        for (_, plan) in all.iter().filter(|(file, plan)| *file == row.file && plan.name == row.plan) {
            for place in row.worlds.split(", ") {
                let Touched { unasked, by_bumper } = touched(row, plan, place, paths, runs);
                unasked.iter().for_each(|line| println!("{line}"));
                let count = unasked.len() as u64;
                let why = if row.asks.is_empty() { row.cause } else { row.asks };
                println!(
                    "{} {} in {place}: {count} of {runs}, and {by_bumper} by `bumper`; {why}",
                    row.file, plan.name
                );
                assert!(by_bumper == 0 || !row.asks.is_empty(), "{} {} asks for contact: say why", row.file, plan.name);
                if count > (row.most * runs).div_ceil(100) {
                    faults.extend(unasked);
                }
            }
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}
