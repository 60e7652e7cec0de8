//! The simulated robot as a target: a differential drive with bumper, odometry and sixteen sonars in a flat world.
//!
//! Generated code uses [`Target`], on which the host runs a plan, and [`alphabet`], the quarks of this robot. Tests and
//! tools use [`Observed`], and the items of `mdle-simulator`: [`World`], [`Simulated`], [`Make`] and [`Sensed`].
#![forbid(unsafe_code)]

mod observed;
mod options;
mod setup;
mod target;

pub use mdle_simulator::{
    Body, Charger, Crowd, Drawing, Fault, FleetDrawing, Footprint, Form, Goal, Groups, Heard, Input, Make, ModelPart,
    Others, Outline, Output, Point, RobotEars, Schedule, Sensed, SignalCurve, Simulated, Start, StartError, StartNoise,
    Thing, TimeChart, TripDrawing, Walls, Waypoint, World, WorldError, Zone, alphabet,
};
pub use observed::Observed;
pub use target::Sim;
/// The target on which the host runs a plan.
pub use target::Sim as Target;
