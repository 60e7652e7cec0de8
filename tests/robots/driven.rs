//! Loads a plan from text, and drives the simulated robot with the plan turn by turn.

#![allow(clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::sync::Arc;
use std::time::Duration;

use mdle_compiler::Compiled;
use mdle_compiler::load::{Loaded, load};
use mdle_runtime::capability::Bumpers as _;
use mdle_runtime::{Machine, Meters, Nanos, PathStore, Plan as _, Pose, Radians, Robot as _, Transition, Turn};
use mdle_runtime::{Twist, Watch};
use mdle_sim::{Body, Make, Simulated, World, alphabet};
use mdle_tests::chance::Chance;
use mdle_tests::golden;
use mdle_tests::repository::TextFile;

const PERIOD: Duration = Duration::from_millis(100);
/// Maximum offset of a start from the world's start: along each axis in metres, and of the heading in degrees.
const OFF: [f64; 2] = [0.05, 3.0];

/// A loaded plan, which can be driven any number of times.
pub(crate) struct Driven {
    pub(crate) name: String,
    loaded: Arc<Loaded<alphabet::Alphabet>>,
}

/// The begin of a contact.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Contact {
    /// Time of the plan, in seconds.
    pub(crate) t: f64,
    /// Law of the current atom.
    pub(crate) law: String,
    /// Interrupt of the current atom.
    pub(crate) interrupt: String,
    pub(crate) pose: Pose,
}

/// Result of a run that is over or reached its time limit.
pub(crate) struct Drive {
    pub(crate) contacts: Vec<Contact>,
    /// Last pose of the robot.
    pub(crate) pose: Pose,
    /// Poses of the robot at the ends of atoms.
    pub(crate) ends: Vec<Pose>,
    /// `true` if the plan is over.
    pub(crate) is_over: bool,
}

/// Returns the plans of a file that the simulator can run, except plans that read modules or other robots.
pub(crate) fn plans(path: &str, text: &str) -> Vec<Driven> {
    let file = TextFile { path: path.to_owned(), text: text.to_owned() };
    let (sources, target) = (golden::sources(&file).0, golden::alphabet(Some("sim")));
    let plans = golden::judge(&file, Some("sim")).0;
    let load = |Compiled { plan, machine, .. }: Compiled| Driven {
        name: plan.root.name,
        loaded: Arc::new(load(&machine, &sources, &target).expect("a plan for the simulator")),
    };
    // A plan that reads modules or other robots needs an engine.
    let is_alone = |driven: &Driven| {
        let plan = driven.loaded.plan();
        plan.reads().is_empty() && plan.robots().is_empty()
    };
    plans.into_iter().map(load).filter(is_alone).collect()
}

/// Number of transitions in a turn.
struct Ends(usize);

impl Watch for Ends {
    fn transition(&mut self, _: Transition) {
        self.0 += 1;
    }
}

/// Returns a robot with this body near the start of `world`. An ideal body has no sensor and wheel errors.
pub(crate) fn robot(body: Body, world: &World, seed: u64) -> Simulated {
    let make = Make { body, seed: (body != Body::Ideal).then_some(seed), ..Make::default() };
    let mut chance = Chance::new(seed);
    let mut within = |most: f64| most * (chance.below(20_001) as f64 / 10_000.0 - 1.0);
    let Pose { x, y, theta } = world.start;
    for _ in 0..100 {
        let [dx, dy, turned] = [within(OFF[0]), within(OFF[0]), within(OFF[1].to_radians())];
        let start = Pose { x: Meters(x.0 + dx), y: Meters(y.0 + dy), theta: Radians(theta.0 + turned) };
        if let Ok(robot) = Simulated::with(&make, world, start, PERIOD) {
            return robot;
        }
    }
    panic!("{body} cannot stand at the start");
}

/// Returns the first random seed of a test: the number in the variable `MDLE_FIRST`, or `usual` if it is not set.
pub(crate) fn first_seed(usual: u64) -> u64 {
    std::env::var("MDLE_FIRST").map_or(usual, |text| text.parse().expect("a whole number"))
}

impl Driven {
    /// Drives the robot until the plan is over, for at most the time `most`.
    pub(crate) fn drive(&self, mut robot: Simulated, paths: PathStore, most: Duration) -> Drive {
        robot.paths = paths;
        let (mut input, mut machine, mut ends) = (Twist::default(), None, Vec::new());
        let (mut contacts, mut touches, mut is_over) = (Vec::new(), false, false);
        for turn in 0..most.as_millis() / PERIOD.as_millis() {
            let y = robot.exchange(&input).expect("finite inputs");
            let t = Nanos(turn as u64 * 100_000_000);
            let machine = machine.get_or_insert_with(|| Machine::begin(self.loaded.plan(), &y, t));
            if y.pressed() && !touches {
                let (plan, atom) = (machine.plan(), machine.atom().expect("an atom"));
                let scope = plan.fsm().atoms[atom as usize].scope;
                let (law, interrupt) = (plan.law(atom).to_owned(), plan.condition(scope).to_owned());
                contacts.push(Contact { t: t.seconds(), law, interrupt, pose: robot.pose() });
            }
            touches = y.pressed();
            let mut ended = Ends(0);
            let step = machine.turn(&y, t, &mut ended);
            ends.extend(std::iter::repeat_n(robot.pose(), ended.0));
            is_over = matches!(step, Turn::Over);
            if is_over {
                break;
            }
            input = step.input();
        }
        Drive { contacts, pose: robot.pose(), ends, is_over }
    }
}
