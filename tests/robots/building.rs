//! Tests two plans, written as a reader of the book would, in a building that was drawn after the control laws had been
//! written. Neither plan was changed after its first run.
//!
//! `MDLE_FIRST=7880000 MDLE_LONG=15` tries 300 seeds. With them, the ideal body and a Scout arrive in all runs, and an
//! ATRV-mini in 291 by measures and in 295 by landmarks.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::print_stdout, reason = "a test tells what happened")]

use std::time::Duration;

use mdle_runtime::{PathStore, Pose};
use mdle_sim::{Body, World};
use mdle_tests::chance::repeated;

use crate::driven::{first_seed, plans, robot};

const WORLD: &str = include_str!("building/world.toml");

/// A plan with distances that were measured on the floor plan: along the first corridor, along the second one, and
/// through the door.
const BY_MEASURES: &str = "{ ToTheStore (bumper OR wait 5min)
  (Atom (stuck 30s) (goAvoid 0 9.2m))
  (Atom (stuck 30s) (goAvoid 90 6m))
  (Atom (stuck 30s) (goAvoid 180 2m))
}
";

/// A plan by landmarks: to the corner, left, past the corner, to the first open door on the left, and in.
const BY_LANDMARKS: &str = "{ ToTheStore (bumper OR wait 5min)
  (Atom (atIsection 1001) (goAvoid 0 20 20))
  (Atom (atIsection 0011) (go 0 0.36))
  (Atom (null) rotate 90)
  (Atom (wait 7) (goAvoid 90 20 20))
  (Atom (atIsection 0001) (goAvoid 90 20 20))
  (Atom (null) rotate 180)
  (Atom (stuck 30s) (goAvoid 180 2m))
}
";

/// Returns the number of runs that arrive in the store without contact, and the number of all runs. The variable
/// `MDLE_FIRST` sets the first random seed.
fn arrived(text: &str, body: Body, count: u64) -> (u64, u64) {
    let world = World::parse("building/world.toml", WORLD).unwrap();
    let (plan, goal) = (plans("to_the_store.mdle", text).remove(0), world.goal.unwrap());
    let (first, count) = (first_seed(500), repeated(count));
    let mut arrived = 0;
    for seed in first..first + count {
        let drive = plan.drive(robot(body, &world, seed), PathStore::EMPTY, Duration::from_secs(400));
        if drive.is_over && drive.contacts.is_empty() && goal.holds(&drive.pose) {
            arrived += 1;
        } else {
            let place = |pose: &Pose| format!("({:.2}, {:.2}) {:.0}", pose.x.0, pose.y.0, pose.theta.degrees());
            let ends: Vec<_> = drive.ends.iter().map(place).collect();
            println!("{body} {seed}: over {}, ends {ends:?}, contacts {:?}", drive.is_over, drive.contacts);
        }
    }
    println!("{body}: {arrived} of {count} arrive\n{text}");
    (arrived, count)
}

fn assert_arrive(text: &str, body: Body, count: u64, share: u64) {
    let (arrived, count) = arrived(text, body, count);
    assert!(100 * arrived >= share * count, "{body}: {arrived} of {count}");
}

#[test]
fn a_plan_by_measures_arrives_in_a_new_building() {
    assert_arrive(BY_MEASURES, Body::Ideal, 20, 95);
    assert_arrive(BY_MEASURES, Body::Scout, 20, 95);
    assert_arrive(BY_MEASURES, Body::Atrv, 20, 80);
}

#[test]
fn a_plan_by_landmarks_arrives_in_a_new_building() {
    assert_arrive(BY_LANDMARKS, Body::Ideal, 20, 95);
    assert_arrive(BY_LANDMARKS, Body::Scout, 20, 95);
    assert_arrive(BY_LANDMARKS, Body::Atrv, 20, 95);
}
