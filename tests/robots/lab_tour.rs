//! Tests the paper's lab tour from end to end: the real `mdlec` compiles it, and the executable drives it.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::fs;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::OnceLock;

use mdle_tests::executable::{folder, run_mdlec};
use mdle_tests::golden::judge;
use mdle_tests::repository::{TextFile, root};
use serde_json::{Value, json};

/// Returns the executable of the tour, which is built once.
fn tour() -> &'static Path {
    static TOUR: OnceLock<PathBuf> = OnceLock::new();
    TOUR.get_or_init(|| {
        let folder = folder("lab_tour");
        let plan = root().join("plans/lab_tour.mdle");
        let output = run_mdlec(&folder, &[plan.to_str().unwrap(), "--target", "sim"]);
        let message = String::from_utf8(output.stderr).unwrap();
        assert!(output.status.success(), "{message}");
        assert!(message.contains("lab_tour: built in "), "{message}");
        folder.join("lab_tour")
    })
}

fn run(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(tour()).args(arguments).current_dir(folder).output().unwrap()
}

/// Pose of the robot.
#[derive(Debug, Clone, Copy)]
struct Place {
    x: f64,
    y: f64,
    /// Heading in degrees, from 0 to 360.
    heading: f64,
}

fn places(trail: &str) -> Vec<(f64, Place)> {
    let numbers = |line: &str| line.split(',').map(|number| number.parse().unwrap()).collect::<Vec<f64>>();
    let rows = trail.lines().skip(1).map(numbers);
    rows.map(|row| (row[0], Place { x: row[1], y: row[2], heading: row[3].rem_euclid(360.0) })).collect()
}

fn apart(one: f64, other: f64) -> f64 {
    let apart = (one - other).rem_euclid(360.0);
    apart.min(360.0 - apart)
}

/// Zone in which an atom must end and, for an atom that turns, the required heading (docs/src/reference/office.md, 2).
type Zone = ([f64; 4], Option<(f64, f64)>);

const ROUND: f64 = 35.0;
const AB: [f64; 4] = [-0.9, 0.9, 4.0, 5.5];
const BC: [f64; 4] = [6.7, 8.3, 3.9, 5.6];
const C: [f64; 4] = [6.7, 8.3, 0.8, 4.5];
const LAB_1: [f64; 4] = [6.7, 8.3, -0.2, 0.8];
const CORNER: [f64; 4] = [6.7, 8.3, -0.9, 0.25];
const OFFICE: [f64; 4] = [11.05, 11.95, -0.9, 0.9];
const ZONES: [Zone; 13] = [
    (AB, None),
    (AB, Some((0.0, ROUND))),
    (AB, Some((0.0, ROUND))),
    (BC, None),
    (BC, Some((270.0, ROUND))),
    (BC, Some((270.0, ROUND))),
    (C, None),
    (LAB_1, None),
    (CORNER, None),
    (CORNER, Some((0.0, ROUND))),
    (CORNER, Some((0.0, ROUND))),
    (OFFICE, None),
    (OFFICE, Some((270.0, 15.0))),
];

fn assert_in_zone(atom: usize, place: Place) {
    let ([left, right, low, high], heading) = ZONES[atom - 1];
    let inside = (left..=right).contains(&place.x) && (low..=high).contains(&place.y);
    assert!(inside, "atom {atom} ended at {place:?}");
    if let Some((degrees, most)) = heading {
        assert!(apart(place.heading, degrees) <= most, "atom {atom} ended at {place:?}");
    }
}

#[test]
fn it_goes_from_lab_2_past_lab_1_to_the_office() {
    let folder = folder("lab_tour_run");
    let options = ["--speed", "max", "--plot", "tour.svg", "--record", "record.svg", "--trail", "tour.csv"];
    let output = run(&folder, &options);
    let message = String::from_utf8(output.stdout).unwrap();
    assert_eq!((output.status.code(), output.stderr.as_slice()), (Some(0), &b""[..]), "{message}");
    let trail = places(&fs::read_to_string(folder.join("tour.csv")).unwrap());
    let (ends, over) = message.trim_end().rsplit_once('\n').unwrap();
    let mut atoms = 0;
    for (line, atom) in ends.lines().zip(1..) {
        let (t, entered) = line.split_once(" s  ").unwrap();
        let t: f64 = t.parse().unwrap();
        assert!(entered.starts_with(&format!("{} (", law(atom as u64 + 1))), "no atom is left out: {line}");
        let (_, place) = trail.iter().find(|(when, _)| (when - t).abs() < 1e-6).unwrap();
        assert_in_zone(atom, *place);
        atoms = atom;
    }
    assert_eq!(atoms, 12, "{message}");
    let (end, over) = over.split_once(" s  ").unwrap();
    let place = "(lab_tour.mdle:30)";
    assert!(
        [format!("plan over: completed {place}"), format!("plan over: wait 10 {place}")].contains(&over.to_owned())
    );
    assert_in_zone(13, trail.last().unwrap().1);
    let record = fs::read_to_string(folder.join("record.svg")).unwrap();
    // The time of the end is in the picture's title and at the end of the film, as in the last line of the run.
    for clock in [format!(" over after {end} s: "), format!(">{end} s, shown ")] {
        assert!(record.contains(&clock), "{clock}");
    }
    assert!(record.len() < 1_000_000 && record.contains("goAvoid 180 40 20"), "{} bytes", record.len());
    let picture = fs::read(folder.join("tour.svg")).unwrap();
    let shown = fs::read(root().join("docs/lab_tour.svg")).unwrap();
    assert!(
        picture == shown,
        "docs/lab_tour.svg is not the picture the tour makes now: copy {folder:?}/tour.svg there"
    );
}

#[test]
fn it_gives_the_same_bytes_on_every_processor() {
    let files = |name: &str, tunables: Option<&str>| {
        let folder = folder(name);
        let mut command = Command::new(tour());
        command.args(["--speed", "max", "--seed", "4", "--plot", "tour.svg", "--trail", "tour.csv", "--log", "log"]);
        command.args(["--record", "record.svg"]);
        if let Some(tunables) = tunables {
            command.env("GLIBC_TUNABLES", tunables);
        }
        let output = command.current_dir(&folder).output().unwrap();
        assert!(output.status.success());
        let written = ["tour.svg", "record.svg", "tour.csv", "log"].map(|file| fs::read(folder.join(file)).unwrap());
        (output.stdout, written)
    };
    let once = files("bytes_once", None);
    assert!(once == files("bytes_again", None), "two runs differ");
    let plain = Some("glibc.cpu.hwcaps=-FMA,-AVX2");
    assert!(once == files("bytes_plain", plain), "a processor without FMA and AVX2 gives other bytes");
}

/// The executable and the compiler's machines behave equally on the same events.
#[test]
fn its_log_is_the_trace_of_what_it_met() {
    let folder = folder("lab_tour_log");
    assert!(run(&folder, &["--speed", "max", "--log", "log.jsonl"]).status.success());
    let log = fs::read_to_string(folder.join("log.jsonl")).unwrap();
    let turns: Vec<Value> = log.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let script: String = turns.iter().map(|turn| format!("{}\n", happenings(turn))).collect();
    fs::write(folder.join("script.jsonl"), script).unwrap();
    let plan = root().join("plans/lab_tour.mdle");
    for machine in ["tree", "counted"] {
        let plan = plan.to_str().unwrap();
        let output =
            run_mdlec(&folder, &["trace", plan, "--target", "sim", "--script", "script.jsonl", "--machine", machine]);
        let trace = String::from_utf8(output.stdout).unwrap();
        for (logged, traced) in log.lines().zip(trace.lines()) {
            assert_eq!(logged, traced, "{machine}");
        }
        assert_eq!(log.lines().count(), trace.lines().count(), "{machine}");
    }
    let transitions = turns.iter().flat_map(|turn| turn["fired"].as_array().unwrap()).count();
    assert!(transitions >= 13, "every atom of the tour ends, and {transitions} did");
}

/// Returns the line of a script that reports the events in a line of a log.
fn happenings(turn: &Value) -> Value {
    let (mut fired, mut completed) = (Vec::new(), Vec::new());
    for transition in turn["fired"].as_array().unwrap() {
        match transition["by"].as_str().unwrap() {
            "completed" => completed.push(law(transition["from"].as_u64().unwrap())),
            // Timers depend on time only, so a script does not report them.
            text if text.starts_with("wait ") => {}
            text => fired.push(text),
        }
    }
    json!({"t": turn["t"], "fired": fired, "completed": completed})
}

/// Returns the text of the law of a state of the tour, which has no loops.
fn law(state: u64) -> &'static str {
    static LAWS: OnceLock<Vec<String>> = OnceLock::new();
    let laws = LAWS.get_or_init(|| {
        let path = "plans/lab_tour.mdle".to_owned();
        let text = fs::read_to_string(root().join(&path)).unwrap();
        let machine = judge(&TextFile { path, text }, Some("sim")).0.swap_remove(0).machine;
        machine.atoms().map(|atom| atom.law().text.clone()).collect()
    });
    &laws[usize::try_from(state).unwrap() - 1]
}

#[test]
fn it_is_static() {
    let bytes = fs::read(tour()).unwrap();
    let half = |at: usize| usize::from(u16::from_le_bytes([bytes[at], bytes[at + 1]]));
    let headers = u64::from_le_bytes(bytes[32..40].try_into().unwrap()) as usize;
    let kinds = (0..half(56)).map(|number| half(headers + number * half(54)));
    // 3 is PT_INTERP, the path of a dynamic loader.
    assert!(kinds.into_iter().all(|kind| kind != 3), "it needs a dynamic loader");
}

#[test]
fn it_refuses_what_it_cannot_run_and_leaves_nothing_behind() {
    let folder = folder("lab_tour_refused");
    fs::write(folder.join("broken.toml"), "[[wall]]\nname = 3\n").unwrap();
    let cases: [&[&str]; 8] = [
        &["--world", "missing.toml"],
        &["--world", "broken.toml"],
        &["--start", "3.65,4.25,0"],
        &["--start", "0,0"],
        &["--speed", "0"],
        &["--plot", "missing/tour.svg"],
        &["--period", "0"],
        &["--nonsense"],
    ];
    let mut message = String::new();
    for arguments in cases {
        let output = run(&folder, arguments);
        assert_eq!((output.status.code(), output.stdout.as_slice()), (Some(2), &b""[..]), "{arguments:?}");
        message += &format!("$ ./lab_tour {}\n{}\n", arguments.join(" "), String::from_utf8(output.stderr).unwrap());
    }
    assert_eq!(fs::read_dir(&folder).unwrap().count(), 1, "only the broken world is there");
    insta::assert_snapshot!(message);
}

#[test]
fn a_limit_ends_it_with_its_own_status() {
    let folder = folder("lab_tour_limit");
    for limit in [["--turns", "5"], ["--timeout", "1.5"]] {
        let output = run(&folder, &[&limit[..], &["--speed", "max"]].concat());
        assert_eq!(output.status.code(), Some(4), "{limit:?}");
    }
}

#[test]
fn run_passes_on_the_status_of_the_executable() {
    let folder = folder("run");
    fs::write(folder.join("wait.mdle"), "{ Wait (Atom (wait 5) stop) }\n").unwrap();
    let run = |arguments: &[&str]| {
        let bare = ["wait.mdle", "--target", "sim", "--run", "--", "--speed", "max"];
        let command = ["run", "wait.mdle", "--target", "sim", "--", "--speed", "max"];
        let outputs = [&bare, &command].map(|words| run_mdlec(&folder, &[&words[..], arguments].concat()));
        let results = outputs.map(|output| (output.status.code(), String::from_utf8(output.stdout).unwrap()));
        assert_eq!(results[0], results[1]);
        results[0].clone()
    };
    assert_eq!(run(&[]), (Some(0), "5.0 s  plan over: wait 5 (wait.mdle:1)\n".to_owned()));
    assert_eq!(run(&["--turns", "3"]).0, Some(4));
    assert_eq!(run(&["--start", "nowhere"]).0, Some(2));
}

#[test]
fn run_passes_signals_to_the_executable() {
    let folder = folder("run_signalled");
    fs::write(folder.join("turns.mdle"), "{ Turns ((Atom (wait 1) (go 0 0.1)) (Atom (wait 1) stop))^inf }\n").unwrap();
    for (signal, status) in [("TERM", 143), ("INT", 130)] {
        let mut command = mdle_tests::executable::command(&folder, &["run", "turns.mdle", "--target", "sim"]);
        let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        // The plan certainly runs once its second atom has been reported.
        let mut line = String::new();
        BufReader::new(child.stdout.as_mut().unwrap()).read_line(&mut line).unwrap();
        assert!(line.contains("  stop (turns.mdle:1"), "{line}");
        let sent = Command::new("kill").args(["-s", signal, &child.id().to_string()]).status().unwrap();
        assert!(sent.success());
        let output = child.wait_with_output().unwrap();
        let message = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(status), "{message}");
        assert!(message.ends_with(&format!("stopped by SIG{signal}\n")), "{message}");
    }
}
