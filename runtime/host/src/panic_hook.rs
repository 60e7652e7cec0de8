//! The panic hook, which reports where code panicked. It does not make the robot wait for the reader of the report.

use std::backtrace::{Backtrace, BacktraceStatus};
use std::panic::{self, PanicHookInfo};
use std::thread;

use crate::background_writer::Aside;
use crate::safety::text;

/// Sends reports of panics to `outlet` from now on.
pub(crate) fn tell_to(outlet: Aside) {
    panic::set_hook(Box::new(move |panic| outlet.tell(report(panic))));
}

/// Returns the text that the standard library's own panic hook would print.
fn report(panic: &PanicHookInfo<'_>) -> String {
    let current = thread::current();
    let thread = current.name().unwrap_or("<unnamed>");
    let place = panic.location().map(|place| format!(" at {place}")).unwrap_or_default();
    let mut report = format!("thread '{thread}' panicked{place}:\n{}\n", text(panic.payload()));
    let backtrace = Backtrace::capture();
    if backtrace.status() == BacktraceStatus::Captured {
        report += &format!("stack backtrace:\n{backtrace}");
    }
    report
}
