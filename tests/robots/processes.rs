//! Tests modules that are child processes: a plan that reads a module in Python, all faults of such a process, and that
//! no process is left when the run has ended.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use mdle_tests::executable::{folder, mdle};
use rustix::process::{Pid, Signal, kill_process};

/// A plan that drives until a module publishes a short range, or publishes nothing for a second.
const PLAN: &str = "{ Near (bumper OR age(ears module) > 1s OR wait 8s)
  (Atom (range(ears module) < 50cm) (go 20 0))
  (Atom (wait 1) stop)
}
";

/// A process that publishes the bearing and range of a place ahead, and runs the statement `OTHER` before its answer
/// 10. It writes its process number, and those of its children, to the file `pid`.
const PROGRAM: &str = "import json, os, signal, subprocess, sys, time
def say(**line):
    print(json.dumps(line), flush=True)
def note(pid):
    with open('pid', 'a') as file:
        file.write(f'{pid}\\n')
note(os.getpid())
FIRST
say(publishes={'bearing': 'deg', 'range': 'cm'}, reads={'sensors/x': 'cm', 'sensors/r0': 'm', 'sensors/bumper': 'flag'})
for number, line in enumerate(sys.stdin):
    line = json.loads(line)
    if number == 10:
        OTHER
    x = line['sensors/x']
    say(bearing=0, range=None if x is None else 120 - x)
";

/// Returns a folder with the plan and a process. The process runs `first` before its declaration, and `other` before
/// its answer 10.
fn with_process(test: &str, first: &str, other: &str) -> PathBuf {
    let folder = folder(test);
    fs::write(folder.join("plan.mdle"), PLAN).unwrap();
    fs::write(folder.join("ears.py"), PROGRAM.replace("FIRST", first).replace("OTHER", other)).unwrap();
    folder
}

/// Returns the command `mdle run` for the plan in the simulator.
fn run(folder: &Path, speed: &str) -> Command {
    let mut command = Command::new(mdle());
    command.args(["run", "plan.mdle", "--target", "sim", "--world", "hall", "--speed", speed]);
    command.args(["--module", "ears=exec python3 ears.py"]).current_dir(folder);
    command
}

/// Returns standard output, standard error and the exit status of a run.
fn report(mut command: Command) -> String {
    let Output { status, stdout, stderr } = command.output().unwrap();
    let [out, err] = [stdout, stderr].map(|bytes| String::from_utf8(bytes).unwrap());
    format!("{out}{err}[{}]\n", status.code().unwrap())
}

/// Returns the process numbers in the file `pid`.
fn processes(folder: &Path) -> Vec<u32> {
    let text = fs::read_to_string(folder.join("pid")).unwrap_or_default();
    text.lines().map(|line| line.parse().unwrap()).collect()
}

/// Returns `true` if a process runs. A process that has ended, but for which its parent has not waited yet, does not
/// count.
fn is_running(process: u32) -> bool {
    let stat = fs::read_to_string(format!("/proc/{process}/stat")).unwrap_or_default();
    stat.rsplit(") ").next().is_some_and(|state| !state.is_empty() && !state.starts_with(['Z', 'X']))
}

/// Waits until `is_so` returns `true`, for at most a minute.
#[track_caller]
fn wait_for(what: &str, is_so: impl Fn() -> bool) {
    let begun = Instant::now();
    while !is_so() {
        assert!(begun.elapsed() < Duration::from_secs(60), "{what}");
        thread::sleep(Duration::from_millis(10));
    }
}

#[test]
fn a_plan_waits_for_what_a_process_publishes() {
    let folder = with_process("waits", "", "pass");
    let first = report(run(&folder, "max"));
    insta::assert_snapshot!(first, @"
    4.1 s  stop (plan.mdle:3)  <- range(ears module) = 0.49 m < 50cm (plan.mdle:2)
    5.1 s  plan over: wait 1 (plan.mdle:3)
    [0]
    ");
    assert_eq!(report(run(&folder, "max")), first, "simulated time waits for the process");
    assert_eq!(processes(&folder).len(), 2);
    assert!(!processes(&folder).into_iter().any(is_running));
}

#[test]
fn a_run_that_is_stopped_gives_up_no_process() {
    let undisturbed = report(run(&with_process("undisturbed", "", "pass"), "max"));
    // The process itself stops the run for longer than a module may take, as Ctrl-Z does, and answers afterwards.
    let pause = "mdle = os.getppid(); os.kill(mdle, signal.SIGSTOP); time.sleep(1.5); os.kill(mdle, signal.SIGCONT)";
    assert_eq!(report(run(&with_process("stopped", "", pause), "max")), undisturbed);
}

#[test]
fn what_a_process_does_wrong_ends_its_module() {
    let faults = [
        ("dies", "sys.exit(3)"),
        ("dies_in_a_line", "print('{\"bear', end='', flush=True); sys.exit(0)"),
        ("prints_garbage", "print('garbage \\x1b[2J', flush=True)"),
        ("prints_bytes", "os.write(1, b'\\xff\\xfe\\n')"),
        ("floods", "[say(range=1) for _ in range(100000)]"),
        ("floods_in_a_line", "os.write(1, b'x' * 70000)"),
        ("closes_its_output", "os.close(1); time.sleep(60)"),
        ("closes_its_input", "os.close(0); say(); time.sleep(60)"),
        ("hangs", "time.sleep(60)"),
        ("kills_its_group", "os.killpg(0, signal.SIGKILL)"),
        ("publishes_nan", "say(bearing=float('nan')); continue"),
        ("publishes_text", "say(bearing='left'); continue"),
        ("publishes_what_is_undeclared", "say(bering=1); continue"),
    ];
    let runs = faults.map(|(name, other)| {
        let folder = with_process(name, "", other);
        thread::spawn(move || {
            let report = report(run(&folder, "max"));
            assert!(!processes(&folder).into_iter().any(is_running), "{name}");
            format!("{name}\n{report}")
        })
    });
    insta::assert_snapshot!(runs.map(|run| run.join().unwrap()).join("\n"));
}

#[test]
fn a_process_that_declares_nothing_is_refused() {
    let faults = [
        ("ends_at_once", "sys.exit(1)"),
        ("never_declares", "time.sleep(60)"),
        ("declares_garbage", "print('Hello, world!', flush=True)"),
        ("declares_no_unit", "say(publishes={'bearing': 'degrees'})"),
        ("declares_twice", "say(publishes={'bearing': 'm'}, reads={'sensors/x': 'deg'})"),
        ("declares_no_name", "say(publishes={'the bearing': 'deg'})"),
    ];
    let runs = faults.map(|(name, first)| {
        let folder = with_process(name, first, "pass");
        thread::spawn(move || {
            let report = report(run(&folder, "max"));
            assert!(!processes(&folder).into_iter().any(is_running), "{name}");
            format!("{name}\n{report}")
        })
    });
    let folder = with_process("commands", "", "pass");
    let others =
        ["ears=python3 ears.py", "mdle=python3 ears.py", "2=true", "nose=exit 7", "nose", "sensors=python3 ears.py"];
    let others = others.map(|module| {
        let mut command = run(&folder, "max");
        command.args(["--module", module]);
        format!("--module {module}\n{}", report(command))
    });
    let runs = runs.map(|run| run.join().unwrap());
    insta::assert_snapshot!([runs.as_slice(), others.as_slice()].concat().join("\n"));
    assert!(!processes(&folder).into_iter().any(is_running));
}

/// Statements that make a process ignore all signals except SIGKILL, and start a child process.
const STUBBORN: &str =
    "[signal.signal(each, signal.SIG_IGN) for each in (signal.SIGTERM, signal.SIGINT, signal.SIGHUP)]
note(subprocess.Popen(['sleep', '1000'], stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL).pid)
import atexit
atexit.register(time.sleep, 1000)";

#[test]
fn no_process_is_left_by_a_run_that_ends() {
    let folder = with_process("stubborn", STUBBORN, "pass");
    let report = report(run(&folder, "max"));
    assert!(report.contains("plan over") && report.ends_with("[0]\n"), "{report}");
    assert_eq!(processes(&folder).len(), 2);
    assert!(!processes(&folder).into_iter().any(is_running));
}

#[test]
fn no_process_is_left_by_a_run_that_is_killed() {
    for (signal, status) in [(Signal::TERM, Some(143)), (Signal::INT, Some(130)), (Signal::KILL, None)] {
        let folder = with_process(&format!("killed_{}", signal.as_raw()), STUBBORN, "pass");
        let mut child = run(&folder, "real").stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
        wait_for("the process starts", || processes(&folder).len() == 2);
        kill_process(Pid::from_child(&child), signal).unwrap();
        assert_eq!(child.wait().unwrap().code(), status);
        wait_for("the processes end", || !processes(&folder).into_iter().any(is_running));
    }
}

#[test]
fn safety_rules_watch_what_modules_publish() {
    let folder = with_process("rules", "", "sys.exit(3)");
    let write = |name: &str, text: &str| fs::write(folder.join(name), text).unwrap();
    write("drive.mdle", "{ Drive (wait 6s) (Atom (null) (go 20 0)) }\n");
    write("listen.mdle", "{ Listen (wait 6s OR range(ears module) < 1cm) (Atom (null) (go 20 0)) }\n");
    write("hold.toml", "[stale]\nmodule = \"1s\"\nthen = \"hold\"\n");
    write("end.toml", "[stale]\noutput = \"1s\"\nmodule = \"500ms\"\nthen = \"end\"\n");
    write("near.toml", "[guards.near]\nwhen = \"range(heading module) < 1m\"\nthen = \"end\"\n");
    write("silent.toml", "[guards.silent]\nwhen = \"age(ears module) > 1s\"\nthen = \"hold\"\n");
    write(
        "nobody.toml",
        "[guards.far]\nwhen = \"range(nose module) > 1m\"\nthen = \"end\"\n\n[stale]\nmodule = \"3s\"\nthen = \"end\"\n",
    );
    write("kind.toml", "[guards.far]\nwhen = \"range(nose module) > 1m\"\nthen = \"end\"\n");
    write("away.mdle", "{ Away (wait 6s) (Atom (range(nose module) > 1m) (go -20 0)) }\n");
    write("away.toml", "[contact]\nthen = \"away.mdle\"\n");
    let ears = "ears=exec python3 ears.py";
    let nose = "nose=echo '{\"publishes\": {\"range\": \"deg\"}}'; cat > /dev/null";
    let silent = "nose=echo '{\"publishes\": {\"range\": \"m\"}}'; cat > /dev/null";
    let runs = [
        ("drive.mdle", "hold.toml", ["--module", ears]),
        ("listen.mdle", "hold.toml", ["--module", ears]),
        ("listen.mdle", "end.toml", ["--module", ears]),
        ("drive.mdle", "near.toml", ["--point", "1.5,0"]),
        ("drive.mdle", "silent.toml", ["--module", ears]),
        ("drive.mdle", "nobody.toml", ["--module", ears]),
        ("drive.mdle", "nobody.toml", ["--module", silent]),
        ("drive.mdle", "kind.toml", ["--module", nose]),
        ("drive.mdle", "away.toml", ["--module", ears]),
        ("drive.mdle", "away.toml", ["--module", nose]),
        ("drive.mdle", "away.toml", ["--module", silent]),
    ];
    let reports = runs.map(|(plan, rules, options)| {
        let mut command = Command::new(mdle());
        command.args(["run", plan, "--target", "sim", "--world", "hall", "--speed", "max", "--safety", rules]);
        command.args(options).current_dir(&folder);
        format!("{plan} {rules} {}\n{}", options.join(" "), report(command))
    });
    insta::assert_snapshot!(reports.join("\n"));
}
