//! Tests signals: each signal ends the run, and a second signal ends a program that hangs.

use std::process::{Child, Command, Stdio};
use std::sync::{Arc, Mutex};
use std::thread;
use std::time::{Duration, Instant};

use nix::sys::signal::{SigSet, SigmaskHow};

use crate::cart::{FAR, cart, is_no_timing, lines, send, start, wait_until_it_moves};

/// The signals that end a program by default and can be caught, without SIGUSR1, SIGPIPE and SIGXFSZ, and two real-time
/// signals.
const ENDING: [(u8, &str); 18] = [
    (1, "SIGHUP"),
    (2, "SIGINT"),
    (3, "SIGQUIT"),
    (5, "SIGTRAP"),
    (6, "SIGABRT"),
    (7, "SIGBUS"),
    (12, "SIGUSR2"),
    (14, "SIGALRM"),
    (15, "SIGTERM"),
    (16, "SIGSTKFLT"),
    (24, "SIGXCPU"),
    (26, "SIGVTALRM"),
    (27, "SIGPROF"),
    (29, "SIGIO"),
    (30, "SIGPWR"),
    (31, "SIGSYS"),
    (36, "SIGRTMIN+2"),
    (64, "SIGRTMIN+30"),
];

#[test]
fn a_signal_stops_the_cart_and_names_the_status() {
    for (number, name) in ENDING {
        let mut child = start(&FAR);
        let lines = wait_until_it_moves(child.stderr.take().unwrap());
        send(&child, &number.to_string());
        let rest: Vec<_> =
            lines.skip_while(|line| line == "cart: 0.5 m/s").take_while(|line| is_no_timing(line)).collect();
        assert_eq!(rest, ["cart: 0 m/s".to_owned(), "cart: stop".to_owned(), format!("stopped by {name}")]);
        assert_eq!(child.wait().unwrap().code(), Some(128 + i32::from(number)));
    }
}

#[test]
fn other_signals_end_no_run() {
    let mut child = start(&FAR);
    let mut lines = wait_until_it_moves(child.stderr.take().unwrap());
    for signal in ["PIPE", "XFSZ", "CHLD", "URG", "WINCH", "CONT"] {
        send(&child, signal);
        assert!(lines.by_ref().take(3).all(|line| line == "cart: 0.5 m/s"), "{signal}");
    }
    send(&child, "TERM");
    assert_eq!(child.wait().unwrap().code(), Some(143));
}

#[test]
fn a_signal_ends_a_start() {
    let mut child = start(&["--tell", "--start", "600000"]);
    let mut lines = lines(child.stderr.take().unwrap());
    assert_eq!(lines.next().as_deref(), Some("cart: start"));
    send(&child, "INT");
    assert_eq!(lines.collect::<Vec<_>>(), ["cart: stop", "stopped by SIGINT"]);
    assert_eq!(child.wait().unwrap().code(), Some(130));
}

pub(crate) fn the_second_signal_ends_a_cart_that_hangs() {
    let mut child = start(&["--tell", "--period", "0.02", "--hang-at", "3"]);
    let mut lines = wait_until_it_moves(child.stderr.take().unwrap());
    assert!(lines.by_ref().take(2).all(|line| line == "cart: 0.5 m/s"));
    send(&child, "TERM");
    thread::sleep(Duration::from_millis(500));
    assert_eq!(child.try_wait().unwrap(), None, "one signal waits for the stop");
    let begun = Instant::now();
    send(&child, "INT");
    assert_eq!(child.wait().unwrap().code(), Some(130));
    assert!(begun.elapsed() >= Duration::from_secs(10), "the stop is waited for");
    assert_eq!(lines.next(), None);
}

#[test]
fn a_cart_that_was_suspended_is_not_driven_on() {
    let mut child = start(&FAR);
    let (mut before, seen) = (0, Arc::new(Mutex::new(Vec::new())));
    let lines = wait_until_it_moves(child.stderr.take().unwrap());
    let reading = {
        let seen = Arc::clone(&seen);
        thread::spawn(move || lines.for_each(|line| seen.lock().unwrap().push(line)))
    };
    send(&child, "STOP");
    thread::sleep(Duration::from_millis(2500));
    before += seen.lock().unwrap().len();
    send(&child, "CONT");
    assert_eq!(child.wait().unwrap().code(), Some(3));
    reading.join().unwrap();
    let seen = seen.lock().unwrap();
    // The signal may have arrived just before a command was sent.
    let after: Vec<_> = seen[before..].iter().skip_while(|line| *line == "cart: 0.5 m/s").collect();
    assert!(seen.len() - before - after.len() <= 1, "{seen:?}");
    assert_eq!(after[0], "cart: stop");
    assert!(after[1].starts_with("error: a fault stopped the robot: it had no command for 2."), "{after:?}");
}

/// Starts a shell that executes `line`, in which `$@` is the command of the cart with the options [`FAR`].
fn in_a_shell(line: &str) -> Child {
    let mut command = Command::new("sh");
    command.args(["-c", line, "sh"]).arg(cart(&[]).get_program()).args(FAR);
    command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
}

#[test]
fn ctrl_c_stops_a_job_in_the_background_of_a_script() {
    for signal in ["INT", "QUIT", "TERM"] {
        let mut child = in_a_shell("trap '' INT QUIT TERM; exec \"$@\"");
        let mut lines = wait_until_it_moves(child.stderr.take().unwrap());
        send(&child, signal);
        assert!(lines.any(|line| line == format!("stopped by SIG{signal}")));
        child.wait().unwrap();
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
fn many_signals_are_one() {
    let mut child = start(&FAR);
    let lines = wait_until_it_moves(child.stderr.take().unwrap());
    let all = format!("kill -TERM {0}; kill -TERM {0}; kill -TERM {0}", child.id());
    Command::new("sh").arg("-c").arg(all).status().unwrap();
    let rest: Vec<_> = lines.skip_while(|line| line == "cart: 0.5 m/s").collect();
    assert_eq!(rest[..3], ["cart: 0 m/s", "cart: stop", "stopped by SIGTERM"]);
    assert_eq!(child.wait().unwrap().code(), Some(143));
}

#[test]
fn a_signal_that_was_ignored_before_stays_ignored() {
    let mut child = in_a_shell("trap '' HUP USR2; exec \"$@\"");
    let mut lines = wait_until_it_moves(child.stderr.take().unwrap());
    for signal in ["HUP", "USR2"] {
        send(&child, signal);
        assert!(lines.by_ref().take(3).all(|line| line == "cart: 0.5 m/s"));
    }
    send(&child, "TERM");
    assert!(lines.any(|line| line == "stopped by SIGTERM"));
    assert_eq!(child.wait().unwrap().code(), Some(143));
}

#[test]
fn a_signal_that_was_blocked_before_ends_the_run() {
    for (number, name) in ENDING {
        // A program inherits the signal mask of the thread that starts it.
        let start = || {
            let mask = SigSet::all().thread_swap_mask(SigmaskHow::SIG_BLOCK).unwrap();
            let child = start(&FAR);
            mask.thread_set_mask().unwrap();
            child
        };
        let mut child = start();
        let mut lines = wait_until_it_moves(child.stderr.take().unwrap());
        send(&child, &number.to_string());
        assert!(lines.any(|line| line == format!("stopped by {name}")), "{name}");
        assert_eq!(child.wait().unwrap().code(), Some(128 + i32::from(number)));
    }
}
