//! A network line that loses and delays the states that a robot sends. It is placed between a sender and the peer to
//! which the sender connects.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::io::{self, Read as _, Write as _};
use std::net::{SocketAddr, TcpListener, TcpStream};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::thread;
use std::time::{Duration, Instant};

use mdle_tests::chance::Chance;

/// Length in bytes of the greeting that a robot sends to a sender (docs/src/reference/interfaces.md, 6.5).
const GREETING: usize = 21;

/// Faults of a line.
#[derive(Clone, Copy)]
pub(crate) struct Line {
    /// Percentage of states that are lost.
    pub(crate) loss: usize,
    /// Maximum delay of a state. Delays are random, so a state can overtake an earlier one.
    pub(crate) longest: Duration,
}

impl Line {
    /// Starts a line to `peer`, and returns the address to which senders must connect instead of `peer`.
    pub(crate) fn before(self, peer: SocketAddr, seed: u64) -> SocketAddr {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let address = listener.local_addr().unwrap();
        thread::spawn(move || {
            for (number, mut stream) in (0..).zip(listener.incoming().flatten()) {
                // If the peer does not listen yet, the sender connects again.
                let Ok(mut to) = TcpStream::connect(peer) else { continue };
                let mut greeting = [0; GREETING];
                let greeted = to.read_exact(&mut greeting).and_then(|()| stream.write_all(&greeting));
                if greeted.is_err() {
                    continue;
                }
                let (frames, carried) = channel();
                let chance = Chance::new(seed + 1000 * number);
                thread::spawn(move || self.take(stream, &frames, chance));
                thread::spawn(move || carry(to, &carried));
            }
        });
        address
    }

    /// Receives the frames of a connection until it ends, and passes each to `frames` with the time at which it must be
    /// delivered.
    fn take(self, mut from: TcpStream, frames: &Sender<(Instant, Vec<u8>)>, mut chance: Chance) -> io::Result<()> {
        loop {
            let mut length = [0; 4];
            from.read_exact(&mut length)?;
            let mut frame = length.to_vec();
            frame.resize(4 + u32::from_le_bytes(length) as usize, 0);
            from.read_exact(&mut frame[4..])?;
            let is_lost = chance.percent(self.loss);
            let delay = self.longest.mul_f64(chance.below(1000) as f64 / 1000.0);
            if !is_lost && frames.send((Instant::now() + delay, frame)).is_err() {
                return Ok(());
            }
        }
    }
}

/// Writes each frame to the peer at its delivery time.
fn carry(mut to: TcpStream, frames: &Receiver<(Instant, Vec<u8>)>) -> io::Result<()> {
    let mut waiting = BinaryHeap::new();
    loop {
        let now = Instant::now();
        let next =
            waiting.peek().map_or(now + Duration::from_secs(1), |Reverse((due, _)): &Reverse<(Instant, _)>| *due);
        match frames.recv_timeout(next.saturating_duration_since(now)) {
            Ok(frame) => waiting.push(Reverse(frame)),
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => return Ok(()),
        }
        while let Some(Reverse((due, _))) = waiting.peek()
            && *due <= Instant::now()
            && let Some(Reverse((_, frame))) = waiting.pop()
        {
            to.write_all(&frame)?;
        }
    }
}
