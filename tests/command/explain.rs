//! Tests `mdlec explain`, through the real binary: each code has a text, the wrong example causes exactly this code,
//! and the right example causes no message.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use mdle_compiler::diagnostic::{Code, Example};
use mdle_tests::executable::{folder, run_mdlec};
use serde_json::Value;

/// Code of a bug in the compiler. It has no examples, because no plan causes it.
const WITHOUT_EXAMPLES: Code = Code::E0901;

/// Returns the codes that have examples.
fn with_examples() -> impl Iterator<Item = Code> {
    let explanation = WITHOUT_EXAMPLES.explanation();
    assert_eq!((explanation.wrong(), explanation.right()), (None, None));
    Code::ALL.iter().copied().filter(|code| *code != WITHOUT_EXAMPLES)
}

/// Returns the messages about an example, in the format `human` or `json`.
fn messages(folder: &Path, example: &Example, format: &str) -> String {
    // In the text of an example, `\xDF` stands for this byte.
    let bytes = example.text.split("\\xDF").map(str::as_bytes).collect::<Vec<_>>().join(&b'\xDF');
    let file = if example.arguments.iter().any(|argument| argument == ".") { "alphabet.mdle" } else { "plan.mdle" };
    fs::write(folder.join(file), bytes).unwrap();
    let arguments: Vec<_> = example.arguments.iter().map(String::as_str).chain(["--message-format", format]).collect();
    String::from_utf8(run_mdlec(folder, &arguments).stderr).expect("UTF-8")
}

/// Writes the files that examples use.
fn write_files(folder: &Path) {
    fs::write(folder.join("corridors.mdle"), "{ Corridor (Atom (wait 5) (go 20 0)) }\n").unwrap();
    fs::create_dir_all(folder.join("cart")).unwrap();
    let cart = "target cart : crate cart, period 100ms;\ncapability diff_drive, odometry;\nuse atoms;\n";
    fs::write(folder.join("cart/alphabet.mdle"), cart).unwrap();
}

/// Returns the codes of the messages about an example, and the messages as JSON.
fn codes(folder: &Path, example: &Example) -> (BTreeSet<String>, String) {
    let messages = messages(folder, example, "json");
    let codes = messages.lines().map(|line| {
        let message: Value = serde_json::from_str(line).unwrap_or_else(|error| panic!("{error}: {line}"));
        message["code"].as_str().map(str::to_owned)
    });
    (codes.flatten().collect(), messages)
}

#[test]
fn wrong_examples_have_just_that_code_and_right_ones_none() {
    let folder = folder("explain");
    write_files(&folder);
    for code in with_examples() {
        let explanation = code.explanation();
        let wrong = explanation.wrong().unwrap_or_else(|| panic!("{code} has no wrong example"));
        let right = explanation.right().unwrap_or_else(|| panic!("{code} has no right example"));
        assert!(!explanation.text().starts_with("Wrong"), "{code} has examples only");
        let (codes_of_wrong, messages) = codes(&folder, &wrong);
        assert_eq!(codes_of_wrong, BTreeSet::from([code.name().to_owned()]), "{code}\n{}\n{messages}", wrong.text);
        let (_, messages) = codes(&folder, &right);
        assert_eq!(messages, "", "{code}\n{}", right.text);
    }
}

#[test]
fn every_code_is_shown_to_people_and_to_programs() {
    let folder = folder("explain_shown");
    write_files(&folder);
    let mut shown = String::new();
    for code in with_examples() {
        let wrong = code.explanation().wrong().unwrap_or_else(|| panic!("{code} has no wrong example"));
        let (human, json) = (messages(&folder, &wrong, "human"), messages(&folder, &wrong, "json"));
        assert!(human.contains(&format!("[{code}]: ")) && json.contains(&format!("\"code\":\"{code}\"")), "{human}");
        let arguments = wrong.arguments.join(" ");
        shown += &format!("==== {code}: {}\n{}$ mdlec {arguments}\n{human}----\n{json}\n", code.title(), wrong.text);
    }
    insta::assert_snapshot!(shown);
}

#[test]
fn a_code_is_explained_and_all_are_listed() {
    let folder = folder("explain_one");
    let printed = |arguments: &[&str]| {
        let output = run_mdlec(&folder, arguments);
        assert_eq!((output.status.code(), &*output.stderr), (Some(0), &b""[..]));
        String::from_utf8(output.stdout).unwrap()
    };
    insta::assert_snapshot!(format!("{}\n----\n{}", printed(&["explain", "w0203"]), printed(&["explain"])));
    for code in Code::ALL {
        let text = printed(&["explain", code.name()]);
        assert!(
            text.starts_with(&format!("{code}: {}\n\n", code.title())) && text.ends_with(code.explanation().text())
        );
    }
}

#[test]
fn an_unknown_code_has_the_nearest_as_help() {
    let folder = folder("explain_none");
    let messages = ["E0210", "w999", "help"].map(|code| {
        let output = run_mdlec(&folder, &["explain", code]);
        format!("{}exit status {}\n", String::from_utf8(output.stderr).unwrap(), output.status.code().unwrap())
    });
    insta::assert_snapshot!(messages.concat());
}

#[test]
fn texts_fit_a_terminal() {
    for code in Code::ALL {
        let text = code.explanation().text();
        assert!(text.lines().all(|line| line.chars().count() <= 100), "{code}");
    }
}
