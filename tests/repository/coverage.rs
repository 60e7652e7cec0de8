//! Tests that the table `coverage.toml` is complete and correct: each production of the grammar, each rule for the
//! meaning of plans, and each code of a diagnostic has a test that exists.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::collections::{BTreeMap, BTreeSet};

use mdle_compiler::diagnostic::{Code, SourceId};
use mdle_compiler::syntax::{arena_for, parse};
use mdle_tests::book::pages;
use mdle_tests::citations::numbered_sections;
use mdle_tests::grammar::{Production, productions};
use mdle_tests::productions::{Productions, count};
use mdle_tests::repository::{TextFile, files, root};
use serde::Deserialize;

/// Content of `coverage.toml`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Table {
    productions: Vec<Covered>,
    rules: Vec<Rule>,
    codes: BTreeMap<String, Vec<String>>,
}

/// Productions that are covered by the same tests.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Covered {
    tests: Vec<String>,
    covers: Vec<String>,
}

/// A rule for the meaning of plans, with its tests.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Rule {
    section: String,
    says: String,
    tests: Vec<String>,
}

fn table() -> Table {
    toml::from_str(&std::fs::read_to_string(root().join("tests/coverage.toml")).unwrap()).expect("the table")
}

/// Returns the texts of all tests in the repository, with keys of the form `path: name`.
fn tests() -> BTreeMap<String, String> {
    let mut tests = BTreeMap::new();
    for TextFile { path, text } in files(&[".rs"]) {
        for (_, behind) in text.match_indices("#[test]\n").map(|(at, mark)| text.split_at(at + mark.len())) {
            let Some((_, named)) = behind.split_once("fn ") else { continue };
            let name = named.split('(').next().unwrap_or("");
            let indent = behind.len() - behind.trim_start().len();
            let end = format!("\n{}}}\n", &behind[..indent]);
            let body = named.split(&end).next().unwrap_or(named);
            tests.insert(format!("{path}: {name}"), body.to_owned());
        }
    }
    tests
}

fn assert_none(breaches: &[String]) {
    assert!(breaches.is_empty(), "{}", breaches.join("\n"));
}

/// Returns a message for each name that the table lacks or contains twice, and for each name in it that does not exist.
fn differences<'a>(all: impl Iterator<Item = &'a str>, listed: impl Iterator<Item = &'a str>) -> Vec<String> {
    let all: BTreeSet<_> = all.collect();
    let mut seen = BTreeSet::new();
    let twice: Vec<_> = listed.filter(|name| !seen.insert(*name)).map(|name| format!("twice: {name}")).collect();
    let missing = all.difference(&seen).map(|name| format!("without a test: {name}"));
    missing.chain(seen.difference(&all).map(|name| format!("not there any more: {name}"))).chain(twice).collect()
}

#[test]
fn every_production_is_in_the_table() {
    let productions = productions();
    let names: Vec<_> = productions.iter().flat_map(|one| [one.options(), vec![one.text.clone()]].concat()).collect();
    let table = table();
    let listed = table.productions.iter().flat_map(|group| &group.covers).map(String::as_str);
    assert_none(&differences(names.iter().map(String::as_str), listed));
}

#[test]
fn every_code_is_in_the_table_and_is_what_its_tests_are_about() {
    let (table, tests, snapshots) = (table(), tests(), files(&[".snap"]));
    assert_none(&differences(Code::ALL.iter().map(|code| code.name()), table.codes.keys().map(String::as_str)));
    let mut breaches = Vec::new();
    for (code, named) in &table.codes {
        for test in named {
            let (_, name) = test.split_once(": ").expect("`path: name`");
            let is_in = |file: &TextFile| file.path.contains(name) && file.text.contains(code.as_str());
            let is_shown =
                tests.get(test).is_some_and(|body| body.contains(code.as_str())) || snapshots.iter().any(is_in);
            breaches.extend((!is_shown).then(|| format!("{code}: {test} and its snapshots say nothing of it")));
        }
        breaches.extend(named.is_empty().then(|| format!("{code}: no test")));
    }
    assert_none(&breaches);
}

#[test]
fn every_test_of_the_table_is_there() {
    let (table, tests) = (table(), tests());
    let named = table.productions.iter().flat_map(|group| &group.tests);
    let named = named.chain(table.rules.iter().flat_map(|rule| &rule.tests)).chain(table.codes.values().flatten());
    let missing: BTreeSet<_> = named.filter(|test| !tests.contains_key(*test)).cloned().collect();
    assert_none(&missing.into_iter().collect::<Vec<_>>());
}

#[test]
fn every_rule_has_tests_and_the_rules_are_in_order() {
    let table = table();
    let without: Vec<_> =
        table.rules.iter().filter(|rule| rule.tests.is_empty()).map(|rule| rule.says.clone()).collect();
    assert_none(&without);
    let chapter = |section: &str| section.split('.').next().map(str::to_owned);
    assert!(table.rules.is_sorted_by_key(|rule| chapter(&rule.section)));
    // Every section of the reference without subsections must have rules, except the first section, which defines
    // terms.
    let reference =
        pages().into_iter().find(|page| page.path == "docs/src/reference/semantics.md").expect("the reference");
    let numbers = numbered_sections(&reference);
    let has_none = |number: &&&str| !numbers.iter().any(|inner| inner.starts_with(&format!("{number}.")));
    let sections = numbers.iter().filter(has_none).filter(|number| **number != "1");
    assert_none(&differences(
        sections.copied(),
        table.rules.iter().map(|rule| &*rule.section).collect::<BTreeSet<_>>().into_iter(),
    ));
    assert_eq!(table.rules.iter().map(|rule| &rule.says).collect::<BTreeSet<_>>().len(), table.rules.len());
}

/// Productions that occur only in texts with errors are not checked, because trees do not contain them.
#[test]
fn a_production_stands_in_a_plan_of_its_tests() {
    let (table, tests) = (table(), tests());
    let recovers = |name: &str| productions().into_iter().any(|Production { text, recovers }| recovers && text == name);
    let mut breaches = Vec::new();
    for group in &table.productions {
        let mut counts = Productions::new();
        for text in group.tests.iter().filter_map(|test| tests.get(test)).flat_map(|body| texts(body)) {
            let arena = arena_for(&text);
            let (file, found) = parse(SourceId(0), &text, &arena);
            if found.is_empty() {
                count(&text, &file, &mut counts);
            }
        }
        let unmet = group.covers.iter().filter(|name| !counts.contains_key(name.as_str()) && !recovers(name));
        breaches.extend(unmet.map(|name| format!("{name}: no plan in {:?} has it", group.tests)));
    }
    assert_none(&breaches);
}

/// Returns the quoted texts in the body of a test.
fn texts(body: &str) -> Vec<String> {
    let mut texts = Vec::new();
    let mut rest = body;
    while let Some(at) = rest.find('"') {
        let (before, behind) = (&rest[..at], &rest[at + 1..]);
        let raw = before.len() - before.trim_end_matches('#').len();
        if before.trim_end_matches('#').ends_with('r') {
            let Some((text, behind)) = behind.split_once(&format!("\"{}", "#".repeat(raw))) else { break };
            texts.push(text.to_owned());
            rest = behind;
            continue;
        }
        let (mut text, mut letters) = (String::new(), behind.char_indices());
        let end = loop {
            match letters.next() {
                Some((_, '\\')) => match letters.next() {
                    Some((_, 'n')) => text.push('\n'),
                    Some((_, letter @ ('"' | '\\' | '\''))) => text.push(letter),
                    Some(_) | None => text.push(' '),
                },
                Some((at, '"')) => break at + 1,
                Some((_, letter)) => text.push(letter),
                None => return texts,
            }
        };
        texts.push(text);
        rest = &behind[end..];
    }
    texts
}
