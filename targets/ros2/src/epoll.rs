//! Functions of epoll(7), linked in place of those of the C library, that a suspension does not interrupt.
//!
//! After a suspension (SIGSTOP, Ctrl-Z, an attached debugger) Linux ends each `epoll_wait` with `EINTR`, see signal(7).
//! The threads of RustDDS take this for an error and end for good: the robot could then neither be heard nor stopped.
//! Here such a wait goes on until its time has passed.
//!
//! The C library musl has all of these functions in one object, so that all have to be replaced where one is.
#![allow(unsafe_code, reason = "the linker finds functions by names that are not mangled, and the system fills memory")]

use std::ffi::{c_int, c_long};
use std::io::{Error, ErrorKind};
use std::ptr;
use std::time::Instant;

use libc::{SYS_epoll_create1, SYS_epoll_ctl, SYS_epoll_pwait, epoll_event, sigset_t, syscall};

/// Number of bytes in the system's set of signals.
const SIGNALS: usize = 8;

/// Creates an instance of epoll.
#[unsafe(no_mangle)]
extern "C" fn epoll_create1(flags: c_int) -> c_int {
    // SAFETY: the call gets no pointer.
    narrow(unsafe { syscall(SYS_epoll_create1, flags) })
}

/// Adds, changes or removes the file descriptor `fd` of the instance `epoll`.
///
/// # Safety
/// `event` is null or points to an event.
#[unsafe(no_mangle)]
unsafe extern "C" fn epoll_ctl(epoll: c_int, operation: c_int, fd: c_int, event: *mut epoll_event) -> c_int {
    // SAFETY: what the caller promises is what the call needs.
    narrow(unsafe { syscall(SYS_epoll_ctl, epoll, operation, fd, event) })
}

/// Waits for events of the instance `epoll` for `timeout` milliseconds; for ever if `timeout` is negative.
///
/// # Safety
/// `events` points to space for `most` events.
#[unsafe(no_mangle)]
unsafe extern "C" fn epoll_wait(epoll: c_int, events: *mut epoll_event, most: c_int, timeout: c_int) -> c_int {
    let begun = Instant::now();
    let mut left = timeout;
    loop {
        let no_signals = ptr::null::<sigset_t>();
        // SAFETY: what the caller promises is what the call needs; without signals it reads no set.
        let found = unsafe { syscall(SYS_epoll_pwait, epoll, events, most, left, no_signals, SIGNALS) };
        if found >= 0 || Error::last_os_error().kind() != ErrorKind::Interrupted {
            return narrow(found);
        }
        if timeout > 0 {
            let passed = c_int::try_from(begun.elapsed().as_millis()).unwrap_or(c_int::MAX);
            left = timeout.saturating_sub(passed).max(0);
        }
    }
}

/// Returns the result of a call as the type of its function: a small number, or -1.
fn narrow(result: c_long) -> c_int {
    c_int::try_from(result).unwrap_or(-1)
}
