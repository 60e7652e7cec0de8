//! Generates random plans that drive a simulated robot.

use std::fmt::Write as _;

use crate::chance::Chance;

/// Returns a random plan for the simulated robot, with nested behaviors, loops, frames, memories, and laws that drive.
#[must_use]
pub fn random_plan(chance: &mut Chance) -> String {
    let mut text = String::from("{ Main (wait 90)\n");
    let mut labels = 0;
    strings(chance, &mut text, 3, &mut labels);
    text + "}\n"
}

/// Appends random elements to a behavior. `depth` is the maximum depth of behaviors nested in it.
fn strings(chance: &mut Chance, text: &mut String, depth: usize, labels: &mut usize) {
    for _ in 0..1 + chance.below(4) {
        let frame = chance.pick(&["", "", "FRAME 45 ", "FRAME here "]);
        let times = chance.pick(&["", "", "^2", "^3"]);
        if depth > 0 && chance.percent(45) {
            *labels += 1;
            let (name, condition) = (*labels, condition(chance, 2));
            let _ = writeln!(text, "{{ Part{name} ({condition}) ");
            strings(chance, text, depth - 1, labels);
            let _ = writeln!(text, "}}");
        } else {
            let law = chance.pick(&[
                "go 20 0",
                "go 30cm/s 10deg/s",
                "go 0 -1",
                "rotate 90",
                "rotate -45",
                "goAvoid 90 40 20",
                "goAvoid 0 30 30",
                "stop",
                "align 3 5",
            ]);
            let condition = condition(chance, 2);
            let _ = writeln!(text, "{frame}(Atom ({condition} OR wait {}) {law}){times}", 1 + chance.below(6));
        }
    }
}

/// Returns a random condition with nested operators.
fn condition(chance: &mut Chance, depth: usize) -> String {
    if depth > 0 && chance.percent(40) {
        let (one, other) = (condition(chance, depth - 1), condition(chance, depth - 1));
        return match chance.below(4) {
            0 => format!("({one}) AND ({other})"),
            1 => format!("({one}) OR ({other})"),
            2 => format!("NOT ({one})"),
            _ => format!("RISING ({one})"),
        };
    }
    let simple = ["bumper", "r0 < 60cm", "r3 < r5", "r12 > 1.5m", "x > 3m", "theta > 30deg", "atIsection 0100"];
    match chance.below(3) {
        0 => format!("wait {}", 1 + chance.below(9)),
        1 => format!("way > {}cm", 10 + chance.below(200)),
        _ => chance.pick(&simple).to_owned(),
    }
}
