//! Source text of the peers of T(N): code that a person could write by hand, with a few lines per atom.

/// Returns the concatenated texts of all atoms.
fn each(atoms: u32, text: impl Fn(u32) -> String) -> String {
    (0..atoms).map(text).collect()
}

/// Returns the input that an atom's law writes, as Rust text.
fn law(atom: u32) -> String {
    format!("Input {{ left: {}.25, right: {atom}.5 }}", atom + 1)
}

/// Returns a machine that is a `match` over the number of the current atom.
pub fn matching(atoms: u32) -> String {
    let arms = each(atoms, |atom| {
        format!(
            "                {atom} => if y.measured >= {}.0 {{ self.state = {} }} else {{ return Turn::Law({}) }},\n",
            atom + 1,
            atom + 1,
            law(atom)
        )
    });
    format!(
        "#[derive(Debug)]
pub struct Match {{ state: u32 }}
impl Robot for Match {{
    fn begin(_: &Output, _: Nanos) -> Self {{ Self {{ state: 0 }} }}
    #[inline(never)]
    fn turn(&mut self, y: &Output, _: Nanos) -> Turn<Input> {{
        if self.state == {atoms} || y.halt {{ self.state = {atoms}; return Turn::Over }}
        loop {{
            match self.state {{
{arms}                _ => return Turn::Over,
            }}
        }}
    }}
}}
"
    )
}

/// Returns a machine of the crate statig. Its macro generates the machine from one function per state.
pub fn statig(atoms: u32) -> String {
    let states = each(atoms, |atom| {
        let next = if atom + 1 == atoms { "over".to_owned() } else { format!("atom_{}", atom + 1) };
        format!(
            "    #[state]
    fn atom_{atom}(context: &mut Option<Turn<Input>>, event: &Output) -> Outcome<State> {{
        if event.halt {{ return Transition(State::over()) }}
        if event.measured >= {}.0 {{ return Transition(State::{next}()) }}
        *context = Some(Turn::Law({}));
        Handled
    }}
",
            atom + 1,
            law(atom)
        )
    });
    format!(
        "#[derive(Debug, Default)]
pub struct Chart;
#[state_machine(initial = \"State::atom_0()\", state(derive(Debug)))]
impl Chart {{
{states}    #[state]
    fn over(context: &mut Option<Turn<Input>>) -> Outcome<State> {{
        *context = Some(Turn::Over);
        Handled
    }}
}}
"
    )
}

/// Returns a machine of the crate smlang: the transitions, and the guards and actions that they name.
pub fn smlang(atoms: u32) -> String {
    let transitions = each(atoms, |atom| {
        let (start, state) = (if atom == 0 { "*" } else { "" }, format!("Atom{atom} + Turn(&'a Output)"));
        let next = if atom + 1 == atoms { "/ end = Over".to_owned() } else { format!("= Atom{}", atom + 1) };
        format!(
            "        {start}{state} [halted] / end = Over,
        {state} [reached_{atom}] {next},
        {state} / write_{atom} = Atom{atom},
"
        )
    });
    let functions = each(atoms, |atom| {
        format!(
            "    fn reached_{atom}(&self, y: &Output) -> Result<bool, ()> {{ Ok(y.measured >= {}.0) }}
    fn write_{atom}(&mut self, _: &Output) -> Result<(), ()> {{ self.turn = Some(PlanTurn::Law({})); Ok(()) }}
",
            atom + 1,
            law(atom)
        )
    });
    format!(
        "statemachine! {{
    transitions: {{
{transitions}        Over + Turn(&'a Output) / end = Over,
    }},
}}
impl StateMachineContext for Context {{
    fn halted(&self, y: &Output) -> Result<bool, ()> {{ Ok(y.halt) }}
    fn end(&mut self, _: &Output) -> Result<(), ()> {{ self.turn = Some(PlanTurn::Over); Ok(()) }}
{functions}}}
"
    )
}
