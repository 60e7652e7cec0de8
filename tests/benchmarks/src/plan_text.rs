//! Generates plans of any length in the style of plans that people write: with line breaks, comments, nested behaviors
//! and loops.

use std::fmt::Write;

use mdle_tests::chance::Chance;

/// Interrupts and comparisons, as operands of conditions.
const TESTS: &[&str] = &[
    "bumper",
    "bumper",
    "wait 5",
    "wait 20s",
    "wait 500ms",
    "wait inf",
    "atIsection 0100",
    "atIsection 1001",
    "atIsection(0011)",
    "sync RobotTwo",
    "rendezvous leader",
    "r 3 < 0.5",
    "r(3) == r 5",
    "t >= 12.5",
];

/// Laws, as they are written after an atom's condition.
const LAWS: &[&str] = &[
    "(go 20 0)",
    "(go 0 0.36)",
    "(go 5 -0.25)",
    "go(20cm/s, 0.1rad/s)",
    "(goAvoid 90 40 20)",
    "goAvoid(0deg, 40m, 20cm/s)",
    "(goAvoid 270 12.5)",
    "align 7 9",
    "(align 11 13)",
    "(rotate 90)",
    "rotate(-45deg)",
    "turn 90",
    "Follow leader",
    "(path \"corridor.path\")",
    "goAvoid(heading module)",
    "stop",
];

/// Names of plans.
const NAMES: &[&str] = &[
    "Patrol",
    "Dock",
    "Lab2ToLab1Plan",
    "LabToOfficePlan",
    "Crossing",
    "AvoidPeople",
    "Shake",
    "LookAround",
    "FollowWall",
    "EnterElevator",
    "WaitForLeader",
    "ReturnHome",
];

/// Comments that people write beside their plans.
const COMMENTS: &[&str] = &[
    "// ahead until something is in front",
    "// for at most this long",
    "// the door is on the left",
    "/* measured in the rear corridor */",
    "// then round the corner",
    "// see the tour",
];

/// Loop counts.
const COUNTS: &[&str] = &["2", "3", "3", "5", "10", "inf"];

/// Maximum depth of nested behaviors and loops.
const DEPTH: usize = 6;

/// Returns generated plans of at least `bytes` bytes. Equal seeds give equal plans.
#[must_use]
pub fn plan_text(seed: u64, bytes: usize) -> String {
    let mut writer = Writer { text: String::with_capacity(bytes + 10_000), chance: Chance::new(seed), depth: 0 };
    writer.line("use \"corridors.mdle\"");
    while writer.text.len() < bytes {
        writer.plan();
    }
    writer.text
}

struct Writer {
    text: String,
    chance: Chance,
    depth: usize,
}

impl Writer {
    fn line(&mut self, line: &str) {
        let indent = 2 * self.depth;
        let comment = if self.chance.percent(12) { self.chance.pick(COMMENTS) } else { "" };
        let gap = if comment.is_empty() { "" } else { "    " };
        writeln!(self.text, "{:indent$}{}{gap}{comment}", "", line.trim_end()).unwrap();
    }

    /// Writes a plan at the top level of the file, with a doc comment.
    fn plan(&mut self) {
        self.text.push('\n');
        self.text.push_str("/// From the rear lab door to the front one, and on.\n");
        let label = if self.chance.percent(30) { "Γ_lab2^lab1 = " } else { "" };
        let params = if self.chance.percent(15) { "(v: speed, mask: bits[4]) " } else { "" };
        self.behavior(label, params);
    }

    fn behavior(&mut self, label: &str, params: &str) {
        let name = self.chance.pick(NAMES);
        let number = self.chance.below(100);
        if self.chance.percent(85) {
            let condition = self.condition(1);
            self.line(&format!("{label}{{ {name}{number} {params}{condition}"));
        } else {
            self.line(&format!("{label}{{ {name}{number} {params}"));
            // The first element is an atom: without a condition, a parenthesis after the name would be parsed as the
            // condition.
            self.depth += 1;
            self.atom();
            self.depth -= 1;
        }
        let elements = 3 + self.chance.below(6);
        self.elements(elements);
        self.line("}");
    }

    fn elements(&mut self, number: usize) {
        self.depth += 1;
        for _ in 0..number {
            self.element();
        }
        self.depth -= 1;
    }

    fn element(&mut self) {
        let nests = self.depth < DEPTH;
        match self.chance.below(100) {
            0..12 if nests => self.behavior("", ""),
            12..18 if nests => {
                let times = self.chance.pick(COUNTS);
                self.line(&format!("ExecPlan {times} {{"));
                self.elements(2);
                self.line("}");
            }
            18..22 if nests => {
                let times = self.chance.pick(COUNTS);
                self.line("(");
                self.elements(2);
                self.line(&format!(")^{times}"));
            }
            22..26 => self.reference(),
            _ => self.atom(),
        }
    }

    /// Writes a reference to a plan by its name.
    fn reference(&mut self) {
        let how = self.chance.pick(&["", "FRAME 180deg ", "ExecPlan 3 "]);
        let arguments = if self.chance.percent(30) { "(15cm/s, 0100)" } else { "" };
        let name = self.chance.pick(NAMES);
        self.line(&format!("{how}{name}{arguments}"));
    }

    fn atom(&mut self) {
        let label = if self.chance.percent(5) { "s1: " } else { "" };
        let condition = self.condition(2);
        let law = self.chance.pick(LAWS);
        self.line(&format!("{label}(Atom {condition} {law})"));
    }

    /// Returns a condition in parentheses, inside which parentheses are nested at most `nested` deep.
    fn condition(&mut self, nested: usize) -> String {
        let mut text = format!("({}", self.operand(nested));
        while self.chance.percent(25) {
            let operator = self.chance.pick(&["OR", "OR", "AND"]);
            let operand = self.operand(nested);
            write!(text, " {operator} {operand}").unwrap();
        }
        text + ")"
    }

    fn operand(&mut self, nested: usize) -> String {
        match self.chance.below(100) {
            0..10 if nested > 0 => self.condition(nested - 1),
            10..18 => format!("NOT {}", self.chance.pick(TESTS)),
            18..20 => format!("RISING {}", self.chance.pick(TESTS)),
            20..22 => "after s1".to_owned(),
            22..25 => "null".to_owned(),
            _ => self.chance.pick(TESTS).to_owned(),
        }
    }
}
