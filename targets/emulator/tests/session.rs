//! Tests that a line does not become the controlling terminal of a program that leads a session, as services do.
//! Otherwise the program would receive SIGHUP when the line is closed.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::env;
use std::fs;
use std::process::Command;

use mdle_emulator::Port;

/// Environment variable that is set when the test runs as the leader of a session.
const LEADS: &str = "MDLE_LEADS_A_SESSION";

#[test]
fn a_line_is_no_terminal_of_a_session() {
    if env::var_os(LEADS).is_none() {
        let arguments = env::args_os().skip(1);
        let mut leader = Command::new("setsid");
        let leader = leader.arg("--wait").arg(env::current_exe().unwrap()).args(arguments).env(LEADS, "1");
        let output = leader.output().unwrap();
        assert!(output.status.success(), "{output:?}");
        return;
    }
    let line = Port::open().unwrap();
    let stat = fs::read_to_string("/proc/self/stat").unwrap();
    // Fields after the name in parentheses: state, parent, group, session, and the number of the terminal.
    let terminal = stat.rsplit_once(')').unwrap().1.split_whitespace().nth(4).unwrap();
    assert_eq!(terminal, "0", "{}", line.path().display());
}
