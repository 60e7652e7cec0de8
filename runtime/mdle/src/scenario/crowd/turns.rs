//! Runs the turns of a crowd on several threads. The results do not depend on the number of threads.
//!
//! In each turn, robots that may touch each other form a group, and a single thread handles each group. The thread
//! moves the robots of the group one after the other; each robot moves among the current poses of the others in its
//! group. Then the thread makes the turns of the robots' plans. Sonars detect all other robots at the poses that they
//! had at the beginning of the turn. Therefore, no result depends on the order of the groups.

use std::fmt::Write as _;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread;

use mdle_compiler::load::Loaded;
use mdle_runtime::{Nanos, Pose};
use mdle_sim::{Crowd, Footprint, Groups, Others};

use super::alphabet::CrowdAlphabet;
use super::member::Member;
use super::recorded::RecordedMember;
use super::setup::CrowdSetup;

/// Number of groups that a thread takes from the list at a time.
const TAKES: usize = 16;
/// Minimum number of robots per thread; with fewer robots, an additional thread would not save time.
const FOR_A_THREAD: usize = 100;

/// The robots of a crowd.
pub(super) struct Turns {
    /// The robots. Only one thread locks each robot in a turn, so no thread waits.
    members: Vec<Mutex<Member>>,
    plan: Arc<Loaded<CrowdAlphabet>>,
    threads: usize,
    is_recorded: bool,
    /// Distance between the centres of two robots, in metres, within which one may detect the other with its sonars.
    hears: f64,
    /// Distance between the centres of two robots, in metres, within which they may touch in a turn.
    touches: f64,
}

/// State of a turn that all threads share.
struct Shared<'t> {
    turns: &'t Turns,
    t: Nanos,
    crowd: Crowd,
    groups: Groups,
    /// Index of the first group that no thread has taken.
    next: AtomicUsize,
}

fn lock(member: &Mutex<Member>) -> MutexGuard<'_, Member> {
    member.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Turns {
    /// Creates a crowd before its first turn, with the records of its robots; `records` is empty if they are not
    /// recorded.
    pub(super) fn new(setup: CrowdSetup, records: Vec<RecordedMember>) -> Self {
        let CrowdSetup { robots, plan, threads, .. } = setup;
        let is_recorded = !records.is_empty();
        let mut records = records.into_iter();
        let (hears, touches) = robots.first().map_or((0.0, 0.0), Member::reaches);
        let members = robots.into_iter().map(|robot| Mutex::new(robot.recorded(records.next())));
        let members: Vec<_> = members.collect();
        let threads = threads.min(members.len().div_ceil(FOR_A_THREAD));
        Self { members, plan, threads, is_recorded, hears, touches }
    }

    /// Returns the number of threads that make the turns.
    pub(super) fn threads(&self) -> usize {
        self.threads
    }

    /// Makes the turn of all robots at time `t`.
    pub(super) fn turn(&mut self, t: Nanos) {
        let bodies: Vec<Footprint> = self.each().map(|member| member.footprint()).collect();
        let crowd = Crowd::of(bodies);
        let groups = crowd.groups(self.touches);
        let shared = Shared { turns: self, t, crowd, groups, next: AtomicUsize::new(0) };
        thread::scope(|scope| {
            for _ in 1..self.threads {
                scope.spawn(|| shared.work());
            }
            shared.work();
        });
    }

    /// Returns an iterator that locks and yields the robots in the order of their numbers.
    fn each(&self) -> impl Iterator<Item = MutexGuard<'_, Member>> {
        self.members.iter().map(lock)
    }

    /// Calls `take` with the number and the pose of each robot.
    pub(super) fn poses(&self, mut take: impl FnMut(usize, &Pose)) {
        for (number, member) in self.each().enumerate() {
            take(number, &member.pose());
        }
    }

    /// Returns `true` if all plans are over.
    pub(super) fn are_over(&self) -> bool {
        self.each().all(|member| member.is_over)
    }

    /// Stops all robots at the end of the run, at time `t`.
    pub(super) fn stop(&mut self, t: Nanos) {
        self.each().for_each(|mut member| member.stop(t));
    }

    /// Returns the message about a record that could not be written; `None` if there is no such record.
    pub(super) fn fault(&self) -> Option<String> {
        if !self.is_recorded {
            return None;
        }
        self.each().find_map(|member| member.fault().map(str::to_owned))
    }

    /// Returns the report about the crowd at time `t`.
    pub(super) fn summary(&self, t: Nanos) -> String {
        let count = |is_so: fn(&Member) -> bool| self.each().filter(|member| is_so(member)).count();
        let (over, touched) = (count(|member| member.is_over), count(|member| member.has_touched));
        let (all, way) = (self.members.len(), self.each().map(|member| member.way).sum::<f64>());
        let robots = if all == 1 { "robot" } else { "robots" };
        let mut text = format!("{all} {robots} for {:.1} s\n", t.seconds());
        // Writing to a string cannot fail.
        let _ = writeln!(text, "plans that are over: {over}");
        let _ = writeln!(text, "robots that touched something: {touched}");
        let _ = write!(text, "mean way: {:.2} m", way / all.max(1) as f64);
        text
    }
}

impl Shared<'_> {
    /// Makes the turns of groups until no group is left.
    fn work(&self) {
        let mut others = Others::default();
        loop {
            let first = self.next.fetch_add(TAKES, Ordering::Relaxed);
            if first >= self.groups.count() {
                return;
            }
            for group in first..(first + TAKES).min(self.groups.count()) {
                self.group(self.groups.group(group), &mut others);
            }
        }
    }

    /// Makes the turn of a group of robots.
    fn group(&self, numbers: &[u32], others: &mut Others) {
        let mut members: Vec<_> = numbers.iter().filter_map(|number| self.locked(*number)).collect();
        let mut bodies: Vec<Footprint> = members.iter().map(|member| member.footprint()).collect();
        for (place, number) in numbers.iter().enumerate() {
            let Some(member) = members.get_mut(place) else { continue };
            self.hear(*number, others);
            self.touch(*number, numbers, &bodies, others);
            member.moves(self.t, others);
            if let Some(body) = bodies.get_mut(place) {
                *body = member.footprint();
            }
        }
        for (member, number) in members.iter_mut().zip(numbers) {
            self.touch(*number, numbers, &bodies, others);
            member.turn(self.t, &self.turns.plan, others);
        }
    }

    fn locked(&self, number: u32) -> Option<MutexGuard<'_, Member>> {
        self.turns.members.get(number as usize).map(lock)
    }

    /// Collects the robots that robot `number` may detect with its sonars, at their poses at the beginning of the turn.
    fn hear(&self, number: u32, Others { heard, .. }: &mut Others) {
        heard.clear();
        self.near(number, self.turns.hears, |_, body| heard.push(*body));
    }

    /// Collects the robots of the group that robot `number` may touch, at their current poses.
    fn touch(&self, number: u32, group: &[u32], now: &[Footprint], Others { touched, .. }: &mut Others) {
        touched.clear();
        // Most robots are alone in their group.
        if group.len() > 1 {
            self.near(number, self.turns.touches, |other, _| {
                let place = group.binary_search(&(other as u32)).ok();
                touched.extend(place.and_then(|place| now.get(place)));
            });
        }
    }

    /// Calls `take` with the number and the footprint of each other robot that was within `reach` metres of robot
    /// `number` at the beginning of the turn.
    fn near(&self, number: u32, reach: f64, mut take: impl FnMut(usize, &Footprint)) {
        let Some(own) = self.crowd.bodies().get(number as usize) else { return };
        self.crowd.near(own.at(), reach, |other, body| {
            if other != number as usize {
                take(other, body);
            }
        });
    }
}
