//! Tests that all commands that need the plan of a run refuse any other plan with exit status 1.

use std::fs::{self, File};
use std::io::Write as _;
use std::path::PathBuf;
use std::process::Command;

use mdle_record::frames::Frames;
use mdle_record::{Begin, RecordFile};
use mdle_tests::executable::{folder, run_mdlec};

use super::asked;
use super::scripted::{PERIOD, outputs};

const RAN: &str = "{ Square (wait 5min)\n  ((Atom (way >= 1m OR r0 < 40cm) (go 20 0)) (Atom (null) turn 90))^4\n}\n";

/// Returns a folder with the plan `square.mdle`, which is run, and with other plans.
fn recorded(name: &str) -> PathBuf {
    let folder = folder(&format!("why-other-{name}"));
    let others = [
        ("square", RAN.to_owned()),
        ("turn", RAN.replace("turn 90", "turn 80")),
        ("limit", RAN.replace("40cm", "30cm")),
        ("named", RAN.replace("Square", "Other")),
        ("wrong", RAN.replace("wait", "wiat")),
    ];
    for (plan, text) in others {
        fs::write(folder.join(format!("{plan}.mdle")), text).unwrap();
    }
    folder
}

#[test]
fn only_the_plan_that_ran_explains() {
    let folder = recorded("texts");
    let run = "run square.mdle --target sim --speed max --world hall --turns 80 --log run.mcap";
    asked(&folder, &run.split(' ').collect::<Vec<_>>());
    let mut answers = Vec::new();
    for command in
        ["why run.mcap 5.2", "why run.mcap --not go", "plot run.mcap run.svg", "log export --script run.mcap"]
    {
        for plan in ["turn", "limit", "named", "wrong", "missing"] {
            let call = format!("{command} --plan {plan}.mdle");
            let answer = asked(&folder, &call.split(' ').collect::<Vec<_>>());
            let status = if plan == "missing" { "[2]\n" } else { "[1]\n" };
            assert!(answer.ends_with(status), "{answer}");
            answers.push(answer);
        }
    }
    // All commands print the same message.
    insta::assert_snapshot!(answers[..5].join("\n"));
    let own = asked(&folder, &["why", "run.mcap", "5.2", "--plan", "square.mdle"]);
    assert_eq!(own.replace(" --plan square.mdle", ""), asked(&folder, &["why", "run.mcap", "5.2"]));
    let replayed =
        ["named", "wrong"].map(|plan| asked(&folder, &["replay", "run.mcap", "--plan", &format!("{plan}.mdle")]));
    assert!(replayed.iter().all(|answer| answer.ends_with("[1]\n")), "{replayed:?}");
}

/// The turns of the record cannot be repeated, but its content can be read.
#[test]
fn a_record_of_an_unknown_robot_is_told_apart() {
    let folder = folder("why-other-robot");
    let begin = Begin { target: "rover".to_owned(), plan: "P".to_owned(), period: PERIOD, ..Begin::default() };
    let (mut frames, mut bytes) = (Frames::default(), Vec::new());
    frames.begin(&begin, &outputs(1, |_, _| {})[0], &mut bytes);
    frames.end(&mut bytes);
    RecordFile::new(File::create(folder.join("run.mcap")).unwrap()).write_all(&bytes).unwrap();
    let calls = ["replay run.mcap", "why run.mcap 1", "plot run.mcap run.svg", "log info run.mcap"];
    let answers = calls.map(|call| asked(&folder, &call.split(' ').collect::<Vec<_>>()));
    insta::assert_snapshot!(answers.join("\n"));
}

/// The record of an executable does not contain the text of its plan. Another plan is still recognized, by the laws,
/// conditions and inputs.
#[test]
fn executables_have_a_plan_as_well() {
    let folder = recorded("executable");
    let built = run_mdlec(&folder, &["square.mdle", "--target", "sim", "-o", "square"]);
    assert!(built.status.success(), "{}", String::from_utf8_lossy(&built.stderr));
    let options = ["--speed", "max", "--world", "hall", "--turns", "80", "--log", "run.mcap"];
    Command::new(folder.join("square")).args(options).current_dir(&folder).output().unwrap();
    let plans = ["", "square", "turn", "limit"];
    let answers = plans.map(|plan| {
        let option = format!("--plan={plan}.mdle");
        let calls = [["why", "run.mcap", "0.3", &option], ["why", "run.mcap", "--not=turn", &option]];
        let answers = calls.map(|call| asked(&folder, if plan.is_empty() { &call[..3] } else { &call }));
        answers
            .map(|answer| answer.lines().filter(|line| !line.starts_with("  ")).collect::<Vec<_>>().join("\n"))
            .join("\n\n")
    });
    insta::assert_snapshot!(answers.join("\n\n"));
}
