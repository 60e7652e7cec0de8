//! Reports commas between the arguments of a law, and between the bits of `atIsection`.

use crate::diagnostic::Diagnostic;
use crate::syntax::site::Site;
use crate::syntax::token::Tok;

/// Maximum number of tokens before or after a comma that a call is read for.
const LONGEST: usize = 30;

/// Reports bits with commas between them, as in `atIsection 1,0,0,0`.
pub(super) fn bits(site: &Site<'_, '_>) -> Option<Diagnostic> {
    let is_part = |at: &usize| matches!(site.kind(*at), Some(Tok::Number("0" | "1") | Tok::Comma));
    let first = (0..=site.at).rev().take(LONGEST).take_while(is_part).last()?;
    let name = first.checked_sub(1).filter(|name| site.name_at(*name) == Some("atIsection"))?;
    let last = (first..).take(LONGEST).take_while(is_part).last()?;
    let text = site.text(first, last).filter(|text| text.contains(','))?;
    let digits: String = text.chars().filter(char::is_ascii_digit).collect();
    let comma = (first..=last).find(|at| site.kind(*at) == Some(Tok::Comma))?;
    let diagnostic = site.about(comma, "the bits of `atIsection` have no commas between them", "not expected here");
    Some(match digits.len() {
        4 => diagnostic.fix("write them together: {}", site.span(name, last), format!("atIsection {digits}")),
        _ => diagnostic.help("four bits are written together, as in `atIsection 1000`"),
    })
}

/// Returns `diagnostic`, which is about a comma after an argument of a law, with the text of the call without commas.
pub(super) fn in_law(site: &Site<'_, '_>, diagnostic: Diagnostic) -> Diagnostic {
    let Some((first, last, name, args)) = call(site) else {
        let words = "remove the comma: arguments are separated by spaces, as in `go 5 0`";
        let diagnostic = diagnostic.fix(words, site.span(site.at, site.at), "");
        return diagnostic.help("or write them in parentheses that touch the name: `go(5, 0)`");
    };
    let spaced = format!("{name} {}", args.join(" "));
    diagnostic
        .fix("remove the comma, because arguments are separated by spaces: {}", site.span(first, last), spaced)
        .help(format!("or write them in parentheses that touch the name: `{name}({})`", args.join(", ")))
}

/// Returns the indices of the first and the last token of the call that contains the comma at the site, its name and
/// its arguments; `None` if the call has other tokens than names, values and commas.
fn call<'s>(site: &Site<'_, 's>) -> Option<(usize, usize, &'s str, Vec<&'s str>)> {
    let is_part =
        |at: &usize| matches!(site.kind(*at), Some(Tok::Name(_) | Tok::Number(_) | Tok::Infinity | Tok::Comma));
    let first = (0..site.at).rev().take(LONGEST).take_while(is_part).last()?;
    let last = (site.at..).take(LONGEST).take_while(is_part).last()?;
    let name = site.name_at(first)?;
    site.text(first, last)?;
    let is_whole = site.kind(last + 1) == Some(Tok::RParen) && site.kind(last) != Some(Tok::Comma);
    let args = (first + 1..=last).filter(|at| site.kind(*at) != Some(Tok::Comma)).map(|at| site.text(at, at));
    Some((first, last, name, args.collect::<Option<_>>()?)).filter(|_| is_whole)
}
