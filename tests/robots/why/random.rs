//! Tests on random runs that `mdle why` names exactly those operands whose change alone changes the transition. Each
//! operand is changed in the output of the explained turn only.

use std::fs;
use std::path::Path;

use mdle_files::Target;
use mdle_runtime::Sensed;
use mdle_tests::chance::{Chance, sized};
use mdle_tests::executable::folder;
use serde_json::Value;

use super::asked;
use super::scripted::{Scripted, outputs, ping, with_range};

/// Number of turns of a run.
const TURNS: u64 = 12;

/// Returns a plan whose conditions read each sonar once.
fn plan(chance: &mut Chance) -> String {
    let mut sonars = 0..16;
    let mut condition = |chance: &mut Chance| condition(chance, &mut sonars);
    let outer = condition(chance);
    let inner = condition(chance);
    let atoms = [condition(chance), condition(chance)];
    format!(
        "{{ Outer ({outer})\n  {{ Inner ({inner})\n    (Atom ({}) go 20 0)\n    (Atom ({}) go 10 0)\n  }}\n  (Atom (null) \
         stop)\n}}\n",
        atoms[0], atoms[1]
    )
}

/// Returns a condition of at most four operands, each of which reads a different sonar.
fn condition(chance: &mut Chance, sonars: &mut impl Iterator<Item = usize>) -> String {
    let mut operand = |chance: &mut Chance| {
        let not = if chance.percent(25) { "NOT " } else { "" };
        let operator = chance.pick(&["<", ">"]);
        format!("{not}r{} {operator} 1m", sonars.next().unwrap())
    };
    let one = operand(chance);
    if chance.percent(30) {
        return one;
    }
    let two = operand(chance);
    let joined = format!("{one} {} {two}", chance.pick(&["AND", "OR"]));
    if chance.percent(50) {
        return joined;
    }
    format!("({joined}) {} {}", chance.pick(&["AND", "OR"]), operand(chance))
}

/// Returns the number of the sonar that an operand reads.
fn sonar(operand: &str) -> usize {
    let at = operand.find('r').unwrap();
    operand[at + 1..].split(' ').next().unwrap().parse().unwrap()
}

/// Returns outputs in which single ranges sometimes cross the limit, so that not all operands fire at once.
fn random_outputs(chance: &mut Chance) -> Vec<Sensed> {
    let mut ranges = [1.5; 16].map(|range: f64| if chance.percent(50) { range } else { 0.5 });
    outputs(TURNS, |_, y| {
        for (sonar, range) in ranges.iter_mut().enumerate() {
            if chance.percent(8) {
                *range = 2.0 - *range;
            }
            ping(y, sonar, *range);
        }
    })
}

/// Compares the operands that `mdle why` names with the effect of changing each operand, in the first turn with a
/// transition. Returns the number of changed operands and the number of deciding operands, or `None` for a run without
/// a transition.
fn compare(folder: &Path, target: &Target, seed: u64) -> Option<(usize, usize)> {
    let mut chance = Chance::new(seed);
    let (text, outputs) = (plan(&mut chance), random_outputs(&mut chance));
    let plan = Scripted::new(&text, target);
    let steps = |number: usize, changed: Option<Sensed>| {
        let mut until = outputs[..=number].to_vec();
        until[number] = changed.unwrap_or(until[number]);
        plan.last_steps(&until)
    };
    let number = (0..outputs.len()).find(|number| !steps(*number, None).is_empty())?;
    let log = format!("{seed}.mcap");
    plan.record(&outputs, &folder.join(&log));
    let time = format!("{}.{}", number / 10, number % 10);
    let answer = asked(folder, &["why", &log, &time, "--json"]);
    fs::remove_file(folder.join(&log)).unwrap();
    let answer: Value = serde_json::from_str(answer.lines().nth(1).unwrap()).unwrap();
    let scopes = answer["ended"][0]["scopes"].as_array().unwrap();
    let ended = scopes.iter().position(|scope| scope["part"] == "ended").unwrap();
    let original = steps(number, None);
    let (mut changed, mut deciding) = (0, 0);
    for (place, scope) in scopes.iter().enumerate() {
        for operand in scope["operands"].as_array().unwrap() {
            let sonar = sonar(operand["operand"].as_str().unwrap());
            let range = 2.0 - outputs[number].pings[sonar].newest_first().next().unwrap().range.unwrap().0;
            let other = steps(number, Some(with_range(&outputs[number], sonar, range)));
            // Only the first transition was explained; later transitions depend on other operands.
            let differs = original.first() != other.first();
            let named = operand["decided"] == true || place < ended && operand["suffices"] == true;
            assert!(operand["decided"] != true || place == ended, "seed {seed}, turn {number}, {operand}\n{text}");
            assert_eq!(named, differs, "seed {seed}, turn {number}, {operand}\n{text}");
            changed += 1;
            deciding += usize::from(named);
        }
    }
    Some((changed, deciding))
}

#[test]
fn named_operands_alone_change_the_transition() {
    let folder = folder("why-random");
    let target = mdle_files::target(Some("sim")).unwrap();
    let wanted = sized(40, 500);
    let (mut runs, mut changed, mut deciding) = (0, 0, 0);
    for count in (0..).filter_map(|seed| compare(&folder, &target, seed)).take(wanted) {
        runs += 1;
        (changed, deciding) = (changed + count.0, deciding + count.1);
    }
    let counts = format!("{runs} runs: of {changed} operands, {deciding} alone change the transition");
    assert!(runs == wanted && changed > 4 * wanted && deciding > wanted && changed > 2 * deciding, "{counts}");
}
