//! A turn of the driver allocates nothing.

use mdle_emulator::memory_asked_for;

#[path = "../../../emulator/tests/counting/mod.rs"]
mod counting;
mod robot;

#[test]
fn a_turn_allocates_nothing() {
    assert_eq!(memory_asked_for::<robot::Robot>(counting::asked), Ok(0));
}
