//! Replaces the epoll(7) functions of the C library with functions that continue to wait after the program was
//! suspended.
//!
//! After a suspension (SIGSTOP, Ctrl-Z, an attached debugger) Linux ends each `epoll_wait` with `EINTR`, see signal(7).
//! The threads of RustDDS treat this as an error and end permanently: the driver could then neither receive data from
//! the robot nor stop it. The replacements resume the wait until its timeout.
//!
//! The C library musl defines all of these functions in one object file, so replacing one requires replacing all.
#![allow(unsafe_code, reason = "the linker finds functions by names that are not mangled, and the system fills memory")]

use std::ffi::{c_int, c_long};
use std::io::{Error, ErrorKind};
use std::ptr;
use std::time::Instant;

use libc::{SYS_epoll_create1, SYS_epoll_ctl, SYS_epoll_pwait, epoll_event, sigset_t, syscall};

/// Size of the system's signal set, in bytes.
const SIGNALS: usize = 8;

/// Creates an epoll instance.
#[unsafe(no_mangle)]
extern "C" fn epoll_create1(flags: c_int) -> c_int {
    // SAFETY: the call gets no pointer.
    narrow(unsafe { syscall(SYS_epoll_create1, flags) })
}

/// Adds, changes or removes the file descriptor `fd` of the epoll instance `epoll`.
///
/// # Safety
/// `event` is null or points to an event.
#[unsafe(no_mangle)]
unsafe extern "C" fn epoll_ctl(epoll: c_int, operation: c_int, fd: c_int, event: *mut epoll_event) -> c_int {
    // SAFETY: the caller guarantees that `event` is null or points to an event.
    narrow(unsafe { syscall(SYS_epoll_ctl, epoll, operation, fd, event) })
}

/// Waits for events of the epoll instance `epoll` for at most `timeout` milliseconds. A negative `timeout` means no
/// limit.
///
/// # Safety
/// `events` points to space for `most` events.
#[unsafe(no_mangle)]
unsafe extern "C" fn epoll_wait(epoll: c_int, events: *mut epoll_event, most: c_int, timeout: c_int) -> c_int {
    let begun = Instant::now();
    let mut left = timeout;
    loop {
        let no_signals = ptr::null::<sigset_t>();
        // SAFETY: the caller guarantees the space for `most` events; with a null signal set, the call reads no signals.
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

/// Converts the result of a system call, which is a small number or -1, to the function's return type.
fn narrow(result: c_long) -> c_int {
    c_int::try_from(result).unwrap_or(-1)
}
