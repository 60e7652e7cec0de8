//! A mutant: a single small fault in a file of the checkout.

use std::collections::BTreeMap;
use std::fmt;
use std::ops::Range;

use crate::finder;

/// A fault in the code.
#[derive(Debug, Clone)]
pub(crate) struct Mutant {
    /// Index of the mutant's area in the list of areas.
    pub(crate) area: usize,
    /// Path of the mutated file from the root of the repository.
    pub(crate) file: String,
    /// Name of the function or constant that contains the change.
    pub(crate) function: String,
    /// Description of the change, which is unique within the function.
    pub(crate) change: String,
    line: usize,
    /// Range of bytes whose text `new` replaces.
    pub(crate) place: Range<usize>,
    pub(crate) new: String,
}

impl Mutant {
    /// Returns the text of the file with the fault.
    pub(crate) fn apply(&self, text: &str) -> String {
        [&text[..self.place.start], &self.new, &text[self.place.end..]].concat()
    }
}

impl fmt::Display for Mutant {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{} {}: {}", self.file, self.line, self.function, self.change)
    }
}

/// Returns all mutants of a file.
///
/// # Errors
/// Fails if the text is not Rust.
pub(crate) fn mutants(area: usize, file: &str, text: &str) -> syn::Result<Vec<Mutant>> {
    let mut seen = BTreeMap::new();
    let mutants = finder::changes(text)?.into_iter().map(|found| {
        let line = text[..found.place.start].matches('\n').count() + 1;
        let change = in_words(text, line, &found);
        let number =
            seen.entry((found.function.clone(), change.clone())).and_modify(|number| *number += 1).or_insert(1);
        let change = if *number == 1 { change } else { format!("{change}, number {number}") };
        let finder::Change { place, new, function } = found;
        Mutant { area, file: file.to_owned(), function, change, line, place, new }
    });
    Ok(mutants.collect())
}

/// Returns a description of the change that quotes its line. The description remains valid if other parts of the file
/// change.
fn in_words(text: &str, line: usize, found: &finder::Change) -> String {
    let old = short(&text[found.place.clone()]);
    let line = short(text.lines().nth(line - 1).unwrap_or_default());
    let becomes =
        if found.new.is_empty() { "is left out".to_owned() } else { format!("becomes `{}`", short(&found.new)) };
    if line == old { format!("`{old}` {becomes}") } else { format!("`{old}` {becomes} in `{line}`") }
}

/// Returns a text as a single line, without its middle part if it is long.
fn short(text: &str) -> String {
    const ENDS: usize = 45;
    let text = text.split_whitespace().collect::<Vec<_>>().join(" ");
    let letters: Vec<_> = text.chars().collect();
    if letters.len() <= 2 * ENDS {
        return text;
    }
    let ends = [&letters[..ENDS], &letters[letters.len() - ENDS..]].map(|end| end.iter().collect::<String>());
    ends.map(|end| end.trim().to_owned()).join(" … ")
}

#[cfg(test)]
mod tests {
    use super::mutants;

    /// Returns the texts that result from all changes, one per line.
    fn changed(text: &str) -> String {
        let texts = mutants(0, "file.rs", text).unwrap().into_iter().map(|mutant| mutant.apply(text));
        texts.map(|text| text.split_whitespace().collect::<Vec<_>>().join(" ") + "\n").collect()
    }

    #[test]
    fn expressions_change() {
        insta::assert_snapshot!(changed("fn f() { a.first - y.max(2) == 0.0 && !c || d(e, Some(g)) < 0..=h[0] }"));
        insta::assert_snapshot!(changed("fn f() { (a.then(b), [\"c\", \"d\"].skip(2), T { p: q, ..r }, -true) }"));
    }

    #[test]
    fn statements_and_arms_change() {
        insta::assert_snapshot!(changed(
            "fn f() { if a { return; } while b { c(); break; } d = e; let g = h; *i += j; k }"
        ));
        insta::assert_snapshot!(changed("fn f() { match x { A if a => b, B => { c } D => e } }"));
    }

    #[test]
    fn templates_change() {
        insta::assert_snapshot!(changed("fn f() { quote!(#[doc = #doc] f(#a, #b, c) >= 1 && !#d => first) }"));
        insta::assert_snapshot!(changed("fn f() { (quote!(#a.or_else(|| #b)), quote!(&)) }"));
    }

    #[test]
    fn tests_types_and_attributes_stay_as_they_are() {
        assert_eq!(changed("#[cfg(test)]\nmod tests { fn f() { 1 + 1; } }\n#[a(1)]\ntype T = [u8; 1];"), "");
    }

    #[test]
    fn a_change_is_named_after_its_line_and_not_its_number() {
        let changes = |text| {
            let mutants = mutants(0, "file.rs", text).unwrap();
            mutants.into_iter().map(|mutant| (mutant.function, mutant.change)).collect::<Vec<_>>()
        };
        let once = changes("fn f() { a < b }");
        assert_eq!(once, [("f".to_owned(), "`<` becomes `<=` in `fn f() { a < b }`".to_owned())]);
        assert_eq!(once, changes("// More.\n\nfn f() { a < b }"));
        let twice = changes("fn f() { g(a < b, a < b) }");
        assert_eq!(twice[1].1, format!("{}, number 2", twice[0].1));
    }
}
