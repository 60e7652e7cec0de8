//! Models of the simulated robots: bodies, and the parts of them that can be left out.

mod figures;

use std::fmt;

use mdle_runtime::{Nanos, Radians, SonarId};

use crate::battery::Pack;
use crate::footprint::Form;
use figures::{atrv, ideal, scout};

/// A body to simulate.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Body {
    /// The size and the motors of a Super Scout, whose sonars all ping in every turn and hear the nearest object in
    /// their cones, and whose odometry has no errors.
    #[default]
    Ideal,
    /// A Nomadic Super Scout II: its sonars fire in turn, miss what they do not face, and err; its wheels slip.
    Scout,
    /// An iRobot ATRV-mini, a rectangle of 0.63 m by 0.54 m: 24 sonars on four boards, skid steering.
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

/// Parts of a body that can be left out, to see their effect.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Part {
    /// The lobe of a sonar: without it everything in a cone of 25° is heard alike.
    Lobe,
    /// Surfaces that reflect like mirrors: without it they are heard from any angle.
    Specular,
    /// Minimum range: without it the sonars hear objects at any distance.
    Minimum,
    /// The steps in which ranges come: without them ranges are exact.
    Steps,
    /// Errors of ranges and missed echoes, which take a seed.
    Noise,
    /// Ranges that mean nothing, which take a seed.
    Outliers,
    /// Firing order: sonars ping one after another; without it all of them ping in every turn.
    Order,
    /// The slip of the wheels, which takes a seed.
    Slip,
}

/// All parts with the names that options give them.
pub const PARTS: [(&str, Part); 8] = [
    ("lobe", Part::Lobe),
    ("specular", Part::Specular),
    ("minimum", Part::Minimum),
    ("steps", Part::Steps),
    ("noise", Part::Noise),
    ("outliers", Part::Outliers),
    ("order", Part::Order),
    ("slip", Part::Slip),
];

/// Everything needed to simulate a body.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Model {
    pub(crate) drive: Drive,
    pub(crate) hearing: Hearing,
    /// Bumper switches: number `i` of them lies at `i` parts of a circle counter-clockwise from the front.
    pub(crate) switches: u8,
    pub(crate) pack: Pack,
}

/// Wheels and outline. Metres and seconds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Drive {
    /// Form of the body.
    pub(crate) form: Form,
    /// The distance between the wheels.
    pub(crate) wheel_base: f64,
    /// Maximum speed of a wheel.
    pub(crate) fastest: f64,
    /// Acceleration of a wheel.
    pub(crate) acceleration: f64,
    /// Wheel speeds are commanded in whole numbers of this, rounded towards zero.
    pub(crate) unit: f64,
    /// `None` for odometry without errors.
    pub(crate) slip: Option<Slip>,
}

/// Errors of odometry: standard deviations of normal distributions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Slip {
    /// Relative error of the way driven, drawn once for a run: the size of the tyres.
    pub(crate) way: f64,
    /// Relative error of the angle turned, drawn once for a run: the points at which the wheels touch the floor.
    pub(crate) turn: f64,
    /// Error of the heading, in radians for each metre driven, drawn once for a run: wheels that are not quite alike.
    pub(crate) bend: f64,
    /// Error of the heading, in radians, after a metre driven; grows with the square root of the way.
    pub(crate) wander: f64,
}

/// The sonars. Metres and radians.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Hearing {
    pub(crate) transducers: Vec<Transducer>,
    /// The distance from the centre at which laws take the transducers to be.
    pub(crate) ring_radius: f64,
    /// Distance, on a wall beside the robot, between the places that the two neighbours of the sonar square to it hear,
    /// in metres; `None` if ranges are too coarse to measure a heading.
    pub(crate) beside_apart: Option<f64>,
    /// Angle of the outermost rays from the axis.
    pub(crate) half_cone: Radians,
    /// Maximum angle off the axis at which something that faces the sonar is heard; `None` for the angle of the
    /// outermost ray.
    pub(crate) lobe: Option<Radians>,
    /// Maximum angle between the axis and the normal of a surface on it at which the surface is heard; `None`: any
    /// angle.
    pub(crate) facing: Option<Radians>,
    pub(crate) least: f64,
    pub(crate) most: f64,
    /// Ranges are whole numbers of this, rounded down; 0 for exact ones.
    pub(crate) step: f64,
    /// The spread of a range's error.
    pub(crate) spread: f64,
    /// Maximum common error of all ranges of a run, as a fraction: it depends on the temperature of the air.
    pub(crate) scale: f64,
    /// Standard deviation of the loudness of an echo, as a part of the loudness needed to hear it.
    pub(crate) fading: f64,
    /// The share of pings that bring no echo, at any distance.
    pub(crate) misses: f64,
    /// The share of pings that bring a random range.
    pub(crate) outliers: f64,
    /// Groups of transducers that ping together, in order, and the time between two groups; `None`: all ping in every
    /// turn.
    pub(crate) order: Option<Order>,
}

/// Transducers that ping together, one group after the other.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Order {
    pub(crate) groups: Vec<Vec<usize>>,
    pub(crate) gap: Nanos,
}

/// A sonar on the body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Transducer {
    /// Forward and to the left of the centre.
    pub(crate) x: f64,
    pub(crate) y: f64,
    pub(crate) bearing: Radians,
    /// The direction, of the paper's sixteen, that it speaks for.
    pub(crate) sonar: SonarId,
}

/// Angle from the axis of a cone without a lobe to its edge.
const HALF_CONE: Radians = Radians::from_degrees(12.5);

impl Model {
    /// The model of a body without some of its parts.
    pub(crate) fn of(body: Body, without: &[Part]) -> Self {
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

    fn leave_out(&mut self, part: Part) {
        let Self { drive, hearing, .. } = self;
        match part {
            Part::Lobe => (hearing.lobe, hearing.half_cone) = (None, HALF_CONE),
            Part::Specular => hearing.facing = None,
            Part::Minimum => hearing.least = 0.0,
            Part::Steps => hearing.step = 0.0,
            Part::Noise => {
                (hearing.spread, hearing.scale, hearing.fading, hearing.misses) = (0.0, 0.0, 0.0, 0.0);
            }
            Part::Outliers => hearing.outliers = 0.0,
            Part::Order => hearing.order = None,
            Part::Slip => {
                drive.slip = drive.slip.map(|_| Slip { way: 0.0, turn: 0.0, bend: 0.0, wander: 0.0 });
            }
        }
    }
}
