//! Formats Rust code. Long lists are formatted in pieces, so that only a small part is parsed and formatted at a time,
//! even if the plan is long.

use std::mem;

use proc_macro2::{Delimiter, Group, Ident, Span, TokenStream, TokenTree};
use quote::quote;

/// Maximum number of elements of a list that are formatted at one time.
const PIECE: usize = 256;
/// Maximum number of columns of a line, as in prettyplease.
const WIDTH: usize = 89;
/// Placeholder for elements that are formatted separately, followed by a number. The placeholder is longer than a line,
/// so it gets a line of its own, as the elements do.
const STAND_IN: &str =
    "the_elements_of_a_long_list_which_are_laid_out_by_themselves_and_then_written_where_this_very_long_name_stands_";

/// Returns the text of a file, with an empty line after each item of the file and of its module. A long list has one
/// element per line; if the elements are numbers, a line contains as many as fit.
pub(super) fn file_text(file: TokenStream) -> String {
    let mut lists = Vec::new();
    let text = pretty(with_gaps(file, &mut lists));
    let mut spaced = String::with_capacity(text.len());
    let mut lines = text.lines().peekable();
    while let Some(line) = lines.next() {
        match list(line).and_then(|number| lists.get_mut(number)) {
            Some(pieces) => write_list(mem::take(pieces), line, &mut spaced),
            None => write_line(line, &mut spaced),
        }
        let ends_item = matches!(line, "}" | "    }");
        if ends_item && lines.peek().is_some_and(|next| *next != "}") {
            spaced.push('\n');
        }
    }
    spaced
}

/// Replaces the elements of each long list in `tokens` with a placeholder, and appends the elements to `lists` in
/// pieces.
fn with_gaps(tokens: TokenStream, lists: &mut Vec<Vec<TokenStream>>) -> TokenStream {
    let tokens = tokens.into_iter().map(|token| match token {
        TokenTree::Group(group) => {
            let (delimiter, inside) = (group.delimiter(), group.stream());
            // Without this second owner, the tokens are moved and not copied.
            drop(group);
            let inside =
                if delimiter == Delimiter::Bracket { elements(inside, lists) } else { with_gaps(inside, lists) };
            Group::new(delimiter, inside).into()
        }
        TokenTree::Ident(_) | TokenTree::Punct(_) | TokenTree::Literal(_) => token,
    });
    tokens.collect()
}

/// Returns the content of a list's brackets. If the list is long, moves the content to `lists` and returns a
/// placeholder instead.
fn elements(inside: TokenStream, lists: &mut Vec<Vec<TokenStream>>) -> TokenStream {
    let mut pieces = Vec::new();
    let (mut piece, mut commas) = (Vec::new(), 0);
    for token in inside {
        commas += usize::from(is_comma(&token));
        piece.push(token);
        if commas == PIECE {
            pieces.push(mem::take(&mut piece).into_iter().collect());
            commas = 0;
        }
    }
    let rest = piece.into_iter().collect();
    if pieces.is_empty() {
        return with_gaps(rest, lists);
    }
    pieces.push(rest);
    lists.push(pieces);
    stand_in(lists.len() - 1)
}

fn stand_in(number: usize) -> TokenStream {
    TokenTree::from(Ident::new(&format!("{STAND_IN}{number}"), Span::call_site())).into()
}

/// Returns the index of the list whose placeholder is on a line; `None` for a line without a placeholder.
fn list(line: &str) -> Option<usize> {
    // prettyplease writes no comma after the last argument of a macro.
    line.trim_start().strip_prefix(STAND_IN)?.trim_end_matches(',').parse().ok()
}

/// Writes the elements of a list in place of the line that contains its placeholder.
fn write_list(pieces: Vec<TokenStream>, line: &str, text: &mut String) {
    let indent = &line[..line.len() - line.trim_start().len()];
    match pieces.iter().map(numbers).collect::<Option<Vec<_>>>() {
        Some(pieces) => write_numbers(&pieces.concat(), indent, text),
        None => pieces.into_iter().for_each(|piece| write_elements(piece, line, text)),
    }
}

/// Returns the elements as text if all are numbers; `None` otherwise.
fn numbers(elements: &TokenStream) -> Option<Vec<String>> {
    literals(elements.clone()).filter(|numbers| !numbers.iter().any(|number| number.starts_with('"')))
}

/// Writes numbers; each line contains as many as fit.
fn write_numbers(numbers: &[String], indent: &str, text: &mut String) {
    let mut line = indent.to_owned();
    for number in numbers {
        let is_first = line.len() == indent.len();
        if !is_first && line.len() + " ,".len() + number.len() > WIDTH {
            write_line(&line, text);
            line.truncate(indent.len());
        } else if !is_first {
            line.push(' ');
        }
        line += number;
        line.push(',');
    }
    write_line(&line, text);
}

/// Writes formatted elements in place of the line that contains their placeholder.
fn write_elements(elements: TokenStream, line: &str, text: &mut String) {
    let indent = line.len() - line.trim_start().len();
    if let Some(plain) = strings(&elements).or_else(|| calls(&elements, WIDTH.saturating_sub(indent))) {
        let indent = &line[..indent];
        plain.iter().for_each(|element| write_line(&format!("{indent}{element},"), text));
        return;
    }
    let stand_in = stand_in(0);
    let mut item = quote!(const LIST: () = [#stand_in, #elements];);
    for _ in 1..indent / 4 {
        item = quote!(mod around { #item });
    }
    let text_around = pretty(item);
    let behind = text_around.lines().skip_while(|line| list(line).is_none()).skip(1);
    behind.take_while(|line| line.trim_start() != "];").for_each(|line| write_line(line, text));
}

/// Returns the elements as text if all are string literals; `None` otherwise. String literals are written unchanged,
/// because parsing them would take most of the time.
fn strings(elements: &TokenStream) -> Option<Vec<String>> {
    let tokens = elements.clone().into_iter().filter(|token| !is_comma(token)).map(|token| token.to_string());
    tokens.map(|token| token.starts_with('"').then_some(token)).collect()
}

/// Returns the elements as text if all are calls and none is longer than `width`, including its comma; `None`
/// otherwise. The tables of a machine are such lists.
fn calls(elements: &TokenStream, width: usize) -> Option<Vec<String>> {
    let calls = plain(elements.clone())?;
    calls.iter().all(|call| call.ends_with(')') && call.len() < width).then_some(calls)
}

/// Returns the elements as text if each is a literal, a path, an array of these, or a call of a path with such
/// arguments; `None` otherwise.
fn plain(elements: TokenStream) -> Option<Vec<String>> {
    let mut texts = Vec::new();
    let mut text = String::new();
    for token in elements {
        match token {
            TokenTree::Ident(word) if text.is_empty() || text.ends_with(':') => text += &word.to_string(),
            TokenTree::Literal(literal) if text.is_empty() || text == "-" => text += &literal.to_string(),
            TokenTree::Group(group) if group.delimiter() == Delimiter::Parenthesis && !text.is_empty() => {
                text += &format!("({})", plain(group.stream())?.join(", "));
            }
            TokenTree::Group(group) if group.delimiter() == Delimiter::Bracket && text.is_empty() => {
                text = format!("[{}]", plain(group.stream())?.join(", "));
            }
            TokenTree::Punct(minus) if minus.as_char() == '-' && text.is_empty() => text.push('-'),
            TokenTree::Punct(colon) if colon.as_char() == ':' && !text.is_empty() => text.push(':'),
            TokenTree::Punct(comma) if comma.as_char() == ',' => texts.push(mem::take(&mut text)),
            TokenTree::Ident(_) | TokenTree::Punct(_) | TokenTree::Group(_) | TokenTree::Literal(_) => return None,
        }
    }
    texts.extend(Some(text).filter(|text| !text.is_empty()));
    Some(texts)
}

/// Returns the arguments as text if all are literals; `None` otherwise.
fn literals(arguments: TokenStream) -> Option<Vec<String>> {
    let arguments = arguments.into_iter().filter(|token| !is_comma(token));
    arguments.map(|token| matches!(token, TokenTree::Literal(_)).then(|| token.to_string())).collect()
}

fn is_comma(token: &TokenTree) -> bool {
    matches!(token, TokenTree::Punct(punct) if punct.as_char() == ',')
}

fn write_line(line: &str, text: &mut String) {
    text.push_str(line);
    text.push('\n');
}

/// Returns the formatted text of a file. If the tokens are not valid Rust, the text makes rustc report an error.
fn pretty(file: TokenStream) -> String {
    syn::parse2(file).map_or_else(|error| error.into_compile_error().to_string(), |file| prettyplease::unparse(&file))
}

#[cfg(test)]
mod tests {
    use proc_macro2::{Literal, TokenStream};
    use quote::quote;

    use super::{PIECE, file_text};

    /// Returns the text of a file formatted piece by piece, and the text formatted as a whole.
    fn both(file: &TokenStream) -> [String; 2] {
        let whole = prettyplease::unparse(&syn::parse2(file.clone()).expect("a file"));
        let pieces: Vec<_> =
            file_text(file.clone()).lines().filter(|line| !line.is_empty()).map(str::to_owned).collect();
        [pieces.join("\n") + "\n", whole]
    }

    #[test]
    fn long_lists_look_as_if_they_were_laid_out_at_once() {
        let number = |number: usize| Literal::usize_unsuffixed(number * number);
        let text = |number: usize| format!("number \"{number}\"\n");
        let elements: [&dyn Fn(usize) -> TokenStream; 10] = [
            &|i| {
                let number = number(i);
                quote!(#number)
            },
            &|i| {
                let number = number(i);
                quote!([0, #number, 7])
            },
            &|i| {
                let number = number(i);
                quote!(Bracket::scope(#number, 1, 2))
            },
            &|i| {
                let number = number(i);
                quote!(guard(go(runtime::Meters(-1.5), #number), [true, false], robot::NONE, follows(1, #number, 2)))
            },
            &|i| {
                let name = quote::format_ident!(
                    "a_name_that_fills_up_the_line_until_no_place_is_left_in_it{}",
                    "_".repeat(i % 40)
                );
                quote!(a::#name(1))
            },
            &|i| {
                let text = text(i);
                quote!(#text)
            },
            &|i| {
                let number = number(i);
                quote!((#number, []))
            },
            &|i| {
                let (number, text) = (number(i), text(i));
                quote!(Row { at: #number, what: (a::Thing::of(&[#number, 2], #text)), then: Some(b::Other(#number)), })
            },
            &|i| {
                let number = number(i);
                if i % 100 == 0 { quote!(None) } else { quote!(#number) }
            },
            // An operator is not a part of a path.
            &|i| {
                let number = number(i);
                quote!(&a::call(#number))
            },
        ];
        for length in [PIECE - 1, PIECE, PIECE + 1, 2 * PIECE + 7] {
            for element in elements {
                let elements: Vec<_> = (0..length).map(element).collect();
                let [pieces, whole] = both(&quote! {
                    static OUTSIDE: &[T] = &[#(#elements),*];
                    mod machine {
                        static TRAILING: &[T] = &[#(#elements,)*];
                        const NESTED: Table = Table { first: 1, rows: &[#(#elements),*], last: &[&[#(#elements),*], &[]] };
                        fn length() -> usize { if true { [#(#elements),*].len() } else { 0 } }
                    }
                });
                assert!(pieces == whole, "{length}:\n{pieces}\n{whole}");
            }
        }
    }

    #[test]
    fn texts_of_a_macro_are_written_in_pieces() {
        let texts = (0..PIECE + 1).map(|number| Literal::string(&format!("go {number} 0")));
        let text = file_text(quote!(
            const TEXTS: &str = concat![#(#texts),*];
        ));
        assert_eq!(text.matches("go ").count(), PIECE + 1, "{text}");
        assert!(syn::parse_file(&text).is_ok() && !text.contains(super::STAND_IN), "{text}");
    }

    #[test]
    fn tokens_that_are_no_rust_are_an_error_of_rustc_s() {
        assert!(file_text(quote!(fn fn)).contains("compile_error"));
    }
}
