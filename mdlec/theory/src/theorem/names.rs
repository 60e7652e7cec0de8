//! Converts names of states and interrupts to names in MDLe, which consist of letters, digits and `_`, are all
//! different, and are not reserved.

use std::collections::{BTreeMap, BTreeSet};

use mdle_runtime::Printable;

use super::Machine;
use mdle_compiler::syntax::is_law;

/// Reserved words, in upper case.
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

/// The names that are in use. For each of them, stores the number of names that were derived from it.
#[derive(Default)]
pub(super) struct UsedNames {
    taken: BTreeSet<String>,
    made: BTreeMap<String, usize>,
}

/// Texts of a machine's laws and interrupts in a plan.
pub(super) struct MachineTexts {
    /// Law of each state except the termination state.
    pub(super) laws: Vec<String>,
    /// Condition of each interrupt.
    pub(super) conditions: Vec<String>,
    /// Renamed interrupts: the new name, and the name in the file.
    pub(super) renamed: Vec<(String, String)>,
}

impl UsedNames {
    /// Returns an unused name that resembles `like`.
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

/// Returns the texts of a machine in a plan, and the names that these texts use.
pub(super) fn texts(machine: &Machine) -> (MachineTexts, UsedNames) {
    let mut names = UsedNames::default();
    // Words in the texts are names that are already in use.
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
        // An FSM file does not contain the labels that `after` refers to.
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
    (MachineTexts { laws, conditions, renamed }, names)
}

/// Returns the words of a text.
pub(super) fn words(text: &str) -> impl Iterator<Item = &str> {
    text.split(|letter: char| !letter.is_alphanumeric() && letter != '_').filter(|word| !word.is_empty())
}

/// Returns `true` if a name may contain this character after its first character.
fn is_in_names(letter: char) -> bool {
    letter.is_ascii_alphanumeric() || letter == '_' || !letter.is_ascii() && is_law(&format!("_{letter}"))
}

/// Escapes a text for a one-line comment.
pub(super) fn in_a_comment(text: &str) -> String {
    Printable(text).to_string()
}
