//! Writes the page of the book that contains the tables of faults.

use std::fmt::Write;
use std::process::Output;

use mdle_emulator::MotionOrder;

use super::watched::Way;

/// Result of a fault or another event.
#[derive(Debug)]
pub(crate) struct Row {
    pub(crate) message: String,
    /// Exit status of the executable; `None` if it was killed.
    pub(crate) status: Option<i32>,
    pub(crate) way: Way,
    /// Last order that the robot received.
    pub(crate) order: Option<MotionOrder>,
}

impl Row {
    /// Returns the row for an executable with this output, after whose fault the body moved by `way`. `order` is the
    /// last order that the robot received.
    pub(crate) fn of(output: Output, way: Way, order: Option<MotionOrder>) -> Self {
        let [out, err] = [output.stdout, output.stderr].map(|bytes| String::from_utf8(bytes).unwrap());
        let message = match err.strip_prefix("error: ") {
            Some(error) => error.trim_end().to_owned(),
            None => {
                let last = out.lines().last().unwrap_or_default();
                // The printed time is omitted, because it counts from the start of the run and not from the fault.
                last.split_once(" s  ").map_or(last, |(_, end)| end).to_owned() + err.trim_end()
            }
        };
        // The number of the terminal is arbitrary.
        let message = message.split(' ').map(|word| if word.starts_with("/dev/pts/") { "/dev/pts/N:" } else { word });
        let message = message.collect::<Vec<_>>().join(" ");
        Self { message, status: output.status.code(), way, order }
    }
}

/// Returns the text of the page.
pub(crate) fn text(plan: &str, robots: &[(&str, Vec<(String, Row)>)]) -> String {
    let mut text = format!(
        "# Faults\n\n\
        After every fault the robot is stopped, or its own watchdog stops it; the program reports one sentence and ends with \
        exit status 3, within a second and a half of the last correct exchange. Some faults take longer to notice: an ATRV that \
        receives nothing but still sends leaves two questions about its brake unanswered, which takes two and a half seconds, and \
        a bumper that is no longer reported is noticed after a second. A robot that does not stop on command gets time to, at most \
        five seconds. The plan continues where it can, but never with stale data.\n\n\
        The tables are written by a test, `tests/clock/faults`: it runs the executable of this plan on the emulated robots.\n\n\
        ```mdle\n{plan}```\n\n\
        The robot drives at 20 cm/s when something goes wrong, 2 m before a wall. \"Moves on\" is the distance that its body \
        then moves in its world, and \"for\" the time from the last correct answer until it has stopped. \"Last command\" is the \
        last motion command that reached the robot. A plan that continues ends as usual.\n\n\
        The emulators are in lockstep, so that the figures are the same each time: a command lets 100 ms pass. While no \
        answer comes, the robot drives on for as long as a driver waits by its configuration, 300 ms. Once the program has \
        ended, it drives on until it stops itself: a Scout by its watchdog, which was set to a second; an ATRV by that of \
        its controller, of which nobody knows how long it takes, and the emulator's takes a second too. By the clock a \
        fault may come a turn later, so that 0.1 s and 2 cm are to be added; the test holds the executables to that as well. \
        At another speed the way is another.\n"
    );
    for (robot, rows) in robots {
        write!(
            text,
            "\n## {robot}\n\n| what happens | what the program reports | status | last command | moves on | for |\n"
        )
        .unwrap();
        writeln!(text, "|---|---|---|---|---|---|").unwrap();
        for (what, Row { message, status, way, order }) in rows {
            let message = if message.is_empty() { "nothing" } else { message };
            let status = status.map_or("killed".to_owned(), |status| status.to_string());
            let order = match order {
                None => "nothing",
                Some(MotionOrder::Drive) => "to drive",
                Some(MotionOrder::Stand) => "to stand",
                Some(MotionOrder::LetGo) => "to let go",
                Some(MotionOrder::Brake) => "to brake",
            };
            let (centimetres, seconds) = ((way.metres * 100.0).round(), way.time.as_secs_f64());
            writeln!(text, "| {what} | {message} | {status} | {order} | {centimetres} cm | {seconds:.1} s |").unwrap();
        }
    }
    text
}
