//! Tests `FRAME here` on simulated robots (docs/src/reference/semantics.md, 3.4).
#![allow(clippy::expect_used, reason = "a test fails by panicking")]

use std::time::Duration;

use mdle_runtime::PathStore;
use mdle_sim::{Body, World};

use crate::driven::{plans, robot};

/// A floor with a single wall, far away.
const FLOOR: &str = "[[wall]]\npoints = [[-20, -20], [20, -20]]\n";

/// The laws correct the heading by walls. Far from any wall they have nothing to correct it by, however small the angle
/// between the frame and the first heading.
#[test]
fn a_frame_far_from_walls_is_the_heading_at_its_entry() {
    let world = World::parse("floor.toml", FLOOR).expect("a world");
    for (body, degrees) in [Body::Ideal, Body::Scout, Body::Atrv].into_iter().flat_map(|body| [(body, 10), (body, 19)])
    {
        let text = format!(
            "{{ Turned (wait 1min) (Atom (null) turn {degrees}) (Atom (wait 2s) stop)\n\
             FRAME here {{ Back (null) (Atom (null) rotate 0) }} }}\n"
        );
        let plan = plans("turned.mdle", &text).remove(0);
        let drive = plan.drive(robot(body, &world, 1), PathStore::EMPTY, Duration::from_secs(60));
        let before = drive.ends.get(1).expect("the end of the second atom");
        let turned = (drive.pose.theta.degrees() - before.theta.degrees()).abs();
        assert!(drive.is_over && turned < 3.0, "{body}, {degrees}: {:?}", drive.ends);
    }
}
