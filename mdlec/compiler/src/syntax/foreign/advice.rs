//! Words of other languages, and the forms of MDLe that replace them.

/// Returns `true` if a name is a word of other languages, which may have to be replaced.
pub(super) fn is_word(name: &str) -> bool {
    matches!(
        name,
        "if" | "If"
            | "IF"
            | "when"
            | "unless"
            | "switch"
            | "else"
            | "Else"
            | "ELSE"
            | "elif"
            | "elseif"
            | "otherwise"
            | "while"
            | "While"
            | "WHILE"
            | "until"
            | "Until"
            | "UNTIL"
            | "repeat"
            | "Repeat"
            | "REPEAT"
            | "loop"
            | "Loop"
            | "for"
            | "For"
            | "forever"
            | "import"
            | "include"
            | "require"
            | "break"
            | "continue"
            | "return"
            | "goto"
            | "def"
            | "function"
            | "fn"
            | "func"
            | "procedure"
            | "let"
            | "var"
            | "const"
            | "int"
            | "float"
            | "parallel"
            | "Parallel"
            | "PARALLEL"
            | "par"
            | "concurrent"
            | "concurrently"
            | "simultaneously"
            | "async"
            | "spawn"
            | "fork"
            | "sequence"
            | "Sequence"
            | "SEQUENCE"
            | "seq"
    )
}

/// Returns the form of MDLe that replaces a word of another language; `None` if there is no such form.
pub(crate) fn advice(word: &str) -> Option<String> {
    advice_for(word, "r0 < 1m")
}

/// Returns the form of MDLe that replaces a word and the condition that follows it.
pub(super) fn advice_for(word: &str, condition: &str) -> Option<String> {
    let is_joined = condition.contains(" OR ") || condition.contains(" AND ");
    let opposite = match condition.strip_prefix("NOT ") {
        Some(operand) if !is_joined => operand.to_owned(),
        _ if is_joined => format!("NOT ({condition})"),
        _ => format!("NOT {condition}"),
    };
    Some(match word {
        "if" | "If" | "IF" | "when" | "unless" | "switch" => {
            let condition = if word == "unless" { condition } else { &opposite };
            format!(
                "an element is skipped while its interrupt holds, so give it the opposite of the condition: \
                 `{{ Branch ({condition}) (Atom (wait 5) stop) }}`"
            )
        }
        "else" | "Else" | "ELSE" | "elif" | "elseif" | "otherwise" => {
            "an element is skipped while its interrupt holds, so give each branch an interrupt: \
             `{ Near (NOT r0 < 1m) (Atom (wait 5) stop) }` and `{ Far (r0 < 1m) (Atom (wait 5) (go 20 0)) }`"
                .to_owned()
        }
        "while" | "While" | "WHILE" => format!(
            "a loop runs until an interrupt around it fires, so give it the opposite of the condition: \
             `{{ Loop ({opposite}) ExecPlan inf {{ (Atom (wait 5) stop) }} }}`"
        ),
        "until" | "Until" | "UNTIL" => format!(
            "a loop runs until an interrupt around it fires: `{{ Loop ({condition}) ExecPlan inf {{ (Atom (wait 5) stop) }} }}`"
        ),
        "repeat" | "Repeat" | "REPEAT" | "loop" | "Loop" | "for" | "For" | "forever" => {
            "a loop is written `ExecPlan 3 { (Atom (wait 5) stop) }`, a loop without end `ExecPlan inf { … }`"
                .to_owned()
        }
        "import" | "include" | "require" => {
            "other files are named at the top of the file: `use \"corridors.mdle\"`".to_owned()
        }
        "goto" => {
            "a plan has no jumps: what is repeated is in a loop, as in `ExecPlan 3 { (Atom (wait 5) stop) }`".to_owned()
        }
        "break" | "continue" | "return" => {
            "an interrupt ends what is in its scope: `{ Drive (bumper) ExecPlan inf { (Atom (wait 5) (go 20 0)) } }`"
                .to_owned()
        }
        "parallel" | "Parallel" | "PARALLEL" | "par" | "concurrent" | "concurrently" | "simultaneously" | "async"
        | "spawn" | "fork" => {
            "a robot runs one law at a time; what has to be watched at the same time is joined in a condition: \
             `(Atom (bumper OR wait 5) (go 20 0))`"
                .to_owned()
        }
        "sequence" | "Sequence" | "SEQUENCE" | "seq" => {
            "elements run one after the other as they are written; to group them, write `{ Name … }` or `( … )`"
                .to_owned()
        }
        "def" | "function" | "fn" | "func" | "procedure" => {
            "a plan is written `{ Name (Atom (wait 5) stop) }` and used by its name".to_owned()
        }
        "let" | "var" | "const" | "int" | "float" => {
            "a plan has no variables, but it may take parameters: `{ Leg(d: length) (Atom (null) (goAvoid 0 d)) }`"
                .to_owned()
        }
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_word_has_an_advice() {
        for word in
            ["if", "else", "while", "until", "repeat", "import", "break", "def", "let", "parallel", "seq", "go", "Leg"]
        {
            assert_eq!(is_word(word), advice(word).is_some(), "{word}");
        }
    }
}
