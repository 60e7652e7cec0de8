//! Tests very large plans, through the real binary: nesting that is too deep is a single error that names the limit,
//! and plans that are only long are processed.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::fs;
use std::path::Path;

use mdle_tests::chance::sized;
use mdle_tests::executable::{folder, run_mdlec};

/// Number of repetitions.
const MANY: usize = 100_000;

/// Arguments of commands that read the plan `plan.mdle`.
const COMMANDS: [&[&str]; 5] = [
    &["check", "plan.mdle"],
    &["fmt", "--check", "plan.mdle"],
    &["trace", "plan.mdle", "--script", "script.jsonl"],
    &["plan.mdle", "--emit", "rust", "--target", "sim"],
    &["analyze", "plan.mdle"],
];

/// Returns the exit status, standard output and standard error of a command on a plan.
fn messages(folder: &Path, plan: &str, arguments: &[&str]) -> (Option<i32>, String, String) {
    fs::write(folder.join("plan.mdle"), plan).unwrap();
    fs::write(folder.join("script.jsonl"), "{\"t\": 0}\n{\"t\": 0.5}\n").unwrap();
    let output = run_mdlec(folder, arguments);
    let text = |bytes| String::from_utf8(bytes).expect("UTF-8");
    (output.status.code(), text(output.stdout), text(output.stderr))
}

/// Returns two texts with deeply nested parts. In the first text all parts are closed, and in the second none.
fn nested(before: &str, opened: &str, inside: &str, closed: &str, behind: &str) -> [String; 2] {
    let open = format!("{before}{}{inside}", opened.repeat(MANY));
    [format!("{open}{}{behind}", closed.repeat(MANY)), format!("{open}{behind}")]
}

#[test]
fn what_nests_too_deep_is_one_error_that_names_the_limit() {
    let folder = folder("too_deep");
    let plans = [
        nested("{ P ", "(", "Q", ")", " }"),
        nested("", "{ P ", "(Atom (bumper) stop)", " }", ""),
        nested("", "{ P (", "Q", ") }", ""),
        nested("", "{ P (", "Q", "} )", ""),
        nested("{ P (Atom ", "(", "bumper", ")", " stop) }"),
        nested("{ P (Atom (", "NOT (", "bumper", ")", ") stop) }"),
        nested("{ P (Atom (bumper) go", "(", "5 0", ")", ") }"),
        nested("{ P ", "ExecPlan 2 { ", "Q", " }", " }"),
    ];
    for plan in plans.as_flattened() {
        let [first, others @ ..] = COMMANDS.map(|arguments| messages(&folder, plan, arguments));
        let (status, printed, messages) = &first;
        let start: String = messages.chars().take(300).collect();
        assert_eq!((*status, printed.as_str()), (Some(1), ""), "{start}");
        assert!(start.starts_with("error[E0106]: brackets nested more than 256 deep\n"), "{start}");
        assert!(messages.ends_with("\nerror: 1 error\n"), "{start}");
        assert!(others.iter().all(|other| *other == first), "{start}");
    }
}

#[test]
fn what_is_only_long_comes_to_a_result() {
    let folder = folder("long");
    // An unoptimized mdlec takes a minute for `MANY` operands.
    let many = sized(MANY / 10, MANY);
    let operands: Vec<_> = (1..=many).map(|seconds| format!("wait {seconds}")).collect();
    let elements: Vec<_> = (1..=many).map(|seconds| format!("  (Atom (wait {seconds}) stop)\n")).collect();
    // The first plan is on one line, which `fmt` breaks.
    let plans = [
        (format!("{{ P\n  (Atom ({}) stop)\n}}\n", operands.join(" OR ")), (Some(1), "plan.mdle\n")),
        (format!("{{ P\n{}}}\n", elements.concat()), (Some(0), "")),
    ];
    let [check, fmt, trace, _, analyze] = COMMANDS;
    for (plan, laid_out) in plans {
        assert_eq!(messages(&folder, &plan, check).0, Some(0));
        let (status, listed, _) = messages(&folder, &plan, fmt);
        assert_eq!((status, listed.as_str()), laid_out);
        let (status, turns, _) = messages(&folder, &plan, trace);
        assert_eq!((status, turns.lines().count()), (Some(0), 2), "{turns}");
        let (status, analysis, _) = messages(&folder, &plan, analyze);
        assert_eq!((status, analysis.starts_with("plan  ")), (Some(0), true), "{analysis}");
    }
}

#[test]
fn brackets_that_close_nothing_are_one_error() {
    let folder = folder("strays");
    for bracket in [")", "}"] {
        let plan = format!("{{ P (Atom (bumper) stop) }}{}", bracket.repeat(MANY));
        for arguments in COMMANDS {
            let (status, _, text) = messages(&folder, &plan, arguments);
            let message = format!("error[E0103]: these 100000 `{bracket}` close nothing\n");
            assert!(status == Some(1) && text.starts_with(&message), "{}", &text[..300]);
            assert!(text.ends_with("\nerror: 1 error\n"));
        }
    }
}

#[test]
fn a_long_line_is_cut_around_its_mistake() {
    let folder = folder("long_line");
    let plan = format!("{{ P {}(Atom (bogus) stop) }}\n", "(Atom (wait 1) stop) ".repeat(60_000));
    let (status, _, text) = messages(&folder, &plan, &["check", "plan.mdle"]);
    assert_eq!(status, Some(1));
    let lines: Vec<_> = text.lines().collect();
    assert!(text.len() < 1000 && lines[1].ends_with("plan.mdle:1:1260012"), "{}", &text[..text.len().min(2000)]);
    let at = |line: &str, part: char| line.chars().position(|letter| letter == part);
    assert_eq!(at(lines[4], '^'), lines[3].find("bogus").map(|byte| lines[3][..byte].chars().count()), "{text}");
    let (_, _, text) = messages(&folder, &plan, &["check", "plan.mdle", "--message-format", "json"]);
    assert!(text.contains(r#""line":1,"column":1260012,"end_line":1,"end_column":1260017"#), "{text}");
}

#[test]
fn a_hundred_errors_are_shown_on_a_terminal() {
    let folder = folder("without_number");
    let plan = format!("{{ P {} }}", "(} {) ".repeat(MANY / 2));
    let (status, _, text) = messages(&folder, &plan, &["check", "plan.mdle"]);
    assert_eq!(status, Some(1));
    assert!(text.len() < 10_000 && text.contains("\n… and "), "{} bytes", text.len());
    let (status, _, text) = messages(&folder, &plan, &["check", "plan.mdle", "--message-format", "json"]);
    // For programs, all errors are printed: each repetition has three errors.
    assert_eq!((status, text.lines().count()), (Some(1), MANY / 2 * 3));
}
