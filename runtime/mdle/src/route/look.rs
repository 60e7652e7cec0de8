//! The look around at a landmark: the robot turns once on the spot, recognizes the landmark with the evidence grids of
//! all landmarks, and measures the directions of the landmark's axes (docs/src/navigation.md).

use std::path::Path;

use mdle_compiler::diagnostic::judged;
use mdle_compiler::fsm::Machine;
use mdle_files::{Input, Target, plan};
use mdle_runtime::{Meters, Pose, Printable, Radians, Sensed};

use crate::evidence::{Fit, GridPing, PingOrder, SavedMap, fit};
use crate::failure::{self, Failure};

/// Name of the plan of a look around.
pub(super) const LOOK: &str = "LookAround";
/// Maximum distance of the search from the expected pose along each axis, in steps of 10 cm, for a robot that has
/// driven to the landmark.
const WAYS: i16 = 6;
/// Maximum margin by which another landmark's score may exceed the score of the expected landmark. With a larger
/// margin, the robot is not at the expected landmark.
const MARGIN: f64 = 0.6;

/// The map of a landmark.
pub(crate) struct LandmarkMap {
    /// Name of the landmark.
    pub(crate) name: String,
    /// Angle, in degrees, from the x axis of the landmark where the route begins to the x axis of this landmark.
    pub(crate) turned: f64,
    /// Pose, in map coordinates, of a robot that is at the landmark and whose heading is along the landmark's x axis.
    pub(crate) at: Pose,
    pub(crate) map: SavedMap,
}

/// The compiled plan of a look around, and the maps for recognizing landmarks.
pub(crate) struct LookPlan {
    pub(crate) machine: Machine,
    pub(crate) input: Input,
    pub(crate) maps: Vec<LandmarkMap>,
}

impl LookPlan {
    /// Compiles the plan of a look around. Messages go to standard error.
    ///
    /// # Errors
    /// Fails if the plan does not compile for the target.
    pub(crate) fn of(maps: Vec<LandmarkMap>, graph: &Path, target: &Target) -> Result<Self, Failure> {
        let text = format!("{{ {LOOK} (bumper OR wait 1min)\n  (Atom (null) turn 360)\n}}\n");
        let mut input = plan(&graph.with_file_name(format!("{LOOK}.mdle")), text, target)?;
        let (plans, diagnostics) = input.compile(&target.alphabet, Some(LOOK));
        if let Err(sentence) = judged(&diagnostics, false) {
            failure::print(&input.sources, &diagnostics);
            return Err(Failure::OtherPlan(format!("{sentence} in the turn at landmarks")));
        }
        let named = plans.into_iter().map(|compiled| (compiled.plan.root.name, compiled.machine)).collect();
        let machine = input.only(named)?;
        Ok(Self { machine, input, maps })
    }
}

/// Echoes that a robot has received while it turned at a landmark.
pub(super) struct LookEchoes {
    /// Name of the landmark at which the robot should be.
    expected: String,
    /// `true` if the robot has driven to the landmark; `false` if it was placed there, with its heading along the
    /// landmark's x axis.
    has_driven: bool,
    order: PingOrder,
    pings: Vec<GridPing>,
    /// Pose by odometry.
    here: Pose,
}

/// The position of a robot at a landmark.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Stand {
    /// Offset of the robot from its expected pose in the landmark's map, along the axes of the map.
    pub(super) off: (Meters, Meters),
    /// Drift of the odometry heading since the route began.
    pub(super) drift: Radians,
}

impl LookEchoes {
    /// Begins the look around of a robot that should be at the landmark `expected`. `driven` is the output at the
    /// robot's arrival; `None` if the robot was placed there.
    pub(super) fn at(expected: &str, driven: Option<&Sensed>) -> Self {
        let mut order = PingOrder::new(Pose::ORIGIN);
        if let Some(y) = driven {
            // Pings that were heard on the way there belong to other places.
            order.take(y);
        }
        let has_driven = driven.is_some();
        Self { expected: expected.to_owned(), has_driven, order, pings: Vec::new(), here: Pose::ORIGIN }
    }

    /// Returns the name of the landmark at which the robot should be.
    pub(super) fn expected(&self) -> &str {
        &self.expected
    }

    /// Returns the pose of the robot by odometry.
    pub(super) fn here(&self) -> Pose {
        self.here
    }

    /// Stores the echoes in the output of a turn.
    pub(super) fn take(&mut self, y: &Sensed) {
        self.here = y.odometry;
        self.pings.extend(self.order.take(y));
    }

    /// Returns the position of the robot at the landmark. `drift` is the approximate drift of the odometry heading.
    ///
    /// # Errors
    /// Fails with a message if the robot is not at the landmark, or if no sonar received an echo.
    pub(super) fn stand(&self, maps: &[LandmarkMap], drift: Radians) -> Result<Stand, String> {
        let expected = Printable(&self.expected);
        let pings: Vec<GridPing> = self.pings.iter().map(|ping| self.around_the_robot(ping)).collect();
        let fits = maps.iter().filter_map(|landmark| {
            // After driving, odometry gives the axes of all landmarks. A robot that was placed heads along the first
            // axis of the landmark at which it is.
            let turned = if self.has_driven { landmark.turned } else { 0.0 };
            let axis = Radians::from_degrees(turned).0 + drift.0;
            let near = Pose { theta: Radians(landmark.at.theta.0 - axis), ..landmark.at };
            Some((landmark, fit(&landmark.map.grid, &pings, near, WAYS)?))
        });
        let (own, others): (Vec<_>, Vec<_>) = fits.partition(|(landmark, _)| landmark.name == self.expected);
        let Some((landmark, fit)) = own.first() else {
            return Err(format!("no sonar has heard anything at {expected}: nothing says that the robot is there"));
        };
        let (LandmarkMap { map, at, turned, .. }, Fit { origin, score, .. }) = (landmark, fit);
        if let Some((other, Fit { score: most, .. })) = best(&others).filter(|(_, best)| best.score > score + MARGIN) {
            let other = Printable(&other.name);
            let scores = format!("their scores are {most:.2} and {score:.2}");
            return Err(format!("the robot is at {other} and not at {expected}, by its maps: {scores}"));
        }
        if let Some(why) = map.objection(fit) {
            return Err(format!("the robot is not at {expected}, by its map: {why}"));
        }
        let off = (Meters(origin.x.0 - at.x.0), Meters(origin.y.0 - at.y.0));
        let axis = at.theta.0 - origin.theta.0;
        Ok(Stand { off, drift: Radians(axis - Radians::from_degrees(*turned).0).wrapped() })
    }

    /// Converts a ping to coordinates relative to the robot's position, because the search rotates pings about the
    /// origin.
    fn around_the_robot(&self, ping: &GridPing) -> GridPing {
        GridPing { x: ping.x - self.here.x.0, y: ping.y - self.here.y.0, ..*ping }
    }
}

/// Returns the best fit among the landmarks at which the robot may be; `None` if there is no such landmark.
fn best<'f>(fits: &'f [(&'f LandmarkMap, Fit)]) -> Option<&'f (&'f LandmarkMap, Fit)> {
    let fits = fits.iter().filter(|(landmark, fit)| landmark.map.objection(fit).is_none());
    fits.reduce(|best, other| if other.1.score > best.1.score { other } else { best })
}
