//! Generates random conditions and laws in all spellings that plans may use.

use crate::chance::Chance;
use crate::signals::comparison;

/// Interrupts of the target `scripted`, with arguments in every unit and notation. All of them are in the target's
/// list.
const INTERRUPTS: &[&str] = &[
    "a",
    "b",
    "c",
    "d",
    "e",
    "f",
    "farOff",
    "farOff 2",
    "farOff(200cm)",
    "farOff 25cm",
    "faster 20",
    "faster(0.2m/s)",
    "faster 5mm/s",
    "facing 90",
    "facing(90deg)",
    "facing -22.5",
    "spinning 0.36",
    "spinning(-1rad/s)",
    "low_battery 10.8V",
    "pattern 0100",
    "pattern(1011)",
    "echo 7",
    "echo(15)",
    "beyond 0.125 -3",
    "beyond(0.125, -3)",
    "beyond(0.125 -3)",
    "beyond (0.125 -3)",
    "beyond 0.125 (-3)",
    "a()",
    "farOff 250mm",
    "farOff 1in",
    "farOff(1ft)",
    "faster 1in/s",
    "faster 20cm/s",
    "spinning 90deg/s",
    "facing(90deg)",
    "low_battery 10.8",
    "played horn",
    "played(\"bell.mid\")",
    "stuck 0.3",
    "stuck(300ms)",
    "stuck 1s",
];

/// Timers. Some are equal to the steps of scripts, so that timers fire just before, at and just after a turn.
const TIMERS: &[&str] = &[
    "wait 0",
    "wait 0.05",
    "wait 100ms",
    "wait(0.2)",
    "wait 0.25",
    "wait 0.3s",
    "wait 1",
    "wait 2.5",
    "wait inf",
    "wait 0.005min",
    "wait 0.001h",
];

/// Laws of the target `scripted` that every notation can write.
const LAWS: &[&str] = &[
    "idle",
    "drift",
    "drive 20 0",
    "(drive 20)",
    "drive(-5cm/s, 0.36)",
    "seek",
    "(climb)",
    "veer 90",
    "veer(-45deg)",
    "veer 1rad",
    "wander 3",
    "wander(50cm, 20ms)",
    "wander 3m (1.5s)",
    "hold 0.5",
    "hold inf",
    "(hold(500ms))",
    "replay \"bell.mid\"",
    "chase(sun module)",
];

/// Laws that can be written only in atoms; in formal notation they would be parsed as plans.
const LAWS_OF_ATOMS: &[&str] = &["chase sun module", "drive (20 0)", "(wander (3 1500ms))"];

/// Returns a random law with its arguments. `is_formal` is `true` for an atom in formal notation.
pub fn law(chance: &mut Chance, is_formal: bool) -> String {
    let choices = if !is_formal && chance.percent(15) { LAWS_OF_ATOMS } else { LAWS };
    chance.pick(choices).to_owned()
}

/// Placeholder of an `after` operand, possibly inside parentheses, until the labels of the definition are known.
pub const AFTER: &str = "AFTER";

/// Returns the texts of the operands of a condition's outermost OR.
pub fn operands(condition: &str) -> Vec<&str> {
    let (mut operands, mut depth, mut from) = (Vec::new(), 0_usize, 0);
    for (at, letter) in condition.char_indices() {
        match letter {
            '(' => depth += 1,
            ')' => depth -= 1,
            ' ' if depth == 0 => {
                let rest = &condition[at..];
                if rest.starts_with(" OR ") || rest.starts_with(" or ") {
                    operands.push(&condition[from..at]);
                    from = at + 4;
                }
            }
            _ => {}
        }
    }
    operands.push(&condition[from..]);
    operands
}

/// Returns a random condition, as it is written between parentheses.
pub fn condition(chance: &mut Chance) -> String {
    match chance.below(10) {
        0 => "null".into(),
        1..=4 => quark(chance),
        5 | 6 => chance.pick(TIMERS).to_owned(),
        _ => or(chance, 2),
    }
}

/// Returns a random quark. A few quarks are more frequent, so that nested scopes often have the same interrupts.
fn quark(chance: &mut Chance) -> String {
    if chance.percent(15) {
        return comparison(chance);
    }
    if chance.percent(10) {
        return AFTER.to_owned();
    }
    if chance.percent(60) { chance.pick(&INTERRUPTS[..3]).to_owned() } else { chance.pick(INTERRUPTS).to_owned() }
}

fn or(chance: &mut Chance, depth: usize) -> String {
    let operands: Vec<_> = (0..=chance.below(3)).map(|_| and(chance, depth)).collect();
    operands.join(if chance.percent(80) { " OR " } else { " or " })
}

fn and(chance: &mut Chance, depth: usize) -> String {
    let more = if chance.percent(40) { 1 + chance.below(2) } else { 0 };
    let operands: Vec<_> = (0..=more).map(|_| not(chance, depth)).collect();
    operands.join(" AND ")
}

fn not(chance: &mut Chance, depth: usize) -> String {
    let test = match chance.below(8) {
        0 => chance.pick(TIMERS).to_owned(),
        1 if chance.percent(20) => "null".into(),
        2 | 3 if depth > 0 => format!("({})", or(chance, depth - 1)),
        _ => quark(chance),
    };
    if chance.percent(15) {
        return if chance.percent(30) { format!("NOT (RISING {test})") } else { format!("RISING {test}") };
    }
    if chance.percent(20) { format!("NOT {test}") } else { test }
}
