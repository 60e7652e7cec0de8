//! Reports that the robot sends periodically, and their schedule. They contain axis positions, sonar echoes and bumper
//! states.

use std::time::Duration;

use mdle_emulator::Ailment;
use mdle_runtime::Twist;

use super::{A_METRE, A_RADIAN, Atrv};
use crate::wire::report;

/// Number of sonar counts per metre.
const A_RANGE: f64 = 1550.0;
/// Boards of the body's sonars, with six sonars each: front left, rear left, front right, rear right.
const BOARDS: [u8; 4] = [0, 1, 3, 2];
/// Range that a sonar without an echo reports, in the sonar's counts.
const NOTHING: u16 = 32_766;
/// Distance, in metres, between consecutive positions that a robot with the fault `leap` reports.
const LEAP: f64 = 3.0;
/// A report contains filler bytes if its number is a multiple of this value.
const FILLED: u8 = 7;

/// Schedule of a report that is sent periodically.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Schedule {
    /// Period of the report; zero if the report is never sent.
    period: Duration,
    due: Duration,
}

impl Atrv {
    pub(super) fn report_axes(&mut self) {
        if self.axis_reports.is_empty() || !self.has(Ailment::Hang) {
            if self.has(Ailment::Leap) {
                self.gone.0 += LEAP * A_METRE;
            }
            let Twist { v, omega } = self.sensed.velocity;
            let axes = [(0, self.gone.0, v.0 * A_METRE), (1, self.gone.1, omega.0 * A_RADIAN)];
            self.axis_reports = axes.map(|(axis, gone, speed)| self.axis(axis, gone, speed)).to_vec();
        }
        let reports = std::mem::take(&mut self.axis_reports);
        for (data, ailment) in reports.iter().zip([Ailment::NoTranslation, Ailment::NoRotation]) {
            if !self.has(ailment) {
                self.send(2, 33, data);
            }
        }
        self.axis_reports = reports;
    }

    fn axis(&self, axis: u8, gone: f64, speed: f64) -> Vec<u8> {
        // A position beyond 32 bits wraps: the report contains its lower 32 bits.
        let position = (gone.round() as i64) as i32;
        let speed = speed.round() as i32;
        [&[0; 4][..], &self.time(), &[axis], &position.to_be_bytes(), &speed.to_be_bytes(), &[0; 8]].concat()
    }

    /// Reports the sonars that have pinged since the last sonar report; sends no report if no sonar has pinged.
    pub(super) fn report_pings(&mut self) {
        let is_dead = self.has(Ailment::DeadSonar);
        let is_mute = self.has(Ailment::NoPings);
        let Some(times) = self.pings.as_mut().filter(|_| !is_mute) else { return };
        let mut data = Vec::new();
        for ((heard, time), sonar) in self.body.heard().iter().zip(times).zip(0_u8..) {
            if heard.at > *time {
                *time = heard.at;
                // The two sonars that point ahead.
                let range = heard.range.filter(|_| !(is_dead && [0, 12].contains(&sonar)));
                let counts = range.map_or(NOTHING, |range| (range.0 * A_RANGE).round() as u16);
                data.push(BOARDS[usize::from(sonar / 6) % 4] * 16 + sonar % 6);
                data.extend(counts.to_be_bytes());
            }
        }
        if !data.is_empty() {
            let data = [&[0; 4][..], &self.time(), &data].concat();
            self.send(4, 2, &data);
        }
    }

    pub(super) fn report_bumpers(&mut self) {
        if self.has(Ailment::NoBumpers) {
            return;
        }
        for bumper in 0..2_u8 {
            let is_pressed = bumper == 0 && self.has(Ailment::Bumper);
            let state = u8::from(is_pressed || self.sensed.switches & (1 << bumper) != 0);
            let data = [&self.time()[..], &[0x40 + bumper, 0, state]].concat();
            self.send(5, 1, &data);
        }
    }

    pub(super) fn time(&self) -> [u8; 4] {
        (self.age.as_millis() as u32).to_be_bytes()
    }

    pub(super) fn send(&mut self, port: u8, code: u8, data: &[u8]) {
        self.count = self.count.wrapping_add(1);
        let filler: &[u8] =
            if self.has(Ailment::Filler) || self.count.is_multiple_of(FILLED) { &[0x1B, 0x01] } else { &[] };
        self.outgoing.push(report(port, self.count, code, data, filler));
    }
}

impl Schedule {
    pub(super) fn new(micros: u32, now: Duration) -> Self {
        let period = Duration::from_micros(u64::from(micros));
        Self { period, due: now + period }
    }

    /// Returns `true` if the report is due. In this case, also schedules the next report.
    pub(super) fn is_due(&mut self, now: Duration) -> bool {
        let is_due = !self.period.is_zero() && self.due <= now;
        if is_due {
            self.due += self.period;
        }
        is_due
    }
}
