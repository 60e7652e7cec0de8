//! Tests with readers that are slow, have closed the stream, or read nothing.

use std::io::{Read, pipe};

use super::*;
use crate::stop_request::StopRequest;

/// Returns the patience of a run in which a robot is driven.
fn driving() -> Patience {
    let patience = Patience::new(StopRequest::default());
    patience.robot_drives();
    patience
}

/// Returns a piece of text of 10 KB.
fn piece(number: usize) -> Vec<u8> {
    format!("{number:9999}\n").into_bytes()
}

#[test]
fn a_slow_reader_loses_lines_and_the_robot_does_not_wait() {
    let (mut reader, writer) = pipe().unwrap();
    let patience = driving();
    let mut outlet = Outlet::open(writer, Keeps::WhatIsRead, &patience).unwrap();
    let pieces = 2 * WAITING / piece(0).len();
    for number in 0..pieces {
        outlet.write_all(&piece(number)).unwrap();
        outlet.flush().unwrap();
    }
    assert!(outlet.shared.queue().lost);
    patience.stop_was_tried(None);
    let reading = std::thread::spawn(move || {
        let mut text = String::new();
        reader.read_to_string(&mut text).map(|_| text)
    });
    outlet.write_all(b"at last\n").unwrap();
    drop(outlet);
    let text = reading.join().unwrap().unwrap();
    let lines: Vec<&str> = text.lines().map(str::trim_start).collect();
    assert_eq!(lines[..2], ["0", "1"]);
    assert_eq!(lines[lines.len() - 2..], ["(lines are missing here: they were not read in time)", "at last"]);
    assert!(text.len() < WAITING + 100_000);
}

#[test]
fn text_is_written_although_nobody_flushes_it() {
    let (mut reader, writer) = pipe().unwrap();
    let mut outlet = Outlet::open(writer, Keeps::All, &driving()).unwrap();
    outlet.write_all(b"a turn\n").unwrap();
    let mut text = [0; 7];
    reader.read_exact(&mut text).unwrap();
    assert_eq!(&text, b"a turn\n");
}

#[test]
fn a_record_that_nobody_takes_is_an_error_and_lacks_nothing_before() {
    let (mut reader, writer) = pipe().unwrap();
    let mut outlet = Outlet::open(writer, Keeps::All, &driving()).unwrap();
    let mut pieces = 0;
    let error = loop {
        outlet.write_all(&piece(pieces)).unwrap();
        match outlet.flush() {
            Ok(()) => pieces += 1,
            Err(error) => break error,
        }
    };
    assert_eq!(error.kind(), io::ErrorKind::TimedOut);
    let mut text = vec![0; pieces * piece(0).len()];
    reader.read_exact(&mut text).unwrap();
    assert_eq!(text, (0..pieces).flat_map(piece).collect::<Vec<u8>>());
}

#[test]
fn a_reader_that_takes_nothing_is_given_up_after_the_stop() {
    let (_reader, writer) = pipe().unwrap();
    let patience = driving();
    patience.stop_was_tried(None);
    let mut outlet = Outlet::open(writer, Keeps::WhatIsRead, &patience).unwrap();
    outlet.write_all(&vec![b'x'; 100_000]).unwrap();
    let begun = Instant::now();
    assert_eq!(outlet.flush().unwrap_err().to_string(), "it was not read for 2 s");
    assert!(begun.elapsed() >= AT_THE_END);
    // The outlet has already waited for its maximum time, and does not wait again.
    outlet.write_all(b"more").unwrap();
    assert_eq!(outlet.flush().unwrap_err().kind(), io::ErrorKind::TimedOut);
    drop(outlet);
    assert!(begun.elapsed() < 2 * AT_THE_END);
}

#[test]
fn where_nothing_drives_all_is_written_at_once() {
    let (mut reader, writer) = pipe().unwrap();
    let mut outlet = Outlet::open(writer, Keeps::WhatIsRead, &Patience::new(StopRequest::default())).unwrap();
    write!(outlet, "plan over: ").unwrap();
    writeln!(outlet, "bumper (Lab)").unwrap();
    outlet.flush().unwrap();
    let mut text = [0; 24];
    reader.read_exact(&mut text).unwrap();
    assert_eq!(&text, b"plan over: bumper (Lab)\n");
}

#[test]
fn a_reader_that_has_gone_is_found_out() {
    let (reader, writer) = pipe().unwrap();
    let mut outlet = Outlet::open(writer, Keeps::WhatIsRead, &Patience::new(StopRequest::default())).unwrap();
    drop(reader);
    outlet.write_all(b"line\n").unwrap();
    assert_eq!([0; 2].map(|_| outlet.flush().unwrap_err().kind()), [io::ErrorKind::BrokenPipe; 2]);
}
