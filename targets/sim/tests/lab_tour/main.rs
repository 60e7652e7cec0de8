//! Tests the paper's tour from lab 2 through lab 1 to the office, on the floor made for it (paper, section V, Fig. 10).
#![allow(clippy::expect_used, clippy::print_stdout, reason = "a test fails by panicking, and tells how many arrived")]

mod plan;

use std::fmt::Write;
use std::path::PathBuf;
use std::time::Duration;

use mdle_host::clap::Command;
use mdle_host::{Ended, Observer as _, StopRequest, Target, view_options};
use mdle_runtime::{Machine, Meters, Nanos, Plan, Pose, Radians, Robot, Transition, Turn, Twist, Watch};
use mdle_sim::{Body, Make, Observed, Sim, Simulated, World};
use plan::Tour;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

const PERIOD: Duration = Duration::from_millis(100);
/// Number of turns after which a run counts as failed: ten minutes.
const TURNS: u64 = 6000;

/// The end of an atom.
struct End {
    atom: u64,
    at: f64,
    by: String,
    pose: Pose,
}

impl End {
    /// Returns the heading at the end of the atom, in degrees from 0 to 360.
    fn heading(&self) -> f64 {
        self.pose.theta.degrees().rem_euclid(360.0)
    }

    /// Returns the difference between the heading at the end of the atom and `heading`, in degrees.
    fn off(&self, heading: f64) -> f64 {
        Radians::from_degrees(self.heading() - heading).wrapped().degrees().abs()
    }
}

#[derive(Default)]
struct Watched(Vec<Transition>);

impl Watch for Watched {
    fn transition(&mut self, transition: Transition) {
        self.0.push(transition);
    }
}

/// Runs the tour; returns the ends of the atoms, in order.
fn run(robot: &mut Observed) -> Vec<End> {
    let mut input = Twist::default();
    let mut machine = None;
    let mut ends = Vec::new();
    for turn in 0..TURNS {
        let y = robot.exchange(&input).expect("finite inputs");
        let t = Nanos(turn * 100_000_000);
        let machine = machine.get_or_insert_with(|| Machine::begin(Tour::new(), &y, t));
        let mut watched = Watched::default();
        let step = machine.turn(&y, t, &mut watched);
        if let Some(atom) = machine.atom().filter(|_| turn == 0 || !watched.0.is_empty()) {
            robot.began(machine.state(), machine.plan().law(atom), t);
        }
        for transition in watched.0 {
            let by = transition.by(machine.plan()).to_owned();
            ends.push(End { atom: transition.from, at: t.seconds(), by, pose: robot.pose() });
        }
        let over = matches!(step, Turn::Over);
        input = step.input();
        if over {
            // Same text as in the executable that draws the picture of the book.
            let by = "completed (lab_tour.mdle:30)";
            robot.ended(&Ended { plan: "LabTour", is_over: true, by, t });
            break;
        }
    }
    robot.exchange(&Twist::default()).expect("finite inputs");
    robot.stop().expect("a simulated stop");
    robot.finish().expect("the plot is written");
    ends
}

fn tour(start: Pose, seed: Option<u64>) -> Vec<End> {
    let world = World::office().expect("our own floor");
    run(&mut Simulated::new(&world, start, seed, PERIOD).expect("a start on the floor").into())
}

/// Returns the robot that an executable creates from these options.
fn connected(options: &[&str]) -> Observed {
    let matches = Sim::arguments(view_options(Command::new("tour").no_binary_name(true))).get_matches_from(options);
    Sim::connect(&matches, PERIOD, &StopRequest::default()).expect("good options")
}

fn table(ends: &[End]) -> String {
    ends.iter().fold(String::new(), |mut table, end| {
        let End { atom, at, by, pose } = end;
        let (x, y, heading) = (pose.x.0, pose.y.0, end.heading());
        writeln!(table, "{atom:>2}  {at:>5.1} s  {by:<15}  {x:>5.2}  {y:>5.2}  {heading:>3.0}").expect("a string");
        table
    })
}

/// Zone in which the robot has to be when an atom ends.
struct Zone {
    x: [f64; 2],
    y: [f64; 2],
    /// Required heading and its tolerance, in degrees; `None` for any heading.
    heading: Option<[f64; 2]>,
}

/// Returns the zone in which an atom has to end; `None` if its end is not checked.
fn zone(atom: u64) -> Option<Zone> {
    let (a_b, b_c) = (([-0.9, 0.9], [4.0, 5.5]), ([6.7, 8.3], [3.9, 5.6]));
    let (lab_1, corner) = (([6.7, 8.3], [-0.2, 0.8]), ([6.7, 8.3], [-0.9, 0.25]));
    let office_door = ([11.05, 11.95], [-0.9, 0.9]);
    let ((x, y), heading) = match atom {
        1 => (a_b, None),
        2 => (a_b, Some([0.0, 35.0])),
        4 => (b_c, None),
        5 => (b_c, Some([270.0, 35.0])),
        8 => (lab_1, None),
        9 => (corner, None),
        10 => (corner, Some([0.0, 35.0])),
        12 => (office_door, None),
        13 => (office_door, Some([270.0, 15.0])),
        _ => return None,
    };
    Some(Zone { x, y, heading })
}

/// Returns the errors of a tour; empty if every atom ended in its zone.
fn faults(ends: &[End]) -> Vec<String> {
    let mut faults = Vec::new();
    if ends.iter().map(|end| end.atom).ne(1..=13) {
        faults.push(format!("the atoms that ended are {:?}", ends.iter().map(|end| end.atom).collect::<Vec<_>>()));
    }
    for end in ends {
        let Some(zone) = zone(end.atom) else { continue };
        let (x, y) = (end.pose.x.0, end.pose.y.0);
        let within = |[least, most]: [f64; 2], value| (least..=most).contains(&value);
        let on_course = zone.heading.is_none_or(|[heading, allowed]| end.off(heading) <= allowed);
        if !within(zone.x, x) || !within(zone.y, y) || !on_course {
            faults.push(format!("atom {} ended at ({x:.2}, {y:.2}), heading {:.0}", end.atom, end.heading()));
        }
    }
    faults
}

/// Returns a start pose that deviates by up to 10 cm and 5 degrees from the ideal one.
fn off(seed: u64) -> Pose {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut within = |most: f64| most * ((random.next_u64() >> 11) as f64 / (1_u64 << 52) as f64 - 1.0);
    Pose { x: Meters(within(0.1)), y: Meters(within(0.1)), theta: Radians::from_degrees(within(5.0)) }
}

/// Returns the number of tours with these seeds that arrive; prints the errors of the others.
fn arrived(seeds: std::ops::Range<u64>, noisy: bool) -> usize {
    let count = seeds.clone().count();
    let arrived = seeds.filter(|seed| {
        let faults = faults(&tour(off(*seed), noisy.then_some(*seed)));
        if !faults.is_empty() {
            println!("start {seed}, noise {noisy}: {faults:?}");
        }
        faults.is_empty()
    });
    let arrived = arrived.count();
    println!("{arrived} of {count} arrived, noise {noisy}");
    arrived
}

#[test]
fn every_atom_ends_in_its_zone_by_its_cause() {
    let ends = tour(Pose::ORIGIN, None);
    assert_eq!(faults(&ends), Vec::<String>::new());
    insta::assert_snapshot!(table(&ends), @"
     1   23.2 s  atIsection 0100   0.04   4.30   90
     2   36.8 s  atIsection 0010   0.04   4.32    1
     3   37.4 s  completed         0.04   4.32  360
     4   74.1 s  atIsection 1000   7.02   4.78  359
     5   87.7 s  atIsection 0100   7.04   4.78  271
     6   88.1 s  completed         7.04   4.78  271
     7   95.1 s  wait 7            7.13   3.49  296
     8  111.0 s  atIsection 1000   7.40   0.43  270
     9  113.4 s  atIsection 1001   7.40  -0.05  270
    10  118.0 s  atIsection 0011   7.40  -0.07  359
    11  118.2 s  completed         7.40  -0.07    0
    12  137.7 s  atIsection 0100  11.24  -0.06    0
    13  140.8 s  completed        11.27  -0.06  271
    ");
}

#[test]
fn a_start_that_is_a_little_off_arrives_too() {
    assert_eq!(arrived(0..100, false), 100);
}

/// Beside a door jamb, no heading has equal ranges; from this start, `align 11 13` once never ended.
#[test]
fn a_tour_past_a_jamb_ends() {
    let start = Pose { x: Meters(-0.08), y: Meters(0.06), theta: Radians::from_degrees(-4.0) };
    assert_eq!(faults(&tour(start, None)), Vec::<String>::new());
}

#[test]
fn noisy_sonars_arrive_too() {
    assert_eq!(arrived(0..3, true), 3);
}

/// A Scout with all its errors. Of seeds 0..200, 196 arrive, and of 30000..30300, 297.
#[test]
fn a_scout_arrives_whose_sonars_fire_in_turn_and_miss_and_whose_wheels_slip() {
    let world = World::office().expect("our own floor");
    let arrived = (0..20).filter(|seed| {
        let make = Make { body: Body::Scout, seed: Some(*seed), ..Make::default() };
        let robot = Simulated::with(&make, &world, off(*seed), PERIOD).expect("a start on the floor");
        let faults = faults(&run(&mut robot.into()));
        println!("scout {seed}: {faults:?}");
        faults.is_empty()
    });
    assert!(arrived.count() >= 19);
}

/// In batches with the seeds 10492000 to 10492299, which were not used to tune parameters, a Scout arrives in 299, 299,
/// 299 and 294 tours where walls have `rough` 0, 0.25, 0.5 and 1, and an ATRV-mini in all 300 of each.
#[test]
fn both_bodies_arrive_however_rough_walls_are() {
    let office = include_str!("../../worlds/office.toml");
    for (body, seeds) in [(Body::Scout, 100..106), (Body::Atrv, 200..206)] {
        for (rough, least) in [(0.0, 5), (1.0, 4)] {
            let world = World::parse("office", &format!("rough = {rough}\n{office}")).expect("our own floor");
            let arrived = seeds.clone().filter(|seed| {
                let make = Make { body, seed: Some(*seed), ..Make::default() };
                let robot = Simulated::with(&make, &world, off(*seed), PERIOD).expect("a start on the floor");
                let faults = faults(&run(&mut robot.into()));
                println!("{body} {seed}, rough {rough}: {faults:?}");
                faults.is_empty()
            });
            assert!(arrived.count() >= least, "{body}, rough {rough}");
        }
    }
}

#[test]
fn the_same_options_draw_the_same_bytes() {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR"));
    let plots = ["one.svg", "other.svg"].map(|name| {
        let path = folder.join(name);
        let shown = path.to_str().expect("a target folder in UTF-8");
        assert_eq!(run(&mut connected(&["--plot", shown, "--start=0.02,-0.03,2", "--seed", "7"])).len(), 13);
        std::fs::read_to_string(&path).expect("the plot was written")
    });
    assert_eq!(plots[0], plots[1]);
    for text in ["goAvoid 90 40 20", "rotate 90", "x in m"] {
        assert!(plots[0].contains(text), "{text}");
    }
}

/// The picture in the book was drawn by an executable that mdlec built, that is, with optimisation and with the emitted
/// plan.
#[test]
fn the_book_shows_the_tour_as_it_is_driven_without_optimisation() {
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("office.svg");
    let shown = path.to_str().expect("a target folder in UTF-8");
    run(&mut connected(&["--body", "scout", "--seed", "1", "--plot", shown]));
    let drawn = std::fs::read_to_string(&path).expect("the plot was written");
    assert!(drawn == include_str!("../../../../docs/src/office.svg"), "this build drives otherwise: see {shown}");
}
