//! Tests modules in `mdle shell`: their attributes and settings, and how they are stopped, unloaded and loaded.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::fs;
use std::io::Write as _;
use std::process::{Command, Stdio};

use mdle_tests::executable::{folder, mdle};

/// Returns the dialogue with the program that has modules, its standard error, and its exit status.
fn dialogue(test: &str, options: &[&str], commands: &str) -> String {
    let folder = folder(test);
    fs::write(folder.join("plan.mdle"), "{ Ahead (wait 60s)\n  (Atom (range(heading module) < 1m) (go 60 0))\n}\n")
        .unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_modular"));
    command.args(["shell", "plan.mdle", "--target", "sim", "--world", "hall", "--speed", "max", "--paused", "-x"]);
    command.args(options).current_dir(folder);
    let mut child = command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    child.stdin.take().unwrap().write_all(commands.as_bytes()).unwrap();
    let output = child.wait_with_output().unwrap();
    let [out, err] = [output.stdout, output.stderr].map(|bytes| String::from_utf8(bytes).unwrap());
    format!("{out}---\n{err}[{}]\n", output.status.code().unwrap())
}

#[test]
fn only_a_run_is_warned_of_a_missing_module() {
    let folder = folder("modules_warning");
    fs::write(folder.join("plan.mdle"), "{ Near (wait 1s)\n  (Atom (range(heading module) < 1m) stop)\n}\n").unwrap();
    let warned = ["--help", "--nonsense", "--speed max"].map(|options| {
        let mut command = Command::new(mdle());
        command.args(["run", "plan.mdle", "--target", "sim"]).args(options.split(' ')).current_dir(&folder);
        String::from_utf8(command.output().unwrap().stderr).unwrap().contains("warning: the plan reads the module")
    });
    assert_eq!(warned, [false, false, true]);
}

#[test]
fn settings_are_read_and_set_in_their_units() {
    let commands = "ls /usr\nls /usr/heading\nget /usr/heading/range\nstep\nget /usr/heading/range\ncd /usr/heading\n\
                    get ahead\nset ahead 4m\nget ahead\nstep 2\nget range\nget bearing\nset gain 2\nset is_on false\n\
                    set count 12\nset name x  y\nset place 1m -50cm 90deg\nset delay 20ms\nset weights 3 4 5\nset key 0aff\n\
                    step\nget copy\nget place\nget weights\nget key\nget delay\nhelp ahead\nhelp key\nhelp copy\n\
                    set ahead 3\nset ahead 3s\nset ahead NaN\nset gain inf\nset gain 1m\nset is_on yes\nset count 1.5\n\
                    set place 1m\nset delay -1s\nset weights 1 b\nset key 0\nset range 3m\nset .state stopped\nset nothing 3\n";
    insta::assert_snapshot!(dialogue("modules_set", &[], commands));
}

#[test]
fn modules_are_stopped_unloaded_and_loaded() {
    let commands = "step 3\nget /usr/counter/count\nget /usr/counter/.state\ncall /usr/heading/.stop\n\
                    get /usr/heading/.state\nget /usr/heading/copy\nset /usr/heading/ahead 9m\nstep 3\n\
                    get /usr/heading/range\ncall /usr/heading/.start\nstep 2\nget /usr/heading/.state\n\
                    get /usr/heading/range\nls /lib\ncall /lib/heading\ncall /usr/heading/.unload\nls /usr\n\
                    get /usr/heading/range\nstep\ncall /lib/heading\nget /usr/heading/range\nstep 2\n\
                    get /usr/heading/range\ncall /usr/counter/.unload now\ncall /usr/counter/.unload\n\
                    call /usr/counter/.unload\ncall /lib/nothing\nstep\nls /usr\n";
    insta::assert_snapshot!(dialogue("modules_load", &[], commands));
}

#[test]
fn a_child_process_is_loaded_as_a_module() {
    let nose = "echo '{\"publishes\": {\"smell\": \"number\"}}'; while read line; do echo '{\"smell\": 7}'; done";
    let commands = format!(
        "ls /lib\nhelp /lib/process\ncall /lib/process\ncall /lib/process nose\ncall /lib/process heading true\n\
         call /lib/process 2 true\ncall /lib/process nose exit 7\ncall /lib/process nose {nose}\nstep 2\nls /usr/nose\n\
         get /usr/nose/smell\ncall /usr/nose/.unload\nstep\nls /usr\ncall /lib/heading now\n"
    );
    insta::assert_snapshot!(dialogue("modules_process", &[], &commands));
}

#[test]
fn a_module_that_never_returns_ends_the_program() {
    let commands = "step 3\nset /usr/heading/name for ever\nstep 2\nget /clock/turns\n";
    let log = folder("modules_hang_log").join("hang.jsonl");
    let dialogue = dialogue("modules_hang", &["--log", log.to_str().unwrap()], commands);
    let sentence =
        "a fault stopped the robot: turn 3 has not ended after 10 s: code of the module `heading` never returns";
    assert!(dialogue.ends_with(&format!("---\nerror: {sentence}\n[3]\n")), "{dialogue}");
    let log = fs::read_to_string(log).unwrap();
    // In turn 0 no plan runs yet: the module has published nothing.
    assert_eq!(log.lines().count(), 2, "{log}");
}

#[test]
fn a_role_decides_what_may_be_done_with_modules() {
    let commands = "step\nset /usr/heading/ahead 4m\ncall /usr/heading/.stop\ncall /lib/heading\n";
    let all = ["view", "tune", "swap"].map(|role| dialogue(&format!("modules_{role}"), &["--role", role], commands));
    insta::assert_snapshot!(all.join("\n"));
}

#[test]
fn stop_and_start_say_what_they_do() {
    let commands = "step\ncall /usr/heading/.stop\ncall /usr/heading/.stop\ncall /usr/heading/.start\n\
                    call /usr/heading/.start\ncall /usr/sensors/.start\ncall /usr/sensors/.stop\n\
                    call /lib/process robot true\ncall /lib/process mdle true\n";
    insta::assert_snapshot!(dialogue("modules_hold", &[], commands), @"
    > step
    1 turn, 0s
    > call /usr/heading/.stop
    heading makes no turns from now on
    > call /usr/heading/.stop
    heading is stopped already
    > call /usr/heading/.start
    heading makes turns from now on
    > call /usr/heading/.start
    heading makes turns already
    > call /usr/sensors/.start
    sensors makes no turns before a plan, a rule or a module reads it
    > call /usr/sensors/.stop
    nothing reads sensors, so it makes no turns; from now on none even if something does
    > call /lib/process robot true
    > call /lib/process mdle true
    ---
    error: standard input:8: the name `robot` is reserved for `/usr/robot`: give the module another name
    error: standard input:9: the name `mdle` is reserved for `/usr/mdle`: give the module another name
    [1]
    ");
}

/// A module without turns has no cost: a child process, and a module that nothing reads.
#[test]
fn the_tree_shows_how_long_a_turn_of_a_module_takes() {
    let commands = "get /usr/heading/.cost\ncall /lib/process nose echo '{}'; while read line; do echo '{}'; done\nstep 3\n\
                    get /usr/heading/.cost\nget /usr/mdle/.cost\nget /usr/sensors/.cost\nget /usr/nose/.cost\n";
    let dialogue = dialogue("modules_cost", &[], commands);
    let answers: Vec<_> = dialogue.lines().filter(|line| !line.starts_with('>')).collect();
    let &[none, _, heading, plan, sensors, nose, ..] = answers.as_slice() else { panic!("{dialogue}") };
    assert_eq!([none, sensors, nose], ["(no value yet)"; 3], "{dialogue}");
    for cost in [heading, plan] {
        let cost: f64 = cost.strip_suffix("ms").unwrap().parse().unwrap();
        assert!(cost > 0.0 && cost < 1000.0, "{dialogue}");
    }
}
