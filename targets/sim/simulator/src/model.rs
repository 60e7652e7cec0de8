//! Models of the simulated robots: their bodies, and the parts of a model that can be omitted.

mod figures;

use std::fmt;

use mdle_runtime::{Mount, Nanos, Radians, SonarId};

use crate::battery::Pack;
use crate::footprint::Form;
use figures::{atrv, ideal, scout};

/// A body to simulate.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Body {
    /// A body with the size and the motors of a Super Scout. All its sonars ping in every turn, and detect the nearest
    /// object in their cones. Its odometry has no errors.
    #[default]
    Ideal,
    /// A Nomadic Super Scout II. Its sonars fire one after the other, miss surfaces that they do not face, and have
    /// errors. Its wheels slip.
    Scout,
    /// An iRobot ATRV-mini: a rectangle of 0.63 m by 0.54 m with 24 sonars on four boards and skid steering.
    Atrv,
}

impl fmt::Display for Body {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Ideal => "ideal",
            Self::Scout => "scout",
            Self::Atrv => "atrv",
        })
    }
}

/// Parts of a body's model that can be omitted, in order to see their effect.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ModelPart {
    /// Lobe of a sonar. Without it, the sonar detects all objects in a cone of 25° equally well.
    Lobe,
    /// Mirror-like reflection by surfaces. Without it, sonars detect surfaces from any angle.
    Specular,
    /// Minimum range. Without it, the sonars detect objects at any distance.
    Minimum,
    /// Resolution of ranges. Without it, ranges are exact.
    Steps,
    /// Errors of ranges, and missed echoes. They need a random seed.
    Noise,
    /// Random ranges without meaning. They need a random seed.
    Outliers,
    /// Firing order, in which sonars ping one after another. Without it, all sonars ping in every turn.
    Order,
    /// Slip of the wheels. It needs a random seed.
    Slip,
}

/// All parts, with their names in command-line options.
pub const PARTS: [(&str, ModelPart); 8] = [
    ("lobe", ModelPart::Lobe),
    ("specular", ModelPart::Specular),
    ("minimum", ModelPart::Minimum),
    ("steps", ModelPart::Steps),
    ("noise", ModelPart::Noise),
    ("outliers", ModelPart::Outliers),
    ("order", ModelPart::Order),
    ("slip", ModelPart::Slip),
];

/// Model of a body, with all data that are needed to simulate it.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Model {
    pub(crate) drive: Drive,
    pub(crate) hearing: Hearing,
    /// Number of bumper switches, which are evenly spaced around the body, counter-clockwise from the front.
    pub(crate) switches: u8,
    pub(crate) pack: Pack,
}

/// Wheels and outline of a body, in metres and seconds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Drive {
    /// Form of the body.
    pub(crate) form: Form,
    /// Distance between the wheels, in metres.
    pub(crate) wheel_base: f64,
    /// Maximum speed of a wheel, in m/s.
    pub(crate) fastest: f64,
    /// Acceleration of a wheel, in m/s².
    pub(crate) acceleration: f64,
    /// Unit of commanded wheel speeds, in m/s. Speeds are rounded towards zero to whole numbers of this unit.
    pub(crate) unit: f64,
    /// Errors of odometry; `None` for odometry without errors.
    pub(crate) slip: Option<Slip>,
}

/// Errors of odometry, as standard deviations of normal distributions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Slip {
    /// Relative error of the driven distance. It is drawn once for a run, and represents the size of the tyres.
    pub(crate) way: f64,
    /// Relative error of the angle by which the robot turns. It is drawn once for a run, and represents uncertainty
    /// about where the wheels touch the floor.
    pub(crate) turn: f64,
    /// Error of the heading, in radians per driven metre. It is drawn once for a run, and represents unequal wheels.
    pub(crate) bend: f64,
    /// Standard deviation of the heading's random error after one metre, in radians. It grows with the square root of
    /// the distance.
    pub(crate) wander: f64,
}

/// Model of the sonars, in metres and radians.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Hearing {
    pub(crate) transducers: Vec<Transducer>,
    /// Distance from the centre at which laws assume the transducers to be, in metres.
    pub(crate) ring_radius: f64,
    /// Distance between two points on a wall beside the robot, in metres: the points that reflect the pings of the two
    /// neighbours of the sonar that faces the wall. `None` if ranges are too coarse to measure a heading.
    pub(crate) beside_apart: Option<f64>,
    /// Angle between the outermost rays and the axis.
    pub(crate) half_cone: Radians,
    /// Maximum angle off the axis at which a sonar detects a surface that faces it; `None` means the angle of the
    /// outermost rays.
    pub(crate) lobe: Option<Radians>,
    /// Maximum angle between the sonar's axis and the normal of a surface on the axis at which the sonar detects the
    /// surface; `None` means any angle.
    pub(crate) facing: Option<Radians>,
    pub(crate) least: f64,
    pub(crate) most: f64,
    /// Resolution of ranges, in metres; ranges are rounded down to it. The value 0 means exact ranges.
    pub(crate) step: f64,
    /// Standard deviation of a range's error, in metres.
    pub(crate) spread: f64,
    /// Maximum relative error that all ranges of a run have in common. Its cause is the temperature of the air.
    pub(crate) scale: f64,
    /// Standard deviation of the loudness of an echo, as a fraction of the minimum loudness for detecting it.
    pub(crate) fading: f64,
    /// Fraction of pings without an echo, at any distance.
    pub(crate) misses: f64,
    /// Fraction of pings with a random range.
    pub(crate) outliers: f64,
    /// Groups of transducers that ping together, and the time between two groups; `None` if all transducers ping in
    /// every turn.
    pub(crate) order: Option<FiringOrder>,
}

/// Firing order: the groups of transducers that ping together. One group pings after another.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct FiringOrder {
    pub(crate) groups: Vec<Vec<usize>>,
    pub(crate) gap: Nanos,
}

/// A sonar transducer on the body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Transducer {
    /// Distance of the transducer ahead of the body's centre, in metres.
    pub(crate) x: f64,
    /// Distance of the transducer to the left of the body's centre, in metres.
    pub(crate) y: f64,
    pub(crate) bearing: Radians,
    /// Sonar to which the transducer belongs, among the paper's sixteen sonars.
    pub(crate) sonar: SonarId,
    /// Mount of the transducer relative to its sonar; `None` if it is in the place of its sonar on the ring.
    pub(crate) mount: Option<Mount>,
}

impl Transducer {
    /// Returns a transducer at `x` metres ahead and `y` metres to the left of the centre, on a body whose ring of
    /// sonars has the radius `ring`.
    fn at((x, y): (f64, f64), bearing: Radians, sonar: SonarId, ring: f64) -> Self {
        let is_on_the_ring = bearing == sonar.bearing() && (libm::hypot(x, y) - ring).abs() < 1e-9;
        let mount = (!is_on_the_ring).then(|| Mount::of(x, y, bearing, sonar));
        Self { x, y, bearing, sonar, mount }
    }
}

impl Hearing {
    /// Converts a range from the transducer with this number to a range from the ring: measured along the transducer's
    /// axis from the point nearest to the centre, minus the ring's radius.
    pub(crate) fn of_ring(&self, range: f64, number: usize) -> f64 {
        match self.transducers.get(number) {
            Some(Transducer { x, y, bearing, mount: Some(_), .. }) => {
                let (sin, cos) = libm::sincos(bearing.0);
                (x * cos + y * sin + range - self.ring_radius).max(0.0)
            }
            Some(Transducer { mount: None, .. }) | None => range,
        }
    }
}

/// Angle between the axis and the edge of a sonar's cone, for sonars without a lobe.
const HALF_CONE: Radians = Radians::from_degrees(12.5);

impl Model {
    /// Creates the model of a body without the given parts.
    pub(crate) fn of(body: Body, without: &[ModelPart]) -> Self {
        let mut model = match body {
            Body::Ideal => ideal(),
            Body::Scout => scout(),
            Body::Atrv => atrv(),
        };
        for part in without {
            model.leave_out(*part);
        }
        model
    }

    fn leave_out(&mut self, part: ModelPart) {
        let Self { drive, hearing, .. } = self;
        match part {
            ModelPart::Lobe => (hearing.lobe, hearing.half_cone) = (None, HALF_CONE),
            ModelPart::Specular => hearing.facing = None,
            ModelPart::Minimum => hearing.least = 0.0,
            ModelPart::Steps => hearing.step = 0.0,
            ModelPart::Noise => {
                (hearing.spread, hearing.scale, hearing.fading, hearing.misses) = (0.0, 0.0, 0.0, 0.0);
            }
            ModelPart::Outliers => hearing.outliers = 0.0,
            ModelPart::Order => hearing.order = None,
            ModelPart::Slip => {
                drive.slip = drive.slip.map(|_| Slip { way: 0.0, turn: 0.0, bend: 0.0, wander: 0.0 });
            }
        }
    }
}
