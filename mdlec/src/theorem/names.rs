//! Names of states and interrupts as MDLe has names: letters, digits and `_`, no two alike, and none that means something else.

use std::collections::{BTreeMap, BTreeSet};

use mdle_runtime::Printable;

use super::Machine;
use crate::syntax::is_law;

/// What is no name, in capitals.
const RESERVED: &[&str] = &[
    "ATOM",
    "EXECPLAN",
    "OR",
    "AND",
    "NOT",
    "RISING",
    "USE",
    "NULL",
    "MODULE",
    "AFTER",
    "FRAME",
    "SIGMA_NULL",
    "INF",
    "INFINITY",
];

/// The names that are taken, and how many are made of one.
#[derive(Default)]
pub(super) struct Names {
    taken: BTreeSet<String>,
    made: BTreeMap<String, usize>,
}

/// The texts that stand for a machine's laws and interrupts.
pub(super) struct Texts {
    /// The law of each state but the last.
    pub(super) laws: Vec<String>,
    /// The condition of each interrupt.
    pub(super) conditions: Vec<String>,
    /// The interrupts that are called something else, as what, and what the file calls them.
    pub(super) renamed: Vec<(String, String)>,
}

impl Names {
    /// A name like this one that nothing else has.
    pub(super) fn name(&mut self, like: &str) -> String {
        let mut name: String = like.chars().map(|letter| if is_in_names(letter) { letter } else { '_' }).collect();
        let begins_well = name.chars().next().is_some_and(|first| is_law(&first.to_string()));
        let is_label = ["Γ_", "Gamma_", "σ_"].iter().any(|label| name.starts_with(label));
        if !begins_well || is_label {
            name.insert(0, '_');
        }
        let made = self.made.entry(name.clone()).or_insert(1);
        let mut free = name.clone();
        while self.taken.contains(&free) || RESERVED.contains(&free.to_uppercase().as_str()) {
            *made += 1;
            free = format!("{name}_{made}");
        }
        self.taken.insert(free.clone());
        free
    }
}

/// The texts of a machine, and the names that they take.
pub(super) fn texts(machine: &Machine) -> (Texts, Names) {
    let mut names = Names::default();
    // What stands in texts is somebody's name already.
    let of_interrupts = machine.interrupts().iter().filter_map(|interrupt| interrupt.text.as_deref());
    for text in of_interrupts.chain(machine.laws.iter().flatten().map(String::as_str)) {
        names.taken.extend(words(text).map(str::to_owned));
    }
    let laws = match &machine.laws {
        Some(laws) => laws.clone(),
        None => machine.atoms().map(|state| names.name(machine.name(state))).collect(),
    };
    let mut renamed = Vec::new();
    let conditions = machine.interrupts().iter().map(|interrupt| {
        // Which labels `after` asks, the file does not say.
        let is_whole = |text: &&String| !words(text).any(|word| word == "after");
        if let Some(text) = interrupt.text.as_ref().filter(is_whole) {
            return text.clone();
        }
        let name = names.name(&interrupt.name);
        if name != interrupt.name || interrupt.text.is_some() {
            let means = interrupt.text.as_ref().unwrap_or(&interrupt.name);
            renamed.push((name.clone(), means.clone()));
        }
        name
    });
    let conditions = conditions.collect();
    (Texts { laws, conditions, renamed }, names)
}

/// The words of a text.
pub(super) fn words(text: &str) -> impl Iterator<Item = &str> {
    text.split(|letter: char| !letter.is_alphanumeric() && letter != '_').filter(|word| !word.is_empty())
}

/// Returns `true` if a name may have this letter after its first one.
fn is_in_names(letter: char) -> bool {
    letter.is_ascii_alphanumeric() || letter == '_' || !letter.is_ascii() && is_law(&format!("_{letter}"))
}

/// A text on one line of a comment.
pub(super) fn in_a_comment(text: &str) -> String {
    Printable(text).to_string()
}
