// Emitted text for the tests of `link`: a plan that ends at once.
pub struct Nap;

impl Nap {
    pub const fn new() -> Self {
        Self
    }
}

const FSM: ::mdle_runtime::Fsm<'static> = ::mdle_runtime::Fsm {
    brackets: &[::mdle_runtime::fsm::Bracket::scope(0, 0, 0, 0)],
    atoms: &[::mdle_runtime::fsm::Atom { scope: 0, state: 1 }],
    termination: 2,
};

impl ::mdle_runtime::Plan for Nap {
    type Output = ::mdle_rover::Sensed;
    type Input = ();
    type Entered = [::mdle_runtime::Nanos; 1];
    type Left = [u64; 0];

    fn fsm(&self) -> ::mdle_runtime::Fsm<'_> {
        FSM
    }

    fn slots(&self) -> (Self::Entered, Self::Left) {
        ([::mdle_runtime::Nanos::default()], [])
    }

    fn enter(&mut self, _: u32, _: &Self::Output, _: ::mdle_runtime::Begin) {}

    fn next(
        &self,
        _: &::mdle_runtime::Cursor<Self::Entered, Self::Left>,
        _: &Self::Output,
        _: ::mdle_runtime::Nanos,
    ) -> Option<::mdle_runtime::Ending> {
        Some(::mdle_runtime::Cause::Fired(0).into())
    }

    fn input(&mut self, _: &Self::Output, _: ::mdle_runtime::Nanos) {}

    fn law(&self, _: u32) -> &str {
        "null"
    }

    fn condition(&self, _: u32) -> &str {
        "morning"
    }

    fn name(&self, _: u32) -> &str {
        ""
    }
}
