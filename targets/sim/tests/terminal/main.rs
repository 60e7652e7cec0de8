//! Tests the live view and the progress line in a real pseudo-terminal: both clear the screen when they end.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod pseudo;

use std::process::Command;

use pseudo::Terminal;
use rustix::process::Signal;

const ENTER: &str = "\x1b[?1049h\x1b[?25l";
const LEAVE: &str = "\x1b[0m\x1b[?25h\x1b[?1049l";

/// Returns the command of the example `tour`, which `cargo test` builds before it runs this test.
fn tour(options: &[&str]) -> Command {
    let mut path = std::env::current_exe().unwrap();
    path.pop();
    path.pop();
    path.extend(["examples", &format!("tour{}", std::env::consts::EXE_SUFFIX)]);
    assert!(path.exists(), "build it with `cargo build -p mdle-sim --example tour`");
    let mut command = Command::new(path);
    command.args(options).env("RUST_BACKTRACE", "0");
    command
}

/// Returns the output after the program has left the alternate screen. Panics unless the program entered the alternate
/// screen before, and sent no control sequences after leaving it.
fn behind_the_screen(seen: &str) -> &str {
    let (before, behind) = seen.split_once(LEAVE).unwrap();
    assert!(before.contains(ENTER), "{seen:?}");
    assert!(!behind.contains('\x1b'), "{behind:?}");
    behind
}

#[test]
fn a_run_is_watched_to_its_limit_and_reported_behind_the_screen() {
    let terminal = Terminal::start(tour(&["--watch", "--speed", "max", "--turns", "500"]), false);
    let (seen, status) = terminal.end();
    assert_eq!(status.code(), Some(4));
    for shown in
        ["goAvoid 90 40 20  (Lab2ToLab1Plan)", "until atIsection 0100", "heading 0", "Ctrl-C stops the robot", "⡇"]
    {
        assert!(seen.contains(shown), "{shown}: {seen}");
    }
    let behind = behind_the_screen(&seen);
    assert!(behind.starts_with("23.2 s  go 0 0.36 (Lab2ToLab1Plan)  <- atIsection 0100\r\n"), "{behind}");
    assert!(behind.ends_with("stopped by --turns: the plan was not over after 500 turns\r\n"), "{behind}");
}

#[test]
fn a_signal_gives_the_terminal_back() {
    let mut terminal = Terminal::start(tour(&["--watch"]), false);
    terminal.wait_for("Ctrl-C stops the robot");
    assert!(!terminal.echoes(), "keys would be drawn over the map");
    terminal.interrupt();
    terminal.wait_for("stopped by SIGINT");
    assert!(terminal.echoes());
    let (seen, status) = terminal.end();
    assert_eq!((behind_the_screen(&seen), status.code()), ("stopped by SIGINT\r\n", Some(130)));
}

#[test]
fn a_panic_gives_the_terminal_back_before_it_tells() {
    let mut terminal = Terminal::start(tour(&["--watch", "--speed", "max", "--panic-at", "5"]), false);
    terminal.wait_for("which is a bug");
    assert!(terminal.echoes());
    let (seen, status) = terminal.end();
    let behind = behind_the_screen(&seen);
    assert_eq!(status.code(), Some(3));
    assert!(behind.contains("panicked at") && behind.contains("the robot fell apart"), "{behind}");
}

#[test]
fn without_a_terminal_there_is_nothing_to_watch() {
    let output = tour(&["--watch"]).output().unwrap();
    assert_eq!((output.status.code(), output.stdout.as_slice()), (Some(2), &b""[..]));
    insta::assert_snapshot!(String::from_utf8(output.stderr).unwrap(), @"error: --watch: standard output is not a terminal; run it in a terminal, or make a picture with --plot or --record");
}

#[test]
fn a_fast_run_shows_that_it_goes_on_and_leaves_no_trace_of_it() {
    // A period so short that the tour takes a million turns.
    let mut terminal = Terminal::start(tour(&["--speed", "max", "--period", "0.0001"]), true);
    terminal.wait_for(" times as fast as real  goAvoid 90 40 20\x1b[K\r");
    terminal.interrupt();
    let (seen, status) = terminal.end();
    assert_eq!(status.code(), Some(130));
    assert!(seen.ends_with("\x1b[K\r\x1b[Kstopped by SIGINT\r\n"), "{seen:?}");
}

#[test]
fn a_batch_that_is_interrupted_says_what_was_done() {
    let mut terminal = Terminal::start(tour(&["--runs", "100000", "--jobs", "2", "--start-noise", "0.1,5"]), false);
    terminal.wait_for(" of 100000 runs, ");
    terminal.interrupt();
    let (seen, status) = terminal.end();
    assert_eq!(status.code(), Some(130));
    let (_, behind) = seen.rsplit_once("\x1b[K").unwrap();
    assert!(behind.contains(" of 100000 runs, seeds 1 to 100000: "), "{behind:?}");
    assert!(behind.ends_with("stopped by SIGINT\r\n"), "{behind:?}");
}

#[test]
fn every_signal_gives_the_terminal_back() {
    let signals = [Signal::HUP, Signal::QUIT, Signal::ABORT, Signal::ALARM, Signal::TERM, Signal::USR2, Signal::XCPU];
    for signal in signals {
        let mut terminal = Terminal::start(tour(&["--watch"]), false);
        terminal.wait_for("Ctrl-C stops the robot");
        terminal.send(signal);
        terminal.wait_for("stopped by SIG");
        assert!(terminal.echoes(), "{signal:?}");
        let (seen, status) = terminal.end();
        behind_the_screen(&seen);
        assert_eq!(status.code(), Some(128 + signal.as_raw()));
    }
}

#[test]
fn a_terminal_that_nobody_reads_holds_up_no_end() {
    let mut terminal = Terminal::start(tour(&["--watch", "--speed", "50"]), false);
    terminal.wait_for("Ctrl-C stops the robot");
    // The terminal's buffer is full within a second or two, which cannot be observed from outside.
    std::thread::sleep(std::time::Duration::from_secs(2));
    terminal.send(Signal::TERM);
    assert_eq!(terminal.end_unread().code(), Some(143));
    assert!(terminal.echoes());
}

#[test]
fn a_terminal_that_says_it_is_very_large_takes_no_memory() {
    let mut terminal = Terminal::sized(tour(&["--watch"]), false, u16::MAX, u16::MAX);
    terminal.wait_for("Ctrl-C stops the robot");
    let memory = terminal.memory();
    assert!(memory < 100_000, "{memory} kB");
    terminal.interrupt();
    assert_eq!(terminal.end().1.code(), Some(130));
}

#[test]
fn a_file_that_may_not_grow_is_an_error_of_that_file() {
    for option in ["--plot", "--record", "--trail", "--log"] {
        let folder = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("limited{option}"));
        let _ = std::fs::remove_dir_all(&folder);
        std::fs::create_dir_all(&folder).unwrap();
        let tour = tour(&["--speed", "max", "--turns", "50", option]);
        let mut shell = Command::new("sh");
        shell.args(["-c", "ulimit -f 0; exec \"$@\"", "sh"]).arg(tour.get_program()).args(tour.get_args());
        let output = shell.arg(folder.join("file")).output().unwrap();
        let errors = String::from_utf8(output.stderr).unwrap();
        // An incomplete log is a fault of the run.
        assert_eq!(output.status.code(), Some(if option == "--log" { 3 } else { 4 }), "{option} {errors}");
        assert!(errors.contains("cannot be written") && errors.contains("File too large"), "{option} {errors}");
    }
}
