//! The alphabet of the simulated robot for a crowd: each running law takes only as much memory as it needs.
//!
//! On a robot, the law that runs is stored in place, so that no memory is allocated in a turn. This place is as large
//! as the largest law of the alphabet, which would be most of the memory of a crowd whose robots run smaller laws.

use mdle_runtime::{Alphabet, Argument, Begin, Comparison, Completes, Control, Law, Limit, Nanos, Sensed, Twist};
use mdle_sim::alphabet::{Alphabet as SimAlphabet, AnyControl, AnyInterrupt, AnySignal};

/// The alphabet of the simulated robot, whose running laws are stored on the heap.
pub(super) struct CrowdAlphabet;

/// Any law of the simulated robot with its arguments.
pub(super) struct CrowdControl(AnyControl);

/// Any running law of the simulated robot.
pub(super) struct CrowdLaw(Box<dyn Completes<Sensed, Input = Twist> + Send>);

/// A running law that cannot complete.
struct Endless<L>(L);

impl<L: Law<Sensed>> Law<Sensed> for Endless<L> {
    type Input = L::Input;

    fn input(&mut self, y: &Sensed, t: Nanos) -> L::Input {
        self.0.input(y, t)
    }

    fn stalled(&self, y: &Sensed, t: Nanos) -> Option<Nanos> {
        self.0.stalled(y, t)
    }
}

impl<L: Law<Sensed>> Completes<Sensed> for Endless<L> {
    fn completed(&self, _: &Sensed, _: Nanos) -> bool {
        false
    }
}

impl CrowdLaw {
    fn of(law: impl Completes<Sensed, Input = Twist> + Send + 'static) -> Self {
        Self(Box::new(law))
    }
}

impl Control<Sensed> for CrowdControl {
    type Law = CrowdLaw;

    fn begin(&self, y: &Sensed, begin: Begin) -> CrowdLaw {
        match &self.0 {
            AnyControl::Go(quark) => CrowdLaw::of(Endless(quark.begin(y, begin))),
            AnyControl::Stop(quark) => CrowdLaw::of(Endless(quark.begin(y, begin))),
            AnyControl::Rotate(quark) => CrowdLaw::of(quark.begin(y, begin)),
            AnyControl::Turn(quark) => CrowdLaw::of(quark.begin(y, begin)),
            AnyControl::Advance(quark) => CrowdLaw::of(quark.begin(y, begin)),
            AnyControl::GoAvoid(quark) => CrowdLaw::of(quark.begin(y, begin)),
            AnyControl::GoAvoid2(quark) => CrowdLaw::of(Endless(quark.begin(y, begin))),
            AnyControl::Align(quark) => CrowdLaw::of(quark.begin(y, begin)),
            AnyControl::Follow(quark) => CrowdLaw::of(quark.begin(y, begin)),
            AnyControl::Lead(quark) => CrowdLaw::of(quark.begin(y, begin)),
            AnyControl::Slot(quark) => CrowdLaw::of(Endless(quark.begin(y, begin))),
            AnyControl::Path(quark) => CrowdLaw::of(quark.begin(y, begin)),
        }
    }
}

impl Law<Sensed> for CrowdLaw {
    type Input = Twist;

    fn input(&mut self, y: &Sensed, t: Nanos) -> Twist {
        self.0.input(y, t)
    }

    fn stalled(&self, y: &Sensed, t: Nanos) -> Option<Nanos> {
        self.0.stalled(y, t)
    }
}

impl Completes<Sensed> for CrowdLaw {
    fn completed(&self, y: &Sensed, t: Nanos) -> bool {
        self.0.completed(y, t)
    }
}

impl Alphabet for CrowdAlphabet {
    type Output = Sensed;
    type Input = Twist;
    type Interrupt = AnyInterrupt;
    type Signal = AnySignal;
    type Control = CrowdControl;
    type Law = CrowdLaw;

    const NAME: &'static str = SimAlphabet::NAME;
    const HASH: u64 = SimAlphabet::HASH;
    const CAPABILITIES: &'static [&'static str] = SimAlphabet::CAPABILITIES;
    const LIMITS: &'static [Limit] = SimAlphabet::LIMITS;

    fn interrupt(name: &str, arguments: &[Argument<'_>]) -> Option<AnyInterrupt> {
        SimAlphabet::interrupt(name, arguments)
    }

    fn signal(name: &str, arguments: &[Argument<'_>]) -> Option<AnySignal> {
        SimAlphabet::signal(name, arguments)
    }

    fn comparison(comparison: Comparison<AnySignal, AnySignal>) -> Option<AnyInterrupt> {
        SimAlphabet::comparison(comparison)
    }

    fn control(name: &str, arguments: &[Argument<'_>]) -> Option<CrowdControl> {
        SimAlphabet::control(name, arguments).map(CrowdControl)
    }
}

#[cfg(test)]
mod tests {
    use mdle_compiler::load::LoadedPlan;
    use mdle_runtime::Machine;

    use super::*;

    #[test]
    fn a_law_takes_only_its_own_memory() {
        let (all, own) =
            (size_of::<Machine<LoadedPlan<SimAlphabet>>>(), size_of::<Machine<LoadedPlan<CrowdAlphabet>>>());
        assert!(own < 400 && own + size_of::<<SimAlphabet as Alphabet>::Law>() < all + 100, "{own} and {all} bytes");
    }
}
