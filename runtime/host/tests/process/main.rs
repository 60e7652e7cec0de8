//! Tests the example `cart` as a program: real signals, closed and blocked pipes, exit statuses, panics.
#![allow(clippy::unwrap_used, clippy::panic, reason = "what fails here is the test")]

mod cart;
mod signals;
mod writers;

use std::process::Output;

use cart::{FAR, cart, is_no_refusal, is_no_timing, send, start, text, wait_until_it_moves};

#[test]
fn lateness_is_printed_on_sigusr1_and_at_the_end() {
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
fn a_closed_pipe_disturbs_nothing() {
    for arguments in [&["--speed", "max"][..], &["--period", "0.01", "--track", "0", "--turns", "10"], &["--help"]] {
        let mut child = start(arguments);
        drop(child.stdout.take());
        let Output { status, stderr, .. } = child.wait_with_output().unwrap();
        let limit = "stopped by --turns: the plan was not over after 10 turns\n9 turns of 10ms, ";
        let listed: String = text(&stderr).split_inclusive('\n').filter(|line| is_no_refusal(line)).collect();
        match status.code() {
            Some(0) => assert_eq!(listed, ""),
            code => assert!(code == Some(4) && listed.starts_with(limit), "{code:?} {listed}"),
        }
    }
}

#[test]
fn a_panic_stops_the_cart() {
    let Output { status, stderr, .. } = cart(&["--tell", "--speed", "max", "--panic-at", "2"]).output().unwrap();
    assert_eq!(status.code(), Some(3));
    let listed = text(&stderr);
    let listed: Vec<_> = listed.lines().filter(|line| line.starts_with("cart") || line.starts_with("error")).collect();
    assert_eq!(
        listed,
        [
            "cart: 0 m/s",
            "cart: 0.5 m/s",
            "cart: 0.5 m/s",
            "cart: stop",
            "error: a fault stopped the robot: its code or the plan's panicked, which is a bug: the cart exploded",
        ]
    );
}

/// Each of these tests takes ten seconds, so they run in parallel.
#[test]
fn a_program_that_hangs_ends() {
    std::thread::scope(|scope| {
        scope.spawn(a_law_that_never_returns_ends_the_program);
        scope.spawn(signals::the_second_signal_ends_a_cart_that_hangs);
    });
}

fn a_law_that_never_returns_ends_the_program() {
    let listed = |arguments: &[&str]| {
        let Output { status, stderr, .. } = cart(arguments).output().unwrap();
        let listed: Vec<_> = text(&stderr).lines().filter(|line| is_no_refusal(line)).map(str::to_owned).collect();
        (status.code(), listed.join("\n"))
    };
    let (stepped, real) = std::thread::scope(|scope| {
        let stepped = scope.spawn(|| listed(&["--tell", "--speed", "max", "--hang-law-at", "1"]));
        let real = listed(&["--tell", "--period", "0.02", "--hang-law-at", "1"]);
        (stepped.join().unwrap(), real)
    });
    let hangs = "turn 1 has not ended after 10 s: code of the plan or of a module never returns";
    let told = "cart: 0 m/s\ncart: 0.5 m/s\nerror: a fault";
    assert_eq!(stepped, (Some(3), format!("{told} stopped the robot: {hangs}")));
    assert_eq!(real, (Some(3), format!("{told} ended the plan, and the robot may not have stopped: {hangs}")));
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
    assert!(report.starts_with("2.0 s  go -0.5 (pass 1)  <- far\n4.0 s  go 0.5 (pass 2)  <- near\n"));
    assert!(report.ends_with(" s  plan over: wait 1000 (Shuttle)\n"), "{report}");
}

#[test]
fn two_outputs_in_one_file_are_refused_before_anything_is_written() {
    let path = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join("one_file");
    let _ = std::fs::remove_file(&path);
    let other = path.with_file_name("../tmp/one_file");
    let output = cart(&["--speed", "max", "--log"]).arg(&path).arg("--record-path").arg(other).output().unwrap();
    assert_eq!((output.status.code(), path.exists()), (Some(2), false));
    let errors = text(&output.stderr);
    assert!(errors.ends_with("/tmp/one_file: --log writes the same file; name another one\n"), "{errors}");
}
