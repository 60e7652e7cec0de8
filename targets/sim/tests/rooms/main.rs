//! Tests `goAvoid` in random rooms, out of corners and through a narrow doorway, with and without the errors of real
//! robots.
#![allow(clippy::expect_used, clippy::print_stdout, reason = "a test fails by panicking, and tells what happened")]

mod room;

use mdle_sim::{Body, Make, Point, World};
use room::{Outcome, drive, room};

/// Minimum gap between the obstacles of a room, in metres: the width of the body plus 40 cm.
const GAP: f64 = 0.81;

fn ideal() -> Make {
    Make::default()
}

/// Returns a Scout with all its errors.
fn scout(seed: u64) -> Make {
    Make { body: Body::Scout, seed: Some(seed), ..Make::default() }
}

/// Returns the number of runs that arrive without contact; prints the outcome of the others.
fn clean(name: &str, runs: impl Iterator<Item = (u64, Outcome)>) -> usize {
    let clean = runs.filter(|(seed, outcome)| {
        if *outcome != Outcome::Clean {
            println!("{name} {seed}: {outcome:?}");
        }
        *outcome == Outcome::Clean
    });
    clean.count()
}

#[test]
fn rooms_of_convex_obstacles_are_crossed() {
    let runs = (0..24).map(|seed| (seed, drive(&ideal(), &room(seed, GAP), Point { x: 7.0, y: 7.0 }, 5)));
    assert!(clean("ideal", runs) >= 23);
}

#[test]
fn rooms_are_crossed_by_a_scout_too() {
    let runs = (0..24).map(|seed| (seed, drive(&scout(seed), &room(seed, GAP), Point { x: 7.0, y: 7.0 }, 5)));
    assert!(clean("scout", runs) >= 22);
}

/// Returns how many of four runs reach a place 6 m ahead without contact, with starts spread across 10 cm: for the
/// ideal robot, and for a Scout.
fn past(walls: &str) -> (usize, usize) {
    let runs = |make: fn(u64) -> Make| {
        let run = move |seed: u64| {
            let y = 0.1 * (seed as f64 / 3.0 - 0.5);
            let world = World::parse("a test's world", &format!("start = {{ y = {y} }}\n{walls}"));
            (seed, drive(&make(seed), &world.expect("a good world"), Point { x: 6.0, y }, 5))
        };
        (0..4).map(run)
    };
    (clean("ideal", runs(|_| ideal())), clean("scout", runs(scout)))
}

#[test]
fn a_way_leads_out_of_concave_corners() {
    for depth in [0.6, 1.0, 2.0] {
        let pocket = format!("[[wall]]\npoints = [[{0}, 1], [3, 1], [3, -1], [{0}, -1]]", 3.0 - depth);
        assert_eq!(past(&pocket), (4, 4), "{depth} m deep");
    }
    assert_eq!(past("[[wall]]\npoints = [[1, 1], [4, 1], [4, -1]]").0, 4, "an L");
}

/// The doorway is 0.61 m wide, and the body 0.41 m. All of twenty Scouts pass.
#[test]
fn a_doorway_twenty_centimetres_wider_than_the_body_is_passed() {
    let hallway = "[[wall]]\npoints = [[-1, 1], [8, 1]]\n[[wall]]\npoints = [[-1, -1], [8, -1]]\n";
    let doorway = "[[wall]]\npoints = [[3, 0.305], [3, 1]]\n[[wall]]\npoints = [[3, -0.305], [3, -1]]";
    let (ideal, scout) = past(&[hallway, doorway].concat());
    assert_eq!(ideal, 4);
    assert!(scout >= 3);
}

/// Returns how many of the runs with these seeds go 6 m along a hallway 2 m wide without contact, while a person
/// approaches the robot at `speed`, in m/s. The person keeps `right` metres to the right of the middle, from the
/// person's view.
fn meet(name: &str, make: fn(u64) -> Make, seeds: u64, speed: f64, right: f64) -> usize {
    let run = |seed: u64| {
        let y = 0.1 * (seed as f64 / 9.5 - 1.0);
        let text = format!(
            "start = {{ y = {y} }}\n[[wall]]\npoints = [[-2, 1], [16, 1]]\n[[wall]]\npoints = [[-2, -1], [16, -1]]\n\
             [[disc]]\nradius = 0.25\nschedule = [[0, 14, {right}], [{}, -1.5, {right}]]",
            15.5 / speed
        );
        let world = World::parse("a test's world", &text).expect("a good world");
        (seed, drive(&make(seed), &world, Point { x: 6.0, y }, 5))
    };
    clean(name, (0..seeds).map(run))
}

/// A person who walks at 1 m/s, 20 cm right of the middle, touches none of 20 ideal robots and 2 of 20 Scouts. A person
/// who walks at 0.5 m/s touches none.
#[test]
fn somebody_who_keeps_right_in_a_hallway_is_given_way_to() {
    assert_eq!(meet("ideal", |_| ideal(), 6, 1.0, 0.2), 6);
    assert_eq!(meet("ideal", |_| ideal(), 6, 0.5, 0.0), 6);
    assert_eq!(meet("scout", scout, 6, 0.5, 0.2), 6);
    assert!(meet("scout", scout, 12, 1.0, 0.2) >= 10);
}
