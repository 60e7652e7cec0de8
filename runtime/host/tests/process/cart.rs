//! The example `cart` as a program that a test starts, reads and sends signals to.

use std::io::{BufRead, BufReader};
use std::process::{Child, ChildStderr, Command, Stdio};
use std::sync::{Arc, Once};

/// Catches SIGHUP, so that the programs that this program starts have the signal's default effect: under `nohup`, they
/// would ignore the signal.
fn catch_hang_up() {
    static CAUGHT: Once = Once::new();
    CAUGHT.call_once(|| {
        signal_hook::flag::register(signal_hook::consts::SIGHUP, Arc::default()).unwrap();
    });
}

/// Returns the command of the example, which `cargo test` builds before it runs this test.
pub(crate) fn cart(arguments: &[&str]) -> Command {
    catch_hang_up();
    let mut path = std::env::current_exe().unwrap();
    path.pop();
    path.pop();
    path.extend(["examples", &format!("cart{}", std::env::consts::EXE_SUFFIX)]);
    assert!(path.exists(), "build it with `cargo build -p mdle-host --example cart`");
    let mut command = Command::new(path);
    command.args(arguments).env("RUST_BACKTRACE", "0").stdin(Stdio::null());
    command
}

/// Starts the cart with pipes for standard output and standard error.
pub(crate) fn start(arguments: &[&str]) -> Child {
    cart(arguments).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
}

/// Options with which the cart reports its commands, and drives on for longer than any test takes.
pub(crate) const FAR: [&str; 5] = ["--tell", "--period", "0.02", "--track", "1000"];

/// Returns `true` unless the line reports a permission that this computer lacks, which comes before anything else.
pub(crate) fn is_no_refusal(line: &str) -> bool {
    !line.starts_with("warning: turns may be late")
}

/// Returns the lines on standard error, without the warning about a missing permission.
pub(crate) fn lines(stderr: ChildStderr) -> impl Iterator<Item = String> {
    BufReader::new(stderr).lines().map(Result::unwrap).filter(|line| is_no_refusal(line))
}

/// Reads the cart's reports until it is commanded to move.
pub(crate) fn wait_until_it_moves(stderr: ChildStderr) -> impl Iterator<Item = String> {
    let mut lines = lines(stderr);
    assert!(lines.any(|line| line == "cart: 0.5 m/s"));
    lines
}

/// Sends a signal, by its name.
pub(crate) fn send(child: &Child, signal: &str) {
    let sent = Command::new("sh").arg("-c").arg(format!("kill -{signal} {}", child.id())).status().unwrap();
    assert!(sent.success());
}

/// Returns `true` unless the line begins the report of the lateness of turns.
pub(crate) fn is_no_timing(line: &str) -> bool {
    !line.contains(" turns of ") && !line.contains(" turn of ")
}

pub(crate) fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}
