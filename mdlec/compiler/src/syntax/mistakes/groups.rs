//! Reports mistakes in the head of a group, which contains its robots and its name.

use crate::diagnostic::Diagnostic;
use crate::syntax::site::Site;
use crate::syntax::token::Tok;

pub(super) const HEAD: &str = "a group begins with its robots and its name: `{ Group [robot1 robot2] Name … }`";

/// Reports a group whose list of robots is not closed, as in `{ Group [robot1 robot2 Name …`, or a group without a
/// name, as in `{ Group [robot1 robot2] (…`.
pub(super) fn head_of_group(site: &Site<'_, '_>) -> Option<Diagnostic> {
    let is_mark = |at: &usize| matches!(site.kind(*at), Some(Tok::Group | Tok::LBracket | Tok::RBracket | Tok::RBrace));
    let mark = (0..site.at).rev().find(is_mark)?;
    let begins = |bracket: usize| bracket > 0 && site.kind(bracket - 1) == Some(Tok::Group);
    match site.kind(mark) {
        Some(Tok::LBracket) if begins(mark) => {
            let message = "the list of a group's robots is not closed";
            Some(site.about(mark, message, "a `]` is missing after the last robot").help(HEAD))
        }
        Some(Tok::RBracket) if mark + 1 == site.at && site.expects("name") => {
            let report = site.about(site.at, "this group has no name", "a name is missing before this");
            Some(report.help(HEAD))
        }
        Some(_) | None => None,
    }
}
