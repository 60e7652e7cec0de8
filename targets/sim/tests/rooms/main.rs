//! `goAvoid` in random rooms, out of corners and through a narrow doorway, with and without all that goes wrong on robots.
#![allow(clippy::expect_used, clippy::print_stdout, reason = "a test fails by panicking, and tells what happened")]

mod room;

use mdle_sim::{Body, Make, Place, World};
use room::{Outcome, drive, room};

fn ideal() -> Make {
    Make::default()
}

/// A Scout with all its errors.
fn scout(seed: u64) -> Make {
    Make { body: Body::Scout, seed: Some(seed), ..Make::default() }
}

/// How many of these runs arrive without contact; tells of the others.
fn clean(name: &str, runs: impl Iterator<Item = (u64, Outcome)>) -> usize {
    let clean = runs.filter(|(seed, outcome)| {
        if *outcome != Outcome::Clean {
            println!("{name} {seed}: {outcome:?}");
        }
        *outcome == Outcome::Clean
    });
    clean.count()
}

/// Of rooms 0..200, all are crossed without contact.
#[test]
fn rooms_of_convex_obstacles_are_crossed() {
    let runs = (0..24).map(|seed| (seed, drive(&ideal(), &room(seed), Place { x: 7.0, y: 7.0 })));
    assert!(clean("ideal", runs) >= 23);
}

/// Of rooms 0..200, 199 are crossed without contact, and one with.
#[test]
fn rooms_are_crossed_by_a_scout_too() {
    let runs = (0..24).map(|seed| (seed, drive(&scout(seed), &room(seed), Place { x: 7.0, y: 7.0 })));
    assert!(clean("scout", runs) >= 22);
}

/// How many of four starts, side by side across 10 cm, lead to a place 6 m ahead without contact: ideal, and as a Scout.
fn past(walls: &str) -> (usize, usize) {
    let runs = |make: fn(u64) -> Make| {
        let run = move |seed: u64| {
            let y = 0.1 * (seed as f64 / 3.0 - 0.5);
            let world = World::parse("a test's world", &format!("start = {{ y = {y} }}\n{walls}"));
            (seed, drive(&make(seed), &world.expect("a good world"), Place { x: 6.0, y }))
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

/// 0.61 m, where the body is 0.41 m wide. Of twenty Scouts all pass.
#[test]
fn a_doorway_twenty_centimetres_wider_than_the_body_is_passed() {
    let hallway = "[[wall]]\npoints = [[-1, 1], [8, 1]]\n[[wall]]\npoints = [[-1, -1], [8, -1]]\n";
    let doorway = "[[wall]]\npoints = [[3, 0.305], [3, 1]]\n[[wall]]\npoints = [[3, -0.305], [3, -1]]";
    let (ideal, scout) = past(&[hallway, doorway].concat());
    assert_eq!(ideal, 4);
    assert!(scout >= 3);
}
