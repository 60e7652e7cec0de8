//! Tests the error messages for files without a valid path, and the round trip of recorded paths.

use std::fmt::Write as _;

use mdle_runtime::{MetersPerSecond, Nanos, Radians, RadiansPerSecond, Setpoint, Twist};

use super::record::PathRecording;
use super::text::{TextFault, setpoints, utf8};

const FASTEST: Twist = Twist { v: MetersPerSecond(1.0), omega: RadiansPerSecond(6.0) };
const HEADER: &str = "time s, heading deg, speed cm/s";

fn read(text: &str) -> Result<Vec<Setpoint>, TextFault> {
    setpoints(text, FASTEST)
}

#[test]
fn all_units_comments_and_line_ends_are_read() {
    let same = [
        "time s, heading deg, speed cm/s\n0, 0, 20\n0.5, 90, -10\n",
        "# hall\r\n\r\ntime s,heading deg,speed cm/s # the paper's units\r\n0,0,20\r\n  # half way\r\n.5,+450,-1e1 # round\r\n",
        "\u{feff}  time   ms ,heading rad, speed m/s\n0,0,.2\n500, 1.5707963267948966, -0.1",
    ];
    for text in same {
        let read = read(text).unwrap();
        let report = read.iter().map(|Setpoint { at, heading, speed }| (at.0, heading.degrees().round(), speed.0));
        assert_eq!(report.collect::<Vec<_>>(), [(0, 0.0, 0.2), (500_000_000, 90.0, -0.1)], "{text}");
    }
}

#[test]
fn errors_have_their_line_and_column() {
    let rows = |rows: &str| format!("{HEADER}\n0, 0, 20\n0.1, 0, 20\n{rows}");
    let report = |texts: &[String]| {
        let mut report = String::new();
        for text in texts {
            let TextFault { place, what } = read(text).unwrap_err();
            let wrong = text.lines().nth(place.map_or(0, |(line, _)| line - 1)).unwrap_or_default();
            writeln!(report, "{wrong}\n  {place:?} {what}").unwrap();
        }
        report
    };
    let headers = [
        "",
        "# nothing but this\n\n",
        "0, 0, 20\n0.1, 0, 20",
        "t s, heading deg, speed cm/s",
        "time, heading deg, speed cm/s",
        "time s, heading deg",
        "time s, heading deg, speed cm/s, x m",
        "time s, speed cm/s, heading deg",
        "time s, heading grad, speed km / h",
        "time s; heading deg; speed cm/s",
        "time s, heading deg, speed cm/s",
        "time s, heading deg, speed cm/s\n0, 0, 20",
    ];
    insta::assert_snapshot!("headers", report(&headers.map(str::to_owned)));
    let bad = [
        "0.2, 0",
        "0.2, , 20",
        "0.2, 0,",
        "0.2, 0, 20, 5",
        "0.2; 0; 20",
        "0.2, 0, fast",
        "0.2, NaN, 20",
        "0.2,   inf, 20",
        "0.2, 0, 1e999",
        "-0.2, 0, 20",
        "-1e-300, 0, 20",
        "0.1, 0, 20",
        "0.1000000001, 0, 20",
        "0.05, 0, 20",
        "1.2, 0, 20",
        "1e99, 0, 20",
        "0.2, 0, 106",
        "0.2, 0, -106",
        "0.2, 90, 20",
        "0.2, -179.5, 20",
    ];
    insta::assert_snapshot!("rows", report(&bad.map(rows)));
    let first = ["0.1, 0, 20", "-0.1, 0, 20", "0, 0, 200"].map(|row| format!("{HEADER}\n{row}"));
    insta::assert_snapshot!("first_rows", report(&first));
}

#[test]
fn limits_are_met_exactly() {
    for row in ["1.1, 0, 20", "0.2, 0, 105", "0.2, 36, 20", "0.100000001, 0, 20"] {
        assert!(read(&format!("{HEADER}\n0, 0, 20\n0.1, 0, 20\n{row}")).is_ok(), "{row}");
    }
    assert!(read(&format!("{HEADER}\n0, 0, 20\n0.1, 0, 20\n1.100000001, 0, 20")).is_err());
}

#[test]
fn invalid_utf8_has_its_place() {
    let place = |bytes: &[u8]| utf8(bytes).unwrap_err().place;
    assert_eq!(place(b"\xff"), Some((1, 1)));
    assert_eq!(place(b"time s\n# \xc3\xa4\xc3\xb6\xc3"), Some((2, 5)));
    assert_eq!(place(b"time s\n\xc3\n"), Some((2, 1)));
}

/// Returns a pseudorandom number between 0 and 1; the numbers are the same in every run.
fn chance(state: &mut u64) -> f64 {
    *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*state >> 11) as f64 / (1_u64 << 53) as f64
}

/// Returns a random drive: times, headings and speeds.
fn drive(state: &mut u64) -> Vec<(Nanos, Radians, MetersPerSecond)> {
    let (mut t, mut heading) = (0, chance(state) * 6.0);
    let turns = 2 + (chance(state) * 50.0) as usize;
    (0..turns)
        .map(|_| {
            let turn = (t, heading, chance(state) * 2.0 - 1.0);
            let step = 1_000_000 + (chance(state) * 0.999e9) as u64;
            t += step;
            heading += (chance(state) * 2.0 - 1.0) * 6.0 * (step as f64 / 1e9);
            (Nanos(turn.0), Radians(turn.1), MetersPerSecond(turn.2))
        })
        .collect()
}

/// Returns the recording of a drive.
fn recorded(drive: &[(Nanos, Radians, MetersPerSecond)]) -> String {
    let mut file = Vec::new();
    let mut recorder = PathRecording::new(&mut file);
    for (t, theta, speed) in drive {
        recorder.take(theta.wrapped(), *speed, *t);
    }
    recorder.close().unwrap();
    String::from_utf8(file).unwrap()
}

#[test]
fn what_is_recorded_is_read_as_it_was_driven() {
    let mut state = 7;
    for _ in 0..500 {
        let driven = drive(&mut state);
        let read = read(&recorded(&driven)).unwrap();
        assert_eq!(read.len(), driven.len());
        let begun = driven[0].1.0;
        for (setpoint, (t, heading, speed)) in read.iter().zip(&driven) {
            let turned = Radians(setpoint.heading.0 - (heading.0 - begun)).wrapped().degrees();
            assert_eq!(setpoint.at, *t);
            assert!(
                turned.abs() < 1e-4 && (setpoint.speed.0 - speed.0).abs() < 1e-6,
                "{setpoint:?} {heading:?} {speed:?}"
            );
        }
    }
}

#[test]
fn a_damaged_file_is_read_or_has_an_error_in_a_line() {
    let (mut state, mut wrong) = (11, 0);
    for _ in 0..3_000 {
        let mut bytes = recorded(&drive(&mut state)).into_bytes();
        let alphabet = b"0123456789.,-+eE#\n\r \"nNaif\xc3\xa4\xff\0";
        for _ in 0..=(chance(&mut state) * 3.0) as usize {
            let [place, byte] =
                [bytes.len(), alphabet.len()].map(|length| (chance(&mut state) * length as f64) as usize);
            match (chance(&mut state) * 3.0) as usize {
                0 => bytes[place] = alphabet[byte],
                1 => bytes.insert(place, alphabet[byte]),
                _ => bytes.truncate(place + 1),
            }
        }
        match utf8(&bytes).and_then(read) {
            Ok(path) => {
                let times = path.windows(2).map(|pair| pair[1].at.since(pair[0].at).0);
                assert!(path[0].at == Nanos::ZERO && times.into_iter().all(|step| (1..=1_000_000_000).contains(&step)));
                let within = |it: &Setpoint| it.speed.0.abs() <= 1.05 && it.heading.degrees().abs() <= 180.0;
                assert!(path.iter().all(within), "{path:?}");
            }
            Err(TextFault { place, what }) => {
                wrong += 1;
                let lines = bytes.split(|byte| *byte == b'\n').count();
                let whole = what.starts_with("there is nothing in it") || what.starts_with("a path needs two rows");
                assert!(
                    place.map_or(whole, |(line, column)| (1..=lines).contains(&line) && column > 0),
                    "{place:?} {what}"
                );
            }
        }
    }
    assert!((500..2_900).contains(&wrong), "{wrong}");
}

#[test]
fn a_failed_recording_is_reported_at_the_end() {
    struct Full;
    impl std::io::Write for Full {
        fn write(&mut self, _: &[u8]) -> std::io::Result<usize> {
            Err(std::io::ErrorKind::StorageFull.into())
        }
        fn flush(&mut self) -> std::io::Result<()> {
            Ok(())
        }
    }
    let mut recorder = PathRecording::new(Full);
    for turn in 0..5_000 {
        recorder.take(Radians(0.0), MetersPerSecond(0.2), Nanos(turn * 100_000_000));
    }
    assert_eq!(recorder.close().unwrap_err().kind(), std::io::ErrorKind::StorageFull);
}
