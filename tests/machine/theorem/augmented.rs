//! Tests the conversion of any machine to a plan with `after`: the plan and the machine are compared turn by turn.

use mdle_compiler::alphabet;
use mdle_compiler::diagnostic::{SourceId, Sources};
use mdle_compiler::trace::{CountedRun, Script, ScriptedInput, run};
use mdle_tests::chance::{Chance, repeated};
use mdle_theory::theorem::{Machine, augment};

use super::machines::{Row, Table, likely, machine};

/// Number of random machines, each with a script of `TURNS` turns.
const MACHINES: u64 = 170;
const TURNS: usize = 60;

/// Returns the trace of a machine, computed directly from its definition: in each turn the machine follows the first
/// interrupt that has fired, until no interrupt has fired.
///
/// States are indices. The trace ends before the first turn that would enter a state twice.
fn states(atoms: usize, rows: &[Row], fired: &[Vec<bool>]) -> Vec<usize> {
    let (mut state, mut trace) = (0, Vec::new());
    for fired in fired {
        let mut entered = vec![false; atoms + 1];
        entered[state] = true;
        while state < atoms {
            let Some(to) = rows.iter().zip(fired).filter(|(_, fired)| **fired).find_map(|(row, _)| row[state]) else {
                break;
            };
            state = to;
            if std::mem::replace(&mut entered[state], true) {
                return trace;
            }
        }
        trace.push(state);
        if state == atoms {
            break;
        }
    }
    trace
}

/// Returns the alphabet of a robot with the laws and interrupts of the machine, with `stop` and with `wait`.
fn alphabet(machine: &Machine) -> alphabet::Alphabet {
    let mut text = "target machine : crate none, period 100ms;\ncontrol stop;\n".to_owned();
    text += "interrupt wait(duration: time s in 0..1e10);\n";
    machine.states().iter().for_each(|state| text += &format!("control {state};\n"));
    machine.interrupts().iter().for_each(|interrupt| text += &format!("interrupt {};\n", interrupt.name));
    let (file, found) = alphabet::read(Sources::default().add("", ""), &text);
    assert_eq!(found, [], "{text}");
    alphabet::combine(file.expect("an alphabet"), &[]).0
}

#[test]
fn the_plan_is_in_the_state_of_the_machine_turn_by_turn() {
    let (mut turns, mut over, mut whole) = (0, 0, 0);
    for seed in 0..repeated(MACHINES) {
        let mut chance = Chance::new(seed);
        let (atoms, interrupts) = (1 + chance.below(6), 1 + chance.below(5));
        let rows: Vec<Row> = match seed % 3 {
            0 => likely(&mut chance, atoms, interrupts),
            _ => (0..interrupts).map(|_| Table::row(chance.below(Table::count(atoms)), atoms)).collect(),
        };
        let machine = machine(atoms, &rows);
        let text = augment(&machine);
        let (compiled, found) = mdle_compiler::compile(SourceId(0), &text, &alphabet(&machine), None);
        let [compiled] = compiled.as_slice() else { panic!("seed {seed}: {found:?}\n{text}") };
        let often = 1 + chance.below(15);
        let fired: Vec<Vec<bool>> =
            (0..TURNS).map(|_| (0..interrupts).map(|_| chance.percent(often)).collect()).collect();
        let lines = (0..TURNS).map(|turn| {
            let names = fired[turn].iter().zip(1..).filter(|(fired, _)| **fired);
            let names: Vec<_> = names.map(|(_, number)| format!("\"x{number}\"")).collect();
            format!("{{\"t\": {turn}, \"fired\": [{}]}}\n", names.join(", "))
        });
        let script = Script::read(&lines.collect::<String>()).expect("a script");
        let expected = states(atoms, &rows, &fired);
        for (turn, (line, state)) in run(CountedRun::new(&compiled.machine), &script).zip(&expected).enumerate() {
            let outcome = &line.outcome;
            assert_eq!((outcome.state - 2) as usize, *state, "seed {seed}, turn {turn}\n{rows:?}\n{text}");
            let is_over = outcome.applied == ScriptedInput::Over;
            assert_eq!(is_over, *state == atoms, "seed {seed}, turn {turn}\n{text}");
            let law = if is_over { ScriptedInput::Over } else { ScriptedInput::Law(&machine.states()[*state]) };
            assert_eq!(outcome.applied, law, "seed {seed}, turn {turn}\n{text}");
            turns += 1;
            over += usize::from(is_over);
        }
        whole += usize::from(expected.len() == TURNS || expected.last() == Some(&atoms));
    }
    println!("{turns} turns, {over} machines over, {whole} to their end");
    let tried = repeated(MACHINES) as usize;
    assert!(turns > tried * 6 && over > tried / 10 && whole > tried / 5, "{turns} {over} {whole}");
}
