//! The views of a run by odometry. They show the driven path as the robot reports it, the echoes of the robot's sonars
//! as points, and the positions where atoms began.

use clap::ArgMatches;
use mdle_runtime::capability::Bumpers as _;
use mdle_runtime::{Nanos, Pose, Sensed};
use mdle_simulator::{Drawing, Footprint, Form, World};

use crate::background_writer::{Keeps, Outlet};
use crate::patience::Patience;
use crate::watch::Watch;
use crate::whole_file::{Unfinished, WholeFile};
use crate::{Ended, Observer, PlanPosition};

/// Observer of a robot whose world is unknown.
pub(crate) struct ByOdometry {
    /// Text that describes the run in titles.
    setup: String,
    watch: Option<Watch>,
    plot: Option<WholeFile>,
    record: Option<WholeFile>,
    trail: Option<OdometryTable>,
    /// Data of pictures and of the live view; `None` before the first output.
    drawing: Option<Drawing>,
    touches: bool,
    contacts: u64,
}

/// The table of poses, with a line for each turn.
struct OdometryTable {
    file: WholeFile,
    patience: Patience,
    /// Writer of the lines; `None` before the first output. The robot does not wait for a slow disk.
    lines: Option<Unfinished<Outlet>>,
}

impl ByOdometry {
    /// Returns the views of a run on the robot with this name.
    ///
    /// # Errors
    /// Returns a message if the options request the live view and standard output is not a terminal.
    pub(crate) fn new(
        robot: &str,
        matches: &ArgMatches,
        plot: Option<WholeFile>,
        record: Option<WholeFile>,
        trail: Option<WholeFile>,
        patience: &Patience,
    ) -> Result<Self, String> {
        let watch = Watch::of(matches, &World::empty())?;
        let trail = trail.map(|file| OdometryTable { file, patience: patience.clone(), lines: None });
        let setup = format!("robot {robot}, by odometry");
        Ok(Self { setup, watch, plot, record, trail, drawing: None, touches: false, contacts: 0 })
    }

    /// Updates the views with the output of the turn at time `t`.
    pub(crate) fn sensed(&mut self, y: &Sensed, t: Nanos) {
        // A driver that loses its pose for a moment leaves a gap in the picture.
        if !is_finite(&y.odometry) {
            return;
        }
        if let Some(trail) = &mut self.trail {
            trail.went(t, &y.odometry);
        }
        if self.plot.is_none() && self.record.is_none() && self.watch.is_none() {
            return;
        }
        let comes_into_contact = y.pressed() && !self.touches;
        self.contacts += u64::from(comes_into_contact);
        self.touches = y.pressed();
        let is_animated = self.record.is_some();
        let begin = || Drawing::without_world(y, self.setup.clone(), is_animated);
        self.drawing.get_or_insert_with(begin).sensed(y, t, comes_into_contact);
        if let Some(watch) = &mut self.watch {
            let body = Footprint { pose: y.odometry, form: Form::of(&y.shape) };
            watch.sensed(&body, y, t, std::iter::empty());
            watch.touched(self.touches, self.contacts);
        }
    }

    /// Restores the screen, and updates the pictures with the output that followed the stop of the robot, if there is
    /// such an output.
    pub(crate) fn stopped(&mut self, y: Option<&Sensed>) {
        if let Some(watch) = &mut self.watch {
            watch.leave();
        }
        if let (Some(drawing), Some(y)) = (&mut self.drawing, y.filter(|y| is_finite(&y.odometry))) {
            drawing.rests_at(&y.odometry);
        }
    }
}

/// Returns `true` if all coordinates of a pose are finite, so that they can be drawn.
fn is_finite(pose: &Pose) -> bool {
    [pose.x.0, pose.y.0, pose.theta.0].into_iter().all(f64::is_finite)
}

impl OdometryTable {
    fn went(&mut self, t: Nanos, pose: &Pose) {
        let Self { file, patience, lines } = self;
        let lines = lines.get_or_insert_with(|| {
            let mut lines = Unfinished::through(file.clone(), |file| Outlet::open(file, Keeps::All, patience));
            lines.write("t,x,y,heading\n");
            lines
        });
        lines.write(&format!("{},{},{},{}\n", t.seconds(), pose.x.0, pose.y.0, pose.theta.degrees()));
    }
}

impl Observer for ByOdometry {
    fn began(&mut self, number: u64, law: &str, t: Nanos) {
        if let Some(drawing) = &mut self.drawing {
            drawing.began(number, law, t);
        }
    }

    fn ended(&mut self, ended: &Ended<'_>) {
        if let Some(drawing) = &mut self.drawing {
            drawing.ended(ended.plan, ended.is_over, ended.by, ended.t);
        }
    }

    fn looks(&self) -> bool {
        self.watch.is_some()
    }

    fn turned(&mut self, standing: &PlanPosition<'_>) {
        if let (Some(watch), Some(drawing)) = (&mut self.watch, &self.drawing) {
            watch.turned(standing, drawing.echoes());
        }
    }

    fn finish(&mut self) -> Result<(), String> {
        let lines = self.trail.take().and_then(|trail| trail.lines);
        let trail = lines.map_or(Ok(()), |lines| lines.finish("trail"));
        let Some(drawing) = &self.drawing else { return trail };
        let plot = self.plot.as_ref().map_or(Ok(()), |file| file.write("plot", &drawing.picture()));
        let record = self.record.as_ref().map_or(Ok(()), |file| file.write("record", &drawing.animation()));
        trail.and(plot).and(record)
    }
}
