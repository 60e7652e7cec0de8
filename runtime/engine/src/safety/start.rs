//! Warns about a robot that starts outside a fence or within its margin.

use mdle_runtime::Pose;

use super::plane::{between, nearest};
use super::{Fence, Rules};

impl Rules {
    /// Returns a sentence for each fence that stops a robot at its start; `pose` is the start pose by odometry.
    #[must_use]
    pub fn held_at_start(&self, pose: &Pose) -> Vec<String> {
        self.fences.iter().filter_map(|fence| fence.held_at_start(pose)).collect()
    }
}

impl Fence {
    /// Returns a sentence if the fence stops a robot that starts at this pose; `None` otherwise.
    fn held_at_start(&self, pose: &Pose) -> Option<String> {
        let here @ [x, y] = [pose.x.0, pose.y.0];
        let Self { name, margin, .. } = self;
        // Adding zero converts -0 to 0.
        let place = format!("x = {:.2} m, y = {:.2} m", x + 0.0, y + 0.0);
        if !self.contains(here) {
            return Some(format!(
                "the robot starts outside `{name}`, at {place} by odometry: it may turn, and drive only towards the \
                 nearest edge"
            ));
        }
        let to_edges = self.edges().map(|edge| between(here, nearest(here, edge)));
        let distance = to_edges.map(|[x, y]| libm::hypot(x, y)).fold(f64::INFINITY, f64::min);
        (distance < *margin).then(|| {
            format!(
                "the robot starts within the margin of `{name}`, at {place} by odometry: it may turn, and drive only \
                 away from the edge"
            )
        })
    }
}
