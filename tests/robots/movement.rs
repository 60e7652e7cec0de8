//! Compares the movements that plans are meant to make with the trail of a run, for the plans of `plans/` and for the
//! plans of the book that have a file name there.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

use std::fs;
use std::path::PathBuf;
use std::process::Command;

use mdle_tests::executable::{folder, run_mdlec};
use mdle_tests::repository::root;

/// A floor with a single wall, far away.
const FLOOR: &str = "[[wall]]\npoints = [[-20, -20], [20, -20]]\n";
/// A room of 8 m by 6 m.
const ROOM: &str = "[[wall]]\npoints = [[0, 0], [8, 0], [8, 6], [0, 6], [0, 0]]\n";
/// A floor with a wall across the x axis at 3 m.
const ACROSS: &str = "[[wall]]\npoints = [[3, -4], [3, 4]]\n[[wall]]\npoints = [[-20, -20], [20, -20]]\n";
/// A floor with a round post on the x axis. Its diameter is 60 cm, and its near side is at 1.7 m.
const POST: &str =
    "[[disc]]\nname = \"post\"\ncentre = [2, 0]\nradius = 0.3\n\n[[wall]]\npoints = [[-20, -20], [20, -20]]\n";

/// A row of a trail: time in seconds, x and y in metres, and heading in degrees.
type Row = [f64; 4];

/// Result of a run.
struct Run {
    trail: Vec<Row>,
    /// Lines of the report, each a transition with its time.
    lines: Vec<String>,
}

/// Returns the text of a plan in the folder `plans`.
fn of_plans(name: &str) -> String {
    fs::read_to_string(root().join("plans").join(format!("{name}.mdle"))).unwrap()
}

/// Returns all blocks that a page of the book writes to this file, in order.
fn all_of_book(page: &str, file: &str) -> Vec<String> {
    let text = fs::read_to_string(root().join("docs/src").join(page)).unwrap();
    let language = file.rsplit('.').next().unwrap();
    let fence = format!("```{language},{file}\n");
    let blocks = text.split(&fence).skip(1);
    let plans: Vec<_> = blocks.map(|block| block.split("```").next().unwrap().to_owned()).collect();
    assert!(!plans.is_empty(), "{page} writes no {file}");
    plans
}

/// Returns the last block that a page of the book writes to this file.
fn of_book(page: &str, file: &str) -> String {
    all_of_book(page, file).pop().unwrap()
}

/// Builds a plan for the simulator, and returns the path of its executable.
fn built(name: &str, text: &str) -> PathBuf {
    let folder = folder(&format!("movement_{name}"));
    fs::write(folder.join(format!("{name}.mdle")), text).unwrap();
    for (world, text) in [("floor", FLOOR), ("walled", ROOM), ("across", ACROSS), ("post", POST)] {
        fs::write(folder.join(format!("{world}.toml")), text).unwrap();
    }
    let output = run_mdlec(&folder, &[&format!("{name}.mdle"), "--target", "sim"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    folder.join(name)
}

/// Runs a plan with these options, which may set a time limit.
fn run(executable: &PathBuf, options: &[&str]) -> Run {
    let folder = executable.parent().unwrap();
    let mut command = Command::new(executable);
    command.args(["--speed", "max", "--trail", "trail.csv"]).args(options).current_dir(folder);
    let output = command.output().unwrap();
    let errors = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(matches!(output.status.code(), Some(0 | 4)), "{errors}");
    let trail = fs::read_to_string(folder.join("trail.csv")).unwrap();
    let row = |line: &str| -> Row {
        let numbers: Vec<f64> = line.split(',').map(|number| number.parse().unwrap()).collect();
        numbers.try_into().unwrap()
    };
    let lines = String::from_utf8(output.stdout).unwrap().lines().map(str::to_owned).collect();
    Run { trail: trail.lines().skip(1).map(row).collect(), lines }
}

impl Run {
    /// Returns the trail relative to the start pose: metres ahead, metres to the left, and degrees turned to the left.
    fn relative(&self) -> Vec<[f64; 3]> {
        let [_, x0, y0, heading] = self.trail[0];
        let (sin, cos) = (libm::sin(heading.to_radians()), libm::cos(heading.to_radians()));
        let relative = self.trail.iter().map(|[_, x, y, at]| {
            let (dx, dy) = (x - x0, y - y0);
            [dx * cos + dy * sin, dy * cos - dx * sin, (at - heading + 180.0).rem_euclid(360.0) - 180.0]
        });
        relative.collect()
    }

    /// Returns the index of the row of the trail at this time.
    fn at(&self, seconds: f64) -> usize {
        self.trail.iter().position(|[t, ..]| *t >= seconds - 1e-9).unwrap_or(self.trail.len() - 1)
    }

    /// Returns the times at which a law begins whose text starts with `law`.
    fn begins(&self, law: &str) -> Vec<f64> {
        let lines = self.lines.iter().filter(|line| line.contains(&format!(" s  {law}")));
        lines.map(|line| line.split(' ').find(|word| !word.is_empty()).unwrap().parse().unwrap()).collect()
    }
}

/// Returns how often the robot reached the far end of a straight line of this length, within 30 cm, and how often it
/// returned to the start. Asserts that the robot always stayed within 30 cm of the line.
fn legs(trail: &[[f64; 3]], length: f64, name: &str) -> (u32, u32) {
    let (mut there, mut back, mut is_out) = (0, 0, false);
    for [ahead, left, _] in trail {
        assert!(
            left.abs() <= 0.3 && (-0.3..=length + 0.3).contains(ahead),
            "{name}: {ahead} m ahead, {left} m to the left"
        );
        let near = |place: f64| (ahead - place).abs() <= 0.3;
        match is_out {
            false if near(length) => (there, is_out) = (there + 1, true),
            true if near(0.0) => (back, is_out) = (back + 1, false),
            _ => {}
        }
    }
    (there, back)
}

#[test]
fn the_patrol_goes_there_and_back_three_times() {
    let patrol = built("patrol", &of_plans("patrol"));
    for (world, start) in [("hall", "1.5,5,0"), ("floor.toml", "10,5,90"), ("floor.toml", "6,5,200")] {
        let run = run(&patrol, &["--world", world, "--start", start]);
        let trail = run.relative();
        assert_eq!(legs(&trail, 3.0, start), (3, 3), "from {start}");
        let [ahead, left, _] = trail[trail.len() - 1];
        assert!(libm::hypot(ahead, left) <= 0.3, "from {start}: ends {ahead} m ahead, {left} m to the left");
        assert!(run.lines.last().unwrap().contains(" s  plan over: completed"), "{:?}", run.lines);
    }
}

#[test]
fn the_legs_of_the_book_lead_there_and_back() {
    let legs_of_book = built("legs", &of_book("names.md", "legs.mdle"));
    let run = run(&legs_of_book, &["--world", "floor.toml", "--start", "6,5,30"]);
    let trail = run.relative();
    let short = run.at(run.begins("advance 1 40")[0]);
    assert_eq!(legs(&trail[..short], 3.0, "the long leg"), (1, 1));
    let (there, back) = legs(&trail[short..], 1.0, "the short leg");
    assert!(there >= 3 && there - back <= 1, "{there} times there, {back} times back");
}

#[test]
fn the_plan_of_the_board_goes_there_and_back_twice() {
    let shuttle = built("shuttle", &of_book("microcontroller.md", "shuttle.mdle"));
    for (world, start) in [("hall", "1.5,5,0"), ("floor.toml", "6,5,200")] {
        let run = run(&shuttle, &["--world", world, "--start", start]);
        assert_eq!(legs(&run.relative(), 3.0, start), (2, 2), "from {start}");
        assert!(run.lines.last().unwrap().contains(" s  plan over: completed"), "{:?}", run.lines);
    }
}

#[test]
fn a_frame_here_leads_ahead_and_back() {
    let ahead = built("ahead", &of_book("language.md", "ahead.mdle"));
    let round = run(&ahead, &["--world", "post.toml", "--start", "0,0,0"]).relative();
    assert!(round.iter().any(|[ahead, ..]| *ahead >= 2.7) && round.iter().any(|[_, left, _]| left.abs() > 0.3));
    let [ahead_at, left, heading] = round[round.len() - 1];
    assert!(libm::hypot(ahead_at, left) <= 0.3 && heading.abs() <= 5.0, "ends at {ahead_at}, {left}, {heading}");
    for start in ["6,5,30", "6,5,-100"] {
        assert_eq!(legs(&run(&ahead, &["--world", "floor.toml", "--start", start]).relative(), 3.0, start), (1, 1));
    }
}

#[test]
fn four_metres_and_four_turns_are_a_square() {
    let metre = built("metre", &of_book("quarks.md", "metre.mdle"));
    let run = run(&metre, &["--world", "floor.toml", "--start", "6,5,30"]);
    let trail = run.relative();
    let turns = run.begins("turn 90");
    assert_eq!(turns.len(), 4);
    for (time, [x, y]) in turns.iter().zip([[1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.0, 0.0]]) {
        let [ahead, left, _] = trail[run.at(*time)];
        assert!(libm::hypot(ahead - x, left - y) <= 0.12, "({ahead}, {left}) is not ({x}, {y})");
    }
}

#[test]
fn the_square_of_the_guide_is_a_square_of_a_metre() {
    let square = built("square", &of_book("own_plan.md", "square.mdle"));
    let run = run(&square, &["--start", "3,1,0"]);
    let (trail, turns) = (run.relative(), run.begins("turn 90"));
    assert_eq!(turns.len(), 16);
    for (corner, time) in turns.iter().enumerate() {
        let from = corner.checked_sub(1).map_or(0, |before| run.at(turns[before]));
        let ([x, y, _], [to_x, to_y, _]) = (trail[from], trail[run.at(*time)]);
        let side = libm::hypot(to_x - x, to_y - y);
        assert!((side - 1.0).abs() <= 0.1, "side {corner} has {side} m");
    }
}

#[test]
fn the_sentry_turns_by_eighths_on_one_spot() {
    let sentry = built("sentry", &of_plans("sentry"));
    let run = run(&sentry, &["--world", "floor.toml", "--start", "6,5,0", "--timeout", "60"]);
    let (trail, rests) = (run.relative(), run.begins("stop"));
    assert!(trail.iter().all(|[ahead, left, _]| libm::hypot(*ahead, *left) <= 0.02));
    assert!(rests.len() >= 10, "{rests:?}");
    for pair in rests.windows(2) {
        let [one, other] = [pair[0], pair[1]].map(|time| trail[run.at(time)][2]);
        let turned = (other - one).rem_euclid(360.0);
        assert!((turned - 45.0).abs() <= 4.0, "{turned} degrees");
    }
}

#[test]
fn exploring_backs_off_from_what_was_touched_and_looks_elsewhere() {
    let retreat = built("retreat", &of_plans("retreat"));
    let run = run(&retreat, &["--world", "hall", "--start", "6,5,0"]);
    let (trail, backs, turns, on) =
        (run.relative(), run.begins("go -15 0"), run.begins("turn 110"), run.begins("go 20 0"));
    assert!(backs.len() >= 2 && turns.len() >= 2, "{:?}", run.lines);
    for (back, turn) in backs.iter().zip(&turns) {
        let ([x, y, heading], [to_x, to_y, _]) = (trail[run.at(*back)], trail[run.at(*turn)]);
        let ahead = (to_x - x) * libm::cos(heading.to_radians()) + (to_y - y) * libm::sin(heading.to_radians());
        assert!((ahead + 0.3).abs() <= 0.08, "{ahead} m in two seconds");
    }
    for (turn, on) in turns.iter().zip(&on) {
        let turned = (trail[run.at(*on)][2] - trail[run.at(*turn)][2]).rem_euclid(360.0);
        assert!((turned - 110.0).abs() <= 4.0, "{turned} degrees");
    }
}

#[test]
fn the_branching_plan_comes_back_where_nothing_is_in_the_way() {
    let branching = built("branching", &of_plans("branching"));
    let run = run(&branching, &["--world", "hall", "--start", "1.5,5,0"]);
    let trail = run.relative();
    let farthest = trail.iter().map(|[ahead, ..]| *ahead).fold(0.0, f64::max);
    let [ahead, left, _] = trail[trail.len() - 1];
    assert!((farthest - 1.0).abs() <= 0.1, "{farthest} m there");
    assert!(libm::hypot(ahead, left) <= 0.15, "ends {ahead} m ahead, {left} m to the left");
}

#[test]
fn docking_ends_with_three_shakes_on_the_spot() {
    let dock = built("dock", &of_plans("dock"));
    let run = run(&dock, &["--world", "hall", "--start", "1.5,5,0"]);
    let (trail, shakes) = (run.relative(), run.begins("go 5 0"));
    assert_eq!(shakes.len(), 3);
    let [ahead, left, _] = trail[run.at(shakes[0])];
    assert!((ahead - 4.0).abs() <= 0.1 && left.abs() <= 0.05, "{ahead} m ahead, {left} m to the left");
    for [x, y, _] in &trail[run.at(shakes[0])..] {
        assert!(libm::hypot(x - ahead, y - left) <= 0.15);
    }
    let turned = trail[trail.len() - 1][2].rem_euclid(360.0);
    assert!((turned - 270.0).abs() <= 8.0, "{turned} degrees");
}

#[test]
fn a_wall_on_the_left_is_followed_for_a_minute() {
    let following = built("wall_following", &of_plans("wall_following"));
    let run = run(&following, &["--world", "walled.toml", "--start", "2,5,0"]);
    assert!(run.lines.last().unwrap().contains(" s  plan over: wait 60s "), "{:?}", run.lines.last());
    assert!(run.trail[run.trail.len() - 1][0] >= 59.8, "contact after {} s", run.trail[run.trail.len() - 1][0]);
    let mut way = 0.0;
    for pair in run.trail.windows(2) {
        let ([_, x, y, heading], [t, to_x, to_y, _]) = (pair[0], pair[1]);
        way += libm::hypot(to_x - x, to_y - y);
        // The walls of the room, each with its direction and its distance from the robot.
        let walls = [(0.0, 8.0 - x), (90.0, 6.0 - y), (180.0, x), (-90.0, y)];
        let (_, near) = walls.into_iter().min_by(|one, other| one.1.total_cmp(&other.1)).unwrap();
        let on_the_left = walls.into_iter().any(|(direction, distance)| {
            let bearing = (direction - heading + 180.0_f64).rem_euclid(360.0) - 180.0;
            distance <= 1.5 && (20.0..=160.0).contains(&bearing)
        });
        assert!(t < 5.0 || (0.4..=1.2).contains(&near), "{near} m from the wall at {t} s, ({x}, {y}) {heading}");
        assert!(t < 5.0 || on_the_left, "no wall on the left at {t} s, ({x}, {y}) {heading}");
    }
    assert!(way >= 8.0, "{way} m");
}

#[test]
fn the_branching_plan_steps_aside_at_an_obstacle() {
    let branching = built("branching_aside", &of_plans("branching"));
    let run = run(&branching, &["--world", "post.toml", "--start", "0,0,0"]);
    let trail = run.relative();
    let [ahead, left, turned] = trail[trail.len() - 1];
    assert!((ahead - (1.7 - 0.8 - 0.2)).abs() <= 0.15, "{ahead} m ahead");
    assert!((left - 0.8).abs() <= 0.1 && turned.abs() <= 4.0, "{left} m to the left, turned by {turned} degrees");
}

#[test]
fn the_first_plan_drives_ahead_and_turns_left() {
    let first = built("first", &of_book("first_plan.md", "first.mdle"));
    let run = run(&first, &["--world", "across.toml", "--start", "0,0,0"]);
    let trail = run.relative();
    let [ahead, left, turned] = trail[trail.len() - 1];
    assert!((1.5..=2.2).contains(&ahead) && left.abs() <= 0.1, "{ahead} m ahead, {left} m to the left");
    assert!((turned - 90.0).abs() <= 4.0, "{turned} degrees");
}

#[test]
fn the_sides_of_the_guide_lead_where_they_say() {
    let sides = all_of_book("own_plan.md", "side.mdle");
    let [point, metre] = &sides[..] else { panic!("{} sides", sides.len()) };
    for (name, text, length, quarter) in [("point", point, 1.5, 0.0), ("side", metre, 1.0, 90.0)] {
        let run = run(&built(name, text), &["--world", "floor.toml", "--start", "6,5,30"]);
        let trail = run.relative();
        let [ahead, left, turned] = trail[trail.len() - 1];
        assert!(libm::hypot(ahead - length, left) <= 0.15, "{name}: {ahead} m ahead, {left} m to the left");
        assert!((turned - quarter).abs() <= 4.0, "{name}: {turned} degrees");
    }
}

#[test]
fn the_careful_square_turns_early_at_a_wall() {
    let careful = built("careful", &of_book("own_plan.md", "careful.mdle"));
    let sides = |world: &str| {
        let run = run(&careful, &["--world", world, "--start", "2,0,0"]);
        let (trail, turns) = (run.relative(), run.begins("turn 90"));
        let corner = |side: usize| turns.get(side).map(|time| trail[run.at(*time)]);
        [0_usize, 1].map(|side| {
            let from = side.checked_sub(1).map_or(trail[0], |before| corner(before).unwrap());
            let to = corner(side).unwrap();
            libm::hypot(to[0] - from[0], to[1] - from[1])
        })
    };
    let [first, second] = sides("floor.toml");
    assert!((first - 1.0).abs() <= 0.1 && (second - 1.0).abs() <= 0.1, "{first} m and {second} m");
    let [first, second] = sides("across.toml");
    assert!((0.2..=0.6).contains(&first) && (second - 1.0).abs() <= 0.1, "{first} m and {second} m before a wall");
}

/// In the maze, 53 of the Scouts with the seeds 1 to 240 arrive within five minutes.
#[test]
fn seven_metres_ahead_are_reached_round_obstacles() {
    let ahead = built("seven", &of_book("simulator.md", "ahead.mdle"));
    let worlds = [
        ("floor.toml", "0,0,0", "ideal", "1"),
        ("room", "0.7,0.7,45", "ideal", "1"),
        ("hall", "1.5,5,20", "scout", "1"),
        ("maze", "4.2,0.6,120", "scout", "42"),
    ];
    for (world, start, body, seed) in worlds {
        let run = run(&ahead, &["--world", world, "--start", start, "--body", body, "--seed", seed]);
        let trail = run.relative();
        let [ahead, left, _] = trail[trail.len() - 1];
        // The plan measures the distance by odometry, which has errors on a body such as the Scout's.
        let near = if body == "ideal" { 0.15 } else { 0.5 };
        assert!(libm::hypot(ahead - 7.0, left) <= near, "{world}: {ahead} m ahead, {left} m to the left");
        assert!(run.lines.last().unwrap().contains(" s  plan over: completed "), "{world}: {:?}", run.lines);
    }
}

#[test]
fn the_square_of_the_rover_has_four_sides_of_a_metre() {
    let square = built("rover_square", &of_book("own_robot.md", "square.mdle"));
    let run = run(&square, &["--world", "floor.toml", "--start", "6,5,30"]);
    let (trail, turns) = (run.relative(), run.begins("turn 90"));
    assert_eq!(turns.len(), 4);
    for (time, [x, y]) in turns.iter().zip([[1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.0, 0.0]]) {
        let [ahead, left, _] = trail[run.at(*time)];
        assert!(libm::hypot(ahead - x, left - y) <= 0.25, "({ahead}, {left}) is not ({x}, {y})");
    }
}

#[test]
fn the_yard_is_crossed_and_the_robot_turns_left() {
    let cross = built("cross", &of_book("worlds.md", "cross.mdle"));
    fs::write(cross.with_file_name("yard.toml"), of_book("worlds.md", "yard.toml")).unwrap();
    let run = run(&cross, &["--world", "yard.toml"]);
    assert!(run.lines.last().unwrap().contains(" s  plan over: completed "), "{:?}", run.lines);
    let trail = run.relative();
    let [_, _, turned] = trail[trail.len() - 1];
    assert!((turned - 90.0).abs() <= 4.0, "{turned} degrees");
    let through = run.trail.windows(2).find(|pair| pair[0][1] < 4.0 && pair[1][1] >= 4.0);
    assert!(through.is_some_and(|pair| pair[1][2] > 1.5 && pair[1][2] < 3.0), "{through:?}");
}

/// In a closed room the robot makes no progress in the first leg. The second leg gets its full time; a plan in rows
/// behaves in the same way.
#[test]
fn stuck_ends_a_leg_that_leads_nowhere() {
    let legs = of_book("quarks.md", "back_off.mdle");
    let in_rows = legs.replace("(bumper OR", "(RISING bumper OR");
    assert_ne!(legs, in_rows);
    let ends = [("legs", legs), ("legs_in_rows", in_rows)].map(|(name, text)| {
        let executable = built(name, &text);
        let closed = "[[wall]]\npoints = [[-1, -1.2], [1, -1.2], [1, 1.2], [-1, 1.2], [-1, -1.2]]\n";
        fs::write(executable.with_file_name("closed.toml"), closed).unwrap();
        let run = run(&executable, &["--world", "closed.toml"]);
        // The places in the plan's text are left out, because they differ.
        let places =
            |line: &String| line.split(" (").map(|part| part.split_once(')').map_or(part, |(_, rest)| rest)).collect();
        run.lines.iter().map(places).collect::<Vec<String>>()
    });
    assert_eq!(ends[0], ends[1]);
    insta::assert_snapshot!(ends[0].join("\n"));
}
