//! `goAvoid` where the way is narrow: doorways, boxes in hallways, corners, rooms, and somebody who walks across.
//!
//! Each test tries a few seeds. `MDLE_LONG=10 cargo test --release -p mdle-sim --test obstacles -- --nocapture` tries
//! ten times as many and prints how they end; `MDLE_FIRST` is the first seed.
#![allow(clippy::expect_used, clippy::print_stdout, reason = "a test fails by panicking, and tells what happened")]

mod chance;
#[path = "../rooms/room.rs"]
mod room;
mod worlds;

use mdle_sim::{Body, Make};
use room::{Outcome, drive};
use worlds::Crossing;

/// A whole number in the environment.
fn number(name: &str, usual: u64) -> u64 {
    std::env::var(name).map_or(usual, |text| text.parse().expect("a whole number"))
}

/// The outcomes of a few runs.
struct Outcomes {
    clean: u64,
    touched: u64,
    count: u64,
}

fn outcomes(name: &str, crossing: fn(Body, u64) -> Crossing, body: Body) -> Outcomes {
    let (first, count) = (number("MDLE_FIRST", 5000), 12 * number("MDLE_LONG", 1));
    let (mut clean, mut touched) = (0, 0);
    for seed in first..first + count {
        let make = Make { body, seed: (body != Body::Ideal).then_some(seed), ..Make::default() };
        let Crossing { world, to } = crossing(body, seed);
        match drive(&make, &world, to) {
            Outcome::Clean => clean += 1,
            Outcome::Touched(_) => touched += 1,
            Outcome::TimedOut => {}
        }
    }
    println!("{name}, {body}: {clean} of {count} arrive without contact, {touched} with");
    Outcomes { clean, touched, count }
}

/// Panics unless at least this share of a few runs, in hundredths, arrives without contact.
fn assert_clean(name: &str, crossing: fn(Body, u64) -> Crossing, body: Body, share: u64) {
    let Outcomes { clean, count, .. } = outcomes(name, crossing, body);
    assert!(100 * clean >= share * count, "{name}, {body}: {clean} of {count}");
}

#[test]
fn a_doorway_fifteen_centimetres_wider_is_passed() {
    assert_clean("doorway", worlds::doorway, Body::Ideal, 70);
    assert_clean("doorway", worlds::doorway, Body::Scout, 20);
}

#[test]
fn a_box_in_the_middle_of_a_hallway_is_passed() {
    assert_clean("middle", worlds::middle, Body::Ideal, 100);
    assert_clean("middle", worlds::middle, Body::Scout, 75);
}

/// `goAvoid` keeps a way of 0.8 m for a rectangle of 0.63 m by 0.54 m: it turns away before both of these.
#[test]
fn a_rectangle_touches_nothing_before_narrow_ways() {
    for (name, crossing) in [("doorway", worlds::doorway as fn(Body, u64) -> Crossing), ("middle", worlds::middle)] {
        assert_eq!(outcomes(name, crossing, Body::Atrv).touched, 0, "{name}");
    }
}

#[test]
fn a_corner_is_left() {
    assert_clean("corner", worlds::corner, Body::Ideal, 100);
    assert_clean("corner", worlds::corner, Body::Scout, 90);
    assert_clean("corner", worlds::corner, Body::Atrv, 70);
}

#[test]
fn the_room_of_the_simulator_is_crossed() {
    assert_clean("room", worlds::room, Body::Ideal, 100);
    assert_clean("room", worlds::room, Body::Scout, 90);
}

#[test]
fn random_rooms_with_narrow_gaps_are_crossed() {
    assert_clean("random", worlds::random, Body::Ideal, 100);
    assert_clean("random", worlds::random, Body::Scout, 90);
    assert_clean("random", worlds::random, Body::Atrv, 30);
}

#[test]
fn the_first_passages_of_the_maze_are_driven() {
    assert_clean("maze", worlds::maze, Body::Ideal, 100);
    assert_clean("maze", worlds::maze, Body::Scout, 90);
}

/// Before the law waited for him, 14 of 40 ideal robots and 19 of 40 Scouts met the walker.
#[test]
fn somebody_who_walks_across_is_waited_for() {
    assert_clean("hall", worlds::hall, Body::Ideal, 90);
    assert_clean("hall", worlds::hall, Body::Scout, 90);
    assert_clean("hall", worlds::hall, Body::Atrv, 60);
}
