//! Splits a text into the number at its beginning and the rest.

/// Returns the number at the beginning of a text, which may be empty, and the rest that directly follows it.
pub(super) fn split(text: &str) -> (&str, &str) {
    let digits = |from: usize| text.bytes().skip(from).take_while(u8::is_ascii_digit).count();
    let is = |at: usize, any: &[u8]| text.as_bytes().get(at).is_some_and(|byte| any.contains(byte));
    let sign = usize::from(is(0, b"+-"));
    let mut end = sign + digits(sign);
    if end == sign {
        return ("", text);
    }
    if is(end, b".") && digits(end + 1) > 0 {
        end += 1 + digits(end + 1);
    }
    if is(end, b"eE") {
        let first = end + 1 + usize::from(is(end + 1, b"+-"));
        if digits(first) > 0 {
            end = first + digits(first);
        }
    }
    text.split_at_checked(end).unwrap_or((text, ""))
}
