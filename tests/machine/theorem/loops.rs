//! Generates random plans with nested endless loops and without repeated interrupts.

use mdle_tests::chance::Chance;

/// Returns the text of a plan `Main` with about `atoms` atoms.
pub(crate) fn plan_of_loops(chance: &mut Chance, atoms: usize) -> String {
    let mut waits = 0;
    let body = sequence(chance, atoms, &mut waits);
    let condition = if chance.percent(50) { "null" } else { "a" };
    format!("{{ Main ({condition}) {body}}}\n")
}

/// Returns a condition that differs from all earlier ones.
fn condition(waits: &mut usize) -> String {
    *waits += 1;
    format!("wait {waits}")
}

fn sequence(chance: &mut Chance, atoms: usize, waits: &mut usize) -> String {
    let mut left = atoms.max(1);
    let mut text = String::new();
    while left > 0 {
        let part = 1 + chance.below(left);
        left -= part;
        text += &element(chance, part, waits);
    }
    text
}

fn element(chance: &mut Chance, atoms: usize, waits: &mut usize) -> String {
    let choice = chance.below(10);
    if atoms == 1 && choice < 5 {
        return format!("(Atom ({}) {}) ", condition(waits), chance.pick(&["idle", "drift", "seek", "climb"]));
    }
    let inside = sequence(chance, if choice < 5 { atoms - 1 } else { atoms }, waits);
    match choice {
        0..=4 => format!("{{ B ({}) {inside}(Atom ({}) idle) }} ", condition(waits), condition(waits)),
        5..=7 => format!("({inside})^inf "),
        _ => format!("({{ B ({}) {inside}}})^inf ", condition(waits)),
    }
}
