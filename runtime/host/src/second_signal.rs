//! Lets a second signal end a program that hangs. The program ends after the attempt to stop the robot, or after ten
//! seconds if there is no such attempt.

use std::io;
use std::thread::{self, Builder};
use std::time::{Duration, Instant};

use signal_hook::iterator::Signals as Incoming;
use signal_hook::low_level;

use crate::background_writer::STACK;
use crate::patience::Stopped;
use crate::run_end;
use crate::signals::Signals;
use crate::watch::leave_screen;

/// Time for which the program continues after the attempt to stop the robot, if a second signal has arrived.
const AFTER_THE_STOP: Duration = Duration::from_secs(1);
/// Time for which the program continues after a second signal if the robot's code hangs and the robot is therefore not
/// stopped.
const WITHOUT_A_STOP: Duration = Duration::from_secs(10);
/// Interval at which the thread checks whether the attempt to stop the robot has ended.
const LOOK: Duration = Duration::from_millis(10);

/// Lets a second signal end the program, with the exit status that is known at that time. Restores the terminal.
///
/// # Errors
/// Fails if the system does not permit catching a signal, or cannot create a thread.
pub(crate) fn watch(signals: &Signals) -> io::Result<()> {
    let mut incoming = Incoming::new(signals.noted().iter().map(|signal| i32::from(signal.number())))?;
    let signals = signals.share();
    let thread = Builder::new().name("signals".to_owned()).stack_size(STACK);
    thread.spawn(move || {
        if incoming.forever().filter(|_| !signals.are_deadly()).nth(1).is_some() {
            end(&signals);
        }
    })?;
    Ok(())
}

/// Ends the program some time after the attempt to stop the robot, or when there has been no such attempt for too long.
fn end(signals: &Signals) {
    let begun = Instant::now();
    let known = loop {
        match signals.patience().stopped() {
            Some(Stopped { at, status }) if at.elapsed() >= AFTER_THE_STOP => break status,
            None if begun.elapsed() >= WITHOUT_A_STOP => break None,
            Some(_) | None => thread::sleep(LOOK),
        }
    };
    let of_the_signal = || signals.caught().map_or(run_end::FAULT, |signal| 128_u8.saturating_add(signal.number()));
    let status = known.unwrap_or_else(of_the_signal);
    leave_screen();
    // Skips the exit handlers of the libraries: they write the remaining output, and would wait for a reader that has
    // stalled.
    low_level::exit(status.into());
}
