//! Tests `mdle shell`: complete dialogues in stepped time, and messages about wrong commands.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::fs;
use std::io::{BufRead as _, BufReader, Read as _, Write as _};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use mdle_tests::chance::{Chance, repeated};
use mdle_tests::executable::{folder, mdle};
use rustix::process::{Pid, Signal, kill_process};

/// A plan that drives ahead, and then turns on the spot.
const PLAN: &str = "{ Ahead (bumper)\n  (Atom (wait 2s) (go 60 0))\n  (Atom (wait 1s) (go 0 1rad/s))\n}\n";
const RULES: &str = "[limits]\nspeed = \"40cm/s\"\n\n[guards.far]\nwhen = \"x > 5m\"\nthen = \"end\"\n";

/// Output and exit status of a session.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct Left {
    pub(crate) out: String,
    pub(crate) err: String,
    pub(crate) status: Option<i32>,
}

fn with_plan(test: &str) -> PathBuf {
    let folder = folder(test);
    fs::write(folder.join("plan.mdle"), PLAN).unwrap();
    fs::write(folder.join("rules.toml"), RULES).unwrap();
    folder
}

/// Starts a session on the simulated robot, with its clock paused.
fn started(folder: &Path, options: &[&str]) -> Child {
    let mut command = Command::new(mdle());
    command.args(["shell", "plan.mdle", "--target", "sim", "--world", "hall", "--speed", "max", "--paused"]);
    command.args(options).current_dir(folder);
    command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
}

/// Runs a session with these bytes as its standard input.
pub(crate) fn piped(folder: &Path, options: &[&str], input: &[u8]) -> Left {
    let mut child = started(folder, options);
    // A session may end before it has read the whole input.
    let _ = child.stdin.take().unwrap().write_all(input);
    let output = child.wait_with_output().unwrap();
    let [out, err] = [output.stdout, output.stderr].map(|bytes| String::from_utf8(bytes).unwrap());
    Left { out, err, status: output.status.code() }
}

/// Returns the dialogue of a session, its standard error, and its exit status.
pub(crate) fn dialogue(folder: &Path, options: &[&str], commands: &str) -> String {
    let Left { out, err, status } = piped(folder, &[&["-x"], options].concat(), commands.as_bytes());
    format!("{out}---\n{err}[{}]\n", status.unwrap())
}

#[test]
fn a_session_reads_and_changes_what_runs() {
    let folder = with_plan("shell_dialogue");
    let commands = "# The paper's shell\nls\nls /usr/mdle\ncd usr/robot\npwd\nget x\nstep 6\nget x\nget input/v\n\
                    get /usr/mdle/main\nget /usr/mdle/atom\nget /usr/mdle/place\nget /usr/mdle/scopes\n\
                    set /safety/limits/speed 20cm/s\nstep\nget input/v\nget /safety/rules/speed/count\n\
                    help /clock/step\npace 10\nget /clock/pace\nstep 20\nget /usr/mdle/since\nget ranges/r0\npace max\n\
                    step 100\nget /clock/now\nget /usr/mdle/atom\n";
    insta::assert_snapshot!(dialogue(&folder, &["--safety", "rules.toml"], commands));
}

#[test]
fn a_file_of_commands_waits_for_the_end_of_the_plan() {
    let folder = with_plan("shell_file");
    fs::write(folder.join("session"), "wait 1s\nget /clock/now\nwait\nget /usr/robot/theta\n").unwrap();
    let Left { out, err, status } = piped(&folder, &["-c", "session"], b"");
    assert_eq!((out.lines().last(), status), (Some("22.912004deg"), Some(0)), "{out}{err}");
    assert!(err.ends_with("3.0 s  plan over: wait 1s (plan.mdle:3)\n"), "{err}");
}

#[test]
fn a_watched_value_is_printed_when_it_changes() {
    let folder = with_plan("shell_watch");
    let commands = "watch /usr/robot/x\nwatch /usr/mdle/atom\nwatch /usr/robot/x\nstep 6\nunwatch /usr/robot/x\nstep 16\n\
                    watch /nowhere\nwatch /clock/step\nwatch /clock\nunwatch /clock/now\nwatch\nwatch a b\n";
    insta::assert_snapshot!(dialogue(&folder, &["--log", "log"], commands));
    let log = fs::read_to_string(folder.join("log")).unwrap();
    assert!(!log.contains("requests\":[\"watch"), "to look changes nothing");
    assert!(log.lines().nth(6).unwrap().ends_with(r#","requests":["call /clock/step 16"]}"#), "{log}");
}

#[test]
fn a_refused_command_says_what_to_type() {
    let folder = with_plan("shell_refused");
    let commands = "get /usr/robot\nget /usr/robot/z\nget /clock/step\nls /usr/robot/x\nls /nowhere\ncd /clock/now\n\
                    set /usr/robot/x 3m\nset /clock/step 3\ncall /clock/now\nset /clock/pace fast\nset /clock/pace 0\n\
                    set /clock/pace inf\nset /safety/limits/speed 1.2ft\nset /safety/limits/speed 60\n\
                    set /safety/limits/speed 0m/s\nset /safety/limits/speed yes\nstep 0\nstep 1.5\nstep 1 2\nwait 3\n\
                    wait -3s\npause now\ncall /engine/quit now\nfly\nset\nhelp /clock/nwo\n\u{1b}[31mls\n";
    insta::assert_snapshot!(dialogue(&folder, &["--safety", "rules.toml"], commands));
}

#[test]
fn a_role_may_do_what_those_before_it_may() {
    let folder = with_plan("shell_roles");
    let commands = "step\nset /safety/limits/speed 1m/s\nget /clock/turns\ncall /engine/quit\nget /clock/turns\n";
    let all = ["view", "tune", "swap", "admin"]
        .map(|role| dialogue(&folder, &["--safety", "rules.toml", "--role", role], commands));
    insta::assert_snapshot!(all.join("\n"));
}

#[test]
fn an_error_in_line_40_is_told_with_its_line() {
    let folder = with_plan("shell_line_40");
    let commands = format!("{}set /clock/now 3s\nstep 3\nget /clock/turns\n", "# nothing\n".repeat(39));
    fs::write(folder.join("session"), commands).unwrap();
    let error = "error: session:40: `/clock/now` is read-only\n";
    let left = piped(&folder, &["-c", "session"], b"");
    assert_eq!((&*left.err, left.status), (error, Some(1)), "{left:?}");
    assert_eq!(left.out, "3 turns, 0.2s\n3\n");
    let left = piped(&folder, &["-e", "-c", "session"], b"");
    assert_eq!(left, Left { out: String::new(), err: error.to_owned(), status: Some(1) });
}

#[test]
fn input_of_any_bytes_ends_the_session() {
    let folder = with_plan("shell_bytes");
    let told = |input: &[u8]| {
        let left = piped(&folder, &[], input);
        assert_eq!(left.status, Some(1), "{left:?}");
        left.err
    };
    assert_eq!(told(b"\xFF\xFE\n"), "error: standard input:1: the line is not UTF-8 text\n");
    assert_eq!(told(b"\0"), "error: standard input:1: there is no command `U+0000`; `help` lists them\n");
    let long = [vec![b'x'; 300_000], b"\nfly".to_vec()].concat();
    assert_eq!(
        told(&long),
        "error: standard input:1: the line is longer than 65536 bytes\n\
         error: standard input:2: there is no command `fly`; `help` lists them\n"
    );
    let middle = "error: standard input:2: the input ends in the middle of a command\n";
    assert_eq!(told(b"get \\\n/clock/\\"), middle);
    assert_eq!(piped(&folder, &[], b"").status, Some(0), "an empty input ends it as well");
}

#[test]
fn a_file_goes_on_after_the_run() {
    let folder = with_plan("shell_after");
    let commands = "wait\nget /clock/turns\nstep\nget /clock/turns\nset /clock/pace 2\nls /plans\n";
    fs::write(folder.join("session"), commands).unwrap();
    let left = piped(&folder, &["-c", "session"], b"");
    assert_eq!(left.out, "31 turns, 3s, and the plan is over\n31\n31\nAhead/\n");
    assert!(
        left.err.contains("error: session:3: the run has ended\nerror: session:5: the run has ended\n"),
        "{left:?}"
    );
    assert_eq!(left.status, Some(1));
    let left = piped(&folder, &["-e", "-c", "session"], b"");
    assert_eq!(left.out, "31 turns, 3s, and the plan is over\n31\n");
}

/// After a run that its plan did not end, `get` still answers, and commands that wait for a turn report the reason of
/// the end.
#[test]
fn a_run_that_ends_otherwise_than_by_its_plan_says_why() {
    let folder = with_plan("shell_otherwise");
    fs::write(folder.join("rules.toml"), "[guards.far]\nwhen = \"x > 20cm\"\nthen = \"end\"\n").unwrap();
    let commands = "step\nget /usr/robot/x\nwait\nget /usr/robot/x\nget /clock/turns\nget /safety/rules/far/count\n";
    insta::assert_snapshot!(dialogue(&folder, &["--safety", "rules.toml"], commands), @"
    > step
    1 turn, 0s
    > get /usr/robot/x
    0m
    > wait
    8 turns, 0.7s, and the run has ended with exit status 6: stopped by the safety rules: far
    > get /usr/robot/x
    0.242938m
    > get /clock/turns
    8
    > get /safety/rules/far/count
    1
    ---
    0.7 s  safety: far ends the plan
    stopped by the safety rules: far
    [6]
    ");
    insta::assert_snapshot!(dialogue(&folder, &["--turns", "7"], "step 9\nget /clock/turns\n"), @"
    > step 9
    7 turns, 0.6s, and the run has ended with exit status 4: stopped by --turns: the plan was not over after 7 turns
    > get /clock/turns
    7
    ---
    stopped by --turns: the plan was not over after 7 turns
    [4]
    ");
    let mut child = started(&folder, &[]);
    let mut input = child.stdin.take().unwrap();
    input.write_all(b"pace 1\nwatch /clock/turns\nwait\n").unwrap();
    let mut answers = BufReader::new(child.stdout.take().unwrap()).lines().map(Result::unwrap);
    assert!(answers.nth(3).is_some_and(|answer| answer.contains("/clock/turns ")));
    kill_process(Pid::from_child(&child), Signal::INT).unwrap();
    let last = answers.last().unwrap();
    assert!(last.ends_with("s, and the run has ended with exit status 130: stopped by SIGINT"), "{last}");
    drop(input);
    assert_eq!(child.wait().unwrap().code(), Some(130));
}

#[test]
fn turns_in_simulated_time_are_never_late() {
    let left = piped(&with_plan("shell_late"), &[], b"step 3\nget /clock/late/max\nget /clock/missed\n");
    assert_eq!((&*left.out, left.status), ("3 turns, 0.2s\n(no value yet)\n(no value yet)\n", Some(0)), "{left:?}");
}

/// Requests are handled at once while the clock is paused; with a delay, 300 readings would take 6 s and more.
#[test]
fn a_reading_waits_for_no_turn_while_the_clock_stands() {
    let (folder, begun) = (with_plan("shell_readings"), Instant::now());
    let left = piped(&folder, &[], "get /clock/now\n".repeat(300).as_bytes());
    assert_eq!((left.out, left.status), ("0s\n".repeat(300), Some(0)));
    assert!(begun.elapsed() < Duration::from_secs(5), "{:?}", begun.elapsed());
}

#[test]
fn help_is_about_commands_and_names() {
    let commands = "help swap\nhelp step\nhelp /clock/pause\nhelp nothing\nhelp\n";
    insta::assert_snapshot!(dialogue(&with_plan("shell_help"), &[], commands));
}

#[test]
fn limits_need_safety_rules() {
    let commands = "set /safety/limits/speed 10cm/s\nget /safety/limits/speed\n";
    let text = dialogue(&with_plan("shell_unsafe"), &[], commands);
    let refusal = "`/safety/limits/speed`: this session has no safety rules: begin it with `--safety FILE`";
    assert!(text.contains(&format!("error: standard input:1: {refusal}\n")), "{text}");
}

/// A rule that has replaced a plan is off until it is reset. A replay repeats the reset.
#[test]
fn a_reset_lets_rules_apply_again() {
    let folder = with_plan("shell_reset");
    fs::write(folder.join("go.mdle"), "{ Go (wait 60s) (Atom (null) (go 60 0)) }\n").unwrap();
    fs::write(folder.join("back.mdle"), "{ Back (wait 60s) (Atom (null) (go -5 0)) }\n").unwrap();
    let rules = "[limits]\nspeed = \"50cm/s\"\n\n[guards.far]\nwhen = \"x > 20cm\"\nthen = \"back.mdle\"\n";
    fs::write(folder.join("rules.toml"), rules).unwrap();
    let commands = "load_plan go.mdle\nstep 9\nget /usr/mdle/atom\nget /safety/rules/far/count\n\
                    set /usr/mdle/trial 0s\nset /safety/limits/speed 30cm/s\nset /usr/mdle/main Go\nstep 5\n\
                    get /usr/mdle/atom\nget /usr/robot/input/v\ncall /safety/reset now\ncall /safety/reset\n\
                    get /safety/limits/speed\nget /safety/rules/far/count\nset /safety/limits/turn_rate 1rad/s\nstep 3\n\
                    get /usr/mdle/atom\nget /safety/rules/far/count\n";
    insta::assert_snapshot!(dialogue(&folder, &["--safety", "rules.toml", "--log", "run.mcap"], commands));
    let replay = Command::new(mdle()).args(["replay", "run.mcap"]).current_dir(&folder).output().unwrap();
    let replayed = String::from_utf8(replay.stdout).unwrap();
    assert!(replayed.starts_with("the same to the bit, "), "{replayed}");
    let unruled = dialogue(&folder, &[], "call /safety/reset\n");
    let refusal = "`/safety/reset`: this session has no safety rules: begin it with `--safety FILE`";
    assert!(unruled.contains(refusal), "{unruled}");
}

#[test]
fn what_cannot_begin_is_told_once() {
    let folder = with_plan("shell_unbegun");
    let started = |options: &[&str]| {
        let Left { out, err, status } = piped(&folder, options, b"get /clock/now\n");
        format!("{}\n{out}{err}[{}]\n", options.join(" "), status.unwrap())
    };
    let all = [
        &["-c", "missing"][..],
        &["-c", "."],
        &["--role", "king"],
        &["--runs", "3"],
        &["--turns", "0"],
        &["--safety", "missing"],
    ]
    .map(started);
    insta::assert_snapshot!(all.join("\n"));
}

#[test]
fn a_signal_ends_a_session_whose_clock_stands() {
    let folder = with_plan("shell_signal");
    let mut child = started(&folder, &[]);
    let mut input = child.stdin.take().unwrap();
    input.write_all(b"step 3\n").unwrap();
    let mut answer = [0; 14];
    child.stdout.as_mut().unwrap().read_exact(&mut answer).unwrap();
    assert_eq!(&answer, b"3 turns, 0.2s\n");
    kill_process(Pid::from_child(&child), Signal::TERM).unwrap();
    let output = child.wait_with_output().unwrap();
    assert_eq!(
        (output.status.code(), String::from_utf8(output.stderr).unwrap()),
        (Some(143), "stopped by SIGTERM\n".to_owned())
    );
}

#[test]
fn random_bytes_end_the_session() {
    let folder = with_plan("shell_random");
    let words = [
        "ls",
        "get",
        "set",
        "call",
        "watch",
        "step",
        "wait 1s",
        "swap",
        "/usr/mdle/main",
        "/clock/pace",
        "{",
        "\\",
        "\n",
        "\0",
    ];
    for seed in 0..repeated(6) {
        let mut chance = Chance::new(seed);
        let mut input = Vec::new();
        while input.len() < 3000 {
            if chance.percent(50) {
                input.extend(words[chance.below(words.len())].bytes());
                input.push(b' ');
            } else {
                input.push(chance.below(256) as u8);
            }
        }
        let left = piped(&folder, &["--timeout", "60"], &input);
        assert!([Some(0), Some(1), Some(4)].contains(&left.status), "{seed}: {left:?}");
    }
}

#[test]
fn a_signal_ends_a_session_in_every_phase() {
    let folder = with_plan("shell_signals");
    fs::write(folder.join("go.mdle"), "{ Go (wait 1000s) (Atom (null) (go 10 0)) }\n").unwrap();
    let phases = [
        ("load_plan go.mdle\nstep\nswap Go\n", "Go takes over in the next turn"),
        ("load_plan go.mdle\nstep\nswap Go atom\nstep\n", "2 turns, 0.1s"),
        ("load_plan go.mdle\nswap Go\nstep 5\n", "5 turns, 0.4s"),
        ("load_plan go.mdle\nswap Go\nstep 5\nrollback\nstep\n", "6 turns, 0.5s"),
        ("load_plan go.mdle\nswap Go\npace 1\nwatch /clock/turns\nwait 1000s\n", "0.0 s  /clock/turns 0"),
    ];
    for (commands, last) in phases {
        let mut child = started(&folder, &[]);
        let mut input = child.stdin.take().unwrap();
        input.write_all(commands.as_bytes()).unwrap();
        let mut answers = BufReader::new(child.stdout.take().unwrap()).lines().map(Result::unwrap);
        assert!(answers.any(|answer| answer == last), "{commands}");
        kill_process(Pid::from_child(&child), Signal::TERM).unwrap();
        let output = child.wait_with_output().unwrap();
        let err = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(143), "{commands}{err}");
        assert!(err.contains("stopped by SIGTERM\n"), "{commands}{err}");
    }
}
