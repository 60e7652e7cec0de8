//! Parses labels of plans, such as `Γ_from^to` (docs/src/reference/language.md, 2). Determines their length in the
//! text, and their words without typesetting.

use std::borrow::Cow;

use logos::{Lexer, Logos};

use crate::alphabet::word;

/// A part of a label. These parts are not in the lexer of plans, in which a word does not begin with a digit.
#[derive(Logos, Debug, Clone, Copy, PartialEq, Eq)]
enum LabelPart {
    #[regex(r"[A-Za-z0-9_]+", |lexer| word(lexer).map(drop))]
    #[regex(r"[^\x00-\x7F]", |lexer| word(lexer).map(drop), priority = 1)]
    Word,
    #[regex(r"\s+")]
    Space,
    #[token("{")]
    Open,
    #[token(r"\text{")]
    Text,
    #[token("}")]
    Close,
    #[token("^")]
    Caret,
}

/// Returns the length in bytes of the label at the start of `text`; `None` if there is no label.
pub(super) fn label_length(text: &str) -> Option<usize> {
    let start = ["Γ_", "Gamma_", r"\Gamma_"].into_iter().find(|start| text.starts_with(start))?;
    let name = name_length(text.get(start.len()..)?)?;
    let to = start.len() + name;
    let behind = text.get(to..)?.strip_prefix('^');
    Some(behind.and_then(name_length).map_or(to, |name| to + 1 + name))
}

/// Returns the length, in bytes, of the name at the start of `text`. A name is a word, or words in braces, which may be
/// the braces of `\text`.
fn name_length(text: &str) -> Option<usize> {
    let mut parts = LabelPart::lexer(text);
    match parts.next()?.ok()? {
        LabelPart::Word => return Some(parts.span().end),
        LabelPart::Open => {}
        LabelPart::Space | LabelPart::Text | LabelPart::Close | LabelPart::Caret => return None,
    }
    let mut words = 0;
    let mut next = parts.next()?.ok()?;
    // A space before `\text` does not belong to the words.
    let mut ahead = parts.clone();
    if next == LabelPart::Space && follows(&mut ahead, LabelPart::Text) {
        (parts, next) = (ahead, LabelPart::Text);
    }
    if next == LabelPart::Text {
        next = parts.next()?.ok()?;
    }
    while matches!(next, LabelPart::Word | LabelPart::Space) {
        words += 1;
        next = parts.next()?.ok()?;
    }
    (words > 0 && next == LabelPart::Close).then(|| {
        let one = parts.span().end;
        let mut second = parts.clone();
        let closes = match second.next() {
            Some(Ok(LabelPart::Space)) => follows(&mut second, LabelPart::Close),
            other => other == Some(Ok(LabelPart::Close)),
        };
        if closes { second.span().end } else { one }
    })
}

fn follows(parts: &mut Lexer<'_, LabelPart>, part: LabelPart) -> bool {
    parts.next() == Some(Ok(part))
}

/// Returns the text of a label in normalized form: `Γ_from^to`.
pub(super) fn label(text: &str) -> Cow<'_, str> {
    if text.starts_with('Γ') && !text.contains('{') {
        return Cow::Borrowed(text);
    }
    let names = text.find('_').and_then(|at| text.get(at..)).unwrap_or("");
    let mut label = String::with_capacity(text.len() + 1);
    label.push('Γ');
    for part in names.split(r"\text") {
        label.extend(part.chars().filter(|c| !c.is_whitespace() && !matches!(c, '{' | '}')));
    }
    Cow::Owned(label)
}

#[cfg(test)]
mod tests {
    use super::label_length;

    #[test]
    fn label_ends_after_its_longest_form() {
        for (label, behind) in [
            ("Γ_a", ""),
            ("Γ_a", " ^b"),
            ("Γ_a^b", "^c"),
            ("Gamma_1^2", "=x"),
            ("\\Gamma_{a}^{b}", " ="),
            ("Γ_a", "^{b"),
            ("Γ_a", "^"),
            ("Γ_{ }^{a b}", "{"),
            ("Γ_{\\text{a b}}", ")"),
            ("Γ_{ \\text{a b} }", ")"),
            ("Γ_{\\text{a}", " b"),
            ("Γ_{a}}", "}"),
            ("Γ_{a} }", " }"),
            ("Γ_{a}", " b"),
            ("Γ_{a\n}", "\\"),
            ("Γ_é9^{ü}", "-"),
        ] {
            let length = label_length(&format!("{label}{behind}"));
            assert_eq!(length, Some(label.len()), "{label}{behind}");
        }
        for text in ["Γ_", "Γ", "Γ_^b", "Γ_{}", "Γ_{\\text{}}", "Γ_{a", "Γ_ a", "\\gamma_a", "Γ_{a-b}", "Γ_{{a}}"]
        {
            assert_eq!(label_length(text), None, "{text}");
        }
    }
}
