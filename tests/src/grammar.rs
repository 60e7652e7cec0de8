//! The productions of the grammar of plans, with the parts of each production, read from the parser generator's input
//! file.

use crate::repository::root;

/// An alternative of a production, in the form `Name = parts`, without the names that its action gives to the parts.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct Production {
    /// Text of the production.
    pub text: String,
    /// `true` if the production only occurs in texts with errors.
    pub recovers: bool,
}

impl Production {
    /// Returns the optional parts of the production in a text without errors, each as `Name … option?`.
    #[must_use]
    pub fn options(&self) -> Vec<String> {
        let mut options = Vec::new();
        if self.recovers {
            return options;
        }
        let name = self.text.split(' ').next().expect("a name");
        for (end, _) in self.text.match_indices('?') {
            let before = &self.text[..end];
            let start = match before.strip_suffix(')') {
                Some(group) => group.rfind('('),
                None => before.rfind(' ').map(|blank| blank + 1),
            };
            options.push(format!("{name} … {}", &self.text[start.expect("an option")..=end]));
        }
        options
    }
}

/// Returns every production of `grammar.lalrpop` except those of tokens, whose spellings are not part of the grammar.
#[must_use]
pub fn productions() -> Vec<Production> {
    let path = root().join("mdlec/compiler/src/syntax/grammar.lalrpop");
    let text = std::fs::read_to_string(path).expect("the grammar");
    let (_, rules) = text.split_once("\npub(crate) File").expect("the first production");
    let (rules, _) = rules.split_once("// ---- Tokens ----").expect("the tokens are last");
    let rules = format!("File{rules}");
    let (mut productions, mut name, mut written) = (Vec::new(), "", String::new());
    for line in rules.lines().map(str::trim).filter(|line| !line.starts_with("//") && !line.starts_with("#[")) {
        let line = match line.split_once(" = ") {
            Some((head, rest)) if head.split_once(": ").is_some_and(|(name, _)| is_name(name)) => {
                name = head.split_once(": ").expect("a type").0;
                rest
            }
            Some(_) | None => line,
        };
        if !matches!(line, "{" | "};" | "") {
            written = format!("{written} {line}");
        }
        if let Some((parts, action)) = written.split_once("=>")
            && action.trim_end().ends_with([',', ';'])
        {
            let text = format!("{name} = {}", made_of(parts));
            productions.push(Production { recovers: text.contains('!'), text });
            written.clear();
        }
    }
    productions
}

fn is_name(text: &str) -> bool {
    text.starts_with(char::is_uppercase) && text.chars().all(char::is_alphanumeric)
}

/// Returns the parts of a production without their names in the action, and without source positions.
fn made_of(parts: &str) -> String {
    let named = |word: &str| match word.split_once(':') {
        Some((_, "@L" | "@R")) => String::new(),
        Some((_, part)) => part.to_owned(),
        None => word.to_owned(),
    };
    // Quoted text is a token.
    let pieces = parts.split('"').enumerate().map(|(number, piece)| match number % 2 {
        0 => piece.replace(['<', '>'], "").split(' ').map(named).collect::<Vec<_>>().join(" "),
        _ => format!("\"{piece}\""),
    });
    pieces.collect::<String>().split(' ').filter(|word| !word.is_empty()).collect::<Vec<_>>().join(" ")
}
