//! Tests the safety rules in the simulator, with plans that try to violate them.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::fmt::Write as _;
use std::sync::Arc;
use std::time::Duration;

use mdle_compiler::diagnostic::Sources;
use mdle_compiler::load::{Loaded, load};
use mdle_engine::safety::{Conditions, Envelope, GuardError, Rules, read};
use mdle_host::Verdict;
use mdle_runtime::{Machine, Nanos, Pose, Robot as _, Twist};
use mdle_sim::{Body, Make, Simulated, World};
use mdle_tests::chance::{Chance, repeated};
use mdle_tests::golden;
use mdle_tests::repository::TextFile;

/// Number of random plans for each body.
const PLANS: u64 = 20;
const PERIOD: Duration = Duration::from_millis(100);
const BODIES: [Body; 3] = [Body::Ideal, Body::Scout, Body::Atrv];

/// A turn of a run under safety rules.
#[derive(Debug)]
struct Turned {
    t: f64,
    /// Pose of the robot before the turn, followed by its speeds.
    pose: Pose,
    velocity: Twist,
    sent: Twist,
    verdict: Option<(Verdict, String)>,
}

/// Compiles and loads a plan for the simulated robot.
fn loaded(text: &str) -> Arc<Loaded<mdle_sim::alphabet::Alphabet>> {
    let file = TextFile { path: "plan.mdle".to_owned(), text: text.to_owned() };
    let (plans, messages) = golden::judge(&file, Some("sim"));
    let [plan] = plans.as_slice() else { panic!("{messages}") };
    Arc::new(load(&plan.machine, &golden::sources(&file).0, &golden::alphabet(Some("sim"))).unwrap())
}

/// Compiles the conditions of rules. `text` is the text of their file `s.toml`, which is added to the sources.
fn conditions(text: &str, rules: &Rules) -> (Sources, Result<Conditions<mdle_sim::alphabet::Alphabet>, GuardError>) {
    let mut sources = golden::sources(&TextFile { path: "plan.mdle".to_owned(), text: String::new() }).0;
    let compiled = Conditions::compile(("s.toml", text), &rules.guards, &mut sources, &golden::alphabet(Some("sim")));
    (sources, compiled)
}

/// Runs a plan under rules for `turns` turns, or until the plan is over or a rule ends it.
fn run(plan: &str, rules: &Rules, make: &Make, turns: u64) -> Vec<Turned> {
    let world = World::named("hall").unwrap().unwrap();
    let mut robot = Simulated::with(make, &world, world.start, PERIOD).unwrap();
    let mut conditions = conditions("", rules).1.unwrap().watch();
    let mut envelope = Envelope::new(rules.clone(), PERIOD);
    let plan = loaded(plan);
    let (mut input, mut machine) = (Twist::default(), None);
    let mut made = Vec::new();
    for turn in 0..turns {
        let (y, t) = (robot.exchange(&input).unwrap(), Nanos(turn * 100_000_000));
        let machine = machine.get_or_insert_with(|| Machine::begin(plan.plan(), &y, t));
        let turn = machine.turn(&y, t, &mut ());
        let is_over = machine.is_over();
        input = envelope.filter(turn.input(), &y, t, conditions.fired(&y, t));
        let verdict = envelope.intervention().map(|it| (it.verdict, it.rule.to_owned()));
        let is_ended = verdict.as_ref().is_some_and(|(verdict, _)| *verdict == Verdict::Ended);
        made.push(Turned { t: t.seconds(), pose: y.odometry, velocity: y.velocity, sent: input, verdict });
        if is_over || is_ended {
            break;
        }
    }
    made
}

/// Returns a line for each time at which a different rule, or no rule, began to overrule the plan, and a line about the
/// last turn.
fn story(run: &[Turned]) -> String {
    let mut story = String::new();
    let mut before = None;
    for turned in run {
        if Some(&turned.verdict) != before {
            let words =
                turned.verdict.as_ref().map_or("free".to_owned(), |(verdict, rule)| format!("{verdict:?} {rule}"));
            writeln!(story, "{:.1} s at {:.3} m: {words}", turned.t, turned.pose.x.0).unwrap();
        }
        before = Some(&turned.verdict);
    }
    let last = run.last().unwrap();
    writeln!(story, "{:.1} s at {:.3} m, sent {:.3} m/s", last.t, last.pose.x.0, last.sent.v.0).unwrap();
    story
}

/// Returns a robot with this body and without errors.
fn exact(body: Body) -> Make {
    Make { body, ..Make::default() }
}

fn rush(speed: &str) -> String {
    format!("{{ Rush (wait 20) (Atom (wait 12) (go {speed} 0)) (Atom (wait inf) (go -{speed} 0)) }}")
}

const FENCE: &str = "[[fence]]\ninside = [[-0.5, -0.5], [2, -0.5], [2, 0.5], [-0.5, 0.5]]\nmargin = \"3cm\"\n\
                     deceleration = \"0.5m/s2\"\n";

#[test]
fn a_plan_that_runs_at_a_fence_stops_at_its_margin() {
    let rules = read(FENCE).unwrap();
    let mut stories = String::new();
    for body in BODIES {
        for speed in ["20cm/s", "60cm/s", "1m/s"] {
            let run = run(&rush(speed), &rules, &exact(body), 200);
            let furthest = run.iter().map(|turned| turned.pose.x.0).fold(f64::NEG_INFINITY, f64::max);
            let back = run.iter().map(|turned| turned.pose.x.0).fold(f64::INFINITY, f64::min);
            assert!(furthest < 1.98 && furthest > 1.95, "{body:?} {speed}: {furthest}");
            assert!(back > -0.5 && run.last().unwrap().pose.x.0 < 0.5, "{body:?} {speed}: {back}");
            writeln!(stories, "{body:?}, {speed}: to {furthest:.3} m\n{}", story(&run)).unwrap();
        }
    }
    insta::assert_snapshot!(stories);
}

#[test]
fn a_limit_is_the_most_that_is_sent() {
    let rules = read("[limits]\nspeed = \"40cm/s\"\nturn_rate = \"30deg/s\"\nacceleration = \"0.5m/s2\"").unwrap();
    let plan = "{ P (wait 4) (Atom (wait 2) (go 90 60deg/s)) (Atom (wait inf) (go -90 -60deg/s)) }";
    let run = run(plan, &rules, &exact(Body::Ideal), 50);
    let sent: Vec<_> = run.iter().map(|turned| format!("{:.2}", turned.sent.v.0)).collect();
    let rate = 30_f64.to_radians() + 1e-12;
    assert!(run.iter().all(|turned| turned.sent.omega.0.abs() <= rate));
    insta::assert_snapshot!(sent.join(" "), @"
    0.05 0.10 0.15 0.20 0.25 0.30 0.35 0.40 0.40 0.40 0.40 0.40 0.40 0.40 0.40 0.40 0.40 0.40 0.40 0.40 -0.05 -0.10 -0.15 -0.20 -0.25 -0.30 -0.35 -0.40 -0.40 -0.40 -0.40 -0.40 -0.40 -0.40 -0.40 -0.40 -0.40 -0.40 -0.40 -0.40 0.00
    ");
    insta::assert_snapshot!(story(&run), @"
    0.0 s at 0.000 m: Limited acceleration
    0.8 s at 0.161 m: Limited speed
    2.0 s at 0.520 m: Limited acceleration
    2.8 s at 0.540 m: Limited speed
    4.0 s at 0.320 m: free
    4.0 s at 0.320 m, sent 0.000 m/s
    ");
}

#[test]
fn contact_holds_the_robot_as_the_rule_says() {
    let plan = "{ P (wait 40) (Atom (wait 30) (go 60 0)) (Atom (wait inf) (go -20 0)) }";
    let story = |then: &str| {
        let rules = read(&format!("[contact]\nthen = \"{then}\"")).unwrap();
        story(&run(plan, &rules, &exact(Body::Scout), 360))
    };
    insta::assert_snapshot!(story("hold"), @"
    0.0 s at 0.000 m: free
    27.5 s at 16.295 m: Held contact
    35.9 s at 16.295 m, sent 0.000 m/s
    ");
    insta::assert_snapshot!(story("hold forward"), @"
    0.0 s at 0.000 m: free
    27.5 s at 16.295 m: HeldForward contact
    30.0 s at 16.295 m: free
    35.9 s at 15.145 m, sent -0.200 m/s
    ");
    insta::assert_snapshot!(story("end"), @"
    0.0 s at 0.000 m: free
    27.5 s at 16.295 m: Ended contact
    27.5 s at 16.295 m, sent 0.000 m/s
    ");
}

#[test]
fn a_guard_is_a_condition_of_the_plan_language() {
    let guards = "[guards.near]\nwhen = \"r0 < 1m AND v > 5cm/s\"\nthen = \"hold forward\"\n\n\
                  [guards.far]\nwhen = \"x > 2m\"\nthen = \"end\"\n";
    let run = run(&rush("50cm/s"), &read(guards).unwrap(), &exact(Body::Scout), 150);
    insta::assert_snapshot!(story(&run), @"
    0.0 s at 0.000 m: free
    4.3 s at 2.019 m: Ended far
    4.3 s at 2.019 m, sent 0.000 m/s
    ");
}

#[test]
fn late_turns_and_stale_outputs_are_seen() {
    let rules = read("[stale]\noutput = \"400ms\"\nthen = \"hold\"\n[overrun]\nturns = 2\nthen = \"end\"").unwrap();
    let mut envelope = Envelope::new(rules, PERIOD);
    let world = World::named("hall").unwrap().unwrap();
    let mut robot = Simulated::with(&exact(Body::Ideal), &world, world.start, PERIOD).unwrap();
    let y = robot.exchange(&Twist::default()).unwrap();
    let mut verdict = |millis: u64| {
        envelope.filter(Twist::default(), &y, Nanos(millis * 1_000_000), &[]);
        envelope.intervention().map(|it| (it.verdict, it.rule.to_owned()))
    };
    let held = |rule: &str| Some((Verdict::Held, rule.to_owned()));
    assert_eq!([0, 100, 251, 400].map(&mut verdict), [const { None }; 4]);
    assert_eq!(verdict(500), held("stale"));
    assert_eq!(verdict(660), held("stale"));
    assert_eq!(verdict(820), Some((Verdict::Ended, "overrun".to_owned())));
}

#[test]
fn an_input_that_is_no_number_ends_the_plan() {
    let mut envelope = Envelope::new(Rules::default(), PERIOD);
    let world = World::named("hall").unwrap().unwrap();
    let mut robot = Simulated::with(&exact(Body::Ideal), &world, world.start, PERIOD).unwrap();
    let y = robot.exchange(&Twist::default()).unwrap();
    let mut nonsense = Twist::default();
    nonsense.omega.0 = f64::NAN;
    assert_eq!(envelope.filter(nonsense, &y, Nanos::ZERO, &[]), Twist::default());
    let intervention = envelope.intervention().unwrap();
    assert_eq!((intervention.verdict, intervention.rule), (Verdict::Ended, "not a number"));
}

#[test]
fn no_random_plan_passes_fence_or_limits() {
    let text = format!("[limits]\nspeed = \"70cm/s\"\nturn_rate = \"80deg/s\"\nacceleration = \"1m/s2\"\n{FENCE}");
    let rules = read(&text).unwrap();
    let mut near = 0;
    for seed in 0..repeated(PLANS) {
        let mut chance = Chance::new(seed);
        let plan = random_plan(&mut chance);
        for body in BODIES {
            let run = run(&plan, &rules, &exact(body), 600);
            for Turned { t, pose, sent, velocity, .. } in &run {
                let place = (pose.x.0, pose.y.0);
                let is_inside = place.0 > -0.5 && place.0 < 2.0 && place.1.abs() < 0.5;
                assert!(is_inside, "{body:?} is at {place:?} with {velocity:?} at {t} s: {plan}");
                assert!(sent.v.0.abs() <= 0.7 && sent.omega.0.abs() <= 80_f64.to_radians() + 1e-12, "{sent:?}: {plan}");
            }
            near += run.iter().filter(|turned| (turned.pose.x.0 - 2.0).abs() < 0.2).count();
        }
    }
    assert!(near > 200, "the fence was tried: {near}");
}

/// Corners of a fence with slanting edges and a corner that points inwards.
const SLANTING: [[f64; 2]; 5] = [[-0.5, -0.5], [2.0, -0.5], [2.0, 0.6], [0.8, 0.1], [-0.5, 0.5]];

/// Returns the distance of a place from the edges of `SLANTING`, in metres; negative if the place is outside.
fn inside_slanting([x, y]: [f64; 2]) -> f64 {
    let edges = || SLANTING.into_iter().zip(SLANTING.into_iter().cycle().skip(1));
    let crossed =
        edges().filter(|([ax, ay], [bx, by])| (*ay > y) != (*by > y) && x < ax + (bx - ax) * (y - ay) / (by - ay));
    let distances = edges().map(|([ax, ay], [bx, by])| {
        let [dx, dy] = [bx - ax, by - ay];
        let part = (((x - ax) * dx + (y - ay) * dy) / (dx * dx + dy * dy)).clamp(0.0, 1.0);
        libm::hypot(ax + part * dx - x, ay + part * dy - y)
    });
    let distance = distances.fold(f64::INFINITY, f64::min);
    if crossed.count() % 2 == 1 { distance } else { -distance }
}

#[test]
fn random_plans_keep_the_margin_of_a_slanting_fence() {
    let corners = SLANTING.map(|[x, y]| format!("[{x:?}, {y:?}]")).join(", ");
    let text = format!("[[fence]]\ninside = [{corners}]\nmargin = \"10cm\"\ndeceleration = \"50cm/s2\"\n");
    let rules = read(&text).unwrap();
    let mut nearest = f64::INFINITY;
    for seed in 0..repeated(PLANS) {
        let plan = random_plan(&mut Chance::new(1000 + seed));
        for body in BODIES {
            for Turned { pose, .. } in run(&plan, &rules, &exact(body), 600) {
                nearest = nearest.min(inside_slanting([pose.x.0, pose.y.0]));
            }
        }
    }
    assert!((0.098..0.105).contains(&nearest), "{nearest} m from the edges");
}

/// A robot that is asked to drive back and to turn at once, while it still rolls towards the edge, has to brake first.
#[test]
fn a_robot_that_reverses_at_a_fence_keeps_its_margin() {
    let rules = read(
        "[[fence]]\ninside = [[-0.5, -0.5], [2, -0.5], [2, 0.6], [-0.5, 0.5]]\nmargin = \"10cm\"\n\
                      deceleration = \"50cm/s2\"\n",
    );
    let plan = "{ Main (wait 9s) (Atom (wait 2500ms) (go -24 -6deg/s)) (Atom (wait 400ms) (go 10 0)) \
                (Atom (wait 800ms) (go -47 0)) (Atom (wait 1800ms) (go 46 0)) (Atom (wait 1300ms) (go 88 -93deg/s)) \
                (Atom (wait 100ms) (go 4 0)) (Atom (wait 1400ms) (go -86 82deg/s)) }";
    let run = run(plan, &rules.unwrap(), &exact(Body::Atrv), 90);
    let lowest = run.iter().map(|turned| turned.pose.y.0).fold(f64::INFINITY, f64::min);
    assert!((-0.402..-0.39).contains(&lowest), "{lowest} m, where -0.5 m is the edge");
}

/// Returns a random plan that drives straight and in circles at any speed.
fn random_plan(chance: &mut Chance) -> String {
    let mut plan = String::from("{ Main (wait 60)\n");
    for _ in 0..60 {
        let (v, omega) = (chance.below(201), chance.below(251));
        let [v, omega] = [v as i64 - 100, omega as i64 - 125];
        let omega = if chance.percent(40) { 0 } else { omega };
        writeln!(plan, "(Atom (wait {}ms) (go {v} {omega}deg/s))", 100 * (1 + chance.below(25))).unwrap();
    }
    plan + "}\n"
}

/// Returns the text of a safety file with a guard whose condition is `when`.
fn file_with(when: &str) -> String {
    format!("# safety\n\n[guards.near]\nwhen = \"{when}\"\nthen = \"hold\"\n")
}

#[test]
fn a_condition_has_the_warnings_of_a_plan() {
    let warned = |text: &str| {
        let (sources, compiled) = conditions(text, &read(text).unwrap());
        compiled.unwrap().warnings().iter().map(|warning| sources.render(warning)).collect::<String>()
    };
    let files = [
        file_with("r0 < 70"),
        file_with("NOT bumper OR r0 < 70 AND v > 5cm/s"),
        file_with("r0 < 70cm"),
        file_with("r0 < 0\\u00370 AND bumper"),
        "guards.near = { then = 'hold', when = '''\nbumper OR\n  r0 < 70''' }\n".to_owned(),
        format!("{}\n[guards.far]\nwhen = \"x > 5\"\nthen = \"end\"\n", file_with("bumper")),
    ];
    insta::assert_snapshot!(files.map(|file| format!("{file}\n{}", warned(&file))).join("\n"));
}

#[test]
fn a_condition_that_cannot_be_is_refused_with_its_place() {
    let refused = |when: &str| {
        let text = file_with(when);
        let (sources, compiled) = conditions(&text, &read(&text).unwrap());
        match compiled.unwrap_err() {
            GuardError::Faulty(diagnostics) => {
                diagnostics.iter().map(|diagnostic| sources.render(diagnostic)).collect::<String>()
            }
            GuardError::Unfit(line, sentence) => format!("{line}: {sentence}\n"),
            GuardError::Load(error) => error.to_string(),
        }
    };
    let conditions = [
        "r0 < 20kg",
        "bumber",
        "r0 < 20cm AND",
        "",
        "wait 3",
        "NOT way > 2m",
        "t > 3",
        "bumper OR RISING bumper",
        "bumper) (Atom (wait 1) stop",
        "stuck 3s",
    ];
    insta::assert_snapshot!(conditions.map(|when| format!("{when}\n{}", refused(when))).join("\n"));
}
