//! The live view of `--watch`. It shows the floor with the robot on it, the current atom, and the elapsed time of each
//! scope.

mod canvas;
mod map;
mod screen;
mod view;

use std::time::{Duration, Instant};

use clap::ArgMatches;
use mdle_runtime::{Nanos, Sensed};
use mdle_simulator::{Footprint, Form, Point, World};

use crate::PlanPosition;
use map::Map;
use screen::Screen;

/// Restores the terminal if the live view uses it. May be called from any thread.
pub(crate) fn leave_screen() {
    screen::leave_at_once();
}

/// Name of the option for the live view.
pub(crate) const WATCH: &str = "watch";

/// Returns `true` if the options request the live view.
pub(crate) fn is_asked_for(matches: &ArgMatches) -> bool {
    matches.get_flag(WATCH)
}

/// Minimum time between two pictures; the eye cannot see faster changes.
const EVERY: Duration = Duration::from_millis(50);

/// The live view that the option `--watch` requests.
pub struct Watch {
    screen: Option<Screen>,
    world: World,
    map: Option<Map>,
    /// Positions on the driven path so far, at least a centimetre apart.
    way: Vec<Point>,
    echoes: Vec<Point>,
    /// Displacement of each moving object of the world; `None` for an open door.
    things: Vec<Option<Point>>,
    /// Time of the robot's last output.
    sensed: Option<Nanos>,
    /// Shape of the robot's body.
    form: Form,
    now: view::Now,
    shown: Option<Instant>,
}

impl Watch {
    /// Returns the live view of a robot in `world` on standard output; `None` if the options do not request it. The
    /// view takes over the screen at the first turn.
    ///
    /// # Errors
    /// Returns a message if standard output is not a terminal.
    pub fn of(matches: &ArgMatches, world: &World) -> Result<Option<Self>, String> {
        if !is_asked_for(matches) {
            return Ok(None);
        }
        if !screen::is_there() {
            let hint = "run it in a terminal, or make a picture with --plot or --record";
            return Err(format!("--watch: standard output is not a terminal; {hint}"));
        }
        Ok(Some(Self {
            screen: None,
            world: world.clone(),
            map: None,
            way: Vec::new(),
            echoes: Vec::new(),
            things: Vec::new(),
            sensed: None,
            form: Form::Disc { radius: 0.0 },
            now: view::Now::default(),
            shown: None,
        }))
    }

    /// Updates the pose of the robot's body, the robot's output, and the displacement of each moving object of the
    /// world.
    pub fn sensed(&mut self, body: &Footprint, sensed: &Sensed, t: Nanos, things: impl Iterator<Item = Option<Point>>) {
        let Footprint { pose, form } = body;
        let place = Point::of(pose);
        if self.way.last().is_none_or(|last| libm::hypot(last.x - place.x, last.y - place.y) >= 0.01) {
            self.way.push(place);
        }
        self.echoes.clear();
        self.echoes.extend(mdle_simulator::echoes(pose, sensed, self.sensed.replace(t)).into_iter().flatten());
        self.things.clear();
        self.things.extend(things);
        (self.now.pose, self.form) = (*pose, *form);
    }

    /// Updates the number of contacts so far; `touches` is `true` if the robot touches an obstacle now.
    pub fn touched(&mut self, touches: bool, contacts: u64) {
        (self.now.touches, self.now.contacts) = (touches, contacts);
    }

    /// Shows a turn if a new picture is due. If the walls are not known, `echoes` contains the positions of all echoes
    /// so far.
    pub fn turned(&mut self, standing: &PlanPosition<'_>, echoes: &[Point]) {
        if self.shown.is_some_and(|shown| shown.elapsed() < EVERY) {
            return;
        }
        self.shown = Some(Instant::now());
        self.now.stands(standing);
        let screen = self.screen.get_or_insert_with(Screen::enter);
        let (columns, rows) = screen::size();
        let below = self.now.below(columns);
        let (wide, high) = (columns, rows.saturating_sub(below.len() + 1));
        let fits = |map: &Map| map.is_of(wide, high) && map.shows(Point::of(&self.now.pose)) && map.shows_new(echoes);
        if !self.map.as_ref().is_some_and(fits) {
            self.map = Some(Map::of(&self.world, &self.way, echoes, wide, high));
        }
        let Some(map) = &mut self.map else { return };
        map.draw_way(&self.way);
        map.draw_echoes(echoes);
        let mut lines = vec![self.now.above(columns)];
        let things = self.world.things.iter().zip(&self.things).filter_map(|(thing, gone)| Some((thing, (*gone)?)));
        let mut now = map.with(things);
        now.draw_current_echoes(&self.echoes);
        lines.extend(now.rows(&Footprint { pose: self.now.pose, form: self.form }, self.now.touches));
        lines.extend(below);
        lines.truncate(rows);
        screen.show(&lines);
    }

    /// Restores the screen.
    pub fn leave(&mut self) {
        self.screen = None;
    }
}
