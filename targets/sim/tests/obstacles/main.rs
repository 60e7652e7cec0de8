//! Tests `goAvoid` in narrow places: doorways, boxes in hallways, corners, rooms, and a person who walks across.
//!
//! Each test tries a few seeds. `MDLE_LONG=10 cargo test --release -p mdle-sim --test obstacles -- --nocapture` tries
//! ten times as many and prints their outcomes; `MDLE_FIRST` is the first seed, and `MDLE_MINUTES` the time for a run.
#![allow(clippy::expect_used, clippy::print_stdout, reason = "a test fails by panicking, and tells what happened")]

mod chance;
#[path = "../rooms/room.rs"]
mod room;
mod walker;
mod worlds;

use mdle_sim::{Body, Make};
use room::{Outcome, drive, number};
use worlds::Crossing;

/// Panics unless at least `share` percent of 24 runs arrive without contact.
fn assert_clean(name: &str, crossing: fn(Body, u64) -> Crossing, body: Body, share: u64) {
    assert_clean_of(24, name, crossing, body, share);
}

/// Panics unless at least `share` percent of this number of runs arrive without contact within five minutes.
fn assert_clean_of(runs: u64, name: &str, crossing: fn(Body, u64) -> Crossing, body: Body, share: u64) {
    assert_clean_within(5, runs, name, crossing, body, share);
}

/// Panics unless at least `share` percent of this number of runs arrive without contact within `minutes`.
fn assert_clean_within(
    minutes: u64,
    runs: u64,
    name: &str,
    crossing: fn(Body, u64) -> Crossing,
    body: Body,
    share: u64,
) {
    let (first, count) = (number("MDLE_FIRST", 5000), runs * number("MDLE_LONG", 1));
    let (mut clean, mut touched) = (0, 0);
    for seed in first..first + count {
        let make = Make { body, seed: (body != Body::Ideal).then_some(seed), ..Make::default() };
        let Crossing { world, to } = crossing(body, seed);
        match drive(&make, &world, to, minutes) {
            Outcome::Clean => clean += 1,
            Outcome::Touched(_) => touched += 1,
            Outcome::TimedOut => {}
        }
    }
    println!("{name}, {body}: {clean} of {count} arrive without contact, {touched} touch something");
    assert!(100 * clean >= share * count, "{name}, {body}: {clean} of {count}");
}

/// The doorway is 15 cm wider than the body. The width of a rectangle is measured across its length, along which it
/// drives. With the seeds 10480000 to 10480623, 612 of 624 Scouts arrive without contact, and 8 touch a jamb.
#[test]
fn a_doorway_fifteen_centimetres_wider_is_passed() {
    assert_clean("doorway", worlds::doorway, Body::Ideal, 95);
    assert_clean_of(48, "doorway", worlds::doorway, Body::Scout, 90);
    assert_clean("doorway", worlds::doorway, Body::Atrv, 90);
}

/// With the seeds from 10480000 on, 1831 of 1872 ideal robots and 103 of 312 Scouts arrive.
#[test]
fn a_doorway_in_a_thick_wall_across_a_room_is_passed() {
    assert_clean_of(144, "thick", worlds::thick, Body::Ideal, 80);
    assert_clean("thick", worlds::thick, Body::Scout, 25);
}

/// The sonars of an ATRV-mini measure no range below 15 cm. Before it drove away in an arc, it touched walls 1 to 12 cm
/// beside it in 271 of 600 runs.
#[test]
fn a_wall_beside_the_start_is_left() {
    assert_clean("beside", worlds::beside, Body::Ideal, 100);
    assert_clean("beside", worlds::beside, Body::Scout, 95);
    assert_clean("beside", worlds::beside, Body::Atrv, 90);
}

#[test]
fn a_box_in_the_middle_of_a_hallway_is_passed() {
    assert_clean("middle", worlds::middle, Body::Ideal, 99);
    assert_clean("middle", worlds::middle, Body::Scout, 95);
    assert_clean("middle", worlds::middle, Body::Atrv, 80);
}

#[test]
fn a_corner_is_left() {
    assert_clean("corner", worlds::corner, Body::Ideal, 90);
    assert_clean("corner", worlds::corner, Body::Scout, 90);
    assert_clean("corner", worlds::corner, Body::Atrv, 85);
}

#[test]
fn the_room_of_the_simulator_is_crossed() {
    assert_clean("room", worlds::room, Body::Ideal, 90);
    assert_clean("room", worlds::room, Body::Scout, 80);
    assert_clean("room", worlds::room, Body::Atrv, 85);
}

#[test]
fn random_rooms_with_narrow_gaps_are_crossed() {
    assert_clean("random", worlds::random, Body::Ideal, 90);
    assert_clean("random", worlds::random, Body::Scout, 90);
    assert_clean("random", worlds::random, Body::Atrv, 90);
}

#[test]
fn the_first_passages_of_the_maze_are_driven() {
    assert_clean("maze", worlds::maze, Body::Ideal, 100);
    assert_clean("maze", worlds::maze, Body::Scout, 90);
    assert_clean("maze", worlds::maze, Body::Atrv, 90);
}

/// The walls are parallel to the axes of odometry, so the drift of the heading is measured. With the seeds from
/// 8350000 on, 118 of 120 Scouts and 116 of 120 ATRV-minis arrive without contact. While the drift counted as none
/// where it was no longer known precisely, 112 and 112 did.
#[test]
fn the_whole_maze_is_crossed_within_an_hour() {
    assert_clean_within(60, 8, "whole maze", worlds::whole_maze, Body::Ideal, 100);
    assert_clean_within(60, 8, "whole maze", worlds::whole_maze, Body::Scout, 85);
    assert_clean_within(60, 8, "whole maze", worlds::whole_maze, Body::Atrv, 85);
}

/// Before `goAvoid` waited for the walker, 14 of 40 ideal robots and 19 of 40 Scouts collided with the walker. Before
/// it backed off, 9 of 100 Scouts and 14 of 100 ATRV-minis did.
#[test]
fn somebody_who_walks_across_is_waited_for() {
    assert_clean("hall", worlds::hall, Body::Ideal, 95);
    assert_clean("hall", worlds::hall, Body::Scout, 95);
    assert_clean("hall", worlds::hall, Body::Atrv, 90);
}

/// If the robots did not react, a third of them would collide with the person.
#[test]
fn a_person_who_walks_across_an_open_floor_is_let_pass() {
    assert_clean("lane", worlds::lane, Body::Ideal, 95);
    assert_clean("lane", worlds::lane, Body::Scout, 90);
    assert_clean("lane", worlds::lane, Body::Atrv, 90);
}

/// With the seeds 10300000..10300480, 12 Scouts and 6 ATRV-minis touch the person. Before echoes that may come from
/// the wall ahead were ruled out, 33 and 25 of 480 did before such walls.
#[test]
fn a_person_in_a_corridor_across_the_way_is_let_pass() {
    assert_clean("corridor", worlds::corridor, Body::Scout, 90);
    assert_clean("corridor", worlds::corridor, Body::Atrv, 90);
}

/// A robot that stands still is touched by a person who walks straight at it. With the seeds 10330000..10330300, 143
/// ideal robots, 145 Scouts and 195 ATRV-minis of 300 are touched; before they stopped for such people, 198, 189 and
/// 262 were.
#[test]
fn a_person_who_comes_from_ahead_and_aside_is_stopped_for() {
    assert_clean_of(96, "slanting", worlds::slanting, Body::Ideal, 30);
    assert_clean_of(96, "slanting", worlds::slanting, Body::Scout, 33);
    assert_clean_of(96, "slanting", worlds::slanting, Body::Atrv, 12);
}
