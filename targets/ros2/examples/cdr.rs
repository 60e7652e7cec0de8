//! Converts messages between CDR and JSON, so that `tests/test_cdr.py` can compare them with another encoder's
//! messages.
//!
//! Each line of standard input contains a type, `read` or `write`, and the bytes as hexadecimal digits or the JSON.
#![allow(clippy::print_stdout, clippy::unwrap_used, clippy::panic, reason = "a program of tests, which fails loudly")]

use std::io::stdin;

use mdle_ros2::cdr::Payload;
use mdle_ros2::messages as m;
use rustdds::RepresentationIdentifier;
use serde::Serialize;
use serde::de::DeserializeOwned;

fn main() {
    for line in stdin().lines() {
        let line = line.unwrap();
        let mut parts = line.splitn(3, ' ');
        let [kind, way, text] = [(); 3].map(|()| parts.next().unwrap());
        let convert = match kind {
            "Twist" => convert::<m::TwistMessage>,
            "TwistStamped" => convert::<m::TwistStamped>,
            "Odometry" => convert::<m::Odometry>,
            "LaserScan" => convert::<m::LaserScan>,
            "ShortRange" => convert::<m::ShortRange>,
            "Range" => convert::<m::Range>,
            "Bool" => convert::<m::Bool>,
            "String" => convert::<m::Text>,
            "HazardDetectionVector" => convert::<m::HazardDetectionVector>,
            "BatteryState" => convert::<m::BatteryState>,
            "Clock" => convert::<m::ClockMessage>,
            "DiagnosticArray" => convert::<m::DiagnosticArray>,
            "ParticipantEntitiesInfo" => convert::<m::ParticipantEntitiesInfo>,
            "LongEntitiesInfo" => written_with_long_ids,
            other => panic!("there is no type `{other}`"),
        };
        println!("{}", convert(way, text));
    }
}

fn convert<T: Serialize + DeserializeOwned>(way: &str, text: &str) -> String {
    if way == "write" {
        return digits(&serde_json::from_str::<T>(text).unwrap());
    }
    let digits = text.as_bytes().chunks(2).map(|pair| std::str::from_utf8(pair).unwrap());
    let bytes = digits.map(|pair| u8::from_str_radix(pair, 16).unwrap()).collect();
    match (Payload { bytes, encoding: RepresentationIdentifier::CDR_LE }).read::<T>() {
        Ok(message) => serde_json::to_string(&message).unwrap(),
        Err(why) => format!("error: {why}"),
    }
}

/// Returns the bytes of a message, as hexadecimal digits.
fn digits<T: Serialize>(message: &T) -> String {
    Payload::of(message).unwrap().bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

/// Encodes the nodes of a program with the ids of Humble. The driver does not read this format.
fn written_with_long_ids(_: &str, text: &str) -> String {
    let mut info: m::ParticipantEntitiesInfo = serde_json::from_str(text).unwrap();
    info.gid.is_long = true;
    for node in &mut info.node_entities_info_seq {
        node.reader_gid_seq.iter_mut().chain(&mut node.writer_gid_seq).for_each(|gid| gid.is_long = true);
    }
    digits(&info)
}
