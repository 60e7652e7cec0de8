//! What plans claim of the way that the robot drives, held against the trail of a run: the plans of `plans/` and those of the
//! book that have a file name there.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

use std::fs;
use std::path::PathBuf;
use std::process::Command;

use mdle_tests::executable::{folder, run_mdlec};
use mdle_tests::repository::root;

/// A floor with one wall, far away.
const FLOOR: &str = "[[wall]]\npoints = [[-20, -20], [20, -20]]\n";

/// A row of a trail: seconds, metres, metres, degrees.
type Row = [f64; 4];

/// A run that is over.
struct Run {
    trail: Vec<Row>,
    /// The lines that the executable printed, each transition with its time.
    lines: Vec<String>,
}

/// A plan of the folder `plans`.
fn of_plans(name: &str) -> String {
    fs::read_to_string(root().join("plans").join(format!("{name}.mdle"))).unwrap()
}

/// A plan that a page of the book writes to this file.
fn of_book(page: &str, file: &str) -> String {
    let text = fs::read_to_string(root().join("docs/src").join(page)).unwrap();
    let blocks: Vec<_> = text.split(&format!("```mdle,{file}\n")).skip(1).collect();
    let block = blocks.last().unwrap_or_else(|| panic!("{page} writes no {file}"));
    block.split("```").next().unwrap().to_owned()
}

/// Builds a plan for the simulator.
fn built(name: &str, text: &str) -> PathBuf {
    let folder = folder(&format!("movement_{name}"));
    fs::write(folder.join(format!("{name}.mdle")), text).unwrap();
    fs::write(folder.join("floor.toml"), FLOOR).unwrap();
    let output = run_mdlec(&folder, &[&format!("{name}.mdle"), "--target", "sim"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    folder.join(name)
}

/// Runs a plan with these options, which may end it at a time.
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
    /// The trail as it is seen from the start: metres ahead, metres to the left, degrees turned to the left.
    fn relative(&self) -> Vec<[f64; 3]> {
        let [_, x0, y0, heading] = self.trail[0];
        let (sin, cos) = (libm::sin(heading.to_radians()), libm::cos(heading.to_radians()));
        let relative = self.trail.iter().map(|[_, x, y, at]| {
            let (dx, dy) = (x - x0, y - y0);
            [dx * cos + dy * sin, dy * cos - dx * sin, (at - heading + 180.0).rem_euclid(360.0) - 180.0]
        });
        relative.collect()
    }

    /// The place in the trail at this time.
    fn at(&self, seconds: f64) -> usize {
        self.trail.iter().position(|[t, ..]| *t >= seconds - 1e-9).unwrap_or(self.trail.len() - 1)
    }

    /// The times at which a law began, by the beginning of its text.
    fn begins(&self, law: &str) -> Vec<f64> {
        let lines = self.lines.iter().filter(|line| line.contains(&format!(" {law}")) && line.contains(" s  atom "));
        lines.map(|line| line.split(' ').find(|word| !word.is_empty()).unwrap().parse().unwrap()).collect()
    }
}

/// How often the robot came to within 30 cm of the far end of a way of this length, and back to within 30 cm of the start,
/// in turn; it never left the way by more than 30 cm.
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
        assert!(run.lines.last().unwrap().starts_with("plan over: completed"), "{:?}", run.lines);
    }
}

#[test]
fn the_legs_of_the_book_lead_there_and_back() {
    let legs_of_book = built("legs", &of_book("names.md", "legs.mdle"));
    let run = run(&legs_of_book, &["--world", "floor.toml", "--start", "6,5,30"]);
    let trail = run.relative();
    let short = run.at(run.begins("goAvoid 0 1 40")[0]);
    assert_eq!(legs(&trail[..short], 3.0, "the long leg"), (1, 1));
    let (there, back) = legs(&trail[short..], 1.0, "the short leg");
    assert!(there >= 4 && there - back <= 1, "{there} times there, {back} times back");
}

#[test]
fn a_frame_here_leads_ahead_and_back() {
    let ahead = built("ahead", &of_book("language.md", "ahead.mdle"));
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
