//! A run of the program on an emulated robot that a test observes.

use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::sync::{Arc, Mutex, Once};
use std::time::{Duration, Instant};

use mdle_atrv_emulator::atrv::{Atrv, step};
use mdle_emulator::{Ailment, Emulated, MotionOrder, OrderLog, Pace, Port, serve};
use mdle_runtime::Pose;
use mdle_scout_emulator::scout::Scout;
use mdle_sim::{Body, Make, Simulated, World};

/// Period of the program's turns.
const PERIOD: Duration = Duration::from_millis(100);
/// Pace of the emulator: each command lets a period pass, so a slow machine has no effect.
pub(crate) const LOCKSTEP: Pace = Pace::Lockstep(PERIOD);
/// Maximum movement in a period for which a robot counts as at rest, in metres.
pub(crate) const AT_REST: f64 = 0.001;
/// Time after which a test fails. A run takes less on any machine.
const SLOW: Duration = Duration::from_secs(120);
const ROOM: &str =
    "start = { x = 0.0, y = 0.0, heading = 0.0 }\n[[wall]]\npoints = [[9, -9], [9, 9], [-9, 9], [-9, -9], [9, -9]]";

/// An emulated robot that the program drives.
pub(crate) trait Robot: Emulated + Sized {
    const NAME: &'static str;

    fn new(pace: Pace) -> Self;
    fn pose(&self) -> Pose;
    fn orders(&self) -> &OrderLog;
    /// Returns `true` if the robot is in the correct state after a run that was stopped. `bytes` contains all bytes
    /// that the robot has received.
    fn is_secured(&self, bytes: &[u8]) -> bool;
}

fn body(body: Body, step: Duration) -> Simulated {
    let world = World::parse("room", ROOM).unwrap();
    Simulated::with(&Make { body, without: Vec::new(), seed: None }, &world, world.start, step).unwrap()
}

impl Robot for Scout {
    const NAME: &'static str = "scout";

    fn new(pace: Pace) -> Self {
        Self::new(body(Body::Scout, pace.step())).unwrap()
    }

    fn pose(&self) -> Pose {
        self.pose()
    }

    fn orders(&self) -> &OrderLog {
        self.orders()
    }

    /// Returns `true` if the bytes end with ST, requests for the state, repeated until the robot is at rest, and LP.
    fn is_secured(&self, bytes: &[u8]) -> bool {
        use mdle_scout::Command::{Limp, State, Stop};
        let [stop, state, limp] = [Stop, State, Limp].map(|command| command.frame().bytes().to_vec());
        let asks = bytes.strip_suffix(&*limp).and_then(|bytes| bytes.strip_suffix(&*state));
        asks.is_some_and(|bytes| without(bytes, &state).ends_with(&stop))
    }
}

impl Robot for Atrv {
    const NAME: &'static str = "atrv";

    fn new(pace: Pace) -> Self {
        let step = step(pace);
        Self::new(body(Body::Atrv, step), step, false).unwrap()
    }

    fn pose(&self) -> Pose {
        self.pose()
    }

    fn orders(&self) -> &OrderLog {
        self.orders()
    }

    /// Returns `true` if the bytes end with commands that stop both axes, set and check the brake, and end all reports.
    fn is_secured(&self, bytes: &[u8]) -> bool {
        use mdle_atrv::Command::{Brake, Deaf, Defaults, Inputs, Reports, Status};
        let frames = |commands: &[mdle_atrv::Command]| -> Vec<u8> {
            commands.iter().flat_map(|command| command.frame(mdle_atrv::Escape::Avoid).bytes().to_vec()).collect()
        };
        let (brake, last) = (frames(&[Brake, Status]), frames(&[Deaf, Inputs(0), Reports(0), Defaults]));
        let Some(moves) = bytes.strip_suffix(&*last).and_then(|bytes| bytes.strip_suffix(&*brake)) else {
            return false;
        };
        let mut moves = without(moves, &brake).rchunks(23);
        let mut rests = |axis| moves.next().is_some_and(|frame| is_rest(axis, frame));
        rests(1) && rests(0) && self.is_braked()
    }
}

/// Returns `true` if the frame commands an axis to stop. Four bytes of speed follow the axis. The speed may be one unit
/// instead of zero, to avoid a byte that has to be escaped; a metre has 139,655 units.
fn is_rest(axis: u8, frame: &[u8]) -> bool {
    frame.starts_with(&[0x1B, 0x02, 2, 0, 7, 14, axis, 0, 0, 0]) && frame.get(10).is_some_and(|speed| *speed <= 1)
}

/// Returns `bytes` without the trailing repetitions of `frame`.
fn without<'b>(mut bytes: &'b [u8], frame: &[u8]) -> &'b [u8] {
    while let Some(before) = bytes.strip_suffix(frame) {
        bytes = before;
    }
    bytes
}

/// Data that a robot has received so far.
#[derive(Default)]
pub(crate) struct Received {
    /// Process number of the program that drives the robot.
    pub(crate) process: u32,
    pub(crate) bytes: Vec<u8>,
    pub(crate) commands: usize,
}

/// A robot that a test observes. `look` is called after each command, and after each step with the duration of the
/// step.
struct Watched<'l, R> {
    robot: R,
    received: Received,
    look: &'l mut dyn FnMut(&R, &Received, Duration),
    /// Type of the answers that the robot does not send; `None` if it sends all answers.
    mute: Option<u8>,
}

impl<R: Robot> Emulated for Watched<'_, R> {
    fn push(&mut self, bytes: &[u8]) {
        self.received.bytes.extend(bytes);
        self.robot.push(bytes);
    }

    fn obey(&mut self) -> Option<bool> {
        let obeyed = self.robot.obey();
        if obeyed.is_some() {
            self.received.commands += 1;
            (self.look)(&self.robot, &self.received, Duration::ZERO);
        }
        obeyed
    }

    fn pass(&mut self, time: Duration) -> Result<(), String> {
        self.robot.pass(time)?;
        (self.look)(&self.robot, &self.received, time);
        Ok(())
    }

    fn take_frames(&mut self) -> Vec<Vec<u8>> {
        let mut frames = self.robot.take_frames();
        frames.retain(|frame| self.mute.is_none_or(|kind| frame.get(3) != Some(&kind)));
        frames
    }

    fn can_suffer(ailment: Ailment) -> bool {
        R::can_suffer(ailment)
    }

    fn suffer(&mut self, ailment: Ailment) {
        self.robot.suffer(ailment);
    }
}

/// The result of a run.
pub(crate) struct Ran<R> {
    pub(crate) robot: R,
    pub(crate) output: Output,
    pub(crate) received: Received,
    /// Distance that the robot moves in the period after the end of the program, in metres.
    pub(crate) moves: f64,
}

impl<R> Ran<R> {
    pub(crate) fn errors(&self) -> String {
        String::from_utf8_lossy(&self.output.stderr).into_owned()
    }
}

/// Returns the distance between two poses, in metres.
pub(crate) fn distance(one: &Pose, other: &Pose) -> f64 {
    libm::hypot(one.x.0 - other.x.0, one.y.0 - other.y.0)
}

/// Sends a signal to a process for which its parent has not waited yet.
pub(crate) fn send(signal: i32, process: u32) {
    assert!(try_send(signal, process));
}

/// Sends a signal to a process, and returns `true` unless the parent of the process has already waited for its end.
pub(crate) fn try_send(signal: i32, process: u32) -> bool {
    let kill = format!("kill -{signal} {process}");
    Command::new("sh").args(["-c", &kill]).status().unwrap().success()
}

/// Gives SIGHUP its default effect in the programs that this program starts, even under `nohup`, which makes them
/// ignore it: a signal that a program catches has its default effect in its child processes.
fn catch_hang_up() {
    static CAUGHT: Once = Once::new();
    CAUGHT.call_once(|| {
        signal_hook::flag::register(signal_hook::consts::SIGHUP, Arc::default()).unwrap();
    });
}

/// Runs the program with this configuration on a robot that sends no answers of the type `mute`. `look` is also called
/// once before the first command.
pub(crate) fn ran<R: Robot>(
    config: &Path,
    pace: Pace,
    mute: Option<u8>,
    look: &mut dyn FnMut(&R, &Received, Duration),
) -> Ran<R> {
    let mut command = Command::new(env!("CARGO_BIN_EXE_ahead"));
    command.env("ROBOT", R::NAME).arg("--config").arg(config);
    ran_by::<R>(command, pace, mute, look)
}

/// Runs the program of this command in the same way as [`ran`].
pub(crate) fn ran_by<R: Robot>(
    mut command: Command,
    pace: Pace,
    mute: Option<u8>,
    look: &mut dyn FnMut(&R, &Received, Duration),
) -> Ran<R> {
    catch_hang_up();
    let port = Port::open().unwrap();
    command.arg("--device").arg(port.path());
    command.args(["--period", "0.1"]).args((pace == LOCKSTEP).then_some("--lockstep"));
    let child = command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let (begun, robot) = (Instant::now(), R::new(pace));
    let received = Received { process: child.id(), ..Received::default() };
    look(&robot, &received, Duration::ZERO);
    let (mut watched, child) = (Watched { robot, received, look, mute }, Mutex::new(child));
    let goes_on = || {
        assert!(begun.elapsed() < SLOW, "the program does not end");
        child.lock().unwrap().try_wait().unwrap().is_none()
    };
    serve(&mut watched, &port, pace, &goes_on).unwrap();
    let output = child.into_inner().unwrap().wait_with_output().unwrap();
    let Watched { mut robot, received, .. } = watched;
    let before = robot.pose();
    let step = pace.step();
    (0..PERIOD.as_millis() / step.as_millis()).for_each(|_| robot.pass(step).unwrap());
    let moves = distance(&before, &robot.pose());
    Ran { robot, output, received, moves }
}

/// Returns `true` if the robot was commanded to drive.
pub(crate) fn drove<R: Robot>(robot: &R) -> bool {
    robot.orders().iter().any(|(_, order)| order == MotionOrder::Drive)
}
