//! Writes a part of a plan's text on one line, for reports that repeat the user's words.

use super::lexer::lex;
use super::source::FileText;
use crate::diagnostic::SourceId;

/// Returns the tokens of `text` on one line, without comments, typesetting and enclosing parentheses. A single space
/// separates tokens that are separated in `text`. `ends` contains offsets in `text` at which tokens end; the function
/// also returns the corresponding offsets in the line.
#[must_use]
pub fn one_line<const N: usize>(text: &str, ends: [Option<usize>; N]) -> (String, [Option<usize>; N]) {
    let tokens = lex(FileText { id: SourceId(0), text }).tokens;
    let is = |index: usize, parenthesis: &str| {
        tokens.get(index).and_then(|token| text.get(token.place.start..token.place.end)) == Some(parenthesis)
    };
    let mut range = 0..tokens.len();
    while range.len() > 1 && is(range.start, "(") && closes(&range, &is) {
        range = range.start + 1..range.end - 1;
    }
    let (mut line, mut places, mut last) = (String::new(), [None; N], None);
    for token in tokens.get(range).into_iter().flatten() {
        match last.and_then(|end| text.get(end..token.place.start)) {
            None | Some("") => {}
            // A dot is between tokens only in the plan of a group, where it is part of a name.
            Some(".") => line.push('.'),
            Some(_) => line.push(' '),
        }
        line += text.get(token.place.start..token.place.end).unwrap_or("");
        last = Some(token.place.end);
        for (place, end) in places.iter_mut().zip(ends) {
            if end == last {
                *place = Some(line.len());
            }
        }
    }
    (line, places)
}

/// Returns `true` if the last token of `range` closes the parenthesis that its first token opens.
fn closes(range: &std::ops::Range<usize>, is: &impl Fn(usize, &str) -> bool) -> bool {
    let mut depth = 0_usize;
    for index in range.clone() {
        if is(index, "(") {
            depth += 1;
        } else if is(index, ")") {
            depth = depth.saturating_sub(1);
        }
        if depth == 0 {
            return index + 1 == range.end;
        }
    }
    false
}

#[cfg(test)]
mod tests {
    use super::one_line;

    #[test]
    fn words_are_joined_as_they_were_apart() {
        let lines = |text| one_line(text, []).0;
        assert_eq!(lines("bumper  OR // contact\n   wait 10min"), "bumper OR wait 10min");
        assert_eq!(lines("( (r1<40cm))"), "r1<40cm");
        assert_eq!(lines("(a) OR (b)"), "(a) OR (b)");
        assert_eq!(lines("NOT (a OR b)"), "NOT (a OR b)");
        assert_eq!(lines("(robot1.x  > 7m)"), "robot1.x > 7m");
        assert_eq!(lines(""), "");
    }

    #[test]
    fn places_move_with_their_words() {
        let text = "RISING  (r1\n < r 5)";
        assert_eq!(one_line(text, [Some(11), None]).1, [Some(10), None]);
        let (line, [left, right]) = one_line("r1<r5", [Some(2), Some(5)]);
        assert_eq!((line.as_str(), left, right), ("r1<r5", Some(2), Some(5)));
    }
}
