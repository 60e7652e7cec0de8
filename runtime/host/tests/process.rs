//! The example `cart` as a program: real signals, closed and blocked pipes, exit statuses, panics.
#![expect(clippy::unwrap_used, reason = "what fails here is the test")]

use std::io::{BufRead, BufReader, Read};
use std::process::{Child, ChildStderr, Command, Output, Stdio};

/// The example, which `cargo test` builds before it runs this.
fn cart(arguments: &[&str]) -> Command {
    let mut path = std::env::current_exe().unwrap();
    path.pop();
    path.pop();
    path.extend(["examples", &format!("cart{}", std::env::consts::EXE_SUFFIX)]);
    assert!(path.exists(), "build it with `cargo build -p mdle-host --example cart`");
    let mut command = Command::new(path);
    command.args(arguments).env("RUST_BACKTRACE", "0").stdin(Stdio::null());
    command
}

/// Starts the cart with everything piped.
fn start(arguments: &[&str]) -> Child {
    cart(arguments).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
}

/// Options with which the cart tells what it is told, and drives on for longer than any test takes.
const FAR: [&str; 5] = ["--tell", "--period", "0.02", "--track", "1000"];

/// What this computer may not permit is told before anything else.
fn is_no_refusal(line: &str) -> bool {
    !line.starts_with("warning: turns may be late")
}

/// What the cart tells, and what is told of it.
fn lines(stderr: ChildStderr) -> impl Iterator<Item = String> {
    BufReader::new(stderr).lines().map(Result::unwrap).filter(|line| is_no_refusal(line))
}

/// Reads what the cart tells until it is told to move.
fn wait_until_it_moves(stderr: ChildStderr) -> impl Iterator<Item = String> {
    let mut lines = lines(stderr);
    assert!(lines.any(|line| line == "cart: 0.5 m/s"));
    lines
}

/// Sends a signal, by its name.
fn send(child: &Child, signal: &str) {
    let sent = Command::new("sh").arg("-c").arg(format!("kill -{signal} {}", child.id())).status().unwrap();
    assert!(sent.success());
}

/// Whether a line is none of the last words, on how late turns were.
fn is_no_timing(line: &str) -> bool {
    !line.contains(" turns of ") && !line.contains(" turn of ")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

#[test]
fn a_signal_stops_the_cart_and_names_the_status() {
    for (signal, status) in [("HUP", 129), ("INT", 130), ("TERM", 143)] {
        let mut child = start(&FAR);
        let lines = wait_until_it_moves(child.stderr.take().unwrap());
        send(&child, signal);
        let rest: Vec<_> =
            lines.skip_while(|line| line == "cart: 0.5 m/s").take_while(|line| is_no_timing(line)).collect();
        assert_eq!(rest, ["cart: 0 m/s".to_owned(), "cart: stop".to_owned(), format!("stopped by SIG{signal}")]);
        assert_eq!(child.wait().unwrap().code(), Some(status));
    }
}

#[test]
fn a_signal_is_noticed_in_a_long_period() {
    let mut child = start(&["--tell", "--period", "60"]);
    let mut lines = lines(child.stderr.take().unwrap());
    assert_eq!(lines.next().as_deref(), Some("cart: 0 m/s"));
    send(&child, "TERM");
    let rest: Vec<_> = lines.take_while(|line| is_no_timing(line)).collect();
    assert_eq!(rest, ["cart: 0 m/s", "cart: stop", "stopped by SIGTERM"]);
    assert_eq!(child.wait().unwrap().code(), Some(143));
}

#[test]
fn how_late_turns_are_is_told_on_sigusr1_and_at_the_end() {
    let mut child = start(&FAR);
    let mut lines = wait_until_it_moves(child.stderr.take().unwrap());
    let table = ["     up to      late      took", "      most"];
    for signal in ["USR1", "TERM"] {
        send(&child, signal);
        let head = lines.find(|line| !is_no_timing(line)).unwrap();
        assert!(head.contains(" of 20ms, "), "{head}");
        assert_eq!(lines.next().as_deref(), Some(table[0]));
        assert!(lines.any(|line| line.starts_with(table[1])));
    }
    assert_eq!(lines.next(), None);
    assert_eq!(child.wait().unwrap().code(), Some(143));
}

#[test]
fn many_signals_are_one() {
    let mut child = start(&FAR);
    let lines = wait_until_it_moves(child.stderr.take().unwrap());
    // The last may come when the robot stands already, and then ends the program at once: the status says nothing here.
    let all = format!("kill -TERM {0}; kill -TERM {0}; kill -TERM {0}", child.id());
    Command::new("sh").arg("-c").arg(all).status().unwrap();
    let rest: Vec<_> = lines.skip_while(|line| line == "cart: 0.5 m/s").collect();
    assert_eq!(rest[..2], ["cart: 0 m/s", "cart: stop"]);
    child.wait().unwrap();
}

#[cfg(target_os = "linux")]
#[test]
fn whoever_ignores_hangups_is_not_stopped_by_one() {
    let example = cart(&[]);
    let script = format!("trap '' HUP; exec {} {}", example.get_program().display(), FAR.join(" "));
    let mut child =
        Command::new("sh").args(["-c", &script]).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let mut lines = wait_until_it_moves(child.stderr.take().unwrap());
    send(&child, "HUP");
    assert!(lines.by_ref().take(3).all(|line| line == "cart: 0.5 m/s"));
    send(&child, "TERM");
    assert!(lines.any(|line| line == "stopped by SIGTERM"));
    assert_eq!(child.wait().unwrap().code(), Some(143));
}

#[test]
fn a_reader_that_does_not_read_holds_up_no_robot() {
    // On a track without length each turn makes as many transitions as it may, far more than a pipe holds.
    let mut child = start(&["--tell", "--period", "0.01", "--track", "0"]);
    let mut lines = lines(child.stderr.take().unwrap());
    assert_eq!(lines.by_ref().take(10).filter(|line| line == "cart: 0 m/s").count(), 10);
    send(&child, "TERM");
    assert!(lines.by_ref().any(|line| line == "cart: stop"));
    let mut report = String::new();
    child.stdout.take().unwrap().read_to_string(&mut report).unwrap();
    assert!(report.starts_with("0.000 s  atom 2 go -0.5  <- far (atom 1)\n"));
    assert_eq!(child.wait().unwrap().code(), Some(143));
}

#[test]
fn a_closed_pipe_disturbs_nothing() {
    for arguments in [&["--speed", "max"][..], &["--period", "0.01", "--track", "0", "--turns", "10"], &["--help"]] {
        let mut child = start(arguments);
        drop(child.stdout.take());
        let Output { status, stderr, .. } = child.wait_with_output().unwrap();
        let limit = "stopped by --turns: the plan was not over after 10 turns\n9 turns of 10ms, ";
        let told: String = text(&stderr).split_inclusive('\n').filter(|line| is_no_refusal(line)).collect();
        match status.code() {
            Some(0) => assert_eq!(told, ""),
            code => assert!(code == Some(4) && told.starts_with(limit), "{code:?} {told}"),
        }
    }
}

#[test]
fn a_panic_stops_the_cart() {
    let Output { status, stderr, .. } = cart(&["--tell", "--speed", "max", "--panic-at", "2"]).output().unwrap();
    assert_eq!(status.code(), Some(3));
    let told = text(&stderr);
    let told: Vec<_> = told.lines().filter(|line| line.starts_with("cart") || line.starts_with("error")).collect();
    assert_eq!(
        told,
        [
            "cart: 0 m/s",
            "cart: 0.5 m/s",
            "cart: 0.5 m/s",
            "cart: stop",
            "error: a fault stopped the robot: its code or the plan's panicked, which is a bug: the cart exploded",
        ]
    );
}

#[test]
fn a_program_has_the_statuses_that_scripts_rely_on() {
    let status = |arguments| cart(arguments).output().unwrap().status.code();
    assert_eq!(status(&["--speed", "max"]), Some(0));
    assert_eq!(status(&["--speed", "max", "--track", "-1"]), Some(2));
    assert_eq!(status(&["--speed", "max", "--track=2000"]), Some(2));
    assert_eq!(status(&["--speed", "max", "--fail-at", "3"]), Some(3));
    assert_eq!(status(&["--speed", "max", "--timeout", "20"]), Some(4));
}

#[test]
fn a_plan_says_what_it_does() {
    let Output { stdout, .. } = cart(&["--speed", "max"]).output().unwrap();
    let report = text(&stdout);
    assert!(report.starts_with("2.000 s  atom 2 go -0.5  <- far (atom 1)\n4.000 s  atom 1 go 0.5  <- near (atom 2)\n"));
    assert!(report.ends_with("\nplan over: wait 1000 (Shuttle)\n"), "{report}");
}
