//! Converts messages between CDR and JSON, for the comparison with another encoder: `tests/test_cdr.py` runs it.
//!
//! A line of standard input is a type, `read` or `write`, and the bytes as hexadecimal digits or the JSON.
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
            other => panic!("there is no type `{other}`"),
        };
        println!("{}", convert(way, text));
    }
}

fn convert<T: Serialize + DeserializeOwned>(way: &str, text: &str) -> String {
    if way == "write" {
        let payload = Payload::of(&serde_json::from_str::<T>(text).unwrap()).unwrap();
        return payload.bytes.iter().map(|byte| format!("{byte:02x}")).collect();
    }
    let digits = text.as_bytes().chunks(2).map(|pair| std::str::from_utf8(pair).unwrap());
    let bytes = digits.map(|pair| u8::from_str_radix(pair, 16).unwrap()).collect();
    match (Payload { bytes, encoding: RepresentationIdentifier::CDR_LE }).read::<T>() {
        Ok(message) => serde_json::to_string(&message).unwrap(),
        Err(why) => format!("error: {why}"),
    }
}
