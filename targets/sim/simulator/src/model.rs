//! Models of the simulated robots: bodies, and the parts of bodies that can be left out.

mod figures;

use std::fmt;

use mdle_runtime::{Mount, Nanos, Radians, SonarId};

use crate::battery::Pack;
use crate::footprint::Form;
use figures::{atrv, ideal, scout};

/// A body to simulate.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Body {
    /// A body with the size and the motors of a Super Scout. All its sonars ping in every turn and hear the nearest
    /// object in their cones, and its odometry has no errors.
    #[default]
    Ideal,
    /// A Nomadic Super Scout II. Its sonars fire in turn, miss surfaces that they do not face, and have errors;
    /// its wheels slip.
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

/// Parts of a body's model that can be left out to see their effect.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ModelPart {
    /// Lobe of a sonar. Without it, all objects in a cone of 25° are heard equally.
    Lobe,
    /// Mirror-like reflection of surfaces. Without it, surfaces are heard from any angle.
    Specular,
    /// Minimum range. Without it, the sonars hear objects at any distance.
    Minimum,
    /// Resolution of ranges. Without it, ranges are exact.
    Steps,
    /// Errors of ranges and missed echoes, which need a seed.
    Noise,
    /// Random ranges without meaning, which need a seed.
    Outliers,
    /// Firing order, in which sonars ping one after another. Without it, all sonars ping in every turn.
    Order,
    /// Slip of the wheels, which needs a seed.
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

/// Model of a body: everything needed to simulate it.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Model {
    pub(crate) drive: Drive,
    pub(crate) hearing: Hearing,
    /// Number of bumper switches, which are evenly spaced around the body, counter-clockwise from the front.
    pub(crate) switches: u8,
    pub(crate) pack: Pack,
}

/// Wheels and outline, in metres and seconds.
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
    /// Unit of commanded wheel speeds, in m/s; speeds are rounded towards zero to whole numbers of this unit.
    pub(crate) unit: f64,
    /// Errors of odometry; `None` for odometry without errors.
    pub(crate) slip: Option<Slip>,
}

/// Errors of odometry, as standard deviations of normal distributions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Slip {
    /// Relative error of the distance driven, drawn once for a run; it represents the size of the tyres.
    pub(crate) way: f64,
    /// Relative error of the angle turned, drawn once for a run; it represents uncertainty about where the wheels touch
    /// the floor.
    pub(crate) turn: f64,
    /// Error of the heading, in radians per metre driven, drawn once for a run; it represents unequal wheels.
    pub(crate) bend: f64,
    /// Standard deviation of the heading's random error after a metre driven, in radians; it grows with the square root
    /// of the distance.
    pub(crate) wander: f64,
}

/// Model of the sonars, in metres and radians.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Hearing {
    pub(crate) transducers: Vec<Transducer>,
    /// Distance of the transducers from the centre, as laws assume it, in metres.
    pub(crate) ring_radius: f64,
    /// Distance, along a wall beside the robot, between the points that the two neighbours of the sonar facing the wall
    /// hear, in metres; `None` if ranges are too coarse to measure a heading.
    pub(crate) beside_apart: Option<f64>,
    /// Angle of the outermost rays from the axis.
    pub(crate) half_cone: Radians,
    /// Maximum angle off the axis at which a surface that faces the sonar is heard; `None` for the angle of the
    /// outermost rays.
    pub(crate) lobe: Option<Radians>,
    /// Maximum angle between the axis and the normal of a surface on the axis at which the surface is heard;
    /// `None` for any angle.
    pub(crate) facing: Option<Radians>,
    pub(crate) least: f64,
    pub(crate) most: f64,
    /// Resolution to which ranges are rounded down, in metres; 0 for exact ranges.
    pub(crate) step: f64,
    /// Standard deviation of a range's error, in metres.
    pub(crate) spread: f64,
    /// Maximum common relative error of all ranges of a run, caused by the temperature of the air.
    pub(crate) scale: f64,
    /// Standard deviation of the loudness of an echo, as a fraction of the loudness needed to hear it.
    pub(crate) fading: f64,
    /// Fraction of pings without an echo, at any distance.
    pub(crate) misses: f64,
    /// Fraction of pings with a random range.
    pub(crate) outliers: f64,
    /// Groups of transducers that ping together, and the time between two groups; `None` if all transducers ping in
    /// every turn.
    pub(crate) order: Option<Order>,
}

/// Firing order: groups of transducers that ping together, one group after another.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Order {
    pub(crate) groups: Vec<Vec<usize>>,
    pub(crate) gap: Nanos,
}

/// A sonar transducer on the body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Transducer {
    /// Position ahead of the centre, in metres.
    pub(crate) x: f64,
    /// Position to the left of the centre, in metres.
    pub(crate) y: f64,
    pub(crate) bearing: Radians,
    /// The sonar, of the paper's sixteen, to which the transducer belongs.
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

/// Angle between the axis and the edge of a cone without a lobe.
const HALF_CONE: Radians = Radians::from_degrees(12.5);

impl Model {
    /// Returns the model of a body without some of its parts.
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
