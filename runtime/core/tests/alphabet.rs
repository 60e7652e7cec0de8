//! Tests `alphabet!` with a robot that has one interrupt, and two laws of the same name.
#![allow(clippy::expect_used, reason = "a test fails by panicking")]

use mdle_runtime::{
    Alphabet as _, Argument, Begin, Bits, Completes, Control, Frame, Interrupt, Law, Meters, Nanos, Radians,
};

/// An output: the bits that are set.
pub struct Output(Bits<2>);
/// An input: a number.
pub type Input = f64;

impl mdle_runtime::Output for Output {}

/// Fires while these bits are set.
#[derive(Debug)]
pub struct Set(Bits<2>);

impl Interrupt<Output> for Set {
    fn fired(&self, y: &Output) -> bool {
        self.0 == y.0
    }
}

/// A law that is done at once.
#[derive(Debug, Clone, Copy)]
pub struct Go(f64);
/// A law that is never done.
#[derive(Debug, Clone, Copy)]
pub struct Go2;

impl Control<Output> for Go {
    type Law = Self;

    fn begin(&self, _: &Output, _: Begin) -> Self {
        *self
    }
}

impl Law<Output> for Go {
    type Input = f64;

    fn input(&mut self, _: &Output, _: Nanos) -> f64 {
        self.0
    }
}

impl Completes<Output> for Go {
    fn completed(&self, _: &Output, _: Nanos) -> bool {
        true
    }
}

impl Control<Output> for Go2 {
    type Law = Self;

    fn begin(&self, _: &Output, _: Begin) -> Self {
        *self
    }
}

impl Law<Output> for Go2 {
    type Input = f64;

    fn input(&mut self, _: &Output, _: Nanos) -> f64 {
        0.0
    }
}

const fn set(arguments: &[Argument<'_>]) -> Option<Set> {
    let &[Argument::Bits(bits)] = arguments else { return None };
    let Some(bits) = Bits::from_slice(bits) else { return None };
    Some(Set(bits))
}

const fn go(arguments: &[Argument<'_>]) -> Option<Go> {
    let &[Argument::Length(Meters(to))] = arguments else { return None };
    Some(Go(to))
}

const fn go2(arguments: &[Argument<'_>]) -> Option<Go2> {
    let &[] = arguments else { return None };
    Some(Go2)
}

/// Name of the target.
pub const NAME: &str = "toy";
/// Hash of the alphabet.
pub const HASH: u64 = 7;

mdle_runtime::alphabet! {
    capabilities: ["wings"];
    limits: ["go" "to" in -1.0..2.0];
    interrupts: ["set" => Set(set)];
    signals: [];
    controls: ["go" => Go(go) completes, "go" => Go2(go2)];
}

#[test]
fn quarks_of_one_name_differ_in_their_arguments() {
    let y = Output(Bits([true, false]));
    let begin = Begin { now: Nanos::ZERO, frame: Frame(Radians(0.0)) };
    let laws = [&[Argument::Length(Meters(1.5))][..], &[]].map(|arguments| {
        let mut law = Alphabet::control("go", arguments).expect("a law").begin(&y, begin);
        (law.input(&y, Nanos::ZERO), law.completed(&y, Nanos::ZERO))
    });
    assert_eq!(laws, [(1.5, true), (0.0, false)]);
    assert!(Alphabet::control("go", &[Argument::Number(1.5)]).is_none());
    assert!(Alphabet::control("stop", &[]).is_none());
}

#[test]
fn a_word_of_bits_has_the_length_that_is_declared() {
    let set = |bits: &[bool]| Alphabet::interrupt("set", &[Argument::Bits(bits)]);
    let fired = |bits| set(bits).expect("an interrupt").fired(&Output(Bits([true, false])));
    assert_eq!([fired(&[true, false]), fired(&[true, true])], [true, false]);
    assert!(set(&[true]).is_none() && set(&[true, false, true]).is_none());
}

#[test]
fn an_alphabet_has_its_capabilities_and_limits() {
    assert_eq!(Alphabet::CAPABILITIES, ["wings"]);
    let [limit] = Alphabet::LIMITS else { unreachable!("a limit") };
    assert_eq!((limit.quark, limit.parameter, limit.least, limit.most), ("go", "to", -1.0, 2.0));
}
