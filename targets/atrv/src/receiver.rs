//! Receives the robot's reports, stores the robot's state, and detects faults.

use std::time::{Duration, Instant};

use mdle_runtime::{Nanos, Pings, Pose, SONARS, Supply, Twist, Volts};
use mdle_serial::{Line, LineFault};

use crate::command::Axis;
use crate::config::{Bumpers, Config};
use crate::fault::Fault;
use crate::frame::{Packet, Reader};
use crate::motion::{Odometer, twist};
use crate::report::Report;
use crate::ring::Ring;

/// Maximum number of bytes that are read from the line at once.
const CHUNK: usize = 512;
/// Maximum delay of an answer, in addition to twice the time between two requests.
const LATE: Duration = Duration::from_millis(300);
/// Maximum number of consecutive reads before the number of reports is checked. The limit is needed because a robot may
/// send without end.
const READS: usize = 64;

/// Receiver of the robot's reports. It stores the state of the robot according to these reports.
#[derive(Debug)]
pub(crate) struct Hearing {
    reader: Reader,
    known: ReportedState,
    /// Time of the last position report by this computer's clock; `None` before the first report.
    last_report: Option<Instant>,
    /// Fault that was detected since the last position report; `None` if no fault was detected.
    trouble: Option<Fault>,
    /// Maximum time between two reports about the brake.
    unanswered: Nanos,
}

/// State of the robot according to its reports.
#[derive(Debug)]
struct ReportedState {
    config: Config,
    odometer: Odometer,
    ring: Ring,
    /// Translational position and velocity, which the robot reports before the rotational ones; `None` once the
    /// rotational ones have been reported.
    along: Option<(i32, i32)>,
    velocity: Twist,
    /// Time of the last position report by the controller's clock; `None` before the first report.
    time: Option<u32>,
    /// Time of the exchange that received the last position report.
    positioned: Nanos,
    /// Bumpers in contact: bit 0 for the front bumper, bit 1 for the rear bumper.
    switches: u32,
    /// Time of the last report of each bumper; `None` before the first report.
    felt: [Option<Nanos>; 2],
    /// `true` if the brake is set; `None` before the first report.
    is_braked: Option<bool>,
    /// Time of the last report about the brake.
    answered: Nanos,
    /// Voltage of the battery, from the last report about the brake.
    battery: Volts,
}

impl Hearing {
    /// Creates the state before the first report. The state of the brake is requested at most once in `period`.
    pub(crate) fn new(config: &Config, period: Duration) -> Self {
        let known = ReportedState {
            config: config.clone(),
            odometer: Odometer::default(),
            ring: Ring::new(config),
            along: None,
            velocity: Twist::default(),
            time: None,
            positioned: Nanos::ZERO,
            switches: 0,
            felt: [None; 2],
            is_braked: None,
            answered: Nanos::ZERO,
            battery: Volts(0.0),
        };
        let unanswered = Duration::from_millis(config.status).max(period).saturating_mul(2).saturating_add(LATE);
        let unanswered = Nanos(u64::try_from(unanswered.as_nanos()).unwrap_or(u64::MAX));
        Self { reader: Reader::default(), known, last_report: None, trouble: None, unanswered }
    }

    /// Reads the reports that have arrived, and waits for `count` position reports. If `count` is 0, waits until the
    /// last position report is at most `patience` old.
    ///
    /// # Errors
    /// Fails if the line is closed, or if the position reports have not arrived within `patience`.
    pub(crate) fn take(&mut self, line: &Line, at: Nanos, count: u32, patience: Duration) -> Result<(), Fault> {
        let begun = Instant::now();
        let mut reports = 0;
        loop {
            reports += self.drain(line, at)?;
            let is_fresh = self.last_report.is_some_and(|time| time.elapsed() <= patience);
            if if count > 0 { reports >= count } else { is_fresh } {
                return Ok(());
            }
            let since = if count > 0 { begun } else { self.last_report.unwrap_or(begun) };
            match line.hear(since + patience) {
                Ok(()) => {}
                // A fault found meanwhile is more specific than a missing report.
                Err(LineFault::Silent) => return Err(self.trouble.take().unwrap_or(Fault::Line(LineFault::Silent))),
                Err(fault) => return Err(fault.into()),
            }
        }
    }

    /// Reads the reports that have arrived, and clears the time and the fault of the last report. Does not clear the
    /// robot's state.
    ///
    /// # Errors
    /// Fails if the line is closed.
    pub(crate) fn forget(&mut self, line: &Line) -> Result<(), Fault> {
        self.drain(line, Nanos::ZERO)?;
        (self.last_report, self.trouble) = (None, None);
        Ok(())
    }

    /// Reads the reports that have arrived, and waits until `deadline` for `count` position reports. Returns the
    /// velocity in the last position report since [`Self::forget`].
    ///
    /// # Errors
    /// Fails if the line is closed, or if no position has been reported since [`Self::forget`].
    pub(crate) fn speed(&mut self, line: &Line, count: u32, deadline: Instant) -> Result<Twist, Fault> {
        let mut reports = 0;
        loop {
            reports += self.drain(line, Nanos::ZERO)?;
            if reports >= count {
                break;
            }
            match line.hear(deadline) {
                Ok(()) => {}
                Err(LineFault::Silent) => break,
                Err(fault) => return Err(fault.into()),
            }
        }
        let silent = || self.trouble.clone().unwrap_or(Fault::Line(LineFault::Silent));
        if self.last_report.is_some() { Ok(self.velocity()) } else { Err(silent()) }
    }

    /// Clears the reported state of the brake.
    pub(crate) fn forget_brake(&mut self) {
        self.known.is_braked = None;
    }

    /// Waits until the robot reports that its brake is set.
    ///
    /// # Errors
    /// Fails if the line is closed. Also fails if, by `deadline`, the robot has not reported the brake since
    /// [`Self::forget_brake`], or has reported that it is not set.
    pub(crate) fn brake(&mut self, line: &Line, deadline: Instant) -> Result<(), Fault> {
        loop {
            self.drain(line, Nanos::ZERO)?;
            if self.known.is_braked == Some(true) {
                return Ok(());
            }
            match line.hear(deadline) {
                Ok(()) => {}
                Err(LineFault::Silent) if self.known.is_braked.is_some() => return Err(Fault::Unbraked),
                Err(LineFault::Silent) => return Err(Fault::Unheard),
                Err(fault) => return Err(fault.into()),
            }
        }
    }

    /// Returns the fault for the first report that has to arrive before the start and is still missing; `None` if all
    /// these reports have arrived.
    pub(crate) fn waits_for(&self) -> Option<Fault> {
        match self.known.is_braked {
            None => Some(Fault::Unheard),
            Some(true) => Some(Fault::Braked),
            Some(false) => {
                let numb = self.known.numb(Nanos::ZERO).map(Fault::Numb);
                numb.or_else(|| self.known.ring.unheard().map(Fault::Deaf))
            }
        }
    }

    /// Checks that the robot can continue. `at` is the time of the current output.
    ///
    /// # Errors
    /// Fails if the brake is set, if the positions leap, or if a report is overdue.
    pub(crate) fn fault(&self, at: Nanos) -> Result<(), Fault> {
        let known = &self.known;
        if known.is_braked == Some(true) {
            return Err(Fault::Braked);
        }
        if known.odometer.leaps() {
            return Err(Fault::Leaps);
        }
        if at.since(known.answered) > self.unanswered {
            return Err(Fault::Unheard);
        }
        let silent = known.numb(at).map(Fault::Numb).or_else(|| known.ring.deaf(at).map(Fault::Deaf));
        silent.map_or(Ok(()), Err)
    }

    /// Returns the robot's pose by odometry.
    pub(crate) fn pose(&self) -> Pose {
        self.known.odometer.pose
    }

    /// Returns the age of the last position report. `at` is the time of the exchange.
    pub(crate) fn age(&self, at: Nanos) -> Nanos {
        at.since(self.known.positioned)
    }

    /// Returns the robot's velocity.
    pub(crate) fn velocity(&self) -> Twist {
        self.known.velocity
    }

    /// Returns the bumpers in contact, as bits.
    pub(crate) fn switches(&self) -> u32 {
        self.known.switches
    }

    /// Returns the last pings of each direction.
    pub(crate) fn pings(&self) -> &[Pings; SONARS] {
        &self.known.ring.pings
    }

    /// Returns the voltage and the state of the battery. Whether the battery is being charged is derived from the
    /// voltage alone.
    pub(crate) fn supply(&self) -> Supply {
        let ReportedState { battery, config, .. } = &self.known;
        let is_plugged = battery.0 > config.plugged_above;
        Supply { battery: *battery, is_low: battery.0 < config.low_battery, is_plugged }
    }

    /// Reads the reports that have arrived, and returns the number of position reports among them.
    fn drain(&mut self, line: &Line, at: Nanos) -> Result<u32, Fault> {
        let mut reports = 0;
        for _ in 0..READS {
            let mut chunk = [0; CHUNK];
            let count = line.read(&mut chunk)?;
            if count == 0 {
                break;
            }
            for byte in chunk.iter().take(count) {
                let heard = match self.reader.take(*byte) {
                    Ok(None) => continue,
                    Ok(Some(packet)) => self.known.take(&packet, at),
                    Err(garbled) => Err(Fault::Garbled(garbled)),
                };
                match heard {
                    Ok(false) => {}
                    Ok(true) => {
                        reports += 1;
                        (self.last_report, self.trouble) = (Some(Instant::now()), None);
                    }
                    Err(trouble) => self.trouble = Some(trouble),
                }
            }
        }
        Ok(reports)
    }
}

impl ReportedState {
    /// Processes a packet. Returns `true` if the packet completes a position report.
    fn take(&mut self, packet: &Packet<'_>, at: Nanos) -> Result<bool, Fault> {
        match Report::read(packet).map_err(Fault::Unreadable)? {
            Report::Axis { axis: Axis::Translation, position, velocity, .. } => {
                if self.along.replace((position, velocity)).is_some() {
                    return Err(Fault::NoAxis(Axis::Rotation));
                }
            }
            Report::Axis { axis: Axis::Rotation, position, velocity, time } => {
                let along = self.along.take();
                if self.time.replace(time) == Some(time) {
                    return Err(Fault::Repeated);
                }
                let (along, speed) = along.ok_or(Fault::NoAxis(Axis::Translation))?;
                self.odometer.take(along, position, &self.config);
                self.velocity = twist(speed, velocity, &self.config);
                self.positioned = at;
                return Ok(true);
            }
            Report::Sonars(echoes) => {
                for (sonar, counts) in echoes.each() {
                    self.ring.take(sonar, counts, at, self.odometer.pose);
                }
            }
            Report::Input { address, state } => self.feel(address, state, at),
            Report::Status { battery, is_braked } => {
                (self.is_braked, self.answered) = (Some(is_braked), at);
                self.battery = Volts(f64::from(battery) / 100.0 + self.config.battery_offset);
            }
            Report::Other => {}
        }
        Ok(false)
    }

    /// Stores the state of the digital input at this address.
    fn feel(&mut self, address: u8, state: u16, at: Nanos) {
        match (address.wrapping_sub(self.config.bumper_address), self.config.bumpers) {
            (0, Bumpers::Bits) => (self.switches, self.felt) = (u32::from(state & 0b11), [Some(at); 2]),
            (bumper @ (0 | 1), Bumpers::Addresses) => {
                let bit = 1 << bumper;
                self.switches = if state == 0 { self.switches & !bit } else { self.switches | bit };
                if let Some(felt) = self.felt.get_mut(usize::from(bumper)) {
                    *felt = Some(at);
                }
            }
            _ => {}
        }
    }

    /// Returns the first bumper whose last report is missing or too old; `None` if there is no such bumper, or if there
    /// is no limit.
    fn numb(&self, at: Nanos) -> Option<u8> {
        let limit = Nanos(self.config.inputs.saturating_mul(1_000_000));
        let is_old = |felt: &Option<Nanos>| felt.is_none_or(|felt| at.since(felt) > limit);
        let numb = (0..).zip(&self.felt).find(|(_, felt)| is_old(felt)).map(|(bumper, _)| bumper);
        numb.filter(|_| limit > Nanos::ZERO)
    }
}
