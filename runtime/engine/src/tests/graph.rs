//! Random graphs of modules. The values of a module depend on everything that it reads.

use std::time::Duration;

use crate::{
    Background, Candidate, Declare, Exchange, Fault, In, Module, Modules, Out, Reading, Relevance, Turn, Value,
};

/// A random number generator (`xorshift64*`) whose numbers depend only on its seed.
#[derive(Debug, Clone)]
pub(super) struct Chance(u64);

impl Chance {
    pub(super) const fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(2).wrapping_add(0x9e37_79b9))
    }

    pub(super) fn next(&mut self) -> u64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        self.0.wrapping_mul(0x2545_f491_4f6c_dd1d)
    }

    pub(super) fn below(&mut self, limit: u64) -> u64 {
        (self.next() >> 16) % limit
    }
}

/// Mixes a number into a state; different numbers give different states.
pub(super) fn mixed(state: u64, number: u64) -> u64 {
    (state ^ number).wrapping_mul(0x0100_0000_01b3).rotate_left(23)
}

/// A module that mixes all values that it reads into its state.
pub(super) struct Mixer {
    reads: Vec<In<f64>>,
    gain: In<f64>,
    outs: Vec<Out<f64>>,
    state: u64,
    /// The module publishes in turns in which its state is a multiple of this number.
    rarity: u64,
}

/// Declares the attributes that a random module reads.
fn reads(declare: &mut Declare, chance: &mut Chance, modules: u64) -> Vec<In<f64>> {
    // Modules with higher numbers are loaded later, and no module has the highest number.
    let names = (0..chance.below(4)).map(|_| (chance.below(modules + 1), chance.below(2)));
    let names: Vec<_> = names.collect();
    names.iter().map(|(module, out)| declare.reads(&format!("m{module}"), &format!("out{out}"))).collect()
}

impl Mixer {
    fn declare(declare: &mut Declare, mut chance: Chance, modules: u64) -> Self {
        declare.priority(chance.below(3) as i32);
        if chance.below(3) == 0 {
            declare.relevance(Relevance::WhenRead);
        }
        let reads = reads(declare, &mut chance, modules);
        let outs = (0..2).map(|out| declare.publishes(&format!("out{out}"))).collect();
        let gain = declare.setting("gain", 1.0);
        Self { reads, gain, outs, state: chance.next(), rarity: chance.below(3) + 1 }
    }
}

impl Module<f64> for Mixer {
    fn turn(&mut self, turn: &mut Turn<'_, f64>) -> Result<(), Fault> {
        let inputs = self.reads.iter().chain([&self.gain]).map(|read| turn.reading(*read));
        let inputs = inputs.flatten().map(|reading| mixed(reading.at.0, reading.value.number().unwrap().to_bits()));
        self.state = inputs.chain([turn.y.to_bits(), turn.number, turn.now.0]).fold(self.state, mixed);
        if self.state.is_multiple_of(self.rarity) {
            for (place, out) in self.outs.iter().enumerate() {
                turn.publish(*out, (self.state >> (place + 12)) as f64);
            }
        }
        Ok(())
    }

    fn start(&mut self) {
        self.state = mixed(self.state, 1);
    }

    fn stop(&mut self) {
        self.state = mixed(self.state, 2);
    }
}

/// A slow background module that mixes all values that it reads into its state.
pub(super) struct Slow {
    reads: Vec<In<f64>>,
    out: Out<f64>,
    chance: Chance,
}

impl Background for Slow {
    fn run(mut self: Box<Self>, mut exchange: Exchange) -> Result<(), Fault> {
        loop {
            std::thread::sleep(Duration::from_micros(self.chance.below(300)));
            let (own, Self { reads, out, .. }) = (self.chance.next(), &*self);
            let ended = exchange.exchange(|offer| {
                let inputs = reads.iter().filter_map(|read| offer.get(*read));
                let state = inputs.fold(own, |state, input| mixed(state, input.to_bits()));
                offer.publish(*out, (state >> 12) as f64);
            });
            if ended.is_err() {
                return Ok(());
            }
        }
    }
}

/// Loads the modules of a random graph.
pub(super) fn load(modules: &mut Modules<f64>, seed: u64) {
    let mut chance = Chance::new(seed);
    let count = chance.below(10) + 2;
    for number in 0..count {
        let own = Chance::new(mixed(seed, number));
        let name = format!("m{number}");
        let candidate = if chance.below(4) == 0 {
            Candidate::background(&name, |declare| {
                let mut own = own;
                declare.latency(mdle_runtime::Nanos(own.below(5) * super::PERIOD));
                Slow { reads: reads(declare, &mut own, count), out: declare.publishes("out0"), chance: own }
            })
        } else {
            Candidate::registered(&name, |declare| Mixer::declare(declare, own, count))
        };
        modules.load(candidate.unwrap()).unwrap();
    }
}

/// Makes a random change of the modules, as a user would.
pub(super) fn change(modules: &mut Modules<f64>, seed: u64, turn: u64) {
    let mut chance = Chance::new(mixed(seed, turn));
    let name = format!("m{}", chance.below(12));
    // The module may not exist, or may not have the setting.
    match chance.below(40) {
        0 => _ = modules.hold(&name, true),
        1 | 2 => _ = modules.hold(&name, false),
        3 => _ = modules.set(&name, "gain", Value::Number(chance.below(9) as f64)),
        4 if chance.below(50) == 0 => _ = modules.unload(&name),
        _ => {}
    }
}

/// Returns a hash of the board, of every value and its time.
pub(super) fn hash(modules: &Modules<f64>) -> u64 {
    let readings = modules.board().posts().iter().map(|post| post.reading.as_ref());
    let words = readings.map(|reading| match reading {
        Some(Reading { value, at }) => mixed(value.number().unwrap().to_bits(), at.0),
        None => 7,
    });
    words.fold(0xcbf2_9ce4_8422_2325, mixed)
}
