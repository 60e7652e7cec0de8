//! Tests the messages of `mdlec` about bad input, through the real binary: each message has a code or a hint, the exit
//! status is set, and no partial file is left.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::fs;
use std::path::Path;

use mdle_tests::executable::{folder, run_mdlec};

/// A plan without errors.
const REST: &str = "{ Rest (Atom (wait 1ms) stop) }\n";

/// Returns a command with its standard error and its exit status, as a user sees them.
fn transcript(folder: &Path, arguments: &[&str]) -> String {
    let before = listing(folder);
    let output = run_mdlec(folder, arguments);
    assert_eq!(output.stdout, b"", "nothing goes to standard output");
    assert_eq!(before, listing(folder), "something was left behind");
    let messages = String::from_utf8(output.stderr).expect("UTF-8");
    assert!(!messages.contains("panicked"), "{messages}");
    let status = output.status.code().expect("mdlec ends by itself");
    format!("$ mdlec {}\n{messages}exit status {status}\n", arguments.join(" "))
}

fn listing(folder: &Path) -> Vec<std::ffi::OsString> {
    let mut names: Vec<_> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    names.sort();
    names
}

fn with_plan(test: &str, plan: impl AsRef<[u8]>) -> std::path::PathBuf {
    let folder = folder(test);
    fs::write(folder.join("plan.mdle"), plan).unwrap();
    folder
}

#[test]
fn a_plan_with_errors() {
    let plan = "{ P (bumpr)\n  (Atom (wait 1 2) go fast 0)\n  { Inner (Atom (atIsection 0121) rotate 90)\n  Legg\n}\n";
    let folder = with_plan("errors", plan);
    insta::assert_snapshot!(transcript(&folder, &["plan.mdle", "--target", "sim"]));
}

#[test]
fn commands_that_are_misspelled() {
    let folder = with_plan("commands", REST);
    let commands =
        [&["chekc", "plan.mdle"][..], &["chekc"], &["anlyze", "--json", "plan.mdle"], &["rnu", "plan.mdle"], &["plan"]];
    insta::assert_snapshot!(commands.map(|arguments| transcript(&folder, arguments)).join("\n"));
}

#[test]
fn a_robot_that_lacks_something_names_those_that_have_it() {
    let folder = with_plan("lacks", "{ P (battery < 11)\n  (Atom (lowBattery OR sync ada) stop)\n}\n");
    fs::create_dir_all(folder.join("cart")).unwrap();
    let cart = "target cart : crate cart, period 100ms;\ncapability diff_drive, odometry;\nuse atoms;\n";
    fs::write(folder.join("cart/alphabet.mdle"), cart).unwrap();
    insta::assert_snapshot!(transcript(&folder, &["check", "plan.mdle", "--target", "./cart"]));
}

#[test]
fn what_is_no_plan_is_a_few_messages() {
    let source = fs::read_to_string(mdle_tests::repository::root().join("mdlec/compiler/src/lib.rs")).unwrap();
    let folder = with_plan("no_plan", source);
    let output = transcript(&folder, &["check", "plan.mdle"]);
    assert_eq!(output.matches("\nerror[").count(), 10, "{output}");
    assert!(output.contains("\n… and ") && output.ends_with(" errors\nexit status 1\n"), "{output}");
}

#[test]
fn every_command_gives_a_plan_with_errors_the_same_status() {
    let folder = with_plan("status", "{ P (bumpr) (Atom (wait 1) stop) }");
    let check = transcript(&folder, &["check", "plan.mdle"]);
    for arguments in [&["plan.mdle", "--emit", "fsm"][..], &["plan.mdle", "--emit", "rust", "--target", "sim"]] {
        assert_eq!(check.split_once('\n').unwrap().1, transcript(&folder, arguments).split_once('\n').unwrap().1);
    }
}

#[test]
fn names_that_no_new_target_can_have() {
    let folder = with_plan("new_target", REST);
    fs::create_dir(folder.join("there")).unwrap();
    let names = ["there", "plan.mdle", "sim", "all", "My-Rover", "../rover", "2wheels", ""];
    insta::assert_snapshot!(names.map(|name| transcript(&folder, &["new-target", name])).join("\n"));
}

#[test]
fn targets_that_are_none() {
    let folder = with_plan("target", REST);
    let transcripts =
        ["sin", "spaceship", "../rover"].map(|target| transcript(&folder, &["plan.mdle", "--target", target]));
    insta::assert_snapshot!(transcripts.join("\n") + &transcript(&folder, &["plan.mdle"]));
}

#[test]
fn plans_by_name() {
    let folder = with_plan("several", format!("{REST}{{ Other Rest2 }}\n{{ Rest2 (Atom (wait 1ms) stop) }}\n"));
    let none = transcript(&folder, &["plan.mdle", "--target", "sim"]);
    let wrong = transcript(&folder, &["plan.mdle", "--target", "sim", "--plan", "Othre"]);
    insta::assert_snapshot!(format!("{none}\n{wrong}"));
}

#[test]
fn files_that_are_no_plans() {
    let folder = with_plan("files", b"{ Caf\xE9 (Atom (wait 1) stop) }");
    fs::create_dir(folder.join("folder.mdle")).unwrap();
    fs::write(folder.join("empty.mdle"), "// nothing yet\n").unwrap();
    let files = ["plan.mdle", "folder.mdle", "missing.mdle", "plan", "empty.mdle"];
    insta::assert_snapshot!(files.map(|file| transcript(&folder, &["check", file])).join("\n"));
}

#[test]
fn places_that_cannot_be_written() {
    let folder = with_plan("places", REST);
    fs::create_dir(folder.join("taken")).unwrap();
    let build = |output: &str| transcript(&folder, &["plan.mdle", "--target", "sim", "-o", output]);
    let emit = transcript(&folder, &["plan.mdle", "--emit=plan=missing/plan.txt"]);
    let drawn = transcript(&folder, &["draw", "plan.mdle", "-o", "taken"]);
    insta::assert_snapshot!([build("taken"), build("missing/plan"), build("plan.mdle"), emit, drawn].join("\n"));
}

#[test]
fn names_of_outputs_in_other_formats() {
    let folder = with_plan("formats", "{ P (bumpr) (Atom (wait 1) stop) }");
    let commands = [
        &["draw", "plan.mdle", "-o", "plan.png"][..],
        &["plan.mdle", "--target", "sim", "-o", "plan.PNG"],
        &["plan.mdle", "--emit", "dot=out/plan.svg"],
        &["plan.mdle", "--emit", "matrices", "-o", "plan.pdf"],
    ];
    insta::assert_snapshot!(commands.map(|arguments| transcript(&folder, arguments)).join("\n"));
}

#[test]
fn options_that_are_wrong() {
    let folder = with_plan("options", REST);
    for arguments in [
        &["plan.mdle", "--emit", "bytecode"][..],
        &["plan.mdle", "--nonsense"],
        &["plan.mdle", "extra"],
        &["trace", "plan.mdle"],
        &["plan.mdle", "--emit", "plan", "--run"],
        &["run", "plan.mdle", "--emit", "plan"],
        &["run"],
        &["build"],
        &["build", "plan.mdle", "--run"],
        &["plan.mdle", "--target", "sim", "arg"],
        &[],
    ] {
        let transcript = transcript(&folder, arguments);
        assert!(transcript.ends_with("exit status 2\n"), "{transcript}");
    }
}

#[test]
fn emulators_that_are_none() {
    let folder = with_plan("emulators", REST);
    let commands =
        [&["emulator", "scuot"][..], &["emulator", "sim"], &["emulator"], &["emulator", "scout", "--link", "line"]];
    insta::assert_snapshot!(commands.map(|arguments| transcript(&folder, arguments)).join("\n"));
}

#[test]
fn options_of_other_commands_name_these() {
    let folder = with_plan("misplaced", REST);
    let commands = [
        &["check", "plan.mdle", "--plan", "Rest"][..],
        &["check", "--run", "plan.mdle"],
        &["check", "plan.mdle", "--emit=plan"],
        &["check", "-o", "rest", "plan.mdle"],
        &["fmt", "--deny-warnings", "plan.mdle"],
        &["run", "plan.mdle", "--emit", "plan"],
        &["run", "plan.mdle", "--machine", "aarch64"],
        &["check", "plan.mdle", "--nonsense"],
        &["check", "plan.mdle", "-t", "sim"],
        &["fmt", "plan.mdle", "--in-place"],
        &["run", "plan.mdle", "--target", "sim", "--speed", "max"],
        &["plan.mdle", "--target", "sim", "--speed", "max"],
        &["quarks", "sim"],
        &["run", "plan.mdle", "scuot"],
        &["simulate", "plan.mdle"],
        &["compile", "plan.mdle"],
    ];
    insta::assert_snapshot!(commands.map(|arguments| transcript(&folder, arguments)).join("\n"));
}

#[test]
fn warnings_can_be_denied() {
    let folder = with_plan("warnings", "{ P (bumper) (Atom (bumper) rotate 90) }\n");
    let allowed = transcript(&folder, &["check", "plan.mdle"]);
    assert!(allowed.contains("warning[W0101]") && allowed.ends_with("exit status 0\n"), "{allowed}");
    let denied = transcript(&folder, &["check", "plan.mdle", "--deny-warnings"]);
    assert!(denied.ends_with("exit status 1\n"), "{denied}");
}

#[test]
fn a_reader_that_goes_away_is_no_error() {
    let plan: String = (0..5000).map(|number| format!("{{ P{number} (Atom (wait 1) stop) }}\n")).collect();
    let folder = with_plan("pipe", plan);
    let mut child = std::process::Command::new(mdle_tests::executable::mdlec())
        .args(["plan.mdle", "--emit", "tree"])
        .current_dir(&folder)
        .stdout(std::process::Stdio::piped())
        .stderr(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    assert_eq!((output.status.code(), String::from_utf8(output.stderr).unwrap().as_str()), (Some(0), ""));
}

#[test]
fn scripts_that_are_wrong() {
    let folder = with_plan("scripts", REST);
    fs::write(folder.join("script"), "{\"t\": 1.0, \"fired\": [], \"completed\": []}\n{\"t\": 0.5}\n").unwrap();
    fs::write(folder.join("nonsense"), "{\"t\": }\n").unwrap();
    fs::write(folder.join("list"), "[\n  {\"t\": 0}\n]\n").unwrap();
    fs::write(folder.join("plain"), "0.5 bumper\n").unwrap();
    fs::write(folder.join("unit"), "{\"t\": \"0s\"}\n").unwrap();
    let turns = [
        r#"{"t": 0, "fired": ["bumpr"]}"#,
        r#"{"t": 0}\n{"t": 1, "fired": ["r0<0.7"]}"#,
        r#"{"t": 0, "fired": ["sync ada"]}"#,
        r#"{"t": 0, "fired": ["wait 5"]}"#,
        r#"{"t": 0, "fired": ["way>200cm"]}"#,
        r#"{"t": 0, "completed": ["turm 90"]}"#,
        r#"{"t": 0, "fired": ["bumper) stop"]}"#,
    ];
    let plan = "{ P (bumper)\n  (Atom (r0 < 60cm OR wait 5 OR way > 2m) turn 90)\n}\n";
    fs::write(folder.join("names.mdle"), plan).unwrap();
    let names = turns.map(|turn| {
        fs::write(folder.join("names"), turn.replace("\\n", "\n") + "\n").unwrap();
        format!("{turn}\n{}", transcript(&folder, &["trace", "names.mdle", "--script", "names"]))
    });
    insta::assert_snapshot!("names_in_scripts_that_are_wrong", names.join("\n"));
    let scripts = ["script", "nonsense", "list", "plain", "unit", "missing"];
    insta::assert_snapshot!(
        scripts.map(|file| transcript(&folder, &["trace", "plan.mdle", "--script", file])).join("\n")
    );
}

#[test]
fn an_expanded_form_that_is_too_large_names_its_loop() {
    let folder = with_plan("large", "{ P ExecPlan 1000000 { (Atom (wait 1) stop) } }\n");
    let emitted = transcript(&folder, &["plan.mdle", "--emit", "fsm"]);
    insta::assert_snapshot!(emitted);
    fs::write(folder.join("script.jsonl"), "{\"t\":0}\n").unwrap();
    let message = |transcript: &str| transcript.split_once('\n').map(|(_, message)| message.to_owned());
    for machine in ["table", "matrix"] {
        let traced = transcript(&folder, &["trace", "plan.mdle", "--script", "script.jsonl", "--machine", machine]);
        assert_eq!(message(&traced), message(&emitted));
    }
}

#[test]
fn brackets_without_end_are_one_error_that_names_the_limit() {
    let folder = with_plan("brackets", format!("{{ P {} }}\n", "(".repeat(20_000)));
    for arguments in [&["check", "plan.mdle"][..], &["plan.mdle", "--target", "sim"]] {
        let transcript = transcript(&folder, arguments);
        assert_eq!(transcript.matches("error[").count(), 1);
        assert!(transcript.contains("error[E0106]: brackets nested more than 256 deep\n"), "{}", &transcript[..200]);
        assert!(transcript.ends_with("error: 1 error\nexit status 1\n"));
    }
}

#[test]
fn more_passes_than_can_be_counted_are_an_error() {
    let loops = (0..12).fold("(Atom (wait 1) stop)".to_owned(), |inside, _| format!("({inside})^1000"));
    let folder = with_plan("passes", format!("{{ P {loops} }}\n"));
    let build = ["plan.mdle", "--target", "sim"];
    for arguments in [&["check", "plan.mdle"][..], &build, &["plan.mdle", "--emit", "fsm"]] {
        let transcript = transcript(&folder, arguments);
        assert!(
            transcript.contains("error[E0501]: ") && transcript.ends_with("error: 1 error\nexit status 1\n"),
            "{transcript}"
        );
    }
}

/// Arguments of commands that write a file, each with the plan's file or a file that the plan uses as the output.
const OVER_AN_INPUT: [&[&str]; 9] = [
    &["plan.mdle", "--target", "sim", "-o", "legs.mdle"],
    &["plan.mdle", "--target", "sim", "-o", "./folder/../plan.mdle"],
    &["plan.mdle", "--target", "sim", "-o", "link"],
    &["plan.mdle", "--target", "sim", "-o", "second_name"],
    &["plan.mdle", "--emit", "tree", "-o", "plan.mdle"],
    &["plan.mdle", "--emit", "formal=legs.mdle"],
    &["draw", "plan.mdle", "-o", "link"],
    &["x1.mtx", "--emit", "matrices=."],
    &["plan.mdle", "--target", "rover", "--emit", "plan=rover/alphabet.mdle"],
];

#[test]
fn no_output_goes_over_an_input() {
    let folder = with_plan("over_input", "use \"legs.mdle\"\n{ P Legs }\n");
    fs::write(folder.join("legs.mdle"), "{ Legs (Atom (wait 1ms) stop) }\n").unwrap();
    fs::write(folder.join("x1.mtx"), REST).unwrap();
    fs::write(folder.join("matrices.json"), "[]").unwrap();
    fs::create_dir(folder.join("folder")).unwrap();
    std::os::unix::fs::symlink("plan.mdle", folder.join("link")).unwrap();
    fs::hard_link(folder.join("plan.mdle"), folder.join("second_name")).unwrap();
    assert_eq!(run_mdlec(&folder, &["new-target", "rover"]).status.code(), Some(0));
    let texts = || ["plan.mdle", "legs.mdle", "x1.mtx", "rover/alphabet.mdle"].map(|file| fs::read(folder.join(file)));
    let before = texts().map(Result::unwrap);
    let report = OVER_AN_INPUT.map(|arguments| transcript(&folder, arguments)).join("\n");
    assert_eq!(texts().map(Result::unwrap), before);
    insta::assert_snapshot!(report);
}

#[test]
fn an_executable_does_not_go_over_a_source_of_its_robot() {
    let folder = with_plan("over_source", REST);
    assert_eq!(run_mdlec(&folder, &["new-target", "rover"]).status.code(), Some(0));
    let report = transcript(&folder, &["plan.mdle", "--target", "rover", "-o", "rover/src/lib.rs"]);
    insta::assert_snapshot!(report);
}

#[test]
fn a_plan_on_standard_input_is_not_written_over() {
    let folder = with_plan("over_standard_input", REST);
    let plan = fs::File::open(folder.join("plan.mdle")).unwrap();
    let mut command = mdle_tests::executable::command(&folder, &["-", "--emit", "tree=plan.mdle"]);
    let output = command.stdin(plan).output().unwrap();
    let report = String::from_utf8(output.stderr).unwrap();
    assert!(report.starts_with("error: `plan.mdle` is an input of this command"), "{report}");
    assert_eq!((output.status.code(), fs::read_to_string(folder.join("plan.mdle")).unwrap().as_str()), (Some(2), REST));
}

#[test]
fn scripts_are_read_as_the_compiler_reads_plans() {
    let folder = with_plan("script_words", "{ P (bumper)\n  (Atom (r0 < 60cm) turn 90)\n}\n");
    let trace = |fired: &str, completed: &str| {
        let script = format!("{{\"t\":0}}\n{{\"t\":1,\"fired\":{fired},\"completed\":{completed}}}\n");
        fs::write(folder.join("script"), script).unwrap();
        let output = run_mdlec(&folder, &["trace", "plan.mdle", "--script", "script"]);
        assert_eq!((output.status.code(), &*output.stderr), (Some(0), &b""[..]));
        String::from_utf8(output.stdout).unwrap()
    };
    let fired = trace(r#"["r0 < 0.6"]"#, "[]");
    assert_eq!(fired.lines().count(), 2);
    for text in ["r0<0.6", "r0 < 60cm", "r_0(t) < 0.60m", "r 0 < 600mm", " r0 <\t0.6 "] {
        assert_eq!(trace(&serde_json::json!([text]).to_string(), "[]"), fired, "{text}");
    }
    let completed = trace("[]", r#"["turn 90"]"#);
    assert_ne!(completed, fired);
    for text in ["turn 90deg", "turn(90)", "turn 90.0"] {
        assert_eq!(trace("[]", &serde_json::json!([text]).to_string()), completed, "{text}");
    }
}
