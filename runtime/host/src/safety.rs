//! Protects a run against panics in the code of the robot and of the plan. A panic becomes a value, so that the robot
//! can still be stopped.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Message of a panic.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Panicked(pub(crate) String);

/// Runs `code`. After a panic, the data that `code` uses may be inconsistent, so the robot may only be stopped.
///
/// # Errors
/// Fails if the code panicked. The panic hook has then reported the place on standard error.
pub(crate) fn shielded<T>(code: impl FnOnce() -> T) -> Result<T, Panicked> {
    catch_unwind(AssertUnwindSafe(code)).map_err(|payload| {
        let message = text(&*payload);
        // Dropping a payload may panic again. It is small, and the program is about to end, so it is never dropped.
        std::mem::forget(payload);
        Panicked(message)
    })
}

/// Returns the message of a panic.
pub(crate) fn text(payload: &dyn Any) -> String {
    match (payload.downcast_ref::<&str>(), payload.downcast_ref::<String>()) {
        (Some(message), _) => (*message).to_owned(),
        (None, Some(message)) => message.clone(),
        (None, None) => "no message".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_becomes_its_message() {
        assert_eq!(shielded(|| 7), Ok(7));
        assert_eq!(shielded(|| panic!("plain")), Err::<(), _>(Panicked("plain".to_owned())));
        assert_eq!(shielded(|| panic!("number {}", 7)), Err::<(), _>(Panicked("number 7".to_owned())));
        assert_eq!(shielded(|| std::panic::panic_any(7)), Err::<(), _>(Panicked("no message".to_owned())));
    }
}
