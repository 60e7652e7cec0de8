//! Tests world files: the office has its walls (docs/src/reference/office.md, 1), and every error is reported with its
//! position.
#![allow(clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::time::Duration;

use mdle_runtime::capability::SonarRing;
use mdle_runtime::{Robot, SonarId, Twist};
use mdle_sim::{Body, Make, Simulated, World, Zone};

/// Returns the error message for a world with an error.
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
fn faults_of_sounds_have_their_place() {
    let many = "[[sound]]\nat = [1, 1]\n".repeat(9);
    let faults = [
        "t60 = 3",
        "t60 = -0.1",
        "t60 = nan",
        "[[sound]]\nkind = \"white\"",
        "[[sound]]\nat = [1]",
        "[[sound]]\nat = [1, inf]",
        "[[sound]]\nat = [1, 1]\nkind = \"music\"",
        "[[sound]]\nat = [1, 1]\nlevel = 81",
        "[[sound]]\nat = [1, 1]\nlevel = nan",
        &many,
    ];
    let messages = faults.map(|text| World::parse("room.toml", text).expect_err(text).to_string());
    insta::assert_snapshot!(messages.join("\n"), @r#"
    room.toml:1:7: a reverberation time is from 0 (nothing reflects sound) to 0.5 s
    room.toml:1:7: a reverberation time is from 0 (nothing reflects sound) to 0.5 s
    room.toml:1:7: a reverberation time is from 0 (nothing reflects sound) to 0.5 s
    room.toml:1:1: missing field `at`
    room.toml:2:6: `at` is two numbers, x and y in metres, not 1
    room.toml:2:10: inf is no coordinate: expected a number, at most 1000 km
    room.toml:3:8: "music" is no kind of sound; expected `white` or `speech`
    room.toml:3:9: a level is from -40 to 80 dB over the noise of a microphone
    room.toml:3:9: a level is from -40 to 80 dB over the noise of a microphone
    room.toml:17:1: more than 8 sources of sound
    "#);
}

#[test]
fn faults_have_their_place() {
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
        "charger = { at = [1, 0], heading = 0 }\n[[wall]]\nname = \"rear\"\npoints = [[1.2, -1], [1.2, 1]]",
        "units = \"cm\"\ncharger = { at = [50, 50], heading = 0 }\n[[box]]\nmin = [0, 0]\nmax = [100, 100]",
        "charger = { at = [1, 0], heading = 0, reach = 0 }",
        "charger = { at = [1, 0] }",
        "charger = { at = [1, 0, 0], heading = 0 }",
        "units = \"miles\"",
        "rough = 2",
        "rough = -0.1",
        "rough = nan",
        "rough = \"very\"",
        "rough = 50%",
        "rough = half",
        "ruogh = 0.5",
        "[[disc]]\ncentre = [0, 0]\nradius = 2m",
        "[[wall]]\npoints = [[0, 0], [1, 0]]\nrough = 2",
        "[[box]]\nmin = [0, 0]\nmax = [1, 1]\nrough = -0.1",
        "[[disc]]\nrough = nan\ncentre = [0, 0]\nradius = 1",
        "[[door]]\nrough = 1.5\npoints = [[0, 0], [1, 0]]\nopen = []",
        "units = \"ft\"\n[[wall]]\npoints = [[0, 0], [1e7, 0]]",
        "[[disc]]\ncentre = [0, 0]\nradius = 0",
        "[[disc]]\nradius = 1",
        "[[disc]]\ncentre = [0, 0]\nradius = 1\nschedule = [[0, 0, 0]]",
        "[[disc]]\nradius = 1\nschedule = []",
        "[[disc]]\nradius = 1\nschedule = [[0, 0]]",
        "[[disc]]\nradius = 1\nschedule = [[5, 0, 0], [5, 1, 0]]",
        "[[disc]]\nradius = 1\nschedule = [[-1, 0, 0]]",
        "[[box]]\nmin = [0, 0]\nmax = [1, 1]\nschedule = [[0, 0, 0]]",
        "[[door]]\npoints = [[0, 0], [1, 0], [2, 0]]\nopen = []",
        "[[door]]\npoints = [[0, 0], [1, 0]]",
        "[[door]]\npoints = [[0, 0], [1, 0]]\nopen = [[3, 2]]",
        "[[door]]\npoints = [[0, 0], [1, 0]]\nopen = [[1, 3], [2, 4]]",
        "[[door]]\npoints = [[0, 0], [1, 0]]\nopen = [[1, 3]]\nevery = 2",
        "[[door]]\npoints = [[0, 0], [1, 0]]\nopen = [[1, nan]]",
    ]
    .map(fault);
    insta::assert_snapshot!(faults.join("\n"), @r#"
    room.toml:3:1: missing comma between array elements, expected `,`
    room.toml:1:3: unknown field `wal`, expected one of `units`, `rough`, `start`, `goal`, `charger`, `t60`, `sound`, `wall`, `box`, `disc`, `door`; did you mean `wall`?
    room.toml:2:1: unknown field `nmae`, expected one of `name`, `points`, `rough`; did you mean `name`?
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
    room.toml:1:9: `start`: invalid type: sequence, expected a table
    room.toml:1:8: `wall` cannot have this value
    help: write `[[wall]]`, and its keys and values in the lines below
    room.toml:1:8: `goal`: missing field `max`
    room.toml:1:30: a goal without an inside: it would reach from (0, 0) to (0, 1)
    room.toml:1:8: a goal's `heading` needs a `tolerance` and the other way round, as in `heading = 90, tolerance = 15`
    room.toml:1:64: a tolerance is from 0 to 180 degrees
    room.toml:1:18: the charger is in "rear": a robot on it, 0.205 m around `at`, would overlap that
    room.toml:2:18: the charger is in "box 1": a robot on it, 0.205 m around `at`, would overlap that
    room.toml:1:47: a charger without a reach: expected one above 0
    room.toml:1:11: `charger`: missing field `heading`
    room.toml:1:18: `at` is two numbers, x and y in metres, not 3
    room.toml:1:9: "miles" is no unit of length; expected one of `m`, `cm`, `mm`, `in`, `ft`
    room.toml:1:9: `rough` is 2; expected 0, for smooth surfaces, to 1, for those heard at any angle
    room.toml:1:9: `rough` is -0.1; expected 0, for smooth surfaces, to 1, for those heard at any angle
    room.toml:1:9: `rough` is NaN; expected 0, for smooth surfaces, to 1, for those heard at any angle
    room.toml:1:9: `rough`: invalid type: string "very", expected a number from 0 to 1, as in `rough = 0.5`
    room.toml:1:9: `rough`: expected a number from 0 to 1, as in `rough = 0.5`
    room.toml:1:9: `rough`: expected a number from 0 to 1, as in `rough = 0.5`
    room.toml:1:1: unknown field `ruogh`, expected one of `units`, `rough`, `start`, `goal`, `charger`, `t60`, `sound`, `wall`, `box`, `disc`, `door`; did you mean `rough`?
    room.toml:3:10: `radius`: expected a number without a unit, as in `radius = 2`
    room.toml:3:9: `rough` is 2; expected 0, for smooth surfaces, to 1, for those heard at any angle
    room.toml:4:9: `rough` is -0.1; expected 0, for smooth surfaces, to 1, for those heard at any angle
    room.toml:2:9: `rough` is NaN; expected 0, for smooth surfaces, to 1, for those heard at any angle
    room.toml:2:9: `rough` is 1.5; expected 0, for smooth surfaces, to 1, for those heard at any angle
    room.toml:3:20: 1e7 is no coordinate: expected a number, at most 1000 km
    room.toml:3:10: a disc without an inside: expected a radius above 0
    room.toml:1:1: a disc has a `radius` and a `centre`, or a `schedule` if it moves
    room.toml:1:1: a disc has a `radius` and a `centre`, or a `schedule` if it moves
    room.toml:3:12: a schedule needs a stop, as in `schedule = [[0, 1, 2], [5, 4, 2]]`
    room.toml:3:13: a stop is three numbers: seconds, and x and y of the centre
    room.toml:3:24: the stops of a schedule must follow one another in time
    room.toml:3:14: -1e0 is no time: expected seconds since the start, from 0 on
    room.toml:1:1: a box that moves is given by `size` and the centres of its `schedule`
    room.toml:2:10: a door has two points, as in `points = [[0, 0], [0.9, 0]]`
    room.toml:1:1: missing field `open`
    room.toml:3:9: times must follow one another
    room.toml:3:17: times must follow one another
    room.toml:4:9: `every` must be after all the times it repeats, and above 0
    room.toml:3:13: NaN is no time: expected seconds since the start, from 0 on
    "#);
}

#[test]
fn lengths_are_in_the_unit_that_the_file_says() {
    let feet = World::parse(
        "feet",
        "units = \"ft\"\nstart = { x = 10, heading = 90 }\n\
         goal = { min = [0, 0], max = [1, 2], heading = 90, tolerance = 9 }\n[[wall]]\npoints = [[0, 0], [1, 0]]",
    );
    let feet = feet.expect("a good world");
    assert!((feet.start.x.0 - 3.048).abs() < 1e-12 && (feet.start.theta.degrees() - 90.0).abs() < 1e-12);
    assert_eq!(feet.outlines[0].points[1].x, 0.3048);
    let goal = feet.goal.expect("a goal");
    let Zone::Rectangle { max, .. } = goal.zone else { panic!("{goal:?}") };
    assert_eq!((max.x, max.y), (0.3048, 0.6096));
    assert!((goal.heading.expect("a heading").0.degrees() - 90.0).abs() < 1e-12);
}

#[test]
fn every_world_that_comes_along_has_a_place_to_start() {
    assert_eq!(World::names().collect::<Vec<_>>(), ["office", "maze", "hall", "room"]);
    for name in World::names() {
        let world = World::named(name).expect("known").expect("a good world");
        for body in [Body::Ideal, Body::Scout, Body::Atrv] {
            let make = Make { body, ..Make::default() };
            let started = Simulated::with(&make, &world, world.start, Duration::from_millis(100));
            assert!(started.is_ok(), "{name}: {:?}", started.err());
        }
    }
    assert!(World::named("ofice").is_none());
}

/// Returns the ranges ahead of a robot at rest at the origin, one per second; `None` without an echo.
fn ahead(text: &str, seconds: usize) -> Vec<Option<f64>> {
    let world = World::parse("a test's world", text).expect("a good world");
    let mut robot = Simulated::new(&world, world.start, None, Duration::from_secs(1)).expect("a start on the floor");
    let heard = |robot: &mut Simulated| {
        let y = robot.exchange(&Twist::default()).expect("finite inputs");
        y.pings(SonarId::new(0)).nearest(1).map(|range| (range.0 * 1e6).round() / 1e6)
    };
    (0..seconds).map(|_| heard(&mut robot)).collect()
}

#[test]
fn a_door_opens_and_closes_at_its_times() {
    let door = "[[door]]\npoints = [[2, -1], [2, 1]]\nopen = [[1.5, 3.5]]\nevery = 5";
    let (closed, open) = (Some(1.81), None);
    assert_eq!(ahead(door, 10), [closed, closed, open, open, closed, closed, closed, open, open, closed]);
}

#[test]
fn what_moves_is_where_its_schedule_says() {
    let box_ = "[[box]]\nsize = [1, 1]\nschedule = [[1, 3, 0], [3, 5, 0]]\nrepeat = true";
    let ranges = ahead(box_, 6).into_iter().map(|range| range.expect("the box"));
    for (range, expected) in ranges.zip([2.31, 2.31, 3.31, 4.31, 3.31, 4.31]) {
        assert!((range - expected).abs() < 0.05, "{range} {expected}");
    }
}

#[test]
fn nothing_moves_into_the_robot_and_it_feels_what_comes() {
    // Objects whose schedules pass through the robot.
    for things in [
        "[[disc]]\nradius = 0.3\nschedule = [[0, 3, 0], [10, -3, 0]]",
        "[[box]]\nsize = [0.5, 0.5]\nschedule = [[0, 0, 3], [1, 0, -3]]",
    ] {
        let world = World::parse("a test's world", things).expect("a good world");
        let mut robot = Simulated::new(&world, world.start, None, Duration::from_secs(1)).expect("a start");
        let felt = (0..20).filter(|_| robot.exchange(&Twist::default()).expect("finite inputs").switches != 0).count();
        assert!(felt > 10, "{things}: {felt}");
        assert_eq!(robot.pose(), world.start);
    }
}

#[test]
fn a_door_does_not_close_on_the_robot() {
    let door = |open| format!("[[door]]\npoints = [[-1, 0], [1, 0]]\nopen = {open}");
    let made = |text: &str| {
        let world = World::parse("a test's world", text).expect("a good world");
        Simulated::new(&world, world.start, None, Duration::from_secs(1))
    };
    assert!(made(&door("[[1, 3]]")).is_err(), "a start in a closed door");
    let mut robot = made(&door("[[0, 3]]")).expect("a start in an open door");
    for _ in 0..9 {
        assert_eq!(robot.exchange(&Twist::default()).expect("finite inputs").switches, 0);
    }
}

#[test]
fn many_walls_are_made_ready_and_more_than_a_million_are_refused() {
    let disc =
        |number: usize| format!("[[disc]]\ncentre = [{}, {}]\nradius = 1\n", 3 + number % 99 * 3, number / 99 * 3);
    let discs = |count: usize| (0..count).map(disc).collect::<String>();
    let many = World::parse("large", &discs(4_000)).expect("192,000 sides");
    assert!(Simulated::new(&many, many.start, None, Duration::from_secs(1)).is_ok());
    assert_eq!(fault(&discs(20_834)), "room.toml: 1000032 walls and sides are too many; expected at most 1000000");
}

#[test]
fn a_world_of_too_much_text_is_refused_before_it_is_read() {
    let long = format!("# {}\n", "x".repeat(9 << 20));
    assert_eq!(fault(&long), "room.toml: a world of 9437187 bytes is too large; expected at most 8388608");
}
