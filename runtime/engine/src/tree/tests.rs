//! Tests which state of the run a front end reads.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::thread;
use std::time::{Duration, Instant};

use mdle_runtime::Nanos;

use super::{Answer, Change, Desk, Node, Operation, Reply, Request, Role, Served, Value, ValueKind};

/// A part with the number of the break.
struct Number;

impl Served<i64> for Number {
    fn nodes(&self, _: &i64) -> Vec<(String, Node)> {
        vec![("/number".to_owned(), Node::reading(ValueKind::Integer, "number of the break"))]
    }

    fn values(&self, number: &i64, to: &mut Vec<Option<Value>>) {
        to.push(Some(Value::Integer(*number)));
    }

    fn change(&mut self, _: &str, _: &Change, _: &mut i64, reply: Reply) {
        reply.answer(Answer::Done(String::new()));
    }
}

#[test]
fn a_reading_between_two_breaks_waits_for_none() {
    let (hub, mut desk) = Desk::with_hub();
    let get = || {
        let request = Request { path: "/number".to_owned(), operation: Operation::Get, role: Role::View };
        hub.ask(request)
    };
    let value = |number: i64| Answer::Value(number.to_string());
    // Takes a snapshot although nobody waits for one.
    desk.close(&[&mut Number], &1, Nanos::ZERO);
    // A front end that waits for a break in vain gives up after two seconds.
    let begun = Instant::now();
    (0..10).for_each(|_| assert_eq!(get(), value(1)));
    assert!(begun.elapsed() < Duration::from_secs(2), "{:?}", begun.elapsed());
    desk.begin_break();
    thread::scope(|scope| {
        let waits = scope.spawn(get);
        thread::sleep(Duration::from_millis(50));
        assert!(!waits.is_finished(), "the break may change what is read");
        desk.publish(&[&mut Number], &2, Nanos::ZERO);
        assert_eq!(waits.join().unwrap(), value(2));
    });
}
