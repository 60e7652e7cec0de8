//! A crowd: many robots in one world that run the same plan, each with its own state (docs/src/many_robots.md).

mod alphabet;
mod member;
mod places;
mod recorded;
mod setup;
mod table;
mod turns;

use std::io::{self, IsTerminal as _, Write as _};
use std::process::ExitCode;
use std::time::Instant;

use mdle_host::{Interruption, ProgressLine};
use mdle_runtime::Nanos;

use super::FAULT;
use super::arguments::ScenarioOptions;
use super::fleet::TIMED_OUT;
use crate::failure::Failure;
pub(super) use setup::CrowdSetup;
use table::Trail;
use turns::Turns;

/// Runs a crowd and prints a report; returns the exit status.
///
/// # Errors
/// Fails if signals cannot be caught, or if a file cannot be written.
pub(super) fn run(setup: CrowdSetup, options: &ScenarioOptions) -> Result<ExitCode, Failure> {
    let mut trail = options.trail.as_deref().map(Trail::create).transpose().map_err(Failure::Usage)?;
    let uncaught = |error| Failure::Usage(format!("signals cannot be caught: {error}"));
    let interruption = Interruption::listen().map_err(uncaught)?;
    let (period, timeout) = (setup.period, setup.timeout);
    let records = options.log.as_deref().map(|log| setup.records(log, &options.command)).transpose();
    let mut turns = Turns::new(setup, records.map_err(Failure::Usage)?.unwrap_or_default());
    let begun = Instant::now();
    let last = {
        let mut err = io::stderr();
        let is_shown = err.is_terminal();
        let mut progress = is_shown.then(|| ProgressLine::new(&mut err, Box::new(move || begun.elapsed())));
        let mut t = Nanos::ZERO;
        loop {
            turns.turn(t);
            if let Some(trail) = &mut trail {
                trail.turn(&mut turns, t);
            }
            let is_unwritten = trail.as_ref().is_some_and(Trail::has_failed) || turns.fault().is_some();
            if turns.are_over() || t >= timeout || is_unwritten || interruption.is_made() {
                break t;
            }
            if let Some(progress) = &mut progress {
                progress.simulated(t, timeout);
            }
            t = Nanos(t.0.saturating_add(period.0));
        }
    };
    turns.stop(last);
    let mut status = if turns.are_over() { 0 } else { TIMED_OUT };
    let _ = writeln!(io::stdout(), "{}", turns.summary(last));
    let seconds = begun.elapsed().as_secs_f64();
    let times = last.seconds() / seconds.max(f64::MIN_POSITIVE);
    let threads = match turns.threads() {
        1 => "a thread".to_owned(),
        threads => format!("{threads} threads"),
    };
    let _ = writeln!(
        io::stderr(),
        "{:.1} s in {seconds:.1} s, {times:.2} times as fast as real, with {threads}",
        last.seconds()
    );
    status = interruption.tell(&mut io::stderr()).unwrap_or(status);
    for sentence in trail.and_then(|trail| trail.close().err()).into_iter().chain(turns.fault()) {
        let _ = writeln!(io::stderr(), "error: {sentence}");
        status = FAULT;
    }
    Ok(ExitCode::from(status))
}
