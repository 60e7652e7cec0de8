//! Tests the book: its pages are linked, its links lead to existing pages, and its examples behave as the pages
//! describe.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

use mdle_tests::book::{Fence, anchors, fences, leads_to, links, messages, name, pages};
use mdle_tests::executable::{folder, mdle, run_mdlec};
use mdle_tests::repository::{TextFile, root};
use serde_json::Value;

#[test]
fn every_page_stands_in_the_summary_once() {
    let (summary, pages): (Vec<_>, Vec<_>) = pages().into_iter().partition(|page| name(page) == "SUMMARY.md");
    let mut listed = links(&summary[0]);
    listed.sort_unstable();
    assert_eq!(listed, pages.iter().map(name).collect::<Vec<_>>());
    assert!(listed.len() > 10, "the pages are gone");
}

#[test]
fn links_lead_to_a_page_and_a_heading_of_it() {
    let pages = pages();
    for page in &pages {
        for link in links(page).into_iter().filter(|link| !link.starts_with("https://")) {
            if link.ends_with(".svg") {
                assert!(root().join("docs/src").join(link).exists(), "{}: no picture {link}", page.path);
                continue;
            }
            let (file, anchor) = link.split_once('#').unwrap_or((link, ""));
            let file = leads_to(page, file);
            let target = pages.iter().find(|page| name(page) == file);
            let target = target.unwrap_or_else(|| panic!("{}: no page {file}", page.path));
            let is_there = anchor.is_empty() || anchors(target).iter().any(|heading| heading == anchor);
            assert!(is_there, "{}: no heading {link}", page.path);
        }
    }
}

#[test]
fn messages_are_as_they_are_explained() {
    let path = root().join("docs/src/messages.md");
    if std::env::var("INSTA_UPDATE").is_ok_and(|update| update == "always") {
        fs::write(&path, messages()).unwrap();
    }
    let committed = fs::read_to_string(path).unwrap();
    assert!(committed == messages(), "INSTA_UPDATE=always writes docs/src/messages.md");
}

/// The examples of a page, which are executed in order in a folder.
struct Walk<'p> {
    page: &'p TextFile,
    folder: PathBuf,
    plan: String,
    script: String,
}

impl Walk<'_> {
    fn write(&self, file: &str, fence: &Fence) -> String {
        let path = self.folder.join(file);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, &fence.text).unwrap();
        file.to_owned()
    }

    fn step(&mut self, fence: &Fence) {
        match fence.words[0].as_str() {
            "mdle" => {
                self.plan = self.write(fence.file().unwrap_or("plan.mdle"), fence);
                self.check(fence);
            }
            "script" => self.script = self.write(fence.file().unwrap_or("script.jsonl"), fence),
            "trace" => self.trace(&fence.text),
            "alphabet" => {
                let file = self.write(fence.file().unwrap_or("./alphabet.mdle"), fence);
                let target = file.strip_suffix("/alphabet.mdle").unwrap();
                let output = run_mdlec(&self.folder, &["quarks", "--target", target]);
                assert!(output.status.success(), "{}: {}", self.page.path, answer(&output));
            }
            "diff" => self.patch(fence),
            "console" => fence.text.split("$ ").skip(1).for_each(|command| self.run(command)),
            "text" => self.compare(fence),
            // Later commands of the page use these files; the packages of a page are built in tests/compiled.
            "commands" | "csv" | "json" | "python" | "rust" | "toml" => drop(self.write(fence.file().unwrap(), fence)),
            "sh" => {}
            other => panic!("{}: what is `{other}`?", self.page.path),
        }
    }

    /// Changes a file as a reader does: replaces the lines that are marked `-` with the following lines that are marked
    /// `+`.
    fn patch(&self, fence: &Fence) {
        let path = self.folder.join(fence.file().expect("a file to change"));
        let mut text = fs::read_to_string(&path).unwrap();
        for change in fence.text.split("\n\n") {
            let lines = |mark| {
                let lines = change.lines().filter_map(|line| line.strip_prefix(mark));
                lines.fold(String::new(), |text, line| text + line + "\n")
            };
            let (before, after) = (lines('-'), lines('+'));
            assert_eq!(text.matches(&before).count(), 1, "{}: {before}", self.page.path);
            text = text.replace(&before, &after);
        }
        fs::write(path, text).unwrap();
    }

    /// Compares the block with the file that it names, if it names one.
    fn compare(&self, fence: &Fence) {
        let Some(file) = fence.file() else { return };
        assert_eq!(fs::read_to_string(self.folder.join(file)).unwrap(), fence.text, "{}: {file}", self.page.path);
    }

    /// Asserts that a plan causes exactly the expected codes.
    fn check(&self, fence: &Fence) {
        let answer = answer(&run_mdlec(&self.folder, &["check", &self.plan, "--message-format", "json"]));
        let codes = answer.lines().filter_map(|line| {
            let message: Value = serde_json::from_str(line).expect(line);
            message["code"].as_str().map(str::to_owned)
        });
        let expected: BTreeSet<_> = fence.codes().into_iter().map(str::to_owned).collect();
        assert_eq!(codes.collect::<BTreeSet<_>>(), expected, "{}\n{}\n{answer}", self.page.path, fence.text);
    }

    /// Asserts that all machines print this trace of the last plan with the last script.
    fn trace(&self, expected: &str) {
        for machine in ["tree", "table", "matrix", "counted"] {
            let arguments = ["trace", &self.plan, "--script", &self.script, "--machine", machine];
            let output = run_mdlec(&self.folder, &arguments);
            let trace = String::from_utf8_lossy(&output.stdout);
            assert_eq!(trace, expected, "{}, machine {machine}: {}", self.page.path, answer(&output));
        }
    }

    /// Runs a command as a reader types it, and compares its output with the page. If the page shows no output, asserts
    /// that the command succeeds.
    fn run(&self, command: &str) {
        let (command, expected) = command.split_once('\n').unwrap();
        let words = words(command);
        let output = match words[0] {
            "mdlec" => run_mdlec(&self.folder, &words[1..]),
            "mdle" => Command::new(mdle()).args(&words[1..]).current_dir(&self.folder).output().unwrap(),
            // The program is called by the typed name, because it may print this name.
            program => Command::new(program).args(&words[1..]).current_dir(&self.folder).output().unwrap(),
        };
        let answer = answer(&output);
        if expected.is_empty() {
            assert!(output.status.success(), "{}: {command}\n{answer}", self.page.path);
        } else {
            assert!(is_alike(&answer, expected), "{}: {command}\n{answer}", self.page.path);
        }
    }
}

impl Walk<'_> {
    /// Compares the pictures on the page with the pictures that its commands have drawn.
    fn pictures(&self) {
        for picture in
            links(self.page).into_iter().filter(|link| link.ends_with(".svg") && self.folder.join(link).exists())
        {
            let (drawn, shown) = (self.folder.join(picture), root().join("docs/src").join(picture));
            let drawn = fs::read(drawn).unwrap();
            if std::env::var("INSTA_UPDATE").is_ok_and(|update| update == "always") {
                fs::write(&shown, &drawn).unwrap();
            }
            assert!(fs::read(&shown).is_ok_and(|shown| shown == drawn), "INSTA_UPDATE=always writes {shown:?}");
        }
    }
}

/// Splits a command into words as a shell does; a quoted text is a single word.
fn words(command: &str) -> Vec<&str> {
    let mut is_quoted = false;
    let ends = command.split(|letter: char| {
        is_quoted ^= letter == '\'';
        letter == ' ' && !is_quoted
    });
    ends.map(|word| word.strip_prefix('\'').and_then(|word| word.strip_suffix('\'')).unwrap_or(word)).collect()
}

fn answer(output: &Output) -> String {
    format!("{}{}", String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr))
}

/// Returns `true` if the output is equal to the page's text, in which a line `…` stands for any omitted lines.
fn is_alike(answer: &str, shown: &str) -> bool {
    match shown.split_once("…\n") {
        None => answer == shown,
        Some((start, end)) => answer.len() > shown.len() && answer.starts_with(start) && answer.ends_with(end),
    }
}

#[test]
fn examples_do_what_the_book_says() {
    let (pages, next, traces) = (pages(), AtomicUsize::new(0), AtomicUsize::new(0));
    // Pages are tested in parallel, because most commands use one processor.
    thread::scope(|scope| {
        for _ in 0..thread::available_parallelism().map_or(1, usize::from) {
            scope.spawn(|| {
                while let Some(page) = pages.get(next.fetch_add(1, Ordering::Relaxed)) {
                    traces.fetch_add(walked(page), Ordering::Relaxed);
                }
            });
        }
    });
    let traces = traces.into_inner();
    assert!(traces >= 20, "the book has {traces} traces");
}

/// Asserts that the examples of a page behave as the page describes; returns the number of its traces.
fn walked(page: &TextFile) -> usize {
    let folder = folder(&format!("book_{}", name(page)));
    let mut walk = Walk { page, folder, plan: String::new(), script: String::new() };
    let fences = fences(page);
    fences.iter().for_each(|fence| walk.step(fence));
    walk.pictures();
    let count = |word: &str| fences.iter().filter(|fence| fence.words[0] == word).count();
    assert_eq!(count("script"), count("trace") + usize::from(name(page) == "first_plan.md"), "{}", page.path);
    count("trace")
}

#[test]
fn the_book_shows_every_plan_to_learn_from() {
    let shown = pages().into_iter().find(|page| name(page) == "plans.md").unwrap().text;
    let plans = fs::read_dir(root().join("plans")).unwrap().map(|entry| entry.unwrap().path());
    for plan in plans.filter(|plan| plan.extension().is_some_and(|ending| ending == "mdle")) {
        let file = Path::new(&plan).file_name().unwrap().to_str().unwrap();
        assert!(shown.contains(&format!("{{{{#include ../../plans/{file}}}}}")), "{file} is not in docs/src/plans.md");
    }
}

#[test]
fn the_book_shows_the_template_of_a_module() {
    let page = pages().into_iter().find(|page| name(page) == "own_module.md").unwrap();
    for file in ["lib.rs", "main.rs"] {
        let shown = fences(&page).into_iter().find(|fence| fence.words == ["rust", file]).unwrap();
        assert_eq!(shown.text, fs::read_to_string(root().join("runtime/template/src").join(file)).unwrap(), "{file}");
    }
    for file in ["closing.rs", "wall.rs"] {
        let shown = fences(&page).into_iter().find(|fence| fence.words == ["rust", file]).unwrap();
        assert_eq!(shown.text, fs::read_to_string(root().join("tests/robots").join(file)).unwrap(), "{file}");
    }
}

#[test]
fn the_page_on_worlds_names_every_key() {
    let page = pages().into_iter().find(|page| name(page) == "worlds.md").unwrap().text;
    let format = fs::read_to_string(root().join("targets/sim/simulator/src/world_file/text.rs")).unwrap();
    let obstacles = format.split("rename = \"").skip(1).filter_map(|rest| rest.split('"').next());
    let obstacles: Vec<_> = obstacles.map(|kind| format!("`[[{kind}]]`")).collect();
    let fields =
        format.lines().filter(|line| !line.contains("Vec<TomlTable<") && !line.contains("Vec<Spanned<TomlTable<"));
    let keys = fields.filter_map(|line| line.trim().strip_prefix("pub(super) ")?.split_once(": "));
    let keys: Vec<_> = keys.map(|(key, _)| format!("`{key}`")).collect();
    assert!(obstacles.len() == 5 && keys.len() > 20, "{obstacles:?} {keys:?}");
    for key in obstacles.iter().chain(&keys) {
        assert!(page.contains(key), "docs/src/worlds.md does not name {key}");
    }
}

#[test]
fn frames_of_the_protocols_are_tested_packets() {
    let page = pages().into_iter().find(|page| name(page) == "reference/protocols.md").unwrap().text;
    let tests = ["scout", "atrv"].map(|robot| root().join(format!("targets/{robot}/tests/packets.rs")));
    let tested: String = tests.iter().map(|path| fs::read_to_string(path).unwrap()).collect();
    let is_byte = |word: &str| word.len() == 2 && u8::from_str_radix(word, 16).is_ok();
    let is_frame = |code: &&str| code.split(' ').count() > 4 && code.split(' ').all(is_byte);
    let frames: Vec<_> = page.split('`').skip(1).step_by(2).filter(is_frame).collect();
    assert!(frames.len() > 20, "{frames:?}");
    let untested: Vec<_> = frames.into_iter().filter(|frame| !tested.contains(&format!("\"{frame}\""))).collect();
    assert_eq!(untested, [""; 0]);
}
