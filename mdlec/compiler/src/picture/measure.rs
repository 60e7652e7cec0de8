//! Estimates the size of text in a picture. All characters are assumed to have the same width, so no font is needed.

/// Width of ten characters, in pixels.
const TEN_LETTERS: i64 = 73;
/// Height of a line, in pixels.
pub(super) const LINE: i64 = 16;

/// Returns the width of a text, in pixels.
pub(super) fn width(text: &str) -> i64 {
    columns(text) * TEN_LETTERS / 10
}

/// Returns the number of characters that fit into a width in pixels.
pub(super) fn letters(width: i64) -> usize {
    usize::try_from(width.max(0) * 10 / TEN_LETTERS).unwrap_or(0)
}

/// Returns the number of columns that a text needs: two for a character of East Asian scripts, one for any other.
fn columns(text: &str) -> i64 {
    text.chars().map(|letter| if letter < '\u{1100}' { 1 } else { 2 }).sum()
}

/// Breaks a text into at most `lines` lines of at most `letters` characters: before OR and AND where possible,
/// otherwise between words. Text that does not fit is omitted, and the last line then ends with `…`.
pub(super) fn wrapped(text: &str, letters: usize, lines: usize) -> Vec<String> {
    let letters = letters.max(4);
    // No more than this is ever shown, so the rest of a long text is not processed.
    let shown = (letters + 1) * lines + 1;
    let enough: String = text.chars().take(shown).collect();
    let mut wrapped = vec![String::new()];
    for operand in operands(&enough) {
        if fits(&wrapped, &operand, letters) || length(&operand) <= letters {
            put(&mut wrapped, &operand, letters);
        } else {
            operand.split(' ').for_each(|word| put(&mut wrapped, word, letters));
        }
    }
    let is_cut = wrapped.len() > lines || text.chars().nth(shown).is_some();
    wrapped.truncate(lines);
    if let Some(last) = wrapped.last_mut().filter(|_| is_cut) {
        let end = last.char_indices().nth(letters - 1).map_or(last.len(), |(end, _)| end);
        last.truncate(end);
        last.push('…');
    }
    wrapped.retain(|line| !line.is_empty());
    wrapped
}

/// Splits a text before each OR and AND.
fn operands(text: &str) -> Vec<String> {
    let mut operands: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        match operands.last_mut() {
            Some(operand) if !["OR", "AND", "or"].contains(&word) => {
                operand.push(' ');
                operand.push_str(word);
            }
            Some(_) | None => operands.push(word.to_owned()),
        }
    }
    operands
}

/// Returns `true` if the last line has room for these words.
fn fits(wrapped: &[String], words: &str, letters: usize) -> bool {
    let line = wrapped.last().map_or(0, |line| length(line) + usize::from(!line.is_empty()));
    line + length(words) <= letters
}

/// Appends words to the last line, or to a new line; words longer than a line are split.
fn put(wrapped: &mut Vec<String>, words: &str, letters: usize) {
    if !fits(wrapped, words, letters) && wrapped.last().is_some_and(|line| !line.is_empty()) {
        wrapped.push(String::new());
    }
    let mut rest = words;
    while let Some(line) = wrapped.last_mut() {
        if !line.is_empty() {
            line.push(' ');
        }
        let end = rest.char_indices().nth(letters).map_or(rest.len(), |(end, _)| end);
        line.push_str(&rest[..end]);
        rest = &rest[end..];
        if rest.is_empty() {
            break;
        }
        wrapped.push(String::new());
    }
}

fn length(text: &str) -> usize {
    usize::try_from(columns(text)).unwrap_or(usize::MAX)
}

#[cfg(test)]
mod tests {
    use super::wrapped;

    #[test]
    fn texts_are_broken_between_words_and_shortened_at_their_end() {
        assert_eq!(wrapped("bumper OR wait 20", 10, 3), ["bumper", "OR wait 20"]);
        assert_eq!(wrapped("bumper OR wait 20 OR atIsection 0100", 10, 2), ["bumper", "OR wait 2…"]);
        assert_eq!(wrapped("until wait 20 or done", 18, 2), ["until wait 20", "or done"]);
        assert_eq!(wrapped("unbreakable", 5, 3), ["unbre", "akabl", "e"]);
        assert_eq!(wrapped("unbreakable", 5, 2), ["unbre", "akab…"]);
        assert_eq!(wrapped("", 5, 2), [""; 0]);
    }

    #[test]
    fn a_text_without_end_is_read_as_far_as_it_is_shown() {
        let long = "wait 1 OR ".repeat(100_000);
        let lines = wrapped(&long, 20, 3);
        assert_eq!(lines.len(), 3);
        assert!(lines[2].ends_with('…'));
    }
}
