//! Texts in this repository that the compiler reads: plans, examples, the fuzzing corpus, and literals in tests.

use std::fs;

use mdle_compiler::diagnostic::Code;
use proc_macro2::{TokenStream, TokenTree};

use crate::any_text;
use crate::repository::{files, root};

/// Returns the texts of the fuzzing corpus, the plans, and the examples in explanations, each with its origin.
///
/// # Panics
/// If a file cannot be read.
#[must_use]
pub fn kept() -> Vec<(String, String)> {
    let kept = fs::read_dir(root().join("tests/fuzz/corpus")).expect("a folder").map(|entry| {
        let path = entry.expect("an entry").path();
        (path.display().to_string(), any_text::text(&fs::read(&path).expect("a file")))
    });
    let plans = files(&[".mdle"]).into_iter().map(|file| (file.path, file.text));
    let examples = Code::ALL.iter().flat_map(|code| {
        let explanation = code.explanation();
        let examples = [explanation.wrong(), explanation.right()].into_iter().flatten();
        examples.map(move |example| (format!("the explanation of {code}"), example.text))
    });
    let mut texts: Vec<_> = kept.chain(plans).chain(examples).collect();
    texts.sort();
    texts
}

/// Returns every string literal in the Rust code of this repository that looks like a plan, such as bad input in tests,
/// with its file.
#[must_use]
pub fn literals() -> Vec<(String, String)> {
    let mut texts = Vec::new();
    // Tests of the language server are left out: their plans contain a mark for the cursor.
    for file in files(&[".rs"]).into_iter().filter(|file| !file.path.starts_with("editors/")) {
        let Ok(tokens) = file.text.parse::<TokenStream>() else { continue };
        let mut found = Vec::new();
        strings(tokens, &mut found);
        // In a literal of `format!`, braces are doubled.
        let plans = found.into_iter().map(|text| text.replace("{{", "{").replace("}}", "}"));
        texts.extend(plans.filter(|text| text.contains("{ ")).map(|text| (file.path.clone(), text)));
    }
    texts
}

fn strings(tokens: TokenStream, found: &mut Vec<String>) {
    for token in tokens {
        match token {
            TokenTree::Group(group) => strings(group.stream(), found),
            TokenTree::Literal(literal) => {
                found.extend(syn::parse_str::<syn::LitStr>(&literal.to_string()).ok().map(|text| text.value()));
            }
            TokenTree::Ident(_) | TokenTree::Punct(_) => {}
        }
    }
}
