//! Finds changes inside `quote!`, in tokens of emitted code, which are not all complete expressions.

use std::ops::Range;

use proc_macro2::{Delimiter, Group, TokenStream, TokenTree};

use crate::operators::{mistaken, neighbours};

/// Calls `change` with each range that can be changed in these tokens and its new text, or with `None` to leave the
/// range out. `text` is the file with the tokens.
pub(crate) fn changes(text: &str, tokens: TokenStream, change: &mut impl FnMut(Range<usize>, Option<String>)) {
    let mut values = Vec::new();
    interpolated(tokens.clone(), &mut values);
    if let [one, other] = &*values {
        let between = &text[one.end..other.start];
        change(one.start..other.end, Some([&text[other.clone()], between, &text[one.clone()]].concat()));
    }
    inside(tokens, change);
}

/// Appends the ranges of all interpolated values to `values`.
fn interpolated(tokens: TokenStream, values: &mut Vec<Range<usize>>) {
    let mut hash = None;
    for token in tokens {
        match (&token, hash) {
            (TokenTree::Group(group), _) => interpolated(group.stream(), values),
            (TokenTree::Ident(_), Some(start)) => values.push(start..range(&token).end),
            (TokenTree::Ident(_) | TokenTree::Literal(_) | TokenTree::Punct(_), _) => {}
        }
        hash = is(&token, '#').then_some(range(&token).start);
    }
}

fn inside(tokens: TokenStream, change: &mut impl FnMut(Range<usize>, Option<String>)) {
    let tokens: Vec<_> = tokens.into_iter().collect();
    if let [one] = &*tokens
        && let Some(other) = [('&', "|"), ('|', "&")].into_iter().find(|(operator, _)| is(one, *operator))
    {
        change(range(one), Some(other.1.to_owned()));
    }
    for (number, token) in tokens.iter().enumerate() {
        let before = number.checked_sub(1).and_then(|number| tokens.get(number));
        let next = tokens.get(number + 1);
        match token {
            TokenTree::Group(group) => {
                let is_attribute =
                    group.delimiter() == Delimiter::Bracket && before.is_some_and(|token| is(token, '#'));
                if !is_attribute {
                    exchange(group, change);
                    inside(group.stream(), change);
                }
            }
            TokenTree::Ident(name) if !before.is_some_and(|token| is(token, '#')) => {
                let opposite = match name.to_string().as_str() {
                    "true" => Some("false"),
                    "false" => Some("true"),
                    name => mistaken(name),
                };
                if let Some(other) = opposite {
                    change(range(token), Some(other.to_owned()));
                }
            }
            TokenTree::Ident(_) => {}
            TokenTree::Literal(literal) => {
                neighbours(&literal.to_string(), "").into_iter().for_each(|new| change(range(token), Some(new)));
            }
            TokenTree::Punct(_) => match next {
                Some(next) if is(token, '>') && is(next, '=') && range(token).end == range(next).start => {
                    change(range(next), None);
                }
                Some(next) if (is(token, '!') || is(token, '-')) && is(next, '#') => change(range(token), None),
                Some(_) | None => {}
            },
        }
    }
}

/// Calls `change` for each pair of interpolated values next to each other in a list, with the two values exchanged.
fn exchange(list: &Group, change: &mut impl FnMut(Range<usize>, Option<String>)) {
    let tokens: Vec<_> = list.stream().into_iter().collect();
    let items: Vec<_> = tokens.split(|token| is(token, ',')).collect();
    for pair in items.windows(2) {
        if let [[hash, TokenTree::Ident(one)], [other_hash, TokenTree::Ident(other)]] = pair
            && is(hash, '#')
            && is(other_hash, '#')
        {
            let place = range(hash).start..other.span().byte_range().end;
            change(place, Some(format!("#{other}, #{one}")));
        }
    }
}

fn is(token: &TokenTree, sign: char) -> bool {
    matches!(token, TokenTree::Punct(punct) if punct.as_char() == sign)
}

fn range(token: &TokenTree) -> Range<usize> {
    token.span().byte_range()
}
