//! The simulated robot: a body and sonars in a world. Each exchange advances them by one period.

use std::fmt;
use std::sync::Arc;
use std::time::Duration;

use mdle_runtime::capability::Steering;
use mdle_runtime::{Compass, Meters, Nanos, PathStore, Pose, Published, Robot, Sensed, Shape, Supply, Twist};

use crate::battery::Battery;
use crate::body::{Body, STEP};
use crate::charger::Charger;
use crate::footprint::{Footprint, Form};
use crate::model::{self, Model, ModelPart};
use crate::point::Point;
use crate::sonar::{Heard, Ring};
use crate::start::{self, StartError};
use crate::walls::{Others, Walls};
use crate::world::World;

/// A robot in a world.
pub struct Simulated {
    walls: Walls,
    body: Body,
    ring: Ring,
    /// Constants of the body, which all robots with the same body share.
    shape: Arc<Shape>,
    /// Drift of the robot's odometry, measured at walls.
    compass: Compass,
    battery: Battery,
    /// Charger of the world. It is on the heap, because few worlds have one.
    charger: Option<Box<Charger>>,
    /// Recorded paths that the plan can replay.
    pub paths: PathStore,
    /// Number of bumper switches.
    switches: u8,
    period: Duration,
    /// Number of exchanges so far. The first exchange is at time 0.
    exchanges: u64,
}

/// Settings of a simulated robot, apart from its world.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Make {
    /// Kind of body to simulate, such as [`model::Body::Scout`].
    pub body: model::Body,
    /// Parts of the body's model that are omitted.
    pub without: Vec<ModelPart>,
    /// Random seed for sensor and wheel errors; `None` for a robot without errors.
    pub seed: Option<u64>,
}

impl Make {
    /// Returns the form of the body.
    #[must_use]
    pub fn form(&self) -> Form {
        Model::of(self.body, &self.without).drive.form
    }
}

/// Reason why an exchange failed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Fault {
    /// The input is not finite, because a law has computed an invalid value.
    Input,
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Input => write!(f, "the plan asked for a speed that is not a number"),
        }
    }
}

impl std::error::Error for Fault {}

fn nanos(period: Duration) -> Nanos {
    Nanos(u64::try_from(period.as_nanos()).unwrap_or(u64::MAX))
}

impl Simulated {
    /// Creates a robot with an ideal body, at rest at `start` in `world`, where its odometry is zero. Its sonars are
    /// exact; if a random seed is given, they are noisy.
    ///
    /// # Errors
    /// Fails if the robot cannot start at `start`.
    pub fn new(world: &World, start: Pose, seed: Option<u64>, period: Duration) -> Result<Self, StartError> {
        Self::with(&Make { seed, ..Make::default() }, world, start, period)
    }

    /// Creates a robot with the settings `make`, at rest at `start` in `world`, where its odometry is zero.
    ///
    /// # Errors
    /// Fails if the robot cannot start at `start`.
    pub fn with(make: &Make, world: &World, start: Pose, period: Duration) -> Result<Self, StartError> {
        let walls = Walls::of(world);
        let Model { drive, hearing, switches, pack } = Model::of(make.body, &make.without);
        start::check(&start, drive.form, world, &walls)?;
        let (half_length, half_width) = drive.form.halves();
        let shape = Shape {
            body_radius: Meters(drive.form.radius()),
            half_length: Meters(half_length),
            half_width: Meters(half_width),
            sonars_apart: hearing.beside_apart.map(Meters),
            wheel_base: Meters(drive.wheel_base),
            ring_radius: Meters(hearing.ring_radius),
            confirmation: if hearing.order.is_some() { 2 } else { 3 },
            steering: Steering::USUAL,
        };
        Ok(Self {
            walls,
            body: Body::new(drive, start, make.seed),
            ring: Ring::new(hearing, make.seed, nanos(period)),
            shape: Arc::new(shape),
            compass: Compass::default(),
            battery: Battery::new(pack, 1.0),
            charger: world.charger.map(Box::new),
            paths: PathStore::EMPTY,
            switches,
            period,
            exchanges: 0,
        })
    }

    /// Creates another robot, at rest at `start`, with the body, the world and the current battery of this robot.
    ///
    /// # Errors
    /// Fails if the robot cannot start at `start` in `world`, which must be the world of this robot.
    pub fn another(&self, world: &World, start: Pose, seed: Option<u64>) -> Result<Self, StartError> {
        start::check(&start, self.footprint().form, world, &self.walls)?;
        Ok(Self {
            walls: self.walls.clone(),
            body: self.body.another(start, seed),
            ring: Ring::new(Arc::clone(&self.ring.hearing), seed, nanos(self.period)),
            shape: Arc::clone(&self.shape),
            compass: Compass::default(),
            battery: self.battery.clone(),
            charger: self.charger.clone(),
            exchanges: 0,
            ..*self
        })
    }

    /// Returns the maximum distance, in metres, between the robot's centre and the centre of a similar robot that its
    /// sonars can detect.
    #[must_use]
    pub fn hears(&self) -> f64 {
        let radius = self.footprint().form.radius();
        let offsets = self.ring.hearing.transducers.iter().map(|transducer| libm::hypot(transducer.x, transducer.y));
        offsets.fold(self.ring.hearing.ring_radius, f64::max) + self.ring.hearing.most + radius
    }

    /// Returns the maximum distance, in metres, between the centres of two similar robots that may touch in the next
    /// exchange.
    #[must_use]
    pub fn touches(&self) -> f64 {
        2.0 * (self.footprint().form.radius() + self.body.goes_most(self.period.as_secs_f64()))
    }

    /// Returns the robot's true pose on the floor, which only the simulator knows.
    #[must_use]
    pub fn pose(&self) -> Pose {
        self.body.pose
    }

    /// Sets the charge of the robot's battery, from 0 to 1. By default, the battery is full.
    #[must_use]
    pub fn charged(mut self, charge: f64) -> Self {
        self.battery.charge(charge);
        self
    }

    /// Sets the charge of the robot's battery from now on, from 0 to 1.
    pub fn set_charge(&mut self, charge: f64) {
        self.battery.charge(charge);
    }

    /// Sets the robot's supply from now on: the charge of its battery, from 0 to 1, and the charger of its world
    /// (`None` if the world has no charger).
    pub fn supply(&mut self, charge: f64, charger: Option<Charger>) {
        self.battery.charge(charge);
        self.charger = charger.map(Box::new);
    }

    /// Returns the battery and charger data that the robot measures.
    #[must_use]
    pub fn supplied(&self) -> Supply {
        self.battery.supply(self.is_plugged())
    }

    fn is_plugged(&self) -> bool {
        self.charger.as_ref().is_some_and(|charger| charger.holds(&self.body.pose))
    }

    /// Returns the area that the robot covers. Other robots detect and touch this area.
    #[must_use]
    pub fn footprint(&self) -> Footprint {
        self.body.footprint()
    }

    /// Returns the distance between the body and the nearest obstacle, in metres, or `reach` if that is less; negative
    /// if they overlap.
    #[must_use]
    pub fn gap(&self, reach: f64) -> f64 {
        self.walls.gap(&self.footprint(), reach)
    }

    /// Sets the positions of the other robots in the world. The robot detects them, and cannot pass through them.
    pub fn see(&mut self, others: &[Footprint]) {
        self.walls.put_others(others);
    }

    /// Exchanges the other robots, which this robot detects and cannot pass through, with those in `others`.
    pub fn swap_others(&mut self, others: &mut Others) {
        self.walls.swap_others(others);
    }

    /// Returns the last ping of each transducer, in the order of the body's model. These are the data of a robot's
    /// sonar boards, before a driver combines them into sixteen sonars; a body with only sixteen transducers has no
    /// such data.
    #[must_use]
    pub fn heard(&self) -> &[Heard] {
        &self.ring.heard
    }

    /// Returns the numbers of the sonars in the order in which they ping; `None` on a body whose sonars ping together.
    #[must_use]
    pub fn sonar_order(&self) -> Option<Vec<u8>> {
        self.ring.order()
    }

    /// Sets the sonars that ping one after another from the next exchange on. Has no effect on a body whose sonars ping
    /// together.
    pub fn order_sonars(&mut self, order: &[u8]) {
        if self.ring.order().is_some() {
            self.ring.reorder(order);
        }
    }

    /// Returns the displacement of each moving object of the world; `None` for an open door.
    pub fn gone(&self) -> impl Iterator<Item = Option<Point>> {
        self.walls.gone()
    }

    /// Returns the point of an obstacle that the body touches; the centre of the body if it touches no obstacle.
    pub(crate) fn touched(&self) -> Point {
        let at = Point::of(&self.body.pose);
        let body = self.footprint();
        self.walls.contact(&body, 0.1 * body.form.radius()).map_or(at, |contact| contact.place)
    }

    /// Returns the time of the next exchange.
    #[must_use]
    pub fn now(&self) -> Nanos {
        Nanos(self.exchanges.saturating_mul(nanos(self.period).0))
    }

    /// Drives for the period that ends at the time `now`. Each sonar pings when it is due.
    fn drive(&mut self, input: &Twist, now: Nanos) {
        let begins = Nanos(now.0.saturating_sub(nanos(self.period).0));
        if self.exchanges == 0 {
            // The first exchange: the plan and the moving objects begin at the end of this period.
            self.body.advance(input, self.period.as_secs_f64(), &self.walls);
            self.ring.warm_up(&self.body.pose, self.body.odometry(), &self.walls);
        } else if self.ring.due().is_none() {
            self.advance(input, self.period.as_secs_f64());
        } else {
            let mut here = begins;
            while let Some(due) = self.ring.due().filter(|due| *due <= now) {
                self.advance(input, due.since(here).seconds());
                here = due;
                self.ring.ping(&self.body.pose, self.body.odometry(), due, &self.walls);
            }
            self.advance(input, now.since(here).seconds());
        }
        if self.ring.due().is_none() {
            self.ring.ping(&self.body.pose, self.body.odometry(), now, &self.walls);
        }
    }

    /// Drives with `input` for one period. This is the first half of an exchange; [`Simulated::senses`] is the second.
    /// If several robots share a world, all of them move before the output of any of them is computed.
    ///
    /// # Errors
    /// Fails if the input is not finite.
    pub fn moves(&mut self, input: &Twist) -> Result<(), Fault> {
        if !(input.v.0.is_finite() && input.omega.0.is_finite()) {
            return Err(Fault::Input);
        }
        let standstill = Twist::default();
        self.drive(if self.battery.is_empty() { &standstill } else { input }, self.now());
        self.body.release();
        self.ring.release();
        if self.exchanges > 0 {
            let (is_plugged, seconds) = (self.is_plugged(), self.period.as_secs_f64());
            self.battery.passed(seconds, self.body.wheels() * seconds, is_plugged);
        }
        Ok(())
    }

    /// Returns the output after [`Simulated::moves`]; this is the second half of an exchange.
    pub fn senses(&mut self) -> Sensed {
        let now = self.now();
        self.exchanges = self.exchanges.saturating_add(1);
        let pings = self.ring.pings();
        self.compass.take(&pings, self.body.odometry(), &self.shape);
        Sensed {
            at: now,
            data_age: Nanos::ZERO,
            odometry: self.body.odometry(),
            velocity: self.body.velocity(),
            switches: self.body.pressed(self.switches, &self.walls),
            pings,
            compass: self.compass,
            supply: self.supplied(),
            shape: *self.shape,
            paths: self.paths,
            published: Published::NONE,
        }
    }

    /// Moves the robot and the moving objects of the world for a time of `seconds`.
    fn advance(&mut self, input: &Twist, seconds: f64) {
        if seconds <= 0.0 {
            return;
        }
        if !self.walls.move_at_all() {
            self.body.advance(input, seconds, &self.walls);
            return;
        }
        let steps = libm::ceil(seconds / STEP);
        for _ in 0..steps as u32 {
            self.walls.advance(seconds / steps, &self.body.footprint());
            self.body.advance(input, seconds / steps, &self.walls);
        }
    }
}

impl Robot for Simulated {
    type Output = Sensed;
    type Input = Twist;
    type Error = Fault;

    fn exchange(&mut self, input: &Twist) -> Result<Sensed, Fault> {
        self.moves(input)?;
        Ok(self.senses())
    }

    fn stop(&mut self) -> Result<(), Fault> {
        self.body.brake(&self.walls);
        Ok(())
    }
}
