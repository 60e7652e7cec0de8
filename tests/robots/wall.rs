//! A background module that estimates the direction of a wall from many echoes, and a test of it without a robot.

use std::collections::VecDeque;
use std::f64::consts::{FRAC_PI_2, PI};

use mdle::engine::{Background, Declare, Exchange, Fault, In, Offer, Out};
use mdle_runtime::{Meters, Nanos, Radians};

/// Number of echoes that the module keeps, and number of echoes from which it publishes.
const KEPT: usize = 200;
const FEWEST: usize = 6;
/// Minimum distance of two echoes whose direction counts, in metres.
const APART: f64 = 0.05;

/// Publishes the direction of the wall on the left, from where the robot heads: the median of the directions from each
/// echo to each other. A few wrong echoes do not change it. Thousands of pairs take longer than a turn may.
pub struct Wall {
    x: In<Meters>,
    y: In<Meters>,
    heading: In<Radians>,
    left: In<Meters>,
    bearing: Out<Radians>,
    echoes: VecDeque<[f64; 2]>,
}

impl Wall {
    /// Declares the attributes and the latency of the module, and returns it as it is before its first exchange.
    pub fn declare(declare: &mut Declare) -> Self {
        declare.latency(Nanos(500_000_000));
        Self {
            x: declare.reads("sensors", "x"),
            y: declare.reads("sensors", "y"),
            heading: declare.reads("sensors", "theta"),
            left: declare.reads("sensors", "r4"),
            bearing: declare.publishes("bearing"),
            echoes: VecDeque::new(),
        }
    }

    /// Adds the echo as of the last break, and publishes the direction at the next one.
    fn estimate(&mut self, offer: &mut Offer<'_>) {
        let place = (offer.get(self.x), offer.get(self.y), offer.get(self.heading));
        // `None` until `sensors` has published.
        let (Some(x), Some(y), Some(heading)) = place else { return };
        // An infinite range is no echo.
        if let Some(Meters(left)) = offer.get(self.left).filter(|left| left.0.is_finite()) {
            let to_left = heading.0 + FRAC_PI_2;
            self.echoes.push_back([x.0 + left * libm::cos(to_left), y.0 + left * libm::sin(to_left)]);
        }
        if self.echoes.len() > KEPT {
            self.echoes.pop_front();
        }
        if self.echoes.len() >= FEWEST
            && let Some(direction) = median(&self.echoes, heading)
        {
            offer.publish(self.bearing, Radians(direction));
        }
    }
}

impl Background for Wall {
    fn run(mut self: Box<Self>, mut exchange: Exchange) -> Result<(), Fault> {
        // Fails when the run ends, or when the module is unloaded.
        while exchange.exchange(|offer| self.estimate(offer)).is_ok() {}
        Ok(())
    }
}

/// Returns the median of the directions from echo to echo, as seen from this heading: from a quarter of a turn to the
/// right to a quarter of a turn to the left.
fn median(echoes: &VecDeque<[f64; 2]>, heading: Radians) -> Option<f64> {
    let pairs = (1..)
        .zip(echoes)
        .flat_map(|(next, from)| echoes.range(next..).map(move |to| [to[0] - from[0], to[1] - from[1]]));
    let apart = pairs.filter(|[x, y]| libm::hypot(*x, *y) >= APART);
    let mut directions: Vec<f64> = apart
        .map(|[x, y]| match Radians(libm::atan2(y, x) - heading.0).wrapped().0 {
            behind if behind > FRAC_PI_2 => behind - PI,
            behind if behind < -FRAC_PI_2 => behind + PI,
            ahead => ahead,
        })
        .collect();
    directions.sort_by(f64::total_cmp);
    directions.get(directions.len() / 2).copied()
}

#[cfg(test)]
mod tests {
    use std::error::Error;

    use mdle::engine::{Candidate, Module, Modules, Service, Threads, Turn};

    use super::*;

    /// A robot that drives along the first axis, with a wall that comes nearer on its left, in place of `sensors`.
    struct Drives {
        x: Out<Meters>,
        y: Out<Meters>,
        heading: Out<Radians>,
        left: Out<Meters>,
    }

    impl<Y> Module<Y> for Drives {
        fn turn(&mut self, turn: &mut Turn<'_, Y>) -> Result<(), Fault> {
            let x = 0.2 * turn.number as f64;
            // Two echoes are wrong.
            let left = if [5, 11].contains(&turn.number) { 4.0 } else { 3.0 - 0.5 * x };
            turn.publish(self.x, Meters(x));
            turn.publish(self.y, Meters(0.0));
            turn.publish(self.heading, Radians(0.0));
            turn.publish(self.left, Meters(left));
            Ok(())
        }
    }

    fn drives(declare: &mut Declare) -> Drives {
        Drives {
            x: declare.publishes("x"),
            y: declare.publishes("y"),
            heading: declare.publishes("theta"),
            left: declare.publishes("r4"),
        }
    }

    #[test]
    fn the_direction_of_a_wall_is_found() -> Result<(), Box<dyn Error>> {
        // In stepped time a break waits for the module, so that each run has the same values.
        let mut modules = Modules::new(Threads::Sequential, Service::WhenDue)?;
        modules.load(Candidate::registered("sensors", drives)?)?;
        modules.load(Candidate::background("wall", Wall::declare)?)?;
        modules.prepare();
        for number in 0..20 {
            modules.turn((), number, Nanos(number * 500_000_000), None);
            modules.settle();
            modules.prepare();
        }
        let post = modules.board().post("wall", "bearing").ok_or("it publishes no bearing")?;
        let bearing = post.reading.as_ref().and_then(|reading| reading.value.number()).ok_or("it has no value")?;
        assert!((bearing - libm::atan(-0.5)).abs() < 1e-9, "{bearing}");
        Ok(())
    }
}
