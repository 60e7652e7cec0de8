//! Local pursuit by three programs that are linked over TCP (paper, section IV-D), and their runs on emulated Scouts in
//! one world.

use std::cell::{Cell, RefCell};
use std::fs;
use std::net::SocketAddr;
use std::path::Path;
use std::process::{Child, Command, Output};
use std::rc::Rc;
use std::thread::sleep;
use std::time::{Duration, Instant};

use mdle_emulator::{Ailment, Embodied, Emulated, Pace, Port, Seat, Several};
use mdle_runtime::{Meters, Pose};
use mdle_scout_emulator::scout::Scout;
use mdle_sim::{Body, Footprint, Make, Simulated, World};

use crate::executable::mdle;
use crate::repository::root;
use crate::ways::{Point, excess};

/// Period of the robots.
pub const PERIOD: Duration = Duration::from_millis(100);
/// The robots, each with its name, its plan, its start on the first axis in metres, and the option that makes it record
/// its paths.
pub const ROBOTS: [(&str, &str, f64, &str); 3] = [
    ("robot1", "first_robot", 0.0, " --records lastPath --paths robot1"),
    ("robot2", "second_robot", -0.95, ""),
    ("robot3", "third_robot", -1.9, " --records lastPath --paths robot3"),
];
/// The floor on which the robots drive.
pub const FLOOR: &str =
    "start = { x = 0.0, y = 0.0, heading = 0.0 }\n[[wall]]\npoints = [[-6, -6], [9, -6], [9, 6], [-6, 6], [-6, -6]]";
/// Minimum real time that a step of an emulated robot takes in lockstep.
const SLOWER: Duration = Duration::from_millis(2);
/// Maximum real time for which the programs may run.
const LONGEST: Duration = Duration::from_secs(400);

/// Program of a robot: starts it in a folder, for the robot with this number and with options for its target.
pub type Begin<'p> = &'p dyn Fn(&Path, usize, &str) -> Child;

/// Writes the plans and the link file of each robot to a folder. The plans drive `laps` laps and have the timer
/// `timer`. Robot `own` connects to robot `other` at the address that `line` returns for `own`, `other` and the address
/// in `addresses` at which robot `other` listens.
pub fn prepare(
    folder: &Path,
    (laps, timer): (u64, &str),
    addresses: [SocketAddr; 3],
    line: &dyn Fn(usize, usize, SocketAddr) -> SocketAddr,
) {
    let plans = root().join("plans/pursuit");
    for (robot, plan, ..) in ROBOTS {
        fs::create_dir_all(folder.join(robot)).unwrap();
        let text = fs::read_to_string(plans.join(plan).with_extension("mdle")).unwrap();
        let text = text.replace("ExecPlan 4", &format!("ExecPlan {laps}")).replace("10min", timer);
        fs::write(folder.join(plan).with_extension("mdle"), text).unwrap();
    }
    fs::copy(plans.join("robot1/lastPath.csv"), folder.join("robot1/lastPath.csv")).unwrap();
    fs::write(folder.join("floor.toml"), FLOOR).unwrap();
    for (own, ((name, _, x, _), listen)) in ROBOTS.into_iter().zip(addresses).enumerate() {
        let mut text = format!("name = \"{name}\"\nlisten = \"{listen}\"\nkey = \"key\"\nstart = \"{x},0,0\"\n");
        for (other, ((name, ..), peer)) in ROBOTS.into_iter().zip(addresses).enumerate() {
            if other != own {
                text += &format!("[[robot]]\nname = \"{name}\"\naddress = \"{}\"\n", line(own, other, peer));
            }
        }
        fs::write(folder.join(format!("{name}-link.toml")), text).unwrap();
    }
}

/// The run of a robot.
pub struct Course {
    /// Exit status; `None` if the program was killed.
    pub status: Option<i32>,
    /// Standard output of the program, followed by its standard error.
    pub report: String,
    /// For each trip, `true` if the robot led it, and the robot's positions by odometry.
    trips: Vec<(bool, Vec<Point>)>,
}

impl Course {
    /// Waits for the end of a program, and returns its run. Asserts that the record of the run replays to the bit.
    pub fn of(folder: &Path, number: usize, child: Child) -> Self {
        let Output { status, stdout, stderr } = child.wait_with_output().unwrap();
        let [out, err] = [stdout, stderr].map(|bytes| String::from_utf8(bytes).unwrap());
        let log = format!("{}.mcap", ROBOTS[number].0);
        let replayed = Command::new(mdle()).args(["replay", &log]).current_dir(folder).output().unwrap();
        let replayed = String::from_utf8(replayed.stdout).unwrap();
        assert!(replayed.starts_with("the same to the bit, "), "{log}: {replayed}");
        let table = Command::new(mdle()).args(["log", "export", "--csv", &log]).current_dir(folder).output().unwrap();
        let table = String::from_utf8(table.stdout).unwrap();
        let places = table.lines().skip(1).map(|line| {
            let number = |column: usize| line.split(',').nth(column).unwrap().parse().unwrap();
            (number(1), [number(4), number(5)])
        });
        let trips = trips(&out, &places.collect::<Vec<_>>());
        Self { status: status.code(), report: out + &err, trips }
    }
}

/// Returns the trips that a robot made by `path` and `Follow`, according to its report. `places` contains the robot's
/// positions over time.
fn trips(report: &str, places: &[(f64, Point)]) -> Vec<(bool, Vec<Point>)> {
    let lines: Vec<(f64, &str)> = report
        .lines()
        .filter_map(|line| line.split_once(" s  "))
        .filter_map(|(time, rest)| Some((time.trim().parse().ok()?, rest)))
        .collect();
    let trip = |pair: &[(f64, &str)]| {
        let [(from, law), (to, _)] = pair else { return None };
        let is_led = law.starts_with("path");
        let within = places.iter().filter(|(t, _)| from <= t && t <= to).map(|(_, place)| *place);
        (is_led || law.starts_with("Follow")).then(|| (is_led, within.collect()))
    };
    lines.windows(2).filter_map(trip).collect()
}

/// Asserts that the paths of the robots have become straight, and prints by how much they exceed a straight line.
pub fn assert_converge(test: &str, courses: &[Course; 3], laps: u64) {
    let all = courses.iter().map(|course| course.report.as_str()).collect::<Vec<_>>().join("\n");
    for course in courses {
        assert_eq!(course.status, Some(0), "{all}");
        assert!(course.report.contains("plan over: completed"), "{all}");
    }
    let led = |robot: usize| courses[robot].trips.iter().filter(|(is_led, _)| *is_led).map(|(_, way)| excess(way));
    let leaders: Vec<f64> = led(0).zip(led(2)).flat_map(|(there, back)| [there, back]).collect();
    let seconds = courses[0].report.lines().rfind(|line| line.contains("plan over")).unwrap();
    let second: Vec<f64> = courses[1].trips.iter().map(|(_, way)| excess(way)).collect();
    println!("{test}: leaders {leaders:.1?} %, second robot {second:.1?} %, {seconds}");
    assert_eq!(leaders.len() as u64, 2 * laps, "{all}");
    assert!(leaders[0] >= 20.0 && leaders[2] <= 6.0 && leaders[3] <= 3.5, "{leaders:?}\n{all}");
    assert!(leaders.windows(3).all(|trips| trips[2] < trips[0]), "{leaders:?}\n{all}");
    if laps >= 4 {
        assert!(leaders[4] <= 2.0 && leaders[6] <= 1.0, "{leaders:?}\n{all}");
        assert!([&leaders[..5], &second[..6]].iter().all(|trips| trips.is_sorted_by(|one, next| next < one)), "{all}");
    }
}

/// A robot whose program is killed: its number, and the time of its world at which this happens.
pub type Victim = (usize, Duration);

/// An emulated Scout that adds the time of its steps to `time`.
struct Timed {
    scout: Scout,
    time: Rc<Cell<Duration>>,
    /// Minimum real time that a step takes.
    slower: Duration,
}

impl Emulated for Timed {
    fn push(&mut self, bytes: &[u8]) {
        self.scout.push(bytes);
    }

    fn obey(&mut self) -> Option<bool> {
        self.scout.obey()
    }

    fn pass(&mut self, time: Duration) -> Result<(), String> {
        self.time.set(self.time.get() + time);
        // In lockstep, the world would outrun the link, which runs in real time: states would be seconds late.
        sleep(self.slower);
        self.scout.pass(time)
    }

    fn take_frames(&mut self) -> Vec<Vec<u8>> {
        self.scout.take_frames()
    }

    fn can_suffer(ailment: Ailment) -> bool {
        Scout::can_suffer(ailment)
    }

    fn suffer(&mut self, ailment: Ailment) {
        self.scout.suffer(ailment);
    }
}

impl Embodied for Timed {
    fn footprint(&self) -> Footprint {
        self.scout.footprint()
    }

    fn see(&mut self, others: &[Footprint]) {
        self.scout.see(others);
    }
}

/// Runs the plans on three emulated Scouts in one world, and returns their runs. Programs that do not end within
/// `LONGEST` are killed.
pub fn on_scouts(folder: &Path, begin: Begin<'_>, pace: Pace, seed: u64, victim: Option<Victim>) -> [Course; 3] {
    let (world, time) = (World::parse("floor", FLOOR).unwrap(), Rc::new(Cell::new(Duration::ZERO)));
    let seat = |number: usize| {
        let make = Make { body: Body::Scout, without: Vec::new(), seed: Some(3 * seed + number as u64) };
        let start = Pose { x: Meters(ROBOTS[number].2), ..world.start };
        let body = Simulated::with(&make, &world, start, pace.step()).unwrap();
        let slower = if pace == Pace::Real { Duration::ZERO } else { SLOWER };
        let robot = Timed { scout: Scout::new(body).unwrap(), time: Rc::clone(&time), slower };
        Seat { robot, port: Port::open().unwrap() }
    };
    let mut robots = Several::of((0..3).map(seat).collect()).unwrap();
    let lockstep = if pace == Pace::Real { "" } else { "--lockstep" };
    let started = [0, 1, 2].map(|number| {
        let device = robots.seats()[number].port.path().display();
        begin(folder, number, &format!("--target scout {lockstep} --device {device}"))
    });
    let (children, begun) = (RefCell::new(started), Instant::now());
    let goes_on = || {
        let mut children = children.borrow_mut();
        // `time` is the sum for the three robots.
        if let Some((number, _)) = victim.filter(|(_, at)| time.get() / 3 >= *at) {
            // Killing a program again has no effect.
            children[number].kill().unwrap();
        }
        if begun.elapsed() > LONGEST {
            children.iter_mut().for_each(|child| child.kill().unwrap());
        }
        children.iter_mut().any(|child| child.try_wait().unwrap().is_none())
    };
    robots.serve(pace, &goes_on).unwrap();
    let mut number = 0;
    children.into_inner().map(|child| {
        number += 1;
        Course::of(folder, number - 1, child)
    })
}
