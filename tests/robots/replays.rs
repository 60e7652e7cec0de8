//! Tests that runs of every kind can be repeated to the bit from their records: with random errors, modules, child
//! processes, safety rules, and operators who replace plans, in the simulator and on both emulated robots.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::fmt::Write as _;
use std::fs;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

use mdle_atrv_emulator::atrv::{Atrv, step};
use mdle_emulator::{Emulated, Pace, Port, serve};
use mdle_record::frames::Frames;
use mdle_record::{RecordFile, RecordedTurn, Records, TurnMade};
use mdle_scout_emulator::scout::Scout;
use mdle_sim::{Body, Make, Simulated, World};
use mdle_tests::chance::{Chance, repeated};
use mdle_tests::driving_plan::random_plan;
use mdle_tests::executable::{folder, mdle};

const PERIOD: Duration = Duration::from_millis(100);
const IN_LOCKSTEP: Pace = Pace::Lockstep(PERIOD);
/// Number of kinds of runs.
const KINDS: u64 = 10;
/// Number of runs if the variable `MDLE_LONG` is 1; without the variable, half as many.
const RUNS: u64 = 100;

/// Files of all runs. `Rounds` has a loop, a memory, a rising condition and a frame; `Sound` and `Ears` read modules;
/// `Back` is the plan to which a safety rule diverts, and uses another file.
const FILES: [(&str, &str); 10] = [
    (
        "rounds.mdle",
        "{ Rounds (wait 30s)
  ((Atom (RISING (r0 < 80cm) OR wait 4s) (go 30 0)) ahead: (Atom (wait 2s OR bumper) (go 0 0.7))
  FRAME here (Atom (NOT after ahead (wait 2s) OR wait 1s) stop))^inf
}
",
    ),
    ("go.mdle", "{ Go (wait 20s)\n  (Atom (bumper OR wait 3s) (go 60 0))\n  (Atom (wait 2s) (go -20 0.3))\n}\n"),
    (
        "sound.mdle",
        "{ Sound (bumper OR age(heading module) > 5s OR wait 20s)
  (Atom (range(heading module) < 60cm) goAvoid(heading module))
  (Atom (wait 1) stop)
}
",
    ),
    (
        "ears.mdle",
        "{ Ears (bumper OR age(ears module) > 1s OR wait 9s)\n  (Atom (range(ears module) < 50cm) (go 20 0))\n}\n",
    ),
    ("back.mdle", "use \"parts.mdle\"\n{ Back (wait 3s) Leg(1s) Leg(2s) }\n"),
    ("parts.mdle", "{ Leg(long: time) (Atom (wait long) (go -20 0.1)) }\n"),
    (
        "ears.py",
        "import json, sys
print(json.dumps({'publishes': {'range': 'cm'}, 'reads': {'sensors/x': 'cm'}}), flush=True)
for number, line in enumerate(sys.stdin):
    x = json.loads(line)['sensors/x']
    print(json.dumps({'range': None if x is None or number % 7 == 3 else 90 - x}), flush=True)
",
    ),
    (
        "rules.toml",
        "[limits]\nspeed = \"40cm/s\"\nturn_rate = \"90deg/s\"\nacceleration = \"50cm/s2\"\n
[[fence]]\ninside = [[-3, -3], [3, -3], [3, 3], [-3, 3]]\nmargin = \"3cm\"\ndeceleration = \"0.5m/s2\"\n
[guards.near]\nwhen = \"r0 < 30cm AND v > 5cm/s\"\nthen = \"hold forward\"\n
[guards.slow]\nwhen = \"range(heading module) < 1.8m AND v > 25cm/s\"\nthen = \"hold\"\n
[guards.far]\nwhen = \"x > 80cm\"\nthen = \"end\"\n",
    ),
    ("push.mdle", "{ Push (wait 60s)\n  (Atom (null) (go 60 0))\n}\n"),
    ("push.toml", "[limits]\nacceleration = \"50cm/s2\"\n\n[contact]\nthen = \"back.mdle\"\n"),
];

/// Returns a folder with the files, and with the random plan and commands of the run with this number.
fn prepared(number: u64) -> PathBuf {
    let folder = folder(&format!("replay-{number}"));
    for (name, text) in FILES {
        fs::write(folder.join(name), text).unwrap();
    }
    let mut chance = Chance::new(number);
    fs::write(folder.join("random.mdle"), random_plan(&mut chance)).unwrap();
    fs::write(folder.join("commands"), commands(&mut chance)).unwrap();
    folder
}

/// Returns random commands of a session, some of which are refused.
fn commands(chance: &mut Chance) -> String {
    let mut text = "load_plan go.mdle\nload_plan sound.mdle\nstep 3\n".to_owned();
    for _ in 0..12 {
        let steps = 1 + chance.below(12);
        let command = chance.pick(&[
            "swap Go now",
            "swap Go atom",
            "swap Rounds plan",
            "swap Rounds atom",
            "swap Sound now",
            "set /usr/mdle/main { Typed (wait 2s) (Atom (null) (go 0 0.5)) }",
            "rollback",
            "rollback",
            "cancel",
            "set /usr/mdle/trial 500ms",
            "set /safety/limits/speed 20cm/s",
            "set /safety/limits/acceleration 2m/s2",
            "pause",
        ]);
        writeln!(text, "{command}\nstep {steps}").unwrap();
    }
    text + "wait\n"
}

/// Returns the arguments of `mdle` for the run with this number, without the device of an emulated robot.
fn arguments(number: u64) -> String {
    let body = ["ideal", "scout", "atrv"][number as usize % 3];
    let sim = format!("--target sim --world hall --speed max --body {body} --seed {number} --timeout 100");
    let line = "--lockstep --timeout 60";
    let session = "--paused -c commands";
    let arguments = match number % KINDS {
        0 => format!("run random.mdle {sim}"),
        1 => format!("run rounds.mdle {sim}"),
        2 => format!("run sound.mdle {sim} --point 2,1"),
        3 => format!("run ears.mdle {sim} --module {}", "ears=exec\u{a0}python3\u{a0}ears.py"),
        4 => format!("run rounds.mdle {sim} --safety rules.toml --point 1,1"),
        5 => format!("run push.mdle {sim} --safety push.toml"),
        6 => format!("shell rounds.mdle {sim} {session} --point 2,0"),
        7 => format!("shell sound.mdle {sim} {session} --point -2,1 --safety rules.toml"),
        8 => format!("shell rounds.mdle --target scout {line} {session} --point 2,0"),
        _ => format!("shell go.mdle --target atrv {line} {session} --point 2,0 --safety rules.toml"),
    };
    format!("{arguments} --log run.mcap")
}

/// Runs `mdle` with these arguments, which are separated by spaces; a no-break space represents a space inside an
/// argument. Returns the output and the exit status.
fn run(folder: &Path, arguments: &str) -> (String, i32) {
    let words = arguments.split(' ').map(|word| word.replace('\u{a0}', " "));
    let output = Command::new(mdle()).args(words).current_dir(folder).output().unwrap();
    let text = [output.stdout, output.stderr].map(|bytes| String::from_utf8(bytes).unwrap()).concat();
    (text, output.status.code().unwrap())
}

/// Runs `mdle` on an emulated robot at this pace. Returns the output and the exit status.
fn emulated<R: Emulated + Send>(folder: &Path, mut robot: R, pace: Pace, arguments: &str) -> (String, i32) {
    let (port, over) = (Port::open().unwrap(), AtomicBool::new(false));
    thread::scope(|scope| {
        let serving = scope.spawn(|| serve(&mut robot, &port, pace, &|| !over.load(Ordering::Relaxed)));
        let outcome = run(folder, &format!("{arguments} --device {}", port.path().display()));
        over.store(true, Ordering::Relaxed);
        serving.join().unwrap().unwrap();
        outcome
    })
}

/// Returns a simulated robot with all errors of its body.
fn simulated(body: Body, step: Duration, seed: u64) -> Simulated {
    let world = World::named("hall").unwrap().unwrap();
    let make = Make { body, without: Vec::new(), seed: Some(seed) };
    Simulated::with(&make, &world, world.start, step).unwrap()
}

/// Records the run with this number; returns its folder and its output.
fn recorded(number: u64) -> (PathBuf, String) {
    let (folder, arguments) = (prepared(number), arguments(number));
    let (text, status) = match number % KINDS {
        8 => {
            let robot = Scout::new(simulated(Body::Scout, PERIOD, number)).unwrap();
            emulated(&folder, robot, IN_LOCKSTEP, &arguments)
        }
        9 => {
            let step = step(IN_LOCKSTEP);
            let robot = Atrv::new(simulated(Body::Atrv, step, number), step, false).unwrap();
            emulated(&folder, robot, IN_LOCKSTEP, &arguments)
        }
        _ => run(&folder, &arguments),
    };
    // 1: a command was refused; 6: a safety rule ended the plan.
    assert!(matches!(status, 0 | 1 | 4 | 6), "{arguments}: {status}\n{text}");
    (folder, text)
}

/// Copies the record `run.mcap` to `bare.mcap` without the changes in its turns.
fn without_changes(folder: &Path) {
    let (begin, turns) = Records::open(fs::File::open(folder.join("run.mcap")).unwrap()).unwrap();
    let (mut frames, mut bytes) = (Frames::default(), Vec::new());
    let turns: Vec<_> = turns.map(Result::unwrap).collect();
    frames.begin(&begin, &turns[0].y, &mut bytes);
    for RecordedTurn { number, t, y, sent, applied, plan, state, steps, overruled, .. } in turns {
        let made = TurnMade { number, t, sent, applied, plan, state, changes: &[], overruled: overruled.as_ref() };
        frames.turn(made, &y, steps.into_iter(), &mut bytes);
    }
    frames.end(&mut bytes);
    RecordFile::new(fs::File::create(folder.join("bare.mcap")).unwrap()).write_all(&bytes).unwrap();
}

/// A run depends on modules and operators: without their changes, the record does not replay.
#[test]
fn a_replay_needs_the_changes_of_a_record() {
    for number in [62, 63, 66, 67] {
        let (folder, report) = recorded(number);
        without_changes(&folder);
        let (text, status) = run(&folder, "replay bare.mcap");
        assert!(text.contains(" differs\n") && status == 1, "{number}: {text}{report}");
        assert!(run(&folder, "replay run.mcap").0.starts_with("the same to the bit, "));
    }
}

/// A record contains only the values that the run has read. If another plan reads other values in a replay, it waits
/// for them.
#[test]
fn another_plan_reads_what_the_run_has_read() {
    let (folder, _) = recorded(72);
    let plan = |reads: &str| format!("{{ Sound (wait 20s) (Atom ({reads}) (go 0 0.3)) (Atom (null) stop) }}");
    let replay = |reads: &str| {
        fs::write(folder.join("other.mdle"), plan(reads)).unwrap();
        run(&folder, "replay run.mcap --plan other.mdle").0
    };
    let (known, unknown) = (replay("range(heading module) < 60cm"), replay("range(ears module) < 60cm"));
    assert!(known.contains("replayed: 0 m/s, 0.3 rad/s\n"), "{known}");
    assert!(unknown.contains("input by\n  recorded: the law of the atom\n  replayed: the null input\n"), "{unknown}");
}

/// Returns how often a text occurs in a record.
fn count(record: &[u8], text: &str) -> usize {
    record.windows(text.len()).filter(|bytes| *bytes == text.as_bytes()).count()
}

#[test]
fn runs_of_every_kind_replay_to_the_bit() {
    const WORDS: [&str; 6] = [
        "\"kind\":\"plan\"",
        "\"kind\":\"safety\"",
        ": rolled back\"",
        "\"diverted: contact\"",
        "\"ended: far\"",
        "\"held: ",
    ];
    let mut counts = [0; WORDS.len()];
    for number in 0..repeated(RUNS) {
        let (folder, report) = recorded(number);
        // The replay needs no file other than the record.
        for (name, _) in FILES {
            fs::remove_file(folder.join(name)).unwrap();
        }
        let (text, status) = run(&folder, "replay run.mcap");
        let turns = text.strip_prefix("the same to the bit, ").and_then(|rest| rest.split_once(" turn"));
        let turns = turns.filter(|(_, rest)| ["\n", "s\n"].contains(rest)).map(|(turns, _)| turns);
        let turns: u64 = turns.unwrap_or_else(|| panic!("{number}: {text}{report}")).parse().unwrap();
        assert!(turns > 0 && status == 0, "{number}: {text}{report}");
        let record = fs::read(folder.join("run.mcap")).unwrap();
        counts.iter_mut().zip(WORDS).for_each(|(sum, word)| *sum += count(&record, word));
        fs::remove_dir_all(&folder).unwrap();
    }
    assert!(counts.iter().all(|count| *count > 1), "{WORDS:?}: {counts:?}");
}

/// Plans and modules run on workers with a deadline, and a process publishes at arbitrary times.
#[test]
fn a_run_in_real_time_replays_to_the_bit() {
    let folder = prepared(1001);
    let commands = "load_plan sound.mdle\nload_plan ears.mdle\nwait 500ms\nset /usr/mdle/main Sound\nwait 1s\n\
                    rollback\nwait 500ms\nset /usr/mdle/main Ears\nwait 1s\n";
    fs::write(folder.join("commands"), commands).unwrap();
    let arguments = "shell rounds.mdle --target scout -c commands --point 2,0 --module ears=exec\u{a0}python3\u{a0}ears.py \
                     --log run.mcap";
    let robot = Scout::new(simulated(Body::Scout, Pace::Real.step(), 3)).unwrap();
    // A busy machine may be too slow for the robot's line, which ends the run.
    let (report, status) = emulated(&folder, robot, Pace::Real, arguments);
    let (text, replayed) = run(&folder, "replay run.mcap");
    assert!(text.starts_with("the same to the bit, ") && replayed == 0, "{text}{status} {report}");
    assert!(matches!(status, 0 | 1 | 3), "{status} {report}");
}

/// The rule ends the plan on trial but not the run. The previous plan continues, both in the run and in the replay.
#[test]
fn a_trial_that_a_rule_ends_replays_to_the_bit() {
    let folder = prepared(1000);
    fs::write(folder.join("stand.mdle"), "{ Stand (wait 20s)\n  (Atom (null) stop)\n}\n").unwrap();
    fs::write(folder.join("far.toml"), "[guards.far]\nwhen = \"x > 60cm AND v > 50cm/s\"\nthen = \"end\"\n").unwrap();
    fs::write(folder.join("commands"), "load_plan go.mdle\nstep 3\nset /usr/mdle/main Go\nwait 4s\n").unwrap();
    let options = "--target sim --world hall --speed max --paused -c commands --safety far.toml --log run.mcap";
    let (report, status) = run(&folder, &format!("shell stand.mdle {options}"));
    assert!(report.contains("warning: the plan Go on trial is ended: the safety rule far ends it"), "{report}");
    let (text, replayed) = run(&folder, "replay run.mcap");
    assert!(text.starts_with("the same to the bit, ") && (status, replayed) == (0, 0), "{text}{report}");
    assert_eq!(count(&fs::read(folder.join("run.mcap")).unwrap(), "plan 1: rolled back"), 1);
}
