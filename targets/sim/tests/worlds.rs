//! World files: the office is the one of the design, and every fault is told with its place.
#![allow(clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use mdle_sim::World;

/// What is wrong with a world.
fn fault(text: &str) -> String {
    World::parse("room.toml", text).expect_err("a bad world").to_string()
}

#[test]
fn the_office_has_twenty_five_walls_one_of_them_a_box() {
    let office = World::office().expect("our own floor");
    let sides = |solid: bool| {
        let outlines = office.outlines.iter().filter(move |outline| outline.solid == solid);
        outlines.map(|outline| outline.points.len() - 1).sum::<usize>()
    };
    assert_eq!((sides(false), sides(true)), (21, 4));
    assert_eq!(office.start, mdle_runtime::Pose::ORIGIN);
}

#[test]
fn a_box_is_given_by_corners_or_by_centre_and_size() {
    let corners = World::parse("one", "[[box]]\nmin = [1, 2]\nmax = [3, 2.5]").expect("good");
    let centre = World::parse("other", "[[box]]\ncentre = [2, 2.25]\nsize = [2, 0.5]").expect("good");
    assert_eq!(corners, centre);
    assert_eq!(corners.outlines[0].name, "box 1");
}

#[test]
fn faults_are_told_with_their_place() {
    let faults = [
        "[[wall]]\npoints = [[0, 0], [1, 0]\nname = \"north\"",
        "[[wal]]\npoints = [[0, 0], [1, 0]]",
        "[[wall]]\nnmae = \"north\"\npoints = [[0, 0], [1, 0]]",
        "[[wall]]\nname = \"north\"",
        "[[wall]]\npoints = [[0, 0]]",
        "[[wall]]\npoints = [[0, 0], [1, 0], [1, 0]]",
        "[[wall]]\npoints = [[0, 0], [1, 0, 2]]",
        "[[wall]]\npoints = [[0, 0], [\"1\", 0]]",
        "[[wall]]\npoints = [[0, 0], [1, nan]]",
        "[[wall]]\npoints = [[0, 0], [-inf, 0]]",
        "[[wall]]\npoints = [[0, 0], [1e300, 0]]",
        "[[box]]\nmin = [0, 0]",
        "start = { x = 1 }\n\n[[box]]\nmin = [0, 0]\nmax = [1, 1]\nsize = [1, 1]",
        "[[box]]\nmin = [0, 0]\nmax = [1, 0]",
        "[[box]]\ncentre = [0, 0]\nsize = [-1, 1]",
        "start = { x = 1, y = 2, theta = 90 }",
        "start = { x = nan }",
        "start = { heading = inf }",
        "start = [0, 0, 0, 4]",
        "wall = 3",
        "goal = { min = [0, 0] }",
        "goal = { min = [0, 0], max = [0, 1] }",
        "goal = { min = [0, 0], max = [1, 1], heading = 90 }",
        "goal = { min = [0, 0], max = [1, 1], heading = 90, tolerance = -1 }",
    ]
    .map(fault);
    insta::assert_snapshot!(faults.join("\n"), @r#"
    room.toml:3:1: missing comma between array elements, expected `,`
    room.toml:1:3: unknown field `wal`, expected one of `start`, `goal`, `wall`, `box`
    room.toml:2:1: unknown field `nmae`, expected `name` or `points`
    room.toml:1:1: missing field `points`
    room.toml:2:10: a wall needs at least two points, as in `points = [[0, 0], [2.5, 0]]`
    room.toml:2:27: a wall of length zero: the point before it is (1, 0) too
    room.toml:2:19: a point is two numbers, x and y in metres, not 3
    room.toml:2:20: invalid type: string "1", expected a number
    room.toml:2:23: NaN is no coordinate: expected a number, at most 1000 km
    room.toml:2:20: -inf is no coordinate: expected a number, at most 1000 km
    room.toml:2:20: 1e300 is no coordinate: expected a number, at most 1000 km
    room.toml:1:1: a box is given by its corners `min` and `max`, or by `centre` and `size`
    room.toml:3:1: a box is given by its corners `min` and `max`, or by `centre` and `size`
    room.toml:3:7: a box without an inside: it would reach from (0, 0) to (1, 0)
    room.toml:3:8: a box without an inside: it would reach from (0.5, -0.5) to (-0.5, 0.5)
    room.toml:1:25: unknown field `theta`, expected one of `x`, `y`, `heading`
    room.toml:1:15: NaN is no coordinate: expected a number, at most 1000 km
    room.toml:1:21: inf is no coordinate: expected a number, at most 1000 km
    room.toml:1:9: invalid type: sequence, expected a table
    room.toml:1:8: invalid type: integer `3`, expected a sequence
    room.toml:1:8: missing field `max`
    room.toml:1:30: a goal without an inside: it would reach from (0, 0) to (0, 1)
    room.toml:1:8: a goal's `heading` needs a `tolerance` and the other way round, as in `heading = 90, tolerance = 15`
    room.toml:1:64: a tolerance is from 0 to 180 degrees
    "#);
}
