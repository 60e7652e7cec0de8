//! Functions that a page calls: it writes a request into the module's memory, and reads the answer from there.
//!
//! ```text
//! at = mdle_room(bytes of the request)    the page writes the request there
//! length = mdle_answer()                  the module answers
//! at = mdle_answer_at()                   the page reads `length` bytes there
//! ```
//!
//! A module that runs out of memory or has a bug stops with a trap; the page then creates a new module.
#![allow(unsafe_code, reason = "a page finds functions by names that are not mangled; nothing here is unsafe to call")]

use std::cell::RefCell;

use crate::PageSession;

/// The only session of a module, with its request and its answer.
#[derive(Default)]
struct OnlySession {
    session: PageSession,
    request: Vec<u8>,
    answer: String,
}

thread_local! {
    static EXCHANGE: RefCell<OnlySession> = RefCell::default();
}

/// Allocates memory for a request of this many bytes, and returns its address.
#[unsafe(no_mangle)]
pub extern "C" fn mdle_room(length: usize) -> usize {
    EXCHANGE.with_borrow_mut(|exchange| {
        exchange.request = vec![0; length];
        exchange.request.as_ptr() as usize
    })
}

/// Answers the request, and returns the length of the answer in bytes.
#[unsafe(no_mangle)]
pub extern "C" fn mdle_answer() -> usize {
    EXCHANGE.with_borrow_mut(|OnlySession { session, request, answer }| {
        // The previous answer may be large: it is freed before the next answer is created.
        *answer = String::new();
        *answer = session.answer(&std::mem::take(request));
        answer.len()
    })
}

/// Returns the address of the last answer.
#[unsafe(no_mangle)]
pub extern "C" fn mdle_answer_at() -> usize {
    EXCHANGE.with_borrow(|exchange| exchange.answer.as_ptr() as usize)
}
